// The path tracer against Blender's Cycles on the same CPU and scene, by turns:
//   bench_cycles [--scene FILE...] [--rounds N] [--spp N] [--size N] [--threads N] [--images FOLDER] [--csv FILE]
// Everything is grey and diffuse, lit by a point and a constant sky, with 4 bounces. Times are those of rendering
// alone: neither loading, nor building trees, nor compiling kernels. Cycles' is the line "Path Tracing" of its own
// report.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/support.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device = "cpu", csv, images, blender = "blender", script = CLARAY_CYCLES_SCRIPT;
    std::vector<std::string> scenes;
    unsigned size = 256, spp = 64, bounces = 4, threads = 2, rounds = 5;
};

constexpr float albedo = 0.7f, sky_radiance = 0.5f;
constexpr double pi = 3.14159265358979;

/// Camera and light, from the centre of the scene in units of its largest extent.
struct View {
    glm::vec3 camera, target, light;
    float fov;        // degrees
    float intensity;  // of the light; the irradiance at distance 1
};

View view_of(const std::string& path) {
    const std::string stem = std::filesystem::path(path).stem().string();
    if (stem.find("cornell") != std::string::npos) return {{0, 0, 1.9f}, {0, 0, 0}, {0, 0.3f, 0.1f}, 40, 0.3f};
    if (stem.find("sponza") != std::string::npos)
        return {{-0.33f, -0.11f, 0.01f}, {0.2f, -0.06f, -0.06f}, {0.06f, 0.15f, 0}, 75, 0.04f};
    return {{0.4f, 0.3f, 1.4f}, {0, 0, 0}, {0.5f, 1, 1}, 45, 1};
}

/// Leaves out triangles that are there twice (cornell.obj has such): Cycles shadows each by the other.
std::vector<glm::uvec3> without_twins(const Mesh& mesh) {
    const auto corners = [&](const glm::uvec3& triangle) {
        std::array<std::array<float, 3>, 3> points;
        for (int i = 0; i < 3; ++i) {
            const glm::vec3 p = mesh.positions[triangle[i]];
            points[i] = {p.x, p.y, p.z};
        }
        std::sort(points.begin(), points.end());
        return points;
    };
    std::set<std::array<std::array<float, 3>, 3>> seen;
    std::vector<glm::uvec3> kept;
    for (const glm::uvec3& triangle : mesh.triangles)
        if (seen.insert(corners(triangle)).second) kept.push_back(triangle);
    return kept;
}

/// One mesh without normals of its own, of one material.
Scene grey_scene(const std::string& path) {
    Warnings warnings;
    const Scene loaded = load_scene(path, warnings);
    if (!loaded.instances.empty()) throw Error(ErrorKind::usage, path + " has instances", "choose another scene");
    Scene scene;
    Mesh mesh;
    for (const Mesh& part : loaded.meshes) {
        const auto base = std::uint32_t(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
        for (const glm::uvec3& triangle : part.triangles) mesh.triangles.push_back(triangle + base);
    }
    mesh.triangles = without_twins(mesh);
    const Bounds bounds = bounds_of(mesh);
    scene.meshes = {std::move(mesh)};
    Material grey;
    grey.albedo = glm::vec3(albedo);
    scene.materials = {grey};
    const View view = view_of(path);
    const glm::vec3 extents = bounds.extent();
    const float extent = std::max({extents.x, extents.y, extents.z});
    const auto place = [&](const glm::vec3& at) { return bounds.center() + extent * at; };
    Camera camera;
    camera.position = place(view.camera), camera.target = place(view.target), camera.vertical_fov = view.fov;
    scene.camera = camera;
    scene.lights = {point_light(place(view.light), glm::vec3(view.intensity * extent * extent))};
    scene.sky.horizon = scene.sky.zenith = glm::vec3(sky_radiance);
    return scene;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), sizeof(T) * values.size()};
}

/// Rows of a 4x4 matrix. Blender's cameras look along -z.
nlohmann::json camera_to_world(const Camera& camera) {
    const glm::vec3 back = glm::normalize(camera.position - camera.target);
    const glm::vec3 right = glm::normalize(glm::cross(camera.up, back)), up = glm::cross(back, right);
    nlohmann::json rows = nlohmann::json::array();
    for (int i = 0; i < 3; ++i) rows.push_back({right[i], up[i], back[i], camera.position[i]});
    rows.push_back({0, 0, 0, 1});
    return rows;
}

