#include "host/scale/dealer.hpp"

#include <algorithm>
#include <cmath>

namespace claray {
namespace {

constexpr std::uint32_t least_pixels = 16;  // in a band
constexpr double piece_seconds = 0.1;
constexpr double least_piece_seconds = 1e-3;
constexpr double share_at_end = 8;       // a piece is this part of the remaining time: workers have a few in advance
constexpr double remembered_passes = 2;  // in the measured speed: parts of an image differ in cost
constexpr double unequal = 0.1;          // share of the time left by which workers may end earlier than others
/// A worker renders ahead of the others up to twice their samples and these.
constexpr std::uint32_t samples_ahead = 32;

std::uint64_t paths_of(const Batch& batch) { return std::uint64_t(batch.pixels) * batch.samples; }

}  // namespace

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
    done_ = ordered_;
}

int Dealer::add(std::uint32_t first_paths, std::uint32_t most_paths) {
    workers_.push_back({std::max(1u, first_paths), std::max(1u, most_paths)});
    return int(workers_.size()) - 1;
}

void Dealer::set_limit(std::uint32_t samples) { limit_ = std::max(limit_, samples); }

std::uint32_t Dealer::least() const {
    std::uint32_t least = ~0u;
    for (const Band& band : bands_) least = std::min(least, band.done);
    return least;
}

std::uint32_t Dealer::least_ordered() const {
    std::uint32_t least = ~0u;
    for (const Band& band : bands_) least = std::min(least, band.ordered);
    return least;
}

/// Schedule has the same passes: 1, 1, 2, 4, 8 ... samples per pixel.
std::uint32_t Dealer::end_of_pass(std::uint32_t samples) const {
    std::uint64_t end = 1;
    while (end < samples && end < largest_pass_) end *= 2;
    if (end < samples) end += (samples - end + largest_pass_ - 1) / largest_pass_ * largest_pass_;
    return std::uint32_t(std::min<std::uint64_t>(end, ~0u));
}

/// Among the bands with the fewest samples one that the worker holds, if there is any: the others would bring sums.
std::size_t Dealer::first_band_for(int worker) const {
    std::size_t best = bands_.size();
    for (std::size_t b = 0; b < bands_.size(); ++b) {
        const Band& band = bands_[b];
        if (!may_render(band, worker)) continue;
        const bool fewer = best == bands_.size() || band.ordered < bands_[best].ordered;
        const bool held = best != bands_.size() && band.ordered == bands_[best].ordered && band.holder == worker &&
                          bands_[best].holder == nobody;
        if (fewer || held) best = b;
    }
    if (best == bands_.size() || bands_[best].holder == worker) return best;
    return free_band_for(worker, bands_[best].ordered);
}

/// Goes on behind the worker's last piece, or else in the middle of the longest run of free bands, so that the bands of
/// a worker lie side by side: long batches are faster.
std::size_t Dealer::free_band_for(int worker, std::uint32_t samples) const {
    const auto is_free = [&](std::size_t b) {
        return b < bands_.size() && bands_[b].holder == nobody && bands_[b].ordered == samples;
    };
    const std::size_t next = workers_[std::size_t(worker)].next_band;
    if (is_free(next)) return next;
    std::size_t longest = 0, start = 0;
    for (std::size_t b = 0; b < bands_.size(); ++b) {
        if (!is_free(b)) continue;
        const std::size_t first = b;
        while (is_free(b)) ++b;
        if (b - first > longest) longest = b - first, start = first;
    }
    const bool is_long = longest > bands_.size() / (4 * workers_.size());
    return start > 0 && is_long ? start + longest / 2 : start;
}

double Dealer::seconds_to_limit() const {
    double speed = 0;
    for (const Worker& worker : workers_)
        if (!worker.is_lost) speed += worker.speed();
    return double(std::uint64_t(pixels_) * limit_ - ordered_) / std::max(speed, 1.);
}

double Dealer::paths_of_piece(const Worker& worker, double seconds_left) const {
    if (worker.speed() == 0 || worker.first_paths == worker.most_paths) return worker.first_paths;
    const double seconds = std::min({piece_seconds, std::max(least_piece_seconds, seconds_to_limit() / share_at_end),
                                     std::max(least_piece_seconds, seconds_left / 2)});
    return std::min({worker.speed() * seconds, 4. * worker.last_paths, double(worker.most_paths)});
}

