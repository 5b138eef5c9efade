#include "host/scale/dealer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace claray {
namespace {

constexpr std::uint32_t least_pixels = 16;  // in a band
constexpr double piece_seconds = 0.1;
constexpr double least_piece_seconds = 2e-3;
/// Of a worker's first pieces an image is long, so that the worker begins before the speed of others is known.
constexpr double first_pieces_of_long_render = 256;
/// Near the end a piece is this part of the remaining time, since workers have a few in advance. Until all workers have
/// their share, it is also this part of the time so far: one that joins waits for the pieces of those that hold all
/// pixels.
constexpr double share_at_end = 3, share_at_begin = 4;
/// Workers whose first piece is a smaller part of the image, such as CPUs, keep to short pieces: four ranks on two
/// cores are 3 % faster so.
constexpr std::uint32_t part_of_cheap_start = 16;
/// A piece has at most so many times the paths of the one before: speed is not yet known well.
constexpr double growth = 4;
/// Small pieces on GPUs are slow, since they start as many kernels as large ones do: an H200
/// needs 5 ms for half a million paths inside sponza, and 57 ms for 16 million.
constexpr double seconds_worth_starting = 0.02;
constexpr double first_pieces_worth_starting = 8;
/// The first passes are so short that a piece may have all of them, up to so many samples per pixel.
constexpr double short_passes = 16;
constexpr double remembered_passes = 2;  // in the measured speed: parts of an image differ in cost
constexpr double unequal = 0.1;          // share of the time left by which workers may end earlier than others
/// While the time so far is less than this part of the time left, speeds are not known well. What is moved later costs
/// no more.
constexpr double begin_of_render = 1. / 3;
constexpr std::uint32_t most_pixels_of_sums = 1 << 16;  // of an order for sums: the worker holds a copy of them
constexpr unsigned most_tries = 16;                     // to find a worker that is behind: an order must not take long
/// A worker renders ahead of the others up to twice their samples and these.
constexpr std::uint32_t samples_ahead = 32;

std::uint64_t paths_of(const Batch& batch) { return std::uint64_t(batch.pixels) * batch.samples; }

void count(std::map<std::uint32_t, std::uint32_t>& counts, std::uint32_t samples) { ++counts[samples]; }
void discount(std::map<std::uint32_t, std::uint32_t>& counts, std::uint32_t samples) {
    const auto at = counts.find(samples);
    if (--at->second == 0) counts.erase(at);
}

}  // namespace

void Dealer::Runs::put(Index first, Index end) {
    ends_.emplace(first, end);
    by_length_.emplace(end - first, ~first);
}

std::map<Dealer::Index, Dealer::Index>::iterator Dealer::Runs::take(std::map<Index, Index>::iterator run) {
    by_length_.erase({run->second - run->first, ~run->first});
    return ends_.erase(run);
}

void Dealer::Runs::add(Index band) {
    Index first = band, end = band + 1;
    auto after = ends_.lower_bound(band);
    if (after != ends_.end() && after->first == end) {
        end = after->second;
        after = take(after);
    }
    if (after != ends_.begin() && std::prev(after)->second == band) {
        first = std::prev(after)->first;
        take(std::prev(after));
    }
    put(first, end);
}

void Dealer::Runs::remove(Index band) {
    const auto run = std::prev(ends_.upper_bound(band));
    const auto [first, end] = *run;
    take(run);
    if (first < band) put(first, band);
    if (band + 1 < end) put(band + 1, end);
}

bool Dealer::Runs::contains(Index band) const {
    const auto after = ends_.upper_bound(band);
    return after != ends_.begin() && band < std::prev(after)->second;
}

std::pair<Dealer::Index, Dealer::Index> Dealer::Runs::longest() const {
    const auto [length, first] = *by_length_.rbegin();
    return {~first, ~first + length};
}

