// The profiler: OpenCL events of all kernels and transfers of a device.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "claray/opencl.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// Times of one command, in nanoseconds of the device's clock.
struct ProfileRecord {
    std::string name;
    std::uint64_t queued = 0, start = 0, end = 0;
    [[nodiscard]] double milliseconds() const { return double(end - start) * 1e-6; }
};

/// Totals of all commands with the same name.
struct ProfileSummary {
    std::uint64_t count = 0;
    double milliseconds = 0;
    double longest = 0;                ///< milliseconds of the longest command
    std::uint64_t start = 0, end = 0;  ///< of the first and of the last command, in nanoseconds of the device's clock
};

/// Collects event times. Not thread-safe: one profiler belongs to one queue.
class Profiler {
public:
    /// Calls enqueue(cl::Event*). The function must set the event of its command; the times are read after the command
    /// has finished. Passes null if the profiler is disabled.
    template <class Enqueue>
    void record(std::string name, const Enqueue& enqueue) {
        if (!enabled_) return enqueue(nullptr);
        cl::Event event;
        enqueue(&event);
        add(std::move(name), event);
    }
    /// Reads the times of all pending events. Blocks until they are finished.
    void collect();

    /// Returns the totals by name since the last reset. Blocks as collect().
    [[nodiscard]] const std::map<std::string, ProfileSummary>& summary();
    /// Returns the device time of all commands with this name since the last reset, in milliseconds; 0 if there were
    /// none.
    [[nodiscard]] double milliseconds(const std::string& name);
    /// Returns the device time of all commands since the last reset, in milliseconds.
    [[nodiscard]] double total_milliseconds();
    /// Clears the totals, but keeps the records.
    void reset();

    /// Also keeps the record of every command, for a trace. Off by default, since a long render has millions of
    /// commands.
    void keep_records(bool keep) { keep_records_ = keep; }
    [[nodiscard]] const std::vector<ProfileRecord>& records();

    /// On by default. Each event takes some microseconds of a GPU's queue. Without them, renders of milliseconds take
    /// up to a quarter less time (docs/performance.md), but RenderStatistics contain no device times.
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
#pragma GCC visibility pop
