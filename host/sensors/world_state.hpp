// The state shared by copies of a SensorWorld. Internal to host/sensors.
#pragma once

#include <optional>

#include "claray/instances.hpp"
#include "claray/sensors.hpp"
#include "host/trace/query_kernel.hpp"

namespace claray {

struct SensorWorld::State {
    Device device;
    std::optional<Bvh> fixed = {};
    std::optional<InstancedBvh> movers = {};
    std::optional<QueryKernel> query = {};  // of the fixed triangles
    Buffer<SensorTriangle> triangles = {};  // fixed ones in the world, then those of the meshes that move
    Buffer<SensorPlace> places = {};        // of fixed meshes, then of all instances in `movers`
    std::uint32_t fixed_places = 0;
    Buffer<float> reflectances = {};          // of all materials
    std::vector<std::uint32_t> movable = {};  // numbers in the scene
    std::vector<Instance> placed = {};        // in `movers`: first those that are movable
    std::size_t triangle_count = 0;
};

}  // namespace claray
