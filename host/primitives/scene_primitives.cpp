#include "host/primitives/scene_primitives.hpp"

#include <algorithm>
#include <cstring>

#include "claray/primitives/curves.hpp"
#include "host/primitives/primitives_state.hpp"

namespace claray {
namespace {

constexpr std::size_t alignment = 256;              // words, of sub-buffers
constexpr std::uint64_t bytes_per_primitive = 160;  // tree, boxes and data, while the tree is built

/// Calls visit(set) for the sets of a kind.
template <class Visit>
void for_each_set(const Scene& scene, std::uint32_t kind, const Visit& visit) {
    for (const PrimitiveSet& set : scene.primitives)
        if (std::uint32_t(set.kind) == kind) visit(set);
}

bool is_flat(std::uint32_t kind) { return kind == CLARAY_FLAT_CURVES || kind == CLARAY_FLAT_BEZIER_CURVES; }
bool is_bezier(std::uint32_t kind) { return kind == CLARAY_BEZIER_CURVES || kind == CLARAY_FLAT_BEZIER_CURVES; }

PrimitiveKind text_of(std::uint32_t kind) {
    switch (kind) {
        case CLARAY_SPHERES: return sphere_kind();
        case CLARAY_DISCS: return disc_kind();
        case CLARAY_CYLINDERS: return cylinder_kind();
    }
    return curve_kind(is_flat(kind) ? CurveShape::flat : CurveShape::round);
}

Builder builder_of(std::uint32_t kind) { return kind >= CLARAY_CURVES ? Builder::binned : Builder::balanced; }

void append(std::vector<float>& words, const std::vector<glm::vec4>& points) {
    for (const glm::vec4& p : points) words.insert(words.end(), {p.x, p.y, p.z, p.w});
}

void append_kind(const Scene& scene, std::uint32_t kind, std::vector<float>& words) {
    for_each_set(scene, kind, [&](const PrimitiveSet& set) {
        if (!are_curves(set)) return append(words, set.points);
        const std::vector<float> data =
            curve_data(set.points, set.segments, is_bezier(kind) ? CurveBasis::bezier : CurveBasis::bspline);
        words.insert(words.end(), data.begin(), data.end());
    });
}

void append_colors(const Scene& scene, std::vector<float>& words) {
    for (std::uint32_t kind = 0; kind < CLARAY_PRIMITIVE_KINDS; ++kind)
        for_each_set(scene, kind, [&](const PrimitiveSet& set) {
            for (const glm::vec3& c : set.colors) words.insert(words.end(), {c.r, c.g, c.b});
            if (set.colors.empty()) words.resize(words.size() + 6 * primitive_count(set), 1.f);
        });
}

std::size_t count_of(const Scene& scene, std::uint32_t kind) {
    std::size_t count = 0;
    for_each_set(scene, kind, [&](const PrimitiveSet& set) { count += primitive_count(set); });
    return count;
}

std::uint32_t triangles_of(const Scene& scene) {
    std::size_t count = 0;
    for (const Mesh& mesh : scene.meshes) count += mesh.triangles.size();
    return std::uint32_t(count);
}

void align(std::vector<float>& words) { words.resize((words.size() + alignment - 1) / alignment * alignment); }

}  // namespace

ScenePrimitives::ScenePrimitives(const Device& device, const Scene& scene) {
    mask_ = kinds_of_primitives(scene);
    PrimitiveStore header{};
    std::vector<float> words(alignment);
    std::size_t sizes[CLARAY_PRIMITIVE_KINDS] = {};
    std::uint32_t next = triangles_of(scene);
    for (std::uint32_t kind = 0; kind < CLARAY_PRIMITIVE_KINDS; ++kind) {
        header.first[kind] = next, header.data[kind] = std::uint32_t(words.size());
        next += std::uint32_t(count_of(scene, kind));
        if (next == header.first[kind]) continue;
        append_kind(scene, kind, words);
        sizes[kind] = words.size() - header.data[kind];
        align(words);
    }
    header.first[CLARAY_PRIMITIVE_KINDS] = next;
    const bool colored = std::any_of(scene.primitives.begin(), scene.primitives.end(),
                                     [](const PrimitiveSet& set) { return !set.colors.empty(); });
    if (colored) header.colors = std::uint32_t(words.size()), append_colors(scene, words);
    std::memcpy(words.data(), &header, sizeof header);
    store_ = Buffer<float>(device, words);
    bytes_ = store_.bytes();
    for (std::uint32_t kind = 0; kind < CLARAY_PRIMITIVE_KINDS; ++kind) {
        if ((mask_ >> kind & 1) == 0) continue;
        const Buffer<float> data(store_, header.data[kind] * sizeof(float), sizes[kind]);
        const Primitives structure = Primitives::build(
            device, text_of(kind), data, header.first[kind + 1] - header.first[kind], {.builder = builder_of(kind)});
        Bvh::State& tree = state_of(structure.bvh());
        bytes_ += tree.tree_bytes(tree.read_header());
        tree.keep_tree_only(), state_of(structure).corners = {};
        kinds_.push_back({header.first[kind], structure});
    }
}

std::uint64_t ScenePrimitives::device_bytes() const {
    std::uint64_t bytes = store_.bytes();
    for (const PrimitivesOfKind& kind : kinds_) bytes += state_of(kind.structure.bvh()).bytes();
    return bytes;
}

std::uint32_t kinds_of_primitives(const Scene& scene) {
    std::uint32_t kinds = 0;
    for (const PrimitiveSet& set : scene.primitives)
        if (primitive_count(set) > 0) kinds |= 1u << std::uint32_t(set.kind);
    return kinds;
}

std::vector<std::uint32_t> materials_of_primitives(const Scene& scene) {
    std::vector<std::uint32_t> materials;
    for (std::uint32_t kind = 0; kind < CLARAY_PRIMITIVE_KINDS; ++kind)
        for_each_set(scene, kind, [&](const PrimitiveSet& set) {
            materials.insert(materials.end(), set.materials.begin(), set.materials.end());
            if (set.materials.empty()) materials.resize(materials.size() + primitive_count(set), 0);
        });
    return materials;
}

std::size_t primitive_count(const Scene& scene) {
    std::size_t count = 0;
    for (const PrimitiveSet& set : scene.primitives) count += primitive_count(set);
    return count;
}

std::uint64_t bytes_of_primitives(const Scene& scene) {
    std::uint64_t bytes = 0;
    for (const PrimitiveSet& set : scene.primitives)
        bytes += sizeof(glm::vec4) * (are_curves(set) ? 4 * set.segments.size() : set.points.size()) +
                 sizeof(glm::vec3) * set.colors.size() + bytes_per_primitive * primitive_count(set);
    return bytes;
}

PrimitivesQuery::PrimitivesQuery(const ScenePrimitives& primitives, QueryKind kind, bool instances,
                                 const std::string& name) {
    for (const PrimitivesOfKind& of : primitives.kinds()) {
        const Primitives::State& state = state_of(of.structure);
        Defines defines = state.launch.with(state.bvh.defines());
        defines.emplace_back("INSTANCES", instances ? "1" : "0");
        const bool closest = kind == QueryKind::closest;
        const Kernel kernel = state.compile(closest ? "nearer_primitive" : "occluding_primitive", defines);
        passes_.push_back({of, name.empty() ? kernel : Kernel(state.device, kernel.handle(), name)});
    }
}

Range PrimitivesQuery::Pass::range(std::uint32_t rays) const { return state_of(of.structure).launch.range(rays); }

void PrimitivesQuery::any(const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, std::uint32_t capacity,
                          const Buffer<std::uint32_t>& count) {
    for (Pass& pass : passes_)
        pass.kernel.run(pass.range(capacity), pass.of.structure.bvh(), arg("data", pass.of.structure.data()),
                        pass.of.structure.count(), rays, capacity, arg("count", count), arg("occluded", occluded));
}

}  // namespace claray
