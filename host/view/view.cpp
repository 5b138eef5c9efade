#include "host/view/view.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "host/base/format.hpp"
#include "host/effects/effects.hpp"
#include "host/view/camera_control.hpp"

namespace claray::view {
namespace {

using Clock = std::chrono::steady_clock;

constexpr float most_pixels_a_side = 16384;

[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
    throw Error(ErrorKind::user, what, remedy);
}

Scene with_camera(Scene scene, const RenderConfig& config) {
    const float aspect = float(config.width) / float(config.height);
    if (!scene.camera) scene.camera = automatic_camera(bounds_of(scene), 40.f, aspect);
    return scene;
}

std::string name_of(const std::string& name, std::size_t number) {
    return name.empty() ? std::to_string(number) : "'" + name + "'";
}

std::string effects_of_material(const Scene& scene, const Material& material) {
    Scene one;
    one.materials = {material};
    one.textures = scene.textures;
    one.meshes.resize(1);
    one.meshes[0].positions.resize(3), one.meshes[0].triangles = {{0, 1, 2}};
    return to_string(effects_of(one));
}

float distance_from_segment(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b) {
    const glm::vec3 along = b - a;
    const float square = glm::dot(along, along);
    const float t = square > 0 ? std::clamp(glm::dot(p - a, along) / square, 0.f, 1.f) : 0.f;
    return glm::length(p - a - t * along);
}

float distance_from_triangle(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 normal = glm::cross(b - a, c - a);
    const auto inside = [&](const glm::vec3& from, const glm::vec3& to) {
        return glm::dot(glm::cross(to - from, p - from), normal) >= 0;
    };
    if (inside(a, b) && inside(b, c) && inside(c, a) && glm::length(normal) > 0)
        return std::abs(glm::dot(p - a, glm::normalize(normal)));
    return std::min({distance_from_segment(p, a, b), distance_from_segment(p, b, c), distance_from_segment(p, c, a)});
}

/// Colours of a picture by the exact sRGB curve.
std::vector<std::uint8_t> encoded(const Image& image) {
    std::vector<std::uint8_t> bytes;
    for (const glm::vec3& c : image.pixels)
        bytes.insert(bytes.end(), {srgb_from_linear(c.x), srgb_from_linear(c.y), srgb_from_linear(c.z), 255});
    return bytes;
}

Image image_of(const Aovs& aovs, const std::string& shows, unsigned width, unsigned height) {
    if (shows == "depth") return false_color(width, height, aovs.depth);
    if (shows == "primitive") return identifier_color(width, height, aovs.primitive);
    if (shows == "heat") return false_color(width, height, {aovs.visits.begin(), aovs.visits.end()});
    Image image{width, height, aovs.albedo};
    if (shows == "normal")
        for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = 0.5f * (aovs.normal[i] + 1.f);
    return image;
}

}  // namespace

View::View(const Device& device, Scene scene, const ViewConfig& config)
    : device_(device),
      scene_(with_camera(std::move(scene), config.render)),
      config_(config),
      home_(*scene_.camera),
      renderer_(std::make_unique<Renderer>(device, scene_, config.render)) {}

float View::size() const {
    const Bounds bounds = bounds_of(scene_);
    return bounds.empty() ? 1.f : std::max(glm::length(bounds.extent()), 1e-6f);
}

template <class Part, class Edit>
void View::change(std::vector<Part> Scene::*part, const SceneChanges& changes, const Edit& edit) {
    std::vector<Part> before = scene_.*part;
    try {
        edit(scene_.*part);
        renderer_->update(scene_, changes);
    } catch (...) {
        scene_.*part = std::move(before);
        throw;
    }
    spp_ = 0;
}

void View::set_camera(const Camera& camera) {
    Scene with;
    with.camera = camera;
    (void)camera_data(camera, 1.f);  // throws for one that cannot be used
    renderer_->update(with, {.camera = true});
    scene_.camera = camera;
    spp_ = 0;
}

void View::render(double seconds) {
    const Clock::time_point begin = Clock::now();
    const auto goes_on = [&](const RenderProgress& progress) {
        return progress.spp == 0 || std::chrono::duration<double>(Clock::now() - begin).count() < seconds;
    };
    spp_ = renderer_->render(goes_on).spp;
}

/// A view that is paused takes the first samples all the same: an image without any shows nothing.
std::span<const std::uint8_t> View::shown() {
    if (spp_ == 0) render(0);
    if (shows_ == "image") return renderer_->picture(config_.picture);
    false_colors_ = encoded(image_of(renderer_->aovs(), shows_, config_.render.width, config_.render.height));
    return false_colors_;
}

const Frame& View::next_frame() {
    if (!paused_ && spp_ < config_.render.spp) render(config_.frame_seconds);
    frame_ = {config_.render.width, config_.render.height, shown(), spp_, paused_ || spp_ >= config_.render.spp};
    return frame_;
}

const Frame& View::complete_frame() {
    paused_ = false;
    while (spp_ < config_.render.spp) render(config_.frame_seconds);
    return next_frame();
}

std::string View::run(const ViewCommand& command) {
    static const std::map<std::string, Handler> handlers = {
        {"orbit", &View::move_camera},     {"turn", &View::move_camera},  {"pan", &View::move_camera},
        {"fly", &View::move_camera},       {"zoom", &View::move_camera},  {"home", &View::move_camera},
        {"focus", &View::focus},           {"aperture", &View::set_lens}, {"exposure", &View::set_picture},
        {"tone", &View::set_picture},      {"show", &View::show},         {"pick", &View::pick},
        {"material", &View::set_material}, {"light", &View::move_light},  {"move", &View::move_object},
        {"time", &View::set_time},         {"resize", &View::resize},     {"pause", &View::control},
        {"camera", &View::control},        {"quit", &View::control},      {"save", &View::save},
        {"frames", &View::control},        {"finish", &View::control}};
    try {
        return (this->*handlers.at(command.name))(command);
    } catch (const Error& error) {
        // What would be a wrong call of the library is here a wrong value of the user's.
        if (error.kind() != ErrorKind::usage) throw;
        throw Error(ErrorKind::user, command.name + ": " + error.what());
    }
}

std::string View::move_camera(const ViewCommand& command) {
    const std::vector<float>& n = command.numbers;
    const Camera& now = *scene_.camera;
    if (command.name == "home") set_camera(home_);
    if (command.name == "orbit") set_camera(orbit(now, n[0], n[1]));
    if (command.name == "turn") set_camera(turn(now, n[0], n[1]));
    if (command.name == "pan") set_camera(pan(now, n[0], n[1]));
    if (command.name == "zoom") set_camera(zoom(now, n[0]));
    if (command.name == "fly") {
        const float unit = 0.01f * size();
        set_camera(fly(now, unit * n[0], unit * n[1], unit * n[2]));
    }
    return {};
}

std::size_t View::pixel_of(const ViewCommand& command) const {
    const float x = command.numbers[0], y = command.numbers[1];
    const auto width = float(config_.render.width), height = float(config_.render.height);
    if (!(x >= 0 && y >= 0 && x < width && y < height))
        refuse(
            printed("pixel %g %g is outside the image of %gx%g", double(x), double(y), double(width), double(height)),
            "count from 0 at the top left");
    return std::size_t(y) * config_.render.width + std::size_t(x);
}

std::string View::focus(const ViewCommand& command) {
    const std::size_t pixel = pixel_of(command);
    const float depth = renderer_->aovs().depth[pixel];
    if (!std::isfinite(depth)) return "no surface there";
    Camera camera = *scene_.camera;
    const glm::vec3 forward = glm::normalize(camera.target - camera.position);
    // The view keeps its direction: only the distance of the target becomes that of the surface.
    camera.target = camera.position + glm::dot(point_at(pixel, depth) - camera.position, forward) * forward;
    camera.focus_distance = 0.f;
    set_camera(camera);
    return printed("distance %.6g", double(depth));
}

std::string View::set_lens(const ViewCommand& command) {
    Camera camera = *scene_.camera;
    camera.aperture_radius = command.numbers[0];
    set_camera(camera);
    return {};
}

std::string View::set_picture(const ViewCommand& command) {
    if (command.name == "exposure") {
        config_.picture.exposure = std::clamp(config_.picture.exposure + command.numbers[0], -64.f, 64.f);
        return printed("exposure %g", double(config_.picture.exposure));
    }
    if (command.word != "none" && command.word != "aces")
        refuse("tone: unknown tone map '" + command.word + "'", "use none or aces");
    config_.picture.tone_map = command.word == "none" ? ToneMap::none : ToneMap::aces;
    return {};
}

std::string View::show(const ViewCommand& command) {
    for (const char* name : {"image", "depth", "normal", "albedo", "primitive", "heat"})
        if (command.word == name) {
            shows_ = name;
            return {};
        }
    refuse("show: unknown name '" + command.word + "'", "use image, depth, normal, albedo, primitive or heat");
}

glm::vec3 View::point_at(std::size_t pixel, float depth) const {
    const unsigned width = config_.render.width, height = config_.render.height;
    const CameraData data = camera_data(*scene_.camera, float(width) / float(height));
    return point_through(data, unsigned(pixel % width), unsigned(pixel / width), width, height, depth);
}

/// Triangles are counted through the meshes of the scene, in order. Of the instances of a mesh, the one whose triangle
/// is nearest to the point is meant.
View::Selection View::selection_of(std::uint32_t triangle, const glm::vec3& point) const {
    Selection found;
    std::size_t first = 0;
    while (triangle - first >= scene_.meshes[found.mesh].triangles.size())
        first += scene_.meshes[found.mesh++].triangles.size();
    const Mesh& mesh = scene_.meshes[found.mesh];
    found.triangle = std::uint32_t(triangle - first);
    found.material = mesh.materials.empty() ? 0 : mesh.materials[found.triangle];
    const glm::uvec3 corners(mesh.triangles[found.triangle]);
    float nearest = std::numeric_limits<float>::infinity();
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
        if (scene_.instances[i].mesh != found.mesh) continue;
        const glm::mat4& transform = scene_.instances[i].transform;
        const auto corner = [&](unsigned k) { return glm::vec3(transform * glm::vec4(mesh.positions[corners[k]], 1)); };
        const float distance = distance_from_triangle(point, corner(0), corner(1), corner(2));
        if (!found.instance || distance < nearest) found.instance = i, nearest = distance;
    }
    return found;
}

