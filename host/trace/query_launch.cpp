#include "host/trace/query_launch.hpp"

#include <algorithm>

namespace claray {

QueryLaunch::QueryLaunch(const Device& device)
    : per_item(std::max(1u, device.tuning("trace/closest_hit", "RAYS_PER_ITEM"))),
      group(device.tuning("trace/closest_hit", "GROUP_SIZE")) {}

Defines QueryLaunch::with(Defines defines) const {
    defines.emplace_back("GROUP_SIZE", std::to_string(group));
    defines.emplace_back("RAYS_PER_ITEM", std::to_string(per_item));
    return defines;
}

}  // namespace claray
