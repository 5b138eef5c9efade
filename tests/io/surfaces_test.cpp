// Which sides of a file's surfaces are there, and which of them is the front.
#include <gtest/gtest.h>

#include "claray/io.hpp"

namespace claray {
namespace {

Scene four_materials() {
    Scene scene;
    scene.materials.resize(4);
    scene.materials[0].cull_back = true;
    scene.materials[2].kind = MaterialKind::glass;
    scene.materials[3].kind = MaterialKind::glass, scene.materials[3].thin_walled = true;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {2, 0, 1}};
    scene.meshes = {mesh, mesh};
    return scene;
}

std::vector<bool> culled(Culling culling) {
    Scene scene = four_materials();
    set_culling(scene, culling);
    std::vector<bool> backs;
    for (const Material& m : scene.materials) backs.push_back(m.cull_back);
    return backs;
}

TEST(Culling, IsByFileOrForAllButSolidGlass) {
    EXPECT_EQ(culled(Culling::by_file), (std::vector<bool>{true, false, false, false}));
    EXPECT_EQ(culled(Culling::none), (std::vector<bool>{false, false, false, false}));
    EXPECT_EQ(culled(Culling::back), (std::vector<bool>{true, true, false, true}));
}

TEST(Fronts, AreFlippedByTheOrderOfVertices) {
    Scene scene = four_materials();
    flip_fronts(scene);
    for (const Mesh& mesh : scene.meshes) EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 2, 1}, {2, 1, 0}}));
}

}  // namespace
}  // namespace claray
