// Makes a header compile as C++ and as OpenCL C. Shared structs contain scalars only, since the size of a float3
// differs between host and device.
#ifndef CLARAY_SHARED_PORTABLE_H
#define CLARAY_SHARED_PORTABLE_H

#ifdef __OPENCL_C_VERSION__

// For programs that are compiled without optimization. PoCL 3.1 copies called functions into the kernel with a search
// that visits every call path, which takes seconds if calls are deeply nested (pocl/lib/llvmopencl/linker.cpp,
// copy_func_callgraph).
#if CLARAY_UNOPTIMIZED
#define inline inline __attribute__((always_inline))
#endif

#define CLARAY_SHARED_BEGIN
#define CLARAY_SHARED_END
#define CLARAY_SHARED_FUNCTION static inline
#define CLARAY_LAYOUT(type, size)
#define CLARAY_ALIGNED(bytes) __attribute__((aligned(bytes)))

#else

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace claray {
using uint = std::uint32_t;
using ulong = std::uint64_t;
}  // namespace claray

#define CLARAY_SHARED_BEGIN namespace claray {
#define CLARAY_SHARED_END }
#define CLARAY_SHARED_FUNCTION inline
#define CLARAY_ALIGNED(bytes) alignas(bytes)
   /// Fails to compile if the host's layout of a shared struct differs from that of the kernels. Passes the struct's
   /// name to Kernel::run, which compares it with the kernel's parameter.
#define CLARAY_LAYOUT(type, size)                                                                                     \
    static_assert(sizeof(type) == (size), #type " has another size");                                                 \
    static_assert(std::is_trivially_copyable_v<type> && std::is_standard_layout_v<type>, #type " is not plain data"); \
    constexpr const char* device_type_name(const type*) { return #type; }

#endif

#endif
