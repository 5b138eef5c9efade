// What Primitives consist of.
#pragma once

#include <memory>

#include "claray/primitives/primitives.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/trace/query_kernel.hpp"
#include "host/trace/query_launch.hpp"
#include "host/trace/ray_order.hpp"

namespace claray {

struct Primitives::State {
    State(const Device& on, PrimitiveKind of, const Buffer<float>& with, std::uint32_t number)
        : device(on), kind(std::move(of)), data(with), count(number), launch(on) {
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
            .run({count, 64}, arg("data", data), count, arg("positions", corners.positions),
                 arg("indices", corners.indices));
    }

    /// The order in which rays are traced, or no buffer.
    [[nodiscard]] const Buffer<std::uint32_t>& order_of(const Buffer<Ray>& rays, const QueryOptions& options) {
        static const Buffer<std::uint32_t> none;
        const auto number = std::uint32_t(rays.size());
        const unsigned fewest = device.tuning("trace/closest_hit", "SORT_FROM");
        if (options.coherence != Coherence::incoherent || fewest == 0 || number < fewest) return none;
        if (!ray_order) ray_order = std::make_unique<RayOrder>(device);
        return ray_order->has_none(bvh, rays, number) ? ray_order->sort(bvh, rays, number) : none;
    }

    template <class Result>
    void trace(const std::string& function, const Buffer<Ray>& rays, const Buffer<Result>& results,
               const QueryOptions& options) {
        check_sizes(rays.size(), results.size(), {});
        if (rays.size() == 0) return;
        Defines defines = launch.with(bvh.defines());
        if (options.brute_force) defines.emplace_back("BRUTE_FORCE", "1");
        const Buffer<std::uint32_t>& order = order_of(rays, options);
        compile(function, defines)
            .run(launch.range(rays.size()), bvh, arg("data", data), count, rays, std::uint32_t(rays.size()),
                 arg("order", order), results);
    }

    Device device;
    PrimitiveKind kind;
    Buffer<float> data;
    std::uint32_t count;
    QueryLaunch launch;
    TriangleBuffers corners;
    Bvh bvh;
    std::unique_ptr<RayOrder> ray_order;
};

}  // namespace claray
