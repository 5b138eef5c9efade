#include "host/textures/texture_use.hpp"

#include <cmath>

#include "claray/error.hpp"

namespace claray {
namespace {

std::string name_of_texture(const Scene& scene, std::uint32_t texture) {
    const std::string& name = scene.textures[texture].name;
    return name.empty() ? "texture " + std::to_string(texture) : "texture '" + name + "'";
}

}  // namespace

const Texture& checked_texture(const Scene& scene, std::uint32_t index) {
    const Texture& t = scene.textures.at(index);
    constexpr unsigned largest = 1u << (CLARAY_TEXTURE_LEVELS - 1);
    if (t.width > largest || t.height > largest)
        throw Error(ErrorKind::user,
                    name_of_texture(scene, index) + " has " + std::to_string(t.width) + "x" + std::to_string(t.height) +
                        " texels",
                    "the maximum is " + std::to_string(largest) + " per side");
    return t;
}

std::vector<bool> used_materials(const Scene& scene) {
    std::vector<bool> used(scene.materials.size());
    const auto use = [&](const std::vector<std::uint32_t>& materials, bool any) {
        if (materials.empty() && any && !used.empty()) used[0] = true;
        for (const std::uint32_t material : materials)
            if (material < used.size()) used[material] = true;
    };
    for (const Mesh& mesh : scene.meshes) use(mesh.materials, !mesh.triangles.empty());
    for (const PrimitiveSet& set : scene.primitives) use(set.materials, primitive_count(set) > 0);
    return used;
}

TextureUseData data_of(const TextureUse& use, std::uint32_t texture) {  // v runs downwards
    const double c = std::cos(double(use.rotation)), s = std::sin(double(use.rotation));
    return {float(c * use.scale.x), float(s * use.scale.y), use.offset.x, float(-s * use.scale.x),
            float(c * use.scale.y), use.offset.y,           texture,      use.uv_set};
}

glm::vec2 transformed(const TextureUse& use, const glm::vec2& uv) {
    const TextureUseData d = data_of(use, 0);
    return {d.m00 * uv.x + d.m01 * uv.y + d.m02, d.m10 * uv.x + d.m11 * uv.y + d.m12};
}

}  // namespace claray
