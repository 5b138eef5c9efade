// Cryptomattes: host/render/layers/cryptomatte.cpp, host/base/matte_hash.cpp and kernel write_numbers of
// render/write_aovs.cl.
#include "claray/cryptomatte.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <set>

#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

/// Values that the reference implementation of MurmurHash3_x86_32 gives (PyPI: mmh3), of all lengths of a tail.
TEST(MatteHash, IsThatOfTheReference) {
    const std::map<std::string, std::uint32_t> known = {
        {"", 0x00000000u},      {"a", 0x3c2569b2u},
        {"ab", 0x9bbfd75fu},    {"abc", 0xb3dd93fau},
        {"hello", 0x248bfa47u}, {"The quick brown fox jumps over the lazy dog", 0x2e4ff723u},
        {"bunny", 0x13851a76u}, {"crypto_object", 0xf834d0a6u}};
    for (const auto& [name, hash] : known) EXPECT_EQ(matte_hash(name), hash) << name;
}

TEST(MatteHash, GivesNumbersThatFilesKeep) {
    for (const std::uint32_t hash : {0u, 1u, 0x7f800000u, 0xff800001u, 0x80000000u, 0x12345678u}) {
        const float id = matte_id(hash);
        EXPECT_TRUE(std::isnormal(id)) << hash;
        EXPECT_EQ(std::bit_cast<std::uint32_t>(id) | 1u << 23, hash | 1u << 23) << "at most one bit differs";
    }
}

/// A floor that fills the image, half a ball's material on it, and a second ball of the same name.
Scene named_scene() {
    Scene scene;
    scene.materials = {lambert(0.5f), lambert(0.6f)};
    scene.materials[0].name = "grey", scene.materials[1].name = "white";
    scene.meshes = {square(20.f, 0.f), sphere(2)};
    scene.meshes[0].name = "floor", scene.meshes[1].name = "ball";
    scene.meshes[1].materials.assign(scene.meshes[1].triangles.size(), 1);
    const auto at = [](float x) { return glm::translate(glm::mat4(1.f), glm::vec3(x, 1, 0)); };
    scene.instances = {{0, glm::mat4(1.f)}, {1, at(-2)}, {1, at(0)}, {1, at(2)}};
    scene.instances[0].name = "ground", scene.instances[1].name = "left";
    scene.instances[2].name = "twin", scene.instances[3].name = "twin";
    scene.camera = Camera{{0, 8, 6}, {0, 0, 0}, {0, 1, 0}, 45.f};
    return scene;
}

std::map<float, double> shares_of(const Cryptomatte& matte) {
    std::map<float, double> shares;
    for (const MattePart& part : matte.parts) shares[part.id] += double(part.coverage);
    return shares;
}

TEST(Cryptomatte, TellsThingsApartByTheirNames) {
    const Scene scene = named_scene();
    const Renderer renderer(device(), scene, {.width = 40, .height = 30, .spp = 1});
    const auto names_in = [&](MatteKind kind) {
        const Cryptomatte matte = cryptomatte(renderer, kind, 16);
        const std::map<float, double> shares = shares_of(matte);
        std::set<std::string> seen;
        for (const auto& [name, hash] : matte.manifest) {
            EXPECT_EQ(hash, matte_hash(name));
            if (shares.contains(matte_id(hash))) seen.insert(name);
        }
        return seen;
    };
    EXPECT_EQ(names_in(MatteKind::object), (std::set<std::string>{"ground", "left", "twin"}));
    EXPECT_EQ(names_in(MatteKind::asset), (std::set<std::string>{"floor", "ball"}));
    EXPECT_EQ(names_in(MatteKind::material), (std::set<std::string>{"grey", "white"}));
    const auto objects = shares_of(cryptomatte(renderer, MatteKind::object, 16));
    const auto assets = shares_of(cryptomatte(renderer, MatteKind::asset, 16));
    const auto share = [](const std::map<float, double>& of, const char* name) {
        return of.at(matte_id(matte_hash(name)));
    };
    EXPECT_NEAR(share(objects, "left") + share(objects, "twin"), share(assets, "ball"), 1e-3);
    EXPECT_NEAR(share(objects, "twin"), 2 * share(objects, "left"), 0.1 * share(objects, "left"));
}

TEST(Cryptomatte, CoversEachPixelOnce) {
    const Renderer renderer(device(), named_scene(), {.width = 40, .height = 30, .spp = 1});
    const Cryptomatte matte = cryptomatte(renderer, MatteKind::object, 32);
    ASSERT_EQ(matte.parts.size(), matte.ranks * 40 * 30);
    EXPECT_EQ(matte.ranks % 2, 0u);
    std::size_t mixed = 0;
    for (std::size_t i = 0; i < matte.parts.size(); i += matte.ranks) {
        double sum = 0;
        for (unsigned rank = 0; rank < matte.ranks; ++rank) {
            sum += double(matte.parts[i + rank].coverage);
            if (rank > 0) {
                ASSERT_LE(matte.parts[i + rank].coverage, matte.parts[i + rank - 1].coverage);
            }
            ASSERT_EQ(matte.parts[i + rank].id == 0.f, matte.parts[i + rank].coverage == 0.f);
        }
        ASSERT_NEAR(sum, 1, 1e-6);
        mixed += matte.parts[i + 1].coverage > 0 ? 1 : 0;
    }
    EXPECT_GT(mixed, 20u) << "edges of the balls";
}

/// A square that covers a known part of pixels, under an open sky.
TEST(Cryptomatte, CoverageIsTheAreaInThePixel) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(1.f, 0.f)};
    scene.camera = Camera{{0, 4, 0}, {0, 0, 0}, {0, 0, -1}, 53.13010235f};  // half the image's height is 2 on the plane
    const Renderer renderer(device(), scene, {.width = 5, .height = 5, .spp = 1});
    const Cryptomatte matte = cryptomatte(renderer, MatteKind::object, 256);
    EXPECT_EQ(matte.manifest.at(0).first, "mesh 0");
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 5; ++x) {
            const auto part = [](int i) { return std::clamp(1.0 - (std::abs(i - 2) - 0.5) * 0.8, 0.0, 0.8) / 0.8; };
            const double expected = std::min(part(x), 1.0) * std::min(part(y), 1.0);
            EXPECT_NEAR(matte.parts[matte.ranks * std::size_t(5 * y + x)].coverage, expected, 0.02) << x << ' ' << y;
        }
}

TEST(Cryptomatte, SeesTheMotion) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(1.f, 0.f)};
    scene.meshes[0].name = "plate";
    scene.instances = {{0, glm::mat4(1.f), glm::translate(glm::mat4(1.f), glm::vec3(4, 0, 0))}};
    scene.instances[0].name = "mover";
    scene.camera = narrow_camera({1, 4, 0}, {1, 0, 0.01f});
    const Renderer renderer(device(), scene, {.width = 2, .height = 2, .spp = 1});
    for (const MattePart& part : cryptomatte(renderer, MatteKind::object, 256).parts)
        if (part.id != 0.f) {
            EXPECT_NEAR(part.coverage, 0.5, 0.02) << "it is there half of the time";
        }
}

TEST(Cryptomatte, KeepsTheSamples) {
    Renderer renderer(device(), named_scene(), {.width = 20, .height = 20, .spp = 4});
    renderer.render();
    const std::vector<glm::vec3> before = renderer.image();
    (void)cryptomatte(renderer, MatteKind::material, 3);
    EXPECT_EQ(renderer.image(), before);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "samples", [&] { (void)cryptomatte(renderer, MatteKind::object, 0); }));
}

}  // namespace
}  // namespace claray::test
