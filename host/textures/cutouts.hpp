// The triangles with parts through which rays pass: their records as in include/claray/shared/texture.h.
#pragma once

#include <functional>
#include <vector>

#include "claray/scene.hpp"
#include "claray/shared/texture.h"

namespace claray {

/// Empty if every triangle is solid, or if all are one-sided, which queries handle themselves.
struct Cutouts {
    /// `slot_of` returns the index in the store of a texture of the scene, and marks the texture for upload.
    Cutouts(const Scene& scene, const std::vector<bool>& used,
            const std::function<std::uint32_t(std::uint32_t)>& slot_of);

    std::vector<CutoutMaterial> materials;
    std::vector<std::uint32_t> records;       ///< one after the other
    std::vector<std::uint32_t> of_triangles;  ///< index of the record's first word, or CLARAY_NO_MAP

    [[nodiscard]] bool empty() const { return records.empty(); }
};

/// Returns whether a masked material exists where it has this opacity.
[[nodiscard]] bool passes_alpha_test(const Material& material, float opacity);

/// Returns whether every material in use is one-sided and nothing is cut out.
[[nodiscard]] bool culls_everywhere(const Scene& scene, const std::vector<bool>& used);
/// For each material in use, whether rays pass through some of its points.
[[nodiscard]] std::vector<bool> find_cut_outs(const Scene& scene, const std::vector<bool>& used);

}  // namespace claray
