#include "host/cli/picture/film.hpp"

#include <algorithm>
#include <cmath>

#include "host/cli/output/messages.hpp"
#include "host/io/scene_readers.hpp"
#include "host/render/config/checks.hpp"

namespace claray::cli {
namespace {

bool needs_whole_image(const RenderOptions& o) {
    const auto shows = [&](const char* aov) { return std::ranges::count(o.aovs, aov) > 0; };
    return o.config.adaptive || o.denoiser || o.fps > 0 || o.config.approximate.tile_sum || shows("gbuffer") ||
           shows("voxels");
}

void use_crop(const SceneFilm& film, RenderOptions& o) {
    if (!film.is_part() || o.has_size || o.config.region.width > 0) return;
    if (needs_whole_image(o))
        return print_warning("'" + o.scene + "': the crop of its film is not used, because the whole image is needed");
    o.config.region = {film.x, film.y, film.part_width, film.part_height};
}

}  // namespace

void use_film(RenderOptions& o) {
    const std::optional<SceneFilm> film = film_of(o.scene);
    if (!film) return;
    use_crop(*film, o);
    if (!o.has_size) o.config.width = film->width, o.config.height = film->height;
    check_size(o.config.width, o.config.height);
    if (!o.exposure && !o.auto_exposure && film->exposure && std::isfinite(*film->exposure))
        o.exposure = film->exposure;
}

}  // namespace claray::cli
