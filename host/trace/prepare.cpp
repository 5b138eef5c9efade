// Compiles ahead what structures and queries need, by using each of them once.
#include "claray/instances.hpp"
#include "claray/query/all_hits.hpp"
#include "claray/query/overlaps.hpp"
#include "claray/query/points.hpp"
#include "host/base/random.hpp"
#include "host/compute/programs/compiler_processes.hpp"

namespace claray {
namespace {

/// Random triangles in a cube: enough of them for every phase of a builder.
Mesh soup() {
    constexpr std::uint32_t triangles = 4096;
    Mesh mesh;
    scenes::Random random(1);
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const glm::vec3 corner = random.in_cube();
        for (const glm::vec3& offset : {glm::vec3(0), random.in_cube(), random.in_cube()})
            mesh.positions.push_back(corner + 0.1f * offset);
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return mesh;
}

/// As many rays as are sorted before they are traced.
std::vector<Ray> rays_of_all_directions() {
    constexpr std::size_t count = 1u << 17;
    std::vector<Ray> rays(count);
    scenes::Random random(2);
    for (Ray& ray : rays) {
        const glm::vec3 from = random.in_cube(), along = random.in_cube();
        ray = {from.x, from.y, from.z, 0, along.x, along.y, along.z, 1e30f};
    }
    return rays;
}

void trace(const Bvh& bvh, std::span<const Ray> rays) {
    for (const Coherence coherence : {Coherence::automatic, Coherence::coherent, Coherence::incoherent}) {
        QueryOptions options;
        options.coherence = coherence;
        (void)closest_hit(bvh, rays, options);
        (void)any_hit(bvh, rays, options);
    }
    const std::span<const Ray> few = rays.first(64);
    (void)count_hits(bvh, few);
    (void)all_hits(bvh, few);
    Buffer<Hit> hits(bvh.device(), 4 * few.size());
    Buffer<std::uint32_t> counts(bvh.device(), few.size());
    nearest_hits(bvh, Buffer<Ray>(bvh.device(), few), 4, hits, counts);
}

void ask_points(const Bvh& bvh) {
    const std::vector<glm::vec3> points(64, glm::vec3(0.5f));
    (void)nearest_point(bvh, points);
    (void)inside(bvh, points);
    (void)signed_distance(bvh, points);
    (void)box_overlaps(bvh, std::vector<Bounds>(1, {glm::vec3(0), glm::vec3(1)}));
    (void)sphere_overlaps(bvh, std::vector<Sphere>(1));
}

void place(const Bvh& bvh, std::span<const Ray> rays) {
    const std::vector<Bvh> bottoms = {bvh};
    const std::vector<Instance> instances(2, make_instance(glm::mat4(1)));
    InstancedBvh placed = InstancedBvh::build(bottoms, instances);
    (void)closest_hit(placed, rays);
    (void)any_hit(placed, rays);
    placed.refit();
    placed.rebuild();
}

}  // namespace

void Device::prepare() const {
    const KeepCompilers keep;
    const std::vector<Mesh> meshes = {soup()};
    const std::vector<Ray> rays = rays_of_all_directions();
    for (const Builder builder : {Builder::automatic, Builder::high}) {
        Bvh::Config config;
        config.builder = builder;
        Bvh bvh = Bvh::build(*this, meshes, config);
        trace(bvh, rays);
        ask_points(bvh);
        place(bvh, rays);
        bvh.refit();
        bvh.rebuild();
    }
    finish();
}

}  // namespace claray
