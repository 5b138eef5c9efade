// Errors that show in images: rays that meet the surface they leave, lost samples, sums, curves, poles, lights that are
// too close.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "claray/renderer.hpp"
#include "host/render/film/film.hpp"
#include "host/textures/mip_map.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/rendering/bsdf.hpp"
#include "host/verify/scenes.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

struct At {
    const char* name;
    double offset, scale;
    bool flat;  ///< triangles in planes y = const, where y is not rounded
};

Mesh triangles_at(const At& at, std::size_t count, std::uint64_t seed) {
    Mesh mesh = soup(count, 1.f, seed);
    for (glm::vec3& p : mesh.positions) {
        p = glm::vec3(glm::dvec3(p) * at.scale + glm::dvec3(at.offset, 0.37 * at.offset, -0.71 * at.offset));
        if (at.flat) p.y = 0.f;
    }
    return mesh;
}

/// Rays that leave a triangle, tested against it alone: they must not hit it. Reversed rays must: most of them do, and
/// if none did, the test would prove nothing.
void leave_alone(const Device& device, const Mesh& mesh, std::uint32_t triangle, std::span<const Ray> rays, Tally& self,
                 Tally& back) {
    Mesh alone = mesh;
    alone.triangles = {mesh.triangles[triangle]};
    std::vector<Ray> both(rays.begin(), rays.end());
    for (Ray ray : rays) ray.dx *= -1, ray.dy *= -1, ray.dz *= -1, both.push_back(ray);
    const std::vector<Hit> hits = closest_hit(Bvh::build(device, std::span(&alone, 1)), both);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        self.add(hits[i].primitive == CLARAY_MISS);
        back.add(hits[rays.size() + i].primitive != CLARAY_MISS);
    }
}

/// Rays that leave a surface must not hit it again, at any scale and distance from the origin, and must begin close to
/// it.
void self_intersection(Run& run) {
    const At places[] = {{"at the origin", 0, 1, false},
                         {"at 1e3", 1e3, 1, false},
                         {"scaled by 1e-3", 0, 1e-3, false},
                         {"scaled by 1e-12", 0, 1e-12, false},
                         {"at 1e6, scaled by 100", 1e6, 100, false},
                         {"in a plane", 0, 1, true},
                         {"in a plane at 1e3", 1e3, 1, true}};
    const std::uint32_t triangles = 2000, each = run.count(32u, 1024u), count = triangles * each;
    Kernel leave = load_kernel(run.device(), "verify/leave_surface.cl", "leave_surface_at_random");
    Kernel by_sixteen = load_kernel(run.device(), "verify/leave_surface.cl", "leave_surface_by_sixteen");
    const bool shades_sixteen = run.device().info().type == DeviceType::cpu;
    Tally same;
    for (const At& at : places) {
        const Mesh mesh = triangles_at(at, triangles, run.seed() + 41);
        const Bvh bvh = build(run, mesh);
        const Buffer<Ray> rays(run.device(), count);
        const Buffer<float> clearance(run.device(), count);
        Buffer<Hit> hits(run.device(), count);
        leave.run({count, 64}, count, 0u, each, std::uint32_t(run.seed()), arg("positions", bvh.triangles().positions),
                  bvh.triangles().indices, rays, arg("clearance", clearance));
        closest_hit(bvh, rays, hits);
        if (shades_sixteen) {
            const Buffer<std::uint32_t> differ(run.device(), (count + 15) / 16);
            by_sixteen.run({differ.size(), 64}, count, each, std::uint32_t(run.seed()), bvh.triangles().positions,
                           arg("indices", bvh.triangles().indices), rays, arg("differ", differ));
            for (const std::uint32_t lanes : differ.read()) same.tried += 8, same.wrong += lanes;
        }
        const auto all = rays.read();
        Tally self, back;
        std::uint32_t i = 0;
        for (const Hit& hit : hits.read()) self.add(hit.primitive != i++ / each);
        for (std::uint32_t t = 0; t < triangles;
             t += run.count(100u, 20u)) {  // some alone, so that no other triangle hides them
            const std::span<const Ray> own(&all[std::size_t(t) * each], each);
            leave_alone(run.device(), mesh, t, own, self, back);
        }
        if (back.wrong > back.tried / 2)
            run.check(std::string("rays back to their triangle, ") + at.name, back.tried, 1, 0, "");
        if (self.wrong)
            run.failure(std::string(at.name) +
                        ", meets the triangle that it leaves: " + text_of(all[self.first % count]));
        run.check(std::string("rays that meet their triangle, ") + at.name, self, "rays");
        auto relative = clearance.read();
        std::nth_element(relative.begin(), relative.begin() + count / 2, relative.end());
        if (!(relative[count / 2] > 0)) run.check(std::string("how far off they begin, ") + at.name, count, 1, 0, "");
        run.check(std::string("how far off they begin, median, ") + at.name, count, relative[count / 2], 1e-3,
                  "of an edge");
    }
    if (shades_sixteen) run.check("that sixteen at once begin elsewhere", same, "rays");
}

