// Outputs of `claray render`: the image, auxiliary images and statistics.
#pragma once

#include "claray/device.hpp"
#include "claray/plan/target.hpp"
#include "claray/scale/render_group.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/cli/output/outputs.hpp"

namespace claray::cli {

/// Sets the exposure of a picture of 8 bits: the one that was asked for, or one that shows its surfaces, of which it
/// tells. `renderer`: tells where surfaces are; null: all pixels count.
void choose_exposure(const std::vector<glm::vec3>& pixels, const Renderer* renderer, RenderOptions& options);
/// Writes the image, and warns if it is black or white. An .exr also gets the AOVs of `renderer` that were asked for,
/// as layers; null: none.
void write_picture(const std::vector<glm::vec3>& pixels, const RenderOptions& options,
                   const Renderer* renderer = nullptr);
/// Writes every auxiliary image that was asked for and is no layer, in false colours (.png) and raw (.pfm).
void write_aovs(Renderer& renderer, const RenderOptions& options, Writes& writes);

/// A denoised image; empty if none was wanted.
struct Denoised {
    std::vector<glm::vec3> image;
    const char* by = "";
    double seconds = 0;
    double error = 0;  ///< of --error; 0: not asked for, or too small to tell
};
/// Throws ErrorKind::user if the denoiser is not installed.
void check_denoiser(DenoiserKind kind);
[[nodiscard]] Denoised denoise(Renderer& renderer, const RenderOptions& options);

/// How the render ended.
struct Outcome {
    RenderProgress progress;
    bool interrupted = false;
    double approximation_error = 0;  ///< of --error with --approximate; 0: not asked for, or too small to tell
};

/// Warns of options that changed nothing: --adaptive without a round, --guide without a guided path.
void tell_of_idle_options(const Renderer& renderer, const RenderOptions& options);
/// `plan`: null if nothing was picked. `shares`: empty for one device.
void print_as_text(const Device& device, const Renderer& renderer, const RenderOptions& options, const Outcome& outcome,
                   const TargetPlan* plan, const Denoised& denoised, const std::vector<DeviceShare>& shares);
void print_as_json(const Device& device, const Renderer& renderer, const RenderOptions& options, const Outcome& outcome,
                   const TargetPlan* plan, const Denoised& denoised, const std::vector<DeviceShare>& shares);

}  // namespace claray::cli
