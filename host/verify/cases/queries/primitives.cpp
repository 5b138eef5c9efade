// Geometry that is not triangles: spheres, discs and cylinders against 80-bit arithmetic, curves against exact ones.
#include <algorithm>
#include <cmath>

#include "host/verify/cases/cases.hpp"
#include "host/verify/oracles/primitive_oracle.hpp"

namespace claray::verify {
namespace {

QueryOptions options_with(bool brute_force) {
    QueryOptions options;
    options.brute_force = brute_force;
    return options;
}

/// Hits at a border, where float64 may round to the other side, are wrong by this count.
struct Judged {
    std::size_t rays = 0, hits = 0, wrong = 0;
    Tally any;
};

void judge(Run& run, const ExactKind& of, const std::vector<float>& data, const Primitives& primitives,
           const std::vector<Ray>& rays, bool brute_force, Judged& judged) {
    const auto hits = closest_hit(primitives, rays, options_with(brute_force));
    const auto occluded = any_hit(primitives, rays, options_with(brute_force));
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const OracleHit nearest = closest_primitive(of, data, rays[i]);
        const bool met = nearest.primitive != CLARAY_MISS;
        const bool right = hits[i].primitive == nearest.primitive &&
                           (!met || std::abs(hits[i].t - nearest.t) <= 1e-7 * std::abs(nearest.t));
        judged.hits += met, judged.wrong += !right;
        if (judged.any.add((occluded[i] != 0) == (hits[i].primitive != CLARAY_MISS)))
            run.failure(std::string(of.name) + ", a wrong any hit: " + text_of(rays[i]));
    }
    judged.rays += rays.size();
}

/// Rays are closed at tmax, where a hit counts, and open at tmin; of equal primitives the first is hit.
void judge_ends(Run& run, const ExactKind& of, std::vector<float> data, const std::vector<Ray>& rays) {
    constexpr std::uint32_t count = 300;
    data.insert(data.end(), data.begin(), data.end());
    Tally wrong;
    for (const auto& [layout, name] : layouts) {
        const Primitives twice =
            Primitives::build(run.device(), of.kind, Buffer<float>(run.device(), data), 2 * count, {.layout = layout});
        const auto hits = closest_hit(twice, rays);
        std::vector<Ray> to = rays, before = rays, from = rays;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (hits[i].primitive == CLARAY_MISS) continue;
            to[i].tmax = from[i].tmin = hits[i].t, before[i].tmax = std::nextafter(hits[i].t, 0.f);
        }
        const auto at = closest_hit(twice, to), none = closest_hit(twice, before), behind = closest_hit(twice, from);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (hits[i].primitive == CLARAY_MISS) continue;
            if (wrong.add(hits[i].primitive < count && at[i].primitive == hits[i].primitive && at[i].t == hits[i].t &&
                          none[i].primitive == CLARAY_MISS &&
                          (behind[i].primitive == CLARAY_MISS || behind[i].t > hits[i].t)))
                run.failure(std::string(of.name) + ", " + name + ", a wrong end: " + text_of(rays[i]));
        }
    }
    run.check("wrong ends of rays at " + std::string(of.name), wrong, "rays");
}

