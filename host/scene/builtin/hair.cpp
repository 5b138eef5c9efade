// Strands on a head, each a ribbon of long thin triangles that fall this way and that: N triangles in all, for
// measuring. Boxes of such triangles are mostly empty and overlap their neighbours', which is what splitting and
// clustering are for. The same strands as curves.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/base/random.hpp"
#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

constexpr std::size_t triangles_a_strand = 48;
constexpr float strand_length = 1.9f;
constexpr float step = strand_length / float(triangles_a_strand + 1);
constexpr std::uint32_t shades = 4;

glm::vec3 unit(const glm::vec3& v) { return v / std::sqrt(glm::dot(v, v)); }

glm::vec3 random_direction(Random& random) {
    for (;;)
        if (const glm::vec3 p = random.in_ball(); glm::dot(p, p) > 1e-2f) return unit(p);
}

/// A place on the unit sphere where hair grows: not on the neck, not on the face, which looks along +z.
glm::vec3 find_root(Random& random) {
    for (;;) {
        const glm::vec3 p = random_direction(random);
        const bool neck = p.y<-0.45f, face = p.z> 0.3f && p.y < 0.45f;
        if (!neck && !face) return p;
    }
}

/// Grows out of the scalp, sinks under its weight, curls a little, and slides along the head where it meets it.
class Strand {
public:
    Strand(const glm::vec3& root, Random& random)
        : random_(random), at_(root), along_(unit(root + 0.3f * random.in_cube())), side_(across(random.in_cube())) {}

    [[nodiscard]] const glm::vec3& at() const { return at_; }
    /// A point of the ribbon's border, left and right by turns, then a step onwards.
    glm::vec3 next(float half_width) {
        left_ = !left_;
        const glm::vec3 border = at_ + (left_ ? half_width : -half_width) * side_;
        along_ = unit(along_ + glm::vec3(0.f, -0.1f, 0.f) + 0.08f * random_.in_cube());
        at_ += step * along_;
        if (const float r = std::sqrt(glm::dot(at_, at_)); r < 1.01f) {
            const glm::vec3 outwards = at_ / r;
            at_ = 1.01f * outwards;
            along_ = unit(along_ - std::min(glm::dot(along_, outwards) - 0.1f, 0.f) * outwards);
        }
        side_ = across(side_ + 0.2f * random_.in_cube());
        return border;
    }

private:
    /// The part of `v` at right angles to the strand; any direction where there is next to none.
    [[nodiscard]] glm::vec3 across(const glm::vec3& v) const {
        const glm::vec3 part = v - glm::dot(v, along_) * along_;
        if (glm::dot(part, part) > 1e-4f) return unit(part);
        return unit(std::abs(along_.x) < 0.8f ? glm::vec3(0.f, along_.z, -along_.y)
                                              : glm::vec3(-along_.z, 0.f, along_.x));
    }

    Random& random_;
    glm::vec3 at_, along_, side_;
    bool left_ = false;
};

/// A B-spline from the strand's root, with a control point at every third step. Its tube is as thick as the ribbon
/// looks in the mean over all sides.
void add_curve(PrimitiveSet& set, std::size_t triangles, float half_width, Random& random) {
    const std::uint32_t material = random.below(shades);
    const float radius = half_width * float(2 / std::numbers::pi);
    Strand strand(find_root(random), random);
    std::vector<glm::vec3> places;
    for (std::size_t i = 0; i < triangles + 2; ++i) {
        if (i % 3 == 0 || (i == triangles + 1 && places.size() == 1)) places.push_back(strand.at());
        (void)strand.next(half_width);
    }
    // The control points before and behind an end, mirrored at it, make the curve reach it.
    places.insert(places.begin(), 2.f * places[0] - places[1]);
    places.push_back(2.f * places.back() - places[places.size() - 2]);
    for (std::size_t i = 0; i + 3 < places.size(); ++i) {
        set.segments.push_back(std::uint32_t(set.points.size() + i));
        set.materials.push_back(material);
    }
    for (const glm::vec3& p : places) set.points.emplace_back(p, radius);
}

void add_strand(Mesh& mesh, std::size_t triangles, float half_width, Random& random) {
    const std::uint32_t material = random.below(shades);
    Strand strand(find_root(random), random);
    const auto base = std::uint32_t(mesh.positions.size());
    for (std::size_t i = 0; i < triangles + 2; ++i) mesh.positions.push_back(strand.next(half_width));
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const std::uint32_t a = base + i, odd = i & 1;
        mesh.triangles.emplace_back(a, a + 1 + odd, a + 2 - odd);
        mesh.materials.push_back(material);
    }
}

}  // namespace

namespace {

std::size_t strands_of(std::size_t triangles) { return (triangles + triangles_a_strand - 1) / triangles_a_strand; }

/// More strands are thinner, so that they cover the head equally densely for any N.
float half_width_of(std::size_t triangles) {
    return float(std::min(0.01, 0.1 / std::sqrt(double(strands_of(triangles)))));
}

/// All but the strands.
Scene bald_head() {
    Scene scene;
    scene.materials = {lambert("dark", {0.1f, 0.045f, 0.02f}), lambert("chestnut", {0.22f, 0.09f, 0.035f}),
                       lambert("copper", {0.42f, 0.17f, 0.06f}), lambert("gold", {0.55f, 0.33f, 0.13f})};
    static_assert(shades == 4);
    scene.lights = {point_light({-3.f, 4.f, 4.f}, {60.f, 55.f, 48.f})};
    scene.sky = {{0.8f, 0.82f, 0.85f}, {0.5f, 0.6f, 0.8f}};
    scene.camera = Camera{{2.2f, 0.7f, 4.6f}, {0.f, -0.25f, 0.f}, {0.f, 1.f, 0.f}, 46.f};
    return scene;
}

}  // namespace

Scene hair(std::size_t count) {
    Scene scene = bald_head();
    Mesh mesh = named_mesh("hair", count + 2 * strands_of(count), count);
    Random random(37);
    for (std::size_t done = 0; done < count; done += triangles_a_strand)
        add_strand(mesh, std::min(triangles_a_strand, count - done), half_width_of(count), random);
    scene.meshes.push_back(std::move(mesh));
    return scene;
}

Scene curves(std::size_t count) {
    Scene scene = bald_head();
    PrimitiveSet& set = scene.primitives.emplace_back();
    set.name = "hair", set.kind = PrimitiveSet::Kind::curves;
    Random random(37);
    for (std::size_t done = 0; done < count; done += triangles_a_strand)
        add_curve(set, std::min(triangles_a_strand, count - done), half_width_of(count), random);
    return scene;
}

}  // namespace claray::scenes
