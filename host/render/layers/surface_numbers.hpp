// The numbers of the user's scene for what rays meet in the scene that is traced (host/scene/placement.hpp).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/placement.hpp"

namespace claray {

/// Of the user's scene. What has no name is called by its kind and number.
struct SurfaceNames {
    std::vector<std::string> objects, instances, materials;  // objects: meshes, then sets of primitives
};

class SurfaceNumbers {
public:
    SurfaceNumbers() = default;
    /// `places`, `numbers`: see PlacedScene; empty if the scene is traced as it is.
    SurfaceNumbers(const Scene& scene, const std::vector<InstancePlace>& places, const TriangleNumbers& numbers);

    /// The mesh of a primitive of the user's scene or, after all meshes, its set of primitives. CLARAY_MISS is kept.
    [[nodiscard]] std::uint32_t object_of(std::uint32_t primitive) const;
    /// The instance in the user's scene; CLARAY_MISS if there is none. Both numbers are those of the traced scene.
    [[nodiscard]] std::uint32_t instance_of(std::uint32_t primitive, std::uint32_t instance) const;
    [[nodiscard]] const SurfaceNames& names() const { return names_; }

private:
    /// Primitives of an object that have consecutive numbers.
    struct Run {
        std::uint32_t first, object;
    };
    std::vector<Run> runs_;
    TriangleNumbers numbers_;
    SurfaceNames names_;
    std::vector<std::uint32_t> of_baked_, of_placed_;  // instances, by mesh and by number in the traced scene
};

}  // namespace claray