void primitives(Run& run) {
    auto rays = random_rays(run.count<std::size_t>(1500, 50'000), 3.f, 1.f, run.seed() + 111);
    for (std::size_t i = 0; i < rays.size(); i += 3) rays[i].tmin = 2.5f, rays[i].tmax = 3.5f;  // some from inside
    for (const ExactKind& of : exact_kinds()) {
        const auto data = random_data(of, 300, 0.2f, run.seed() + 110), later = random_data(of, 300, 0.2f, run.seed());
        Judged judged;
        for (const auto& [layout, name] : layouts)
            for (const auto& [builder, builder_name, note, codes, splits] : builders) {
                Primitives built = Primitives::build(run.device(), of.kind, Buffer<float>(run.device(), data), 300,
                                                     {.builder = builder, .layout = layout});
                for (const bool brute_force : {false, true}) {
                    if (brute_force && builder != Builder::fast) continue;
                    judge(run, of, data, built, rays, brute_force, judged);
                }
                Buffer<float>(built.data()).write(later);
                built.refit();
                judge(run, of, later, built, rays, false, judged);
            }
        judge_ends(run, of, data, rays);
        const std::string kind = of.name;
        run.check("closest hits of " + kind + " off float64", judged.rays, double(judged.wrong) / double(judged.rays),
                  2e-4, "of all");
        run.check("rays that meet no " + kind, judged.rays, judged.hits < judged.rays / 10, 0, "");
        run.check("wrong any hits of " + kind, judged.any, "rays");
    }
}

/// A curve that is thinner by the tolerance is hit later or not, one that is thicker earlier.
void curves(Run& run, CurveBasis basis, CurveShape shape, float thickness, const std::string& what) {
    const Tufts tufts = random_strands(40, 3, basis, run.seed() + 112, thickness);
    const auto exact = exact_curves(tufts, basis);
    auto rays = random_rays(run.count<std::size_t>(800, 20'000), 4.f, 1.f, run.seed() + 113);
    Random random(run.seed() + 114);
    for (std::size_t i = 0; i < rays.size(); i += 2) {  // every second one at a curve
        const glm::vec3 origin(rays[i].ox, rays[i].oy, rays[i].oz);
        const ExactCurve& at = exact[random.below(std::uint32_t(exact.size()))];
        rays[i] = make_ray(origin, glm::vec3(glm::dvec3(at.at(random.uniform()))) - origin);
    }
    const double tolerance = thickness / 32 + thickness / 50;  // and the steps of the samples
    std::vector<Contact> contacts;
    for (const Ray& ray : rays) contacts.push_back(first_contact(exact, ray, tolerance, shape));
    Tally wrong, any;
    for (const auto& [layout, name] : layouts)
        for (const Builder builder : {Builder::fast, Builder::balanced}) {
            const Primitives built = build_curves(run.device(), tufts.points, tufts.segments, basis, shape,
                                                  {.builder = builder, .layout = layout});
            const auto hits = closest_hit(built, rays);
            const auto occluded = any_hit(built, rays);
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const double unit = std::sqrt(double(rays[i].dx) * rays[i].dx + double(rays[i].dy) * rays[i].dy +
                                              double(rays[i].dz) * rays[i].dz);
                const double slack = shape == CurveShape::flat ? 0.01 / unit : 1e-6;  // a step of the samples
                const auto [early, late] = contacts[i];
                const bool hit = hits[i].primitive != CLARAY_MISS;
                const bool right =
                    hit ? std::isfinite(hits[i].t) && hits[i].t >= early - slack && hits[i].t <= late + slack
                        : std::isinf(late);
                if (wrong.add(right)) run.failure(what + ", " + name + ": " + text_of(rays[i]));
                any.add((occluded[i] != 0) == hit);
            }
        }
    run.check("wrong closest hits of " + what, wrong, "rays");
    run.check("wrong any hits of " + what, any, "rays");
}

void curves(Run& run) {
    for (const auto& [basis, basis_name] :
         {std::pair(CurveBasis::bspline, "B-splines"), {CurveBasis::bezier, "Bezier curves"}}) {
        for (const float thickness : {0.02f, 0.2f})
            curves(run, basis, CurveShape::round, thickness,
                   std::string(thickness < 0.1f ? "thin " : "thick ") + basis_name);
        curves(run, basis, CurveShape::flat, 0.02f, std::string("flat ") + basis_name);
    }
}

}  // namespace

Cases primitive_cases() {
    return {
        {{"primitives", "queries", "Hits of spheres, discs and cylinders against 80-bit arithmetic"}, primitives},
        {{"curves", "queries", "Hits of curves are within the tolerance of the exact curves"}, curves},
    };
}

}  // namespace claray::verify
