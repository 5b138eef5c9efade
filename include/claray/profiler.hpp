// One profiler for everything that measures: OpenCL events of every kernel and transfer of a device.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "claray/opencl.hpp"

namespace claray {

/// One command as the device's clock saw it, in nanoseconds.
struct ProfileRecord {
    std::string name;
    std::uint64_t queued = 0, start = 0, end = 0;
    [[nodiscard]] double milliseconds() const { return double(end - start) * 1e-6; }
};

/// All commands of one name.
struct ProfileSummary {
    std::uint64_t count = 0;
    double milliseconds = 0;
    double longest = 0;                ///< milliseconds of the longest one
    std::uint64_t start = 0, end = 0;  ///< of the first and of the last command, in nanoseconds of the device's clock
};

/// Collects event times. Not thread safe: one profiler belongs to one queue.
class Profiler {
public:
    /// Calls enqueue(cl::Event*) with what is to become the command's event, whose times are read once it has finished;
    /// with null where nothing is measured.
    template <class Enqueue>
    void record(std::string name, const Enqueue& enqueue) {
        if (!enabled_) return enqueue(nullptr);
        cl::Event event;
        enqueue(&event);
        add(std::move(name), event);
    }
    /// Reads the times of all remembered events, waiting for those under way.
    void collect();

    /// Totals by name since the last reset.
    [[nodiscard]] const std::map<std::string, ProfileSummary>& summary();
    /// Device milliseconds of one name since the last reset, 0 if it never ran.
    [[nodiscard]] double milliseconds(const std::string& name);
    /// Device milliseconds of all commands since the last reset.
    [[nodiscard]] double total_milliseconds();
    /// Forgets the totals, not the records.
    void reset();

    /// Keeps every single record too, for a trace; off at first, for a long render makes millions.
    void keep_records(bool keep) { keep_records_ = keep; }
    [[nodiscard]] const std::vector<ProfileRecord>& records();

    /// On at first. Events cost a GPU's queue some microseconds each: without them renders of milliseconds take it up
    /// to a quarter less (docs/performance.md), and RenderStatistics have no times of the device.
    void enable(bool enabled) { enabled_ = enabled; }

private:
    void add(std::string name, const cl::Event& event);

    struct Pending {
        std::string name;
        cl::Event event;
    };
    std::vector<Pending> pending_;
    std::map<std::string, ProfileSummary> summary_;
    std::vector<ProfileRecord> records_;
    bool keep_records_ = false;
    bool enabled_ = true;
};

}  // namespace claray
