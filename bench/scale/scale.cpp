// How far rank 0 can deal: the dealer of claray with simulated ranks. The time that the dealer itself takes is
// measured; speed, overhead of a piece and network are given, as measured on one machine (docs/scale.md).
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <queue>
#include <random>

#include "host/accuracy/svg.hpp"
#include "host/base/file.hpp"
#include "host/scale/dealer.hpp"

namespace claray {
namespace {

struct Setting {
    unsigned width = 1920, height = 1080, spp = 4096;
    double speed = 1e7;      // samples per second of a rank
    double overhead = 1e-3;  // seconds of a piece
    double unequal = 0.2;    // ranks differ in speed by up to this share
    double latency = 5e-5;   // seconds of a message
    double bandwidth = 1e9;  // bytes per second of rank 0's link
    double spread = 2;       // cost of the dearest pixel over the cheapest
};

struct Result {
    double seconds = 0, ideal = 0, dealing = 0, sending = 0;  // the last two: of rank 0
    double orders = 0, bytes = 0;
};

constexpr double message_bytes = 64;
constexpr std::size_t most_orders = 4;
constexpr std::size_t most_refused = 8;  // idle ranks asked after a report, as RenderGroup does

class Simulation {
public:
    Simulation(const Setting& setting, unsigned ranks)
        : setting_(setting),
          pixels_(setting.width * setting.height),
          dealer_({{0, pixels_, 0}}, 16, std::max(4096u, 16 * ranks)),
          ranks_(ranks) {
        std::mt19937 random(1);
        std::uniform_real_distribution<double> part(1 - setting.unequal, 1);
        for (Rank& rank : ranks_) {
            rank.speed = setting.speed * part(random);
            dealer_.add(2048, 1u << 20);
        }
        dealer_.set_limit(setting.spp);
    }

    Result run() {
        for (std::size_t r = 0; r < ranks_.size(); ++r) deal(r);
        while (!dealer_.finished() && !reports_.empty()) {
            const auto [time, r] = reports_.top();
            reports_.pop();
            free_ = std::max(free_, time);
            take_report(r);
            deal(r);
            for (std::size_t i = std::min(idle_.size(), most_refused); i-- > 0;) {
                const std::size_t other = idle_.front();
                idle_.pop_front();
                deal(other);
            }
        }
        for (std::size_t r = 1; r < ranks_.size(); ++r)  // the image
            for (const Order& order : dealer_.handovers(int(r))) send(order.batch.pixels * sizeof(FilmPixel));
        double speed = 0;
        for (const Rank& rank : ranks_) speed += rank.speed;
        result_.ideal = double(pixels_) * setting_.spp / speed;
        result_.seconds = free_;
        return result_;
    }

private:
    struct Rank {
        double speed = 0, end = 0;  // when its last order ends
        std::deque<std::pair<Order, double>> orders;
    };
    using Clock = std::chrono::steady_clock;

    /// Rank 0 does one thing after the other.
    template <class Work>
    auto on_rank_0(const Work& work) {
        const Clock::time_point begin = Clock::now();
        auto result = work();
        const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        free_ += seconds, result_.dealing += seconds;
        return result;
    }
    void send(double bytes) {
        const double seconds = (message_bytes + bytes) / setting_.bandwidth;
        free_ += seconds, result_.sending += seconds, result_.bytes += message_bytes + bytes;
    }
    /// Pixels at the bottom cost more than those at the top, as floors do.
    [[nodiscard]] double seconds_of(const Order& order, const Rank& rank) const {
        if (order.kind != Order::Kind::render) return 1e-4;
        const double middle = (order.batch.first_pixel + 0.5 * order.batch.pixels) / pixels_;
        const double cost = 2 * (1 + (setting_.spread - 1) * middle) / (1 + setting_.spread);
        return setting_.overhead + cost * order.batch.pixels * order.batch.samples / rank.speed;
    }
    void deal(std::size_t r) {
        Rank& rank = ranks_[r];
        while (rank.orders.size() < most_orders) {
            const auto order = on_rank_0([&] {
                const std::optional<Order> next = dealer_.next(int(r), 1e9);
                return next || r == 0 ? next : dealer_.read_finished(int(r));
            });
            if (!order) {
                if (rank.orders.empty()) idle_.push_back(r);
                return;
            }
            ++result_.orders;
            send(order->brings_sums ? order->batch.pixels * double(sizeof(FilmPixel)) : 0);
            const double seconds = seconds_of(*order, rank);
            rank.end = std::max(rank.end, free_ + setting_.latency) + seconds;
            rank.orders.emplace_back(*order, seconds);
            reports_.emplace(rank.end + setting_.latency, r);
        }
    }
    void take_report(std::size_t r) {
        const auto [order, seconds] = ranks_[r].orders.front();
        ranks_[r].orders.pop_front();
        if (order.kind != Order::Kind::render) send(order.batch.pixels * double(sizeof(FilmPixel)));
        on_rank_0([&, o = order, s = seconds] { return dealer_.done(int(r), o, s), 0; });
    }

