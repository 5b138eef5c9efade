#include "host/io/world/spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace claray {
namespace {

/// The standard observer of 1931 for 2 degrees and the illuminant D65, scaled to 1 as 100 (CIE 15:2004, tables T.1 and
/// T.4), every 10 nm from 380 nm on.
struct CieRow {
    double x, y, z, d65;
};
constexpr double first_wavelength = 380, wavelength_step = 10;
constexpr CieRow cie_rows[] = {{0.001368, 0.000039, 0.006450, 0.49975}, {0.004243, 0.000120, 0.020050, 0.54648},
                               {0.014310, 0.000396, 0.067850, 0.82755}, {0.043510, 0.001210, 0.207400, 0.91486},
                               {0.134380, 0.004000, 0.645600, 0.93432}, {0.283900, 0.011600, 1.385600, 0.86682},
                               {0.348280, 0.023000, 1.747060, 1.04865}, {0.336200, 0.038000, 1.772110, 1.17008},
                               {0.290800, 0.060000, 1.669200, 1.17812}, {0.195360, 0.090980, 1.287640, 1.14861},
                               {0.095640, 0.139020, 0.812950, 1.15923}, {0.032010, 0.208020, 0.465180, 1.08811},
                               {0.004900, 0.323000, 0.272000, 1.09354}, {0.009300, 0.503000, 0.158200, 1.07802},
                               {0.063270, 0.710000, 0.078250, 1.04790}, {0.165500, 0.862000, 0.042160, 1.07689},
                               {0.290400, 0.954000, 0.020300, 1.04405}, {0.433450, 0.994950, 0.008750, 1.04046},
                               {0.594500, 0.995000, 0.003900, 1.00000}, {0.762100, 0.952000, 0.002100, 0.96334},
                               {0.916300, 0.870000, 0.001650, 0.95788}, {1.026300, 0.757000, 0.001100, 0.88686},
                               {1.062200, 0.631000, 0.000800, 0.90006}, {1.002600, 0.503000, 0.000340, 0.89599},
                               {0.854450, 0.381000, 0.000190, 0.87699}, {0.642400, 0.265000, 0.000050, 0.83289},
                               {0.447900, 0.175000, 0.000020, 0.83699}, {0.283500, 0.107000, 0.000000, 0.80027},
                               {0.164900, 0.061000, 0.000000, 0.80215}, {0.087400, 0.032000, 0.000000, 0.82278},
                               {0.046770, 0.017000, 0.000000, 0.78284}, {0.022700, 0.008210, 0.000000, 0.69721},
                               {0.011359, 0.004102, 0.000000, 0.71609}, {0.005790, 0.002091, 0.000000, 0.74349},
                               {0.002899, 0.001047, 0.000000, 0.61604}, {0.001440, 0.000520, 0.000000, 0.69886},
                               {0.000690, 0.000249, 0.000000, 0.75087}, {0.000332, 0.000120, 0.000000, 0.63593},
                               {0.000166, 0.000060, 0.000000, 0.46418}, {0.000083, 0.000030, 0.000000, 0.66805},
                               {0.000042, 0.000015, 0.000000, 0.63383}};

/// XYZ with the white point D65 to linear Rec. 709 (IEC 61966-2-1).
glm::dvec3 rgb_of_xyz(const glm::dvec3& c) {
    return {3.2404542 * c.x - 1.5371385 * c.y - 0.4985314 * c.z, -0.9692660 * c.x + 1.8760108 * c.y + 0.0415560 * c.z,
            0.0556434 * c.x - 0.2040259 * c.y + 1.0572252 * c.z};
}

double value_at(std::span<const SpectrumSample> samples, double wavelength) {
    if (samples.empty() || !(wavelength >= samples.front().wavelength && wavelength <= samples.back().wavelength))
        return 0;
    const auto above = std::lower_bound(samples.begin(), samples.end(), wavelength,
                                        [](const SpectrumSample& s, double at) { return s.wavelength < at; });
    if (above == samples.begin() || above->wavelength == wavelength) return above->value;
    const SpectrumSample &a = *(above - 1), &b = *above;
    return a.value + (b.value - a.value) * (wavelength - a.wavelength) / (b.wavelength - a.wavelength);
}

/// Sums `value(wavelength)` over the curves, every nanometre; the luminance of 1 is 1.
template <class Value>
glm::dvec3 xyz_of(const Value& value, bool by_d65) {
    constexpr int per_row = 10;
    glm::dvec3 sum(0.0);
    double white = 0;
    for (std::size_t row = 0; row + 1 < std::size(cie_rows); ++row) {
        for (int step = 0; step < per_row; ++step) {
            const double t = double(step) / per_row,
                         wavelength = first_wavelength + wavelength_step * (double(row) + t);
            const CieRow &a = cie_rows[row], &b = cie_rows[row + 1];
            const glm::dvec3 curves(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z));
            const double light = by_d65 ? a.d65 + t * (b.d65 - a.d65) : 1.0;
            sum += curves * (light * value(wavelength));
            white += curves.y * light;
        }
    }
    return sum / white;
}

