#include "host/cli/picture/lens_options.hpp"

#include <cmath>

#include "host/cli/help/help.hpp"
#include "host/cli/options/option_rules.hpp"

namespace claray::cli {
namespace {

constexpr float default_sensor = 24.f;  // millimetres, of 35 mm film

void add_pair(CLI::App& command, const char* name, std::optional<glm::vec2>& pair, const char* description) {
    command
        .add_option_function<std::string>(
            name,
            [name, &pair](const std::string& text) {
                const std::vector<float> numbers = parse_numbers(text);
                if (numbers.size() != 2)
                    throw Error(ErrorKind::usage, std::string(name) + ": '" + text + "' is not a pair of numbers",
                                "write two numbers: X,Y");
                pair = glm::vec2(numbers[0], numbers[1]);
            },
            description)
        ->type_name("X,Y");
}

}  // namespace

void add_lens_options(CLI::App& command, LensOptions& o) {
    add_pair(command, "--shift", o.shift,
             "Lens shift, in parts of the image's width to the right and of its height upwards [0,0]");
    add_pair(command, "--tilt", o.tilt,
             "Degrees by which the sharp plane is turned: its top goes away, its right goes away [0,0]");
    const std::vector<std::pair<std::string, Stereo>> layouts = {
        {"none", Stereo::none}, {"side-by-side", Stereo::side_by_side}, {"top-bottom", Stereo::top_bottom}};
    command
        .add_option("--stereo", o.stereo,
                    "The images of two eyes in one: side-by-side or top-bottom, the left eye's first [none]")
        ->transform(choice_of(layouts))
        ->type_name("NAME");
    command.add_option("--eye-distance", o.eye_distance, "Between the eyes, in units of the scene [0.064]")
        ->check(positive_number());
    command
        .add_option("--focal-length", o.focal_length,
                    "Of the lens in millimetres: the field of view by the sensor's height")
        ->check(positive_number())
        ->type_name("MM");
    command.add_option("--sensor-height", o.sensor_height, "In millimetres [24]")
        ->check(positive_number())
        ->type_name("MM");
    command
        .add_option(
            "--f-number", o.f_number,
            "Of the lens. With --focal-length or --sensor-height it sets --aperture, in a scene in metres; with\n"
            "--iso the exposure")
        ->check(positive_number())
        ->type_name("N");
}

Camera with_lens(Camera camera, const LensOptions& o) {
    if (o.shift) camera.shift = *o.shift;
    if (o.tilt) camera.tilt = *o.tilt;
    if (o.stereo) camera.stereo = *o.stereo;
    if (o.eye_distance) camera.eye_distance = *o.eye_distance;
    const float sensor = o.sensor_height.value_or(default_sensor);
    if (o.focal_length) {
        camera.vertical_fov = glm::degrees(2 * std::atan(0.5f * sensor / *o.focal_length));
        camera.projection = Projection::perspective;
    }
    if (o.f_number && (o.focal_length || o.sensor_height)) {
        const float focal_length =
            o.focal_length.value_or(0.5f * sensor / std::tan(0.5f * glm::radians(camera.vertical_fov)));
        camera.aperture_radius = 1e-3f * focal_length / (2 * *o.f_number);
    }
    return camera;
}

void add_exposure_options(CLI::App& command, RenderOptions& o) {
    OptionGroup group(command, "Lens and motion");
    command
        .add_option("--iso", o.iso,
                    "Sensor speed: with --f-number and --shutter-time the exposure of a PNG, if radiance is in cd/m^2")
        ->check(positive_number())
        ->type_name("S");
    command.add_option("--shutter-time", o.shutter_time, "Time of the exposure: 8ms, 1s; with --iso")
        ->transform(duration())
        ->type_name("TIME");
}

void check_exposure_options(const CLI::App& command, RenderOptions& o) {
    refuse_without(command, "--iso", "--f-number");
    refuse_without(command, "--iso", "--shutter-time");
    refuse_without(command, "--shutter-time", "--iso");
    refuse_both(command, "--iso", {"--exposure"}, "both tell the exposure");
    refuse_both(command, "--focal-length", {"--fov", "--ortho"}, "both tell the field of view");
    const LensOptions& lens = o.view.lens;
    if (lens.f_number && (lens.focal_length || lens.sensor_height))
        refuse_both(command, "--f-number", {"--aperture"}, "both tell the radius of the lens");
    if (lens.f_number && !lens.focal_length && !lens.sensor_height && !o.iso)
        throw Error(ErrorKind::usage, "--f-number has no effect without a sensor or an exposure",
                    "add --focal-length, --sensor-height or --iso");
    if (o.iso) o.exposure = float(stops_of(*o.iso, double(*lens.f_number), o.shutter_time));
}

double stops_of(double iso, double f_number, double shutter_seconds) {
    constexpr double saturation = 78, lens_factor = 0.65;
    return std::log2(lens_factor * iso * shutter_seconds / (saturation * f_number * f_number));
}

}  // namespace claray::cli
