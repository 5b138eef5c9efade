#include "host/ranks/protocol.hpp"

#include <cmath>

namespace claray::ranks {
namespace {

/// Calls `visit(member, ...)` with the members that other ranks need. Does not compile after a member is added until it
/// is named here.
template <class Config, class Visit>
void visit_config(Config& config, const Visit& visit) {
    auto& [width, height, spp, max_depth, sample_clamp, seed, seconds, noise, error, adaptive, guide, report_seconds,
           sampler, bvh, parts, effects, approximate, light_grid, compiler, checkpoint, checkpoint_seconds, resume,
           region, alpha, lobes, light_groups] = config;
    (void)compiler, (void)checkpoint, (void)checkpoint_seconds, (void)resume;
    visit(region.x, region.y, region.width, region.height);
    visit(width, height, spp, max_depth, sample_clamp, seed, seconds, noise, error, adaptive, guide, report_seconds,
          sampler, bvh, parts, effects, approximate, light_grid, alpha, lobes, light_groups);
}

template <class... T>
std::string bytes_of(const T&... values) {
    ByteWriter writer;
    writer.add(values...);
    return writer.take();
}

/// All of them.
template <class... T>
void read(const std::string& bytes, T&... values) {
    ByteReader reader(bytes);
    reader.get(values...);
    reader.finish();
}

bool is_duration(double seconds) { return std::isfinite(seconds) && seconds >= 0; }

void check_failure(const Failure& failure) {
    if (failure.exit_code < int(ErrorKind::user) || failure.exit_code > int(ErrorKind::device))
        refuse_message("has an exit code of " + std::to_string(failure.exit_code));
}

}  // namespace

std::string to_bytes(const Hello& hello) { return bytes_of(hello.version, hello.options, hello.host, hello.devices); }

Hello hello_from(const std::string& bytes) {
    Hello hello;
    read(bytes, hello.version, hello.options, hello.host, hello.devices);
    if (hello.devices.empty()) refuse_message("names no device");
    return hello;
}

std::string to_bytes(const Failure& failure) { return bytes_of(failure.exit_code, failure.text); }

Failure failure_of(ErrorKind kind, const std::string& text) { return {int(kind), text.substr(0, text.find('\n'))}; }

Failure failure_from(const std::string& bytes) {
    Failure failure;
    if (bytes.empty()) return failure;
    read(bytes, failure.exit_code, failure.text);
    check_failure(failure);
    return failure;
}

std::string to_bytes(std::uint32_t number, const RenderConfig& config, const Scene& scene) {
    ByteWriter writer;
    writer.add(number);
    visit_config(config, [&](const auto&... members) { writer.add(members...); });
    writer.add(scene);
    return writer.take();
}

RenderTask task_from(const std::string& bytes) {
    RenderTask task;
    ByteReader reader(bytes);
    reader.get(task.number);
    visit_config(task.config, [&](auto&... members) { reader.get(members...); });
    reader.get(task.scene);
    reader.finish();
    return task;
}

std::string to_bytes(const RenderedFrame& f) {
    return bytes_of(f.frame, f.names, f.files, f.pixels, f.failure.exit_code, f.failure.text);
}

RenderedFrame rendered_from(const std::string& bytes) {
    RenderedFrame f;
    read(bytes, f.frame, f.names, f.files, f.pixels, f.failure.exit_code, f.failure.text);
    if (f.names.size() != f.files.size()) refuse_message("has other names than files");
    for (const std::string& name : f.names)
        if (name.empty() || name[0] == '.' || name.find_first_of("/\\") != std::string::npos)
            refuse_message("names a file of another folder");
    check_failure(f.failure);
    return f;
}

std::string to_bytes(const RemoteOrder& order) { return bytes_of(order.task, order.device, order.order, order.sums); }

RemoteOrder order_from(const std::string& bytes) {
    RemoteOrder order;
    read(bytes, order.task, order.device, order.order, order.sums);
    if (order.order.kind > Order::Kind::give) refuse_message("has an order of no kind");
    return order;
}

std::string to_bytes(const RemoteReport& remote) {
    const Report& r = remote.report;
    return bytes_of(remote.task, r.worker, r.kind, r.first_paths, r.most_paths, r.seconds, r.sums, r.error, r.what);
}

RemoteReport report_from(const std::string& bytes) {
    RemoteReport remote;
    Report& r = remote.report;
    read(bytes, remote.task, r.worker, r.kind, r.first_paths, r.most_paths, r.seconds, r.sums, r.error, r.what);
    if (r.kind > Report::Kind::failed) refuse_message("has a report of no kind");
    if (!is_duration(r.seconds)) refuse_message("has a time of " + std::to_string(r.seconds) + " s");
    check_failure({int(r.error), r.what});
    return remote;
}

}  // namespace claray::ranks