/// Adds a band to the indices, and removes it from them.
void Dealer::enter(Index b) {
    const Band& band = bands_[b];
    count(ordered_counts_, band.ordered), count(done_counts_, band.done);
    if (band.holder == nobody) {
        free_[band.ordered].add(b);
        free_pixels_ += band.pixels;
    } else if (band.leaves) {
        if (band.taker == nobody) return;
        Worker& taker = workers_[std::size_t(band.taker)];
        taker.coming_pixels += band.pixels, taker.coming_ordered += std::uint64_t(band.pixels) * band.ordered;
    } else {
        Worker& worker = workers_[std::size_t(band.holder)];
        worker.bands.insert(worker.bands.end(), b);
        worker.by_samples.emplace(band.ordered, b);
        if (worker.pixels == 0) --without_bands_;
        worker.pixels += band.pixels, worker.ordered += std::uint64_t(band.pixels) * band.ordered;
    }
}

void Dealer::leave(Index b) {
    const Band& band = bands_[b];
    discount(ordered_counts_, band.ordered), discount(done_counts_, band.done);
    if (band.holder == nobody) {
        const auto free = free_.find(band.ordered);
        free->second.remove(b);
        if (free->second.empty()) free_.erase(free);
        free_pixels_ -= band.pixels;
    } else if (band.leaves) {
        if (band.taker == nobody) return;
        Worker& taker = workers_[std::size_t(band.taker)];
        taker.coming_pixels -= band.pixels, taker.coming_ordered -= std::uint64_t(band.pixels) * band.ordered;
    } else {
        Worker& worker = workers_[std::size_t(band.holder)];
        worker.bands.erase(b);
        worker.by_samples.erase({band.ordered, b});
        worker.pixels -= band.pixels, worker.ordered -= std::uint64_t(band.pixels) * band.ordered;
        if (worker.pixels == 0) ++without_bands_;
    }
}

template <class Change>
void Dealer::change(Index b, const Change& change) {
    leave(b);
    change(bands_[b]);
    enter(b);
}

Dealer::Dealer(const std::vector<PixelRun>& runs, std::uint32_t largest_pass, std::uint32_t bands)
    : largest_pass_(std::max(1u, largest_pass)) {
    for (const PixelRun& run : runs) pixels_ += run.pixels;
    const std::uint32_t size = std::max(least_pixels, pixels_ / std::max(1u, bands));
    for (const PixelRun& run : runs) {
        for (std::uint32_t at = 0; at < run.pixels; at += size) {
            const std::uint32_t pixels = std::min(size, run.pixels - at);
            bands_.push_back({run.first + at, pixels, run.samples, run.samples, run.samples});
        }
        ordered_ += std::uint64_t(run.pixels) * run.samples;
    }
    done_ = done_before_ = ordered_;
    for (Index b = 0; b < bands_.size(); ++b) enter(b);
}

int Dealer::add(std::uint32_t first_paths, std::uint32_t most_paths, double handover) {
    workers_.push_back({std::max(1u, first_paths), std::max(1u, most_paths), handover});
    ++without_bands_;
    all_had_shares_ = false;
    return int(workers_.size()) - 1;
}

void Dealer::set_limit(std::uint32_t samples) {
    limit_ = std::max(limit_, samples);
    for (int w = 0; w < int(workers_.size()); ++w) sort_in(w);
}

std::uint32_t Dealer::least() const { return done_counts_.empty() ? ~0u : done_counts_.begin()->first; }

/// PassSchedule has the same passes: 1, 1, 2, 4, 8 ... samples per pixel.
std::uint32_t Dealer::end_of_pass(std::uint32_t samples) const {
    std::uint64_t end = 1;
    while (end < samples && end < largest_pass_) end *= 2;
    if (end < samples) end += (samples - end + largest_pass_ - 1) / largest_pass_ * largest_pass_;
    return std::uint32_t(std::min<std::uint64_t>(end, ~0u));
}

/// With others of speed V and this one of speed s, the samples W that are left take W / (V + s) instead of W / V, and
/// the share s / (V + s) of the pixels is handed over. So s does not matter. Until V is known only long renders pay.
bool Dealer::pays(const Worker& worker, double seconds_left) const {
    if (worker.handover == 0 || worker.pixels + worker.coming_pixels > 0) return true;
    const double others = speed_ - worker.speed();
    const auto keeps_sums = [](const Worker& other) { return !other.is_lost && other.handover == 0; };
    const auto left = double(std::uint64_t(pixels_) * limit_ - ordered_);
    if (others < 1)
        return left > first_pieces_of_long_render * worker.first_paths ||
               std::none_of(workers_.begin(), workers_.end(), keeps_sums);
    return std::min(left / others, seconds_left) > worker.handover * pixels_;
}

