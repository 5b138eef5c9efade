#include "host/render/structure.hpp"

#include <algorithm>

#include "host/bvh/bvh_state.hpp"
#include "host/bvh/host_tree.hpp"
#include "host/bvh/instances_state.hpp"
#include "host/compute/memory.hpp"
#include "host/lights/lights.hpp"
#include "host/render/parts/parts_query.hpp"

namespace claray {
namespace {

/// As Bvh::build for one tree over all of them.
TriangleBuffers upload_all(const Device& device, const Scene& scene) {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;
    for (const Mesh& mesh : scene.meshes) {
        const auto base = std::uint32_t(positions.size() / 3);
        for (const glm::vec3& p : mesh.positions) positions.insert(positions.end(), {p.x, p.y, p.z});
        for (const glm::uvec3& t : mesh.triangles) indices.insert(indices.end(), {base + t.x, base + t.y, base + t.z});
    }
    TriangleBuffers buffers;
    buffers.positions = Buffer<float>(device, positions);
    buffers.indices = Buffer<std::uint32_t>(device, indices);
    return buffers;
}

std::uint64_t buffer_bytes(const TriangleBuffers& triangles) {
    return claray::buffer_bytes(triangles.positions, triangles.indices, triangles.geometries, triangles.masks);
}

struct BottomLevels {
    std::vector<Bvh> bvhs;
    std::vector<std::uint32_t> of_meshes;        // for each mesh its bottom level
    std::vector<std::uint32_t> first_triangles;  // of each, counted through the scene
    std::vector<bool> empty;
    BvhStatistics statistics;  // triangles of all, and the largest height
};

void add_to(BvhStatistics& all, const Bvh& bvh, const BvhHeader& header) {
    const auto triangles = std::uint32_t(bvh.triangle_count()) - header.culled;
    all.triangles += triangles;
    all.culled += header.culled;
    all.references += header.valid - triangles;
    all.height = std::max(all.height, header.height);
}

/// One over all baked meshes, and one for each other mesh.
template <class Build>
BottomLevels build_bottoms(const Scene& scene, std::size_t baked, const Build& build) {
    BottomLevels levels;
    std::uint32_t triangles = 0;
    for (std::size_t i = 0; i < scene.meshes.size();) {
        const std::size_t count = i == 0 && baked > 0 ? baked : 1;
        levels.of_meshes.resize(i + count, std::uint32_t(levels.bvhs.size()));
        levels.first_triangles.push_back(triangles);
        levels.bvhs.push_back(build(std::span(scene.meshes).subspan(i, count)));
        const BvhHeader header = state_of(levels.bvhs.back()).read_header();
        add_to(levels.statistics, levels.bvhs.back(), header);
        levels.empty.push_back(header.valid == 0);
        for (std::size_t end = i + count; i < end; ++i) triangles += std::uint32_t(scene.meshes[i].triangles.size());
    }
    return levels;
}

InstancedBvh::Config config_of_top(const Bvh::Config& config) {
    return {.builder = Builder::balanced, .morton_bits = config.morton_bits};
}

}  // namespace

/// In the order of the structure; `ends` if something moves.
struct Structure::Instances {
    std::vector<Instance> begins, ends;
    bool any_moves = false;
};

/// All baked meshes are the first instance, whose first triangle and light are those of the first mesh. `bottoms`: of
/// the meshes; `first_triangles`: of the bottoms.
Structure::Instances Structure::instances_of(const Scene& scene, std::size_t baked,
                                             const std::vector<std::uint32_t>& bottoms,
                                             const std::vector<std::uint32_t>& first_triangles) {
    const std::vector<std::uint32_t> lights = first_light_numbers(scene);
    Instances found;
    for (std::size_t i = 0; i < scene.instances.size(); i += i == 0 && baked > 0 ? baked : 1) {
        const MeshInstance& instance = scene.instances[i];
        const std::uint32_t bottom = bottoms[instance.mesh];
        found.begins.push_back(make_instance(instance.transform, bottom, 0xffffffffu, first_triangles[bottom]));
        found.begins.back().tag = lights[i];
        found.ends.push_back(make_instance(instance.transform_end.value_or(instance.transform), bottom));
        found.any_moves = found.any_moves || claray::moves(instance);
    }
    return found;
}

Structure::Structure(const Device& device, const Scene& scene, std::size_t baked, const Bvh::Config& config,
                     bool by_host, unsigned parts)
    : baked_(baked) {
    if (primitive_count(scene) > 0) primitives_ = std::make_shared<ScenePrimitives>(device, scene);
    if (parts > 1) {
        build_parts(device, scene, config, parts);
        return;
    }
    const auto build = [&](std::span<const Mesh> meshes) {
        return by_host ? build_by_host(device, meshes, config) : Bvh::build(device, meshes, config);
    };
    if (scene.instances.empty()) {
        bvh_ = build(scene.meshes);
        triangles_ = bvh_.triangles();
        return;
    }
    const BottomLevels levels = build_bottoms(scene, baked, build);
    bottoms_ = levels.statistics;
    Instances placed = instances_of(scene, baked, levels.of_meshes, levels.first_triangles);
    for (const Instance& instance : placed.begins) empty_instances_ += levels.empty[instance.bottom];
    if (!placed.any_moves) placed.ends.clear();
    const InstancedBvh::Config top = config_of_top(config);
    if (by_host)
        instanced_ = build_by_host(levels.bvhs, placed.begins, placed.ends, top);
    else
        instanced_ = placed.any_moves ? InstancedBvh::build(levels.bvhs, placed.begins, placed.ends, top)
                                      : InstancedBvh::build(levels.bvhs, placed.begins, top);
    check_placed();
    triangles_ = levels.bvhs.size() == 1 ? levels.bvhs[0].triangles() : upload_all(device, scene);
    if (by_host) by_host_ = levels.bvhs;
}

/// Shading reads the instances of the whole scene, but no tree: one triangle stands for each of their bottom levels.
void Structure::build_parts(const Device& device, const Scene& scene, const Bvh::Config& config, unsigned parts) {
    triangles_ = upload_all(device, scene);
    const std::vector<SceneObject> objects = objects_of(scene, baked_);
    std::vector<PlacedObject> placed;
    bool any_moves = false;
    if (!scene.instances.empty()) {
        std::vector<std::uint32_t> of_meshes, first_triangles;
        for (std::size_t o = 0; o < objects.size(); ++o) {
            of_meshes.resize(of_meshes.size() + objects[o].meshes, std::uint32_t(o));
            first_triangles.push_back(objects[o].first_triangle);
        }
        Instances all = instances_of(scene, baked_, of_meshes, first_triangles);
        any_moves = all.any_moves;
        for (std::size_t i = 0; i < all.begins.size(); ++i) {
            placed.push_back({all.begins[i], all.ends[i], all.begins[i].bottom});
            all.begins[i].bottom = all.ends[i].bottom = 0;
        }
        Mesh triangle;
        triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, triangle.triangles = {{0, 1, 2}};
        const std::vector<Bvh> one = {Bvh::build(device, std::span(&triangle, 1), config)};
        const InstancedBvh::Config top = config_of_top(config);
        instanced_ =
            any_moves ? InstancedBvh::build(one, all.begins, all.ends, top) : InstancedBvh::build(one, all.begins, top);
        check_placed();
    }
    parts_ = std::make_shared<SceneParts>(device, scene, objects, placed, any_moves, triangles_, parts, config);
    bottoms_ = parts_->statistics();
    if (!instanced_) bvh_ = parts_->parts().front().bvh;
}

void Structure::set_cutouts(const Buffer<std::uint32_t>& store) {
    if (parts_)
        parts_->set_cutouts(store);
    else
        instanced_ ? state_of(*instanced_).set_cutouts(store) : state_of(bvh_).set_cutouts(store);
}

void Structure::check_placed() const {
    const std::uint32_t culled = state_of(instanced_->top()).read_header().culled;
    if (culled <= empty_instances_) return;
    throw Error(ErrorKind::user,
                std::to_string(culled - empty_instances_) + " of " + std::to_string(instanced_->instance_count()) +
                    " instances cannot be placed: their transforms cannot be inverted in float32" +
                    (moves() ? " at some time of their motion" : ""),
                std::string("use scales that differ by less than a factor of 10000") +
                    (moves() ? ", and rotations of less than half a turn" : ""));
}

void Structure::move_vertices(std::size_t first, std::span<const glm::vec3> positions) {
    if (positions.empty()) return;
    triangles_.positions.write({&positions[0].x, 3 * positions.size()}, 3 * first);
}

void Structure::follow_vertices() {
    bvh_.refit();
    if (should_rebuild(bvh_)) bvh_.rebuild();
}

void Structure::move_instances(std::span<const std::pair<std::uint32_t, MeshInstance>> moved) {
    Buffer<Instance> begins = instanced_->instances(), ends = instanced_->ends();
    const std::vector<Instance> before = begins.read(), ends_before = moves() ? ends.read() : before;
    std::vector<Instance> now = before, ends_now = ends_before;
    const auto set = [](Instance& instance, const glm::mat4& transform) {
        const std::uint32_t tag = instance.tag;
        instance = make_instance(transform, instance.bottom, instance.mask, instance.id);
        instance.tag = tag;
    };
    for (const auto& [number, instance] : moved) {
        const std::size_t i = number - baked_ + (baked_ > 0 ? 1 : 0);
        set(now[i], instance.transform);
        set(ends_now[i], instance.transform_end.value_or(instance.transform));
    }
    const auto place = [&](const std::vector<Instance>& at, const std::vector<Instance>& ends_at) {
        begins.write(at);
        if (moves()) ends.write(ends_at);
        instanced_->rebuild();
    };
    place(now, ends_now);
    try {
        check_placed();
    } catch (const Error&) {
        place(before, ends_before);
        throw;
    }
}

Structure Structure::rebuilt(const Bvh::Config& config) const {
    Structure other;
    other.triangles_ = triangles_;
    other.primitives_ = primitives_;
    other.baked_ = baked_, other.empty_instances_ = empty_instances_;
    if (!instanced_) {
        other.bvh_ = Bvh::build(device(), triangles_, config);
        return other;
    }
    std::vector<Bvh> bottoms;
    for (const Bvh& bvh : by_host_) {
        bottoms.push_back(Bvh::build(device(), bvh.triangles(), config));
        add_to(other.bottoms_, bottoms.back(), state_of(bottoms.back()).read_header());
    }
    other.instanced_ = InstancedBvh::build(bottoms, instanced_->instances(), instanced_->ends(), config_of_top(config));
    return other;
}

std::uint64_t Structure::bytes() const {
    std::uint64_t bytes = buffer_bytes(triangles_);
    if (parts_) bytes += parts_->bytes();
    if (instanced_) bytes += state_of(*instanced_).bytes();
    if (!instanced_ && !parts_) bytes += state_of(bvh_).bytes();
    if (by_host_.size() > 1)
        for (const Bvh& bvh : by_host_) bytes += buffer_bytes(bvh.triangles()) + state_of(bvh).bytes();
    return bytes + (primitives_ ? primitives_->device_bytes() : 0);
}

BvhStatistics Structure::statistics() const {
    BvhStatistics statistics = statistics_of_triangles();
    if (primitives_) statistics.bytes += primitives_->bytes();
    return statistics;
}

BvhStatistics Structure::statistics_of_triangles() const {
    if (!instanced_ && !parts_) return bvh_.statistics();
    BvhStatistics statistics = bottoms_;
    if (parts_) return statistics;
    const InstanceStatistics top = instanced_->statistics();
    statistics.height += top.height;
    statistics.sah_cost = top.sah_cost;
    statistics.bytes = top.top_bytes + top.bottom_bytes;
    return statistics;
}

const Device& Structure::device() const { return instanced_ ? instanced_->device() : bvh_.device(); }

Defines StructureFormat::defines() const {
    Defines defines = {{"INSTANCES", has_instances ? "1" : "0"}, {"INSTANCE_MOTION", trees.moves ? "1" : "0"}};
    if (primitives != 0) defines.emplace_back("PRIMITIVES", std::to_string(primitives));
    return defines;
}

/// Of instances in parts, those that rays traverse.
StructureFormat Structure::format() const {
    StructureFormat format;
    format.has_instances = instanced_.has_value(), format.is_split = parts_ != nullptr;
    const std::optional<InstancedBvh>& traced = parts_ ? parts_->parts().front().instanced : instanced_;
    format.trees = traced ? state_of(*traced).format : format_of(bvh_);
    if (primitives_) format.primitives = primitives_->mask();
    return format;
}

KernelSet programs_of_query(const Device& device, const StructureFormat& structure, QueryKind kind,
                            const QueryOptions& options, const std::string& file) {
    KernelSet set;
    if (structure.has_instances)
        set.add(device, instance_kernel(structure.trees, kind, options));
    else
        set.add(QueryKernels(device, structure.trees, kind, options, file).programs(device));
    if (structure.is_split) set.add(device, keeper_of_nearest(structure, kind));
    return set;
}

KernelSet programs_of_structure(const Device& device, const StructureFormat& structure, const Bvh::Config& config) {
    KernelSet set = programs_of_builder(device, config);
    if (structure.is_split) set.add(device, area_sum);  // of Bvh::statistics
    if (!structure.has_instances) return set;
    set.add(device, InstancedBvh::State::placing());
    set.add(programs_of_builder(device, InstancedBvh::State::config_of_top(config_of_top(config))));
    return set;
}

void Structure::bind(Kernel& kernel, unsigned& index) const {
    if (instanced_) {
        kernel.set(index, arg("instances", instanced_->instances()));
        kernel.set(index, arg("instance_ends", instanced_->ends()));
        kernel.set(index, state_of(*instanced_).placed);
    }
    if (primitives_) kernel.set(index, arg("primitive_store", primitives_->store()));
}

SceneHits::SceneHits(const Structure& structure, std::size_t count) {
    if (structure.instanced())
        of_instances = Buffer<InstanceHit>(structure.device(), count);
    else
        of_triangles = Buffer<Hit>(structure.device(), count);
}

SceneQuery::SceneQuery(const Structure& structure, QueryKernel::Kind kind, const QueryOptions& options,
                       const std::string& name, const std::string& file)
    : instanced_(structure.instanced().has_value()) {
    if (structure.parts())
        of_parts_ = std::make_shared<PartsQuery>(structure, kind, options, name);
    else if (instanced_)
        of_instances_ = InstanceQuery(*structure.instanced(), kind, options, name);
    else
        of_triangles_ = QueryKernel(structure.bvh(), kind, options, name, file);
    if (structure.primitives()) of_primitives_.emplace(*structure.primitives(), kind, instanced_, name);
}

std::uint64_t SceneQuery::bytes() const { return of_parts_ ? of_parts_->bytes() : 0; }

void SceneQuery::closest(const Buffer<Ray>& rays, SceneHits& hits, std::uint32_t capacity,
                         const Buffer<std::uint32_t>& count, const Buffer<float>& times) {
    if (of_parts_)
        of_parts_->closest(rays, hits, capacity, count, times);
    else
        instanced_ ? of_instances_.run(rays, hits.of_instances, capacity, count, times)
                   : of_triangles_.run(rays, hits.of_triangles, capacity, count);
    if (of_primitives_) of_primitives_->closest(rays, hits, capacity, count);
}

void SceneQuery::any(const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, std::uint32_t capacity,
                     const Buffer<std::uint32_t>& count, const Buffer<float>& times) {
    if (of_parts_)
        of_parts_->any(rays, occluded, capacity, count, times);
    else
        instanced_ ? of_instances_.run(rays, occluded, capacity, count, times)
                   : of_triangles_.run(rays, occluded, capacity, count);
    if (of_primitives_) of_primitives_->any(rays, occluded, capacity, count);
}

}  // namespace claray
