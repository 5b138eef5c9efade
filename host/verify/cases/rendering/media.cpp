// Bodies of glass and liquid that touch, overlap or enclose something, against a path tracer in float64. It shares no
// code with the kernels: it keeps no stack of media, but asks at each border which bodies contain the points before and
// behind it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include "claray/renderer.hpp"
#include "host/base/format.hpp"
#include "host/verify/cases/cases.hpp"

namespace claray::verify {
namespace {

struct Box {
    glm::dvec3 lo, hi;
    [[nodiscard]] bool contains(const glm::dvec3& p) const {
        return glm::all(glm::greaterThan(p, lo)) && glm::all(glm::lessThan(p, hi));
    }
};
/// A transparent body. Where bodies overlap, the last one of the scene is there. `left`: of light over a length of 1.
struct Body {
    Box box;
    double ior, left;
};
/// An opaque body.
struct Solid {
    Box box;
    double albedo, emission;
};
struct MediaScene {
    const char* name;
    double sky;
    std::vector<Body> bodies;
    std::vector<Solid> solids;
};

Box cube(double half, const glm::dvec3& centre = glm::dvec3(0)) { return {centre - half, centre + half}; }

/// Their indices are such that the bodies' order is that of nested_media: those within others, and denser ones, last.
std::vector<MediaScene> media_scenes() {
    const Box lower = {{-1, -1, -1}, {1, 0, 1}}, upper = {{-1, 0, -1}, {1, 1, 1}}, deeper = {{-1, -0.4, -1}, {1, 1, 1}};
    const Solid grey = {cube(0.35, {0.1, 0.5, 0}), 0.7, 0}, lamp = {cube(0.35, {0.1, 0.1, 0}), 0, 2};
    return {{"lamp in glass", 0.3, {{cube(1), 1.5, 1}}, {lamp}},
            {"solid in tinted glass", 1, {{cube(1), 1.5, 0.4}}, {grey}},
            {"liquid that touches glass", 1, {{upper, 1.33, 0.6}, {lower, 1.5, 1}}, {grey}},
            {"liquid that overlaps glass", 1, {{deeper, 1.33, 0.6}, {lower, 1.5, 1}}, {grey}},
            {"air in glass", 1, {{cube(1), 1.6, 0.5}, {cube(0.6), 1, 1}}, {{cube(0.3), 0.7, 0}}},
            {"diamond in liquid in glass",
             1,
             {{cube(1), 1.5, 0.8}, {cube(0.8), 1.33, 0.5}, {cube(0.6), 2.4, 1}},
             {{cube(0.3), 0.7, 0.5}}}};
}

struct Line {
    glm::dvec3 origin, direction;
};
/// Where a line meets a box, and the normal there, against the line.
struct Border {
    double distance;
    glm::dvec3 normal;
};

/// The first border beyond the origin: an entry or an exit.
std::optional<Border> border_of(const Box& box, const Line& line) {
    double near = -std::numeric_limits<double>::infinity(), far = -near;
    int near_axis = 0, far_axis = 0;
    for (int k = 0; k < 3; ++k) {
        if (line.direction[k] == 0 && (line.origin[k] < box.lo[k] || line.origin[k] > box.hi[k])) return {};
        double a = (box.lo[k] - line.origin[k]) / line.direction[k],
               b = (box.hi[k] - line.origin[k]) / line.direction[k];
        if (a > b) std::swap(a, b);
        if (a > near) near = a, near_axis = k;
        if (b < far) far = b, far_axis = k;
    }
    if (near > far || far <= 0) return {};
    const int axis = near > 0 ? near_axis : far_axis;
    glm::dvec3 normal(0);
    normal[axis] = line.direction[axis] > 0 ? -1 : 1;
    return Border{near > 0 ? near : far, normal};
}

class Reference {
public:
    Reference(const MediaScene& scene, const Camera& camera, std::uint64_t seed) : scene_(scene), random_(seed) {
        const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.target) - glm::dvec3(camera.position));
        const double slope = std::tan(glm::radians(double(camera.vertical_fov)) / 2);
        right_ = slope * glm::normalize(glm::cross(forward, glm::dvec3(camera.up)));
        up_ = glm::cross(right_, forward);
        forward_ = forward, position_ = camera.position;
    }
    /// Radiance through a random point of the square image.
    double sample() {
        const double x = 2 * uniform() - 1, y = 2 * uniform() - 1;
        return radiance({position_, glm::normalize(forward_ + x * right_ + y * up_)});
    }

private:
    static constexpr double step = 1e-9;  // beyond a border

    double uniform() { return std::uniform_real_distribution<double>()(random_); }

