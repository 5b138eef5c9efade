#include "bench/peers/rays.hpp"

#include <cmath>

namespace claray::measure {
namespace {

constexpr int directions = 128;

/// Directions spread evenly over the sphere (a Fibonacci lattice); the first is straight up.
glm::vec3 direction(int i) {
    const float y = 1 - 2 * float(i) / float(directions - 1), r = std::sqrt(std::max(0.f, 1 - y * y));
    const float phi = 2.3999632f * float(i);
    return {r * std::cos(phi), y, r * std::sin(phi)};
}

/// The places to try: in the middle half of the box, where rooms are.
std::vector<glm::vec3> places_in(const Bounds& bounds) {
    std::vector<glm::vec3> places;
    for (int x = -2; x <= 2; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -2; z <= 2; ++z)
                places.push_back(bounds.center() + glm::vec3(x, 1.5f * float(y), z) * 0.125f * bounds.extent());
    return places;
}

}  // namespace

std::vector<View> views_from_inside(const Device& device, const Scene& scene) {
    const Bounds bounds = bounds_of(scene);
    const float size = glm::length(bounds.extent());
    const std::vector<glm::vec3> places = places_in(bounds);
    std::vector<Ray> rays;
    for (const glm::vec3& place : places)
        for (int i = 0; i < directions; ++i) {
            const glm::vec3 d = direction(i);
            rays.push_back({place.x, place.y, place.z, 0, d.x, d.y, d.z, size});
        }
    const std::vector<Hit> hits = closest_hit(Bvh::build(device, scene.meshes), rays);
    const auto distance = [&](std::size_t place, int i) { return hits[place * directions + std::size_t(i)].t; };
    // Rays that leave the scene count as if they met something at once: the place is to be inside.
    std::size_t best = 0;
    double best_sum = -1;
    for (std::size_t place = 0; place < places.size(); ++place) {
        double sum = 0;
        for (int i = 0; i < directions; ++i)
            if (hits[place * directions + std::size_t(i)].primitive != CLARAY_MISS)
                sum += std::log1p(1e3 * distance(place, i) / size);
        if (sum > best_sum) best = place, best_sum = sum;
    }
    const glm::vec3 eye = places[best],
                    light = eye + glm::vec3(0, 0.5f * std::min(distance(best, 0), bounds.extent().y), 0);
    std::vector<View> views;
    for (const float angle : {0.f, 2.1f, 4.2f}) {
        const glm::vec3 ahead(std::sin(angle), -0.2f, std::cos(angle));
        views.push_back({{.position = eye, .target = eye + ahead * size, .vertical_fov = 75}, light});
    }
    return views;
}

}  // namespace claray::measure
