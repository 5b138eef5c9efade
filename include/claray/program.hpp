// Kernels: compile claray's or your own, bind plain structs and buffers, run.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "claray/buffer.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// Macros for compiling a kernel: name and value.
using Defines = std::vector<std::pair<std::string, std::string>>;

/// How floating-point code is compiled.
enum class Math {
    strict,  ///< IEEE: no contraction, denormals kept, divisions rounded correctly if the device supports it
    fast     ///< -cl-fast-relaxed-math: NaN and infinity are not reliable. Do not use it for geometry.
};

/// Number of work-items in total and per group. The global size is rounded up to whole groups; kernels must check their
/// index.
struct Range {
    std::size_t global = 0;
    /// 0: the driver chooses a divisor of the global size, which is not rounded. NVIDIA's driver takes 1 if the global
    /// size is prime, which is many times as slow: give a size wherever the number of items is not known.
    std::size_t local = 0;
};

/// Local (work-group) memory for a kernel argument, in bytes.
struct LocalMemory {
    std::size_t bytes = 0;
};

/// An argument with the name of its parameter. Needed for kernels that have several buffers of one type.
template <class T>
struct Argument {
    const char* name;
    const T& value;
};
template <class T>
[[nodiscard]] Argument<T> arg(const char* name, const T& value) {
    return {name, value};
}

/// Returns the OpenCL C name of a type, or null if it is unknown. For shared structs see CLARAY_LAYOUT.
constexpr const char* device_type_name(const void*) { return nullptr; }
constexpr const char* device_type_name(const float*) { return "float"; }
constexpr const char* device_type_name(const double*) { return "double"; }
constexpr const char* device_type_name(const std::uint8_t*) { return "uchar"; }
constexpr const char* device_type_name(const std::int32_t*) { return "int"; }
constexpr const char* device_type_name(const std::uint32_t*) { return "uint"; }
constexpr const char* device_type_name(const std::uint64_t*) { return "ulong"; }

class Kernel {
public:
    Kernel() = default;
    Kernel(Device device, cl::Kernel kernel, std::string name)
        : device_(std::make_shared<Device>(std::move(device))), kernel_(std::move(kernel)), name_(std::move(name)) {}

    /// Binds the arguments in order and enqueues the kernel. Asynchronous. An argument is a Buffer, a plain value of
    /// exactly the kernel's type, LocalMemory or nullptr (no buffer). It may also be an object that binds several
    /// arguments by a member `bind(Kernel&, index)` (such as Bvh). `arg` gives an argument the name of its parameter.
    /// Reading a buffer waits for the kernel. Throws ErrorKind::usage if the type or the name of an argument differs
    /// from its parameter, and for a buffer of another context. It also throws for a buffer without a name if one of
    /// claray's own kernels takes several buffers of its type.
    template <class... Args>
    void run(Range range, const Args&... args) {
        unsigned index = 0;
        (bind(index, args), ...);
        enqueue(range, index);
    }

    template <class T>
    void set(unsigned& index, const T& value) {
        bind(index, value);
    }

    /// Throws ErrorKind::usage if this kernel comes from compile_kernel and was compiled without one of these macros.
    /// Objects with a `bind` member call this to check that the kernel was compiled for their memory layout.
    void require(const Defines& macros) const;
    void remember(Defines macros) { macros_ = std::make_shared<const Defines>(std::move(macros)); }
    /// Enables checks of the names and types of arguments. `parameters` holds a line "kernel name type" for every
    /// parameter of a program.
    void check_arguments(const std::string& parameters);

    [[nodiscard]] const cl::Kernel& handle() const noexcept { return kernel_; }
    [[nodiscard]] const std::string& name() const noexcept { return name_; }

private:
    friend class KernelPool;
    template <class T>
    void bind(unsigned& index, const Argument<T>& argument) {
        name_of_argument_ = argument.name;
        bind(index, argument.value);
    }
    template <class T>
    void bind(unsigned& index, const Buffer<T>& buffer) {
        check_buffer(index, device_type_name(static_cast<const T*>(nullptr)));
        if (buffer.allocated()) check_context(index, buffer.device());
        const cl_mem memory = buffer.memory()();  // null if nothing is allocated: no buffer
        set_argument(index++, sizeof memory, &memory);
    }
    void bind(unsigned& index, const cl::Buffer& buffer) {
        const cl_mem memory = buffer();
        set_argument(index++, sizeof memory, &memory);
    }
    void bind(unsigned& index, std::nullptr_t) {
        const cl_mem absent = nullptr;
        set_argument(index++, sizeof absent, &absent);
    }
    void bind(unsigned& index, LocalMemory local) { set_argument(index++, local.bytes, nullptr); }
    template <class T>
    void bind(unsigned& index, const T& value) {
        if constexpr (requires { value.bind(*this, index); }) {
            value.bind(*this, index);
        } else {
            static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>, "kernel arguments are plain data");
            set_argument(index++, sizeof(T), &value);
        }
    }
    void check_buffer(unsigned index, const char* type);
    void check_context(unsigned index, const Device& of_buffer) const;
    void check_name(unsigned index);
    void set_argument(unsigned index, std::size_t bytes, const void* value);
    void enqueue(Range range, unsigned arguments);

    std::shared_ptr<Device> device_;
    std::shared_ptr<const void> lease_;  // of `kernel_`, which is destroyed before it; null: not from a KernelPool
    cl::Kernel kernel_;
    std::string name_;
    std::shared_ptr<const Defines> macros_;  // null: not checked

    struct Parameter {
        std::string name, type;  // "Ray*"
        bool ambiguous = false;  // another parameter is a pointer to the same type
    };
    std::shared_ptr<const std::vector<Parameter>> parameters_;  // null: not checked
    const char* name_of_argument_ = nullptr;                    // name of the argument that is being bound
};

/// Loads one of claray's own kernels by its file under kernels/ (such as "sort/radix_sort.cl"). It is compiled once per
/// device and set of macros, then cached in memory and on disk. The tuning values that its source names become macros;
/// `defines` override them. Throws ErrorKind::device with the compiler's log, ErrorKind::usage for an unknown function.
[[nodiscard]] Kernel load_kernel(const Device& device, const std::string& file, const std::string& function,
                                 const Defines& defines = {}, Math math = Math::strict);

/// Compiles a kernel from your own source text. It may include claray's device headers ("claray/shared/types.h",
/// "trace/closest_hit.clh" and the rest). `name` is the file name in error messages. Compile a kernel that takes a Bvh
/// or an InstancedBvh with its defines(), which describe its layout; binding a structure with another layout throws
/// ErrorKind::usage. Throws ErrorKind::device with the compiler's log, ErrorKind::usage for an unknown function.
[[nodiscard]] Kernel compile_kernel(const Device& device, const std::string& source, const std::string& function,
                                    const Defines& defines = {}, Math math = Math::strict,
                                    const std::string& name = "user.cl");

/// Time spent compiling since the start of the process, in milliseconds, and the number of programs by origin.
struct CompileStatistics {
    double milliseconds = 0;
    unsigned compiled = 0;    ///< by the driver, from source
    unsigned from_cache = 0;  ///< loaded from the cache on disk
    std::string cache_error;  ///< why the latest program could not be cached; empty if all were
};
[[nodiscard]] CompileStatistics compile_statistics();

}  // namespace claray
#pragma GCC visibility pop
