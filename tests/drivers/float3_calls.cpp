// A driver's bug in 30 lines: Intel's OpenCL CPU runtime (2026.22.10) joins the work-items of a group into vectors, and
// then a function that is not inlined loses arguments or results of three components. Prints how many of 256 items are
// wrong, for vectors of 2, 3 and 4 components, as the driver likes it and told not to join work-items
// (kernels/compute/portable.clh). Run: bin/driver_float3_calls
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_ENABLE_EXCEPTIONS
#include <CL/opencl.hpp>
#include <cstdio>
#include <string>
#include <vector>

constexpr const char* source = R"(
__attribute__((noinline)) VECTOR scaled(VECTOR v) { return v * v.y; }
HINT kernel void square(global float* out) {
    const uint i = get_global_id(0);
    out[i] = scaled((VECTOR)((float)i)).x;
})";

int wrong_items(const cl::Context& context, const cl::Device& device, const std::string& options) {
    cl::Program program(context, source);
    program.build(options.c_str());
    std::vector<float> out(256);
    cl::Buffer buffer(context, CL_MEM_READ_WRITE, out.size() * sizeof(float));
    cl::Kernel kernel(program, "square");
    kernel.setArg(0, buffer);
    cl::CommandQueue queue(context, device);
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(out.size()), cl::NDRange(64));
    queue.enqueueReadBuffer(buffer, CL_TRUE, 0, out.size() * sizeof(float), out.data());
    int wrong = 0;
    for (std::size_t i = 0; i < out.size(); ++i) wrong += out[i] != float(i * i);
    return wrong;
}

int main() {
    const cl::Device device = cl::Device::getDefault();
    const cl::Context context(device);
    std::printf("%s, driver %s\n", device.getInfo<CL_DEVICE_NAME>().c_str(),
                device.getInfo<CL_DRIVER_VERSION>().c_str());
    for (const char* vector : {"float2", "float3", "float4"})
        for (const char* hint : {"", "__attribute__((vec_type_hint(float4)))"})
            std::printf("%s %-40s %d of 256 wrong\n", vector, hint,
                        wrong_items(context, device, std::string("-DVECTOR=") + vector + " -DHINT=" + hint));
}
