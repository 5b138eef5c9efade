#include "tests/render/textures/textures.hpp"

#include "tests/support/meshes.hpp"

namespace claray::test {

Texture random_texture(glm::uvec2 size, unsigned channels, TexelFormat format, std::uint64_t seed) {
    Random random(seed);
    Texture t;
    t.width = size.x, t.height = size.y, t.channels = channels, t.format = format;
    for (unsigned i = 0; i < size.x * size.y * channels; ++i) {
        if (format == TexelFormat::float32)
            t.floats.push_back(random.uniform());
        else
            t.bytes.push_back(std::uint8_t(random.below(256)));
    }
    return t;
}

Material lambert_material() {
    Material m;
    m.albedo = glm::vec3(1.f);
    return m;
}

Material textured(std::uint32_t texture) {
    Material m = lambert_material();
    m.albedo_map.texture = texture;
    return m;
}

Mesh mapped_square(std::uint32_t material) {
    Mesh mesh;
    mesh.positions = {{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}};
    mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.materials = {material, material};
    return mesh;
}

}  // namespace claray::test
