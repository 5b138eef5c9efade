// The price of stability: what each remedy's textbook version gets wrong, and what it would save.
#pragma once

#include "claray/verify.hpp"
#include "host/bench/measure.hpp"

namespace claray::bench {

/// A remedy that can be compiled in its textbook version (kernels/compute/textbook.clh).
struct Remedy {
    std::string name, textbook;
    std::vector<std::string> macros;
    std::vector<std::string> cases;  ///< of claray verify, that it is there for
};
[[nodiscard]] const std::vector<Remedy>& remedies();

/// Failures of the remedy's cases, as shipped and by the textbook.
struct ComparedFailures {
    std::string remedy, textbook, verify_case, unit;
    std::uint64_t tried = 0;
    double shipped = 0, by_textbook = 0;  ///< of the worst check; where it counts failures, of all checks together
};
/// Runs the remedy's cases both ways.
[[nodiscard]] std::vector<ComparedFailures> compare_failures(const Device& device, const Remedy& remedy,
                                                             const VerifyOptions& options);

/// What tracing costs, by turns: medians of rounds.
struct ComparedTimes {
    std::string scene, rays;
    double textbook_ms = 0;   ///< by the fastest textbook version: all macros of geometry, ray by ray
    double fast_math_ms = 0;  ///< the same under fast math
    double robust_ms = 0;     ///< the same traversal with the remedies
    double shipped_ms = 0;    ///< with packets and sorting, where the device has them
    double ratio = 0;         ///< median of the rounds' ratios of robust to textbook
    double least_ratio = 0;   ///< of the quickest rounds, which a busy machine disturbs less
};
[[nodiscard]] std::vector<ComparedTimes> compare_times(const Device& device, const std::string& scene, unsigned width,
                                                       unsigned height, int rounds);

/// What shading and the film cost, by turns, in milliseconds of the kernel at hand.
struct ComparedKernel {
    std::string remedy, kernel;
    double textbook_ms = 0, shipped_ms = 0;
    double least_ratio = 0;
};
[[nodiscard]] std::vector<ComparedKernel> compare_kernels(const Device& device, int rounds);

}  // namespace claray::bench