template <class Visit>
void Dealer::for_bands_of(const Batch& batch, const Visit& visit) {
    const auto begins_before = [](const Band& band, std::uint32_t pixel) { return band.first < pixel; };
    auto band = std::lower_bound(bands_.begin(), bands_.end(), batch.first_pixel, begins_before);
    for (; band != bands_.end() && band->first < batch.first_pixel + batch.pixels; ++band) visit(*band);
}

/// Whole passes more for few pixels, since short batches are slow; at most half as many samples again as they have.
std::uint32_t Dealer::longer(const Batch& piece, double paths) const {
    const std::uint32_t end = piece.first_sample + piece.samples;
    const double most = std::min(1.5 * piece.first_sample, piece.first_sample + paths / piece.pixels);
    if (most < end + largest_pass_ || end != end_of_pass(end)) return piece.samples;
    const auto passes = std::uint32_t((most - end) / largest_pass_);
    return std::min(limit_, end + passes * largest_pass_) - piece.first_sample;
}

Order Dealer::piece_from(std::size_t b, int worker, double paths) {
    const Band first = bands_[b];
    const std::uint32_t end = std::min(limit_, end_of_pass(first.ordered + 1));
    Order order;
    order.brings_sums = first.holder == nobody && first.ordered > 0;
    order.batch.first_pixel = first.first, order.batch.first_sample = first.ordered;
    order.batch.samples =
        std::min(end - first.ordered, std::uint32_t(std::clamp(paths / first.pixels, 1., double(~0u))));
    for (; b < bands_.size(); ++b) {
        const Band& band = bands_[b];
        const std::uint32_t all = order.batch.pixels + band.pixels;
        if (!may_render(band, worker) || band.ordered != first.ordered || band.holder != first.holder) break;
        if (order.batch.pixels > 0 && double(all) * order.batch.samples > paths) break;
        order.batch.pixels = all;
    }
    order.batch.samples = longer(order.batch, paths);
    for_bands_of(order.batch, [&](Band& band) { band.holder = worker, band.ordered += order.batch.samples; });
    ordered_ += paths_of(order.batch);
    workers_[std::size_t(worker)].next_band = b;
    return order;
}

std::optional<Order> Dealer::next(int number, double seconds_left) {
    Worker& worker = workers_[std::size_t(number)];
    if (!worker.gives.empty()) {
        const Order give = worker.gives.front();
        worker.gives.pop_front();
        return give;
    }
    const std::size_t band = first_band_for(number);
    const bool any = band != bands_.size();
    ask_others(number, any ? bands_[band].ordered : limit_);
    if (!any || bands_[band].ordered > 2 * std::uint64_t(least_ordered()) + samples_ahead) return std::nullopt;
    const Order order = piece_from(band, number, paths_of_piece(worker, seconds_left));
    worker.last_paths = std::uint32_t(std::min<std::uint64_t>(paths_of(order.batch), worker.most_paths));
    return order;
}

/// The worker has nothing to do below `level` samples per pixel. Takes over bands of the worker that would end last, so
/// that both end at the same time.
void Dealer::ask_others(int number, std::uint32_t level) {
    std::vector<double> left(workers_.size());  // samples up to the limit
    std::vector<bool> is_behind(workers_.size());
    for (const Band& band : bands_) {
        if (band.holder == nobody || band.leaves) continue;
        left[std::size_t(band.holder)] += double(limit_ - band.ordered) * band.pixels;
        if (band.ordered < level) is_behind[std::size_t(band.holder)] = true;
    }
    const Worker& worker = workers_[std::size_t(number)];
    const double own = worker.speed() > 0 ? left[std::size_t(number)] / worker.speed() : 0;
    int slowest = nobody;
    double longest = 0;
    for (std::size_t w = 0; w < workers_.size(); ++w) {
        const Worker& other = workers_[w];
        if (int(w) == number || !is_behind[w] || other.giving > 0 || other.speed() == 0) continue;
        const double seconds = left[w] / other.speed();
        const double tolerated = std::max(least_piece_seconds, unequal * seconds);
        if (seconds - own > tolerated && seconds > longest) longest = seconds, slowest = int(w);
    }
    if (slowest == nobody) return;
    const double all = left[std::size_t(slowest)];
    if (worker.speed() == 0) {  // a first piece, to measure the speed
        const double passes = std::max(1., double(limit_ - least_ordered()) / largest_pass_);
        return ask(slowest, std::min(all / 2, worker.first_paths * passes));
    }
    const double share = worker.speed() / (worker.speed() + speed(slowest));
    ask(slowest, share * (all + left[std::size_t(number)]) - left[std::size_t(number)]);
}

