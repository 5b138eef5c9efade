// claray.h: scenes and images.
#include "host/capi/scene.hpp"

#include "claray/io.hpp"
#include "claray/renderer.hpp"
#include "host/capi/capi.hpp"
#include "host/primitives/scene_primitives.hpp"
#include "host/scene/validate.hpp"

using namespace claray;
using namespace claray::capi;

struct claray_renderer {
    unsigned width, height;
    Renderer renderer;
};

namespace {

RenderConfig config_of(const claray_render_config* given) {
    const claray_render_config known = versioned(given, "config");
    RenderConfig config;
    if (known.width != 0) config.width = known.width;
    if (known.height != 0) config.height = known.height;
    if (known.spp != 0) config.spp = known.spp;
    if (known.max_depth != 0) config.max_depth = known.max_depth;
    config.seed = known.seed;
    config.seconds = known.seconds, config.noise = known.noise, config.error = known.error;
    return config;
}

claray_progress progress_of(const RenderProgress& p) {
    claray_progress progress{};
    progress.struct_size = sizeof progress;
    progress.spp = p.spp;
    progress.seconds = p.seconds, progress.noise = p.noise, progress.error = p.error;
    return progress;
}

template <class T>
std::vector<T> copied(const void* data, std::size_t count, const char* name) {
    const std::span<const T> given = array(static_cast<const T*>(data), count, name);
    return {given.begin(), given.end()};
}

PrimitiveSet set_of(const claray_primitive_set& given, std::uint32_t new_material) {
    PrimitiveSet set;
    const std::string kind = &required(given.kind, "set.kind");
    const auto* row = std::find_if(std::begin(primitive_kind_names), std::end(primitive_kind_names),
                                   [&](const PrimitiveKindName& known) { return kind == known.name; });
    if (row == std::end(primitive_kind_names))
        throw Error(ErrorKind::usage, "set.kind is '" + kind + "'",
                    "use spheres, discs, cylinders, curves, bezier curves, flat curves or flat bezier curves");
    set.kind = row->kind;
    set.points = copied<glm::vec4>(given.points, given.point_count, "set.points");
    set.segments = copied<std::uint32_t>(given.segments, given.segment_count, "set.segments");
    const std::size_t count = primitive_count(set);
    if (given.colors) set.colors = copied<glm::vec3>(given.colors, 2 * count, "set.colors");
    if (given.materials) set.materials = copied<std::uint32_t>(given.materials, count, "set.materials");
    if (!given.materials) set.materials.assign(count, new_material);
    return set;
}

}  // namespace

claray_status claray_scene_load(const char* name_or_path, claray_scene** scene) {
    return guarded([&] {
        Warnings warnings;
        hand_out(scene, "scene",
                 [&] { return new claray_scene{load_scene(&required(name_or_path, "name_or_path"), warnings)}; });
    });
}

size_t claray_scene_triangle_count(const claray_scene* scene) { return scene ? triangle_count(scene->scene) : 0; }

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

size_t claray_scene_primitive_count(const claray_scene* scene) { return scene ? primitive_count(scene->scene) : 0; }
void claray_scene_release(claray_scene* scene) { delete scene; }

claray_status claray_renderer_create(claray_device* device, const claray_scene* scene,
                                     const claray_render_config* config, claray_renderer** renderer) {
    return guarded([&] {
        const RenderConfig known = config_of(config);
        hand_out(renderer, "renderer", [&] {
            return new claray_renderer{
                known.width, known.height,
                Renderer(required(device, "device").device, required(scene, "scene").scene, known)};
        });
    });
}

claray_status claray_renderer_render(claray_renderer* renderer, claray_progress_callback callback, void* user,
                                     claray_progress* reached) {
    return guarded([&] {
        const std::size_t room = reached ? versioned(reached, "reached").struct_size : 0;
        const auto call = [&](const RenderProgress& p) {
            const claray_progress progress = progress_of(p);
            return callback(&progress, user) != 0;
        };
        Renderer& used = required(renderer, "renderer").renderer;
        claray_progress progress = progress_of(callback ? used.render(call) : used.render());
        progress.struct_size = room;
        if (reached) std::memcpy(reached, &progress, std::min(room, sizeof progress));
    });
}

claray_status claray_renderer_image(claray_renderer* renderer, float* rgb, size_t count) {
    return guarded([&] {
        const claray_renderer& used = required(renderer, "renderer");
        const std::size_t needed = std::size_t(3) * used.width * used.height;
        if (count != needed)
            throw Error(ErrorKind::usage, "count is " + std::to_string(count) + ", and the image has " +
                                              std::to_string(needed) + " floats");
        const std::vector<glm::vec3> image = used.renderer.image();
        std::memcpy(&required(rgb, "rgb"), image.data(), needed * sizeof(float));
    });
}

void claray_renderer_release(claray_renderer* renderer) { delete renderer; }
