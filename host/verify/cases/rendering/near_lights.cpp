// What chooses near lights, against float64: picks from the lists of a grid, and densities of hot spots. Images tell of
// them only by noise, since a wrong choice with its own probability keeps the mean.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "host/lights/light_lists.hpp"
#include "host/lights/lights.hpp"
#include "host/verify/cases/cases.hpp"

namespace claray::verify {
namespace {

using std::numbers::pi;

// ---- picks from lists --------------------------------------------------------------------------------------------

/// As in kernels/lights/light_lists.clh.
struct ListPick {
    std::uint32_t light;
    float probability, irradiance;
};

/// A point, the normal there (0 0 0: light from all directions), the number that picks, and a light to ask for.
struct LitPlace {
    glm::vec3 from, normal;
    float random;
    std::uint32_t asked;
};

/// Added to cosines, so that rounding leaves no light without a chance (LEAST_COSINE).
constexpr double least_cosine = 1e-5f;

/// irradiance_of (kernels/lights/lanes/list_lanes.clh).
double irradiance_of(const PunctualLight& light, const glm::dvec3& from, const glm::dvec3& normal) {
    const glm::dvec3 towards = glm::dvec3(light.x, light.y, light.z) - from;
    const double distance = glm::length(towards), share = distance * std::abs(double(light.inverse_range));
    if (!(share < 1 && distance > 0)) return 0;
    double received = normal == glm::dvec3(0) ? 1 : std::max(0.0, glm::dot(normal, towards) / distance + least_cosine);
    if (light.kind != CLARAY_POINT_LIGHT) {
        const glm::dvec3 axis(light.direction_x, light.direction_y, light.direction_z);
        const double cosine = -glm::dot(axis, towards) / distance;
        received *= std::pow(std::clamp(cosine * light.cone_scale + light.cone_offset, 0.0, 1.0), 2);
    }
    const double window = light.inverse_range < 0 ? 1 - share : 1 - std::pow(share, 4);
    const double divisor = light.attenuation_0 + distance * (light.attenuation_1 + distance * light.attenuation_2);
    const double intensity = 0.2126f * light.intensity_r + 0.7152f * light.intensity_g + 0.0722f * light.intensity_b;
    return received * intensity * window / divisor;
}

/// Points and spots with and without ranges.
std::vector<PunctualLight> various_lights(std::mt19937& random) {
    std::uniform_real_distribution<float> unit(-1.f, 1.f);
    Scene scene;
    for (unsigned i = 0; i < 200; ++i) {
        Light light;
        light.position = {5 * unit(random), 1 + unit(random), 5 * unit(random)};
        light.intensity = glm::vec3(1.2f + unit(random), 1.f, 1.f - 0.5f * unit(random));
        if (i % 2 == 1) {
            light.kind = LightKind::spot, light.direction = {unit(random), -1.f, unit(random)};
            light.inner_angle = 0.3f + 0.1f * unit(random), light.outer_angle = 0.9f;
        }
        if (i % 20 != 0) light.range = 2 + unit(random), light.linear_range = i % 3 == 0;
        if (i % 5 == 0) light.attenuation = {0.5f, 0.2f, 1.f};
        scene.lights.push_back(light);
    }
    Lights lights = collect_lights(scene, {.most_per_cell = 1e6});
    return lights.punctual;
}

/// 32 lights that each give 1 exactly to the origin: k / 32 is at the border between two of them, without roundings.
std::vector<PunctualLight> equal_lights() {
    Scene scene;
    std::array<float, 3> sizes{1, 2, 3};
    do
        for (unsigned signs = 0; signs < 8; ++signs) {
            const auto signed_size = [&](unsigned k) { return signs >> k & 1u ? -sizes[k] : sizes[k]; };
            Light light;
            light.position = {signed_size(0), signed_size(1), signed_size(2)}, light.intensity = {0.f, 0.f, 1.f};
            light.attenuation = {0.0722f, 0.f, 0.f};  // its luminance
            scene.lights.push_back(light);
        }
    while (std::ranges::next_permutation(sizes).found);
    scene.lights.resize(32);
    Lights lights = collect_lights(scene, {.most_per_cell = 1e6});
    return lights.punctual;
}

std::vector<LitPlace> various_places(std::mt19937& random, unsigned count, std::size_t lights) {
    std::uniform_real_distribution<float> unit(-1.f, 1.f);
    std::vector<LitPlace> places(count);
    for (unsigned i = 0; i < count; ++i) {
        LitPlace& place = places[i];
        place.from = {6 * unit(random), 1 + 2 * unit(random), 6 * unit(random)};
        if (i / 16 % 2 == 1 && i % 16 != 0) place.from = places[i - i % 16].from + 1e-3f * float(i % 16);
        place.normal = glm::normalize(glm::vec3(unit(random), unit(random), unit(random)));
        if (i % 7 == 0) place.normal = glm::vec3(0.f);
        place.random = std::min(0.5f + 0.5f * unit(random), 0x1.fffffep-1f), place.asked = random() % lights;
    }
    return places;
}

std::vector<LitPlace> places_of_ties(std::size_t lights) {
    std::vector<LitPlace> places;
    for (std::uint32_t i = 0; i < lights; ++i)
        places.push_back({glm::vec3(0.f), glm::vec3(0.f), float(i) / float(lights), i});
    return places;
}

struct Picks {
    std::vector<ListPick> alone, together;
    std::vector<float> probabilities;
};

Picks pick_at(const Device& device, const std::vector<PunctualLight>& lights, const std::vector<LitPlace>& places) {
    std::vector<float> numbers, random;
    std::vector<std::uint32_t> asked;
    for (const LitPlace& p : places) {
        numbers.insert(numbers.end(), {p.from.x, p.from.y, p.from.z, p.normal.x, p.normal.y, p.normal.z});
        random.push_back(p.random), asked.push_back(p.asked);
    }
    const auto count = std::uint32_t(places.size());
    const Buffer<ListPick> alone(device, count), together(device, count);
    const Buffer<float> probabilities(device, count);
    load_kernel(device, "verify/near_lights.cl", "pick_listed_lights")
        .run({count / 16, 1}, arg("table", Buffer<std::uint32_t>(device, build_light_lists(lights))),
             arg("lights", Buffer<PunctualLight>(device, lights)), arg("places", Buffer<float>(device, numbers)),
             arg("random", Buffer<float>(device, random)), arg("asked", Buffer<std::uint32_t>(device, asked)), count,
             arg("alone", alone), arg("together", together), arg("probabilities", probabilities));
    return {alone.read(), together.read(), probabilities.read()};
}

/// What a place receives of each light, and the sums up to each.
struct Shares {
    std::vector<double> of_light, up_to;
    Shares(const std::vector<PunctualLight>& lights, const LitPlace& place) {
        double sum = 0;
        for (const PunctualLight& light : lights) {
            of_light.push_back(irradiance_of(light, glm::dvec3(place.from), glm::dvec3(place.normal)));
            up_to.push_back(sum += of_light.back());
        }
    }
    [[nodiscard]] double total() const { return up_to.back(); }
    /// Whether a number picks this light, up to a rounding of its share.
    [[nodiscard]] bool picks(std::uint32_t light, double random, double rounding) const {
        const double at = random * total(), wide = rounding * total();
        return of_light[light] > 0 && at >= up_to[light] - of_light[light] - wide && at < up_to[light] + wide;
    }
};

bool is_near(double found, double expected) { return std::abs(found - expected) <= 1e-4 * expected; }

void judge_picks(Run& run, const std::string& what, const std::vector<PunctualLight>& lights,
                 const std::vector<LitPlace>& places, double rounding) {
    const Picks found = pick_at(run.device(), lights, places);
    Tally lit, alone, together, asked;
    const auto is_right = [&](const Shares& shares, const ListPick& pick, float random) {
        if (shares.total() == 0) return pick.probability == 0;
        return pick.light < lights.size() && shares.picks(pick.light, random, rounding) &&
               is_near(pick.irradiance, shares.total()) &&
               is_near(pick.probability, shares.of_light[pick.light] / shares.total());
    };
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Shares shares(lights, places[i]);
        const double own = shares.of_light[places[i].asked];
        lit.add(shares.total() == 0);
        alone.add(is_right(shares, found.alone[i], places[i].random));
        together.add(is_right(shares, found.together[i], places[i].random));
        asked.add(own == 0 ? found.probabilities[i] == 0 : is_near(found.probabilities[i], own / shares.total()));
    }
    run.check(what + ": wrong picks of one surface", alone, "places");
    run.check(what + ": wrong picks of sixteen surfaces", together, "places");
    run.check(what + ": wrong probabilities of lights", asked, "places");
    run.check(what + ": places without light", places.size(), double(lit.tried - lit.wrong),
              0.5 * double(places.size()), "places");
}

void light_lists(Run& run) {
    std::mt19937 random(std::uint32_t(run.seed()));
    const auto lights = various_lights(random), equal = equal_lights();
    judge_picks(run, "points and spots", lights, various_places(random, run.count(4096u, 65536u), lights.size()), 1e-5);
    judge_picks(run, "numbers at borders of equal lights", equal, places_of_ties(equal.size()), 0);
}

// ---- hot spots ---------------------------------------------------------------------------------------------------

struct SpotView {
    glm::vec3 light, way, from, direction;
};

/// The density per steradian of directions to the points where rays from the light, uniform over the hemisphere around
/// `way`, meet the plane at its end.
double density_of_spot(const SpotView& view) {
    const glm::dvec3 way(view.way), direction(view.direction), from(view.from);
    const double height = glm::length(way);
    const glm::dvec3 middle = glm::dvec3(view.light) + way;
    const double along = glm::dot(direction, way) / height;
    const double t = glm::dot(middle - from, way) / height / along;
    if (!(t > 0)) return 0;
    const double distance = glm::distance(from + t * direction, glm::dvec3(view.light));
    const double of_area = height / distance / (distance * distance) / (2 * pi);
    return of_area * t * t / std::abs(along);
}

/// Lights from 1e-4 to 1 above a plane, seen from 1e-4 to 10 away.
std::vector<SpotView> spot_views(std::mt19937& random, unsigned count) {
    std::uniform_real_distribution<float> unit(-1.f, 1.f);
    const auto direction = [&] { return glm::normalize(glm::vec3(unit(random), unit(random), unit(random))); };
    std::vector<SpotView> views(count);
    for (SpotView& view : views) {
        view.way = direction() * std::pow(10.f, 2 * unit(random) - 2);
        view.from = direction(), view.direction = direction();
        view.light = view.from + direction() * std::pow(10.f, 2.5f * unit(random) - 1.5f);
    }
    return views;
}

/// float32 cancels where light and viewer are near each other's plane, so a density may be off by what coordinates
/// that are off by half a unit in the last place change.
double uncertainty_of(const SpotView& view) {
    double most = 0;
    const double expected = density_of_spot(view);
    for (int k = 0; k < 3; ++k)
        for (const float size : {-1e-7f, 1e-7f}) {
            SpotView moved = view;
            moved.light[k] += size * std::max(1.f, std::abs(moved.light[k]));
            SpotView turned = view;
            turned.direction[k] += size;
            for (const SpotView& other : {moved, turned})
                most = std::max(most, std::abs(density_of_spot(other) - expected));
        }
    return 8 * most + 1e-5 * expected;
}

void hot_spot_densities(Run& run) {
    std::mt19937 random(std::uint32_t(run.seed()));
    const auto count = run.count(16'384u, 1'048'576u);
    const std::vector<SpotView> views = spot_views(random, count);
    const Buffer<SpotView> numbers(run.device(), views);
    const Buffer<float> alone(run.device(), count), together(run.device(), count);
    load_kernel(run.device(), "verify/near_lights.cl", "see_hot_spots")
        .run({count / 16, 1}, arg("numbers", numbers), count, arg("alone", alone), arg("together", together));
    const auto one = alone.read(), sixteen = together.read();
    Tally seen, wrong_one, wrong_sixteen;
    for (std::size_t i = 0; i < count; ++i) {
        const double expected = density_of_spot(views[i]), wide = uncertainty_of(views[i]);
        seen.add(expected == 0);
        wrong_one.add(std::abs(one[i] - expected) <= wide), wrong_sixteen.add(std::abs(sixteen[i] - expected) <= wide);
    }
    run.check("wrong densities of one ray", wrong_one, "directions");
    run.check("wrong densities of sixteen rays", wrong_sixteen, "directions");
    run.check("directions that do not meet the plane", count, double(seen.tried - seen.wrong), 0.6 * count,
              "directions");
}

}  // namespace

Cases near_light_cases() {
    return {
        {{"light-lists", "images",
          "Lights are picked from lists in proportion to what they give, and by no other number"},
         light_lists},
        {{"hot-spots", "images", "Densities of directions to hot spots are those of rays from the light"},
         hot_spot_densities},
    };
}

}  // namespace claray::verify