/// What render.py reads.
void write_scene(const std::filesystem::path& folder, const Scene& scene, const Options& options) {
    const Mesh& mesh = scene.meshes[0];
    write_file(folder / "positions.f32", bytes_of(mesh.positions));
    write_file(folder / "corners.u32", bytes_of(mesh.triangles));
    const Light& light = scene.lights[0];
    const glm::vec3 extents = bounds_of(mesh).extent();
    const nlohmann::json view = {
        {"width", options.size},
        {"height", options.size},
        {"spp", options.spp},
        {"bounces", options.bounces},
        {"threads", options.threads},
        {"albedo", albedo},
        {"sky", sky_radiance},
        {"light", {light.position.x, light.position.y, light.position.z}},
        {"light_watts", 4 * pi * light.intensity.x},  // Blender: power P of a point is intensity P / (4 pi)
        {"fov", scene.camera->vertical_fov * pi / 180},
        {"extent", std::max({extents.x, extents.y, extents.z})},
        {"camera_to_world", camera_to_world(*scene.camera)},
    };
    write_file(folder / "view.json", view.dump(1));
}

struct Render {
    double seconds = 0, processor_seconds = 0;  // of the clock, and of all threads
    std::vector<double> luminance;              // a pixel each
};

std::vector<double> luminances(const std::vector<glm::vec3>& pixels) {
    std::vector<double> values;
    for (const glm::vec3& pixel : pixels) values.push_back((double(pixel.x) + pixel.y + pixel.z) / 3);
    return values;
}

void keep_image(const Options& options, const std::string& name, const std::vector<glm::vec3>& pixels) {
    if (options.images.empty()) return;
    for (const char* ending : {".pfm", ".png"})
        write_image(std::filesystem::path(options.images) / (name + ending), {options.size, options.size, pixels}, 0,
                    ToneMap::none);
}

Render render_claray(const Device& device, const Scene& scene, const Options& options, std::uint32_t seed,
                     const std::string& name) {
    // A path that is scattered `bounces` times is lit directly at one surface more.
    Renderer renderer(device, scene,
                      {.width = options.size,
                       .height = options.size,
                       .spp = options.spp,
                       .max_depth = options.bounces + 1,
                       .seed = seed});
    device.finish();
    Render result;
    const std::clock_t begin = std::clock();
    result.seconds = renderer.render().seconds;
    result.processor_seconds = double(std::clock() - begin) / CLOCKS_PER_SEC;
    const std::vector<glm::vec3> image = renderer.image();
    keep_image(options, name + ".claray", image);
    result.luminance = luminances(image);
    return result;
}

/// Runs a command and returns what it prints.
std::string output_of(const std::string& command) {
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    if (!pipe) throw Error(ErrorKind::user, "cannot run '" + command + "'", "check the shell");
    std::string text;
    char part[4096];
    while (const std::size_t n = std::fread(part, 1, sizeof part, pipe)) text.append(part, n);
    pclose(pipe);
    return text;
}

/// The number behind the last occurrence of `label`.
double number_after(const std::string& text, const std::string& label) {
    const std::size_t at = text.rfind(label);
    if (at == std::string::npos)
        throw Error(ErrorKind::user, "Blender printed no '" + label + "'; it printed: " + text.substr(0, 2000),
                    "install Debian's blender 3.4, or give --blender");
    return std::strtod(text.c_str() + at + label.size(), nullptr);
}

Render render_cycles(const std::filesystem::path& folder, const Options& options, unsigned seed,
                     const std::string& name) {
    const std::filesystem::path image = folder / "cycles.pfm";
    const std::string text =
        output_of(options.blender + " -b --factory-startup --debug-cycles --verbose 2 --python '" + options.script +
                  "' -- '" + folder.string() + "' " + std::to_string(seed) + " '" + image.string() + "'");
    Render result;
    result.processor_seconds = number_after(text, "\nprocessor seconds ");
    result.seconds = number_after(text, "\n          Path Tracing ");
    const Texture picture = load_image(image);
    std::vector<glm::vec3> pixels(std::size_t(picture.width) * picture.height);
    std::memcpy(pixels.data(), picture.floats.data(), sizeof(glm::vec3) * pixels.size());
    keep_image(options, name + ".cycles", pixels);
    result.luminance = luminances(pixels);
    return result;
}

/// Every pixel's mean over the rounds, and the variance of that mean.
struct Estimate {
    std::vector<double> mean, variance;
    explicit Estimate(const std::vector<Render>& renders) {
        const std::size_t pixels = renders[0].luminance.size();
        const auto n = double(renders.size());
        for (std::size_t i = 0; i < pixels; ++i) {
            double sum = 0, squares = 0;
            for (const Render& r : renders) sum += r.luminance[i];
            for (const Render& r : renders) squares += std::pow(r.luminance[i] - sum / n, 2);
            mean.push_back(sum / n), variance.push_back(squares / (n - 1) / n);
        }
    }
};

double sum_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum;
}

struct Comparison {
    double mean_ratio = 0;   // of the images' mean radiance, ours over theirs
    double excess = 0;       // squared difference of the images over their variances: 1 where noise is all
    double outliers = 0;     // share of pixels that differ by more than 3 standard errors
    double noise_ratio = 0;  // of the images' variances, ours over theirs
};