std::string View::pick(const ViewCommand& command) {
    const std::size_t pixel = pixel_of(command);
    const Aovs aovs = renderer_->aovs();
    if (aovs.primitive[pixel] == CLARAY_MISS) {
        selected_.reset();
        return "no surface there";
    }
    selected_ = selection_of(aovs.primitive[pixel], point_at(pixel, aovs.depth[pixel]));
    const Material& material = scene_.materials[selected_->material];
    return "mesh " + name_of(scene_.meshes[selected_->mesh].name, selected_->mesh) + ", triangle " +
           std::to_string(selected_->triangle) + ", material " + name_of(material.name, selected_->material) + " (" +
           effects_of_material(scene_, material) + "), distance " + printed("%.6g", double(aovs.depth[pixel])) + ", " +
           std::to_string(aovs.visits[pixel]) + " boxes and triangles tested";
}

std::string View::set_material(const ViewCommand& command) {
    if (!selected_) refuse("material: nothing is selected", "select an object with pick X Y");
    const std::vector<float>& n = command.numbers;
    const std::map<std::string, glm::vec3 Material::*> colors = {{"albedo", &Material::albedo},
                                                                 {"emission", &Material::emission}};
    const std::map<std::string, float Material::*> values = {{"roughness", &Material::roughness},
                                                             {"metallic", &Material::metallic},
                                                             {"ior", &Material::ior},
                                                             {"transmission", &Material::transmission}};
    change(&Scene::materials, {.materials = true}, [&](std::vector<Material>& materials) {
        Material& material = materials[selected_->material];
        if (const auto color = colors.find(command.word); color != colors.end())
            material.*color->second = {n[0], n[1], n[2]};
        else if (const auto value = values.find(command.word); value != values.end())
            material.*value->second = n[0];
        else
            refuse("material: unknown value '" + command.word + "'",
                   "use albedo, emission, roughness, metallic, ior or transmission");
    });
    return {};
}

