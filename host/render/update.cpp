// Renderer::update: a renderer follows the changes of its scene.
#include <algorithm>

#include "claray/mesh.hpp"
#include "host/effects/parts/part.hpp"
#include "host/render/renderer_state.hpp"
#include "host/scene/validate.hpp"
#include "host/textures/texture_use.hpp"

namespace claray {
namespace {

void check_equal(std::size_t now, std::size_t before, const std::string& what) {
    if (now == before) return;
    throw Error(ErrorKind::usage,
                "the scene has " + std::to_string(now) + " " + what + " instead of " + std::to_string(before),
                "make a new Renderer for another scene");
}

void check_meshes(const Scene& scene, const SceneShape& shape) {
    check_equal(scene.meshes.size(), shape.meshes.size(), "meshes");
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        const Mesh& mesh = scene.meshes[i];
        const SceneShape::MeshSize before = shape.meshes[i];
        const std::string of = " in mesh " + std::to_string(i);
        check_equal(mesh.positions.size(), before.vertices, "vertices" + of);
        check_equal(mesh.triangles.size(), before.triangles, "triangles" + of);
        check_equal(mesh.normals.size(), before.normals, "normals" + of);
    }
}

void check_changes(const Scene& scene, const SceneChanges& changes, const SceneShape& shape) {
    if (changes.vertices) check_meshes(scene, shape);
    if (changes.instances) check_equal(scene.instances.size(), shape.instances.size(), "instances");
    if (changes.materials) check_equal(scene.materials.size(), shape.materials, "materials");
    check_equal(primitive_count(scene), shape.primitives, "primitives");
    if (changes.camera) validate_camera(scene);
    if (changes.lights) validate_lights(scene);
    if (changes.materials) validate_materials(scene), validate_primitives(scene);
    if (changes.sky) validate_sky(scene);
    if (changes.instances) validate_instances(scene);
    if (changes.vertices) validate_meshes(scene);
}

/// Replaces the effects of the changed parts that follow from these parts alone.
EffectSet with_parts(EffectSet effects, const Scene& scene, const SceneChanges& changes) {
    Scene parts;
    if (changes.camera) parts.camera = scene.camera, effects = effects - effects_in(parts_of_cameras());
    if (changes.lights) parts.lights = scene.lights, effects = effects - effects_in(parts_of_lights());
    if (changes.sky) parts.sky = scene.sky, effects = effects - effects_in(parts_of_sky());
    return effects | (effects_of(parts) - effects_with(CLARAY_AID));
}

bool same(const MeshInstance& a, const MeshInstance& b) {
    return a.mesh == b.mesh && a.transform == b.transform && a.transform_end == b.transform_end;
}

/// Calls `function` with the scene in which every instance is placed; without instances that is the scene itself.
template <class Function>
void with_placed(const Scene& scene, const Function& function) {
    if (scene.instances.empty()) return function(scene);
    function(place_instances(scene).scene);
}

bool is_mirror(const glm::mat4& transform) { return glm::determinant(glm::dmat3(transform)) < 0; }

}  // namespace

SceneShape::SceneShape(const Scene& scene, const Scene& placed, std::vector<InstancePlace> of, TriangleNumbers ofs)
    : materials(scene.materials.size()),
      primitives(primitive_count(scene)),
      instances(scene.instances),
      places(std::move(of)),
      numbers(std::move(ofs)),
      surfaces(scene, places, numbers) {
    for (const Mesh& mesh : scene.meshes)
        meshes.push_back({mesh.positions.size(), mesh.triangles.size(), mesh.normals.size()});
    std::size_t vertices = 0;
    for (const Mesh& mesh : placed.meshes) {
        first_vertices.push_back(vertices);
        vertices += mesh.positions.size();
    }
    const auto has_uvs = [](const Mesh& mesh) { return !mesh.uvs.empty(); };
    if (std::any_of(placed.meshes.begin(), placed.meshes.end(), has_uvs)) uvs = of_all_meshes(placed, &Mesh::uvs);
}

/// Keeps the kernels in use if they support the scene. Others are compiled in the background if that is possible.
void Renderer::State::support_scene() {
    if (wavefront.kernels.config.supports(buffers)) return;
    kernels.plan = plan_kernels(device, traits(buffers.effects), config);
    kernels.are_own = kernels.plan.first == kernels.plan.last;
    kernels.compiler = {};
    const KernelChoice& first = kernels.plan.first;
    const Structure& structure = buffers.structure;
    const bool same_tree = structure.instanced() || structure.parts() || structure.bvh().layout() == first.layout;
    adopt(same_tree ? structure : structure.rebuilt(with_layout(config.bvh, first.layout)), first.effects);
}

