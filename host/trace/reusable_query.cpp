// Query: the kernels of one structure and one set of options, run many times and on any queue.
#include <optional>

#include "host/compute/device_error.hpp"
#include "host/trace/instance_query.hpp"
#include "host/trace/learning/learning.hpp"
#include "host/trace/lists/filter.hpp"
#include "host/trace/query_kernel.hpp"

namespace claray {

struct Query::State {
    Device device;
    QueryKind kind;
    QueryOptions options;
    std::optional<QueryKernel> flat;  // for a Bvh
    std::optional<InstanceQuery> instanced;
    Bvh bvh;  // as given; with neither of the two for options with a filter
};

namespace {

[[noreturn]] void refuse_results(const Query::State& query, const char* given) {
    const bool any = query.kind == QueryKind::any;
    throw Error(ErrorKind::usage, std::string("a query of this kind does not write ") + given,
                any               ? "pass a buffer of bytes for QueryKind::any"
                : query.instanced ? "pass a buffer of InstanceHit for an InstancedBvh"
                                  : "pass a buffer of Hit for a Bvh");
}

template <class Result>
void check_kind(const Query::State& query) {
    constexpr bool bytes = std::is_same_v<Result, std::uint8_t>, instances = std::is_same_v<Result, InstanceHit>;
    if (bytes != (query.kind == QueryKind::any) || (!bytes && instances != query.instanced.has_value()))
        refuse_results(query, bytes ? "bytes" : instances ? "InstanceHits" : "Hits");
}

template <class T>
void check_buffer(const Device& device, const char* what, const Buffer<T>& buffer) {
    if (!buffer.allocated()) throw Error(ErrorKind::usage, std::string("the query's ") + what + " are not allocated");
    if (buffer.device().context()() != device.context()())
        throw Error(ErrorKind::usage, std::string("the query's ") + what + " belong to another context");
}

template <class Result>
void run_flat(Query::State& query, const Buffer<Ray>& rays, Buffer<Result>& results,
              const Buffer<std::uint32_t>& count) {
    trace_and_learn(query.device, query.bvh, query.options, rays.size(), count, [&](const Bvh& tree) {
        query.flat->trace_in(tree);
        query.flat->run(rays, results, std::uint32_t(rays.size()), count);
        query.flat->trace_in(query.bvh);  // so that it does not keep a tree that others have dropped
    });
}

template <class Result>
cl::Event run_query(Query::State& query, const Buffer<Ray>& rays, Buffer<Result>& results,
                    std::span<const cl::Event> wait_for, const Buffer<std::uint32_t>& count) {
    check_kind<Result>(query);
    check_buffer(query.device, "rays", rays);
    check_buffer(query.device, "results", results);
    if (count.allocated()) check_buffer(query.device, "count", count);
    check_sizes(rays.size(), results.size(), query.options);
    query.device.wait_for(wait_for);
    const auto capacity = std::uint32_t(rays.size());
    if constexpr (std::is_same_v<Result, InstanceHit>)
        query.instanced->run(rays, results, capacity, count, query.options.ray_times);
    else if (query.flat)
        run_flat(query, rays, results, count);
    else if constexpr (std::is_same_v<Result, Hit>)
        closest_accepted(query.device, query.bvh, rays, results, query.options, count);
    else if (query.instanced)
        query.instanced->run(rays, results, capacity, count, query.options.ray_times);
    else
        any_accepted(query.device, query.bvh, rays, results, query.options, count);
    return query.device.event();
}

template <class Result>
void run_on_host(Query::State& query, std::span<const Ray> rays, std::span<Result> results) {
    if (rays.size() != results.size())
        throw Error(ErrorKind::usage, "a query of " + std::to_string(rays.size()) + " rays cannot write " +
                                          std::to_string(results.size()) + " results");
    check_kind<Result>(query);
    const auto device_rays = Buffer<Ray>::over(query.device, rays);
    auto device_results = Buffer<Result>::under(query.device, results);
    static_cast<void>(run_query(query, device_rays, device_results, {}, {}));
    device_results.fetch(results);
}

void check_queue(const Device& of_structure, const Device& queue) try {
    if (of_structure.context()() != queue.context()())
        throw Error(ErrorKind::usage, "the structure and the queue of the query belong to different contexts",
                    "make the queue by with_new_queue of the structure's device");
    // Not Device::finish: threads with queues of their own may get here at once, and the structure's profiler is of
    // one.
    if (of_structure.queue()() != queue.queue()()) of_structure.queue().finish();
} catch (const cl::Error& error) {
    throw_device_error(of_structure, "wait for the structure", error);
}

}  // namespace

Query::Query(const Bvh& bvh, QueryKind kind, const QueryOptions& options, const Device& queue) {
    check_queue(bvh.device(), queue);
    if (options.filter.source.empty())
        state_ = std::make_shared<State>(State{queue, kind, options, QueryKernel(queue, bvh, kind, options), {}, bvh});
    else
        state_ = std::make_shared<State>(State{queue, kind, options, {}, {}, bvh});
}
Query::Query(const Bvh& bvh, QueryKind kind, const QueryOptions& options) : Query(bvh, kind, options, bvh.device()) {}

Query::Query(const InstancedBvh& bvh, QueryKind kind, const QueryOptions& options, const Device& queue) {
    check_queue(bvh.device(), queue);
    state_ = std::make_shared<State>(State{queue, kind, options, {}, InstanceQuery(queue, bvh, kind, options), {}});
}
Query::Query(const InstancedBvh& bvh, QueryKind kind, const QueryOptions& options)
    : Query(bvh, kind, options, bvh.device()) {}

cl::Event Query::run(const Buffer<Ray>& rays, Buffer<Hit>& hits, std::span<const cl::Event> wait_for,
                     const Buffer<std::uint32_t>& count) {
    return run_query(*state_, rays, hits, wait_for, count);
}
cl::Event Query::run(const Buffer<Ray>& rays, Buffer<InstanceHit>& hits, std::span<const cl::Event> wait_for,
                     const Buffer<std::uint32_t>& count) {
    return run_query(*state_, rays, hits, wait_for, count);
}
cl::Event Query::run(const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, std::span<const cl::Event> wait_for,
                     const Buffer<std::uint32_t>& count) {
    return run_query(*state_, rays, occluded, wait_for, count);
}

void Query::run(std::span<const Ray> rays, std::span<Hit> hits) { run_on_host(*state_, rays, hits); }
void Query::run(std::span<const Ray> rays, std::span<InstanceHit> hits) { run_on_host(*state_, rays, hits); }
void Query::run(std::span<const Ray> rays, std::span<std::uint8_t> occluded) { run_on_host(*state_, rays, occluded); }

const Device& Query::device() const { return state_->device; }

}  // namespace claray
