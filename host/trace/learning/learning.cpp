#include "host/trace/learning/learning.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <thread>

#include "host/base/random.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/trace/learning/better_tree.hpp"
#include "host/trace/learning/comparison.hpp"

namespace claray {
namespace {

// A better tree is built after so many batches at least. Then some are traced in both trees, one for so many that were
// traced before: enough to see the kinds of rays of a program in turn, and less than a tenth of the time so far.
constexpr std::uint64_t least_batches = 100, least_turns = 8, most_turns = 64, batches_per_turn = 30;

/// Whether to measure the time of a batch: of some, in no rhythm that the program may have, too. The first ones may
/// wait for a compiler.
bool is_timed(std::uint64_t batch) { return batch >= 4 && scenes::mix(batch) % (batch < 64 ? 4 : 16) == 0; }

/// The time of the device between two markers.
double seconds_between(const cl::Event& begin, const cl::Event& end) {
    const auto at = [](const cl::Event& event) { return event.getProfilingInfo<CL_PROFILING_COMMAND_END>(); };
    return double(at(end) - at(begin)) * 1e-9;
}

/// Counts and times batches of rays, has a better tree built, and traces some batches in both trees. Queries of any
/// thread and queue call `trace`.
class LearningSearch final : public TreeSearch {
public:
    explicit LearningSearch(const Bvh& bvh) : bvh_(without_owning(bvh)) {}
    ~LearningSearch() override {
        stop();
        if (builder_.joinable()) builder_.join();
    }

    void trace(const Device& queue, const Bvh& bvh, std::size_t rays, const std::function<void(const Bvh&)>& trace) {
        Batch batch = begin_batch(queue, bvh, rays);
        if (!batch.is_timed) return trace(batch.trees[0]);
        batch.events[0] = queue.event();
        for (std::size_t i = 0; i < batch.trees.size(); ++i) {
            trace(batch.trees[i]);
            batch.events[i + 1] = queue.event();
        }
        const std::lock_guard lock(mutex_);
        if (stage_ != Stage::over) timed_.push_back(std::move(batch));
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

    struct Batch {
        std::vector<Bvh> trees;  // one or two, in the order in which they are traced
        std::size_t rays = 0;
        bool is_timed = false, better_first = false;
        std::array<cl::Event, 3> events;  // before, between and after

        [[nodiscard]] double seconds(std::size_t i) const { return seconds_between(events[i], events[i + 1]); }
        [[nodiscard]] bool is_complete() const {
            return events[trees.size()].getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>() == CL_COMPLETE;
        }
    };

    static Batch batch_in(std::vector<Bvh> trees, std::size_t rays) {
        Batch batch;
        batch.trees = std::move(trees), batch.rays = rays;
        return batch;
    }

    Batch begin_batch(const Device& queue, const Bvh& bvh, std::size_t rays) {
        const std::lock_guard lock(mutex_);
        try {
            read_times();
            if (stage_ == Stage::counting && pays(queue)) begin_build(queue.with_new_queue());
            if (stage_ == Stage::comparing) compare();
        } catch (const std::exception&) {  // no times, no memory or no thread: the query itself needs none of them
            end_with({});
        }
        if (stage_ == Stage::over && better_) return batch_in({*better_}, rays);
        Batch batch = batch_in({bvh}, rays);
        if (stage_ == Stage::counting) {
            rays_ += double(rays);
            batch.is_timed = is_timed(batches_++);
        } else if (stage_ == Stage::comparing && turns_ < turns()) {
            batch.is_timed = true, batch.better_first = scenes::mix(turns_++) % 2 == 0;
            batch.trees.insert(batch.better_first ? batch.trees.begin() : batch.trees.end(), *better_);
        }
        return batch;
    }

    /// Of the timed batches that are done.
    void read_times() {
        while (!timed_.empty() && timed_.front().is_complete()) {
            const Batch& batch = timed_.front();
            if (batch.trees.size() == 2)
                comparison_.add(batch.seconds(batch.better_first ? 1 : 0), batch.seconds(batch.better_first ? 0 : 1));
            else if (stage_ == Stage::counting)
                timed_rays_ += double(batch.rays), timed_seconds_ += batch.seconds(0);
            timed_.erase(timed_.begin());
        }
    }

    /// After the time of ten builds, a gain of a tenth pays for the build if as many rays follow; if none follow, a
    /// tenth of the time was lost.
    [[nodiscard]] bool pays(const Device& queue) const {
        if (batches_ < least_batches || timed_rays_ == 0) return false;
        const double seconds = rays_ * timed_seconds_ / timed_rays_;
        const unsigned builds = queue.tuning("trace/learning", "BUILDS_TO_WAIT_FOR");
        return seconds >= builds * seconds_to_build_best(queue, bvh_.triangle_count());
    }

    void begin_build(const Device& queue) {
        builder_ = std::thread([this, queue] { build(queue); });
        stage_ = Stage::building;
    }

    /// In a thread. An error (too little memory, for example) only ends the search.
    void build(const Device& queue) {
        std::optional<Bvh> better;
        try {
            TriangleBuffers triangles;
            {
                const std::lock_guard first_tree(first_tree_);
                if (!is_stopped_) triangles = triangles_held(queue, bvh_);
            }
            if (!is_stopped_) better = build_best(queue, bvh_, triangles);
        } catch (const std::exception&) {
        }
        const std::lock_guard lock(mutex_);
        if (!better || is_stopped_)
            end_with({});
        else
            better_ = better, stage_ = Stage::comparing;
        built_.notify_all();
    }

    /// Number of batches that are traced in both trees.
    [[nodiscard]] std::uint64_t turns() const {
        return std::clamp(batches_ / batches_per_turn, least_turns, most_turns);
    }

    void compare() {
        if (comparison_.size() >= turns()) end_with(comparison_.second_pays() ? better_ : std::nullopt);
    }

    void end_with(const std::optional<Bvh>& better) {
        better_ = better;
        timed_.clear();
        stage_ = Stage::over;
    }

    const Bvh bvh_;
    std::mutex first_tree_;  // held while the thread reads bvh_, which may change otherwise
    std::atomic<bool> is_stopped_ = false;
    std::thread builder_;

    mutable std::mutex mutex_;  // of all that follows
    std::condition_variable built_;
    Stage stage_ = Stage::counting;
    std::uint64_t batches_ = 0, turns_ = 0;
    double rays_ = 0, timed_rays_ = 0, timed_seconds_ = 0;
    std::vector<Batch> timed_;  // their times are not read yet
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
    Bvh::State& state = bvh.state();
    if (!state.learns || !counts(options, count) || rays == 0) return trace(bvh);
    std::call_once(state.search_begun, [&] { state.search = std::make_unique<LearningSearch>(bvh); });
    static_cast<LearningSearch&>(*state.search).trace(queue, bvh, rays, trace);
}

void wait_for_build(const Bvh& bvh) {
    if (bvh.state().search) static_cast<LearningSearch&>(*bvh.state().search).wait_for_build();
}

}  // namespace claray
