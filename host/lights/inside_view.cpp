#include "host/lights/inside_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "host/base/in_parallel.hpp"
#include "host/base/random.hpp"

namespace claray {
namespace {

constexpr double no_end = std::numeric_limits<double>::infinity();
constexpr double least_enclosed = 0.8;  // of the rays from a place in a room that meet surfaces
constexpr double least_fronts = 0.9;    // of the surfaces that they meet

glm::dvec3 any_direction(scenes::Random& random) {
    const glm::dvec3 in_ball(random.in_ball());
    return in_ball / std::max(glm::length(in_ball), 1e-9);
}

/// Fronts of surfaces all round a place.
bool is_enclosed(const HostRays& rays, const glm::dvec3& place, scenes::Random& random) {
    constexpr int count = 48;
    int met = 0, fronts = 0;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 direction = any_direction(random);
        const auto hit = rays.closest(place, direction, no_end);
        met += hit.has_value(), fronts += hit && glm::dot(hit->normal, direction) < 0;
    }
    return met >= least_enclosed * count && fronts >= least_fronts * met;
}

/// Places of a grid in the scene's box that are in rooms, in slices.
class Rooms {
public:
    explicit Rooms(const ProbedScene& scene) : rays_(scene.rays()), box_(bounds_of(scene.scene())), slices_(side) {
        in_parallel(side, [&](std::size_t z) {
            scenes::Random random(z);
            for (int y = 0; y < side; ++y)
                for (int x = 0; x < side; ++x)
                    if (const glm::dvec3 place = at(x, y, int(z)); is_enclosed(rays_, place, random))
                        slices_[z].push_back(place);
        });
    }
    [[nodiscard]] double share_of_box() const {
        std::size_t count = 0;
        for (const auto& slice : slices_) count += slice.size();
        return double(count) / (side * side * side);
    }
    [[nodiscard]] Camera best_view(float vertical_fov, float aspect) const;

private:
    static constexpr int side = 8;

    [[nodiscard]] glm::dvec3 at(int x, int y, int z) const {
        return glm::dvec3(box_.lo) + (glm::dvec3(x, y, z) + 0.5) / double(side) * glm::dvec3(box_.extent());
    }
    struct Look {
        glm::dvec3 place{0.0}, direction{0.0};
        double distance = 0, merit = -1;
    };
    [[nodiscard]] Look look(const glm::dvec3& place, const glm::dvec3& along, const glm::dvec2& slopes,
                            scenes::Random& random) const;
    [[nodiscard]] Look best_look(const glm::dvec3& place, const glm::dvec2& slopes, scenes::Random& random) const;
    [[nodiscard]] double place_merit(const glm::dvec3& place) const;

    const HostRays& rays_;
    Bounds box_;
    std::vector<std::vector<glm::dvec3>> slices_;
};

/// People look from low in a room, whose ceiling may be missing, and from the lower floors.
double Rooms::place_merit(const glm::dvec3& place) const {
    const auto up = rays_.closest(place, {0.0, 1.0, 0.0}, no_end),
               down = rays_.closest(place, {0.0, -1.0, 0.0}, no_end);
    const double above = up ? up->distance : box_.hi.y - place.y, below = down ? down->distance : place.y - box_.lo.y;
    const double off = (below / std::max(below + above, 1e-30) - 0.25) / 0.25;
    return std::exp(-off * off) * (1 - 0.7 * (place.y - box_.lo.y) / box_.extent().y);
}

/// The merit is the mean of the logarithms of all distances in view: one that is near hides more than one that is far
/// adds. It falls where little light comes from around the scene to what is in view.
Rooms::Look Rooms::look(const glm::dvec3& place, const glm::dvec3& along, const glm::dvec2& slopes,
                        scenes::Random& random) const {
    constexpr int grid = 5;
    constexpr double dark = 0.2, light_enough = 0.2;
    const double far = glm::length(glm::dvec3(box_.extent())), outside = 0.25 * far;  // a sky is no far view
    const glm::dvec3 right = glm::normalize(glm::cross(along, glm::dvec3(0, 1, 0))), up = glm::cross(right, along);
    double sum = 0, ahead = outside;
    int seen = 0, open = 0;
    for (int y = 0; y < grid; ++y)
        for (int x = 0; x < grid; ++x) {
            const glm::dvec2 at = (2.0 * glm::dvec2(x, y) / double(grid - 1) - 1.0) * slopes;
            const glm::dvec3 direction = glm::normalize(along + at.x * right + at.y * up);
            const auto hit = rays_.closest(place, direction, far);
            const double distance = hit ? hit->distance : outside;
            sum += std::log(std::max(distance / far, 1e-6));
            if (x == grid / 2 && y == grid / 2) ahead = distance;
            if (!hit) continue;
            const glm::dvec3 on_front = place + (1 - 1e-6) * distance * direction;
            seen += 1, open += !rays_.closest(on_front, hit->normal + 0.999 * any_direction(random), no_end);
        }
    const double light = dark + std::min(double(open) / std::max(seen, 1), light_enough);
    return {place, along, ahead, light * std::exp(sum / (grid * grid))};
}

Rooms::Look Rooms::best_look(const glm::dvec3& place, const glm::dvec2& slopes, scenes::Random& random) const {
    constexpr int turns = 16;
    Look best;
    for (int i = 0; i < turns; ++i) {
        const double angle = 2 * std::numbers::pi * i / turns;
        const Look found = look(place, {std::sin(angle), 0, -std::cos(angle)}, slopes, random);
        if (found.merit > best.merit) best = found;
    }
    best.merit *= place_merit(place);
    return best;
}

Camera Rooms::best_view(float vertical_fov, float aspect) const {
    const double slope = std::tan(0.5 * glm::radians(double(vertical_fov)));
    std::vector<Look> of_slices(slices_.size());
    in_parallel(slices_.size(), [&](std::size_t i) {
        scenes::Random random(i);
        for (const glm::dvec3& place : slices_[i])
            if (const Look found = best_look(place, {slope * aspect, slope}, random); found.merit > of_slices[i].merit)
                of_slices[i] = found;
    });
    const auto better = [](const Look& a, const Look& b) { return a.merit < b.merit; };
    const Look best = *std::max_element(of_slices.begin(), of_slices.end(), better);
    Camera camera;
    camera.position = glm::vec3(best.place);
    camera.target = glm::vec3(best.place + 0.5 * best.distance * best.direction);
    camera.vertical_fov = vertical_fov;
    return camera;
}

struct Surfaces {
    double enclosed = 0;  // share of the area from whose fronts hardly any ray leaves the scene
    double of_box = 0;    // that area over the area of the scene's box
};

/// Counts what lines in all directions meet: a surface meets a random line in proportion to its area (Cauchy and
/// Crofton).
class LineCount {
public:
    explicit LineCount(const ProbedScene& scene) : rays_(scene.rays()), box_(bounds_of(scene.scene())) {}
    [[nodiscard]] Surfaces surfaces() const;

private:
    struct Count {
        int met = 0, enclosed = 0;
    };
    [[nodiscard]] double radius() const { return 0.5 * glm::length(glm::dvec3(box_.extent())); }
    [[nodiscard]] Count along_line(scenes::Random& random) const;
    [[nodiscard]] bool is_enclosed_at(const glm::dvec3& place, const glm::dvec3& front, scenes::Random& random) const;