std::string View::move_light(const ViewCommand& command) {
    const std::vector<float>& n = command.numbers;
    if (!(n[0] >= 0 && n[0] < float(scene_.lights.size())))
        refuse(printed("light: there is no light %g", double(n[0])),
               printed("the scene has %zu lights; count from 0", scene_.lights.size()));
    change(&Scene::lights, {.lights = true},
           [&](std::vector<Light>& lights) { lights[std::size_t(n[0])].position += glm::vec3(n[1], n[2], n[3]); });
    return {};
}

std::string View::move_object(const ViewCommand& command) {
    if (!selected_) refuse("move: nothing is selected", "select an object with pick X Y");
    if (!selected_->instance)
        refuse("move: the scene has no instances", "use a file whose objects are placed, as glTF does");
    const std::vector<float>& n = command.numbers;
    const glm::vec4 way(n[0], n[1], n[2], 0.f);
    change(&Scene::instances, {.instances = true}, [&](std::vector<MeshInstance>& instances) {
        MeshInstance& instance = instances[*selected_->instance];
        instance.transform[3] += way;
        if (instance.transform_end) (*instance.transform_end)[3] += way;
    });
    return {};
}

std::string View::set_time(const ViewCommand& command) {
    if (!config_.at_time) refuse("time: the scene is not animated", "use a glTF file with an animation");
    Scene then = config_.at_time(command.numbers[0]);
    then.camera = scene_.camera, then.materials = scene_.materials;
    renderer_->update(then, {.lights = true, .instances = true, .vertices = true});
    scene_ = std::move(then);
    spp_ = 0;
    return {};
}

