// claray.h: instances.
#include "claray/instances.hpp"

#include "host/capi/capi.hpp"

using namespace claray;
using namespace claray::capi;

struct claray_instances {
    InstancedBvh bvh;
    std::size_t bottoms;
};

namespace {

static_assert(sizeof(claray_instance_hit) == sizeof(InstanceHit));

std::vector<Instance> instances_of(std::span<const claray_instance> given, std::size_t bottoms) {
    std::vector<Instance> instances;
    for (const claray_instance& one : given) {
        if (one.bottom >= bottoms)
            throw Error(ErrorKind::usage, "instances: instance " + std::to_string(instances.size()) +
                                              " has the structure " + std::to_string(one.bottom) + " of " +
                                              std::to_string(bottoms));
        Instance& instance = instances.emplace_back();
        std::copy(one.transform, one.transform + 4, instance.row0);
        std::copy(one.transform + 4, one.transform + 8, instance.row1);
        std::copy(one.transform + 8, one.transform + 12, instance.row2);
        instance.bottom = one.bottom, instance.mask = one.mask;
    }
    return instances;
}

}  // namespace

claray_status claray_instances_build(const claray_bvh* const* bvhs, size_t bvh_count, const claray_instance* instances,
                                     size_t count, claray_instances** placed) {
    return guarded([&] {
        std::vector<Bvh> bottoms;
        for (const claray_bvh* bvh : array(bvhs, bvh_count, "bvhs")) bottoms.push_back(required(bvh, "bvhs").bvh);
        const std::vector<Instance> all = instances_of(array(instances, count, "instances"), bvh_count);
        hand_out(placed, "placed", [&] { return new claray_instances{InstancedBvh::build(bottoms, all), bvh_count}; });
    });
}

claray_status claray_instances_move(claray_instances* placed, const claray_instance* instances, size_t count,
                                    int rebuild) {
    return guarded([&] {
        InstancedBvh& moved = required(placed, "placed").bvh;
        if (count != moved.instance_count())
            throw Error(ErrorKind::usage, "count is " + std::to_string(count) + ", and there are " +
                                              std::to_string(moved.instance_count()) + " instances");
        Buffer<Instance> memory = moved.instances();
        memory.write(instances_of(array(instances, count, "instances"), placed->bottoms));
        rebuild != 0 ? moved.rebuild() : moved.refit();
    });
}

claray_status claray_query_instances_create(const claray_instances* placed, claray_query_kind kind,
                                            const claray_query_options* options, claray_device* queue,
                                            claray_query** query) {
    return guarded([&] {
        const InstancedBvh& over = required(placed, "placed").bvh;
        hand_out(query, "query", [&] {
            Query made(over, kind_of(kind), options_of(options), queue ? queue->device : over.device());
            return new claray_query{kind, std::move(made), true};  // `kind` is checked
        });
    });
}

void claray_instances_release(claray_instances* placed) { delete placed; }