glm::vec3 sampled(std::span<const SpectrumSample> samples, bool by_d65) {
    const auto value = [&](double wavelength) { return value_at(samples, wavelength); };
    return rgb_of_xyz(xyz_of(value, by_d65));
}

struct NamedConductor {
    std::string_view name;
    Conductor of;
};
/// Published measurements (Palik 1998, Sopra S.A.) as sums over the CIE's curves in the light of equal energy.
constexpr NamedConductor conductors[] = {{"a-C", {{2.944f, 2.2271f, 1.9682f}, {0.88746f, 0.7993f, 0.81529f}}},
                                         {"Ag", {{0.15528f, 0.11673f, 0.13839f}, {4.8284f, 3.1222f, 2.1469f}}},
                                         {"Al", {{1.6575f, 0.8804f, 0.52124f}, {9.2238f, 6.2695f, 4.837f}}},
                                         {"AlAs", {{3.6053f, 3.2329f, 2.2163f}, {0.00068f, 0.f, 0.00751f}}},
                                         {"AlSb", {{0.f, 4.1394f, 4.6693f}, {0.f, 0.094009f, 1.3006f}}},
                                         {"Au", {{0.14304f, 0.37531f, 1.442f}, {3.983f, 2.3856f, 1.6034f}}},
                                         {"Be", {{4.185f, 3.185f, 2.7841f}, {3.8355f, 3.0101f, 2.869f}}},
                                         {"Cr", {{4.3697f, 2.9165f, 1.6549f}, {5.2065f, 4.2313f, 3.7547f}}},
                                         {"CsI", {{2.1449f, 1.7023f, 1.6624f}, {0.f, 0.f, 0.f}}},
                                         {"Cu", {{0.20101f, 0.92375f, 1.1022f}, {3.9133f, 2.453f, 2.1421f}}},
                                         {"CuZn", {{0.444f, 0.527f, 1.094f}, {3.695f, 2.765f, 1.829f}}},
                                         {"Cu2O", {{3.5518f, 2.9499f, 2.7519f}, {0.11421f, 0.1939f, 0.60613f}}},
                                         {"CuO", {{3.2475f, 2.4478f, 2.2102f}, {0.52109f, 0.57003f, 0.72218f}}},
                                         {"d-C", {{2.7087f, 2.3188f, 2.2289f}, {0.f, 0.f, 0.f}}},
                                         {"Hg", {{2.3989f, 1.44f, 0.90957f}, {6.3276f, 4.3719f, 3.4218f}}},
                                         {"HgTe", {{4.779f, 3.2312f, 2.6599f}, {1.6316f, 1.5808f, 1.7293f}}},
                                         {"Ir", {{3.0863f, 2.0822f, 1.6179f}, {5.5922f, 4.0671f, 3.2673f}}},
                                         {"K", {{0.064043f, 0.04641f, 0.038185f}, {2.1042f, 1.3489f, 0.91313f}}},
                                         {"Li", {{0.26579f, 0.19562f, 0.22095f}, {3.5402f, 2.3111f, 1.6686f}}},
                                         {"MgO", {{2.0896f, 1.6507f, 1.5949f}, {0.f, 0.f, 0.f}}},
                                         {"Mo", {{4.484f, 3.5251f, 2.7763f}, {4.1114f, 3.4208f, 3.1506f}}},
                                         {"Na", {{0.060269f, 0.056141f, 0.061988f}, {3.1793f, 2.1125f, 1.579f}}},
                                         {"Nb", {{3.4201f, 2.7901f, 2.3956f}, {3.4414f, 2.7377f, 2.5797f}}},
                                         {"Ni", {{2.3673f, 1.6634f, 1.4671f}, {4.4988f, 3.0502f, 2.3454f}}},
                                         {"Rh", {{2.5858f, 1.8602f, 1.5543f}, {6.7823f, 4.703f, 3.9761f}}},
                                         {"Se", {{4.0583f, 2.8429f, 2.8209f}, {0.75405f, 0.63844f, 0.52181f}}},
                                         {"SiC", {{3.1723f, 2.526f, 2.4794f}, {0.f, 0.f, 0.00001f}}},
                                         {"SnTe", {{4.5242f, 1.9816f, 1.2816f}, {0.f, 0.f, 0.f}}},
                                         {"Ta", {{2.0627f, 2.3929f, 2.6279f}, {2.4084f, 1.7415f, 1.947f}}},
                                         {"Te", {{7.3902f, 4.4821f, 2.6371f}, {3.256f, 3.5271f, 3.2921f}}},
                                         {"ThF4", {{1.8307f, 1.4422f, 1.3876f}, {0.f, 0.f, 0.f}}},
                                         {"TiC", {{3.7005f, 2.8374f, 2.5823f}, {3.2656f, 2.3516f, 2.1728f}}},
                                         {"TiN", {{1.6484f, 1.1505f, 1.3798f}, {3.3683f, 1.9435f, 1.1021f}}},
                                         {"TiO2", {{3.4566f, 2.8017f, 2.9052f}, {0.00011f, 0.f, 0.00065f}}},
                                         {"VC", {{3.6576f, 2.7527f, 2.5327f}, {3.0683f, 2.1987f, 1.9632f}}},
                                         {"V", {{4.2776f, 3.5129f, 2.7611f}, {3.4913f, 2.8895f, 3.1115f}}},
                                         {"VN", {{2.8656f, 2.1192f, 1.9401f}, {3.0322f, 2.0561f, 1.6163f}}},
                                         {"W", {{4.3708f, 3.3002f, 2.9984f}, {3.5006f, 2.6049f, 2.2732f}}},
                                         {"none", {{0.f, 0.f, 0.f}, {1.f, 1.f, 1.f}}}};  // reflects everything

