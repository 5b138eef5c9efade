// The dealer, with workers of simulated speed.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "host/scale/dealer.hpp"

namespace claray::test {
namespace {

/// Workers that carry out up to three orders one after the other, each at its speed in samples per second.
class Simulation {
public:
    /// The last worker begins at the time `last_begins`.
    Simulation(std::uint32_t pixels, std::uint32_t spp, std::vector<double> speeds, double last_begins = 0)
        : samples_(pixels),
          known_(pixels),
          speeds_(std::move(speeds)),
          last_begins_(last_begins),
          dealer_({{0, pixels, 0}}, 16) {
        held_.assign(speeds_.size(), std::vector<std::uint32_t>(pixels));
        for (std::size_t w = 0; w + 1 < speeds_.size() || (last_begins == 0 && w < speeds_.size()); ++w) add();
        dealer_.expect(unsigned(speeds_.size()));
        dealer_.set_limit(spp);
    }

    /// Returns the time until all is done. Worker `lost` disappears at the time `at`.
    double run(int lost = -1, double at = 0) {
        while (!dealer_.finished()) {
            for (std::size_t w = 0; w < workers_.size(); ++w) deal(int(w));
            std::size_t next = workers_.size();
            for (std::size_t w = 0; w < workers_.size(); ++w)
                if (!workers_[w].orders.empty() && (next == workers_.size() || workers_[w].end < workers_[next].end))
                    next = w;
            if (next == workers_.size()) return NAN;  // nobody has anything to do
            now_ = workers_[next].end;
            if (workers_.size() < speeds_.size() && now_ >= last_begins_) add();
            if (++events_ % 64 == 0 && !any_lost_) check_first_worker();
            if (lost >= 0 && now_ >= at) {
                workers_[std::size_t(lost)].orders.clear(), workers_[std::size_t(lost)].is_lost = true;
                dealer_.lost(lost);
                lost = -1, any_lost_ = true;
                continue;
            }
            finish(next);
        }
        return now_;
    }
    [[nodiscard]] double ideal(std::uint64_t samples) const {
        return double(samples) / std::accumulate(speeds_.begin(), speeds_.end(), 0.);
    }
    [[nodiscard]] const std::vector<std::uint32_t>& samples() const { return samples_; }
    [[nodiscard]] Dealer& dealer() { return dealer_; }
    std::uint64_t moved = 0;  // pixels

private:
    struct Worker {
        std::deque<Order> orders;
        double end = 0;  // of the first order
        bool is_lost = false;
    };

    /// Together with the sums that it lacks, and those that come with its orders, the first worker has all.
    void check_first_worker() const {
        std::vector<std::uint32_t> samples = held_[0];
        const auto take = [&](std::uint32_t first, std::uint32_t pixels) {
            std::copy_n(samples_.begin() + first, pixels, samples.begin() + first);
        };
        for (const PixelRun& run : dealer_.held_by_others(0)) take(run.first, run.pixels);
        for (const Order& order : workers_[0].orders)
            if (order.brings_sums) take(order.batch.first_pixel, order.batch.pixels);
        ASSERT_EQ(samples, samples_);
    }
    void add() {
        dealer_.add(2048, 1u << 22);
        workers_.emplace_back();
    }
    [[nodiscard]] double seconds_of(const Order& order, std::size_t w) const {
        return order.kind == Order::Kind::render ? double(order.batch.pixels) * order.batch.samples / speeds_[w] : 1e-5;
    }
    void deal(int w) {
        Worker& worker = workers_[std::size_t(w)];
        while (!worker.is_lost && worker.orders.size() < 3) {
            std::optional<Order> order = dealer_.next(w, 1e9);
            if (!order && w > 0) order = dealer_.read_finished(w);
            if (!order) return;
            if (worker.orders.empty()) worker.end = now_ + seconds_of(*order, std::size_t(w));
            worker.orders.push_back(*order);
        }
    }
    /// The samples of each pixel must follow those that its worker holds, or that came with the order.
    void finish(std::size_t w) {
        Worker& worker = workers_[w];
        const Order order = worker.orders.front();
        worker.orders.pop_front();
        const Batch& b = order.batch;
        for (std::uint32_t p = b.first_pixel; p < b.first_pixel + b.pixels; ++p) {
            if (order.kind != Order::Kind::render) {
                known_[p] = held_[w][p], ++moved;
                continue;
            }
            if (order.brings_sums) held_[w][p] = known_[p];
            ASSERT_EQ(held_[w][p], b.first_sample) << "pixel " << p;
            held_[w][p] += b.samples, samples_[p] = held_[w][p];
        }
        dealer_.done(int(w), order, seconds_of(order, w));
        if (!worker.orders.empty()) worker.end = now_ + seconds_of(worker.orders.front(), w);
    }

