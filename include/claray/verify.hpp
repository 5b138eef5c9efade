// Whether a device and its driver can be trusted: cases that break ray tracers, each with a bar that it must meet.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "claray/device.hpp"

namespace claray {

enum class Effort {
    quick,  ///< seconds in all
    full    ///< with the counts that the bars are meant for: minutes
};

/// A case that is known to break ray tracers.
struct VerifyCase {
    std::string name;    ///< "edges"
    std::string family;  ///< "triangles", "boxes", "tree", "rays", "materials", "images", "device"
    std::string what;    ///< what is tried, and what must hold
};

/// One figure and its bar; it holds where worst <= bar.
struct VerifyCheck {
    std::string what;
    std::uint64_t tried = 0;  ///< how often
    double worst = 0, bar = 0;
    std::string unit;
    bool time = false;  ///< a ratio of times, which a busy machine disturbs
    [[nodiscard]] bool holds() const { return worst <= bar; }
};

/// A drawing of what went wrong: shapes in a plane of width 1, y upwards.
struct VerifyPicture {
    struct Shape {
        std::vector<float> points;  ///< x, y pairs; one pair is a dot
        bool filled = false;
        std::uint32_t color = 0x000000;  ///< 0xrrggbb
    };
    std::string title;
    std::vector<Shape> shapes;
};

struct VerifyResult {
    std::string name;
    std::vector<VerifyCheck> checks;
    std::vector<std::pair<std::string, std::string>> facts;  ///< without a bar: hashes, costs of trees
    std::vector<std::string> failures;                       ///< the first wrong ray or value of each kind
    std::vector<VerifyPicture> pictures;                     ///< of failures
    double seconds = 0;
    std::uint64_t seed = 0;
    std::string command;  ///< runs this case again in the same way
    [[nodiscard]] bool holds() const;
};

struct VerifyOptions {
    Effort effort = Effort::quick;
    std::uint64_t seed = 1;  ///< of all random rays and meshes
    bool times = true;       ///< also checks ratios of times
    unsigned threads = 0;    ///< cases at once; 0: on a GPU as many as there are processors, but 5 at most, else 1
};

[[nodiscard]] const std::vector<VerifyCase>& verify_cases();

/// Cases of claray's catalogue that wait for a feature, with the feature's name.
[[nodiscard]] const std::vector<VerifyCase>& verify_cases_left_out();

/// Throws ErrorKind::usage where one of the names is no case's, with those that there are.
void check_verify_cases(std::span<const std::string> names);

/// Runs one case. Throws ErrorKind::usage, naming those that exist, where there is no such case, and ErrorKind::device
/// where the device refuses to work at all.
[[nodiscard]] VerifyResult run_verify_case(const Device& device, const std::string& name,
                                           const VerifyOptions& options = {});

/// Runs cases and hands over the result of each, in the order of `names`, as soon as it is there and those before are.
/// Most take longer to compile than to run, so several run at once, each thread with a queue of its own; those that
/// measure times run alone, after the others. Throws as run_verify_case does.
void run_verify_cases(const Device& device, std::span<const std::string> names, const VerifyOptions& options,
                      const std::function<void(const VerifyResult&)>& report);

}  // namespace claray
