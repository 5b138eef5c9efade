// claray.h: scenes, their meshes, placements and primitives.
#include "host/capi/scene.hpp"

#include "claray/effects.hpp"
#include "claray/io.hpp"
#include "host/capi/members.hpp"
#include "host/primitives/scene_primitives.hpp"
#include "host/scene/validate.hpp"

using namespace claray;
using namespace claray::capi;

namespace {

LoadOptions options_of(const claray_load_options* given) {
    const claray_load_options known = versioned(given, "options");
    LoadOptions options;
    visit_pairs(known, options, Take{"options"});
    if (known.has_time != 0) options.time = known.time;
    if (known.stroke_radius != 0) options.stroke_radius = std::max(known.stroke_radius, 0.f);
    options.images = known.no_images == 0;
    return options;
}

/// Calls `use` with the list of the scene, and what its elements are called.
template <class Scene, class Use>
auto with_part(Scene& scene, const claray_scene_part& part, const Use& use) {
    switch (number_of(part)) {
        case CLARAY_MESHES: return use(scene.meshes, "meshes");
        case CLARAY_PLACEMENTS: return use(scene.instances, "placements");
        case CLARAY_PRIMITIVE_SETS: return use(scene.primitives, "sets of primitives");
        case CLARAY_MATERIALS: return use(scene.materials, "materials");
        case CLARAY_TEXTURES: return use(scene.textures, "textures");
        case CLARAY_LIGHTS: return use(scene.lights, "lights");
        default: refuse("part is " + std::to_string(number_of(part)), "use a claray_scene_part");
    }
}

/// Nothing for NULL.
template <class T>
std::vector<T> for_each(const void* data, std::size_t count, const char* name) {
    return data ? copied<T>(data, count, name) : std::vector<T>();
}

Mesh mesh_of(const claray_mesh& given) {
    if (given.geometries) refuse("mesh.geometries is not NULL", "a mesh of a scene is one geometry");
    if (given.mask_count > 1)
        refuse("mesh.mask_count is " + std::to_string(given.mask_count), "a mesh of a scene has one mask");
    Mesh mesh;
    mesh.name = text_of(given.name);
    mesh.positions = copied<glm::vec3>(given.vertices, given.vertex_count, "mesh.vertices");
    mesh.triangles = copied<glm::uvec3>(given.triangles, given.triangle_count, "mesh.triangles");
    mesh.normals = for_each<glm::vec3>(given.normals, given.vertex_count, "mesh.normals");
    mesh.uvs = for_each<glm::vec2>(given.uvs, given.vertex_count, "mesh.uvs");
    mesh.uvs1 = for_each<glm::vec2>(given.uvs1, given.vertex_count, "mesh.uvs1");
    mesh.tangents = for_each<glm::vec4>(given.tangents, given.vertex_count, "mesh.tangents");
    mesh.colors = for_each<glm::vec4>(given.colors, given.vertex_count, "mesh.colors");
    mesh.materials = for_each<std::uint32_t>(given.materials, given.triangle_count, "mesh.materials");
    if (!given.materials && given.material != 0) mesh.materials.assign(given.triangle_count, given.material);
    if (given.masks && given.mask_count == 1) mesh.mask = given.masks[0];
    return mesh;
}

template <class T>
const float* floats_of(const std::vector<T>& values) {
    return values.empty() ? nullptr : &values[0][0];
}

claray_mesh mesh_of(const Mesh& mesh) {
    claray_mesh known{};
    known.name = mesh.name.c_str();
    known.vertices = floats_of(mesh.positions), known.vertex_count = mesh.positions.size();
    known.triangles = mesh.triangles.empty() ? nullptr : &mesh.triangles[0][0];
    known.triangle_count = mesh.triangles.size();
    known.masks = &mesh.mask, known.mask_count = 1;
    known.normals = floats_of(mesh.normals), known.uvs = floats_of(mesh.uvs), known.uvs1 = floats_of(mesh.uvs1);
    known.tangents = floats_of(mesh.tangents), known.colors = floats_of(mesh.colors);
    known.materials = mesh.materials.empty() ? nullptr : mesh.materials.data();
    return known;
}

PrimitiveSet set_of(const claray_primitive_set& given, std::uint32_t new_material) {
    PrimitiveSet set;
    set.name = text_of(given.name);
    set.kind = kind_named<PrimitiveSet::Kind>(&required(given.kind, "set.kind"), "set.kind");
    set.points = copied<glm::vec4>(given.points, given.point_count, "set.points");
    set.segments = copied<std::uint32_t>(given.segments, given.segment_count, "set.segments");
    const std::size_t count = primitive_count(set);
    if (given.colors) set.colors = copied<glm::vec3>(given.colors, 2 * count, "set.colors");
    if (given.materials) set.materials = copied<std::uint32_t>(given.materials, count, "set.materials");
    if (!given.materials) set.materials.assign(count, new_material);
    return set;
}

claray_primitive_set set_of(const PrimitiveSet& set) {
    claray_primitive_set known{};
    known.name = set.name.c_str();
    put(known.kind, set.kind);
    known.points = floats_of(set.points), known.point_count = set.points.size();
    known.segments = set.segments.empty() ? nullptr : set.segments.data(), known.segment_count = set.segments.size();
    known.colors = floats_of(set.colors);
    known.materials = set.materials.empty() ? nullptr : set.materials.data();
    return known;
}

void give_box(float* place, const Bounds& box) {
    float* bounds = &required(place, "bounds");
    for (int axis = 0; axis < 3; ++axis) bounds[axis] = box.lo[axis], bounds[3 + axis] = box.hi[axis];
}

claray_lines* lines_of(const Warnings& warnings) { return new claray_lines{{warnings.begin(), warnings.end()}}; }

}  // namespace