    [[nodiscard]] const Body& medium_at(const glm::dvec3& p) const {
        static const Body air = {{}, 1, 1};
        const auto found = std::find_if(scene_.bodies.rbegin(), scene_.bodies.rend(),
                                        [&](const Body& body) { return body.box.contains(p); });
        return found == scene_.bodies.rend() ? air : *found;
    }
    glm::dvec3 diffuse(const glm::dvec3& normal) {
        const double z = 2 * uniform() - 1, angle = 2 * std::numbers::pi * uniform(), r = std::sqrt(1 - z * z);
        return glm::normalize(normal + glm::dvec3(r * std::cos(angle), r * std::sin(angle), z));
    }
    /// Reflects or refracts the line at a border of two media. Radiance over the square of the index stays.
    double cross(Line& line, const Border& border, const glm::dvec3& p, double before, double behind) {
        const double cosine = -glm::dot(line.direction, border.normal), eta = before / behind;
        const double below = 1 - eta * eta * (1 - cosine * cosine);
        double reflected = 1;
        if (below > 0) {
            const double c = std::sqrt(below);
            const double s = (before * cosine - behind * c) / (before * cosine + behind * c);
            const double t = (behind * cosine - before * c) / (behind * cosine + before * c);
            reflected = (s * s + t * t) / 2;
        }
        const bool reflects = uniform() < reflected;
        line.direction = reflects ? line.direction + 2 * cosine * border.normal
                                  : eta * line.direction + (eta * cosine - std::sqrt(below)) * border.normal;
        line.direction = glm::normalize(line.direction);
        line.origin = p + step * line.direction;
        return reflects ? 1 : eta * eta;
    }
    double radiance(Line line) {
        double sum = 0, carried = 1;
        for (;;) {
            std::optional<Border> first;
            const Solid* met = nullptr;
            const auto nearer = [&](const std::optional<Border>& b) {
                return b && (!first || b->distance < first->distance);
            };
            for (const Solid& solid : scene_.solids)
                if (const auto b = border_of(solid.box, line); nearer(b)) first = b, met = &solid;
            for (const Body& body : scene_.bodies)
                if (const auto b = border_of(body.box, line); nearer(b)) first = b, met = nullptr;
            if (!first) return sum + carried * scene_.sky;
            const glm::dvec3 p = line.origin + first->distance * line.direction;
            const Body& before = medium_at(p - step * line.direction);
            carried *= std::pow(before.left, first->distance);
            if (met) {
                sum += carried * met->emission, carried *= met->albedo;
                line = {p + step * first->normal, diffuse(first->normal)};
            } else {
                const Body& behind = medium_at(p + step * line.direction);
                if (before.ior == behind.ior)
                    line.origin = p + step * line.direction;
                else
                    carried *= cross(line, *first, p, before.ior, behind.ior);
            }
            const double survival = std::min(1.0, 4 * carried);
            if (uniform() >= survival) return sum;
            carried /= survival;
        }
    }

    const MediaScene& scene_;
    std::mt19937_64 random_;
    glm::dvec3 position_, forward_, right_, up_;
};

void add(Scene& to, const Box& box, const Material& material) {
    Mesh mesh;
    for (int corner = 0; corner < 8; ++corner)
        mesh.positions.push_back(
            glm::mix(glm::vec3(box.lo), glm::vec3(box.hi), glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2)));
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    mesh.materials.assign(mesh.triangles.size(), std::uint32_t(to.materials.size()));
    to.materials.push_back(material), to.meshes.push_back(mesh);
}

Scene scene_of(const MediaScene& from, const Camera& camera) {
    Scene scene;
    for (const Body& body : from.bodies) {
        Material glass;
        glass.kind = MaterialKind::glass, glass.albedo = glm::vec3(1.f), glass.roughness = 0.f;
        glass.ior = float(body.ior);
        glass.attenuation = glm::vec3(float(body.left)), glass.attenuation_distance = 1.f;
        add(scene, body.box, glass);
    }
    for (const Solid& solid : from.solids) {
        Material opaque;
        opaque.albedo = glm::vec3(float(solid.albedo)), opaque.emission = glm::vec3(float(solid.emission));
        add(scene, solid.box, opaque);
    }
    scene.sky = {glm::vec3(float(from.sky)), glm::vec3(float(from.sky))};
    scene.camera = camera;
    return scene;
}

void nested_media(Run& run) {
    const Camera camera = {{2.3f, 1.9f, 3.1f}, {0.f, 0.f, 0.f}, {0.f, 1.f, 0.f}, 48.f};
    constexpr unsigned side = 32;
    const unsigned spp = run.count(1024u, 8192u);
    const std::uint64_t samples = run.count(1'000'000u, 8'000'000u);
    for (const MediaScene& scene : media_scenes()) {
        Reference reference(scene, camera, run.seed());
        double expected = 0, found = 0;
        for (std::uint64_t i = 0; i < samples; ++i) expected += reference.sample() / double(samples);
        Renderer renderer(
            run.device(), scene_of(scene, camera),
            {.width = side, .height = side, .spp = spp, .max_depth = 256, .seed = std::uint32_t(run.seed())});
        renderer.render();
        for (const glm::vec3& pixel : renderer.image()) found += pixel.x / (side * side);
        const double error = std::abs(found / expected - 1);
        run.check(std::string("light of ") + scene.name, samples, error, 0.005, "of all");
        if (!(error <= 0.005)) run.failure(printed("%s: %.5f instead of %.5f", scene.name, found, expected));
    }
}

}  // namespace

Cases media_cases() {
    return {
        {{"nested-media", "images", "Light in bodies that touch, overlap or enclose others, against float64"},
         nested_media},
    };
}

}  // namespace claray::verify
