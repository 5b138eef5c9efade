// The price of stability: what each remedy's textbook version gets wrong, and what it would save.
#pragma once

#include "claray/verify.hpp"
#include "host/measure/measure.hpp"

namespace claray::measure {

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

/// A traversal in the textbook's version and with the remedies, by turns: medians of rounds.
struct ComparedPair {
    double textbook_ms = 0, robust_ms = 0;
    double ratio = 0;        ///< median of the rounds' ratios of robust to textbook
    double least_ratio = 0;  ///< of the quickest rounds, which a busy machine disturbs less
    double processor = 0;    ///< median of the ratios of processor time, on CPUs, which others disturb least; else 0
};

/// What tracing costs.
struct ComparedTimes {
    std::string scene, rays;
    ComparedPair shipped;     ///< as this device traces: with packets, streams and sorting, where it has them
    ComparedPair one_by_one;  ///< ray by ray
    double fast_math_ms = 0;  ///< the textbook's ray by ray, under fast math
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

}  // namespace claray::measure
