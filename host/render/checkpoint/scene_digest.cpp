// A digest of a scene without its names. Structured bindings name all members of the structs: this file does not
// compile after a member is added until it is named here.
#include <glm/glm.hpp>

#include "host/bsdf/custom_bsdfs.hpp"
#include "host/render/checkpoint/scene_digest.hpp"

namespace claray {
namespace {

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <class T>
concept PlainVector = requires(T v) {
    typename T::col_type;
}
|| requires(T v) { T::length(); };

class SceneHasher {
public:
    template <class... T>
    void add(const T&... all) {
        (put(all), ...);
    }
    [[nodiscard]] Digest digest() const { return hasher_.digest(); }

private:
    template <Plain T>
    void put(const T& value) {
        hasher_.add(&value, sizeof value);
    }
    template <PlainVector T>
    void put(const T& value) {
        hasher_.add(&value, sizeof value);
    }
    template <class T>
    void put(const std::optional<T>& value) {
        add(value.has_value());
        if (value) add(*value);
    }
    template <class T>
    void put(const std::vector<T>& values) {
        add(std::uint64_t(values.size()));
        if constexpr (Plain<T> || PlainVector<T>)
            hasher_.add(values.data(), values.size() * sizeof(T));
        else
            for (const T& value : values) add(value);
    }
    void put(const std::string& text) { hasher_.add(text.data(), text.size()); }
    void put(const Mesh& mesh) {
        const auto& [name, positions, normals, uvs, uvs1, tangents, colors, triangles, materials, mask] = mesh;
        add(positions, normals, uvs, uvs1, tangents, colors, triangles, materials, mask);
    }
    void put(const MeshInstance& instance) {
        const auto& [mesh, transform, transform_end] = instance;
        add(mesh, transform, transform_end);
    }
    void put(const Texture& texture) {
        const auto& [name, width, height, channels, format, bytes, floats, wrap_u, wrap_v, filter] = texture;
        add(width, height, channels, format, bytes, floats, wrap_u, wrap_v, filter);
    }
    void put(const TextureUse& use) {
        const auto& [texture, uv_set, offset, scale, rotation] = use;
        add(texture, uv_set, offset, scale, rotation);
    }
    void put(const Material& material) {
#define CLARAY_ROW(name, text, standard, check) , name
        const auto& [name, kind, albedo, emission, roughness, ior, metallic, transmission, thin_walled, clearcoat,
                     clearcoat_roughness, specular, specular_weight, specular_tint, sheen, sheen_roughness, anisotropy,
                     anisotropy_rotation, iridescence, iridescence_ior, film_thickness, attenuation,
                     attenuation_distance, opacity, alpha_mode, alpha_cutoff, alpha_test, cull_back, albedo_map,
                     emission_map, metallic_roughness_map, transmission_map, clearcoat_map, clearcoat_roughness_map,
                     clearcoat_normal_map, clearcoat_normal_scale, specular_map, specular_weight_map, shininess_map,
                     sheen_map, sheen_roughness_map, anisotropy_map, iridescence_map, film_thickness_map, opacity_map,
                     normal_map, normal_scale, height_map, height_scale, light_map, custom,
                     parameters CLARAY_BSDF_PARAMETERS(CLARAY_ROW)] = material;
        add(kind, albedo, emission, roughness, ior, metallic, transmission, thin_walled, clearcoat, clearcoat_roughness,
            specular, specular_weight, specular_tint, sheen, sheen_roughness, anisotropy, anisotropy_rotation,
            iridescence, iridescence_ior, film_thickness, attenuation, attenuation_distance, opacity, alpha_mode,
            alpha_cutoff, alpha_test, cull_back, custom, parameters);
        if (kind == MaterialKind::custom && custom < custom_bsdfs().size()) put(custom_bsdfs()[custom].source);
        add(albedo_map, emission_map, metallic_roughness_map, transmission_map, clearcoat_map, clearcoat_roughness_map,
            clearcoat_normal_map, clearcoat_normal_scale, specular_map, specular_weight_map, shininess_map, sheen_map,
            sheen_roughness_map, anisotropy_map, iridescence_map, film_thickness_map, opacity_map, normal_map,
            normal_scale, height_map, height_scale, light_map CLARAY_BSDF_PARAMETERS(CLARAY_ROW));
#undef CLARAY_ROW
    }
    void put(const Light& light) {
        const auto& [name, kind, position, direction, intensity, inner_angle, outer_angle, range, attenuation,
                     linear_range] = light;
        add(kind, position, direction, intensity, inner_angle, outer_angle, range, attenuation, linear_range);
    }
    void put(const Sky& sky) {
        const auto& [horizon, zenith] = sky;
        add(horizon, zenith);
    }
    void put(const Environment& environment) {
        const auto& [images, strength, rotation] = environment;
        add(images, strength, rotation);
    }
    void put(const Camera& camera) {
        const auto& [position, target, up, vertical_fov, aperture_radius, focus_distance, position_end, target_end,
                     orthographic_height] = camera;
        add(position, target, up, vertical_fov, aperture_radius, focus_distance, position_end, target_end,
            orthographic_height);
    }
    void put(const Scene& scene) {
        const auto& [name, meshes, instances, materials, textures, lights, sky, environment, camera] = scene;
        add(meshes, instances, materials, textures, lights, sky, environment, camera);
    }

    Hasher hasher_;
};

}  // namespace

Digest digest_of(const Scene& scene) {
    SceneHasher hasher;
    hasher.add(scene);
    return hasher.digest();
}

}  // namespace claray
