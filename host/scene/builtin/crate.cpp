// Wooden crates: boards with bevelled edges in a few browns, held by battens, under a small strong sun.
#include <cmath>

#include "host/base/random.hpp"
#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

enum : std::uint32_t { earth, first_board, board_browns = 5, batten = first_board + board_browns, sun_lamp };

// A crate's own coordinates: unit cube from -1 to 1, turned about y, scaled and moved.
struct Placement {
    glm::vec3 center;
    float half;
    float turn;  // radians

    [[nodiscard]] glm::mat3 axes() const {
        const float c = std::cos(turn), s = std::sin(turn);
        return half * glm::mat3(glm::vec3(c, 0.f, -s), glm::vec3(0.f, 1.f, 0.f), glm::vec3(s, 0.f, c));
    }
};

constexpr float thickness = 0.05f;     // of a board, half
constexpr float batten_width = 0.13f;  // half
constexpr int boards = 6;

// One side of a crate. In `side` z points outwards, boards run along x and are stacked along y.
void add_side(Mesh& mesh, const glm::vec3& center, const glm::mat3& side, float half, Random& random) {
    const auto add = [&](glm::vec3 at, glm::vec3 along, glm::vec3 across, glm::vec3 out, std::uint32_t material) {
        add_beveled_box(mesh, center + side * at, side * glm::mat3(along, across, out), 0.014f * half, material);
    };
    const float pitch = 2.f / float(boards);
    for (int i = 0; i < boards; ++i) {
        const float y = (float(i) + 0.5f) * pitch - 1.f;
        const float depth = 0.9f + 0.012f * random.uniform();  // no two boards were nailed alike
        add({0.f, y, depth}, {0.985f, 0.f, 0.f}, {0.f, 0.5f * pitch - 0.008f, 0.f}, {0.f, 0.f, thickness},
            first_board + random.below(board_browns));
    }
    const float out = 0.9f + 2.f * thickness, reach = 1.f - batten_width;
    for (const float s : {-1.f, 1.f}) {
        add({s * reach, 0.f, out}, {batten_width, 0.f, 0.f}, {0.f, 1.f, 0.f}, {0.f, 0.f, thickness}, batten);
        add({0.f, s * reach, out}, {reach - batten_width, 0.f, 0.f}, {0.f, batten_width, 0.f}, {0.f, 0.f, thickness},
            batten);
    }
    // The brace from corner to corner, inside the frame.
    const float inner = reach - batten_width, d = std::sqrt(0.5f);
    const float length = std::sqrt(2.f) * inner - batten_width;
    add({0.f, 0.f, out - 0.004f}, length * glm::vec3(d, d, 0.f), batten_width * glm::vec3(-d, d, 0.f),
        {0.f, 0.f, thickness}, batten);
}

Mesh make_crate(const Placement& placement, std::uint64_t seed) {
    Mesh mesh = named_mesh("crate");
    Random random(seed);
    const glm::mat3 a = placement.axes();
    const glm::mat3 sides[] = {{a[0], a[1], a[2]},  {-a[2], a[1], a[0]}, {-a[0], a[1], -a[2]},
                               {a[2], a[1], -a[0]}, {a[0], -a[2], a[1]}, {a[0], a[2], -a[1]}};
    for (const glm::mat3& side : sides) add_side(mesh, placement.center, side, placement.half, random);
    return mesh;
}

}  // namespace

Scene crate() {
    Scene scene;
    scene.materials = {lambert("earth", {0.32f, 0.27f, 0.2f}),    lambert("pine", {0.52f, 0.33f, 0.16f}),
                       lambert("oak", {0.44f, 0.27f, 0.13f}),     lambert("larch", {0.48f, 0.26f, 0.12f}),
                       lambert("chestnut", {0.36f, 0.21f, 0.1f}), lambert("spruce", {0.58f, 0.4f, 0.22f}),
                       lambert("batten", {0.3f, 0.165f, 0.075f}), lamp("sun", {240.f, 215.f, 175.f})};
    Mesh ground = named_mesh("ground");
    add_rectangle(ground, {0.f, 0.f, 0.f}, {0.f, 0.f, 120.f}, {120.f, 0.f, 0.f}, earth);
    // A crate reaches 1.05 times its half size, for battens stand out; a small gap keeps surfaces apart.
    const auto standing = [](float x, float z, float floor, float half, float turn) {
        return Placement{{x, floor + 1.051f * half, z}, half, turn};
    };
    scene.meshes = {std::move(ground), make_crate(standing(0.f, 0.f, 0.f, 1.f, 0.45f), 1),
                    make_crate(standing(2.05f, -0.9f, 0.f, 0.72f, -0.3f), 2),
                    make_crate(standing(0.1f, -0.1f, 2.103f, 0.5f, 0.95f), 3),
                    make_lamp({-9.f, 14.f, 10.f}, {0.f, 1.f, 0.f}, 1.1f, sun_lamp)};
    scene.sky = {{0.62f, 0.66f, 0.7f}, {0.2f, 0.36f, 0.68f}};
    scene.camera = Camera{{-2.2f, 2.9f, 6.6f}, {0.55f, 1.3f, 0.f}, {0.f, 1.f, 0.f}, 38.f};
    return scene;
}

}  // namespace claray::scenes
