// Public structs are filled by naming members, without a warning about the others.
#include <gtest/gtest.h>

#include "claray/claray.hpp"
#include "claray/io.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wmissing-field-initializers"

namespace claray {
namespace {

TEST(NamedMembers, TheOthersHaveTheirDefaults) {
    const QueryOptions query = {.coherence = Coherence::coherent};
    EXPECT_FALSE(query.cull_back_faces || query.ray_masks.allocated() || !query.filter.source.empty());
    EXPECT_TRUE((PointOptions{.reach = 2.f}.sort));
    EXPECT_EQ((Bvh::Config{.builder = Builder::fast}.morton_bits), 63u);
    EXPECT_FALSE((TriangleBuffers{.positions = {}}.masks.allocated()));
    EXPECT_TRUE((HitFilter{.name = "all"}.source.empty()));
    EXPECT_EQ((PrimitiveKind{.name = "dust"}.floats), 0u);
    EXPECT_TRUE((PrimitiveSet{.name = "dust"}.points.empty()));
    EXPECT_TRUE((Mesh{.name = "mesh"}.triangles.empty()));
    EXPECT_TRUE((Material{.name = "red", .albedo = glm::vec3(1, 0, 0)}.parameters.empty()));
    EXPECT_EQ((CustomBsdf{.name = "dust"}.parameters), 0u);
    EXPECT_EQ((Light{.name = "lamp"}.range), 0.f);
    EXPECT_EQ((Sky{.horizon = glm::vec3(1)}.zenith), glm::vec3(0));
    EXPECT_TRUE((Environment{.strength = 2.f}.images.empty()));
    EXPECT_FALSE((Camera{.vertical_fov = 30.f}.position_end.has_value()));
    EXPECT_FALSE((MeshInstance{.mesh = 1}.transform_end.has_value()));
    EXPECT_TRUE((Texture{.name = "wood"}.bytes.empty()));
    EXPECT_TRUE((Scene{.name = "scene"}.meshes.empty()));
    EXPECT_EQ((RenderConfig{.width = 8}.height), RenderConfig{}.height);
    EXPECT_FALSE((SceneChanges{.camera = true}.lights));
    EXPECT_EQ((InstancedBvh::Config{.builder = Builder::high}.morton_bits), 63u);
    EXPECT_TRUE((LoadOptions{.camera = "front"}.images));
    EXPECT_EQ((PictureConfig{.exposure = 1.f}.width), 0u);
    EXPECT_TRUE((ImageLayer{.name = "depth"}.values.empty()));
    EXPECT_TRUE((Image{.width = 4}.pixels.empty()));
    EXPECT_TRUE((EffectOverrides{.add = {}}.remove.empty()));
}

}  // namespace
}  // namespace claray

#pragma GCC diagnostic pop
