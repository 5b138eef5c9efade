#include "claray/primitives/primitives.hpp"

#include "host/primitives/primitives_state.hpp"

namespace claray {
namespace {

PrimitiveKind own_kind(const std::string& name, unsigned floats) {
    return {name, "#include \"primitives/" + name + ".clh\"\n", floats};
}

void check_data(const PrimitiveKind& kind, std::size_t floats, std::size_t count) {
    if (floats / std::max(1u, kind.floats) < count)
        throw Error(ErrorKind::usage, std::to_string(count) + " primitives of the kind '" + kind.name + "' need " +
                                          std::to_string(std::size_t(kind.floats) * count) + " floats, not " +
                                          std::to_string(floats));
}

}  // namespace

PrimitiveKind sphere_kind() { return own_kind("spheres", 4); }
PrimitiveKind disc_kind() { return own_kind("discs", 8); }
PrimitiveKind cylinder_kind() { return own_kind("cylinders", 8); }

Primitives Primitives::build(const Device& device, const PrimitiveKind& kind, const Buffer<float>& data,
                             std::uint32_t count, const Bvh::Config& config) {
    check_data(kind, data.size(), count);
    Primitives primitives;
    primitives.state_ = std::make_shared<State>(device, kind, data, count);
    Bvh::Config whole = config;
    whole.split_budget = 0;
    primitives.state_->bvh = build_over_primitives(device, primitives.state_->corners, whole, kind.capsules);
    return primitives;
}

Primitives Primitives::build(const Device& device, const PrimitiveKind& kind, const Buffer<float>& data,
                             std::uint32_t count) {
    return build(device, kind, data, count, {.builder = Builder::balanced});
}

Primitives Primitives::build(const Device& device, const PrimitiveKind& kind, std::span<const float> data) {
    if (kind.floats == 0 || data.size() % kind.floats != 0)
        throw Error(ErrorKind::usage, std::to_string(data.size()) +
                                          " floats are no whole number of primitives of the kind '" + kind.name + "'");
    return build(device, kind, Buffer<float>(device, data), std::uint32_t(data.size() / kind.floats));
}

void Primitives::rebuild() {
    state_->bound();
    state_->bvh.rebuild();
}
void Primitives::refit() {
    state_->bound();
    state_->bvh.refit();
}

std::uint32_t Primitives::count() const { return state_->count; }
const Buffer<float>& Primitives::data() const { return state_->data; }
const Device& Primitives::device() const { return state_->device; }
const Bvh& Primitives::bvh() const { return state_->bvh; }

void closest_hit(const Primitives& primitives, const Buffer<Ray>& rays, Buffer<Hit>& hits,
                 const QueryOptions& options) {
    state_of(primitives).trace("closest_primitive", rays, hits, options);
}
void any_hit(const Primitives& primitives, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded,
             const QueryOptions& options) {
    state_of(primitives).trace("any_primitive", rays, occluded, options);
}

std::vector<Hit> closest_hit(const Primitives& primitives, std::span<const Ray> rays, const QueryOptions& options) {
    Buffer<Hit> hits(primitives.device(), rays.size());
    closest_hit(primitives, Buffer<Ray>(primitives.device(), rays), hits, options);
    return hits.read();
}
std::vector<std::uint8_t> any_hit(const Primitives& primitives, std::span<const Ray> rays,
                                  const QueryOptions& options) {
    Buffer<std::uint8_t> occluded(primitives.device(), rays.size());
    any_hit(primitives, Buffer<Ray>(primitives.device(), rays), occluded, options);
    return occluded.read();
}

}  // namespace claray
