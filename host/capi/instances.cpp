// claray.h: instances.
#include "claray/instances.hpp"

#include "host/capi/capi.hpp"

using namespace claray;
using namespace claray::capi;

struct claray_instances {
    InstancedBvh bvh;
    std::size_t bottoms;
};
struct claray_flat_instances {
    FlatInstances flat;
    std::vector<claray_instance> members;
};

namespace {

static_assert(sizeof(claray_instance_hit) == sizeof(InstanceHit));

std::vector<Instance> instances_of(std::span<const claray_instance> given) {
    std::vector<Instance> instances;
    for (const claray_instance& one : given) {
        Instance& instance = instances.emplace_back();
        std::copy(one.transform, one.transform + 4, instance.row0);
        std::copy(one.transform + 4, one.transform + 8, instance.row1);
        std::copy(one.transform + 8, one.transform + 12, instance.row2);
        instance.bottom = one.bottom, instance.mask = one.mask;
    }
    return instances;
}

/// The same, of structures that exist.
std::vector<Instance> instances_of(std::span<const claray_instance> given, std::size_t bottoms) {
    for (std::size_t i = 0; i < given.size(); ++i)
        if (given[i].bottom >= bottoms)
            throw Error(ErrorKind::usage, "instances: instance " + std::to_string(i) + " has the structure " +
                                              std::to_string(given[i].bottom) + " of " + std::to_string(bottoms));
    return instances_of(given);
}

claray_flat_instances* flat_of(FlatInstances&& flat) {
    std::vector<claray_instance> members;
    for (const Instance& instance : flat.instances) {
        claray_instance& one = members.emplace_back();
        std::copy(instance.row0, instance.row0 + 4, one.transform);
        std::copy(instance.row1, instance.row1 + 4, one.transform + 4);
        std::copy(instance.row2, instance.row2 + 4, one.transform + 8);
        one.bottom = instance.bottom, one.mask = instance.mask;
    }
    return new claray_flat_instances{std::move(flat), std::move(members)};
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

claray_status claray_flat_instances_create(const claray_instance* roots, size_t root_count,
                                           const claray_instance_group* groups, size_t group_count, uint32_t bottoms,
                                           claray_flat_instances** flat) {
    return guarded([&] {
        std::vector<InstanceGroup> all;
        for (const claray_instance_group& group : array(groups, group_count, "groups"))
            all.push_back({instances_of(array(group.members, group.count, "members"))});
        const std::vector<Instance> placed = instances_of(array(roots, root_count, "roots"));
        hand_out(flat, "flat", [&] { return flat_of(flatten(placed, all, bottoms)); });
    });
}

size_t claray_flat_instances_count(const claray_flat_instances* flat) { return flat ? flat->members.size() : 0; }

const claray_instance* claray_flat_instances_members(const claray_flat_instances* flat) {
    return flat ? flat->members.data() : nullptr;
}

const uint32_t* claray_flat_instances_steps(const claray_flat_instances* flat, size_t i, size_t* count) {
    const bool found = i < claray_flat_instances_count(flat);
    if (count != nullptr) *count = found ? flat->flat.offsets[i + 1] - flat->flat.offsets[i] : 0;
    return found ? flat->flat.steps.data() + flat->flat.offsets[i] : nullptr;
}

void claray_flat_instances_release(claray_flat_instances* flat) { delete flat; }

void claray_instances_release(claray_instances* placed) { delete placed; }
