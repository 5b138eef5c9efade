// Saves a render to a file and continues from it. docs/formats.md describes the bytes.
#pragma once

#include <filesystem>
#include <vector>

#include "claray/renderer.hpp"
#include "host/base/hash.hpp"
#include "host/render/film/error_estimate.hpp"
#include "host/render/schedule/adaptive_schedule.hpp"

namespace claray {

/// Everything except the device on which the samples of a render depend. A render can continue another one of the same
/// identity, also with another number of samples.
struct RenderIdentity {
    std::uint32_t width = 0, height = 0;
    Digest scene{};
    Digest settings{};  // seed, depth, sampler, removed effects, adaptive sampling, guiding
    Digest kernels{};   // their sources
};

[[nodiscard]] RenderIdentity identity_of(const Scene& scene, const RenderConfig& config);

/// The progress of a render.
struct Checkpoint {
    AdaptiveSchedule::Position position;
    ErrorProgress error;
    std::vector<FilmPixel> sums;
};

/// Writes through NewFile: under this name there is always a complete checkpoint, the previous one or this one.
void write_checkpoint(const std::filesystem::path& path, const RenderIdentity& identity, const Checkpoint& checkpoint);

/// Throws ErrorKind::user, naming the file and the difference, if the file is damaged, belongs to a render of another
/// identity, or has more than `spp` samples per pixel.
[[nodiscard]] Checkpoint read_checkpoint(const std::filesystem::path& path, const RenderIdentity& identity,
                                         std::uint32_t spp);

}  // namespace claray