claray_status claray_scene_create(claray_scene** scene) {
    return guarded([&] { hand_out(scene, "scene", [] { return new claray_scene{}; }); });
}

claray_status claray_scene_load(const char* name_or_path, claray_scene** scene) {
    return claray_scene_options_load(name_or_path, nullptr, nullptr, scene);
}

claray_status claray_scene_options_load(const char* name_or_path, const claray_load_options* options,
                                        claray_lines** warnings, claray_scene** scene) {
    return guarded([&] {
        const LoadOptions known = options_of(options);
        Warnings found;
        hand_out(scene, "scene",
                 [&] { return new claray_scene{load_scene(&required(name_or_path, "name_or_path"), found, known)}; });
        if (warnings) *warnings = lines_of(found);
    });
}

claray_status claray_animation_seconds(const char* name_or_path, const claray_load_options* options, double* seconds) {
    return guarded([&] {
        required(seconds, "seconds") =
            animation_seconds(&required(name_or_path, "name_or_path"), options_of(options)).value_or(-1);
    });
}

claray_status claray_scene_copy_create(const claray_scene* scene, claray_scene** copy) {
    return guarded([&] {
        const Scene& from = required(scene, "scene").scene;
        hand_out(copy, "copy", [&] { return new claray_scene{from}; });
    });
}

void claray_scene_release(claray_scene* scene) { delete scene; }

size_t claray_scene_count(const claray_scene* scene, claray_scene_part part) {
    std::size_t count = 0;
    if (scene)
        guarded([&] { with_part(scene->scene, part, [&](const auto& list, const char*) { count = list.size(); }); });
    return count;
}

claray_status claray_scene_truncate(claray_scene* scene, claray_scene_part part, size_t count) {
    return guarded([&] {
        with_part(required(scene, "scene").scene, part, [&](auto& list, const char* what) {
            if (count > list.size())
                refuse("count is " + std::to_string(count) + ", and there are " + std::to_string(list.size()) + " " +
                       what);
            list.resize(count);
        });
    });
}

size_t claray_scene_triangle_count(const claray_scene* scene) { return scene ? triangle_count(scene->scene) : 0; }
size_t claray_scene_primitive_count(const claray_scene* scene) { return scene ? primitive_count(scene->scene) : 0; }
const char* claray_scene_name(const claray_scene* scene) { return scene ? scene->scene.name.c_str() : ""; }
claray_status claray_scene_set_name(claray_scene* scene, const char* name) {
    return guarded([&] { required(scene, "scene").scene.name = text_of(name); });
}

claray_status claray_scene_mesh_set(claray_scene* scene, size_t index, const claray_mesh* mesh) {
    return guarded([&] {
        Scene& to = required(scene, "scene").scene;
        set_element(to.meshes, index, mesh_of(versioned(&required(mesh, "mesh"), "mesh")), "meshes");
    });
}
claray_status claray_scene_mesh_get(const claray_scene* scene, size_t index, claray_mesh* mesh) {
    return guarded(
        [&] { give(mesh, mesh_of(element(required(scene, "scene").scene.meshes, index, "meshes")), "mesh"); });
}

