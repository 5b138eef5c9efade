// Cryptomatte: which surfaces a pixel shows, and how much of it each covers. Compositors make masks of these by their
// names. Psyop's Cryptomatte specification 1.2.0; Friedman and Jones 2015, "Fully automatic ID mattes with support for
// motion blur and transparency".
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "claray/error.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// What a Cryptomatte tells apart.
enum class MatteKind : std::uint32_t {
    object,    ///< instances by their names; of scenes without instances, meshes and sets of primitives
    material,  ///< materials
    asset      ///< meshes and sets of primitives: all instances of a mesh are one
};

struct MatteRow {
    MatteKind kind;
    const char* name;  ///< of the layer
    const char* meaning;
};
inline constexpr MatteRow matte_rows[] = {
    {MatteKind::object, "crypto_object", "instances and meshes by their names"},
    {MatteKind::material, "crypto_material", "materials by their names"},
    {MatteKind::asset, "crypto_asset", "meshes by their names, however often each is shown"}};

/// A surface in a pixel.
struct MattePart {
    float id = 0.f;        ///< of its name; 0: nothing
    float coverage = 0.f;  ///< share of the pixel, 0..1
};

struct Cryptomatte {
    std::string name;              ///< of the layer
    unsigned ranks = 0;            ///< parts of each pixel, an even number
    std::vector<MattePart> parts;  ///< `ranks` of each pixel, row by row from the top left, the largest first
    std::vector<std::pair<std::string, std::uint32_t>> manifest;  ///< all names, and their hashes
};

/// Returns the hash of a name: MurmurHash3_x86_32 with seed 0.
[[nodiscard]] std::uint32_t matte_hash(const std::string& name);
/// Returns the id with this hash: its bits as a float. A bit is changed where they would be 0, subnormal, infinite or
/// NaN.
[[nodiscard]] float matte_id(std::uint32_t hash);

}  // namespace claray
#pragma GCC visibility pop