/// From the end, since workers begin at the front.
void Dealer::ask(int holder, double samples) {
    Worker& worker = workers_[std::size_t(holder)];
    for (std::size_t b = bands_.size(); b-- > 0 && samples > 0;) {
        Band& band = bands_[b];
        if (band.holder != holder || band.leaves || band.ordered >= limit_) continue;
        samples -= double(limit_ - band.ordered) * band.pixels;
        band.leaves = true;
        if (!worker.gives.empty() && worker.gives.back().batch.first_pixel == band.first + band.pixels) {
            worker.gives.back().batch.first_pixel = band.first;
            worker.gives.back().batch.pixels += band.pixels;
            continue;
        }
        Order give{Order::Kind::give};
        give.batch.first_pixel = band.first, give.batch.pixels = band.pixels;
        worker.gives.push_back(give);
        ++worker.giving;
    }
}

std::vector<Order> Dealer::handovers(int worker) {
    std::deque<Order>& gives = workers_[std::size_t(worker)].gives;
    const auto given = std::ptrdiff_t(gives.size());
    std::vector<Order> orders(gives.begin(), gives.end());
    gives.clear();
    for (const Band& band : bands_) {
        if (band.holder != worker || band.leaves || band.known == band.ordered) continue;
        if (std::ssize(orders) > given && orders.back().batch.first_pixel + orders.back().batch.pixels == band.first) {
            orders.back().batch.pixels += band.pixels;
            continue;
        }
        Order read{Order::Kind::read};
        read.batch.first_pixel = band.first, read.batch.pixels = band.pixels;
        orders.push_back(read);
    }
    return orders;
}

void Dealer::done(int number, const Order& order, double seconds) {
    Worker& worker = workers_[std::size_t(number)];
    if (order.kind == Order::Kind::render) {
        for_bands_of(order.batch, [&](Band& band) { band.done += order.batch.samples; });
        done_ += paths_of(order.batch), worker.all += paths_of(order.batch);
        const double window = remembered_passes * largest_pass_ * pixels_ / double(workers_.size());
        const double kept = std::max(0.5, 1 - double(paths_of(order.batch)) / window);
        worker.samples = kept * worker.samples + double(paths_of(order.batch));
        worker.seconds = kept * worker.seconds + std::max(seconds, 1e-9);
        return;
    }
    for_bands_of(order.batch, [&](Band& band) { band.known = band.done; });
    if (order.kind != Order::Kind::give) return;
    --worker.giving;
    for_bands_of(order.batch, [](Band& band) { band.holder = nobody, band.leaves = false; });
}

void Dealer::lost(int number) {
    Worker& worker = workers_[std::size_t(number)];
    worker.is_lost = true, worker.gives.clear(), worker.giving = 0;
    for (Band& band : bands_) {
        if (band.holder != number) continue;
        ordered_ -= std::uint64_t(band.pixels) * (band.ordered - band.known);
        done_ -= std::uint64_t(band.pixels) * (band.done - band.known);
        band.ordered = band.done = band.known;
        band.holder = nobody, band.leaves = false;
    }
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
        if (band.holder == worker || band.done == 0) continue;
        if (!runs.empty() && runs.back().first + runs.back().pixels == band.first)
            runs.back().pixels += band.pixels;
        else
            runs.push_back({band.first, band.pixels, band.done});
    }
    return runs;
}

}  // namespace claray
