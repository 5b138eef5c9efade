#include "host/trace/learning/learning.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <condition_variable>
#include <thread>

#include "host/base/random.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/compute/fork.hpp"
#include "host/trace/learning/better_tree.hpp"
#include "host/trace/learning/comparison.hpp"

namespace claray {
namespace {

// A better tree is built after so many batches at least. Then some are traced in both trees: one for so many that were
// traced before.
constexpr std::uint64_t least_batches = 100, least_turns = 8, most_turns = 64, batches_per_turn = 30;
constexpr std::size_t most_unread = 2 * most_turns;  // if the program never waits, or one queue holds all up

/// Picks one of `of` batches, at irregular places: a program may have a rhythm.
bool picks(std::uint64_t batch, std::uint32_t of) { return scenes::Random(batch).below(of) == 0; }

/// The time of the device between two markers.
double seconds_between(const cl::Event& begin, const cl::Event& end) {
    const auto at = [](const cl::Event& event) { return event.getProfilingInfo<CL_PROFILING_COMMAND_END>(); };
    return (double(at(end)) - double(at(begin))) * 1e-9;
}

/// Counts and times batches of rays, has a better tree built, and traces some batches in both trees. Queries of any
/// thread and queue call `trace`.
class LearningSearch final : public TreeSearch {
public:
    explicit LearningSearch(const Bvh& bvh)
        : bvh_(without_owning(bvh)),
          config_(state_of(bvh).config),
          seconds_to_wait_(bvh.device().tuning("trace/learning", "BUILDS_TO_WAIT_FOR") *
                           seconds_to_build_best(bvh.device(), bvh.triangle_count())) {
        config_.layout = bvh.layout();
    }
    ~LearningSearch() override {
        if (is_forked()) {  // without the thread, which may hold any lock
            if (builder_.joinable()) builder_.detach();
            return;
        }
        stop();
        if (builder_.joinable()) builder_.join();
    }

    void trace(const Device& queue, const Bvh& bvh, std::size_t rays, const std::function<void(const Bvh&)>& trace) {
        if (has_ended_in_vain_) return trace(bvh);
        const Turn turn = begin_turn(queue, rays);
        Times times;
        times.rays = rays, times.better_first = turn.better_first, times.trees = turn.in_both ? 2 : 1;
        if (turn.is_timed) times.marks[0] = queue.event();
        for (unsigned i = 0; i < times.trees; ++i) {
            const bool in_better = turn.in_both ? (i == 0) == turn.better_first : turn.better.has_value();
            in_better ? trace_better(*turn.better, bvh, trace) : trace(bvh);
            if (turn.is_timed) times.marks[i + 1] = queue.event();
        }
        if (turn.is_timed) keep(std::move(times));
    }

    void wait_for_build() {
        std::unique_lock lock(mutex_);
        built_.wait(lock, [this] { return stage_ != Stage::building; });
    }

    void stop() override {
        is_stopped_ = true;
        const std::scoped_lock lock(first_tree_, mutex_);
        end_with({});
    }
    [[nodiscard]] bool has_found() const override {
        const std::lock_guard lock(mutex_);
        return stage_ == Stage::over && better_.has_value();
    }

private:
    enum class Stage { counting, building, comparing, over };

    /// How a batch is traced.
    struct Turn {
        std::optional<Bvh> better;  // instead of the first tree, or in both
        bool in_both = false, better_first = false, is_timed = false;
    };

    /// Of a batch.
    struct Times {
        std::size_t rays = 0;
        unsigned trees = 1;
        bool better_first = false;       // of two trees
        std::array<cl::Event, 3> marks;  // before the first, and after each

        [[nodiscard]] double seconds(unsigned i) const { return seconds_between(marks[i], marks[i + 1]); }
        /// Or failed: its times then cannot be read.
        [[nodiscard]] bool has_ended() const {
            return marks[trees].getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>() <= CL_COMPLETE;
        }
    };

    Turn begin_turn(const Device& queue, std::size_t rays) {
        const std::lock_guard lock(mutex_);
        try {
            read_times();
            if (stage_ == Stage::counting && pays()) begin_build(queue.with_new_queue());
            if (stage_ == Stage::comparing && comparison_.size() >= turns())
                end_with(comparison_.second_pays() ? better_ : std::nullopt);
        } catch (const std::exception&) {  // no times, no memory or no thread: the query itself needs none of them
            end_with({});
        }
        Turn turn;
        if (stage_ == Stage::over) turn.better = better_;
        if (stage_ == Stage::counting) {
            rays_ += double(rays);
            // The first batches may wait for a compiler.
            turn.is_timed = batches_ >= 4 && picks(batches_, batches_ < 64 ? 4 : 16) && times_.size() < most_unread;
            ++batches_;
        } else if (stage_ == Stage::comparing && turns_ < turns() && picks(compared_++, 2)) {
            turn.better = better_, turn.in_both = turn.is_timed = true;
            turn.better_first = std::popcount(turns_++) % 2 != 0;  // as often as not, and in no rhythm (Thue-Morse)
        }
        return turn;
    }

