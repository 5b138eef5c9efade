// Eight statues of 100,000 triangles each along a walk: marble and bronze figures in pleated robes on square plinths.
// The scene is made for heat maps: boxes of fine folds beside a background that costs a single box.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host/base/random.hpp"
#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/noise.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

enum : std::uint32_t { marble, limestone, bronze, pavement };

// A row of triangles at the top and rows of twice as many below: 160 * (1 + 2 * 312) = 100,000.
constexpr unsigned around = 160, rows = 312;
constexpr double pi = std::numbers::pi;
constexpr double plinth_height = 0.55;

/// Radius and height of the outline, from the ground to the top of the head.
constexpr std::array<std::array<double, 2>, 20> outline = {
    {{0.47, 0.0},           {0.47, 0.1},   {0.4, 0.13},   {0.4, 0.42},  {0.45, 0.45},
     {0.45, plinth_height}, {0.36, 0.555}, {0.35, 0.62},  {0.3, 1.0},   {0.24, 1.4},
     {0.19, 1.6},           {0.23, 1.8},   {0.24, 1.97},  {0.16, 2.06}, {0.085, 2.11},
     {0.075, 2.18},         {0.12, 2.24},  {0.145, 2.36}, {0.11, 2.5},  {0.0, 2.55}}};

using OutlinePoint = std::array<double, 2>;

/// Length of the outline up to each of its points.
std::array<double, outline.size()> lengths_of_outline() {
    std::array<double, outline.size()> length{};
    for (std::size_t i = 1; i < outline.size(); ++i)
        length[i] = length[i - 1] + std::hypot(outline[i][0] - outline[i - 1][0], outline[i][1] - outline[i - 1][1]);
    return length;
}
const std::array<double, outline.size()> lengths = lengths_of_outline();

/// A point of the outline at a share of its length.
OutlinePoint point_of_outline(double share) {
    const double at = share * lengths.back();
    std::size_t i = 1;
    while (i + 1 < outline.size() && lengths[i] < at) ++i;
    const double part = (at - lengths[i - 1]) / (lengths[i] - lengths[i - 1]);
    return {outline[i - 1][0] + part * (outline[i][0] - outline[i - 1][0]),
            outline[i - 1][1] + part * (outline[i][1] - outline[i - 1][1])};
}

/// The same with rounded corners: the mean over a short piece.
OutlinePoint point_of_rounded_outline(double share) {
    OutlinePoint mean{};
    const double reach = std::min({0.02, share, 1 - share});
    constexpr int steps = 8;
    for (int i = -steps; i <= steps; ++i) {
        const OutlinePoint p = point_of_outline(share + reach * i / steps);
        mean[0] += p[0] / (2 * steps + 1), mean[1] += p[1] / (2 * steps + 1);
    }
    return mean;
}

double smooth_step(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

/// 1 at the middle, falling to about 0 at twice the width.
double bump(double x, double middle, double width) {
    const double d = (x - middle) / width;
    return std::exp(-d * d);
}

/// What makes the figures differ.
struct Pose {
    double pleats, twist, sway, turn, arms;
    std::uint64_t seed;
};

Pose pose_of(unsigned number) {
    Random random(100 + number);
    return {double(9 + random.below(10)),          double(random.uniform(-1.2f, 1.2f)),
            double(random.uniform(-0.09f, 0.09f)), double(random.uniform(-0.7f, 0.7f)),
            double(random.uniform(0.04f, 0.1f)),   1000u + number};
}

/// A point of the figure about its axis; angle 0 is its face, towards +z.
glm::dvec3 point_of_figure(const Pose& pose, double angle, double share) {
    const auto [radius, height] = point_of_rounded_outline(share);
    const double figure = smooth_step(lengths[5], lengths[6], share * lengths.back()),
                 robe = smooth_step(plinth_height, 0.62, height) * smooth_step(2.0, 1.7, height);
    const double crown = smooth_step(2.55, 2.46, height);  // where the outline ends, nothing is added to it
    const double up = std::max(height - plinth_height, 0.0), neck = smooth_step(2.05, 2.15, height);
    const double c = std::cos(angle), s = std::sin(angle);
    const double square = std::pow(std::pow(std::abs(c), 8.0) + std::pow(std::abs(s), 8.0), -1.0 / 8);
    double r = radius * (square + figure * (1 - square));
    const double wave = std::sin(pose.pleats * angle + pose.twist * up + 3 * value_noise(2 * angle, 2 * up, pose.seed));
    r += robe * radius * 0.09 * (std::abs(wave) - 0.5) * (0.4 + 0.6 * smooth_step(1.9, 0.7, height));
    const double beside = std::abs(std::remainder(angle, 2 * pi)) - pi / 2;  // arms hang at both sides
    r += figure * pose.arms * bump(beside, 0, 0.28) * smooth_step(1.15, 1.3, height) * smooth_step(2.05, 1.9, height);
    const double front = std::abs(std::remainder(angle - pose.turn, 2 * pi));  // the head is turned
    r += 0.035 * bump(front, 0, 0.16) * bump(height, 2.33, 0.045) -
         0.015 * bump(front, 0.42, 0.16) * bump(height, 2.37, 0.03);
    r += crown * neck * 0.02 * std::abs(std::sin(11 * angle + 30 * height)) * smooth_step(0.9, 1.5, front) *
         smooth_step(2.24, 2.34, height);
    r += crown * 0.0025 * radius / 0.3 * fractal_noise(12 * angle / pi, 14 * height, 4, pose.seed + 7);
    const double wide = 1 + figure * (1 - neck) * 0.2, deep = 1 - figure * (1 - neck) * 0.15;
    return {wide * r * s + pose.sway * std::sin(pi * std::min(up / 1.5, 1.0)), height, deep * r * c};
}

/// Normals of vertices: the sum of the triangles' normals by area.
void add_normals(Mesh& mesh) {
    mesh.normals.assign(mesh.positions.size(), glm::vec3(0.f));
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
        const glm::vec3 normal = glm::cross(b - a, c - a);
        for (int k = 0; k < 3; ++k) mesh.normals[t[k]] += normal;
    }
    for (glm::vec3& normal : mesh.normals) normal = glm::normalize(normal);
}

