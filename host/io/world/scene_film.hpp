// The picture that a scene file asks for: what pbrt and Mitsuba call its film.
#pragma once

#include <optional>

namespace claray {

/// Pixels of a picture.
struct SceneFilm {
    unsigned width = 0, height = 0;
    unsigned x = 0, y = 0, part_width = 0, part_height = 0;  ///< the crop, from the top left; 0: the whole picture
    std::optional<float> exposure = {};                      ///< stops by which pictures are brighter than radiance

    [[nodiscard]] bool is_part() const { return part_width > 0; }
    /// Keeps the pixels from `left` to before `right` and from `top` to before `bottom`. Returns false if there are
    /// none.
    [[nodiscard]] bool crop(double left, double right, double top, double bottom);
};

}  // namespace claray
