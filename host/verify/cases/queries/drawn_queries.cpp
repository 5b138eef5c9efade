// Queries of meshes, instances, rays and points that are drawn at random. Other cases compare a few of these with exact
// arithmetic. Here many have committed answers, which all devices must give.
#include "claray/query/all_hits.hpp"
#include "claray/query/overlaps.hpp"
#include "claray/query/points.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/committed.hpp"
#include "host/verify/placements.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

constexpr std::uint64_t sets = 24;
constexpr float sizes[] = {1.f, 0x1p20f, 0x1p-20f};

/// Answers of one kind to all queries, as words.
struct Answers {
    std::string all;
    template <class T>
    void add(const std::vector<T>& values) {
        all += hash_of(values);
    }
    template <class T>
    void add(const HostLists<T>& lists) {
        add(lists.offsets), add(lists.elements);
    }
};

/// From everywhere, some towards an edge of the mesh or along an axis, some from next to it, many with ends.
std::vector<Ray> drawn_rays(const Mesh& mesh, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Ray> rays = random_rays(count, 3.f, 1.f, seed);
    for (std::size_t i = 0; i < count; i += 2) {
        Ray& ray = rays[i];
        const glm::vec3 from(ray.ox, ray.oy, ray.oz);
        const glm::uvec3& t = mesh.triangles[random.below(std::uint32_t(mesh.triangles.size()))];
        const glm::vec3 at = glm::mix(mesh.positions[t.x], mesh.positions[t.y], random.uniform());
        if (i % 4 == 0) ray = make_ray(from, at - from);
        if (i % 8 == 2) ray = make_ray(at - glm::vec3(0.f, 0.f, 2.f), {0.f, 0.f, 1.f});
        if (i % 16 == 6) {
            const glm::vec3 within = glm::mix(at, mesh.positions[t.z], random.uniform());
            const float before = i % 32 == 6 ? 0.f : random.uniform(-1e-6f, 1e-6f);
            ray = make_ray(within - before * from, from);
        }
        if (i % 3 == 0) ray.tmin = random.uniform(0.f, 2.f), ray.tmax = ray.tmin + random.uniform(0.f, 3.f);
    }
    return rays;
}

/// All that is a length becomes `by` times as long.
std::vector<Ray> scaled_rays(std::vector<Ray> rays, float by) {
    for (Ray& ray : rays) ray.ox *= by, ray.oy *= by, ray.oz *= by, ray.tmin *= by, ray.tmax *= by;
    return rays;
}

void add_hits(const Run& run, const Bvh& bvh, const std::vector<Ray>& rays, std::uint64_t seed, Answers& answers) {
    Random random(seed);
    std::vector<std::uint32_t> masks(rays.size());
    for (std::uint32_t& mask : masks) mask = random.below(4);
    QueryOptions options;
    options.cull_back_faces = seed % 3 == 1, options.closed = seed % 3 == 2;
    if (options.cull_back_faces) options.ray_masks = Buffer<std::uint32_t>(run.device(), masks);
    answers.add(closest_hit(bvh, rays, options)), answers.add(any_hit(bvh, rays, options));
    answers.add(all_hits(bvh, rays, options)), answers.add(count_hits(bvh, rays, options));
    options.brute_force = true;
    answers.add(closest_hit(bvh, rays, options)), answers.add(any_hit(bvh, rays, options));
}

void add_points(const Bvh& bvh, float size, std::uint64_t seed, Answers& answers) {
    Random random(seed);
    std::vector<glm::vec3> points;
    std::vector<Bounds> boxes;
    std::vector<Sphere> spheres;
    for (int i = 0; i < 400; ++i) {
        points.push_back(size * random.in_cube(1.5f));
        boxes.push_back({points.back(), points.back() + size * glm::abs(random.in_cube(0.5f))});
        spheres.push_back({points.back(), size * random.uniform(0.f, 0.5f)});
    }
    PointOptions options;
    if (seed % 3 == 0) options.reach = size * random.uniform(0.f, 0.5f);
    options.vote = seed % 4 == 1, options.sort = seed % 2;
    answers.add(nearest_point(bvh, points, options)), answers.add(inside(bvh, points, options));
    answers.add(signed_distance(bvh, points, options));
    if (bvh.triangle_count() > 0) answers.add(box_overlaps(bvh, boxes)), answers.add(sphere_overlaps(bvh, spheres));
}

