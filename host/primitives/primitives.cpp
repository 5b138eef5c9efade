#include "claray/primitives/primitives.hpp"

#include <optional>

#include "host/bvh/bvh_state.hpp"
#include "host/trace/query_kernel.hpp"
#include "host/trace/ray_order.hpp"
#include "host/trace/schedule.hpp"

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

struct Primitives::State {
    State(const Device& on, PrimitiveKind of, const Buffer<float>& with, std::uint32_t number)
        : device(on), kind(std::move(of)), data(with), count(number), schedule(on) {
        corners.positions = Buffer<float>(device, std::size_t(9) * count);
        corners.indices = Buffer<std::uint32_t>(device, std::size_t(3) * count);
        bound();
    }

    /// A kernel of kernels/primitives/primitives.cl for this kind.
    [[nodiscard]] Kernel compile(const std::string& function, Defines defines) const {
        if (kind.capsules) defines.emplace_back("PRIMITIVE_CAPSULES", "1");
        const std::string text = "#include \"primitives/primitive.clh\"\n#line 1 \"" + kind.name + "\"\n" +
                                 kind.source +
                                 "\n#define CLARAY_PRIMITIVE_KIND 1\n#include \"primitives/primitives.cl\"\n";
        return compile_kernel(device, text, function, defines, Math::strict, kind.name + ".cl");
    }

    void bound() {
        if (count == 0) return;
        compile("bound_primitives", {})
            .run({count, 0}, arg("data", data), count, arg("positions", corners.positions),
                 arg("indices", corners.indices));
    }

    /// The order in which rays are traced, or no buffer.
    [[nodiscard]] const Buffer<std::uint32_t>& order_of(const Buffer<Ray>& rays, const QueryOptions& options) {
        static const Buffer<std::uint32_t> none;
        const auto number = std::uint32_t(rays.size());
        const unsigned fewest = device.tuning("trace/closest_hit", "SORT_FROM");
        if (options.coherence != Coherence::incoherent || fewest == 0 || number < fewest) return none;
        if (!sample) sample = load_order_sample(device);
        if (!in_any_order(*sample, device, bvh, rays, number)) return none;
        if (!ray_order || ray_order->capacity() < number) ray_order = std::make_unique<RayOrder>(device, number);
        return ray_order->sort(bvh, rays, number);
    }

    template <class Result>
    void trace(const std::string& function, const Buffer<Ray>& rays, const Buffer<Result>& results,
               const QueryOptions& options) {
        check_sizes(rays.size(), results.size(), {});
        if (rays.size() == 0) return;
        Defines defines = schedule.with(bvh.defines());
        if (options.brute_force) defines.emplace_back("BRUTE_FORCE", "1");
        const Buffer<std::uint32_t>& order = order_of(rays, options);
        compile(function, defines)
            .run(schedule.range(rays.size()), bvh, arg("data", data), count, rays, std::uint32_t(rays.size()),
                 arg("order", order), results);
    }

    Device device;
    PrimitiveKind kind;
    Buffer<float> data;
    std::uint32_t count;
    Schedule schedule;
    TriangleBuffers corners;
    Bvh bvh;
    std::unique_ptr<RayOrder> ray_order;
    std::optional<Kernel> sample;  // of the order of rays
};

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
    primitives.state().trace("closest_primitive", rays, hits, options);
}
void any_hit(const Primitives& primitives, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded,
             const QueryOptions& options) {
    primitives.state().trace("any_primitive", rays, occluded, options);
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