    std::vector<std::uint32_t> samples_, known_;    // of each pixel: so far; in the sums that were handed over
    std::vector<std::vector<std::uint32_t>> held_;  // by each worker
    std::vector<double> speeds_;
    std::vector<Worker> workers_;
    double last_begins_;
    unsigned events_ = 0;
    bool any_lost_ = false;
    double now_ = 0;
    Dealer dealer_;
};

/// A worker that has nothing to render hands over the sums of what it has finished, each pixel's once.
TEST(Dealer, AsksForTheSumsOfFinishedPixelsOnce) {
    constexpr std::uint32_t pixels = 300'000;
    Dealer dealer({{0, pixels, 0}}, 16);
    dealer.add(pixels, 1u << 24);
    for (const std::uint32_t limit : {1u, 2u}) {
        dealer.set_limit(limit);
        const Order render = *dealer.next(0, 1e9);
        EXPECT_FALSE(dealer.read_finished(0)) << "nothing is finished";
        dealer.done(0, render, 1e-3);
        std::uint32_t next = 0;
        while (const std::optional<Order> order = dealer.read_finished(0)) {
            EXPECT_EQ(order->kind, Order::Kind::read);
            EXPECT_EQ(order->batch.first_pixel, next);
            next += order->batch.pixels;
            dealer.done(0, *order, 1e-3);
        }
        EXPECT_EQ(next, pixels);
        EXPECT_TRUE(dealer.handovers(0).empty());
    }
}

TEST(Dealer, KeepsWorkersOfAllSpeedsBusy) {
    constexpr std::uint32_t pixels = 480 * 270;
    for (const std::vector<double>& speeds : {std::vector<double>{1e7},
                                              {1e7, 1e7},
                                              {1e7, 1e5},
                                              {1e8, 1e6, 3e6},
                                              {3e6, 1e6, 1e6, 1e6, 2e6, 7e5, 1e6, 1e6}}) {
        const std::uint32_t spp = speeds[0] > 1e7 ? 1024 : 256;  // about a second
        Simulation simulation(pixels, spp, speeds);
        const double seconds = simulation.run();
        EXPECT_GE(simulation.ideal(std::uint64_t(pixels) * spp) / seconds, 0.95) << speeds.size() << " workers";
        EXPECT_EQ(simulation.samples(), std::vector<std::uint32_t>(pixels, spp));
        EXPECT_LT(simulation.moved, 4 * pixels) << "pixels seldom move";
    }
}

TEST(Dealer, GivesOnePieceUntilTheSpeedIsKnown) {
    Dealer dealer({{0, 10'000, 0}}, 16);
    dealer.add(1000, 1u << 20);
    dealer.set_limit(64);
    const std::optional<Order> first = dealer.next(0, 1e9);
    ASSERT_TRUE(first);
    EXPECT_LE(first->batch.pixels, 1000u);
    EXPECT_FALSE(dealer.next(0, 1e9));
    dealer.done(0, *first, 1e-3);
    EXPECT_TRUE(dealer.next(0, 1e9));
    EXPECT_TRUE(dealer.next(0, 1e9));
}

/// Workers hold a copy of the sums of an order.
TEST(Dealer, AsksForFewSumsAtATime) {
    constexpr std::uint32_t pixels = 300'000, most = 1u << 16;
    Dealer dealer({{0, pixels, 0}}, 16);
    dealer.add(pixels, 1u << 24);
    dealer.set_limit(1);
    dealer.done(0, *dealer.next(0, 1e9), 1e-3);
    std::uint32_t next = 0;
    for (const Order& order : dealer.handovers(0)) {
        EXPECT_EQ(order.batch.first_pixel, next);
        EXPECT_LE(order.batch.pixels, most);
        next += order.batch.pixels;
    }
    EXPECT_EQ(next, pixels);
}

/// Nobody waits for another one's first samples, although one could begin with the whole image.
TEST(Dealer, GivesAllSomethingAtFirst) {
    constexpr std::uint32_t pixels = 61 * 43;
    Dealer dealer({{0, pixels, 0}}, 16);
    for (int w = 0; w < 4; ++w) dealer.add(1u << 20, 1u << 20);
    dealer.lost(2);
    dealer.set_limit(37);
    for (const int w : {0, 1, 3}) {
        const std::optional<Order> order = dealer.next(w, 1e9);
        ASSERT_TRUE(order) << w;
        EXPECT_GE(order->batch.pixels, pixels / 6) << w;
        EXPECT_LE(order->batch.pixels, pixels / 3 + 16) << w;
    }
}

/// Another one that took all pixels gives some at once, and soon as many as the speeds are worth.
TEST(Dealer, GivesLateWorkersSomethingSoon) {
    constexpr std::uint32_t pixels = 640 * 360, spp = 64;
    constexpr double speed = 1.4e7, late = 0.015;
    Simulation simulation(pixels, spp, {speed, speed}, late);
    const double ideal = (double(pixels) * spp / speed + late) / 2;
    EXPECT_GE(ideal / simulation.run(), 0.97);
    EXPECT_EQ(simulation.samples(), std::vector<std::uint32_t>(pixels, spp));
}

/// Handing over the sums of all pixels takes 10 ms here.
TEST(Dealer, LeavesOutWorkersThatDoNotPay) {
    constexpr std::uint32_t pixels = 10'000;
    const auto works = [](std::uint32_t spp, double speed, double seconds_left, bool other_is_lost = false) {
        Dealer dealer({{0, pixels, 0}}, 16);
        dealer.add(1000, 1u << 20), dealer.add(1000, 1u << 20, 1e-6);
        dealer.set_limit(spp);
        EXPECT_FALSE(dealer.next(1, seconds_left)) << "the speed of the other one is unknown";
        const std::optional<Order> order = dealer.next(0, seconds_left);
        dealer.done(0, *order, order->batch.pixels * order->batch.samples / speed);
        if (other_is_lost) dealer.lost(0);
        return dealer.next(1, seconds_left).has_value();
    };
    EXPECT_TRUE(works(16, 1e6, 1e9)) << "0.16 s";
    EXPECT_FALSE(works(16, 1e8, 1e9)) << "2 ms";
    EXPECT_FALSE(works(16, 1e6, 5e-3)) << "the time is up before";
    EXPECT_TRUE(works(16, 1e8, 1e9, true)) << "nobody else is there";
}

/// They take equal parts until their speeds are known, so that none of them gives much of it to the other.
TEST(Dealer, LetsAllBeginALongRender) {
    constexpr std::uint32_t pixels = 10'000;
    Dealer dealer({{0, pixels, 0}}, 16);
    dealer.add(1000, 1u << 20), dealer.add(1000, 1u << 20, 1e-6);
    dealer.set_limit(64);
    const Order first = *dealer.next(0, 1e9);
    ASSERT_TRUE(dealer.next(1, 1e9)) << "before the speed of the other one is known";
    std::uint32_t taken = 0;
    for (Order order = first; order.batch.samples > 0;) {
        if (order.batch.first_sample == 0) taken += order.batch.pixels;
        dealer.done(0, order, 1e-3);
        order = dealer.next(0, 1e9).value_or(Order());
    }
    EXPECT_LE(taken, pixels / 2 + 16);
}

TEST(Dealer, RendersAgainWhatIsLost) {
    constexpr std::uint32_t pixels = 10'000, spp = 77;
    for (const double at : {0., 0.1, 0.3, 0.5}) {
        Simulation simulation(pixels, spp, {1e6, 4e5});
        EXPECT_GT(simulation.run(1, at), at);
        EXPECT_EQ(simulation.samples(), std::vector<std::uint32_t>(pixels, spp)) << at;
        const std::vector<PixelRun> rendered = simulation.dealer().rendered();
        ASSERT_EQ(rendered.size(), 1u);
        EXPECT_EQ(rendered[0].samples, spp);
    }
}

TEST(Dealer, HasThePassesOfASchedule) {
    const Dealer dealer({{0, 100, 0}}, 16);
    const std::vector<std::uint32_t> ends = {1, 2, 4, 8, 16, 32, 48, 64};
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) EXPECT_EQ(dealer.end_of_pass(ends[i] + 1), ends[i + 1]);
    EXPECT_EQ(dealer.end_of_pass(0), 1u);
    EXPECT_EQ(dealer.end_of_pass(4'000'001), 4'000'016u);
}

/// Samples that some pixels have already are not rendered again.
TEST(Dealer, GoesOnWhereRunsEnd) {
    Dealer dealer({{0, 50, 8}, {50, 1, 3}, {51, 49, 2}}, 16);
    dealer.add(1u << 20, 1u << 20);
    dealer.set_limit(8);
    EXPECT_EQ(dealer.least(), 2u);
    std::uint64_t samples = 0;
    while (!dealer.finished()) {
        const std::optional<Order> order = dealer.next(0, 1e9);
        ASSERT_TRUE(order);
        EXPECT_TRUE(order->brings_sums || order->batch.first_sample >= 4);
        samples += std::uint64_t(order->batch.pixels) * order->batch.samples;
        dealer.done(0, *order, 1e-6);
    }
    EXPECT_EQ(samples, 5u + 49 * 6u);
    EXPECT_EQ(dealer.rendered().size(), 1u);
    EXPECT_EQ(dealer.known().size(), 3u);
}

}  // namespace
}  // namespace claray::test