claray_status claray_scene_placement_set(claray_scene* scene, size_t index, const claray_placement* placement) {
    return guarded([&] {
        Scene& to = required(scene, "scene").scene;
        const claray_placement given = versioned(&required(placement, "placement"), "placement");
        MeshInstance instance;
        instance.mesh = given.mesh;
        instance.transform = matrix_of(given.transform);
        if (given.moves != 0) instance.transform_end = matrix_of(given.transform_end);
        instance.name = text_of(given.name);
        set_element(to.instances, index, std::move(instance), "placements");
    });
}
claray_status claray_scene_placement_get(const claray_scene* scene, size_t index, claray_placement* placement) {
    return guarded([&] {
        const MeshInstance& of = element(required(scene, "scene").scene.instances, index, "placements");
        claray_placement known{};
        known.name = of.name.c_str(), known.mesh = of.mesh, known.moves = of.transform_end ? 1 : 0;
        put_rows(known.transform, of.transform);
        put_rows(known.transform_end, of.transform_end.value_or(of.transform));
        give(placement, known, "placement");
    });
}

claray_status claray_scene_add_primitives(claray_scene* scene, const claray_primitive_set* set) {
    return guarded([&] {
        Scene& to = required(scene, "scene").scene;
        const claray_primitive_set given = versioned(&required(set, "set"), "set");
        Scene check;  // so that a fault leaves the scene as it was
        check.materials = to.materials;
        check.primitives = {set_of(given, std::uint32_t(to.materials.size()))};
        if (given.materials == nullptr) check.materials.emplace_back().albedo = glm::vec3(1.f);
        validate_primitives(check);
        to.materials = std::move(check.materials);
        to.primitives.push_back(std::move(check.primitives[0]));
    });
}
claray_status claray_scene_primitives_get(const claray_scene* scene, size_t index, claray_primitive_set* set) {
    return guarded([&] {
        give(set, set_of(element(required(scene, "scene").scene.primitives, index, "sets of primitives")), "set");
    });
}

claray_status claray_scene_bounds(const claray_scene* scene, float bounds[6]) {
    return guarded([&] { give_box(bounds, bounds_of(required(scene, "scene").scene)); });
}
claray_status claray_scene_mesh_bounds(const claray_scene* scene, size_t index, float bounds[6]) {
    return guarded(
        [&] { give_box(bounds, bounds_of(element(required(scene, "scene").scene.meshes, index, "meshes"))); });
}

claray_status claray_scene_validate(const claray_scene* scene) {
    return guarded([&] { validate(required(scene, "scene").scene); });
}

claray_status claray_scene_warnings_create(const claray_scene* scene, claray_lines** warnings) {
    return guarded([&] {
        const std::optional<std::string> line = warning_of_lamps(required(scene, "scene").scene);
        hand_out(warnings, "warnings",
                 [&] { return new claray_lines{line ? std::vector<std::string>{*line} : std::vector<std::string>{}}; });
    });
}

claray_status claray_scene_effects_create(const claray_scene* scene, claray_lines** causes, claray_lines** effects) {
    return guarded([&] {
        std::vector<std::string> names, firsts;
        for (const EffectCause& cause : causes_of_effects(required(scene, "scene").scene)) {
            names.emplace_back(name_of(cause.effect));
            firsts.push_back(cause.first);
        }
        hand_out(effects, "effects", [&] { return new claray_lines{std::move(names)}; });
        if (causes) *causes = new claray_lines{std::move(firsts)};
    });
}

claray_status claray_scene_without_effects_create(const claray_scene* scene, const char* effects,
                                                  claray_scene** without) {
    return guarded([&] {
        const Scene& from = required(scene, "scene").scene;
        const EffectSet removed = parse_effects(&required(effects, "effects"));
        hand_out(without, "without", [&] { return new claray_scene{without_effects(from, removed)}; });
    });
}

claray_status claray_scene_approximations_create(const claray_scene* scene, claray_lines** approximations) {
    return guarded([&] {
        std::vector<std::string> names;
        for (const Approximations& one : approximations_for(required(scene, "scene").scene))
            names.push_back(to_string(one));
        hand_out(approximations, "approximations", [&] { return new claray_lines{std::move(names)}; });
    });
}

claray_status claray_scene_set_culling(claray_scene* scene, claray_culling culling) {
    return guarded([&] { set_culling(required(scene, "scene").scene, enumerator(culling, "culling")); });
}
claray_status claray_scene_flip_fronts(claray_scene* scene) {
    return guarded([&] { flip_fronts(required(scene, "scene").scene); });
}
