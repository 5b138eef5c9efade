#include "claray/profiler.hpp"

#include <algorithm>

namespace claray {
namespace {
// Bounds the memory of unread events; reading finished events early costs nothing.
constexpr std::size_t pending_limit = 4096;
}  // namespace

void Profiler::add(std::string name, const cl::Event& event) {
    if (pending_.size() >= pending_limit) collect();
    pending_.push_back({std::move(name), event});
}

void Profiler::collect() {
    for (const Pending& pending : pending_) {
        pending.event.wait();
        ProfileRecord record{pending.name, pending.event.getProfilingInfo<CL_PROFILING_COMMAND_QUEUED>(),
                             pending.event.getProfilingInfo<CL_PROFILING_COMMAND_START>(),
                             pending.event.getProfilingInfo<CL_PROFILING_COMMAND_END>()};
        ProfileSummary& summary = summary_[record.name];
        summary.start = summary.count == 0 ? record.start : std::min(summary.start, record.start);
        summary.end = std::max(summary.end, record.end);
        ++summary.count;
        summary.milliseconds += record.milliseconds();
        summary.longest = std::max(summary.longest, record.milliseconds());
        if (keep_records_) records_.push_back(std::move(record));
    }
    pending_.clear();
}

const std::map<std::string, ProfileSummary>& Profiler::summary() {
    collect();
    return summary_;
}

double Profiler::milliseconds(const std::string& name) {
    collect();
    const auto found = summary_.find(name);
    return found == summary_.end() ? 0.0 : found->second.milliseconds;
}

double Profiler::total_milliseconds() {
    double total = 0;
    for (const auto& [name, summary] : summary()) total += summary.milliseconds;
    return total;
}

void Profiler::reset() {
    collect();
    summary_.clear();
}

const std::vector<ProfileRecord>& Profiler::records() {
    collect();
    return records_;
}

}  // namespace claray
