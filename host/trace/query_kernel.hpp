// A query over arrays of rays: its kernel for one structure and one set of options, and how many items it is run with.
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "host/base/seconds_since.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/compute/programs/kernel_set.hpp"
#include "host/trace/query_options.hpp"
#include "host/trace/ray_order.hpp"

namespace claray {

/// The words of kernels/trace/queue/ray_queue.clh. All queries of a device share them, because its commands run one
/// after another.
[[nodiscard]] const cl::Buffer& ray_queue(const Device& device);

/// Binds only CLARAY_CUTOUTS_PARAMETERS.
struct CutoutsOf {
    const Bvh& bvh;
    void bind(Kernel& kernel, unsigned& index) const { state_of(bvh).bind_cutouts(kernel, index); }
};

/// Binds CLARAY_BVH_PARAMETERS of kernels that treat all triangles as solid.
struct SolidBvh {
    const Bvh& bvh;
    void bind(Kernel& kernel, unsigned& index) const { state_of(bvh).bind_solid(kernel, index); }
};

/// What a query is compiled from.
struct QueryKernels {
    std::vector<KernelRequest> trace;      // one, or two schedules of which one traces the rays
    std::optional<KernelRequest> retrace;  // the rays that met a cut-out
    std::uint32_t batch = 0;               // the largest; 0: rays are not traced in batches
    bool in_queue = false;

    /// Of a tree of triangles; the other parameters are those of QueryKernel.
    QueryKernels(const Device& device, const TreeFormat& tree, QueryKind kind, const QueryOptions& options,
                 const std::string& file = {});
    [[nodiscard]] KernelSet programs(const Device& device) const;
};

class QueryKernel {
public:
    using Kind = QueryKind;

    QueryKernel() = default;
    /// The profiler shows its times under `name`, or under the kernel's name if `name` is empty. `file`: kernels that
    /// include the query's and define the handling of answers (trace/answers.clh); binary layout only.
    QueryKernel(const Bvh& bvh, Kind kind, const QueryOptions& options = {}, const std::string& name = {},
                const std::string& file = {})
        : QueryKernel(bvh.device(), bvh, kind, options, name, file) {}
    /// The same on another queue of the structure's context.
    QueryKernel(const Device& queue, const Bvh& bvh, Kind kind, const QueryOptions& options,
                const std::string& name = {}, const std::string& file = {});

    /// Traces rays in this structure from now on: one of the same layout, without cut-outs if the first has none.
    void trace_in(const Bvh& bvh) { bvh_ = bvh; }

    /// Traces the first min(*count, capacity) rays, or `capacity` if `count` is absent; asynchronous. `results` holds
    /// Hits or, for any hit, bytes or an object that binds the file's parameters for answers.
    template <class Results>
    void run(const Buffer<Ray>& rays, Results& results, std::uint32_t capacity,
             const Buffer<std::uint32_t>& count = {}) {
        if (options_.brute_force) {
            kernels_[0].run({items_for(capacity), group_}, state_of(bvh_).header, state_of(bvh_).leaves,
                            CutoutsOf{bvh_}, rays, results, capacity, arg("count", count),
                            arg("masks", options_.ray_masks));
            return;
        }
        trace(rays, results, capacity, count, order_of(rays, results, capacity, count));
        if (retraces())
            retrace_.run({(std::size_t(capacity) + rays_per_item_ - 1) / rays_per_item_, 1}, bvh_, rays, results,
                         capacity, arg("count", count), arg("masks", options_.ray_masks));
    }

private:
    /// Batches do not support cut-outs: rays that met one are traced again, one by one.
    [[nodiscard]] bool retraces() const { return most_in_batch_ != 0 && state_of(bvh_).has_cutouts(); }

    /// Rays per batch: as tuned, but few enough to keep all compute units busy. 0: no batches.
    [[nodiscard]] std::uint32_t batch_size(std::uint32_t capacity) const;
    [[nodiscard]] std::size_t items_for(std::uint32_t capacity) const;

    /// `order`: numbers of the rays to trace; absent: the first ones.
    template <class Results>
    void trace(const Buffer<Ray>& rays, Results& results, std::uint32_t capacity, const Buffer<std::uint32_t>& count,
               const Buffer<std::uint32_t>& order) {
        const auto run = [&](Kernel& kernel, const auto& structure) {
            kernel.run({items_for(capacity), group_}, structure, rays, results, capacity, arg("count", count),
                       arg("masks", options_.ray_masks), options_.visits, ray_queue(*device_), batch_size(capacity),
                       arg("sorted", order));
        };
        if (retraces()) return run(kernels_[0], SolidBvh{bvh_});
        for (Kernel& kernel : kernels_) run(kernel, bvh_);
    }

    /// The order in which rays are traced, or no buffer. Waits for the device if it has to find out whether an order
    /// pays: sorting takes as long as tracing short rays, so that some of them are traced first.
    template <class Results>
    [[nodiscard]] Buffer<std::uint32_t> order_of(const Buffer<Ray>& rays, Results& results, std::uint32_t capacity,
                                                 const Buffer<std::uint32_t>& count) {
        if (!may_sort(capacity, count) || !ray_order_->has_none(bvh_, rays, capacity)) return {};
        const Buffer<std::uint32_t>& some = ray_order_->sample(capacity, sample_size());
        const auto trace_some = [&] {
            trace(rays, results, sample_size(), {}, some);
            device_->finish();
        };
        if (!std::exchange(has_sampled_, true)) trace_some();  // a driver loads a kernel when it first runs
        const auto begin = std::chrono::steady_clock::now();
        trace_some();
        if (seconds_since(begin) < least_seconds_to_sort()) return {};
        return ray_order_->sort(bvh_, rays, capacity);
    }
    /// Whether there are so many rays, and nobody says that they are in order. Makes `ray_order_`.
    [[nodiscard]] bool may_sort(std::uint32_t capacity, const Buffer<std::uint32_t>& count);
    /// Rays that are traced first: so many for each compute unit that a launch takes a small part of their time.
    static constexpr std::uint32_t sampled_by_unit = 2048;
    [[nodiscard]] std::uint32_t sample_size() const {
        return sampled_by_unit * std::max(1u, device_->info().compute_units);
    }
    /// Of tracing these.
    [[nodiscard]] double least_seconds_to_sort() const;

    std::optional<Device> device_;  // with the queue
    Bvh bvh_;
    QueryOptions options_;
    std::vector<Kernel> kernels_;  // one, or two schedules of which one traces the rays
    Kernel retrace_;
    std::shared_ptr<RayOrder> ray_order_;
    std::size_t rays_per_item_ = 1, group_ = 64, most_items_ = std::size_t(-1);
    std::uint32_t most_in_batch_ = 0, sort_from_ = 0, sort_from_nanoseconds_ = 0;
    bool has_sampled_ = false;
};

}  // namespace claray