/// Among the bands with the fewest samples one that the worker holds, if there is any: the others would bring sums.
Dealer::Index Dealer::first_band_for(int number) const {
    const Worker& worker = workers_[std::size_t(number)];
    const std::uint32_t held = worker.by_samples.empty() ? limit_ : worker.by_samples.begin()->first;
    const std::uint32_t free = free_.empty() ? limit_ : free_.begin()->first;
    if (std::min(held, free) >= limit_) return Index(bands_.size());
    const bool leaves_free = held < limit_ && equal_share_left(worker) == 0;
    return held <= free || leaves_free ? worker.by_samples.begin()->second : free_band_for(number, free);
}

/// Goes on behind the worker's last piece, or else in the middle of the longest run of free bands, so that the bands of
/// a worker lie side by side: long batches are faster.
Dealer::Index Dealer::free_band_for(int worker, std::uint32_t samples) const {
    const Runs& runs = free_.at(samples);
    const Index next = workers_[std::size_t(worker)].next_band;
    if (runs.contains(next)) return next;
    const auto [first, end] = runs.longest();
    const bool is_long = end - first > bands_.size() / (4 * workers_.size());
    return first > 0 && is_long ? first + (end - first) / 2 : first;
}

/// The others that hold none need some too: else they would wait until another worker gives bands.
std::uint32_t Dealer::share_of_free(const Worker& worker) const {
    const unsigned others = without_bands_ - (worker.pixels == 0);
    const std::uint32_t fair = free_pixels_ / (others + 1), equal = equal_share_left(worker);
    return equal > 0 ? std::min(fair, equal) : fair;
}

/// Pixels that the worker may take while others render their first piece: two like it share the image without giving
/// each other any.
std::uint32_t Dealer::equal_share_left(const Worker& worker) const {
    const auto share = std::uint32_t(pixels_ / std::max(1u, at_work_));
    if (measured_ >= at_work_) return pixels_;
    return worker.pixels < share - share / 8 ? share - std::uint32_t(worker.pixels) : 0;
}

double Dealer::seconds_to_limit() const {
    return double(std::uint64_t(pixels_) * limit_ - ordered_) / std::max(speed_, 1.);
}

/// Half of what their speeds are worth at least. What was so once remains so until another one joins: looking at all
/// for each order would take long with hundreds of ranks.
bool Dealer::all_have_shares() {
    const auto has_share = [&](const Worker& worker) {
        const double pixels = double(worker.pixels + worker.coming_pixels);
        return worker.is_lost || (worker.speed() > 0 && pixels * speed_ >= 0.5 * pixels_ * worker.speed());
    };
    if (!all_had_shares_ && workers_.size() >= expected_)
        all_had_shares_ = std::all_of(workers_.begin(), workers_.end(), has_share);
    return all_had_shares_;
}

bool Dealer::begins() const { return seconds_so_far() < begin_of_render * seconds_to_limit(); }

double Dealer::seconds_so_far() const { return double(done_ - done_before_) / std::max(speed_, 1.); }

double Dealer::paths_of_piece(const Worker& worker, double seconds_left) {
    if (worker.speed() == 0 || worker.first_paths == worker.most_paths) return worker.first_paths;
    double most = std::min(seconds_to_limit() / share_at_end, seconds_left / 2);
    const bool starts_cheaply = worker.first_paths < pixels_ / part_of_cheap_start;
    if (starts_cheaply || !all_have_shares()) most = std::min(most, seconds_so_far() / share_at_begin);
    const double seconds = std::clamp(most, least_piece_seconds, piece_seconds);
    const double paths = std::min({worker.speed() * seconds, growth * worker.last_paths, double(worker.most_paths)});
    const double worth_starting =
        std::min(first_pieces_worth_starting * worker.first_paths, worker.speed() * seconds_worth_starting);
    return seconds_left / 2 < seconds ? paths : std::max({paths, double(worker.first_paths), worth_starting});
}

