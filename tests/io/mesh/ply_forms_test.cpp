// What PLY files of other programs hold: rows and elements out of order, colours, images, points.
#include <gtest/gtest.h>

#include <cmath>

#include "host/io/image/color.hpp"
#include "tests/io/expect_error.hpp"

namespace claray {
namespace {

const std::string vertex_xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string face_list = "property list uchar int vertex_indices\n";

class PlyForms : public test::ReaderTest {
protected:
    Scene load(const std::string& elements, const std::string& rows, const LoadOptions& options = {}) {
        warnings.clear();
        const std::string text = "ply\nformat ascii 1.0\n" + elements + "end_header\n" + rows;
        return load_scene(folder.file("mesh.ply", text).string(), warnings, options);
    }
    /// A square of two triangles whose vertices and faces have further properties.
    Scene square(const std::string& of_vertices, const std::string& of_faces, const std::vector<std::string>& vertices,
                 const std::vector<std::string>& faces, const std::string& comments = {}) {
        const char* const corners[] = {"0 0 0 ", "1 0 0 ", "1 1 0 ", "0 1 0 "};
        const char* const triangles[] = {"3 0 1 2 ", "3 0 2 3 "};
        std::string rows;
        for (std::size_t i = 0; i < 4; ++i) rows += corners[i] + vertices[i % vertices.size()] + "\n";
        for (std::size_t i = 0; i < 2; ++i) rows += triangles[i] + faces[i % faces.size()] + "\n";
        return load(
            comments + "element vertex 4\n" + vertex_xyz + of_vertices + "element face 2\n" + face_list + of_faces,
            rows);
    }
};

const std::string bytes_rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

TEST_F(PlyForms, NumbersBehindARowDoNotRunIntoTheNext) {
    const Scene scene = square("", "", {"7 8", ""}, {"9"});
    EXPECT_EQ(scene.meshes.at(0).positions[1], glm::vec3(1, 0, 0));
    EXPECT_EQ(scene.meshes[0].triangles[1], glm::uvec3(0, 2, 3));
    EXPECT_EQ(warned("mesh.ply' line 10 (and 3 more): more values than the header states"), 1u);
}

TEST_F(PlyForms, RowsMayBeBrokenOrOnOneLine) {
    const std::string elements = "element vertex 3\n" + vertex_xyz + "element face 1\n" + face_list;
    for (const char* rows : {"0 0\n0\n1 0 0\n\n0 1 0\n3 0\n1 2\n", "0 0 0 1 0 0 0 1 0 3 0 1 2\n"}) {
        const Scene scene = load(elements, rows);
        EXPECT_EQ(scene.meshes.at(0).positions[2], glm::vec3(0, 1, 0)) << rows;
        EXPECT_EQ(warned("more values"), 0u) << rows;
    }
}

TEST_F(PlyForms, ElementsInAnyOrder) {
    const Scene scene = load("element tristrips 1\n" + face_list + "element face 1\n" + face_list +
                                 "element other 1\n" + "property int a\nelement vertex 3\n" + vertex_xyz,
                             "3 0 2 1\n3 0 1 2\n5\n0 0 0\n1 0 0\n0 1 0\n");
    EXPECT_EQ(scene.meshes.at(0).triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 1}}));
}

TEST_F(PlyForms, FacesHaveColoursOfTheirOwn) {
    const Mesh mesh = square("", bytes_rgb, {""}, {"255 0 0", "0 0 255"}).meshes.at(0);
    ASSERT_EQ(mesh.positions.size(), 6u) << "two vertices are in both triangles";
    for (const std::uint32_t i : {0u, 1u, 2u}) {
        EXPECT_EQ(mesh.colors.at(mesh.triangles[0][int(i)]), glm::vec4(1, 0, 0, 1));
        EXPECT_EQ(mesh.colors.at(mesh.triangles[1][int(i)]), glm::vec4(0, 0, 1, 1));
    }
    EXPECT_EQ(square("", bytes_rgb, {""}, {"9 9 9"}).meshes.at(0).positions.size(), 4u);
    const Mesh longer = square("", bytes_rgb, {""}, {"9 1 1 1 1"}).meshes.at(0);
    EXPECT_EQ(longer.colors.at(0), glm::vec4(1)) << "a row that does not follow its header says no colour";
}

