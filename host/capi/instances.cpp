// claray.h: instances.
#include "claray/instances.hpp"

#include "host/capi/members.hpp"

using namespace claray;
using namespace claray::capi;

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
            refuse("instances: instance " + std::to_string(i) + " has the structure " +
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

std::vector<Bvh> structures_of(const claray_bvh* const* bvhs, std::size_t count) {
    std::vector<Bvh> structures;
    for (const claray_bvh* bvh : array(bvhs, count, "bvhs")) structures.push_back(required(bvh, "bvhs").bvh);
    return structures;
}

InstancedBvh::Config instances_config_of(const claray_instances_config& given) {
    InstancedBvh::Config config;
    const Builder builder = enumerator(given.builder, "config.builder");
    if (builder != Builder::automatic) config.builder = builder;
    if (given.morton_bits != 0) config.morton_bits = given.morton_bits;
    return config;
}

void update(InstancedBvh& bvh, int rebuild) { rebuild != 0 ? bvh.rebuild() : bvh.refit(); }

void move(claray_instances& placed, const claray_instance* instances, const claray_instance* ends, std::size_t count,
          int rebuild) {
    if (count != placed.bvh.instance_count())
        refuse("count is " + std::to_string(count) + ", and there are " + std::to_string(placed.bvh.instance_count()) +
               " instances");
    const std::vector<Instance> begin = instances_of(array(instances, count, "instances"), placed.bottoms);
    Buffer<Instance> memory = placed.bvh.instances(), end_memory = placed.bvh.ends();
    if (ends && !end_memory.allocated()) refuse("ends: the instances were built without", "build them with ends");
    memory.write(begin);
    if (ends) end_memory.write(instances_of(array(ends, count, "ends"), placed.bottoms));
    update(placed.bvh, rebuild);
}

}  // namespace

claray_status claray_instances_build(const claray_bvh* const* bvhs, size_t bvh_count, const claray_instance* instances,
                                     size_t count, claray_instances** placed) {
    return claray_instances_config_build(bvhs, bvh_count, instances, count, nullptr, placed);
}

claray_status claray_instances_config_build(const claray_bvh* const* bvhs, size_t bvh_count,
                                            const claray_instance* instances, size_t count,
                                            const claray_instances_config* config, claray_instances** placed) {
    return guarded([&] {
        const claray_instances_config given = versioned(config, "config");
        const InstancedBvh::Config known = instances_config_of(given);
        const std::vector<Bvh> bottoms = structures_of(bvhs, bvh_count);
        const std::vector<Instance> all = instances_of(array(instances, count, "instances"), bvh_count);
        hand_out(placed, "placed", [&] {
            if (!given.ends) return new claray_instances{InstancedBvh::build(bottoms, all, known), bvh_count};
            const std::vector<Instance> ends = instances_of(std::span(given.ends, count), bvh_count);
            return new claray_instances{InstancedBvh::build(bottoms, all, ends, known), bvh_count};
        });
    });
}

claray_status claray_instances_move(claray_instances* placed, const claray_instance* instances, size_t count,
                                    int rebuild) {
    return guarded([&] { move(required(placed, "placed"), instances, nullptr, count, rebuild); });
}

claray_status claray_instances_move_with_ends(claray_instances* placed, const claray_instance* instances,
                                              const claray_instance* ends, size_t count, int rebuild) {
    return guarded([&] { move(required(placed, "placed"), instances, &required(ends, "ends"), count, rebuild); });
}

claray_status claray_instances_update(claray_instances* placed, int rebuild) {
    return guarded([&] { update(required(placed, "placed").bvh, rebuild); });
}

claray_status claray_instances_replace(claray_instances* placed, const claray_bvh* const* bvhs, size_t bvh_count) {
    return guarded([&] {
        claray_instances& changed = required(placed, "placed");
        changed.bvh.replace_bottoms(structures_of(bvhs, bvh_count));
        changed.bottoms = bvh_count;
    });
}

claray_status claray_instances_buffers_get(const claray_instances* placed, void** instances, void** ends) {
    return guarded([&] {
        const InstancedBvh& of = required(placed, "placed").bvh;
        required(instances, "instances") = of.instances().memory()();
        if (ends) *ends = of.ends().memory()();
    });
}

size_t claray_instances_count(const claray_instances* placed) { return placed ? placed->bvh.instance_count() : 0; }

claray_status claray_instances_statistics_get(const claray_instances* placed, claray_instances_statistics* statistics) {
    return guarded([&] {
        const InstancedBvh& of = required(placed, "placed").bvh;
        auto known = put_into<claray_instances_statistics>(of.statistics());
        put(known.layout, of.layout());
        give(statistics, known, "statistics");
    });
}

claray_status claray_instances_validate(const claray_instances* placed, claray_bvh_validation* validation) {
    return guarded([&] {
        give(validation, put_into<claray_bvh_validation>(required(placed, "placed").bvh.validate()), "validation");
    });
}

claray_status claray_instances_tree_create(const claray_instances* placed, claray_bvh** tree) {
    return guarded([&] {
        const Bvh& top = required(placed, "placed").bvh.top();
        hand_out(tree, "tree", [&] { return new claray_bvh{top}; });
    });
}

claray_status claray_query_instances_create(const claray_instances* placed, claray_query_kind kind,
                                            const claray_query_options* options, claray_device* queue,
                                            claray_query** query) {
    return guarded([&] {
        const InstancedBvh& over = required(placed, "placed").bvh;
        hand_out(query, "query", [&] { return query_of(over, kind, options, queue, true); });
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
