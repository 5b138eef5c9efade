#include "host/textures/cutouts.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "host/textures/texture_use.hpp"

namespace claray {
namespace {

/// Returns whether a texture can make the opacity less than 1: by its alpha, or by red.
bool has_holes(const Texture& t, bool by_alpha) {
    if (by_alpha && t.channels % 2 == 1) return false;
    const std::size_t first = by_alpha ? t.channels - 1 : 0;
    for (std::size_t i = first; i < t.bytes.size() && t.format != TexelFormat::float32; i += t.channels)
        if (t.bytes[i] != 255) return true;
    for (std::size_t i = first; i < t.floats.size() && t.format == TexelFormat::float32; i += t.channels)
        if (!(t.floats[i] >= 1.f)) return true;
    return false;
}

bool has_holes(const Scene& scene, const TextureUse& use, bool by_alpha) {
    return use.used() && has_holes(checked_texture(scene, use.texture), by_alpha);
}

/// For each material, whether one of its triangles has an opacity below 1 at a corner.
std::vector<bool> find_vertex_alphas(const Scene& scene) {
    std::vector<bool> found(scene.materials.size());
    for (const Mesh& mesh : scene.meshes) {
        if (mesh.colors.empty()) continue;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const std::uint32_t material = mesh.materials.empty() ? 0 : mesh.materials.at(i);
            for (int k = 0; k < 3 && !found.at(material); ++k)
                found[material] = mesh.colors.at(mesh.triangles[i][k]).w < 1.f;
        }
    }
    return found;
}

/// From `least` to `most`, or all others.
struct Opacities {
    float least, most;
    bool outside;
};

/// Those at which a masked material exists.
Opacities masked_opacities(const Material& m) {
    constexpr float infinite = std::numeric_limits<float>::infinity();
    const float at = m.alpha_cutoff, above = std::nextafter(at, infinite);
    switch (m.alpha_test) {
        case AlphaTest::greater: return {above, infinite, false};
        case AlphaTest::less: return {at, infinite, true};
        case AlphaTest::less_equal: return {above, infinite, true};
        case AlphaTest::equal: return {at, at, false};
        case AlphaTest::not_equal: return {at, at, true};
        case AlphaTest::greater_equal: break;
    }
    return {at, infinite, false};
}

bool is_cut_out(const Scene& scene, const Material& m, bool by_vertices) {
    if (m.alpha_mode == AlphaMode::opaque) return false;
    const bool solid = m.alpha_mode == AlphaMode::mask ? passes_alpha_test(m, m.opacity) : m.opacity >= 1.f;
    return by_vertices || !solid || has_holes(scene, m.albedo_map, true) || has_holes(scene, m.opacity_map, false);
}

void add_vertex_alphas(const Mesh& mesh, const glm::uvec3& triangle, std::vector<std::uint32_t>& to) {
    for (int k = 0; k < 3; ++k)
        to.push_back(std::bit_cast<std::uint32_t>(mesh.colors.empty() ? 1.f : mesh.colors[triangle[k]].w));
}

/// Coordinates of a triangle's corners in the texture.
void add_corners(const Mesh& mesh, const glm::uvec3& triangle, const TextureUse& use, std::vector<std::uint32_t>& to) {
    const std::vector<glm::vec2>& uvs = use.uv_set == 0 ? mesh.uvs : mesh.uvs1;
    for (int k = 0; k < 3; ++k) {
        const glm::vec2 uv = transformed(use, triangle[k] < uvs.size() ? uvs[triangle[k]] : glm::vec2(0.f));
        to.push_back(std::bit_cast<std::uint32_t>(uv.x));
        to.push_back(std::bit_cast<std::uint32_t>(uv.y));
    }
}

}  // namespace

bool passes_alpha_test(const Material& material, float opacity) {
    const Opacities those = masked_opacities(material);
    return (opacity >= those.least && opacity <= those.most) != those.outside;
}

std::vector<bool> find_cut_outs(const Scene& scene, const std::vector<bool>& used) {
    std::vector<bool> found = find_vertex_alphas(scene);
    for (std::size_t i = 0; i < found.size(); ++i)
        found[i] = used[i] && is_cut_out(scene, scene.materials[i], found[i]);
    return found;
}

bool culls_everywhere(const Scene& scene, const std::vector<bool>& used) {
    bool any = false;
    const std::vector<bool> cut_outs = find_cut_outs(scene, used);
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        if (!used[i]) continue;
        if (!scene.materials[i].cull_back || cut_outs[i]) return false;
        any = true;
    }
    return any;
}

Cutouts::Cutouts(const Scene& scene, const std::vector<bool>& used,
                 const std::function<std::uint32_t(std::uint32_t)>& slot_of) {
    if (culls_everywhere(scene, used)) return;
    const std::vector<bool> cut_outs = find_cut_outs(scene, used), vertex_alphas = find_vertex_alphas(scene);
    std::vector<std::uint32_t> of_materials(scene.materials.size(), CLARAY_NO_MAP);
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& m = scene.materials[i];
        const bool cut = cut_outs[i];
        if (!cut && !(used[i] && m.cull_back)) continue;
        of_materials[i] = std::uint32_t(materials.size());
        CutoutMaterial data{};
        data.mode = (cut && m.alpha_mode == AlphaMode::mask ? CLARAY_CUT_MASK : 0u) |
                    (cut && m.alpha_mode == AlphaMode::blend ? CLARAY_CUT_BLEND : 0u) |
                    (cut && vertex_alphas[i] ? CLARAY_CUT_VERTEX_ALPHA : 0u) | (m.cull_back ? CLARAY_CUT_BACK : 0u);
        const Opacities those = masked_opacities(m);
        data.opacity = m.opacity, data.cutoff = those.least, data.most = those.most;
        if (cut && m.alpha_mode == AlphaMode::mask && those.outside) data.mode |= CLARAY_CUT_OUTSIDE;
        data.albedo = cut && has_holes(scene, m.albedo_map, true) ? slot_of(m.albedo_map.texture) : CLARAY_NO_MAP;
        data.opacity_map =
            cut && has_holes(scene, m.opacity_map, false) ? slot_of(m.opacity_map.texture) : CLARAY_NO_MAP;
        materials.push_back(data);
    }
    if (materials.empty()) return;
    for (const Mesh& mesh : scene.meshes) {
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const std::uint32_t index = mesh.materials.empty() ? 0 : mesh.materials[i];
            const std::uint32_t material = of_materials[index];
            of_triangles.push_back(material == CLARAY_NO_MAP ? CLARAY_NO_MAP : std::uint32_t(records.size()));
            if (material == CLARAY_NO_MAP) continue;
            records.push_back(material);
            const Material& m = scene.materials[index];
            if (materials[material].mode & CLARAY_CUT_VERTEX_ALPHA) add_vertex_alphas(mesh, mesh.triangles[i], records);
            if (materials[material].albedo != CLARAY_NO_MAP)
                add_corners(mesh, mesh.triangles[i], m.albedo_map, records);
            if (materials[material].opacity_map != CLARAY_NO_MAP)
                add_corners(mesh, mesh.triangles[i], m.opacity_map, records);
        }
    }
}

}  // namespace claray
