// Outputs of `claray render`: the image, auxiliary images and statistics.
#pragma once

#include "claray/device.hpp"
#include "claray/target.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/cli/output/outputs.hpp"

namespace claray::cli {

/// Writes the image, and warns if it is black or white.
void write_picture(const std::vector<glm::vec3>& pixels, const RenderOptions& options);
/// Writes every auxiliary image that was asked for, in false colours (.png) and raw (.pfm).
void write_aovs(const Renderer& renderer, const RenderOptions& options, Writes& writes);

/// How the render ended.
struct Outcome {
    RenderProgress progress;
    bool interrupted = false;
};

/// `plan`: null if nothing was picked.
void print_as_text(const Device& device, const Renderer& renderer, const RenderOptions& options, const Outcome& outcome,
                   const TargetPlan* plan);
void print_as_json(const Device& device, const Renderer& renderer, const RenderOptions& options, const Outcome& outcome,
                   const TargetPlan* plan);

}  // namespace claray::cli
