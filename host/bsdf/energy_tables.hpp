// How much light rough surfaces scatter once, by direction and roughness: what kernels/bsdf/ggx.clh needs to give
// back the rest.
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

    /// As in claray/shared/energy.h.
    [[nodiscard]] const std::vector<float>& data() const { return data_; }
    /// Where the block of an index of refraction begins; 0 where there is none.
    [[nodiscard]] std::uint32_t block_of(float ior) const;
    /// Where the parameters of a material with an added BSDF begin.
    [[nodiscard]] std::uint32_t parameters_of(const Material& material) const;

private:
    struct Needs {
        bool opaque = false, transparent = false, coat = false;
    };
    void add_needs(const Material& material);
    void fill_tables();

    bool conductor_ = false, sheen_ = false, stretched_ = false;
    std::map<float, Needs> needs_;
    std::map<float, std::uint32_t> blocks_;
    std::map<std::vector<float>, std::uint32_t> parameters_;  // of added BSDFs
    std::vector<float> data_;
};

}  // namespace claray
