#include "host/io/world/scene_film.hpp"

#include <algorithm>

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

}  // namespace claray