    using Event = std::pair<double, std::size_t>;
    Setting setting_;
    std::uint32_t pixels_;
    Dealer dealer_;
    std::vector<Rank> ranks_;
    std::deque<std::size_t> idle_;
    std::priority_queue<Event, std::vector<Event>, std::greater<>> reports_;
    double free_ = 0;  // when rank 0 has time
    Result result_;
};

/// Efficiencies by number of ranks, for one number of samples per pixel.
struct Curve {
    unsigned spp;
    std::vector<std::pair<unsigned, double>> points;
};

Curve simulate(Setting setting, unsigned spp, const std::vector<unsigned>& counts) {
    setting.spp = spp;
    Curve curve{spp, {}};
    std::printf("%u samples per pixel\n%6s %10s %10s %8s %12s %12s %10s %10s\n", spp, "ranks", "seconds", "efficiency",
                "orders", "ms a piece", "dealing, %", "sending, %", "MB");
    for (const unsigned ranks : counts) {
        const Result r = Simulation(setting, ranks).run();
        std::printf("%6u %10.3f %10.3f %8.0f %12.2f %12.2f %10.2f %10.1f\n", ranks, r.seconds, r.ideal / r.seconds,
                    r.orders, 1e3 * r.seconds * ranks / r.orders, 100 * r.dealing / r.seconds,
                    100 * r.sending / r.seconds, 1e-6 * r.bytes);
        curve.points.emplace_back(ranks, r.ideal / r.seconds);
    }
    return curve;
}

/// Efficiency over the ranks, whose axis is logarithmic.
std::string plot(const std::vector<Curve>& curves, unsigned most_ranks) {
    constexpr double width = 760, height = 420, left = 70, right = 180, top = 30, bottom = 60;
    constexpr const char *ink = "#222", *pale = "#666", *grid = "#e4e4e4";
    constexpr std::array colors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7"};  // Okabe and Ito 2008
    const auto x = [&](unsigned ranks) {
        return left + (width - left - right) * std::log2(ranks) / std::max(1., std::log2(most_ranks));
    };
    const auto y = [&](double efficiency) { return height - bottom - (height - top - bottom) * efficiency; };
    std::string svg = svg::begin(width, height);
    for (unsigned ranks = 1; ranks <= most_ranks; ranks *= 2) {
        svg += svg::rectangle(x(ranks), top, 1, height - top - bottom, grid);
        svg += svg::text(x(ranks), height - bottom + 18, "middle", 12, pale, std::to_string(ranks));
    }
    for (int tenth = 0; tenth <= 10; tenth += 2) {
        svg += svg::rectangle(left, y(0.1 * tenth), width - left - right, 1, grid);
        svg += svg::text(left - 8, y(0.1 * tenth) + 4, "end", 12, pale, printed("%.1f", 0.1 * tenth));
    }
    svg += svg::text((left + width - right) / 2, height - 18, "middle", 13, ink, "ranks");
    svg += svg::text(left, 18, "start", 13, ink, "speed over the sum of the ranks' speeds (simulation)");
    for (std::size_t c = 0; c < curves.size(); ++c) {
        const char* color = colors[c % colors.size()];
        std::string line;
        for (const auto& [ranks, efficiency] : curves[c].points) {
            line += printed("%.1f,%.1f ", x(ranks), y(efficiency));
            svg += printed("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" fill=\"%s\"/>\n", x(ranks), y(efficiency), color);
        }
        svg += "<polyline points=\"" + line + "\" fill=\"none\" stroke=\"" + color + "\" stroke-width=\"2\"/>\n";
        const auto& [ranks, efficiency] = curves[c].points.back();
        svg += svg::text(x(ranks) + 10, y(efficiency) + 4, "start", 12, color,
                         std::to_string(curves[c].spp) + " samples per pixel");
    }
    return svg + "</svg>\n";
}

}  // namespace
}  // namespace claray

int main(int argc, char** argv) {
    using namespace claray;
    CLI::App app{"The efficiency of many ranks, by simulation with the real dealer."};
    Setting setting;
    std::string svg;
    std::vector<unsigned> spps = {1024, 16384};
    std::vector<unsigned> counts = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024};
    app.add_option("--ranks", counts, "Numbers of ranks")->delimiter(',')->check(CLI::Range(1u, 1u << 20));
    app.add_option("--width", setting.width, "Pixels");
    app.add_option("--height", setting.height, "Pixels");
    app.add_option("--spp", spps, "Samples per pixel; may be a list")->delimiter(',');
    app.add_option("--speed", setting.speed, "Samples per second of the fastest rank");
    app.add_option("--overhead", setting.overhead, "Seconds of a piece besides its samples");
    app.add_option("--latency", setting.latency, "Seconds of a message");
    app.add_option("--bandwidth", setting.bandwidth, "Bytes per second of rank 0's link");
    app.add_option("--svg", svg, "Also write a plot of the efficiencies to this file");
    CLI11_PARSE(app, argc, argv);
    std::vector<Curve> curves;
    for (const unsigned spp : spps) curves.push_back(simulate(setting, spp, counts));
    if (!svg.empty()) write_file(svg, plot(curves, *std::max_element(counts.begin(), counts.end())));
}
