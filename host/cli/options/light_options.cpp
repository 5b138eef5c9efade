#include "host/cli/options/light_options.hpp"

#include <algorithm>
#include <numbers>

#include "claray/error.hpp"
#include "claray/io.hpp"
#include "host/cli/help/help.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/output/messages.hpp"
#include "host/lights/studio.hpp"

namespace claray::cli {
namespace {

constexpr float degree = std::numbers::pi_v<float> / 180.f;

[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
    throw Error(ErrorKind::usage, what, remedy);
}

/// A name with the numbers that follow it.
struct Value {
    std::string name;
    std::vector<float> numbers;
};

std::vector<Value> values_of(const std::vector<std::string>& words) {
    std::vector<Value> values;
    for (std::size_t i = 1; i < words.size(); ++i) {
        const std::size_t equals = words[i].find('=');
        if (equals != std::string::npos) values.push_back({words[i].substr(0, equals), {}});
        const auto numbers = parse_numbers(equals == std::string::npos ? words[i] : words[i].substr(equals + 1));
        if (values.empty() || numbers.empty())
            refuse("--light: '" + words[i] + "' is not a number", "write KIND,NAME=NUMBERS,NAME=NUMBERS ...");
        values.back().numbers.push_back(numbers[0]);
    }
    return values;
}

void expect_count(const Value& value, bool good, const char* remedy) {
    if (!good) refuse("--light: " + value.name + " has " + std::to_string(value.numbers.size()) + " numbers", remedy);
}

glm::vec3 three(const Value& value) {
    expect_count(value, value.numbers.size() == 3, "give three");
    return {value.numbers[0], value.numbers[1], value.numbers[2]};
}

glm::vec3 one_or_three(const Value& value) {
    if (value.numbers.size() == 1) return glm::vec3(value.numbers[0]);
    expect_count(value, value.numbers.size() == 3, "give one or three");
    return three(value);
}

float one(const Value& value) {
    expect_count(value, value.numbers.size() == 1, "give one");
    return value.numbers[0];
}

/// "point, directional, ...".
std::string kinds() {
    std::string text;
    for (const LightTraits& traits : light_kinds) text += (text.empty() ? "" : ", ") + std::string(traits.name);
    return text;
}

LightKind kind_named(const std::string& name) {
    for (const LightTraits& traits : light_kinds)
        if (name == traits.name) return traits.kind;
    refuse("--light: unknown kind '" + name + "'", "the kinds are " + kinds());
}

/// "spot,position=0,2,0,direction=0,-1,0,intensity=50,inner=20,outer=30": a kind, then names and values; angles in
/// degrees, one number for three equal ones.
Light parse_light(const std::string& text) {
    const std::vector<std::string> words = split(text);
    Light light;
    light.kind = kind_named(words[0]);
    for (const Value& value : values_of(words)) {
        if (value.name == "position")
            light.position = three(value);
        else if (value.name == "direction")
            light.direction = three(value);
        else if (value.name == "intensity")
            light.intensity = one_or_three(value);
        else if (value.name == "attenuation")
            light.attenuation = three(value);
        else if (value.name == "range")
            light.range = one(value);
        else if (value.name == "linear-range")
            light.range = one(value), light.linear_range = true;
        else if (value.name == "inner")
            light.inner_angle = degree * one(value);
        else if (value.name == "outer")
            light.outer_angle = degree * one(value);
        else
            refuse("--light: unknown value '" + value.name + "'",
                   "use position, direction, intensity, range, linear-range, attenuation, inner or outer");
    }
    return light;
}

/// "R,G,B", or "R,G,B,R,G,B" from the horizon to the zenith; one number is grey.
Sky parse_sky(const std::string& text) {
    std::vector<float> numbers = parse_numbers(text);
    const bool negative = std::any_of(numbers.begin(), numbers.end(), [](float x) { return x < 0; });
    if (negative || (numbers.size() != 1 && numbers.size() != 3 && numbers.size() != 6))
        refuse("--sky: '" + text + "' is not a radiance", "write R,G,B, or R,G,B,R,G,B from the horizon to the zenith");
    if (numbers.size() == 1) numbers.assign(3, numbers[0]);
    if (numbers.size() == 3) numbers.insert(numbers.end(), {numbers[0], numbers[1], numbers[2]});
    return {{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
}

/// "DENSITY,R,G,B,DEPTH"; the colour may be one number, and the depth may be left out.
Sky parse_fog(const std::string& text) {
    const std::vector<float> numbers = parse_numbers(text);
    const bool negative = std::any_of(numbers.begin(), numbers.end(), [](float x) { return x < 0; });
    const std::size_t given = numbers.size();
    if (negative || given < 2 || given > 5)
        refuse("--fog: '" + text + "' is not fog",
               "write DENSITY,R,G,B or DENSITY,R,G,B,DEPTH; one number instead of R,G,B is grey");
    const bool grey = given < 4;
    Sky fog;
    fog.fog_density = numbers[0];
    fog.fog_color = grey ? glm::vec3(numbers[1]) : glm::vec3(numbers[1], numbers[2], numbers[3]);
    if (given == 3 || given == 5) fog.fog_depth = numbers.back();
    return fog;
}

}  // namespace

void add_light_options(CLI::App& command, LightOptions& o) {
    OptionGroup group(command, "Light");
    command
        .add_option_function<std::vector<std::string>>(
            "--light",
            [&o](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) o.lights.push_back(parse_light(text));
            },
            "Add a light: its kind (" + kinds() +
                "), then values as in "
                "spot,position=0,2,0,direction=0,-1,0,intensity=50,inner=20,outer=30 (degrees; also range, "
                "linear-range, attenuation)")
        ->take_all()
        ->type_name("TEXT");
    group.next("More light");
    command.add_flag("--artist-lights", o.artist_lights,
                     "Points, spots, directional lights and suns, also the scene's, are pi times as bright: a light of "
                     "intensity 1 makes a white surface at distance 1 as bright as 1, as many modelling programs do");
    group.next("Light");
    command
        .add_option_function<std::string>(
            "--sky", [&o](const std::string& text) { o.sky = parse_sky(text); },
            "Radiance from where no surface is: R,G,B, or R,G,B,R,G,B from horizon to zenith")
        ->type_name("R,G,B");
    group.next("More light");
    command.add_option_function<std::string>(
        "--fog", [&o](const std::string& text) { o.fog = parse_fog(text); },
        "Fog between the surfaces: DENSITY,R,G,B[,DEPTH]. exp(-DENSITY d) of the light is left after d units; DEPTH "
        "lies before the sky [0]");
    group.next("Light");
    command
        .add_option(
            "--environment", o.environment,
            "An image round the scene, in place of the sky: latitude and longitude, or a folder with px nx py ny pz nz")
        ->type_name(file_value);
    group.next("More light");
    command
        .add_option_function<std::string>(
            "--studio",
            [&o](const std::string& text) {
                const std::vector<float> numbers = parse_numbers(text);
                if (numbers.size() != 3 || numbers == std::vector<float>(3))
                    refuse("--studio: '" + text + "' is not a direction", "write X,Y,Z");
                o.studio = {numbers[0], numbers[1], numbers[2]};
            },
            "The neutral studio that files without light get, for a camera that looks along X,Y,Z, whatever the file "
            "has")
        ->type_name("X,Y,Z");
    command.add_option("--environment-strength", o.strength, "Its radiance times this [1]")->check(number_from_0());
    command.add_option("--environment-rotation", o.rotation, "Turns it by degrees, counter-clockwise from above [0]")
        ->check(finite_number());
}

bool add_lights(Scene& scene, const LightOptions& options) {
    if ((options.strength || options.rotation) && options.environment.empty())
        refuse("--environment-strength and --environment-rotation change an environment",
               "name it by --environment FILE");
    scene.lights.insert(scene.lights.end(), options.lights.begin(), options.lights.end());
    if (options.artist_lights)
        for (Light& light : scene.lights) light.intensity *= std::numbers::pi_v<float>;
    if (options.sky) {
        scene.sky.horizon = options.sky->horizon, scene.sky.zenith = options.sky->zenith;
        scene.environment = {};
    }
    if (options.fog) {
        const Sky& fog = *options.fog;
        scene.sky.fog_color = fog.fog_color, scene.sky.fog_density = fog.fog_density;
        scene.sky.fog_depth = fog.fog_depth;
    }
    if (options.studio && (options.sky || !options.environment.empty()))
        refuse("--studio replaces sky and environment", "leave out --sky and --environment");
    if (options.environment.empty()) return options.sky || options.studio || !options.lights.empty();
    Warnings warnings;
    scene.environment = load_environment(options.environment, warnings);
    for (const std::string& warning : warnings) print_warning(warning);
    scene.environment.strength = options.strength.value_or(1.f);
    scene.environment.rotation = degree * options.rotation.value_or(0.f);
    return true;
}

void add_studio(Scene& scene, const LightOptions& options) {
    if (!options.studio) return;
    Camera camera;
    camera.position = glm::vec3(0), camera.target = *options.studio, camera.up = camera_of(scene).up;
    scene.environment = studio(camera);
}

}  // namespace claray::cli