/// Places the scene, its buffers and trees anew.
void Renderer::State::rebuild_scene(const Scene& scene) {
    PlacedScene placed;
    if (scene.instances.empty())
        placed.scene = scene;
    else
        placed = place_instances(scene);
    const Structure structure(device, placed.scene, placed.baked, with_layout(config.bvh, kernels.plan.last.layout),
                              false, source.parts);
    light_grid = light_grid_of(config, placed.scene);
    buffers = SceneBuffers(device, placed.scene, structure, config.effects.add, selection_of_lights(config),
                           words_of(light_grid), words_of_listed_pixels(), words_of_guide());
    list_region();
    set_bounds(scene, true);
    source.shape = SceneShape(scene, placed.scene, std::move(placed.places), std::move(placed.numbers));
    wavefront.replace_scene(buffers);
    kernels.plan = plan_kernels(device, traits(buffers.effects), config);
    kernels.are_own = true;
    adopt(structure, kernels.plan.last.effects);
}

/// For one tree. Returns false if more than vertices must change.
bool Renderer::State::move_vertices(const Scene& scene, bool all) {
    std::vector<std::pair<Mesh, std::size_t>> moved;  // and their first vertices
    const auto add = [&](const Mesh& mesh, const glm::mat4& transform, std::uint32_t index) {
        moved.emplace_back(transformed(mesh, transform), source.shape.first_vertices[index]);
        return mesh.tangents.empty() && survives_baking(mesh, transform);
    };
    if (scene.instances.empty())
        for (std::uint32_t i = 0; i < scene.meshes.size(); ++i)
            if (!add(scene.meshes[i], glm::mat4(1.f), i)) return false;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const MeshInstance &now = scene.instances[i], &before = source.shape.instances[i];
        const InstancePlace place = source.shape.places[i];
        if (place.index == CLARAY_MISS || (!all && same(now, before))) continue;
        if (moves(now) || now.mesh != before.mesh || is_mirror(now.transform) != is_mirror(before.transform))
            return false;
        if (!add(scene.meshes[now.mesh], now.transform, place.index)) return false;
    }
    for (const auto& [mesh, first] : moved) {
        buffers.structure.move_vertices(first, mesh.positions);
        buffers.move_normals(first, mesh.normals);
    }
    buffers.structure.follow_vertices();
    return true;
}

/// For a tree of trees. Returns false if more than the transforms of its own instances must change.
bool Renderer::State::move_instances(const Scene& scene) {
    std::vector<std::pair<std::uint32_t, MeshInstance>> moved;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const MeshInstance &now = scene.instances[i], &before = source.shape.instances[i];
        const InstancePlace place = source.shape.places[i];
        if (same(now, before) || place.index == CLARAY_MISS) continue;
        if (place.baked || now.mesh != before.mesh || (moves(now) && !buffers.structure.moves())) return false;
        moved.emplace_back(place.index, now);
    }
    if (!moved.empty()) buffers.structure.move_instances(moved);
    return true;
}

void Renderer::State::move(const Scene& scene, const SceneChanges& changes) {
    const bool shines = buffers.lights.triangles > 0;
    const Structure& structure = buffers.structure;
    const bool moved =
        !structure.parts() && (structure.instanced() ? !changes.vertices && !shines && move_instances(scene)
                                                     : move_vertices(scene, changes.vertices));
    if (!moved) return rebuild_scene(scene);
    if (changes.instances) source.shape.instances = scene.instances;
    if (!shines && has_lights(buffers.lights)) buffers.replace_lights(scene);  // hot spots follow surfaces
    if (shines) with_placed(scene, [&](const Scene& placed) { buffers.replace_emissive_triangles(placed); });
    set_bounds(scene, changes.vertices);
}

void Renderer::State::update(const Scene& scene, const SceneChanges& changes) {
    if (changes.camera && scene.camera) look_through(*scene.camera);
    if (changes.sky) wavefront.frame.sky = sky_data(scene);
    if (changes.instances || changes.vertices) move(scene, changes);
    EffectSet effects = with_parts(buffers.effects, scene, changes);
    if (changes.materials) {
        with_placed(scene, [&](const Scene& placed) {
            buffers.replace_materials(placed);
            effects = effects_of(placed);
        });
    } else if (changes.lights)
        buffers.replace_lights(scene);
    buffers.effects = effects | buffers.effects_of_tables();
    wavefront.replace_scene(buffers);
    const bool surfaces = changes.instances || changes.vertices;
    if (light_grid && (surfaces || changes.lights || changes.materials || changes.sky))
        light_grid->scene_changed(surfaces);
    support_scene();
}

void Renderer::update(const Scene& scene, const SceneChanges& changes) {
    State& state = *state_;
    state.refuse_with_checkpoints("a scene cannot change while checkpoints are written");
    check_changes(scene, changes, state.source.shape);
    if (state.outputs.matte) state.outputs.matte->follow(scene, changes);
    const EffectSet removed = state.config.effects.remove;
    removed.empty() ? state.update(scene, changes) : state.update(without_effects(scene, removed), changes);
    if (state.outputs.light_layers) state.outputs.light_layers->follow(scene, state.wavefront);
    state.error.cut_off.reset();
    if (state.outputs.denoising) state.outputs.denoising->follow(state.buffers, changes);
    state.discard_samples();
}

}  // namespace claray