template <class Visit>
void Dealer::for_bands_of(const Batch& batch, const Visit& visit) {
    const auto begins_before = [](const Band& band, std::uint32_t pixel) { return band.first < pixel; };
    auto b = Index(std::lower_bound(bands_.begin(), bands_.end(), batch.first_pixel, begins_before) - bands_.begin());
    for (; b < bands_.size() && bands_[b].first < batch.first_pixel + batch.pixels; ++b) visit(b);
}

/// Whole passes more for few pixels, since short batches are slow; at most half as many samples again as they have.
std::uint32_t Dealer::longer(const Batch& piece, double paths) const {
    std::uint32_t end = piece.first_sample + piece.samples;
    if (end != end_of_pass(end)) return piece.samples;
    const double most =
        std::min(std::max(short_passes, 1.5 * piece.first_sample), piece.first_sample + paths / piece.pixels);
    for (std::uint32_t next = end_of_pass(end + 1); next <= most; next = end_of_pass(end + 1)) end = next;
    return std::min(limit_, end) - piece.first_sample;
}

Order Dealer::piece_from(Index b, int worker, double paths) {
    const Band first = bands_[b];
    const std::uint32_t end = std::min(limit_, end_of_pass(first.ordered + 1));
    Order order;
    order.brings_sums = first.ordered > 0 && (first.holder == nobody || first.is_away);
    order.batch.first_pixel = first.first, order.batch.first_sample = first.ordered;
    order.batch.samples =
        std::min(end - first.ordered, std::uint32_t(std::clamp(paths / first.pixels, 1., double(~0u))));
    const std::uint32_t most = first.holder == nobody ? share_of_free(workers_[std::size_t(worker)]) : pixels_;
    for (; b < bands_.size(); ++b) {
        const Band& band = bands_[b];
        const std::uint32_t all = order.batch.pixels + band.pixels;
        const bool is_alike =
            band.ordered == first.ordered && band.holder == first.holder && band.is_away == first.is_away;
        if (!may_render(band, worker) || !is_alike) break;
        if (order.batch.pixels > 0 && (all > most || double(all) * order.batch.samples > paths)) break;
        order.batch.pixels = all;
    }
    order.batch.samples = longer(order.batch, paths);
    for_bands_of(order.batch, [&](Index of_piece) {
        change(of_piece,
               [&](Band& band) { band.holder = worker, band.is_away = false, band.ordered += order.batch.samples; });
    });
    ordered_ += paths_of(order.batch);
    workers_[std::size_t(worker)].next_band = b;
    sort_in(worker);
    return order;
}

std::optional<Order> Dealer::next(int number, double seconds_left) {
    Worker& worker = workers_[std::size_t(number)];
    if (!worker.gives.empty()) {
        const Order give = worker.gives.front();
        worker.gives.pop_front();
        return give;
    }
    const bool is_measured = worker.speed() > 0 || worker.last_paths == 0 || worker.first_paths == worker.most_paths;
    if (!is_measured || !pays(worker, seconds_left)) return std::nullopt;
    const Index band = first_band_for(number);
    const bool any = band != bands_.size();
    const bool waits = !any || bands_[band].ordered > 2 * std::uint64_t(least_ordered()) + samples_ahead;
    if (waits || !begins()) ask_others(number, any ? bands_[band].ordered : limit_);
    if (waits) return std::nullopt;
    const Order order = piece_from(band, number, paths_of_piece(worker, seconds_left));
    if (worker.last_paths == 0) ++at_work_;
    worker.last_paths = std::uint32_t(std::min<std::uint64_t>(paths_of(order.batch), worker.most_paths));
    return order;
}

/// To render its samples and to hand over the sums of its pixels. Its speed must be known.
double Dealer::seconds_to_end(const Worker& worker) const {
    const double pixels = double(worker.pixels + worker.coming_pixels);
    return samples_left(worker) / worker.speed() + worker.handover * pixels;
}

