// Tests of a device and its driver: cases that break ray tracers, each with limits for its results.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "claray/device.hpp"

#pragma GCC visibility push(default)
namespace claray {

enum class Effort {
    quick,  ///< seconds in total
    full    ///< with the full number of trials: minutes on a GPU, hours on a few CPU cores
};

/// A case that is known to break ray tracers.
struct VerifyCase {
    std::string name;    ///< "edges"
    std::string family;  ///< "triangles", "boxes", "tree", "rays", "materials", "images", "device", "driver"
    std::string what;    ///< what is tried, and what must hold
};

/// One measured value and its limit, which is met if worst <= bar.
struct VerifyCheck {
    std::string what;
    std::uint64_t tried = 0;  ///< number of trials
    double worst = 0, bar = 0;
    std::string unit;
    bool time = false;   ///< true for a ratio of times, which is unreliable on a busy machine
    bool known = false;  ///< whether this is known of the driver, and claray's kernels avoid it
    [[nodiscard]] bool is_met() const { return worst <= bar; }
    [[nodiscard]] bool holds() const { return known || is_met(); }
};

/// A drawing of a failure: shapes in a plane of width 1, y upwards.
struct VerifyPicture {
    struct Shape {
        std::vector<float> points;  ///< x, y pairs; a single pair is a dot
        bool filled = false;
        std::uint32_t color = 0x000000;  ///< 0xrrggbb
    };
    std::string title;
    std::vector<Shape> shapes;
};

struct VerifyResult {
    std::string name;
    std::vector<VerifyCheck> checks;
    std::vector<std::pair<std::string, std::string>> facts;  ///< values without a limit: hashes, costs of trees
    std::vector<std::string> failures;                       ///< the first wrong ray or value of each kind
    std::vector<VerifyPicture> pictures;                     ///< drawings of failures
    double seconds = 0;
    std::uint64_t seed = 0;
    std::string command;                 ///< command line that repeats this case in the same way
    std::set<std::string> kernels = {};  ///< names of the kernels that ran, if VerifyOptions::kernels
    [[nodiscard]] bool holds() const;
};

struct VerifyOptions {
    Effort effort = Effort::quick;
    std::uint64_t seed = 1;  ///< seed of all random rays and meshes
    bool times = true;       ///< also check ratios of times
    bool kernels = false;    ///< also tell which kernels run; keeps a record of each command
    unsigned threads =
        0;  ///< cases that run at once; 0: on NVIDIA's GPUs the number of processors, but at most 5, else 1
};

/// Returns all cases.
[[nodiscard]] const std::vector<VerifyCase>& verify_cases();

/// Returns the names of all kernels of claray, in alphabetical order.
[[nodiscard]] std::set<std::string> kernel_names();

/// Throws ErrorKind::usage, listing the existing cases, if one of the names is unknown.
void check_verify_cases(std::span<const std::string> names);

/// Runs one case. It fails, with the message, if it ends with an error, as on a device without what it needs. Throws
/// ErrorKind::usage, listing the existing cases, if there is no such case.
[[nodiscard]] VerifyResult run_verify_case(const Device& device, const std::string& name,
                                           const VerifyOptions& options = {});

/// Runs cases and passes each result to `report`, in the order of `names`, as soon as it and those before it are
/// available. `report` is called from any thread, by one at a time. Most cases take longer to compile than to run, so
/// several run at once, each thread with its own queue. Cases that measure times run alone, after the others. Throws as
/// run_verify_case does, and what `report` throws.
void run_verify_cases(const Device& device, std::span<const std::string> names, const VerifyOptions& options,
                      const std::function<void(const VerifyResult&)>& report);

}  // namespace claray
#pragma GCC visibility pop
