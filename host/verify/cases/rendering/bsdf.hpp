// Materials on the device, one at a time, to test what every BSDF must satisfy: energy, reciprocity and its stated
// density.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "claray/program.hpp"
#include "host/bsdf/material_data.hpp"

namespace claray::verify {

inline constexpr double pi = std::numbers::pi;

struct Sampled {
    float x, y, z, weight, pdf, eval_value, eval_pdf;
    std::uint32_t valid;
};

class TestedMaterial {
public:
    TestedMaterial(const Device& device, const Material& material, bool inside = false)
        : device_(device), tables_(std::span(&material, 1)), data_(material_data(material, tables_)), inside_(inside) {
        const std::vector<float> none(1);
        buffer_ = Buffer<float>(device_, tables_.data().empty() ? none : tables_.data());
    }
    /// A kernel of kernels/verify/bsdf/FILE.cl.
    template <class... Args>
    void run(const std::string& file, const char* kernel, std::size_t items, const Args&... args) const {
        load_kernel(device_, "verify/bsdf/" + file + ".cl", kernel)
            .run({items, 64}, data_, arg("tables", buffer_), std::uint32_t(inside_), args...);
    }
    /// Samples of one outgoing direction; with eval_bsdf of each if `evaluates`.
    [[nodiscard]] std::vector<Sampled> draw(const glm::vec3& outgoing, std::uint32_t count, std::uint32_t seed = 1,
                                            bool evaluates = true) const;
    struct Evaluated {
        std::vector<float> values, pdfs;
    };
    /// eval_bsdf at many directions: values over |cos|, and densities.
    [[nodiscard]] Evaluated evaluate(const glm::vec3& outgoing, const std::vector<float>& directions) const;
    /// The coat's normal in the surface's frame.
    void tilt_coat(const glm::vec3& n) { data_.coat_x = n.x, data_.coat_y = n.y, data_.coat_z = n.z; }

private:
    Device device_;
    EnergyTables tables_;
    MaterialData data_;
    Buffer<float> buffer_;
    bool inside_;
};

[[nodiscard]] inline glm::vec3 at_angle(double theta, double phi = 0.3) {
    return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)), float(std::cos(theta))};
}

/// A material that absorbs nothing.
[[nodiscard]] inline Material white(MaterialKind kind, float roughness, float ior = 1.5f) {
    Material m;
    m.kind = kind, m.albedo = glm::vec3(1.f), m.roughness = roughness, m.ior = ior;
    return m;
}

/// The test of a material at a roughness, from outside and, if relevant, from inside.
struct Kind {
    const char* name;
    Material (*make)(float roughness);
    bool inside = false;
    bool complete = true;  ///< a white one reflects or transmits all light
    bool mixed = false;    ///< its parts are chosen at random and tested separately
};
[[nodiscard]] const std::vector<Kind>& bsdf_kinds();
[[nodiscard]] TestedMaterial tested(const Device& device, const Kind& kind, float roughness);

/// The probability that a sampler with the claimed density deviates by more: a chi-squared test over a grid of
/// directions.
struct Agreement {
    double chance = 1;
    double excess = 0;  ///< of the density's integral over the share of samples that have one
};
[[nodiscard]] Agreement agreement_of_samples(const Device& device, const Kind& kind, float roughness,
                                             const glm::vec3& outgoing, std::uint32_t samples, std::uint32_t seed = 1);

/// The chance that chi-squared with so many degrees of freedom is larger (Wilson and Hilferty 1931).
[[nodiscard]] double chance_of_chi_squared(double chi2, double degrees);

/// Fresnel's equations in float64 complex arithmetic, which needs no case for total reflection.
[[nodiscard]] double fresnel_reference(double cosine, double eta);
/// Directional albedo of GGX with Fresnel 1 that is scattered once, by the midpoint rule.
[[nodiscard]] double single_scattering_albedo(double alpha, double cosine);

}  // namespace claray::verify
