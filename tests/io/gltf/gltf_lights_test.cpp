// glTF: the image around a scene (EXT_lights_image_based).
#include <cmath>
#include <numbers>

#include "host/io/image/write/encode.hpp"
#include "tests/io/gltf/gltf_fixture.hpp"

namespace claray::test {
namespace {

class GltfEnvironment : public GltfTest {
protected:
    GltfEnvironment() {
        builder.triangle();
        json faces = json::array();
        for (int face = 0; face < 6; ++face) faces.push_back(image(2, 2, 3, std::string(12, char(40 * face))));
        builder.root["extensions"]["EXT_lights_image_based"]["lights"] = {
            {{"intensity", 0.5},
             {"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}},
             {"specularImageSize", 2},
             {"irradianceCoefficients", json::array()},
             {"specularImages", {faces}}}};
        builder.root["extensionsRequired"] = {"EXT_lights_image_based"};
        builder.root["scenes"] = {{{"nodes", {0}}, {"extensions", {{"EXT_lights_image_based", {{"light", 0}}}}}}};
    }
    json& light() { return builder.root["extensions"]["EXT_lights_image_based"]["lights"][0]; }
    int image(unsigned width, unsigned height, unsigned channels, const std::string& bytes) {
        const std::vector<unsigned char> values(bytes.begin(), bytes.end());
        const std::string png = encode_png(width, height, channels, values);
        return builder.push("images", {{"uri", "data:image/png;base64," + base64(png)}});
    }
};

TEST_F(GltfEnvironment, IsACubeThatTurnsAgainstTheQuaternion) {
    const Environment environment = load().environment;
    ASSERT_EQ(environment.images.size(), 6u);
    for (int face = 0; face < 6; ++face) {
        const Texture& texture = environment.images[std::size_t(face)];
        const double encoded = 40 * face / 255.0;
        EXPECT_NEAR(texture.floats.at(0), encoded <= 0.04045 ? 0 : std::pow((encoded + 0.055) / 1.055, 2.4), 1e-6);
    }
    EXPECT_EQ(environment.strength, 0.5f);
    EXPECT_NEAR(environment.rotation, -std::numbers::pi / 2, 1e-6);
    EXPECT_EQ(warned("studio"), 0u) << "the file has its light";
    EXPECT_EQ(warned("not supported"), 0u);
    light()["rotation"] = {0.5, 0, 0, std::sqrt(0.75)};
    load();
    EXPECT_EQ(warned("is tilted"), 1u);
}

/// Upside down, and divided by alpha.
TEST_F(GltfEnvironment, FacesAreRgbd) {
    std::string bytes;
    for (const int row : {0, 1})
        for (const int column : {0, 1}) bytes += {char(row ? 255 : 0), char(column ? 255 : 0), char(255), char(51)};
    light()["specularImages"][0][2] = image(2, 2, 4, bytes);
    const Texture top = load().environment.images.at(2);
    EXPECT_EQ(top.channels, 3u);
    const std::vector<float> expected = {5, 0, 5, 5, 5, 5, 0, 0, 5, 0, 5, 5};
    ASSERT_EQ(top.floats.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(top.floats[i], expected[i], 1e-5) << i;
}

TEST_F(GltfEnvironment, BadOnesAreNamed) {
    const json good = builder.root;
    const auto with = [&](const std::string& words, auto change) {
        builder.root = good;
        change(builder.root);
        refuse({"scene.gltf", words});
    };
    with("the scene refers to light 3 of 1 of EXT_lights_image_based",
         [](json& root) { root["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 3; });
    with("has no six specularImages", [&](json&) { light()["specularImages"][0].erase(5); });
    with("has no six specularImages", [&](json&) { light().erase("specularImages"); });
    with("refers to image 99 of 6", [&](json&) { light()["specularImages"][0][4] = 99; });
    with("are no squares of one size",
         [&](json&) { light()["specularImages"][0][4] = image(2, 1, 3, std::string(6, 'x')); });
    builder.root = good;
    builder.root["images"][1] = {{"uri", "gone.png"}};
    EXPECT_TRUE(load().environment.images.size() != 6) << "and the studio lights it";
    EXPECT_EQ(warned("gone.png"), 1u);
}

}  // namespace
}  // namespace claray::test