/// The new renderer finds the kernels in memory.
std::string View::resize(const ViewCommand& command) {
    const float width = std::floor(command.numbers[0]), height = std::floor(command.numbers[1]);
    if (!(width >= 1 && height >= 1 && width <= most_pixels_a_side && height <= most_pixels_a_side))
        refuse(printed("resize: the image cannot have %gx%g pixels", double(width), double(height)),
               "use 1 to 16384 per side");
    RenderConfig config = config_.render;
    config.width = unsigned(width), config.height = unsigned(height);
    renderer_ = std::make_unique<Renderer>(device_, scene_, config);
    config_.render = config;
    spp_ = 0;
    return {};
}

/// `frames` and `finish` are for the loops that call next_frame.
std::string View::control(const ViewCommand& command) {
    if (command.name == "camera") return options_of(*scene_.camera);
    if (command.name == "pause") {
        paused_ = !paused_;
        return paused_ ? "paused" : "continued";
    }
    if (command.name == "quit") ended_ = true;
    return {};
}

std::string View::save(const ViewCommand& command) {
    const std::span<const std::uint8_t> pixels = shown();
    Texture texture;
    texture.width = config_.render.width, texture.height = config_.render.height, texture.channels = 3;
    texture.format = TexelFormat::srgb8;
    for (std::size_t i = 0; i < pixels.size(); ++i)
        if (i % 4 != 3) texture.bytes.push_back(pixels[i]);
    write_texture(command.word, texture);
    return "wrote " + command.word;
}

}  // namespace claray::view