Comparison compare(const Estimate& ours, const Estimate& theirs) {
    double squares = 0, outside = 0;
    for (std::size_t i = 0; i < ours.mean.size(); ++i) {
        const double square = std::pow(ours.mean[i] - theirs.mean[i], 2);
        squares += square, outside += square > 9 * (ours.variance[i] + theirs.variance[i]);
    }
    const double our_variance = sum_of(ours.variance), their_variance = sum_of(theirs.variance);
    return {sum_of(ours.mean) / sum_of(theirs.mean), squares / (our_variance + their_variance),
            outside / double(ours.mean.size()), our_variance / their_variance};
}

double median_of(const std::vector<Render>& renders, double Render::*member) {
    std::vector<double> values;
    for (const Render& render : renders) values.push_back(render.*member);
    return measure::median(values);
}

/// Median of the rounds' ratios, theirs over ours.
double paired_ratio(const std::vector<Render>& ours, const std::vector<Render>& theirs, double Render::*member) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < ours.size(); ++i) ratios.push_back(theirs[i].*member / (ours[i].*member));
    return measure::median(ratios);
}

/// Whether the images agree.
bool run(const Device& device, const std::string& path, const Options& options, measure::Csv& csv) {
    const Scene scene = grey_scene(path);
    const std::string name = std::filesystem::path(path).stem().string();
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("claray_cycles_" + std::to_string(getpid()) + name);
    std::filesystem::create_directories(folder);
    write_scene(folder, scene, options);
    (void)render_claray(device, scene, options, 0, name);  // compiles the kernels
    std::vector<Render> ours, theirs;
    for (unsigned round = 1; round <= options.rounds; ++round) {
        ours.push_back(render_claray(device, scene, options, round, name));
        theirs.push_back(render_cycles(folder, options, round, name));
    }
    std::filesystem::remove_all(folder);
    const double samples = double(options.size) * options.size * options.spp * 1e-6;
    const double our_rate = samples / median_of(ours, &Render::seconds);
    const double their_rate = samples / median_of(theirs, &Render::seconds);
    const double ratio = paired_ratio(ours, theirs, &Render::seconds);
    const double processor_ratio = paired_ratio(ours, theirs, &Render::processor_seconds);
    const Comparison images = compare(Estimate(ours), Estimate(theirs));
    std::printf("%-10s %8.3f %8.3f %8.2f %10.2f   %8.5f %8.3f %9.3f %% %8.2f\n", name.c_str(), our_rate, their_rate,
                ratio, processor_ratio, images.mean_ratio, images.excess, 100 * images.outliers, images.noise_ratio);
    std::fflush(stdout);
    csv.row(name, options.size, options.spp, options.bounces, options.rounds, our_rate, their_rate, ratio,
            processor_ratio, images.mean_ratio, images.excess, images.outliers, images.noise_ratio);
    csv.write();
    return std::abs(images.mean_ratio - 1) <= 0.005 && images.excess <= 1.1;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("The path tracer against Blender's Cycles");
    Options options;
    app.add_option("--device", options.device);
    app.add_option("--scene", options.scenes, "meshes; cornell.obj and sponza.obj have views of their own")->required();
    app.add_option("--size", options.size, "pixels a side [256]");
    app.add_option("--spp", options.spp, "samples a pixel [64]");
    app.add_option("--bounces", options.bounces, "[4]");
    app.add_option("--threads", options.threads, "of Cycles [2]; PoCL takes POCL_MAX_PTHREAD_COUNT");
    app.add_option("--rounds", options.rounds, "[5]")->check(CLI::Range(2, 1000));
    app.add_option("--blender", options.blender, "the program [blender]");
    app.add_option("--script", options.script, "bench/cycles/render.py");
    app.add_option("--images", options.images, "folder for the last round's images");
    app.add_option("--csv", options.csv, "write the result to FILE");
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.device);
    std::printf("%s, %ux%u, %u samples a pixel, %u bounces, %u rounds\n", device.info().name.c_str(), options.size,
                options.size, options.spp, options.bounces, options.rounds);
    std::printf("%-10s %8s %8s %8s %10s   %8s %8s %11s %8s\n", "scene", "claray", "Cycles", "ratio", "processor",
                "means", "excess", "beyond 3se", "noise^2");
    measure::Csv csv(options.csv, device,
                     "scene,size,spp,bounces,rounds,claray_msamples_per_s,cycles_msamples_per_s,ratio,processor_ratio,"
                     "mean_ratio,excess,beyond_3_se,variance_ratio");
    bool agree = true;
    for (const std::string& scene : options.scenes) agree &= run(device, scene, options, csv);
    std::printf("images %s\n", agree ? "agree" : "DIFFER");
    return agree ? 0 : 1;
} catch (const Error& error) {
    std::fprintf(stderr, "bench_cycles: %s\n", error.what());
    return int(error.kind());
}
