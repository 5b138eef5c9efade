// Geometry that is not triangles: primitives whose bounds and intersection are given in OpenCL C.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "claray/query.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// A kind of primitive: OpenCL C that defines the functions `bounds_of` and `intersect` of
/// kernels/primitives/primitive.clh, and usually includes "primitives/primitive.clh".
struct PrimitiveKind {
    std::string name = {};    ///< appears in the compiler's messages
    std::string source = {};  ///< may include claray's device headers
    unsigned floats = 0;      ///< per primitive in the data; 0: the data is not so regular
    /// The boxes are those of capsules around the primitives, which reject more rays
    /// (kernels/primitives/primitive.clh).
    bool capsules = false;
};

/// claray's own kinds, which are made in the same way; each file says what the floats of a primitive are.
[[nodiscard]] PrimitiveKind sphere_kind();    ///< kernels/primitives/spheres.clh
[[nodiscard]] PrimitiveKind disc_kind();      ///< kernels/primitives/discs.clh
[[nodiscard]] PrimitiveKind cylinder_kind();  ///< kernels/primitives/cylinders.clh

/// A bounding volume hierarchy over primitives of one kind, in device memory. A handle: copies share the structure.
class Primitives {
public:
    /// Builds over `count` primitives, whose functions read `data`. Boxes are computed on the device; primitives with
    /// boxes that are not finite are left out. `config` is as for triangles; nothing is split. The structure shares
    /// `data`. Throws ErrorKind::usage if there is too little data, ErrorKind::device with the compiler's log if the
    /// source does not compile.
    [[nodiscard]] static Primitives build(const Device& device, const PrimitiveKind& kind, const Buffer<float>& data,
                                          std::uint32_t count, const Bvh::Config& config);
    [[nodiscard]] static Primitives build(const Device& device, const PrimitiveKind& kind, const Buffer<float>& data,
                                          std::uint32_t count);
    /// As above, for data in host memory and kinds with a number of floats per primitive.
    [[nodiscard]] static Primitives build(const Device& device, const PrimitiveKind& kind, std::span<const float> data);

    /// Rebuild, or refit, after the data has changed.
    void rebuild();
    void refit();

    [[nodiscard]] std::uint32_t count() const;
    [[nodiscard]] const Buffer<float>& data() const;
    [[nodiscard]] const Device& device() const;
    /// The tree, whose triangles span the primitives' boxes: for its statistics, validation and hash. Queries of
    /// triangles, instances and Bvh::save refuse it by ErrorKind::usage.
    [[nodiscard]] const Bvh& bvh() const;

    struct State;  ///< not for users

private:
    friend struct Internals;
    std::shared_ptr<State> state_;
};

/// Finds the closest hit of every ray; Hit::primitive is the index of the primitive, u and v are what its kind sets.
/// Among equal distances the lowest primitive wins. Of `options` only `brute_force` and `coherence` are used.
/// Asynchronous, except on CPUs for 65,536 rays or more that are declared incoherent: a sample of them is read, and
/// they are sorted first unless neighbours begin near each other.
void closest_hit(const Primitives& primitives, const Buffer<Ray>& rays, Buffer<Hit>& hits,
                 const QueryOptions& options = {});
/// Writes 1 for every ray that hits anything, else 0.
void any_hit(const Primitives& primitives, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded,
             const QueryOptions& options = {});

/// As above, for rays in host memory. Block.
[[nodiscard]] std::vector<Hit> closest_hit(const Primitives& primitives, std::span<const Ray> rays,
                                           const QueryOptions& options = {});
[[nodiscard]] std::vector<std::uint8_t> any_hit(const Primitives& primitives, std::span<const Ray> rays,
                                                const QueryOptions& options = {});

}  // namespace claray
#pragma GCC visibility pop