struct NamedIor {
    std::string_view name;
    float ior;
};
constexpr NamedIor iors[] = {{"vacuum", 1.f},
                             {"helium", 1.00004f},
                             {"hydrogen", 1.00013f},
                             {"air", 1.00028f},
                             {"carbon dioxide", 1.00045f},
                             {"water ice", 1.31f},
                             {"water", 1.333f},
                             {"acetone", 1.36f},
                             {"ethanol", 1.361f},
                             {"fused quartz", 1.458f},
                             {"carbon tetrachloride", 1.461f},
                             {"pyrex", 1.47f},
                             {"glycerol", 1.4729f},
                             {"acrylic glass", 1.49f},
                             {"polypropylene", 1.49f},
                             {"benzene", 1.501f},
                             {"bk7", 1.5046f},
                             {"silicone oil", 1.52045f},
                             {"sodium chloride", 1.544f},
                             {"amber", 1.55f},
                             {"pet", 1.575f},
                             {"bromine", 1.661f},
                             {"diamond", 2.419f},
                             {"glass-BK7", 1.5168f},
                             {"glass-BAF10", 1.67f},
                             {"glass-FK51A", 1.4866f},
                             {"glass-LASF9", 1.8503f},
                             {"glass-F5", 1.6727f},
                             {"glass-F10", 1.7283f},
                             {"glass-F11", 1.7847f}};

