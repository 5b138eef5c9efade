#include "host/bvh/host_placement.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace claray {
namespace {

// Definitions that the kernel source below gets from kernels/compute/portable.clh and kernels/bvh/triangles.clh on a
// device. Host and device share the source, so that rays in objects have the same bits.
using std::fabs, std::fma, std::fmax, std::fmin;
using real = double;
constexpr float UNIT_ROUNDOFF = std::numeric_limits<float>::epsilon() / 2;
constexpr real REAL_ROUNDOFF = std::numeric_limits<real>::epsilon() / 2;
constexpr float COORDINATE_LIMIT = 1e18f;

uint float_key(float value) {
    const uint bits = std::bit_cast<uint>(value);
    return bits ^ ((bits >> 31) != 0 ? 0xffffffffu : 0x80000000u);
}
float float_from_key(uint key) { return std::bit_cast<float>(key ^ ((key >> 31) != 0 ? 0x80000000u : 0xffffffffu)); }

#define global
#include "kernels/bvh/instances/moving_instance.clh"

#include "kernels/bvh/instances/placement.clh"
#undef global

}  // namespace

HostPlacement place_by_host(std::span<const Instance> instances, std::span<const Instance> ends,
                            std::span<const BvhHeader> bottoms) {
    HostPlacement all;
    for (std::size_t i = 0; i < instances.size(); ++i) {
        PlacedInstance placed{};
        float corners[9] = {};
        const float widening = place_instance(&instances[i], ends.empty() ? nullptr : &ends[i], bottoms.data(),
                                              uint(bottoms.size()), &placed, corners);
        all.widening = std::max(all.widening, widening);
        all.placed.push_back(placed);
        if (!ends.empty()) all.moving.push_back({instances[i], ends[i]});
        for (const float* c : {corners, corners + 3, corners + 6}) all.boxes.positions.emplace_back(c[0], c[1], c[2]);
        all.boxes.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return all;
}

}  // namespace claray
