// Rays against boxes: no box that a ray meets may be missed; rays along the axes must be correct and fast.
#include <algorithm>
#include <cmath>

#include "claray/program.hpp"
#include "host/base/format.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

struct Box {
    float lo[3], hi[3];
};

/// Whether the ray meets the box at t >= 0, in 64 bits of mantissa, where shrinking it by a relative 1e-15 changes
/// nothing.
bool surely_meets(const Ray& ray, const Box& box) {
    const long double o[3] = {ray.ox, ray.oy, ray.oz}, d[3] = {ray.dx, ray.dy, ray.dz};
    long double in = 0, out = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
        if (d[axis] == 0) {
            if (o[axis] < box.lo[axis] || o[axis] > box.hi[axis]) return false;
            continue;
        }
        long double a = (box.lo[axis] - o[axis]) / d[axis], b = (box.hi[axis] - o[axis]) / d[axis];
        if (a > b) std::swap(a, b);
        in = std::max(in, a), out = std::min(out, b);
    }
    return in <= out - std::fabs(out) * 1e-18L;
}

/// A lattice of triangles; many rays along the axes begin on faces of their boxes.
Mesh lattice_soup(std::size_t count, std::uint64_t seed) {
    Mesh mesh = soup(count, 0.3f, seed);
    for (glm::vec3& p : mesh.positions) p = glm::round(p * 8.f) / 8.f;
    return mesh;
}

std::vector<Ray> axis_rays_on(const Mesh& mesh, std::size_t count, std::uint64_t seed, float tilt) {
    Random random(seed);
    const auto vertices = std::uint32_t(mesh.positions.size());
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 vertex = mesh.positions[random.below(vertices)], other = mesh.positions[random.below(vertices)];
        const int axis = int(i % 3);
        glm::vec3 origin = vertex, direction(0.f);
        origin[(axis + 1) % 3] = other[(axis + 1) % 3] + (i % 2 ? random.uniform(-0.1f, 0.1f) : 0.f);
        if (i % 8 < 6) origin[axis] = i % 4 < 2 ? -3.f : 3.f;  // else on the face itself
        direction[axis] = i % 4 < 2 ? 1.f : -1.f;
        if (i % 5 == 0) direction[(axis + 1) % 3] = -0.f;
        if (tilt != 0) direction += tilt * random.in_cube(1.f);
        rays.push_back(make_ray(origin, direction));
    }
    return rays;
}

/// Boxes near and far, of all shapes, and rays to their faces, edges and corners.
void boxes(Run& run) {
    const std::uint64_t total = run.count<std::uint64_t>(300'000, 10'000'000), batch = 500'000;
    Kernel kernel = load_kernel(run.device(), "verify/graze_boxes.cl", "graze_boxes");
    Tally missed[4];
    std::uint64_t met = 0, falsely_met[4] = {};
    const char* const names[4] = {"binary, any signs", "binary, known signs", "wide", "wide, in the last slot"};
    for (std::uint64_t begin = 0; begin < total; begin += batch) {
        const auto count = std::uint32_t(std::min(batch, total - begin));
        const Buffer<Ray> rays(run.device(), count);
        const Buffer<Box> boxes(run.device(), count);
        const Buffer<std::uint32_t> found(run.device(), count);
        const Buffer<BvhHeader> headers(run.device(), count);
        const Buffer<WideNode> nodes(run.device(), count);
        kernel.run({count, 64}, count, std::uint32_t(begin), std::uint32_t(run.seed()), headers, nodes, rays, boxes,
                   found);
        const auto host_rays = rays.read();
        const auto host_boxes = boxes.read();
        const auto host_found = found.read();
        for (std::uint32_t i = 0; i < count; ++i) {
            const bool meets = surely_meets(host_rays[i], host_boxes[i]);
            met += meets;
            for (int k = 0; k < 4; ++k) {
                const bool says = (host_found[i] >> k) & 1;
                falsely_met[k] += says && !meets;
                if (missed[k].add(says || !meets)) {
                    const Box& b = host_boxes[i];
                    run.failure(std::string("missed by ") + names[k] + ": " + text_of(host_rays[i]) +
                                printed(" box %a %a %a to %a %a %a", double(b.lo[0]), double(b.lo[1]), double(b.lo[2]),
                                        double(b.hi[0]), double(b.hi[1]), double(b.hi[2])));
                }
            }
        }
    }
    for (int k = 0; k < 4; ++k) run.check(std::string("boxes missed, ") + names[k], missed[k], "boxes");
    // The case would prove nothing if all rays met their boxes, or if every test always reported a hit.
    if (met < total / 5) run.check("rays that meet their box", total, 1, 0, "");
    for (int k = 0; k < 4; ++k)
        if (total - met - falsely_met[k] < total / 50)
            run.check(std::string("rays that pass their box, ") + names[k], total, 1, 0, "");
    run.fact("rays that meet their box", std::to_string(met));
    for (int k = 0; k < 4; ++k)
        run.fact(std::string("hit although the ray passes, ") + names[k], std::to_string(falsely_met[k]));
}

void axis_rays(Run& run) {
    Mesh mesh = lattice_soup(run.count<std::size_t>(400, 1000), run.seed() + 21);
    auto rays = axis_rays_on(mesh, run.count<std::size_t>(60'000, 1'000'000), run.seed() + 22, 0.f);
    judge(run, mesh, rays, "", rays.size() / 20);
    move_away(mesh, rays);  // eighths become multiples of 128: rays still begin on faces
    judge(run, mesh, rays, "at 1e6", rays.size() / 20);
    if (!run.times()) return;
    // Rays along the axes against rays tilted by 1e-3, in a larger mesh that is on no lattice: there they would meet
    // more boxes, not only slower ones.
    const Mesh large = soup(run.count<std::size_t>(20'000, 200'000), 0.05f, run.seed() + 23);
    const auto count = run.count<std::size_t>(60'000, 400'000);
    for (const auto& [layout, name] : layouts) {
        const Bvh bvh = build(run, large, {.layout = layout});
        const Buffer<Ray> straight(run.device(), axis_rays_on(large, count, run.seed() + 24, 0.f));
        const Buffer<Ray> tilted(run.device(), axis_rays_on(large, count, run.seed() + 24, 1e-3f));
        Buffer<Hit> hits(run.device(), count);
        QueryOptions options;
        options.coherence = Coherence::incoherent;
        run.check_time(
            std::string("along the axes against tilted, ") + name, count,
            [&] { closest_hit(bvh, straight, hits, options); }, [&] { closest_hit(bvh, tilted, hits, options); }, 1.2);
    }
}

}  // namespace

Cases box_cases() {
    return {
        {{"boxes", "boxes", "No box test misses a box that a grazing ray hits"}, boxes},
        {{"axis-rays", "boxes", "Rays along the axes that begin on faces of boxes: correct, and as fast as others"},
         axis_rays,
         true},
    };
}

}  // namespace claray::verify
