// claray.h: kernels that are compiled ahead or by the program, and the times of all commands.
#include "claray/io.hpp"
#include "claray/program.hpp"
#include "claray/program/compiling.hpp"
#include "host/capi/renderer.hpp"

using namespace claray;
using namespace claray::capi;

struct claray_profile {
    std::vector<claray_profile_row> rows;
    std::vector<std::string> names;
};

namespace {

Defines defines_of(const claray_kernel_source& source) {
    Defines defines;
    if (source.bvh) defines = source.bvh->bvh.defines();
    if (source.instances)
        for (const auto& define : source.instances->bvh.defines()) defines.push_back(define);
    for (const char* one : array(source.defines, source.define_count, "source.defines")) {
        const std::string text = &required(one, "source.defines");
        const std::size_t equals = text.find('=');
        if (equals == 0 || equals == std::string::npos)
            refuse("source.defines: '" + text + "' is no macro", "use NAME=VALUE");
        defines.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
    return defines;
}

/// A kernel of its own, since claray lends those that it keeps to others.
cl_kernel own_kernel(const Kernel& kernel) {
    cl::Kernel own(kernel.handle().getInfo<CL_KERNEL_PROGRAM>(), kernel.name().c_str());
    clRetainKernel(own());
    return own();
}

template <class Structure>
void bind_to(const Structure& structure, void* kernel, std::uint32_t& index) {
    if (kernel == nullptr) refuse("kernel is NULL");
    const cl::Kernel given(static_cast<cl_kernel>(kernel), true);
    Kernel bound(structure.device(), given, given.getInfo<CL_KERNEL_FUNCTION_NAME>());
    unsigned next = index;
    structure.bind(bound, next);
    index = next;
}

claray_profile* rows_of_records(Profiler& profiler) {
    auto profile = std::make_unique<claray_profile>();
    for (const ProfileRecord& record : profiler.records()) {
        claray_profile_row& row = profile->rows.emplace_back();
        row.count = 1, row.milliseconds = row.longest = record.milliseconds();
        row.queued = record.queued, row.start = record.start, row.end = record.end;
        profile->names.push_back(record.name);
    }
    return profile.release();
}

claray_profile* rows_of_totals(Profiler& profiler) {
    auto profile = std::make_unique<claray_profile>();
    for (const auto& [name, total] : profiler.summary()) {
        claray_profile_row& row = profile->rows.emplace_back();
        row.count = total.count, row.milliseconds = total.milliseconds, row.longest = total.longest;
        row.start = total.start, row.end = total.end;
        profile->names.push_back(name);
    }
    return profile.release();
}

}  // namespace

claray_status claray_prepare(claray_device* device, const char* effects, const claray_render_config* config) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const RenderConfig known = render_config_of(config);
        effects ? compile_kernels(on, parse_effects(effects), known) : on.prepare();
    });
}

claray_status claray_on_compiling(claray_compiling_callback callback, void* user) {
    return guarded([&] {
        if (!callback) return on_compiling({});
        on_compiling([callback, user](const CompileProgress& progress) {
            callback(progress.done, progress.total, text_of(progress).c_str(), user);
        });
    });
}

claray_status claray_compile_statistics_get(claray_compile_statistics* statistics) {
    return guarded([&] {
        thread_local std::string error;
        const CompileStatistics known = compile_statistics();
        error = known.cache_error;
        give(statistics,
             {sizeof(claray_compile_statistics), known.milliseconds, known.compiled, known.from_cache, error.c_str()},
             "statistics");
    });
}

claray_status claray_kernel_compile(claray_device* device, const claray_kernel_source* source, void** kernel) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const claray_kernel_source known = versioned(&required(source, "source"), "source");
        void*& place = required(kernel, "kernel");
        place = own_kernel(compile_kernel(
            on, &required(known.source, "source.source"), &required(known.function, "source.function"),
            defines_of(known), known.fast_math != 0 ? Math::fast : Math::strict, known.name ? known.name : "user.cl"));
    });
}

claray_status claray_bvh_bind(const claray_bvh* bvh, void* kernel, uint32_t* index) {
    return guarded([&] { bind_to(required(bvh, "bvh").bvh, kernel, required(index, "index")); });
}
claray_status claray_instances_bind(const claray_instances* placed, void* kernel, uint32_t* index) {
    return guarded([&] { bind_to(required(placed, "placed").bvh, kernel, required(index, "index")); });
}

claray_status claray_profiler_start(claray_device* device, int enabled, int keep_records) {
    return guarded([&] {
        Profiler& profiler = required(device, "device").device.profiler();
        profiler.collect();
        profiler.reset();
        profiler.enable(enabled != 0);
        profiler.keep_records(keep_records != 0);
    });
}

claray_status claray_profile_create(claray_device* device, int records, claray_profile** profile) {
    return guarded([&] {
        Profiler& profiler = required(device, "device").device.profiler();
        hand_out(profile, "profile",
                 [&] { return records != 0 ? rows_of_records(profiler) : rows_of_totals(profiler); });
    });
}
size_t claray_profile_count(const claray_profile* profile) { return profile ? profile->rows.size() : 0; }
claray_status claray_profile_get(const claray_profile* profile, size_t i, claray_profile_row* row) {
    return guarded([&] {
        claray_profile_row known = element(required(profile, "profile").rows, i, "rows", "i");
        known.name = profile->names[i].c_str();
        give(row, known, "row");
    });
}
void claray_profile_release(claray_profile* profile) { delete profile; }

claray_status claray_write_trace(claray_device* device, const char* path) {
    return guarded([&] {
        const Device& of = required(device, "device").device;
        write_trace(&required(path, "path"), of.profiler().records(), of.info().name);
    });
}
