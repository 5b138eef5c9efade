// Rays traced in several ways on the same tree, timed in alternating runs.
#pragma once

#include <algorithm>

#include "claray/accuracy.hpp"
#include "claray/query.hpp"

namespace claray {

/// One way: the macros of kernels/accuracy/trace_variant.cl, or the shipped query.
struct RayVariant {
    std::string method, setting;
    Defines defines = {};
    Math math = Math::strict;
    unsigned node_bits = 32;
    bool shipped = false;
    bool counts_boxes = false;  ///< by another kernel, once; not of what ships
};

struct TracedVariant {
    std::vector<Hit> hits;
    std::vector<double> seconds;  ///< of the device, a value a round; none where the study was stopped before
    double boxes = 0;             ///< tested, a ray, if they are counted
};

/// Runs that are repeated for so long that they take `least_seconds` need fewer rounds.
[[nodiscard]] inline unsigned rounds_of(const StudyOptions& options) {
    constexpr unsigned most_of_long_runs = 3;
    return std::clamp(options.runs, 1u, options.least_seconds > 0 ? most_of_long_runs : ~0u);
}

/// Over a tree of the balanced builder.
[[nodiscard]] std::vector<TracedVariant> trace_variants(const Device& device, std::span<const Mesh> meshes,
                                                        std::span<const Ray> rays,
                                                        const std::vector<RayVariant>& variants,
                                                        const StudyOptions& options, const AccuracyProgress& progress);

/// At most so many that testing them all against all triangles takes about a second.
[[nodiscard]] std::size_t rays_to_judge(std::size_t wanted, std::span<const Mesh> meshes);

/// Half of them start at the scene's camera, the others bounce off their hits.
[[nodiscard]] std::vector<Ray> rays_of_scene(const Device& device, const Scene& scene, std::span<const Mesh> meshes,
                                             std::size_t count);

}  // namespace claray
