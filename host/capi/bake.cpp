// claray.h: light maps and probes.
#include "host/capi/members.hpp"
#include "host/capi/renderer.hpp"
#include "host/capi/scene.hpp"

using namespace claray;
using namespace claray::capi;

namespace {

LightMapConfig light_map_config_of(const claray_light_map_config* given) {
    const claray_light_map_config known = versioned(given, "config");
    LightMapConfig config;
    visit_pairs(known, config, TakeGiven{"config"});
    if (given) config.uv_set = known.uv_set;
    if (known.bvh) config.bvh = config_of(known.bvh);
    return config;
}

}  // namespace

claray_status claray_probe_render(claray_device* device, const claray_scene* scene, const float position[3],
                                  const claray_render_config* config, claray_scene* to) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const Scene& from = required(scene, "scene").scene;
        const float* at = &required(position, "position");
        Scene& place = required(to, "to").scene;
        place.environment = render_probe(on, from, {at[0], at[1], at[2]}, render_config_of(config));
    });
}

claray_status claray_light_map_create(claray_device* device, const claray_scene* scene, size_t mesh,
                                      const claray_light_map_config* config, claray_fraction_callback callback,
                                      void* user, claray_image** image) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const Scene& from = required(scene, "scene").scene;
        const LightMapConfig known = light_map_config_of(config);
        std::function<bool(double)> progress;
        if (callback) progress = [=](double done) { return callback(done, user) != 0; };
        hand_out(image, "image", [&] { return new claray_image{bake_light_map(on, from, mesh, known, progress)}; });
    });
}

claray_status claray_light_map_uv_set(const claray_scene* scene, size_t mesh, uint32_t* uv_set) {
    return guarded([&] {
        const Scene& of = required(scene, "scene").scene;
        static_cast<void>(element(of.meshes, mesh, "meshes", "mesh"));
        required(uv_set, "uv_set") = light_map_uv_set(of, mesh);
    });
}

claray_status claray_scene_light_map_set(claray_scene* scene, size_t mesh, const claray_texture* light_map,
                                         uint32_t uv_set) {
    return guarded([&] {
        Scene& to = required(scene, "scene").scene;
        use_light_map(to, mesh, texture_of(light_map, "light_map"), uv_set);
    });
}