Bvh::Config drawn_layout(std::uint64_t seed) {
    return {.builder = builders[seed % std::size(builders)].builder, .layout = layouts[seed / 4 % 2].layout};
}

void drawn_queries(Run& run) {
    Answers hits, points;
    for (std::uint64_t seed = 0; seed < sets; ++seed) {
        Mesh mesh = drawn_mesh(seed);
        mesh.mask = seed % 8 == 0 ? 2u : 0xffffffffu;
        const float size = sizes[seed / 8 % std::size(sizes)];
        const auto rays = scaled_rays(drawn_rays(mesh, 1500, seed), size);
        const Bvh bvh = build(run, scaled(mesh, size), drawn_layout(seed));
        add_hits(run, bvh, rays, seed, hits);
        add_points(bvh, size, seed, points);
    }
    Committed answers(run);
    answers.compare("hits of drawn meshes", hits.all);
    answers.compare("points and shapes near drawn meshes", points.all);
    answers.check("sets of answers");
}

/// Of two meshes, of one without triangles and of one that does not exist; some are flat or cannot be inverted.
std::vector<Instance> drawn_instances(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Instance> instances;
    for (std::uint32_t i = 0; i < count; ++i) {
        glm::mat4 m = drawn_transform(random);
        if (i % 3 == 0) m[int(random.below(3))] *= -1.f;
        if (i % 4 == 1) m[seed % 2] *= 2.f, m[1 - seed % 2] *= 0.3f;  // other axes are long at the end of the motion
        if (i % 17 == 5) m[1] = m[0];
        if (i % 13 == 4) m[2] *= 1e-4f;
        instances.push_back(make_instance(m, i % 7 == 6 ? 2 + random.below(2) : random.below(2), random.below(4), i));
    }
    return instances;
}

void add_instances(const InstancedBvh& bvh, const std::vector<Ray>& rays, const QueryOptions& options,
                   Answers& answers) {
    const InstanceStatistics of = bvh.statistics();
    answers.add(std::vector<std::uint32_t>{of.instances, of.culled, of.height});
    answers.add(std::vector<float>{of.widening});
    answers.all += bvh.top().hash();
    answers.add(closest_hit(bvh, rays, options)), answers.add(any_hit(bvh, rays, options));
}

void drawn_instance_queries(Run& run) {
    Answers still, moving;
    for (std::uint64_t seed = 0; seed < sets; ++seed) {
        const Mesh first = drawn_mesh(seed + 1), empty;
        const Layout layout = layouts[seed % 2].layout;
        const std::vector<Bvh> bottoms = {build(run, first, {.layout = layout}),
                                          build(run, sphere(1), {.layout = layout}),
                                          build(run, empty, {.layout = layout})};
        const std::vector<Instance> begins = drawn_instances(1 + seed * 5, seed),
                                    ends = drawn_instances(begins.size(), 91 + seed);
        const auto rays = random_rays(800, 5.f, 1.5f, seed);
        std::vector<float> times;
        std::vector<std::uint32_t> masks;
        Random random(seed);
        for (std::size_t i = 0; i < rays.size(); ++i)
            times.push_back(random.uniform()), masks.push_back(random.below(4));
        QueryOptions options;
        if (seed % 3) options.ray_masks = Buffer<std::uint32_t>(run.device(), masks);
        options.brute_force = seed % 5 == 0;
        const InstancedBvh::Config config{.builder = builders[seed % std::size(builders)].builder};
        InstancedBvh bvh = InstancedBvh::build(bottoms, begins, config);
        add_instances(bvh, rays, options, still);
        Buffer<Instance>(bvh.instances()).write(ends);
        bvh.refit();
        add_instances(bvh, rays, options, still);
        options.ray_times = Buffer<float>(run.device(), times);
        add_instances(InstancedBvh::build(bottoms, begins, ends, config), rays, options, moving);
    }
    Committed answers(run);
    answers.compare("hits of drawn instances", still.all);
    answers.compare("hits of drawn moving instances", moving.all);
    answers.check("sets of answers");
}

}  // namespace

Cases drawn_query_cases() {
    return {
        {{"drawn-queries", "sameness", "Rays, points and shapes meet what is committed in meshes drawn at random"},
         drawn_queries},
        {{"drawn-instances", "sameness", "Rays meet what is committed in instances drawn at random"},
         drawn_instance_queries},
    };
}

}  // namespace claray::verify
