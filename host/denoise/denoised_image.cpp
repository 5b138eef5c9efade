#include "host/denoise/denoised_image.hpp"

#include "host/denoise/denoiser.hpp"
#include "host/denoise/oidn.hpp"

namespace claray {
namespace {

std::vector<glm::vec3> by_claray(const NoisyFilm& film) {
    Denoiser denoiser(film.pixels.device(), film.width, film.height);
    std::vector<glm::vec3> image(film.pixels.size());
    film.read(denoiser.denoise(film.pixels, film.guides, film.spp), image);
    return image;
}

glm::vec3 mean_of(const FilmPixel& p) {
    const glm::vec3 sum(p.all.r + p.all.lost_r, p.all.g + p.all.lost_g, p.all.b + p.all.lost_b);
    return p.count == 0 ? glm::vec3(0) : sum / float(p.count);
}

/// Glow needs no denoising, and its high contrasts disturb it: only the rest is.
std::vector<glm::vec3> by_oidn(const NoisyFilm& film) {
    const std::vector<Guide> guides = film.guides.read();
    const std::vector<FilmPixel> pixels = film.pixels.read();
    OidnImages images{film.width, film.height, {}, {}, {}};
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const Guide& g = guides[i];
        const glm::vec3 glow(g.sampled_glow_r, g.sampled_glow_g, g.sampled_glow_b);
        const glm::vec3 gloss(g.gloss_r, g.gloss_g, g.gloss_b);
        images.color.push_back(glm::max(mean_of(pixels[i]) - glow + gloss, 0.f));
        images.albedo.push_back(glm::clamp(glm::vec3(g.albedo_r, g.albedo_g, g.albedo_b), 0.f, 1.f));
        images.normal.emplace_back(g.normal_x, g.normal_y, g.normal_z);
    }
    std::vector<glm::vec3> image = Oidn::load_or_throw()->denoise(std::move(images));
    for (std::size_t i = 0; i < image.size(); ++i)
        image[i] += glm::vec3(guides[i].glow_r, guides[i].glow_g, guides[i].glow_b);
    return image;
}

}  // namespace

DenoiserKind picked_denoiser(DenoiserKind kind) {
    if (kind != DenoiserKind::automatic) return kind;
    return Oidn::load() ? DenoiserKind::oidn : DenoiserKind::claray;
}

void require_oidn() { (void)Oidn::load_or_throw(); }

std::vector<glm::vec3> denoised_image(const NoisyFilm& film, DenoiserKind kind) {
    return picked_denoiser(kind) == DenoiserKind::oidn ? by_oidn(film) : by_claray(film);
}

}  // namespace claray