void Dealer::sort_in(int number) {
    Worker& worker = workers_[std::size_t(number)];
    if (worker.seconds_left >= 0) by_seconds_.erase({worker.seconds_left, number});
    const bool may_be_asked = !worker.is_lost && worker.giving == 0 && worker.speed() > 0;
    worker.seconds_left = may_be_asked ? seconds_to_end(worker) : -1;
    if (may_be_asked) by_seconds_.emplace(worker.seconds_left, number);
}

/// The worker has nothing to do below `level` samples per pixel. Takes over bands of the worker that would end last, so
/// that both end at the same time.
void Dealer::ask_others(int number, std::uint32_t level) {
    const Worker& worker = workers_[std::size_t(number)];
    if (worker.speed() == 0 && worker.pixels + worker.coming_pixels > 0) return;  // whether it needs more is unknown
    const double own = worker.speed() > 0 ? seconds_to_end(worker) : 0;
    int slowest = nobody;
    unsigned tries = most_tries;
    for (auto at = by_seconds_.rbegin(); at != by_seconds_.rend() && tries-- > 0 && slowest == nobody; ++at) {
        const auto [seconds, w] = *at;
        if (seconds - own <= std::max(least_piece_seconds, unequal * seconds)) break;
        const Worker& other = workers_[std::size_t(w)];
        const bool is_behind = !other.by_samples.empty() && other.by_samples.begin()->first < level;
        if (w != number && is_behind) slowest = w;
    }
    if (slowest == nobody) return;
    if (worker.speed() == 0) {  // as many pixels as a first piece has paths, until its speed is known
        const double half = samples_left(workers_[std::size_t(slowest)]) / 2;
        return ask(slowest, number, std::min(half, double(worker.first_paths) * (limit_ - least_ordered())));
    }
    const double later = seconds_to_end(workers_[std::size_t(slowest)]) - own;
    ask(slowest, number, later / (1 / worker.speed() + 1 / speed(slowest)));
}

/// From the end, since workers begin at the front.
void Dealer::ask(int holder, int taker, double samples) {
    Worker& worker = workers_[std::size_t(holder)];
    std::vector<Index> asked;
    for (auto b = worker.bands.rbegin(); b != worker.bands.rend() && samples > 0; ++b) {
        const Band& band = bands_[*b];
        if (band.ordered >= limit_) continue;
        samples -= double(limit_ - band.ordered) * band.pixels;
        asked.push_back(*b);
    }
    for (const Index b : asked) {
        if (bands_[b].is_away)
            change(b, [&](Band& band) { band.holder = taker; });
        else
            order_to_give(b, taker);
    }
    sort_in(holder), sort_in(taker);
}

void Dealer::order_to_give(Index b, int taker) {
    const Band& band = bands_[b];
    Worker& worker = workers_[std::size_t(band.holder)];
    const auto goes_on = [&](const Batch& last) {
        return last.first_pixel == band.first + band.pixels && last.pixels + band.pixels <= most_pixels_of_sums;
    };
    if (worker.gives.empty() || !goes_on(worker.gives.back().batch)) {
        worker.gives.push_back({Order::Kind::give, {band.first + band.pixels, 0, 0, 0, 0}});
        ++worker.giving;
    }
    Batch& give = worker.gives.back().batch;
    give.first_pixel = band.first, give.pixels += band.pixels;
    change(b, [&](Band& leaving) { leaving.leaves = true, leaving.taker = taker; });
}

std::optional<Order> Dealer::read_finished(int number) {
    std::deque<Index>& finished = workers_[std::size_t(number)].finished;
    Order read{Order::Kind::read, {}};
    for (; !finished.empty(); finished.pop_front()) {
        const Band& band = bands_[finished.front()];
        if (band.holder != number || band.leaves || band.done < limit_ || band.known == band.done) continue;
        if (read.batch.pixels == 0) read.batch.first_pixel = band.first;
        const bool goes_on = read.batch.first_pixel + read.batch.pixels == band.first;
        if (!goes_on || (read.batch.pixels > 0 && read.batch.pixels + band.pixels > most_pixels_of_sums)) break;
        read.batch.pixels += band.pixels;
    }
    return read.batch.pixels > 0 ? std::optional(read) : std::nullopt;
}