    const HostRays& rays_;
    Bounds box_;
};

bool LineCount::is_enclosed_at(const glm::dvec3& place, const glm::dvec3& front, scenes::Random& random) const {
    constexpr int count = 12;
    const glm::dvec3 origin = place + 1e-6 * radius() * front;
    int met = 0;
    for (int i = 0; i < count; ++i)
        met += rays_.closest(origin, front + 0.999 * any_direction(random), no_end).has_value();
    return met >= least_enclosed * count;
}

LineCount::Count LineCount::along_line(scenes::Random& random) const {
    constexpr int most_surfaces = 64;
    const glm::dvec3 direction = any_direction(random), other = any_direction(random);
    const glm::dvec3 aside = glm::normalize(glm::cross(direction, other));
    const glm::dvec3 from_middle = radius() * std::sqrt(double(random.uniform())) * aside;
    const glm::dvec3 begin = glm::dvec3(box_.center()) + from_middle - 1.01 * radius() * direction;
    Count found;
    double gone = 0;
    while (found.met < most_surfaces) {
        const auto hit = rays_.closest(begin + gone * direction, direction, no_end);
        if (!hit) break;
        gone += hit->distance;
        found.met += 1, found.enclosed += is_enclosed_at(begin + gone * direction, hit->normal, random);
        gone += 1e-6 * radius();
    }
    return found;
}

Surfaces LineCount::surfaces() const {
    constexpr int rows = 32, lines_a_row = 12;
    std::vector<Count> counts(rows);
    in_parallel(rows, [&](std::size_t i) {
        scenes::Random random(i);
        for (int line = 0; line < lines_a_row; ++line) {
            const Count found = along_line(random);
            counts[i].met += found.met, counts[i].enclosed += found.enclosed;
        }
    });
    double met = 0, enclosed = 0;
    for (const Count& count : counts) met += count.met, enclosed += count.enclosed;
    // A line through a ball of the radius r meets an area A in it A / (2 pi r^2) times in the mean.
    const double area = enclosed / (rows * lines_a_row) * 2 * std::numbers::pi * radius() * radius();
    const glm::dvec3 e(box_.extent());
    return {enclosed / std::max(met, 1.0), area / (2 * (e.x * e.y + e.y * e.z + e.z * e.x))};
}

}  // namespace

std::optional<Camera> inside_view(const ProbedScene& scene, float vertical_fov, float aspect) {
    constexpr double least_of_area = 0.55, least_of_box_area = 0.6, least_of_box = 0.33;
    const glm::vec3 extent = bounds_of(scene.scene()).extent();
    if (!(std::min({extent.x, extent.y, extent.z}) > 0.f)) return {};
    const Surfaces surfaces = LineCount(scene).surfaces();
    if (surfaces.enclosed < least_of_area || surfaces.of_box < least_of_box_area) return {};
    const Rooms rooms(scene);
    if (rooms.share_of_box() < least_of_box) return {};
    return rooms.best_view(vertical_fov, aspect);
}

}  // namespace claray
