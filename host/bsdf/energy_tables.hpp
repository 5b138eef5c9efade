// Albedos of single scattering of rough surfaces by direction and roughness, with which kernels/bsdf/ggx.clh adds the
// light of multiple scattering.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "claray/scene.hpp"
#include "claray/shared/energy.h"

namespace claray {

/// Only the tables that the materials need; empty if none needs any. The parameters of added BSDFs follow the tables.
class EnergyTables {
public:
    explicit EnergyTables(std::span<const Material> materials);

    /// In the layout of claray/shared/energy.h.
    [[nodiscard]] const std::vector<float>& data() const { return data_; }
    /// Offset of the block of an index of refraction; 0 if there is none.
    [[nodiscard]] std::uint32_t block_of(float ior) const;
    /// Offset of the parameters of a material with an added BSDF.
    [[nodiscard]] std::uint32_t parameters_of(const Material& material) const;

private:
    struct Needs {
        bool opaque = false, transparent = false, coat = false, stretched = false;
        bool changed = false;  ///< rough glass with another reflectance than Fresnel's
    };
    void add_needs(const Material& material);
    void fill_tables();

    bool conductor_ = false, sheen_ = false, stretched_ = false, film_ = false;
    std::map<float, Needs> needs_;
    std::map<float, std::uint32_t> blocks_;
    std::map<std::vector<float>, std::uint32_t> parameters_;  // of added BSDFs
    std::vector<float> data_;
};

}  // namespace claray
