#include "host/bench/rays.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "claray/io.hpp"
#include "host/scene/random.hpp"

namespace claray::bench {
namespace {

glm::vec3 unit(const glm::vec3& v) { return v / std::sqrt(glm::dot(v, v)); }

Ray ray_from(const glm::vec3& origin, const glm::vec3& direction, float tmax = 1e30f) {
    return {origin.x, origin.y, origin.z, 0, direction.x, direction.y, direction.z, tmax};
}

/// The middle of all that emits, the first point light, or a point high above one side.
glm::vec3 find_light(const Scene& scene, const Bounds& bounds) {
    if (!scene.point_lights.empty()) return scene.point_lights[0].position;
    Bounds lamps;
    for (const Mesh& mesh : scene.meshes)
        for (std::size_t i = 0; i < mesh.materials.size(); ++i)
            if (scene.materials[mesh.materials[i]].emission != glm::vec3(0.f))
                for (int corner = 0; corner < 3; ++corner) lamps.grow(mesh.positions[mesh.triangles[i][corner]]);
    return lamps.empty() ? bounds.center() + glm::vec3(0.3f, 1.5f, 0.4f) * bounds.extent() : lamps.center();
}

/// Where the rays of the next kinds start: a hit, a little off the surface on the side that the ray came from.
struct Surface {
    glm::vec3 point, normal;
};

std::vector<Surface> surfaces(const BenchScene& scene, const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
    std::vector<std::uint32_t> first;  // primitive of each mesh
    std::uint32_t triangles = 0;
    for (const Mesh& mesh : scene.meshes) first.push_back(triangles), triangles += std::uint32_t(mesh.triangles.size());
    const glm::vec3 extent = scene.bounds.extent();
    const float offset = 1e-5f * std::max({extent.x, extent.y, extent.z});
    std::vector<Surface> all;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (hits[i].primitive == CLARAY_MISS) continue;
        const Mesh& mesh = scene.meshes[hits[i].geometry];
        const glm::uvec3 t = mesh.triangles[hits[i].primitive - first[hits[i].geometry]];
        const glm::vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
        const glm::vec3 direction(rays[i].dx, rays[i].dy, rays[i].dz), scaled = glm::cross(b - a, c - a);
        if (!(glm::dot(scaled, scaled) > 0.f)) continue;  // so small a triangle that its normal underflows
        const glm::vec3 normal = glm::dot(scaled, direction) > 0.f ? -unit(scaled) : unit(scaled);
        const glm::vec3 point = glm::vec3(rays[i].ox, rays[i].oy, rays[i].oz) + hits[i].t * direction;
        all.push_back({point + offset * normal, normal});
    }
    return all;
}

RaySet shadow_rays(const BenchScene& scene, const std::vector<Surface>& from) {
    const float radius = 0.03f * std::sqrt(glm::dot(scene.bounds.extent(), scene.bounds.extent())) * 0.5f;
    scenes::Random random(51);
    RaySet set{"shadow", true, {}};
    for (const Surface& s : from)
        set.rays.push_back(ray_from(s.point, scene.light + radius * random.in_ball() - s.point, 0.9999f));
    return set;
}

/// A unit vector on a sphere around the tip of the normal is distributed by the cosine.
RaySet bounce_rays(const std::vector<Surface>& from) {
    scenes::Random random(52);
    RaySet set{"bounce", false, {}};
    for (const Surface& s : from) {
        glm::vec3 ball = random.in_ball();
        while (glm::dot(ball, ball) < 1e-4f) ball = random.in_ball();
        const glm::vec3 direction = s.normal + unit(ball);
        set.rays.push_back(ray_from(s.point, glm::dot(direction, direction) > 1e-6f ? unit(direction) : s.normal));
    }
    return set;
}

std::filesystem::path ray_file(const BenchScene& scene) {
    return std::filesystem::path(scene.name).replace_extension(".ray");
}

bool has_recorded_rays(const BenchScene& scene) {
    return scene.name.ends_with(".scn") && std::filesystem::exists(ray_file(scene));
}

std::vector<RaySet> recorded_rays(const std::filesystem::path& path) {
    const std::vector<std::uint32_t> words = read_words(path);
    std::vector<RaySet> sets = {{"primary", false, {}}, {"shadow", true, {}}, {"bounce", false, {}}};
    std::size_t at = 4;
    for (std::size_t i = 0; i < sets.size(); ++i) {
        sets[i].rays.resize(words.at(i + 1));
        const std::size_t size = sets[i].rays.size() * sizeof(Ray) / 4;
        if (at + size > words.size()) throw Error(ErrorKind::user, path.string() + " is shorter than it says");
        std::memcpy(sets[i].rays.data(), words.data() + at, size * 4);
        at += size;
    }
    return sets;
}

}  // namespace

std::vector<std::uint32_t> read_words(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw Error(ErrorKind::user, "cannot read " + path.string());
    std::vector<std::uint32_t> words(std::size_t(file.tellg()) / 4 + 1);
    file.seekg(0).read(reinterpret_cast<char*>(words.data()), std::streamsize(words.size() * 4));
    return words;
}

BenchScene open_scene(const std::string& name) {
    BenchScene opened;
    opened.name = name;
    Scene scene;
    if (name.ends_with(".scn")) {
        scene.meshes = load_meshes(name);
    } else {
        Warnings warnings;
        scene = load_scene(name, warnings);
    }
    opened.bounds = bounds_of(scene);
    opened.camera = scene.camera.value_or(automatic_camera(opened.bounds, 40.f, 16.f / 9.f));
    opened.light = find_light(scene, opened.bounds);
    opened.meshes = std::move(scene.meshes);
    return opened;
}

std::vector<Mesh> load_meshes(const std::string& name) {
    if (!name.ends_with(".scn")) {
        Warnings warnings;
        return load_scene(name, warnings).meshes;
    }
    const std::vector<std::uint32_t> words = read_words(name);
    Mesh mesh;
    mesh.positions.resize(words.at(1));
    mesh.triangles.resize(words.at(2));
    if (4 + 3 * (mesh.positions.size() + mesh.triangles.size()) > words.size())
        throw Error(ErrorKind::user, name + " is shorter than it says");
    std::memcpy(mesh.positions.data(), &words.at(4), mesh.positions.size() * sizeof(glm::vec3));
    std::memcpy(mesh.triangles.data(), &words.at(4 + 3 * mesh.positions.size()),
                mesh.triangles.size() * sizeof(glm::uvec3));
    return {std::move(mesh)};
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
        rays[i] = {c.x,
                   c.y,
                   c.z,
                   0,
                   c.forward_x + u * c.right_x + v * c.up_x,
                   c.forward_y + u * c.right_y + v * c.up_y,
                   c.forward_z + u * c.right_z + v * c.up_z,
                   1e30f};
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
        ray = ray_from(from, point() - from);
    }
    return rays;
}

std::vector<RaySet> make_rays(const Bvh& bvh, const BenchScene& scene, unsigned width, unsigned height) {
    std::vector<RaySet> sets;
    if (has_recorded_rays(scene)) {
        sets = recorded_rays(ray_file(scene));
    } else {
        std::vector<Ray> primary = primary_rays(scene.camera, width, height, false);
        const std::vector<Surface> from = surfaces(scene, primary, closest_hit(bvh, primary));
        sets = {{"primary", false, std::move(primary)}, shadow_rays(scene, from), bounce_rays(from)};
    }
    sets.push_back({"random", false, random_rays(scene.bounds, sets[0].rays.size())});
    return sets;
}

}  // namespace claray::bench
