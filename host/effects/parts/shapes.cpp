// Attributes of meshes, instances and primitives.
#include <array>

#include "host/effects/parts/part.hpp"
#include "host/scene/placement.hpp"
#include "host/textures/textures.hpp"

namespace claray {
namespace {

using scenes::ball_material, scenes::block_material;

bool has_normals(const Mesh& mesh) { return !mesh.normals.empty(); }

template <bool needs(const Mesh&)>
void find_meshes(const SearchedScene& searched, const Found& found) {
    for (std::size_t i = 0; i < searched.scene.meshes.size(); ++i)
        if (needs(searched.scene.meshes[i])) found("mesh", searched.scene.meshes[i].name, i);
}

bool is_any(const MeshInstance&) { return true; }
bool is_moving(const MeshInstance& instance) { return moves(instance); }

template <bool needs(const MeshInstance&)>
void find_instances(const SearchedScene& searched, const Found& found) {
    for (std::size_t i = 0; i < searched.scene.instances.size(); ++i)
        if (needs(searched.scene.instances[i])) found("instance", {}, i);
}

void find_primitives(const SearchedScene& searched, const Found& found) {
    const std::vector<PrimitiveSet>& sets = searched.scene.primitives;
    for (std::size_t i = 0; i < sets.size(); ++i)
        if (primitive_count(sets[i]) > 0) found("primitive set", sets[i].name, i);
}

template <auto Mesh::*values>
void clear(Scene& scene) {
    for (Mesh& mesh : scene.meshes) (mesh.*values).clear();
}

void stop_instances(Scene& scene) {
    for (MeshInstance& instance : scene.instances) instance.transform_end = {};
}

/// So coarse that the ball's outline is visibly not round.
void show_smooth_normals(Scene& s) {
    s.meshes[ball_material] = scenes::textured_ball({-0.35f, 0.8f, 0.f}, 0.8f, 2, ball_material);
}

void show_vertex_colors(Scene& s) {
    ball_of(s).albedo = glm::vec3(0.8f);
    scenes::paint(s.meshes[ball_material]);
}

/// Rows of small balls, all the same mesh.
void show_instances(Scene& s) {
    s.meshes = {s.meshes[0], scenes::textured_ball({0, 0, 0}, 1.f, 3, ball_material)};
    s.meshes[1].normals.clear();
    s.instances = {MeshInstance{}};
    for (int i = 0; i < 25; ++i) {
        MeshInstance instance;
        instance.mesh = 1;
        const float size = 0.16f + 0.012f * float(i % 7);
        instance.transform = glm::mat4(size);
        instance.transform[3] = {0.6f * float(i % 5) - 1.1f, size, 0.6f * float(i / 5) - 1.3f, 1.f};
        s.instances.push_back(instance);
    }
}

void show_instance_motion(Scene& s) {
    s.instances.resize(s.meshes.size());
    for (std::uint32_t i = 0; i < s.instances.size(); ++i) s.instances[i].mesh = i;
    glm::mat4 end(1.f);
    end[3] = {-0.45f, 0.35f, 0.f, 1.f};
    s.instances[ball_material].transform_end = end;
}

/// A nest of curves with eggs, in the ball's place, on a disc.
void show_primitives(Scene& s) {
    s.meshes.erase(s.meshes.begin() + ball_material);
    s.camera->target.y -= 0.2f;
    scenes::add_nest(s, {-0.35f, 0.f, 0.f}, 0.8f, ball_material, block_material);
}

constexpr std::array shape_parts = {EffectPart{.effect = Effect::smooth_normals,
                                               .find = find_meshes<has_normals>,
                                               .strip = clear<&Mesh::normals>,
                                               .show = show_smooth_normals},
                                    EffectPart{.effect = Effect::vertex_colors,
                                               .find = find_meshes<has_colors>,
                                               .strip = clear<&Mesh::colors>,
                                               .show = show_vertex_colors},
                                    EffectPart{.effect = Effect::instance_motion,
                                               .find = find_instances<is_moving>,
                                               .strip = stop_instances,
                                               .show = show_instance_motion},
                                    EffectPart{.effect = Effect::instances,
                                               .find = find_instances<is_any>,
                                               .strip = [](Scene& scene) { scene.instances.clear(); },
                                               .show = show_instances},
                                    EffectPart{.effect = Effect::primitives,
                                               .find = find_primitives,
                                               .strip = [](Scene& scene) { scene.primitives.clear(); },
                                               .show = show_primitives,
                                               .apart = true}};

}  // namespace

std::span<const EffectPart> parts_of_shapes() { return shape_parts; }

}  // namespace claray
