// The film of pbrt-v4: its size, crop and speed.
#include <cmath>

#include "claray/error.hpp"
#include "host/io/pbrt/pbrt_scene.hpp"
#include "host/io/scene_readers.hpp"

namespace claray {
namespace {

[[noreturn]] void refuse(const PbrtParameters& p, const char* what, const char* remedy) {
    throw Error(ErrorKind::user, p.place() + ": " + what, remedy);
}

/// As FilmBaseParameters of pbrt-v4: the crop window, a share of the picture, precedes bounds in pixels.
void set_crop(SceneFilm& film, const PbrtParameters& p) {
    const std::vector<double>&window = p.numbers("cropwindow"), &bounds = p.numbers("pixelbounds");
    const auto edge = [](double share, unsigned pixels) { return std::ceil(share * pixels); };
    bool some = true;
    if (window.size() == 4)
        some = film.crop(
            edge(std::min(window[0], window[1]), film.width), edge(std::max(window[0], window[1]), film.width),
            edge(std::min(window[2], window[3]), film.height), edge(std::max(window[2], window[3]), film.height));
    else if (bounds.size() == 4)
        some = film.crop(bounds[0], bounds[1], bounds[2], bounds[3]);
    if (!some) refuse(p, "the crop of the picture has no pixel", "correct cropwindow or pixelbounds");
}

}  // namespace

SceneFilm next_film(PbrtTokens& tokens) {
    (void)tokens.next_text();
    const PbrtParameters p = PbrtParameters::read(tokens);
    const double width = p.number("xresolution", 1280), height = p.number("yresolution", 720);
    if (!(width >= 1 && height >= 1 && width <= 1e6 && height <= 1e6))
        refuse(p, "the picture has no sensible size", "give xresolution and yresolution");
    SceneFilm film{unsigned(width), unsigned(height)};
    set_crop(film, p);
    if (p.find("iso")) film.exposure = float(std::log2(p.number("iso", 100) / 100));
    return film;
}

/// pbrt multiplies radiance by the time of the exposure in seconds, and by the film's speed over 100.
std::optional<SceneFilm> pbrt_film(const std::filesystem::path& path) {
    PbrtTokens tokens(path);
    std::optional<SceneFilm> film;
    double seconds = 1;
    for (PbrtToken token = tokens.next(); token.kind != PbrtToken::Kind::end; token = tokens.next()) {
        if (token.kind != PbrtToken::Kind::word) continue;
        if (token.value == "WorldBegin") break;
        if (token.value == "Include" || token.value == "Import") tokens.include(tokens.next_text());
        if (token.value == "Film") film = next_film(tokens);
        if (token.value != "Camera") continue;
        (void)tokens.next_text();
        const PbrtParameters camera = PbrtParameters::read(tokens);
        seconds = camera.number("shutterclose", 1) - camera.number("shutteropen", 0);
    }
    if (film && seconds != 1) film->exposure = film->exposure.value_or(0.f) + float(std::log2(seconds));
    if (film && film->exposure && !std::isfinite(*film->exposure)) film->exposure.reset();
    return film;
}

}  // namespace claray
