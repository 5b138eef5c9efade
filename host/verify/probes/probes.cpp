#include "host/verify/probes/probes.hpp"

#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "claray/error.hpp"
#include "host/compute/device_state.hpp"

namespace claray::verify {
namespace {

#include "host/verify/probes/pieces/frame.c"
#include "host/verify/probes/pieces/kernel.c"
namespace kernel_only {
#include "host/verify/probes/bodies/kernel_only.c"
}
namespace atomics {
#include "host/verify/probes/bodies/atomics.c"
}
namespace argument_values {
#include "host/verify/probes/bodies/argument_values.c"
}
namespace correct_division {
#include "host/verify/probes/bodies/correct_division.c"
}
namespace doubles {
#include "host/verify/probes/bodies/doubles.c"
}
namespace event_times {
#include "host/verify/probes/bodies/event_times.c"
}
namespace fills {
#include "host/verify/probes/bodies/fills.c"
}
namespace group_sizes {
#include "host/verify/probes/bodies/group_sizes.c"
}
namespace headers {
#include "host/verify/probes/bodies/headers.c"
}
namespace images {
#include "host/verify/probes/bodies/images.c"
}
namespace large_buffers {
#include "host/verify/probes/bodies/large_buffers.c"
}
namespace local_memory {
#include "host/verify/probes/bodies/local_memory.c"
}
namespace printing {
#include "host/verify/probes/bodies/printing.c"
}
namespace queues {
#include "host/verify/probes/bodies/queues.c"
}
namespace sixteen_arguments {
#include "host/verify/probes/bodies/sixteen_arguments.c"
}
namespace sub_buffers {
#include "host/verify/probes/bodies/sub_buffers.c"
}
namespace subnormals {
#include "host/verify/probes/bodies/subnormals.c"
}
namespace two_contexts {
#include "host/verify/probes/bodies/two_contexts.c"
}
namespace wide_atomics {
#include "host/verify/probes/bodies/wide_atomics.c"
}

struct Row {
    const char* name;
    void (*body)(Probe*);
    const char* what;
};

constexpr Row rows[] = {
    {"conversions", kernel_only::probe, "conversions saturate and round at the limits of their types"},
    {"subnormals", subnormals::probe, "+ - * and fma keep subnormal numbers"},
    {"integers", kernel_only::probe, "shifts, popcount, clz, mul_hi and others of 32 bits"},
    {"wide-integers", kernel_only::probe, "the same for 64 bits, and their quotients"},
    {"doubles", doubles::probe, "float64 + - * / sqrt and fma are rounded to the nearest"},
    {"correct-division", correct_division::probe, "/ and sqrt are rounded to the nearest by the option for it"},
    {"contraction", kernel_only::probe, "FP_CONTRACT OFF leaves a * b + c two roundings"},
    {"float3-calls", kernel_only::probe, "functions that are not inlined take and return vectors"},
    {"vector-loads", kernel_only::probe, "vloadn and vstoren at any address"},
    {"private-arrays", kernel_only::probe, "loops index private arrays by data"},
    {"struct-addresses", kernel_only::probe, "functions read and write structs of their caller by address"},
    {"long-loops", kernel_only::probe, "loops of more than 65,535 iterations"},
    {"sixteen-arguments", sixteen_arguments::probe, "a kernel gets sixteen arguments of all sizes"},
    {"argument-values", argument_values::probe, "commands in a queue keep the arguments that they were enqueued with"},
    {"headers", headers::probe, "clCompileProgram takes the header that it is given, not a file of this name"},
    {"atomics", atomics::probe, "counters of all groups, minima, maxima and exchanges under load"},
    {"wide-atomics", wide_atomics::probe, "atomics of 64 bits"},
    {"barriers", kernel_only::probe, "barriers in loops whose number of rounds depends on data"},
    {"barrier-counters", kernel_only::probe, "items count the rounds of a loop with barriers that local memory ends"},
    {"local-memory", local_memory::probe, "a group uses all local memory of the device"},
    {"group-sizes", group_sizes::probe, "groups of 1 item, of odd numbers and of the largest number"},
    {"async-copies", kernel_only::probe, "async_work_group_copy to local memory and back"},
    {"printing", printing::probe, "printf of numbers, text and vectors"},
    {"images", images::probe, "texels are read and written exactly"},
    {"queues", queues::probe, "commands of four queues wait for each other's events"},
    {"event-times", event_times::probe, "times of events grow"},
    {"two-contexts", two_contexts::probe, "two threads compile and run, each in its own context"},
    {"large-buffers", large_buffers::probe, "a buffer of more than 4 GB"},
    {"fills", fills::probe, "clEnqueueFillBuffer by patterns of 1 to 128 bytes"},
    {"sub-buffers", sub_buffers::probe, "parts of a buffer as arguments"},
};

/// A fault of a driver that claray's own kernels do not meet: their cases hold.
struct KnownFault {
    const char *probe, *platform, *driver;  ///< beginnings of the names
    const char* avoided;
};
constexpr KnownFault known_faults[] = {
    {"float3-calls", "Intel", "2026.22", "claray's kernels have the hint vec_type_hint(float4)"},
    {"printing", "NVIDIA", "580", "no kernel of claray prints"},
    {"barrier-counters", "Portable Computing Language", "", "no kernel of claray counts rounds of such a loop"},
};

const KnownFault* known_fault(const std::string& probe, const DeviceInfo& device) {
    const auto* fault = std::find_if(std::begin(known_faults), std::end(known_faults), [&](const KnownFault& f) {
        return probe == f.probe && device.platform.starts_with(f.platform) && device.driver.starts_with(f.driver);
    });
    return fault == std::end(known_faults) ? nullptr : fault;
}

template <std::size_t index>
void run_row(Run& run) {
    const Row& row = rows[index];
    const auto probe = std::make_unique<Probe>();
    try_probe(probe.get(), state_of(run.device()).device(), probe_texts(row.name).kernel.c_str(), row.body);
    const KnownFault* known = known_fault(row.name, run.device().info());
    run.check("results", probe->tried, double(probe->wrong), 0, "wrong", known != nullptr);
    if (probe->lacks != nullptr) run.fact("the device lacks", probe->lacks);
    if (probe->wrong == 0) return;
    if (known != nullptr)
        run.fact("known fault of this driver", std::string(probe->what) + "; " + known->avoided);
    else
        run.failure(probe->what);
}

const Row* find(const std::string& name) {
    const auto row = std::find_if(std::begin(rows), std::end(rows), [&](const Row& r) { return r.name == name; });
    return row == std::end(rows) ? nullptr : row;
}

/// The text of a file of this name in any of the folders; null without one.
const std::string* text_of(const std::string& name) {
    for (const KernelSource& source : embedded_probe_texts())
        if (std::filesystem::path(source.path).filename() == name) return &source.text;
    return nullptr;
}

}  // namespace

bool is_probe(const std::string& name) { return find(name) != nullptr; }

std::vector<std::string> probe_names() {
    std::vector<std::string> names;
    for (const Row& row : rows) names.push_back(row.name);
    return names;
}

ProbeTexts probe_texts(const std::string& name) {
    const Row* row = find(name);
    if (row == nullptr)
        throw Error(ErrorKind::usage, "'" + name + "' is no probe", "choose one of --list's family driver");
    std::string file = name;
    std::replace(file.begin(), file.end(), '-', '_');
    const std::string* body = text_of(file + ".c");
    const std::string run = "cc " + name + ".c -lOpenCL -o " + name + " && ./" + name + " [NUMBER OF DEVICE]";
    return {*text_of(file + ".cl"), "#define PROBE \"" + name + "\"  // " + row->what + ": " + run + '\n' +
                                        *text_of("frame.c") + *text_of("kernel.c") +
                                        (body != nullptr ? *body : *text_of("kernel_only.c")) + *text_of("main.c")};
}

Cases probe_cases() {
    return []<std::size_t... index>(std::index_sequence<index...>) {
        return Cases{{{rows[index].name, "driver", rows[index].what}, run_row<index>}...};
    }
    (std::make_index_sequence<std::size(rows)>());
}

}  // namespace claray::verify
