// All measurements of claray: rounds in which all variants alternate, medians of OpenCL event times.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "claray/device.hpp"

namespace claray::measure {

/// The median; 0 if there are no values.
[[nodiscard]] double median(std::vector<double> values);
/// Half the distance between the quartiles, relative to the median.
[[nodiscard]] double relative_spread(const std::vector<double>& values);

/// Times of one task, in milliseconds of the device's clock.
struct Timing {
    std::map<std::string, double> commands;  ///< median by name of kernel or transfer
    std::map<std::string, double> least;     ///< the same, of its quickest round
    std::vector<double> rounds;              ///< all commands of a round together, one value a round
    std::vector<double> processor;           ///< what all threads of this process took, on CPUs the device's, too
    std::vector<double> spans;               ///< from the start of a round's first command to the end of its last

    [[nodiscard]] double milliseconds() const { return median(rounds); }
    /// Includes the pauses between commands.
    [[nodiscard]] double span() const { return median(spans); }
    [[nodiscard]] double spread() const { return relative_spread(rounds); }
};

/// Runs every task once per round, so that disturbances of the machine affect all tasks alike. The first round does not
/// count. Timings are in the order of the tasks.
[[nodiscard]] std::vector<Timing> measure_rounds(const Device& device, int rounds,
                                                 const std::vector<std::function<void()>>& tasks);

/// One task alone: median milliseconds by command name; "" is the sum of all.
[[nodiscard]] std::map<std::string, double> measure(const Device& device, int repeat,
                                                    const std::function<void()>& task);

}  // namespace claray::measure
