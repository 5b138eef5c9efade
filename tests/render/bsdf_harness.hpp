// Materials on the device, one at a time: what the kernels of the BSDF tests share.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "claray/program.hpp"
#include "host/render/material_data.hpp"
#include "tests/support/device.hpp"

namespace claray::test {

inline constexpr double pi = std::numbers::pi;

struct Sampled {
    float x, y, z, weight, pdf, eval_value, eval_pdf;
    std::uint32_t valid;
};

/// One of the kernels in bsdf_harness.cpp.
[[nodiscard]] Kernel bsdf_kernel(const char* kernel);

class TestedMaterial {
public:
    explicit TestedMaterial(const Material& material, bool inside = false)
        : tables_(std::span(&material, 1)), data_(material_data(material, tables_)), inside_(inside) {
        const std::vector<float> none(1);
        buffer_ = Buffer<float>(device(), tables_.data().empty() ? none : tables_.data());
    }
    template <class... Args>
    void run(const char* kernel, std::size_t items, const Args&... args) const {
        bsdf_kernel(kernel).run({items, 64}, data_, buffer_, std::uint32_t(inside_), args...);
    }
    [[nodiscard]] std::vector<Sampled> draw(const glm::vec3& outgoing, std::uint32_t count) const;
    struct Evaluated {
        std::vector<float> values, pdfs;
    };
    /// eval_bsdf at many directions: values over |cos|, and densities.
    [[nodiscard]] Evaluated evaluate(const glm::vec3& outgoing, const std::vector<float>& directions) const;
    /// What a principled material turns out to be at a hit.
    void become(std::uint32_t kind) { data_.kind = kind; }

private:
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

}  // namespace claray::test