double dielectric_reflectance(double ior, double cosine) {
    const double sine2 = (1 - cosine * cosine) / (ior * ior);
    if (sine2 >= 1) return 1;
    const double beyond = std::sqrt(1 - sine2);
    const double s = (cosine - ior * beyond) / (cosine + ior * beyond),
                 p = (ior * cosine - beyond) / (ior * cosine + beyond);
    return (s * s + p * p) / 2;
}

/// The integral of 2 c f(c) over cosines: what diffuse light meets.
template <class Function>
double of_diffuse_light(const Function& f) {
    constexpr int steps = 1000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double cosine = (i + 0.5) / steps;
        sum += 2 * cosine * f(cosine) / steps;
    }
    return sum;
}

}  // namespace

glm::vec3 rgb_of_reflectance(std::span<const SpectrumSample> samples) { return sampled(samples, true); }
glm::vec3 rgb_of_light(std::span<const SpectrumSample> samples) { return sampled(samples, false); }

glm::vec3 rgb_of_blackbody(double kelvin) {
    const auto planck = [&](double nanometres) {
        const double metres = nanometres * 1e-9, second_constant = 1.438776877e-2;  // h c / k, in m K
        return std::pow(560 / nanometres, 5) * std::expm1(second_constant / (560e-9 * kelvin)) /
               std::expm1(second_constant / (metres * kelvin));
    };
    const glm::dvec3 xyz = xyz_of(planck, false);
    return glm::max(rgb_of_xyz(xyz / xyz.y), 0.0);
}

float luminance_of(const glm::vec3& rgb) { return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z; }

std::optional<Conductor> conductor_named(std::string_view name) {
    constexpr std::string_view metal = "metal-", palik = "_palik";
    if (name.starts_with(metal)) name.remove_prefix(metal.size());
    for (const std::string_view end : {std::string_view("-eta"), std::string_view("-k"), palik})
        if (name.ends_with(end)) name.remove_suffix(end.size());
    for (const NamedConductor& each : conductors)
        if (each.name == name) return each.of;
    return {};
}

std::optional<float> ior_named(std::string_view name) {
    for (const NamedIor& each : iors)
        if (each.name == name) return each.ior;
    return {};
}

double conductor_reflectance(double eta, double k, double cosine) {
    const double c2 = cosine * cosine, s2 = 1 - c2, difference = eta * eta - k * k - s2;
    const double root = std::sqrt(difference * difference + 4 * eta * eta * k * k);  // a^2 + b^2
    const double a = std::sqrt(std::max(0.0, (root + difference) / 2));
    const double s = (root + c2 - 2 * cosine * a) / (root + c2 + 2 * cosine * a);
    const double p = s * (c2 * root + s2 * s2 - 2 * cosine * a * s2) / (c2 * root + s2 * s2 + 2 * cosine * a * s2);
    return (s + p) / 2;
}

glm::vec3 schlick_color(const Conductor& conductor) {
    glm::vec3 color;
    for (int i = 0; i < 3; ++i) {
        const double mean = of_diffuse_light(
            [&](double cosine) { return conductor_reflectance(conductor.eta[i], conductor.k[i], cosine); });
        color[i] = float(std::clamp((mean - 1.0 / 21) * 21 / 20, 0.0, 1.0));  // Schlick's mean is F0 + (1 - F0) / 21
    }
    return color;
}

double inner_reflectance(double ior) {
    return of_diffuse_light([&](double cosine) { return dielectric_reflectance(1 / ior, cosine); });
}

}  // namespace claray