TEST_F(PlyForms, ColoursOfOtherNamesAndRanges) {
    const auto first = [&](const std::string& properties, const std::string& values) {
        const Mesh mesh = square(properties, "", {values}, {""}).meshes.at(0);
        return mesh.colors.empty() ? -1.f : mesh.colors[0].x;
    };
    const float dark = linear_from_display(glm::dvec3(10 / 255.0)).x;
    EXPECT_EQ(first("property uchar intensity\n", "10"), dark);
    EXPECT_EQ(first("property uchar Gray\n", "10"), dark);
    EXPECT_EQ(first("property float intensity\n", "10"), -1.f) << "of a scanner, without a known range";
    const auto rgb = [](const std::string& type, const std::string& r, const std::string& g, const std::string& b) {
        return "property " + type + ' ' + r + "\nproperty " + type + ' ' + g + "\nproperty " + type + ' ' + b + '\n';
    };
    EXPECT_EQ(first(rgb("uchar", "diffuse_red", "diffuse_green", "diffuse_blue"), "10 0 0"), dark);
    EXPECT_EQ(first(rgb("uchar", "R", "G", "B"), "10 0 0"), dark);
    EXPECT_EQ(first(rgb("int", "red", "green", "blue"), "10 255 0"), dark);
    EXPECT_EQ(first(rgb("ushort", "red", "green", "blue"), "2570 65535 0"), dark);
    EXPECT_EQ(first(rgb("float", "red", "green", "blue"), "10 255 0"), dark);
    EXPECT_EQ(first(rgb("float", "red", "green", "blue"), "1.5 0 0"), 1.f) << "clamped";
}

TEST_F(PlyForms, ImagesByComment) {
    const std::string pfm = std::string("PF\n1 1\n-1\n") + std::string(12, '\0');
    static_cast<void>(folder.file("a b.pfm", pfm)), static_cast<void>(folder.file("c.pfm", pfm));
    const std::string uv = "property float s\nproperty float t\n";
    Scene scene = square(uv, "", {"0 0.25"}, {""}, "comment TextureFile a b.pfm\n");
    EXPECT_EQ(scene.textures.size(), 1u);
    EXPECT_TRUE(scene.materials.at(0).albedo_map.used());
    EXPECT_EQ(scene.meshes.at(0).uvs[0], glm::vec2(0, 0.75f));
    const std::string corners = "property list uchar float texcoord\nproperty int texnumber\n";
    scene = square("", corners, {""}, {"6 0 0 1 0 1 1 0", "6 0 0 1 1 0 1 1"},
                   "comment TextureFile a b.pfm\ncomment TextureFile c.pfm\n");
    EXPECT_EQ(scene.textures.size(), 2u);
    EXPECT_EQ(scene.meshes.at(0).materials, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_EQ(scene.meshes[0].uvs.at(scene.meshes[0].triangles[0].y), glm::vec2(1, 1));
    EXPECT_EQ(scene.meshes[0].positions.size(), 4u) << "corners that agree are one";
    scene = square(uv, "", {"0 0"}, {""}, "comment TextureFile gone.png\n");
    EXPECT_EQ(scene.materials.at(0).albedo, glm::vec3(0.5f));
    EXPECT_EQ(warned("mesh.ply': the image 'gone.png' is missing"), 1u);
    square("", "", {""}, {""}, "comment TextureFile c.pfm\n");
    EXPECT_EQ(warned("has no texture coordinates"), 1u);
}

TEST_F(PlyForms, PointsAndEdgesAreDrawn) {
    const std::string points = "element vertex 3\n" + vertex_xyz + bytes_rgb;
    const std::string rows = "0 0 0 255 0 0\n1 0 0 0 255 0\n0 inf 0 0 0 255\n";
    Scene scene = load(points, rows, {.stroke_radius = 0.5f});
    ASSERT_EQ(scene.primitives.size(), 1u);
    EXPECT_EQ(scene.primitives[0].points, (std::vector<glm::vec4>{{0, 0, 0, 0.5f}, {1, 0, 0, 0.5f}}))
        << "those that are finite";
    EXPECT_EQ(scene.primitives[0].colors.at(2), glm::vec3(0, 1, 0));
    EXPECT_EQ(warned("1 vertices are not finite or exceed float32"), 1u);
    scene = load(points + "element edge 1\nproperty int vertex1\nproperty int vertex2\n", rows + "0 1\n");
    ASSERT_EQ(scene.primitives.size(), 2u);
    EXPECT_EQ(scene.primitives[1].kind, PrimitiveSet::Kind::cylinders);
}

TEST_F(PlyForms, NumbersBeyondFloatAreNotZero) {
    const Scene scene = load("element vertex 3\n" + vertex_xyz + "element face 1\n" + face_list,
                             "0 0 1e-400\n1e400 1e39 -1e400\n0 1 0\n3 0 1 2\n");
    EXPECT_EQ(scene.meshes.at(0).positions[0], glm::vec3(0));
    EXPECT_EQ(scene.meshes[0].positions[1], glm::vec3(INFINITY, INFINITY, -INFINITY));
    EXPECT_EQ(warned("1 vertices are not finite or exceed float32"), 1u);
}

}  // namespace
}  // namespace claray
