#include "host/trace/learning/learning.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <thread>

#include "host/bvh/bvh_state.hpp"
#include "host/trace/learning/better_tree.hpp"

namespace claray {
namespace {

/// Queries of any thread and queue call `tree`. One thread at a time estimates, builds and compares.
class LearningSearch final : public TreeSearch {
public:
    explicit LearningSearch(const Bvh& bvh)
        : bvh_(without_owning(bvh)),
          sample_(bvh.device()),
          wanted_(std::max(2.0 * double(sample_.capacity()), 4.0 * double(bvh.triangle_count()))) {}
    ~LearningSearch() override {
        stop();
        if (thread_.joinable()) thread_.join();
    }

    Bvh tree(const Device& queue, const Bvh& bvh, QueryKind kind, const QueryOptions& options,
             const Buffer<Ray>& rays) {
        const std::lock_guard lock(mutex_);
        if (found_) return *found_;
        if (is_working_ || is_over_) return bvh;
        rays_ += double(rays.size());
        try {
            if (2 * rays_ >= wanted_) sample_.add(queue, kind, options, rays);
            if (rays_ >= wanted_) begin_work(queue.with_new_queue());
        } catch (const std::exception&) {  // too little memory, or no thread: the query itself needs neither
            is_over_ = true;
        }
        return bvh;
    }

    void wait() {
        std::unique_lock lock(mutex_);
        ended_.wait(lock, [this] { return !is_working_; });
    }

    void stop() override {
        is_stopped_ = true;
        const std::scoped_lock lock(first_tree_, mutex_);
        found_.reset();
        sample_.clear();
        is_over_ = true;
    }
    [[nodiscard]] bool has_found() const override {
        const std::lock_guard lock(mutex_);
        return found_.has_value();
    }

private:
    void begin_work(const Device& queue) {
        if (thread_.joinable()) thread_.join();  // its work has ended
        thread_ = std::thread([this, queue] { work(queue); });
        is_working_ = true;
    }

    /// An error (too little memory, for example) only ends the search: the first tree answers all queries.
    void work(const Device& queue) {
        std::optional<Bvh> found;
        bool is_over = true;
        try {
            is_over = pays(queue);
            if (is_over) found = find(queue);
        } catch (const std::exception&) {
        }
        const std::lock_guard lock(mutex_);
        if (!is_stopped_) found_ = found;
        if (is_over) sample_.clear();
        is_over_ = is_over || is_stopped_;
        is_working_ = false;
        ended_.notify_all();
    }

    /// Whether the rays so far took long enough; if not, they are counted until they may have. After the time of ten
    /// builds, a gain of a tenth pays for the build if as many rays follow; if none follow, a tenth of the time was
    /// lost.
    bool pays(const Device& queue) {
        const std::lock_guard first_tree(first_tree_);
        if (is_stopped_) return false;
        for (const RaySample::Piece& piece : sample_.pieces()) queue.wait_for({&piece.copied, 1});
        const double seconds =
            queue.tuning("trace/learning", "BUILDS_TO_WAIT_FOR") * seconds_to_build_best(queue, bvh_.triangle_count());
        const double needed = seconds / seconds_per_ray(queue, bvh_, sample_.pieces());
        const std::lock_guard lock(mutex_);
        if (rays_ >= needed) return true;
        wanted_ = needed;
        return false;
    }

    std::optional<Bvh> find(const Device& queue) {
        TriangleBuffers triangles;
        {
            const std::lock_guard first_tree(first_tree_);
            if (is_stopped_) return {};
            triangles = triangles_held(queue, bvh_);
        }
        const Bvh better = build_best(queue, bvh_, triangles);
        const std::lock_guard first_tree(first_tree_);
        if (!is_faster(queue, bvh_, better, sample_.pieces(), [this] { return bool(is_stopped_); })) return {};
        return better;
    }

    Bvh bvh_;
    std::mutex first_tree_;  // held while the thread uses bvh_, which may change otherwise
    std::atomic<bool> is_stopped_ = false;

    mutable std::mutex mutex_;  // of all that follows; the sample belongs to the thread while it works
    std::condition_variable ended_;
    RaySample sample_;
    double rays_ = 0, wanted_;
    bool is_working_ = false, is_over_ = false;
    std::optional<Bvh> found_;
    std::thread thread_;
};

bool counts(const QueryOptions& options, const Buffer<std::uint32_t>& count) {
    return !options.brute_force && !options.visits.allocated() && !options.ray_masks.allocated() &&
           options.filter.source.empty() && !count.allocated();
}

}  // namespace

Bvh learned_tree(const Device& queue, const Bvh& bvh, QueryKind kind, const QueryOptions& options,
                 const Buffer<Ray>& rays, const Buffer<std::uint32_t>& count) {
    Bvh::State& state = bvh.state();
    if (!state.learns || !counts(options, count)) return bvh;
    std::call_once(state.search_begun, [&] { state.search = std::make_unique<LearningSearch>(bvh); });
    return static_cast<LearningSearch&>(*state.search).tree(queue, bvh, kind, options, rays);
}

void wait_for_search(const Bvh& bvh) {
    if (bvh.state().search) static_cast<LearningSearch&>(*bvh.state().search).wait();
}

}  // namespace claray
