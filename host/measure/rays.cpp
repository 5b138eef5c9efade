#include "host/measure/rays.hpp"

#include <algorithm>
#include <cmath>

#include "host/scene/camera.hpp"
#include "host/scene/placement.hpp"

namespace claray::measure {
namespace {

/// A direction with density cos / pi about the normal.
glm::vec3 cosine_direction(const glm::vec3& normal, Pcg& random) {
    const float z = 2 * random.uniform() - 1, phi = 6.2831853f * random.uniform(), r = std::sqrt(1 - z * z);
    const glm::vec3 sum = normal + glm::vec3(r * std::cos(phi), r * std::sin(phi), z);
    return glm::dot(sum, sum) > 1e-6f ? glm::normalize(sum) : normal;
}

}  // namespace

std::vector<Mesh> world_meshes(const Scene& scene) {
    if (scene.instances.empty()) return scene.meshes;
    std::vector<Mesh> meshes;
    for (const MeshInstance& instance : scene.instances)
        meshes.push_back(transformed(scene.meshes[instance.mesh], instance.transform));
    return meshes;
}

std::vector<Ray> primary_rays(const Camera& camera, unsigned width, unsigned height, bool tiles) {
    const CameraData c = camera_data(camera, float(width) / float(height));
    std::vector<Ray> rays(std::size_t(width) * height);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        std::size_t x = i % width, y = i / width;
        if (tiles) {
            const std::size_t tile = i / 64, in_tile = i % 64, row = width / 8;
            x = tile % row * 8 + in_tile % 8, y = tile / row * 8 + in_tile / 8;
        }
        const float u = (float(x) + 0.5f) / float(width) * 2 - 1, v = 1 - (float(y) + 0.5f) / float(height) * 2;
        const CameraRay ray = camera_ray(c, double(u), double(v));
        const glm::vec3 origin(ray.origin), direction(ray.direction);
        rays[i] = {origin.x, origin.y, origin.z, 0, direction.x, direction.y, direction.z, 1e30f};
    }
    return rays;
}

std::vector<Ray> random_rays(const Bounds& bounds, std::size_t count) {
    std::vector<Ray> rays(count);
    std::uint64_t state = 1;
    const auto uniform = [&] {  // PCG's generator (O'Neill 2014), its upper 24 bits
        state = state * 6364136223846793005ull + 1442695040888963407ull;
        return float(state >> 40) * 0x1p-24f;
    };
    const auto point = [&] {
        const glm::vec3 in_cube(uniform(), uniform(), uniform());
        return bounds.center() + (in_cube - 0.5f) * 1.5f * bounds.extent();
    };
    for (Ray& ray : rays) {
        const glm::vec3 from = point();
        const glm::vec3 direction = point() - from;
        ray = {from.x, from.y, from.z, 0, direction.x, direction.y, direction.z, 1e30f};
    }
    return rays;
}

std::vector<View> three_views(const std::string& name, const Scene& scene) {
    const Bounds bounds = bounds_of(scene);
    const glm::vec3 extent = bounds.extent();
    const float unit = std::max({extent.x, extent.y, extent.z}) / 1000;
    const auto view = [&](glm::vec3 eye, glm::vec3 target, float fov, glm::vec3 light) {
        const auto at = [&](glm::vec3 place) { return bounds.center() + unit * place; };
        return View{{.position = at(eye), .target = at(target), .vertical_fov = fov}, at(light)};
    };
    if (name.find("sponza") != name.npos)
        return {view({-330, -110, 10}, {200, -60, -60}, 75, {60, 150, 0}),
                view({330, -110, -10}, {-200, -80, 60}, 75, {60, 150, 0}),
                view({-50, 40, 20}, {300, -120, -80}, 75, {60, 150, 0})};
    if (name.find("sibenik") != name.npos)
        return {view({-420, -200, 0}, {300, -120, 20}, 75, {0, 200, 0}),
                view({200, -100, 60}, {-300, -50, -50}, 75, {0, 200, 0}),
                view({0, -250, 0}, {300, 100, 10}, 75, {0, 200, 0})};
    std::vector<View> views;
    const Camera front = automatic_camera(bounds, 40.f, 4.f / 3.f);
    for (const float angle : {0.f, 2.1f, 4.2f}) {
        const glm::vec3 d = (front.position - front.target) * 0.55f;
        View made;
        made.camera = front;
        const float c = std::cos(angle), s = std::sin(angle);
        made.camera.position = front.target + glm::vec3(c * d.x + s * d.z, d.y, c * d.z - s * d.x);
        made.light = bounds.center() + unit * glm::vec3(900, 1500, 900);
        views.push_back(made);
    }
    return views;
}

std::vector<Ray> shuffled(std::vector<Ray> rays, const std::vector<Ray>& more, Pcg& random) {
    rays.insert(rays.end(), more.begin(), more.end());
    for (std::size_t i = rays.size(); i > 1; --i) std::swap(rays[i - 1], rays[random.next() % i]);
    return rays;
}

RaySets make_rays(const Device& device, const Scene& scene, const std::vector<View>& views, unsigned width,
                  unsigned height, bool tiles) {
    RaySets sets;
    std::vector<glm::uvec3> triangles;
    std::vector<glm::vec3> positions;
    for (const Mesh& mesh : scene.meshes) {
        const glm::uvec3 base{std::uint32_t(positions.size())};
        for (const glm::uvec3& t : mesh.triangles) triangles.push_back(base + t);
        positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
    }
    const glm::vec3 extent = bounds_of(scene).extent();
    const float lift = 1e-5f * std::max({extent.x, extent.y, extent.z});
    const Bvh bvh = Bvh::build(device, scene.meshes, {.learns = false});
    Pcg random;
    for (const View& view : views) {
        std::vector<Ray> rays = primary_rays(view.camera, width, height, tiles);
        for (Ray& ray : rays) {
            const glm::vec3 d = glm::normalize(glm::vec3(ray.dx, ray.dy, ray.dz));
            ray.dx = d.x, ray.dy = d.y, ray.dz = d.z;
        }
        const std::vector<Hit> hits = closest_hit(bvh, rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (hits[i].primitive == CLARAY_MISS) continue;
            const glm::uvec3 t = triangles[hits[i].primitive];
            const glm::vec3 a = positions[t.x], d(rays[i].dx, rays[i].dy, rays[i].dz);
            glm::vec3 normal = glm::normalize(glm::cross(positions[t.y] - a, positions[t.z] - a));
            if (!(glm::dot(normal, d) < 0)) normal = -normal;
            if (!(glm::dot(normal, normal) > 0.5f)) continue;
            const glm::vec3 from = glm::vec3(rays[i].ox, rays[i].oy, rays[i].oz) + hits[i].t * d + lift * normal;
            const glm::vec3 to = view.light - from, bounce = cosine_direction(normal, random);
            const float distance = glm::length(to);
            const glm::vec3 direction = to / distance;
            sets.shadow.push_back(
                {from.x, from.y, from.z, 0, direction.x, direction.y, direction.z, distance * 0.9999f});
            sets.bounce.push_back({from.x, from.y, from.z, 0, bounce.x, bounce.y, bounce.z, 1e30f});
        }
        sets.primary.insert(sets.primary.end(), rays.begin(), rays.end());
    }
    sets.mixed = shuffled(sets.primary, sets.bounce, random);
    return sets;
}

}  // namespace claray::measure
