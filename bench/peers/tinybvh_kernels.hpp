// tinybvh's OpenCL kernels, started as its own host starts them (tiny_bvh_speedtest.cpp): one item a ray, in groups of
// a stated size.
#pragma once

#include <string>

#include "claray/claray.hpp"

namespace claray::measure {

/// What its batch kernels do, for any-hit rays, too, and with the length of the ray. Items behind the last ray return.
constexpr const char* tinybvh_source = R"(
struct BVHNode { float4 lmin, lmax, rmin, rmax; };
struct Ray { float4 O, D, rD, hit; };
#define STACK_SIZE 32
#include "traverse_bvh2.cl"
float3 reciprocal(float3 d) { return select((float3)(1e30f), 1 / d, fabs(d) > 1e-12f); }  // as its host computes it
kernel void closest(global const struct BVHNode* nodes, global const uint* idx, global const float4* corners,
                    global const float4* rays, uint count, global float4* hits) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float4 o = rays[2 * i], d = rays[2 * i + 1];
    hits[i] = traverse_ailalaine(nodes, idx, corners, 0, o.xyz, d.xyz, reciprocal(d.xyz), d.w, 0);
}
kernel void occlusion(global const struct BVHNode* nodes, global const uint* idx, global const float4* corners,
                      global const float4* rays, uint count, global uchar* occluded) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float4 o = rays[2 * i], d = rays[2 * i + 1];
    occluded[i] = isoccluded_ailalaine(nodes, idx, corners, 0, o.xyz, d.xyz, reciprocal(d.xyz), d.w);
}
)";

/// `folder`: of its traverse_bvh2.cl. `more`: options beside those that its host gives on every device (tiny_ocl.h).
/// Throws cl::Error if it does not compile.
inline cl::Program build_tinybvh(const Device& device, const std::string& folder, const std::string& more = {}) {
    const std::string options =
        "-cl-std=CL2.0 -cl-strict-aliasing -cl-fast-relaxed-math -cl-single-precision-constant -I " + folder + ' ' +
        more;
    cl::Program program(device.context(), std::string(tinybvh_source));
    program.build(options.c_str());
    return program;
}

/// Starts a kernel of that program for the first `count` rays. A driver that is given no group size takes a divisor of
/// the number of items, NVIDIA's down to one item a group: the number is rounded up to whole groups instead.
inline void start_tinybvh(const Device& device, cl::Kernel kernel, std::size_t count, std::size_t group) {
    const std::size_t items = (count + group - 1) / group * group;
    kernel.setArg(4, cl_uint(count));
    device.profiler().record("peer", [&](cl::Event* event) {
        device.queue().enqueueNDRangeKernel(kernel, {}, cl::NDRange(items), cl::NDRange(group), nullptr, event);
    });
}

/// The largest prime up to a number, which is at least 2.
inline std::size_t prime_up_to(std::size_t number) {
    const auto is_prime = [](std::size_t n) {
        for (std::size_t divisor = 2; divisor * divisor <= n; ++divisor)
            if (n % divisor == 0) return false;
        return true;
    };
    while (!is_prime(number)) --number;
    return number;
}

}  // namespace claray::measure
