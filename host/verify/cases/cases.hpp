// The cases. Each family's file ends with the list of its cases; `verify.cpp` joins these lists.
#pragma once

#include "host/verify/run.hpp"

namespace claray::verify {

struct Case {
    VerifyCase about;
    void (*run)(Run&);
    bool measures_times = false;
};
using Cases = std::vector<Case>;

[[nodiscard]] Cases probe_cases();
[[nodiscard]] Cases device_cases();
[[nodiscard]] Cases function_cases();
[[nodiscard]] Cases edge_cases();
[[nodiscard]] Cases triangle_cases();
[[nodiscard]] Cases box_cases();
[[nodiscard]] Cases tree_cases();
[[nodiscard]] Cases refit_cases();
[[nodiscard]] Cases instance_cases();
[[nodiscard]] Cases query_cases();
[[nodiscard]] Cases primitive_cases();
[[nodiscard]] Cases sensor_cases();
[[nodiscard]] Cases material_cases();
[[nodiscard]] Cases media_cases();
[[nodiscard]] Cases image_cases();
[[nodiscard]] Cases harmonics_cases();
[[nodiscard]] Cases shading_cases();
[[nodiscard]] Cases gbuffer_cases();
[[nodiscard]] Cases wave_cases();
[[nodiscard]] Cases light_cases();
[[nodiscard]] Cases near_light_cases();
[[nodiscard]] Cases sameness_cases();
[[nodiscard]] Cases random_cases();
[[nodiscard]] Cases committed_cases();
[[nodiscard]] Cases drawn_cases();
[[nodiscard]] Cases drawn_query_cases();

/// Traces with both layouts and compares every hit with exact arithmetic (triangles.cpp).
void judge(Run& run, const Mesh& mesh, const std::vector<Ray>& rays, const std::string& what,
           std::size_t least_hits = 100);

}  // namespace claray::verify
