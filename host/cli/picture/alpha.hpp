// Pictures with alpha and parts of pictures: --alpha, --holdout, --shadow-catcher, --region, --full-frame.
#pragma once

#include <CLI/CLI.hpp>

#include "host/cli/options/render_options.hpp"

namespace claray::cli {

void add_alpha_options(CLI::App& command, RenderOptions& options);
/// Throws ErrorKind::usage for options that exclude each other.
void check_alpha_options(const CLI::App& command, RenderOptions& options);

/// Gives materials their roles, and adds the ground plane that catches shadows. Throws ErrorKind::usage for a material
/// that the scene does not have.
void give_roles(Scene& scene, const RenderOptions& options);

/// What is written: a render, or its place in the whole image.
struct Picture {
    unsigned width = 0, height = 0;
    std::vector<glm::vec3> pixels = {};
    std::vector<float> alpha = {};  // empty: none
};
/// `renderer`: has the alpha; null: there is none.
[[nodiscard]] Picture picture_of(const std::vector<glm::vec3>& pixels, const Renderer* renderer,
                                 const RenderOptions& options);
/// The colours of an EXR, premultiplied unless `options` ask otherwise.
[[nodiscard]] ImageLayer colors_of(const Picture& picture, const RenderOptions& options);
/// As write_image: a PNG is straight unless `options` ask otherwise.
void write_with_alpha(const Picture& picture, const RenderOptions& options);

}  // namespace claray::cli