    /// The first tree answers if the other cannot.
    void trace_better(const Bvh& better, const Bvh& first, const std::function<void(const Bvh&)>& trace) {
        try {
            trace(better);
        } catch (const std::exception&) {
            stop();
            trace(first);
        }
    }

    void keep(Times&& times) {
        const std::lock_guard lock(mutex_);
        if (stage_ != Stage::over) times_.push_back(std::move(times));
    }

    void read_times() {
        std::erase_if(times_, [this](const Times& times) {
            if (!times.has_ended()) return false;
            if (times.trees == 2)
                comparison_.add(times.seconds(times.better_first ? 1 : 0), times.seconds(times.better_first ? 0 : 1));
            else
                timed_rays_ += double(times.rays), timed_seconds_ += times.seconds(0);
            return true;
        });
    }

    /// Waits for the time of ten builds. If as much follows, a gain of a tenth pays for the build. If none follows, a
    /// tenth of the time was lost.
    [[nodiscard]] bool pays() const {
        return batches_ >= least_batches && timed_rays_ > 0 && rays_ * timed_seconds_ / timed_rays_ >= seconds_to_wait_;
    }

    /// Number of batches to trace in both trees.
    [[nodiscard]] std::uint64_t turns() const {
        return std::clamp(batches_ / batches_per_turn, least_turns, most_turns);
    }

    void begin_build(const Device& queue) {
        builder_ = std::thread([this, queue] { build(queue); });
        stage_ = Stage::building;
    }

    /// In a thread. An error (too little memory, for example) only ends the search.
    void build(const Device& queue) {
        std::optional<Bvh> better;
        try {
            HeldTriangles triangles;
            {
                const std::lock_guard first_tree(first_tree_);
                if (!is_stopped_) triangles = read_triangles(queue, bvh_);
            }
            if (!is_stopped_) better = build_best(queue, std::move(triangles), config_);
        } catch (const std::exception&) {
        }
        const std::lock_guard lock(mutex_);
        if (!better || is_stopped_)
            end_with({});
        else
            better_ = better, stage_ = Stage::comparing;
        built_.notify_all();
    }

    void end_with(const std::optional<Bvh>& better) {
        better_ = better;
        times_.clear();
        stage_ = Stage::over;
        has_ended_in_vain_ = !better;
    }

    const Bvh bvh_;
    Bvh::Config config_;
    const double seconds_to_wait_;
    std::mutex first_tree_;  // held while the thread reads bvh_, which may change otherwise
    std::atomic<bool> is_stopped_ = false, has_ended_in_vain_ = false;
    std::thread builder_;

    mutable std::mutex mutex_;  // of all that follows
    std::condition_variable built_;
    Stage stage_ = Stage::counting;
    std::uint64_t batches_ = 0, compared_ = 0, turns_ = 0;
    double rays_ = 0, timed_rays_ = 0, timed_seconds_ = 0;
    std::vector<Times> times_;  // not read yet
    Comparison comparison_;
    std::optional<Bvh> better_;
};

bool counts(const QueryOptions& options, const Buffer<std::uint32_t>& count) {
    return !options.brute_force && !options.visits.allocated() && !options.ray_masks.allocated() &&
           options.filter.source.empty() && !count.allocated();
}

}  // namespace

void trace_and_learn(const Device& queue, const Bvh& bvh, const QueryOptions& options, std::size_t rays,
                     const Buffer<std::uint32_t>& count, const std::function<void(const Bvh&)>& trace) {
    Bvh::State& state = state_of(bvh);
    if (!state.learns || !counts(options, count) || rays == 0) return trace(bvh);
    std::call_once(state.search_begun, [&] { state.begin_search(std::make_unique<LearningSearch>(bvh)); });
    static_cast<LearningSearch&>(*state.search()).trace(queue, bvh, rays, trace);
}

void wait_for_build(const Bvh& bvh) {
    if (TreeSearch* search = state_of(bvh).search()) static_cast<LearningSearch&>(*search).wait_for_build();
}

}  // namespace claray
