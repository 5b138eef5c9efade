// The film of a Mitsuba scene: its size and crop, and the exposure that films of 8 bits had in Mitsuba 0.5.
#include "host/io/mitsuba/mitsuba_scene.hpp"
#include "host/io/scene_readers.hpp"

namespace claray {

SceneFilm film_of(const MitsubaNode& film) {
    const double width = film.number("width", default_film.width), height = film.number("height", default_film.height);
    if (!(width >= 1 && height >= 1 && width <= 1e6 && height <= 1e6))
        film.refuse("the picture has no sensible size", "give width and height");
    SceneFilm result{unsigned(width), unsigned(height)};
    const double x = film.number("crop_offset_x", 0), y = film.number("crop_offset_y", 0);
    if (!result.crop(x, x + film.number("crop_width", width), y, y + film.number("crop_height", height)))
        film.refuse("the crop of the picture has no pixel", "correct crop_offset and crop_width");
    if (film.type == "ldrfilm" && film.property("exposure")) result.exposure = float(film.number("exposure", 0));
    return result;
}

std::optional<SceneFilm> mitsuba_film(const std::filesystem::path& path) {
    const MitsubaNode scene = read_mitsuba(path);
    Warnings warnings;
    World world(path, warnings);
    const MitsubaMaterials objects(scene, world);
    const MitsubaNode* sensor = objects.child(scene, "sensor");
    const MitsubaNode* film = sensor ? objects.child(*sensor, "film") : nullptr;
    return film ? std::optional(film_of(*film)) : std::nullopt;
}

}  // namespace claray
