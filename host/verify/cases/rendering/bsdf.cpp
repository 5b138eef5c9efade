#include "host/verify/cases/rendering/bsdf.hpp"

#include <algorithm>
#include <complex>
#include <functional>
#include <memory>

namespace claray::verify {

std::vector<Sampled> TestedMaterial::draw(const glm::vec3& o, std::uint32_t count, std::uint32_t seed,
                                          bool evaluates) const {
    const Buffer<Sampled> out(device_, count);
    run("samples", "sample", count, o.x, o.y, o.z, count, seed, std::uint32_t(evaluates), out);
    return out.read();
}

TestedMaterial::Evaluated TestedMaterial::evaluate(const glm::vec3& o, const std::vector<float>& directions) const {
    const auto count = std::uint32_t(directions.size() / 3);
    const Buffer<float> values(device_, count), pdfs(device_, count);
    run("samples", "eval", count, o.x, o.y, o.z, count, arg("directions", Buffer<float>(device_, directions)),
        arg("values", values), arg("pdfs", pdfs));
    return {values.read(), pdfs.read()};
}

double chance_of_chi_squared(double chi2, double degrees) {
    const double variance = 2 / (9 * degrees);
    const double z = (std::cbrt(chi2 / degrees) - (1 - variance)) / std::sqrt(variance);
    return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

namespace {

Material plain_metal(float roughness) { return white(MaterialKind::metal, roughness); }
Material plain_glass(float roughness) { return white(MaterialKind::glass, roughness); }
Material dense_glass(float roughness) { return white(MaterialKind::glass, roughness, 2.2f); }
Material thin_wall(float roughness) {
    Material m = plain_glass(roughness);
    m.thin_walled = true;
    return m;
}
Material bubble(float roughness) { return white(MaterialKind::glass, roughness, 1 / 1.33f); }
Material plastic(float roughness) { return white(MaterialKind::principled, roughness); }
Material dense_plastic(float roughness) { return white(MaterialKind::principled, roughness, 2.4f); }

/// Shininess of about that roughness.
Material blinn_phong(float roughness) {
    Material m = white(MaterialKind::blinn_phong, roughness);
    m.albedo = glm::vec3(0.5f), m.specular = glm::vec3(0.5f);
    m.shininess = roughness > 0.f ? 2.f / std::pow(roughness, 4.f) - 2.f : 0.5f;
    return m;
}
Material only_highlight(float roughness) {
    Material m = blinn_phong(roughness);
    m.albedo = glm::vec3(0.f), m.specular = glm::vec3(1.f);
    return m;
}
Material with_coat(Material m, float roughness) {
    m.clearcoat = 1.f, m.clearcoat_roughness = roughness;
    return m;
}
/// Metal under a coat; its own roughness and the coat's differ.
Material coated_metal(float roughness) {
    Material m = white(MaterialKind::principled, roughness);
    m.metallic = 1.f, m.clearcoat = 1.f, m.clearcoat_roughness = 0.1f;
    return m;
}
Material under_rough_coat(float roughness) {
    Material m = coated_metal(0.35f);
    m.clearcoat_roughness = roughness;
    return m;
}
Material coated_plastic(float roughness) { return with_coat(plastic(roughness), 0.1f); }
Material mixture(float roughness) {
    Material m = white(MaterialKind::principled, roughness, 1.4f);
    m.metallic = 0.4f, m.clearcoat = 0.6f, m.clearcoat_roughness = 0.2f, m.transmission = 0.5f;
    return m;
}

/// Its red reflectance at normal incidence is the largest and exceeds that of the index of refraction.
Material tinted_plastic(float roughness) {
    Material m = plastic(roughness);
    m.specular_tint = {8.f, 4.f, 0.5f};
    return m;
}
Material weak_plastic(float roughness) {
    Material m = dense_plastic(roughness);
    m.specular_weight = 0.3f, m.specular_tint = glm::vec3(0.5f);
    return m;
}
/// Only grazing light is reflected, by an index whose own curve would fall first.
Material steep_plastic(float roughness) {
    Material m = white(MaterialKind::principled, roughness, 1000.f);
    m.specular_tint = glm::vec3(0.f);
    return m;
}
Material with_film(Material m) {
    m.iridescence = 1.f, m.iridescence_ior = 1.8f, m.film_thickness.y = 420.f;
    return m;
}
Material film_on_plastic(float roughness) { return with_film(plastic(roughness)); }
Material film_on_metal(float roughness) {
    Material m = with_film(plastic(roughness));
    m.metallic = 1.f, m.albedo = glm::vec3(0.6f);
    return m;
}
Material film_on_glass(float roughness) {
    Material m = with_film(plastic(roughness));
    m.transmission = 1.f;
    return m;
}
Material brushed_metal(float roughness) {
    Material m = plastic(roughness);
    m.metallic = 1.f, m.anisotropy = 0.7f;
    return m;
}
Material brushed_plastic(float roughness) {
    Material m = plastic(roughness);
    m.anisotropy = 1.f;
    return m;
}
/// Fibres over a smooth metal, whose reflection is a delta function, or over plastic.
Material sheen_on_mirror(float roughness) {
    Material m = plastic(0.f);
    m.metallic = 1.f, m.sheen = glm::vec3(1.f), m.sheen_roughness = roughness;
    return m;
}
Material cloth(float roughness) {
    Material m = plastic(0.8f);
    m.sheen = glm::vec3(0.7f), m.sheen_roughness = roughness;
    return m;
}
Material sheen_on_plastic(float roughness) {
    Material m = plastic(roughness);
    m.sheen = glm::vec3(1.f), m.sheen_roughness = 0.4f;
    return m;
}
Material sheen_on_metal(float roughness) {
    Material m = sheen_on_plastic(roughness);
    m.metallic = 1.f;
    return m;
}
/// A separate coat over a base without an interface, and over a film.
Material coated_diffuse(float roughness) {
    Material m = plastic(0.5f);
    m.specular_weight = 0.f, m.clearcoat = 1.f, m.clearcoat_roughness = roughness;
    return m;
}
Material coated_film(float roughness) { return with_coat(film_on_plastic(roughness), 0.2f); }
/// A separate coat over a cloth, and over a brushed metal.
Material coated_cloth(float roughness) { return with_coat(cloth(0.5f), roughness); }
Material coated_brushed_metal(float roughness) { return with_coat(brushed_metal(roughness), 0.3f); }

Material sheen_on_wall(float roughness) {
    Material m = sheen_on_plastic(roughness);
    m.transmission = 1.f, m.thin_walled = true;
    return m;
}
Material weak_glass(float roughness) {
    Material m = weak_plastic(roughness);
    m.transmission = 1.f;
    return m;
}
Material sheen_on_glass(float roughness) {
    Material m = sheen_on_plastic(roughness);
    m.transmission = 1.f;
    return m;
}
Material coated_sheen_on_metal(float roughness) { return with_coat(sheen_on_metal(roughness), 0.3f); }
Material coated_film_on_glass(float roughness) { return with_coat(film_on_glass(roughness), 0.3f); }
Material brushed_film(float roughness) {
    Material m = film_on_plastic(roughness);
    m.anisotropy = 0.4f, m.film_thickness.y = 250.f;
    return m;
}

const std::vector<Kind> kinds = {
    {"Lambert", [](float r) { return white(MaterialKind::lambert, r); }},
    {"OrenNayar", [](float r) { return white(MaterialKind::oren_nayar, r); }},
    {"Mirror", [](float r) { return white(MaterialKind::mirror, r); }},
    {"Metal", plain_metal},
    {"Glass", plain_glass},
    {"GlassInside", plain_glass, true},
    {"DenseGlass", dense_glass},
    {"DenseGlassInside", dense_glass, true},
    {"Bubble", bubble},
    {"BubbleInside", bubble, true},
    {"ThinWall", thin_wall},
    {"ThinWallInside", thin_wall, true},
    {"BlinnPhong", blinn_phong, false, false},
    {"OnlyHighlight", only_highlight, false, false},
    {"Plastic", plastic},
    {"DensePlastic", dense_plastic},
    {"CoatedPlastic", coated_plastic},
    {"CoatedMetal", coated_metal},
    {"UnderRoughCoat", under_rough_coat},
    {"TintedPlastic", tinted_plastic},
    {"WeakPlastic", weak_plastic},
    {"SteepPlastic", steep_plastic},
    {"FilmOnPlastic", film_on_plastic},
    {"FilmOnMetal", film_on_metal, false, false},
    {"FilmOnGlass", film_on_glass},
    {"FilmOnGlassInside", film_on_glass, true},
    {"BrushedMetal", brushed_metal},
    {"BrushedPlastic", brushed_plastic},
    {"SheenOnMirror", sheen_on_mirror},
    {"Cloth", cloth},
    {"CoatedCloth", coated_cloth},
    {"CoatedBrushedMetal", coated_brushed_metal},
    {"SheenOnMetal", sheen_on_metal},
    {"SheenOnMetalBehind", sheen_on_metal, true},
    {"SheenOnWall", sheen_on_wall},
    {"WeakGlass", weak_glass},
    {"WeakGlassInside", weak_glass, true},
    {"SheenOnGlass", sheen_on_glass},
    {"SheenOnGlassInside", sheen_on_glass, true},
    {"CoatedSheenOnMetal", coated_sheen_on_metal},
    {"CoatedFilmOnGlass", coated_film_on_glass},
    {"CoatedFilmOnGlassInside", coated_film_on_glass, true},
    {"BrushedFilm", brushed_film},
    {"CoatedDiffuse", coated_diffuse},
    {"SheenOnPlastic", sheen_on_plastic},
    {"CoatedFilm", coated_film},
    {"Mixture", mixture, false, true, true},
    {"MixtureInside", mixture, true, true, true},
};

// ---- chi-squared

/// Cells of directions on one side of the horizon.
class Grid {
public:
    using Visitor = std::function<void(std::size_t cell, const glm::dvec3& direction, double solid_angle)>;

    explicit Grid(bool above) : above_(above) {}
    Grid(const Grid&) = delete;
    Grid& operator=(const Grid&) = delete;
    virtual ~Grid() = default;
    [[nodiscard]] bool above() const { return above_; }
    [[nodiscard]] virtual std::size_t size() const = 0;
    [[nodiscard]] virtual std::size_t cell(const glm::dvec3& direction) const = 0;
    /// The midpoints of parts of each cell, so many that the midpoint rule's error is far below the noise of a million
    /// samples.
    virtual void visit(const Visitor& visitor) const = 0;

private:
    bool above_;
};

/// Equal turns around an axis, and rings that are narrow near it, as the lobe there is.
class RingGrid : public Grid {
public:
    RingGrid(const glm::dvec3& towards, double width) : Grid(towards.z > 0), axis_(glm::normalize(towards)) {
        side_ = glm::normalize(glm::cross(axis_, std::abs(axis_.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
        other_ = glm::cross(axis_, side_);
        const double stretch = std::clamp(2.2 - 1.15 * std::log(width), 0.1, 12.0);  // first rings: width / 4
        for (int i = 0; i <= 24; ++i) edges_.push_back(pi * std::sinh(i * stretch / 24) / std::sinh(stretch));
        if (std::abs(axis_.z) == 1) split_at(pi / 2);
    }
    /// An edge at which the density jumps: the midpoint rule is inaccurate in a cell that contains it.
    void split_at(double angle) { edges_.insert(std::upper_bound(edges_.begin(), edges_.end(), angle), angle); }
    [[nodiscard]] std::size_t size() const override { return (edges_.size() - 1) * turns; }
    [[nodiscard]] std::size_t cell(const glm::dvec3& d) const override {
        const double x = glm::dot(d, side_), y = glm::dot(d, other_);
        const double angle = std::atan2(std::hypot(x, y), glm::dot(d, axis_));
        const auto ring = std::upper_bound(edges_.begin() + 1, edges_.end() - 1, angle) - edges_.begin() - 1;
        const double turn = std::atan2(y, x) / (2 * pi) + 0.5;
        return std::size_t(ring) * turns + std::min(int(turn * turns), turns - 1);
    }
    void visit(const Visitor& visitor) const override {
        constexpr int fine = 32;
        for (std::size_t ring = 0; ring + 1 < edges_.size(); ++ring)
            for (int i = 0; i < fine; ++i) {
                const double width = (edges_[ring + 1] - edges_[ring]) / fine, angle = edges_[ring] + (i + 0.5) * width;
                const double area = 2 * std::sin(angle) * std::sin(width / 2) * 2 * pi / turns / fine;
                for (int j = 0; j < turns * fine; ++j)
                    visitor(ring * turns + j / fine, direction(angle, (j + 0.5) / (turns * fine)), area);
            }
    }

private:
    [[nodiscard]] glm::dvec3 direction(double angle, double turn) const {
        const double phi = (turn - 0.5) * 2 * pi;
        return std::cos(angle) * axis_ + std::sin(angle) * (std::cos(phi) * side_ + std::sin(phi) * other_);
    }

    static constexpr int turns = 20;
    glm::dvec3 axis_, side_, other_;
    std::vector<double> edges_;  ///< angles from the axis
};

/// Cells of the slopes of the facets that reflect: steps of asinh(slope / alpha) along both axes. They resolve a lobe
/// however it is stretched, and diffuse light with it.
class SlopeGrid : public Grid {
public:
    SlopeGrid(const glm::dvec3& outgoing, const glm::dvec2& alpha)
        : Grid(true), outgoing_(outgoing), alpha_(alpha), reach_(glm::asinh(1e3 / alpha)) {}
    [[nodiscard]] std::size_t size() const override { return std::size_t(steps) * steps; }
    [[nodiscard]] std::size_t cell(const glm::dvec3& incoming) const override {
        const glm::dvec3 half = outgoing_ + incoming;
        const glm::dvec2 place = 0.5 + 0.5 * glm::asinh(glm::dvec2(half) / half.z / alpha_) / reach_;
        const glm::ivec2 at = glm::clamp(glm::ivec2(place * double(steps)), 0, steps - 1);
        return std::size_t(at.y) * steps + at.x;
    }
    /// Parts near the horizon are split further: there the density jumps, and lost light has its narrow peak.
    void visit(const Visitor& visitor) const override {
        constexpr int fine = 16, all = steps * fine;
        const double width = 2.0 / all;
        for (int y = 0; y < all; ++y)
            for (int x = 0; x < all; ++x) {
                const glm::dvec2 corner = width * glm::dvec2(x, y) - 1.0;
                const int splits = reaches_horizon(corner, width) ? 8 : 1;
                const std::size_t cell = std::size_t(y / fine) * steps + x / fine;
                for (int part = 0; part < splits * splits; ++part) {
                    const glm::dvec2 middle(part % splits + 0.5, part / splits + 0.5);
                    visit_part(corner + middle * (width / splits), width / splits, cell, visitor);
                }
            }
    }

private:
    [[nodiscard]] glm::dvec3 half_at(const glm::dvec2& place) const {
        return glm::normalize(glm::dvec3(alpha_ * glm::sinh(reach_ * place), 1));
    }
    [[nodiscard]] bool reaches_horizon(const glm::dvec2& corner, double width) const {
        const auto height = [&](double x, double y) {
            const glm::dvec3 half = half_at(corner + width * glm::dvec2(x, y));
            return 2 * glm::dot(outgoing_, half) * half.z - outgoing_.z;
        };
        const auto [least, most] = std::minmax({height(0, 0), height(0, 1), height(1, 0), height(1, 1)});
        return least < 0.1 && most > 0;
    }
    void visit_part(const glm::dvec2& place, double width, std::size_t cell, const Visitor& visitor) const {
        const glm::dvec3 half = half_at(place);
        const double cosine = glm::dot(outgoing_, half);
        const glm::dvec2 step = width * reach_ * alpha_ * glm::cosh(reach_ * place);
        // d incoming = 4 cosine d half, and d half = half.z^3 d slope
        if (cosine > 0)
            visitor(cell, 2 * cosine * half - outgoing_, 4 * cosine * half.z * half.z * half.z * step.x * step.y);
    }

    static constexpr int steps = 32;
    glm::dvec3 outgoing_;
    glm::dvec2 alpha_, reach_;
};

/// The integral of the density over each cell, by the midpoint rule.
std::vector<double> expected_shares(const TestedMaterial& material, const glm::vec3& outgoing, const Grid& grid) {
    std::vector<float> directions;
    std::vector<double> solid_angles;
    std::vector<std::size_t> cells;
    grid.visit([&](std::size_t cell, const glm::dvec3& d, double solid_angle) {
        if ((d.z > 0) != grid.above()) return;
        directions.insert(directions.end(), {float(d.x), float(d.y), float(d.z)});
        solid_angles.push_back(solid_angle), cells.push_back(cell);
    });
    const std::vector<float> pdfs = material.evaluate(outgoing, directions).pdfs;
    std::vector<double> shares(grid.size());
    for (std::size_t i = 0; i < pdfs.size(); ++i) shares[cells[i]] += pdfs[i] * solid_angles[i];
    return shares;
}

using Grids = std::vector<std::unique_ptr<Grid>>;

/// The probability that a sampler with the claimed density deviates by more. Invalid samples and those of delta
/// functions are in no cell.
Agreement agreement(const TestedMaterial& material, const glm::vec3& outgoing, const Grids& grids, std::uint32_t count,
                    std::uint32_t seed) {
    std::vector<std::vector<double>> observed;
    for (const auto& grid : grids) observed.emplace_back(grid->size());
    double valid = 0;
    for (const Sampled& s : material.draw(outgoing, count, seed, false)) {
        if (!s.valid || s.pdf == 0) continue;
        ++valid;
        for (std::size_t g = 0; g < grids.size(); ++g)
            if ((s.z > 0) == grids[g]->above()) ++observed[g][grids[g]->cell({s.x, s.y, s.z})];
    }
    double chi2 = 0, degrees = 0, rare_observed = 0, rare_expected = 0, total = 0;
    const auto add = [&](double seen, double expected) {
        chi2 += (seen - expected) * (seen - expected) / expected, ++degrees;
    };
    for (std::size_t g = 0; g < grids.size(); ++g) {
        const std::vector<double> shares = expected_shares(material, outgoing, *grids[g]);
        for (std::size_t i = 0; i < shares.size(); ++i) {
            const double expected = count * shares[i];
            total += shares[i];
            if (expected < 20)
                rare_observed += observed[g][i], rare_expected += expected;
            else
                add(observed[g][i], expected);
        }
    }
    if (rare_expected >= 20) add(rare_observed, rare_expected);
    return {degrees > 0 ? chance_of_chi_squared(chi2, degrees) : 1, std::abs(total - valid / count)};
}

/// Grids around the directions of ideal reflection and refraction where a lobe is narrow, else around the normal.
Grids round_grids(const Material& m, bool inside, const glm::vec3& o) {
    double width = 1;
    for (const float r : {m.roughness, m.clearcoat > 0 ? m.clearcoat_roughness : 1.f})
        if (r > 0.03f) width = std::min(width, double(r) * r);
    const double ior = m.thin_walled ? 1 : m.ior, eta = inside ? 1 / ior : ior,
                 below = 1 - (1 - o.z * o.z) / (eta * eta);
    const bool narrow = width < 0.1;
    Grids grids;
    grids.push_back(
        std::make_unique<RingGrid>(narrow ? glm::dvec3(-o.x, -o.y, o.z) : glm::dvec3(0, 0, 1), narrow ? width : 1));
    if (m.kind != MaterialKind::glass && m.transmission != 1.f) return grids;
    const bool refracted = narrow && below > 0;
    const glm::dvec3 through(-o.x / eta, -o.y / eta, -std::sqrt(std::max(below, 0.0)));
    auto grid = std::make_unique<RingGrid>(refracted ? through : glm::dvec3(0, 0, -1),
                                           refracted ? width * (m.thin_walled ? 1 : std::abs(eta - 1) / 2) : 1);
    // Upright facets refract light there; no facets are beyond them, so that GGX ends with a jump.
    if (!refracted && o.z < eta) grid->split_at(std::acos(o.z / eta));
    grids.push_back(std::move(grid));
    return grids;
}

Grids grids_for(const Material& m, bool inside, const glm::vec3& outgoing) {
    if (m.anisotropy == 0) return round_grids(m, inside, outgoing);
    // KHR_materials_anisotropy; smooth across is an alpha of SMALLEST_ALPHA in bsdf/ggx.clh.
    const double across = std::max(double(m.roughness) * m.roughness, 1e-3);
    Grids grids;
    grids.push_back(std::make_unique<SlopeGrid>(
        outgoing, glm::dvec2(glm::mix(across, 1.0, double(m.anisotropy) * m.anisotropy), across)));
    return grids;
}

}  // namespace

const std::vector<Kind>& bsdf_kinds() { return kinds; }

TestedMaterial tested(const Device& device, const Kind& kind, float roughness) {
    return TestedMaterial(device, kind.make(roughness), kind.inside);
}

Agreement agreement_of_samples(const Device& device, const Kind& kind, float roughness, const glm::vec3& outgoing,
                               std::uint32_t samples, std::uint32_t seed) {
    return agreement(tested(device, kind, roughness), outgoing, grids_for(kind.make(roughness), kind.inside, outgoing),
                     samples, seed);
}

/// Fresnel's equations in float64 complex arithmetic, which needs no case for total reflection.
double fresnel_reference(double cosine, double eta) {
    const std::complex<double> t = std::sqrt(std::complex<double>(1 - (1 - cosine * cosine) / (eta * eta)));
    const std::complex<double> s = (cosine - eta * t) / (cosine + eta * t), p = (eta * cosine - t) / (eta * cosine + t);
    return 0.5 * (std::norm(s) + std::norm(p));
}

/// By the midpoint rule over microfacet normals. With u = the distribution's
/// own cumulative function the integrand is G2 (o.h) / (cos_o cos_h), which is smooth.
double single_scattering_albedo(double alpha, double cosine) {
    const auto lambda = [&](double z) { return 0.5 * (std::sqrt(1 + alpha * alpha * (1 - z * z) / (z * z)) - 1); };
    const double ox = std::sqrt(1 - cosine * cosine);
    const int n = 1000;
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double u = (i + 0.5) / n, phi = 2 * pi * (j + 0.5) / n;
            const double tangent2 = alpha * alpha * u / (1 - u), hz = 1 / std::sqrt(1 + tangent2);
            const double hx = std::sqrt(1 - hz * hz) * std::cos(phi);
            const double oh = ox * hx + cosine * hz, iz = 2 * oh * hz - cosine;
            if (oh > 0 && iz > 0) sum += oh / (cosine * hz) / (1 + lambda(cosine) + lambda(iz));
        }
    return sum / n / n;
}

}  // namespace claray::verify
