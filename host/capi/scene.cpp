// claray.h: scenes and images.
#include "host/capi/scene.hpp"

#include "claray/io.hpp"
#include "claray/renderer.hpp"
#include "host/capi/capi.hpp"

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

}  // namespace

claray_status claray_scene_load(const char* name_or_path, claray_scene** scene) {
    return guarded([&] {
        Warnings warnings;
        hand_out(scene, "scene",
                 [&] { return new claray_scene{load_scene(&required(name_or_path, "name_or_path"), warnings)}; });
    });
}

size_t claray_scene_triangle_count(const claray_scene* scene) { return scene ? triangle_count(scene->scene) : 0; }
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