void nan_pixels(Run& run) {
    // All effects take longest to compile, so they come first. A quick run compiles these once for most scenes.
    constexpr const char* names[] = {"effects", "cornell",   "spheres",   "crate",
                                     "hills",   "soup:2000", "hair:2000", "terrain:2000"};
    const RenderConfig config{.width = run.count(32u, 256u), .height = run.count(24u, 192u), .spp = run.count(4u, 64u)};
    struct Rendered {
        Tally finite;
        std::uint64_t dropped = 0;
    };
    std::vector<Rendered> rendered(std::size(names));
    run.side_by_side(rendered.size(), [&](const Device& device, std::size_t i) {
        RenderConfig shared = config;
        if (!run.full() && i != 1) shared.effects.add = full_effects();
        Renderer renderer(device, *builtin_scene(names[i]), shared);
        renderer.render();
        for (const glm::vec3& p : renderer.image())
            rendered[i].finite.add(std::isfinite(p.x + p.y + p.z) && p.x >= 0 && p.y >= 0 && p.z >= 0);
        rendered[i].dropped = renderer.statistics().dropped_samples;
    });
    const std::uint64_t samples = std::uint64_t(config.width) * config.height * config.spp;
    for (std::size_t i = 0; i < rendered.size(); ++i) {
        const std::string name = names[i];
        const Tally& finite = rendered[i].finite;
        const auto dropped = double(rendered[i].dropped);
        if (finite.wrong || dropped > 0) run.failure(name + " has samples that are NaN, infinite or negative");
        run.check("samples that are NaN, infinite or above 1e30, " + name, samples, dropped, 0, "samples");
        run.check("pixels that are NaN, infinite or negative, " + name, finite, "pixels");
    }
    // Bad samples must be counted and must not reach the image.
    Film film(run.device(), 2);
    const float nan = NAN, inf = INFINITY;
    film.accumulate({0, 2, 0, 4, 0},
                    Buffer<float>(run.device(), std::vector<float>{1, 2, 3,    nan,   1, 1, 1,   inf, 1,   3,   4, 5,
                                                                   1, 1, -inf, 1e38f, 1, 1, nan, nan, nan, inf, 1, 1}));
    const auto image = film.image();
    run.check("bad samples that were not dropped", 6, std::abs(6 - double(film.noise().dropped)), 0, "samples");
    run.check("pixels that bad samples changed", 2,
              double(image[0] != glm::vec3(2, 3, 4)) + double(image[1] != glm::vec3(0)), 0, "pixels");
}

/// Lognormal samples, the largest of which are thousands of times their mean: sums in one float lose small samples.
void accumulation(Run& run) {
    const std::uint32_t pixels = 2, per_batch = 1u << 16, batches = run.count(8u, 256u);
    Film film(run.device(), pixels);
    std::vector<double> exact(pixels);
    Random random(run.seed() + 7);
    std::vector<float> radiance(3 * std::size_t(pixels) * per_batch);
    for (std::uint32_t b = 0; b < batches; ++b) {
        for (std::uint32_t i = 0; i < pixels * per_batch; ++i) {
            // A sum of uniform numbers is normal enough, and the same in every library.
            float normal = -6.f;
            for (int k = 0; k < 12; ++k) normal += random.uniform();
            const float value = float(std::exp(2.0 * normal));
            exact[i / per_batch] += value;
            radiance[3 * i] = radiance[3 * i + 1] = radiance[3 * i + 2] = value;
        }
        film.accumulate({0, pixels, b * per_batch, per_batch, 0}, Buffer<float>(run.device(), radiance));
    }
    const std::uint64_t samples = std::uint64_t(per_batch) * batches;
    double worst = 0;
    const auto image = film.image();
    for (std::uint32_t p = 0; p < pixels; ++p)
        worst = std::max(worst, std::abs(image[p].y / (exact[p] / double(samples)) - 1));
    run.check("relative error of the mean", samples, worst, 1e-5, "");
}

void srgb(Run& run) {
    Tally same;
    double worst = 0;
    for (int i = 0; i < 256; ++i) {
        const float linear = decode_srgb(std::uint8_t(i));
        const double c = i / 255.0, exact = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
        same.add(encode_srgb(linear) == i);
        worst = std::max(worst, std::abs(linear - exact));
    }
    run.check("bytes that are not restored", same, "bytes");
    run.check("absolute error of the curve", 256, worst, 1e-7, "");
    // On the device: a texture of all bytes, seen as a picture.
    Scene scene;
    Texture ramp;
    ramp.width = 16, ramp.height = 16, ramp.channels = 3, ramp.format = TexelFormat::srgb8,
    ramp.filter = Filter::nearest;
    for (int i = 0; i < 256; ++i) ramp.bytes.insert(ramp.bytes.end(), 3, std::uint8_t(i));
    scene.textures = {ramp}, scene.materials = {grey(1.f)}, scene.meshes = {square(1.f, 0.f, 0)};
    scene.materials[0].albedo_map.texture = 0;
    scene.camera = Camera{{0, 10, 0}, {0, 0, 0}, {0, 0, -1}, float(2 * std::atan(0.1) * 180 / std::numbers::pi)};
    Renderer renderer(run.device(), scene, {.width = 16, .height = 16, .spp = 1});
    const auto albedo = renderer.aovs().albedo;
    double on_device = 0;
    for (std::size_t i = 0; i < 256; ++i)
        on_device = std::max(on_device, std::abs(double(albedo[i].x) - double(decode_srgb(std::uint8_t(i)))));
    run.check("absolute error of a texture on the device", 256, on_device, 1e-6, "");
}

}  // namespace

Cases image_cases() {
    return {
        {{"self-intersection", "images", "Rays that leave a surface do not hit it at any scale, and begin close to it"},
         self_intersection},
        {{"nan-pixels", "images",
          "No sample of the built-in scenes is NaN or infinite, and such samples do not reach the image"},
         nan_pixels},
        {{"accumulation", "images", "Sums of millions of samples with heavy tails"}, accumulation},
        {{"srgb", "images", "The sRGB curve restores all bytes"}, srgb},
    };
}

}  // namespace claray::verify
