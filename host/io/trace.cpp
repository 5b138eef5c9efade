// Profiler records in the Trace Event Format of Perfetto and chrome://tracing.
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "claray/io.hpp"

namespace claray {
namespace {

using nlohmann::json;

// Names may hold any bytes; JSON must be UTF-8.
std::string dump(const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); }

json metadata(const char* kind, const std::string& name) {
    return {{"ph", "M"}, {"pid", 1}, {"tid", 1}, {"name", kind}, {"args", {{"name", name}}}};
}

}  // namespace

void write_trace(const std::filesystem::path& path, const std::vector<ProfileRecord>& records,
                 const std::string& device_name) {
    // The device's clock starts anywhere: time 0 is when the first command was queued.
    std::uint64_t origin = std::numeric_limits<std::uint64_t>::max();
    for (const ProfileRecord& record : records) origin = std::min({origin, record.queued, record.start});
    const auto microseconds = [&](std::uint64_t time) { return double(time - origin) * 1e-3; };

    std::string text = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n" + dump(metadata("process_name", device_name)) +
                       ",\n" + dump(metadata("thread_name", "queue"));
    for (const ProfileRecord& record : records) {
        text += ",\n" + dump({{"ph", "X"},
                              {"pid", 1},
                              {"tid", 1},
                              {"cat", "opencl"},
                              {"name", record.name},
                              {"ts", microseconds(record.start)},
                              {"dur", double(record.end - record.start) * 1e-3},
                              {"args", {{"queued_us", microseconds(record.queued)}}}});
    }
    write_file(path, text + "\n]}\n");
}

}  // namespace claray