Mesh make_statue(unsigned number, const glm::vec3& place, double facing, std::uint32_t material) {
    static constexpr const char* names[] = {"Clio",     "Thalia", "Erato",     "Euterpe",
                                            "Calliope", "Urania", "Melpomene", "Polyhymnia"};
    Mesh mesh = named_mesh(names[number], std::size_t(around) * (rows + 1) + 1, std::size_t(around) * (1 + 2 * rows));
    const Pose pose = pose_of(number);
    const double c = std::cos(facing), s = std::sin(facing);
    const auto add = [&](double angle, double share) {
        const glm::dvec3 p = point_of_figure(pose, angle, share);
        mesh.positions.push_back(place + glm::vec3(c * p.x + s * p.z, p.y, c * p.z - s * p.x));
    };
    for (unsigned j = 0; j <= rows; ++j)
        for (unsigned i = 0; i < around; ++i) add(2 * pi * i / around, double(j) / (rows + 1));
    add(0, 1);
    for (unsigned j = 0; j < rows; ++j)
        for (unsigned i = 0; i < around; ++i) {
            const std::uint32_t next = (i + 1) % around, a = j * around + i, b = j * around + next;
            mesh.triangles.emplace_back(a, b, b + around);
            mesh.triangles.emplace_back(a, b + around, a + around);
        }
    for (unsigned i = 0; i < around; ++i)
        mesh.triangles.emplace_back(rows * around + i, rows * around + (i + 1) % around, (rows + 1) * around);
    add_normals(mesh);
    mesh.materials.assign(mesh.triangles.size(), material);
    return mesh;
}

}  // namespace

Scene statues() {
    Scene scene;
    scene.materials = {lambert("marble", {0.7f, 0.68f, 0.64f}), lambert("limestone", {0.62f, 0.55f, 0.44f}),
                       metal("bronze", {0.5f, 0.32f, 0.17f}, 0.35f), lambert("pavement", {0.36f, 0.34f, 0.32f})};
    for (unsigned i = 0; i < 8; ++i) {
        const float side = i % 2 == 0 ? -1.f : 1.f;
        const std::uint32_t materials[] = {marble, limestone, marble, bronze, bronze, marble, limestone, marble};
        scene.meshes.push_back(
            make_statue(i, {1.45f * side, 0.f, -1.9f * float(i / 2)}, -0.9 * double(side), materials[i]));
    }
    Mesh ground = named_mesh("pavement");
    add_rectangle(ground, {0.f, 0.f, -3.f}, {0.f, 0.f, 6.f}, {3.f, 0.f, 0.f}, pavement);
    scene.meshes.push_back(std::move(ground));
    scene.lights = {point_light({-9.f, 12.f, 8.f}, {520.f, 470.f, 400.f})};
    scene.sky = {{0.42f, 0.46f, 0.52f}, {0.13f, 0.22f, 0.42f}};
    scene.camera = Camera{{0.f, 2.1f, 7.f}, {0.f, 1.3f, -2.f}, {0.f, 1.f, 0.f}, 34.f};
    return scene;
}

}  // namespace claray::scenes
