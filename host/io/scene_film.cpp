#include "host/io/scene_film.hpp"

#include <algorithm>

#include "host/io/scene_readers.hpp"

namespace claray {

bool SceneFilm::crop(double left, double right, double top, double bottom) {
    const auto within = [](double pixel, unsigned most) {
        return pixel > 0 ? unsigned(std::min(pixel, double(most))) : 0u;
    };
    const unsigned x_end = within(right, width), y_end = within(bottom, height);
    x = within(left, width), y = within(top, height);
    if (x >= x_end || y >= y_end) return false;
    part_width = x_end - x, part_height = y_end - y;
    if (part_width == width && part_height == height) part_width = part_height = 0;
    return true;
}

std::optional<SceneFilm> film_of(const std::filesystem::path& path) {
    const SceneReader* reader = scene_reader_of(path);
    return reader && reader->film ? reader->film(path) : std::nullopt;
}

}  // namespace claray
