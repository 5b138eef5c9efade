// Spheres of every material on a chequered floor, under a square lamp and a pale sky.
#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

enum : std::uint32_t { light_tile, dark_tile, red, blue, gold, copper, steel, silver, clear, light };

constexpr unsigned sphere_levels = 5;  // 20,480 triangles a sphere

// One mesh of `tiles` x `tiles` unit squares, all vertices shared, coloured like a chessboard.
Mesh make_floor(unsigned tiles) {
    Mesh mesh = make_height_field(tiles, 0.5f * float(tiles), [](double, double) { return 0.0; });
    mesh.name = "floor";
    mesh.normals.clear();
    for (unsigned j = 0; j < tiles; ++j)
        for (unsigned i = 0; i < tiles; ++i)
            mesh.materials.insert(mesh.materials.end(), 2, (i + j) % 2 ? dark_tile : light_tile);
    return mesh;
}

}  // namespace

Scene spheres() {
    Scene scene;
    scene.materials = {lambert("light tile", {0.62f, 0.6f, 0.56f}), lambert("dark tile", {0.16f, 0.17f, 0.19f}),
                       lambert("red", {0.7f, 0.09f, 0.06f}),        lambert("blue", {0.08f, 0.2f, 0.55f}),
                       metal("gold", {1.f, 0.71f, 0.29f}, 0.2f),    metal("copper", {0.95f, 0.64f, 0.54f}, 0.45f),
                       metal("steel", {0.56f, 0.57f, 0.58f}, 0.7f), mirror("silver", {0.95f, 0.93f, 0.88f}),
                       glass("clear", {0.98f, 1.f, 0.99f}, 1.5f),   lamp("light", {14.f, 13.f, 11.f})};
    scene.meshes = {make_floor(24),
                    make_sphere({-2.7f, 1.f, -0.9f}, 1.f, sphere_levels, red),
                    make_sphere({-0.4f, 1.2f, -1.8f}, 1.2f, sphere_levels, silver),
                    make_sphere({2.2f, 1.f, -1.2f}, 1.f, sphere_levels, gold),
                    make_sphere({0.5f, 0.8f, 0.7f}, 0.8f, sphere_levels, clear),
                    make_sphere({-1.3f, 0.6f, 1.1f}, 0.6f, sphere_levels, copper),
                    make_sphere({2.2f, 0.55f, 1.1f}, 0.55f, sphere_levels, steel),
                    make_sphere({-0.35f, 0.35f, 2.1f}, 0.35f, sphere_levels, blue),
                    make_lamp({-3.f, 7.f, 4.f}, {0.f, 0.f, 0.f}, 1.3f, light)};
    scene.sky = {{0.75f, 0.8f, 0.85f}, {0.25f, 0.4f, 0.7f}};
    scene.camera = Camera{{0.6f, 2.9f, 9.f}, {0.f, 0.8f, 0.f}, {0.f, 1.f, 0.f}, 36.f};
    return scene;
}

}  // namespace claray::scenes
