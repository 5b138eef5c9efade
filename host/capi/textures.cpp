// claray.h: textures and environments, and those that are rendered: light maps and probes.
#include "claray/io.hpp"
#include "host/capi/members.hpp"
#include "host/capi/renderer.hpp"
#include "host/capi/scene.hpp"

using namespace claray;
using namespace claray::capi;

namespace {

claray_texture texture_of(const Texture& texture) {
    auto known = put_into<claray_texture>(texture);
    const bool floats = texture.format == TexelFormat::float32;
    known.texels = floats ? static_cast<const void*>(texture.floats.data()) : texture.bytes.data();
    return known;
}

LightMapConfig light_map_config_of(const claray_light_map_config* given) {
    const claray_light_map_config known = versioned(given, "config");
    LightMapConfig config;
    visit_pairs(known, config, TakeGiven{"config"});
    if (given) config.uv_set = known.uv_set;
    if (known.bvh) config.bvh = config_of(known.bvh);
    return config;
}

}  // namespace

namespace claray::capi {

Texture texture_of(const claray_texture* given, const char* name) {
    const claray_texture known = versioned(&required(given, name), name);
    const auto check = [&](std::uint32_t value, std::uint32_t most, const char* member) {
        if (value == 0 || value > most)
            refuse(std::string(name) + "." + member + " is " + std::to_string(value),
                   "use 1 to " + std::to_string(most));
    };
    check(known.width, 1u << 14, "width");
    check(known.height, 1u << 14, "height");
    check(known.channels, 4, "channels");
    Texture texture;
    visit_pairs(known, texture, Take{name});
    const std::size_t values = std::size_t(known.width) * known.height * known.channels;
    const std::string texels = std::string(name) + ".texels";
    if (texture.format == TexelFormat::float32)
        texture.floats = copied<float>(known.texels, values, texels.c_str());
    else
        texture.bytes = copied<std::uint8_t>(known.texels, values, texels.c_str());
    return texture;
}

}  // namespace claray::capi

claray_status claray_scene_texture_set(claray_scene* scene, size_t index, const claray_texture* texture) {
    return guarded([&] {
        Scene& to = required(scene, "scene").scene;
        set_element(to.textures, index, texture_of(texture, "texture"), "textures");
    });
}
claray_status claray_scene_texture_get(const claray_scene* scene, size_t index, claray_texture* texture) {
    return guarded([&] {
        give(texture, ::texture_of(element(required(scene, "scene").scene.textures, index, "textures")), "texture");
    });
}

claray_status claray_image_load(const char* path, claray_texel_format eight_bit, claray_image** image) {
    return guarded([&] {
        const TexelFormat bytes = enumerator(eight_bit, "eight_bit");
        hand_out(image, "image", [&] { return new claray_image{load_image(&required(path, "path"), bytes)}; });
    });
}
claray_status claray_normal_map_create(const claray_texture* heights, float strength, claray_image** image) {
    return guarded([&] {
        const Texture given = texture_of(heights, "heights");
        hand_out(image, "image", [&] { return new claray_image{normal_map_of(given, strength)}; });
    });
}
claray_status claray_panorama_create(const claray_scene* scene, claray_image** image) {
    return guarded([&] {
        const Environment& of = required(scene, "scene").scene.environment;
        if (of.images.empty()) refuse("scene: it has no environment", "set one by claray_scene_environment_set");
        hand_out(image, "image", [&] { return new claray_image{panorama_of(of)}; });
    });
}
claray_status claray_image_get(const claray_image* image, claray_texture* texture) {
    return guarded([&] { give(texture, ::texture_of(required(image, "image").texture), "texture"); });
}
void claray_image_release(claray_image* image) { delete image; }

claray_status claray_write_texture(const char* path, const claray_texture* texture) {
    return guarded([&] { write_texture(&required(path, "path"), texture_of(texture, "texture")); });
}

claray_status claray_scene_environment_set(claray_scene* scene, const claray_environment* environment) {
    return guarded([&] {
        Scene& to = required(scene, "scene").scene;
        const claray_environment given = versioned(&required(environment, "environment"), "environment");
        Environment known;
        for (const claray_texture* image : array(given.images, given.image_count, "environment.images"))
            known.images.push_back(texture_of(image, "environment.images"));
        if (given.strength != 0) known.strength = given.strength;
        known.rotation = given.rotation;
        to.environment = std::move(known);
    });
}
claray_status claray_scene_environment_get(const claray_scene* scene, claray_environment* environment) {
    return guarded([&] {
        const Environment& of = required(scene, "scene").scene.environment;
        give(environment, {sizeof(claray_environment), nullptr, of.images.size(), of.strength, of.rotation},
             "environment");
    });
}
claray_status claray_scene_environment_image_get(const claray_scene* scene, size_t index, claray_texture* texture) {
    return guarded([&] {
        const Environment& of = required(scene, "scene").scene.environment;
        give(texture, ::texture_of(element(of.images, index, "images")), "texture");
    });
}
claray_status claray_scene_environment_load(claray_scene* scene, const char* path, claray_lines** warnings) {
    return guarded([&] {
        Scene& to = required(scene, "scene").scene;
        Warnings found;
        to.environment = load_environment(&required(path, "path"), found);
        if (warnings) *warnings = new claray_lines{{found.begin(), found.end()}};
    });
}

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
