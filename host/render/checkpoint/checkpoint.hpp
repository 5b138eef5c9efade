// Saves a render to a file and continues from it. docs/formats.md describes the bytes.
#pragma once

#include <filesystem>
#include <vector>

#include "claray/renderer.hpp"
#include "host/base/hash.hpp"
#include "host/render/error_looks.hpp"
#include "host/render/film.hpp"
#include "host/render/schedule.hpp"

namespace claray {

/// Whether samples of odd index are summed once more.
[[nodiscard]] inline bool tells_error(const RenderConfig& config) { return config.error > 0; }

/// What the samples of a render depend on, but for the device. Of two renders of the same identity one may go on where
/// the other stopped, with another number of samples, too.
struct RenderIdentity {
    std::uint32_t width = 0, height = 0;
    bool tells_error = false;
    Digest scene{};
    Digest settings{};  // seed, depth, sampler, effects that are left out
    Digest kernels{};   // their sources
};

[[nodiscard]] RenderIdentity identity_of(const Scene& scene, const RenderConfig& config);

/// How far a render has come.
struct Checkpoint {
    Schedule::Position position;
    ErrorLooks looks;
    Film::Sums sums;
};

/// As NewFile: there is always a whole checkpoint under this name, the former one or this.
void write_checkpoint(const std::filesystem::path& path, const RenderIdentity& identity, const Checkpoint& checkpoint);

/// Throws ErrorKind::user, naming the file and what differs, for a file that is damaged, or of a render of another
/// identity, or with more than `spp` samples a pixel.
[[nodiscard]] Checkpoint read_checkpoint(const std::filesystem::path& path, const RenderIdentity& identity,
                                         std::uint32_t spp);

}  // namespace claray
