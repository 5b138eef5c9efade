// Which triangles rays pass through somewhere: their records as include/claray/shared/texture.h has them.
#pragma once

#include <functional>
#include <vector>

#include "claray/scene.hpp"
#include "claray/shared/texture.h"

namespace claray {

/// Empty where every triangle is solid, or where all have only a front, which queries know by themselves.
struct Cutouts {
    /// `slot_of` returns the index in the store of a texture of the scene, and marks the texture for upload.
    Cutouts(const Scene& scene, const std::vector<bool>& used,
            const std::function<std::uint32_t(std::uint32_t)>& slot_of);

    std::vector<CutoutMaterial> materials;
    std::vector<std::uint32_t> records;       ///< one behind the other
    std::vector<std::uint32_t> of_triangles;  ///< index of the record's first word, or CLARAY_NO_MAP

    [[nodiscard]] bool empty() const { return records.empty(); }
};

/// Whether every material in use has only a front, and nothing is cut out.
[[nodiscard]] bool culls_everywhere(const Scene& scene, const std::vector<bool>& used);
/// Of each material in use whether rays pass through some of its points.
[[nodiscard]] std::vector<bool> find_cut_outs(const Scene& scene, const std::vector<bool>& used);

}  // namespace claray