std::vector<Order> Dealer::handovers(int number) {
    Worker& worker = workers_[std::size_t(number)];
    const auto given = std::ssize(worker.gives);
    std::vector<Order> orders(worker.gives.begin(), worker.gives.end());
    worker.gives.clear();
    for (const Index b : worker.bands) {
        const Band& band = bands_[b];
        if (band.known == band.ordered) continue;
        const auto goes_on = [&](const Batch& last) {
            return last.first_pixel + last.pixels == band.first && last.pixels + band.pixels <= most_pixels_of_sums;
        };
        if (std::ssize(orders) == given || !goes_on(orders.back().batch))
            orders.push_back({Order::Kind::read, {band.first, 0, 0, 0, 0}});
        orders.back().batch.pixels += band.pixels;
    }
    return orders;
}

void Dealer::done(int number, const Order& order, double seconds) {
    Worker& worker = workers_[std::size_t(number)];
    if (order.kind == Order::Kind::render) {
        for_bands_of(order.batch, [&](Index b) {
            discount(done_counts_, bands_[b].done);
            count(done_counts_, bands_[b].done += order.batch.samples);
            if (bands_[b].done == limit_) worker.finished.push_back(b);
        });
        done_ += paths_of(order.batch), worker.all += paths_of(order.batch);
        const double window = remembered_passes * largest_pass_ * pixels_ / double(workers_.size());
        const double kept = std::max(0.5, 1 - double(paths_of(order.batch)) / window);
        if (worker.speed() == 0) ++measured_;
        speed_ -= worker.speed();
        worker.samples = kept * worker.samples + double(paths_of(order.batch));
        worker.seconds = kept * worker.seconds + std::max(seconds, 1e-9);
        speed_ += worker.speed();
        sort_in(number);
        return;
    }
    for_bands_of(order.batch, [&](Index b) { bands_[b].known = bands_[b].done; });
    if (order.kind != Order::Kind::give) return;
    --worker.giving;
    sort_in(number);
    for_bands_of(order.batch, [&](Index b) {
        change(b, [](Band& band) {
            band.holder = std::exchange(band.taker, nobody);
            band.is_away = band.holder != nobody, band.leaves = false;
        });
    });
}

void Dealer::lost(int number) {
    Worker& worker = workers_[std::size_t(number)];
    worker.gives.clear(), worker.giving = 0;
    if (worker.is_lost) return;
    speed_ -= worker.speed();
    if (worker.last_paths > 0) --at_work_;
    if (worker.speed() > 0) --measured_;
    worker.is_lost = true;
    sort_in(number);
    for (Index b = 0; b < bands_.size(); ++b) {
        if (bands_[b].taker == number) change(b, [](Band& band) { band.taker = nobody; });
        if (bands_[b].holder != number) continue;
        change(b, [&](Band& band) {
            ordered_ -= std::uint64_t(band.pixels) * (band.ordered - band.known);
            done_ -= std::uint64_t(band.pixels) * (band.done - band.known);
            band.ordered = band.done = band.known;
            band.holder = band.taker = nobody;
            band.leaves = band.is_away = false;
        });
    }
    --without_bands_;
}

std::vector<PixelRun> Dealer::runs(std::uint32_t Band::*samples) const {
    std::vector<PixelRun> runs;
    for (const Band& band : bands_) {
        if (!runs.empty() && runs.back().samples == band.*samples)
            runs.back().pixels += band.pixels;
        else
            runs.push_back({band.first, band.pixels, band.*samples});
    }
    return runs;
}

std::vector<PixelRun> Dealer::held_by_others(int worker) const {
    std::vector<PixelRun> runs;
    for (const Band& band : bands_) {
        if ((band.holder == worker && !band.is_away) || band.done == 0) continue;
        if (!runs.empty() && runs.back().first + runs.back().pixels == band.first)
            runs.back().pixels += band.pixels;
        else
            runs.push_back({band.first, band.pixels, band.done});
    }
    return runs;
}

}  // namespace claray
