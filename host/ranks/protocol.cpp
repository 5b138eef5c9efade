#include "host/ranks/protocol.hpp"

namespace claray::ranks {
namespace {

/// Calls `visit(member, ...)` with the members that other ranks need. Does not compile after a member is added until it
/// is named here.
template <class Config, class Visit>
void visit_config(Config& config, const Visit& visit) {
    auto& [width, height, spp, max_depth, sample_clamp, seed, seconds, noise, error, adaptive, guide, report_seconds,
           sampler, bvh, parts, effects, approximate, light_grid, ambient, compiler, checkpoint, checkpoint_seconds,
           resume] = config;
    (void)compiler, (void)checkpoint, (void)checkpoint_seconds, (void)resume;
    visit(width, height, spp, max_depth, sample_clamp, seed, seconds, noise, error, adaptive, guide, report_seconds,
          sampler, bvh, parts, effects, approximate, light_grid, ambient);
}

template <class... T>
std::string bytes_of(const T&... values) {
    ByteWriter writer;
    writer.add(values...);
    return writer.take();
}

}  // namespace

std::string to_bytes(const Hello& hello) { return bytes_of(hello.version, hello.options, hello.host, hello.devices); }

Hello hello_from(const std::string& bytes) {
    Hello hello;
    ByteReader(bytes).get(hello.version, hello.options, hello.host, hello.devices);
    return hello;
}

std::string to_bytes(const Failure& failure) { return bytes_of(failure.exit_code, failure.text); }

Failure failure_of(ErrorKind kind, const std::string& text) { return {int(kind), text.substr(0, text.find('\n'))}; }

Failure failure_from(const std::string& bytes) {
    Failure failure;
    if (!bytes.empty()) ByteReader(bytes).get(failure.exit_code, failure.text);
    return failure;
}

std::string to_bytes(std::uint32_t number, const RenderConfig& config, const Scene& scene) {
    ByteWriter writer;
    writer.add(number);
    visit_config(config, [&](const auto&... members) { writer.add(members...); });
    writer.add(scene);
    return writer.take();
}

Picture picture_from(const std::string& bytes) {
    Picture picture;
    ByteReader reader(bytes);
    reader.get(picture.number);
    visit_config(picture.config, [&](auto&... members) { reader.get(members...); });
    reader.get(picture.scene);
    return picture;
}

std::string to_bytes(const RenderedFrame& f) {
    return bytes_of(f.frame, f.names, f.files, f.pixels, f.failure.exit_code, f.failure.text);
}

RenderedFrame rendered_from(const std::string& bytes) {
    RenderedFrame f;
    ByteReader(bytes).get(f.frame, f.names, f.files, f.pixels, f.failure.exit_code, f.failure.text);
    return f;
}

std::string to_bytes(const RemoteOrder& order) {
    return bytes_of(order.picture, order.device, order.order, order.sums.pixels, order.sums.odd);
}

RemoteOrder order_from(const std::string& bytes) {
    RemoteOrder order;
    ByteReader(bytes).get(order.picture, order.device, order.order, order.sums.pixels, order.sums.odd);
    return order;
}

std::string to_bytes(const RemoteReport& remote) {
    const Report& r = remote.report;
    return bytes_of(remote.picture, r.worker, r.kind, r.first_paths, r.most_paths, r.seconds, r.sums.pixels, r.sums.odd,
                    r.error, r.what);
}

RemoteReport report_from(const std::string& bytes) {
    RemoteReport remote;
    Report& r = remote.report;
    ByteReader(bytes).get(remote.picture, r.worker, r.kind, r.first_paths, r.most_paths, r.seconds, r.sums.pixels,
                          r.sums.odd, r.error, r.what);
    return remote;
}

}  // namespace claray::ranks
