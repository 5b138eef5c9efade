// From a PCD to spheres.
#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/io/image/color.hpp"
#include "host/io/mesh/positions.hpp"
#include "host/io/obj/mtl.hpp"
#include "host/io/points/pcd_file.hpp"
#include "host/io/scene_readers.hpp"
#include "host/io/strokes.hpp"

namespace claray {
namespace {

/// Red, green and blue in the lower three bytes of a word, which PCL also calls a float.
glm::vec4 unpacked_color(std::uint32_t word) {
    glm::dvec3 display;
    for (int k = 0; k < 3; ++k) display[k] = double(word >> (16 - 8 * k) & 255) / 255;
    return {linear_from_display(display), 1.f};
}

/// All that are finite: scanners write NaN where a ray met nothing.
Strokes strokes_of_pcd(const PcdFile& file, const std::string& name) {
    const PcdField *x = file.field("x"), *y = file.field("y"), *z = file.field("z");
    if (!x || !y || !z) file.refuse("the points lack x, y or z");
    if (file.points() > 0xffffffffu) file.refuse("there are more than 2^32 points");
    const PcdField* colors = file.field("rgb");
    if (!colors) colors = file.field("rgba");
    if (colors && colors->size != 4) colors = nullptr;
    Strokes strokes;
    strokes.name = name;
    for (std::size_t i = 0; i < file.points(); ++i) {
        const glm::vec3 position(float(file.value(*x, i)), float(file.value(*y, i)), float(file.value(*z, i)));
        if (!is_finite(position)) continue;
        strokes.triangles.emplace_back(glm::uvec3(std::uint32_t(strokes.positions.size())));
        strokes.positions.push_back(position);
        if (colors) strokes.colors.push_back(unpacked_color(file.word(*colors, i)));
    }
    strokes.materials.assign(strokes.triangles.size(), 0);
    return strokes;
}

}  // namespace

Scene load_pcd_without_light(const std::filesystem::path& path, Warnings& warnings, const LoadOptions& options) {
    const std::string bytes = read_file(path, "check the path");
    if (bytes.empty()) throw Error(ErrorKind::user, "'" + path.string() + "' is empty", "export the points again");
    const PcdFile file(bytes, path);
    Scene scene;
    scene.name = path.stem().string();
    Strokes strokes = strokes_of_pcd(file, scene.name);
    if (strokes.triangles.empty())
        throw Error(ErrorKind::user, "'" + path.string() + "' contains no point that is finite",
                    "export the points again");
    scene.materials.push_back(grey_lambert(scene.name));
    add_strokes(scene, {std::move(strokes)}, options.stroke_radius, warnings);
    return scene;
}

}  // namespace claray
