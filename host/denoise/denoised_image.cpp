#include "host/denoise/denoised_image.hpp"

#include "claray/renderer.hpp"
#include "host/denoise/oidn.hpp"

namespace claray {
namespace {

glm::vec3 mean_of(const FilmPixel& p) {
    const glm::vec3 sum(p.all.r + p.all.lost_r, p.all.g + p.all.lost_g, p.all.b + p.all.lost_b);
    return p.count == 0 ? glm::vec3(0) : sum / float(p.count);
}

}  // namespace

DenoiserKind picked_denoiser(DenoiserKind kind) {
    if (kind != DenoiserKind::automatic) return kind;
    return Oidn::load() ? DenoiserKind::oidn : DenoiserKind::claray;
}

void require_oidn() { (void)Oidn::load_or_throw(); }

/// Glow needs no denoising, and its high contrasts disturb it: only the rest is.
std::vector<glm::vec3> denoised_by_oidn(const NoisyFilm& film) {
    OidnImages images{film.width, film.height, {}, {}, {}};
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
        const Guide& g = film.guides[i];
        const glm::vec3 glow(g.sampled_glow_r, g.sampled_glow_g, g.sampled_glow_b);
        const glm::vec3 gloss(g.gloss_r, g.gloss_g, g.gloss_b);
        images.color.push_back(glm::max(mean_of(film.pixels[i]) - glow + gloss, 0.f));
        images.albedo.push_back(glm::clamp(glm::vec3(g.albedo_r, g.albedo_g, g.albedo_b), 0.f, 1.f));
        images.normal.emplace_back(g.normal_x, g.normal_y, g.normal_z);
    }
    std::vector<glm::vec3> image = Oidn::load_or_throw()->denoise(std::move(images));
    for (std::size_t i = 0; i < image.size(); ++i) {
        const Guide& g = film.guides[i];
        image[i] += glm::vec3(g.glow_r, g.glow_g, g.glow_b);
    }
    return image;
}

}  // namespace claray
