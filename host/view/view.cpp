#include "host/view/view.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <utility>

#include "host/base/format.hpp"
#include "host/base/seconds_since.hpp"
#include "host/view/camera_control.hpp"
#include "host/view/edit/scene_edits.hpp"
#include "host/view/false_colors.hpp"
#include "host/view/refuse.hpp"

namespace claray::view {
namespace {

using Clock = std::chrono::steady_clock;

constexpr float most_pixels_a_side = 16384;
constexpr std::size_t most_pixels = 4096 * 4096;  // more than displays of 5120x2880 have
constexpr double least_share = 0.25;              // of a frame's time that is spent on sampling
constexpr double longest_slice = 0.01;            // seconds from one look at what interrupts to the next

Scene prepared(Scene scene, const RenderConfig& config) {
    place_all(scene);
    scene.camera = camera_of(scene, float(config.width) / float(config.height));
    return scene;
}

bool have_same_vertices(const Scene& a, const Scene& b) {
    return std::equal(
        a.meshes.begin(), a.meshes.end(), b.meshes.begin(), b.meshes.end(),
        [](const Mesh& m, const Mesh& n) { return m.positions == n.positions && m.normals == n.normals; });
}

}  // namespace

void require_live_size(unsigned width, unsigned height) {
    if (std::size_t(width) * height > most_pixels)
        refuse(printed("%ux%u pixels are too many for a live view", width, height),
               "use at most 16.7 million, for example 5120x2880");
}

/// The first picture is made at once, so that no answer to a command waits for a kernel to be compiled, or for what
/// drivers do at its first run.
View::View(const Device& device, Scene scene, const ViewConfig& config)
    : device_(device),
      scene_(prepared(std::move(scene), config.render)),
      config_(config),
      home_(*scene_.camera),
      renderer_(std::make_unique<Renderer>(device, scene_, config_.render)),
      preview_(config_.answer_seconds),
      time_(config.animation.time) {
    (void)shown_frame();
    renderer_->load_kernels();
}

float View::size() const {
    const Bounds bounds = bounds_of(scene_);
    return bounds.empty() ? 1.f : std::max(glm::length(bounds.extent()), 1e-6f);
}

void View::set_camera(const Camera& camera) {
    Scene with;
    with.camera = camera;
    (void)camera_data(camera, 1.f);  // throws for one that cannot be used
    renderer_->update(with, {.camera = true});
    scene_.camera = camera;
    spp_ = 0;
}

Renderer& View::complete_renderer() {
    if (std::exchange(previewing_, false)) renderer_->resize(config_.render.width, config_.render.height), spp_ = 0;
    return *renderer_;
}

/// Frames that are denoised together have samples of their own: equal ones would have the same noise.
void View::render(double seconds, const Interrupted& interrupted) {
    const Clock::time_point begin = Clock::now();
    Renderer& renderer = complete_renderer();
    double noise = 0;
    if (spp_ == 0) {
        if (denoises_) renderer.restart(++seed_);
        const auto goes_on = [&](const RenderProgress&) { return !interrupted(); };
        const RenderProgress first = interrupted ? renderer.render_for(0, goes_on) : renderer.render_for(0);
        spp_ = first.spp, noise = first.noise;
        if (spp_ == 0) return;  // not every pixel has a sample
        preview_.complete_took(seconds_since(begin));
        curve_ = {}, ++run_;
    }
    for (double left = seconds - seconds_since(begin); left > 0; left = seconds - seconds_since(begin)) {
        const RenderProgress progress = renderer.render_for(interrupted ? std::min(left, longest_slice) : left);
        spp_ = progress.spp, noise = progress.noise;
        if (spp_ >= config_.render.spp || (interrupted && interrupted())) break;
    }
    curve_.add(seconds_since(begin), spp_, noise);
}

bool View::wants_preview() const { return !paused_ && !denoises_ && shows_ == "image" && preview_.is_smaller(); }

/// One sample for each pixel of an image that is ready in a part of the time.
void View::preview() {
    const Clock::time_point begin = Clock::now();
    const double scale = preview_.scale();
    renderer_->resize(unsigned(std::ceil(scale * config_.render.width)),
                      unsigned(std::ceil(scale * config_.render.height)));
    previewing_ = true;
    spp_ = renderer_->render_for(0).spp;
    preview_.preview_took(seconds_since(begin));
}

/// The time that the picture of the last frame and its display took is not available for sampling. The first frame
/// after a change takes the least time, since it is an answer.
void View::sample_frame(const Interrupted& interrupted) {
    const double others = seconds_since(sampled_at_);
    const double least = least_share * config_.frame_seconds;
    render(spp_ == 0 ? least : std::max(config_.frame_seconds - others, least), interrupted);
    sampled_at_ = Clock::now();
}

/// A view that is paused takes the first samples all the same: an image without any shows nothing.
std::span<const std::uint8_t> View::shown() {
    if (previewing_ && (shows_ != "image" || denoises_)) (void)complete_renderer();
    if (spp_ == 0) render(0);
    PictureConfig picture = config_.picture;
    if (previewing_) picture.width = config_.render.width, picture.height = config_.render.height;
    const unsigned width = config_.render.width, height = config_.render.height;
    if (shows_ == "image") return denoises_ ? renderer_->denoised_picture(picture) : renderer_->picture(picture);
    false_colors_ = encoded(shows_ == "error" ? error_map(renderer_->noise_map(), int(width), int(height))
                                              : picture_of(renderer_->aovs(), shows_, width, height));
    return false_colors_;
}

const Frame& View::shown_frame() {
    const bool moves = playing_ || spin_ != 0 || previewing_;
    const bool complete = rests() || (!moves && spp_ >= config_.render.spp);
    frame_ = {config_.render.width, config_.render.height, shown(), spp_, complete, frame_.number + 1};
    return frame_;
}

/// What measures shares the device with nothing else.
bool View::rests() const { return paused_ || costs_.is_running(); }

const Frame& View::next_frame(const Interrupted& interrupted) {
    if (playing_) pass_time();
    if (spin_ != 0) pass_spin();
    if (costs_.is_running()) take_costs();
    const bool answers = spp_ == 0;
    if (answers && wants_preview())
        preview();
    else if (!rests() && (previewing_ || spp_ < config_.render.spp))
        sample_frame(interrupted);
    const bool waits = !answers && interrupted && interrupted();  // then no better picture of the same is needed
    if ((spp_ > 0 || rests()) && !waits) return shown_frame();
    frame_.complete = false;
    return frame_;
}

const Frame& View::complete_frame() {
    paused_ = false;
    while (previewing_ || spp_ < config_.render.spp) render(config_.frame_seconds);
    return shown_frame();
}

std::string View::run(const ViewCommand& command) {
    static const std::map<std::string, Handler> handlers = {
        {"orbit", &View::move_camera},   {"turn", &View::move_camera},    {"pan", &View::move_camera},
        {"fly", &View::move_camera},     {"zoom", &View::move_camera},    {"home", &View::move_camera},
        {"look", &View::move_camera},    {"spin", &View::control},        {"focus", &View::focus},
        {"aperture", &View::set_lens},   {"fov", &View::set_lens},        {"exposure", &View::set_exposure},
        {"stops", &View::set_exposure},  {"tone", &View::choose},         {"show", &View::choose},
        {"denoise", &View::choose},      {"pick", &View::pick},           {"material", &View::set_material},
        {"light", &View::move_light},    {"lamp", &View::set_light},      {"move", &View::move_object},
        {"rotate", &View::move_object},  {"scale", &View::move_object},   {"object", &View::select},
        {"edit", &View::select},         {"deselect", &View::select},     {"select", &View::select_light},
        {"next", &View::select_light},   {"drag", &View::drag},           {"hold", &View::change_history},
        {"undo", &View::change_history}, {"redo", &View::change_history}, {"explain", &View::explain},
        {"time", &View::set_time},       {"play", &View::set_time},       {"resize", &View::resize},
        {"pause", &View::control},       {"camera", &View::control},      {"quit", &View::control},
        {"save", &View::save},           {"frames", &View::control},      {"finish", &View::control}};
    try {
        const Handler handler = handlers.at(command.name);
        std::string told = (this->*handler)(command);
        if (handler != &View::move_camera) ++revision_;
        return told;
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
    if (command.name == "look") {
        Camera camera = now;
        camera.position = {n[0], n[1], n[2]}, camera.target = {n[3], n[4], n[5]};
        set_camera(camera);
    }
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
    const float depth = complete_renderer().aovs().depth[pixel];
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
    (command.name == "fov" ? camera.vertical_fov : camera.aperture_radius) = command.numbers[0];
    set_camera(camera);
    return {};
}

std::string View::set_exposure(const ViewCommand& command) {
    const float before = command.name == "stops" ? 0.f : config_.picture.exposure;
    config_.picture.exposure = std::clamp(before + command.numbers[0], -64.f, 64.f);
    return printed("exposure %g", double(config_.picture.exposure));
}

/// The words were checked with the command.
std::string View::choose(const ViewCommand& command) {
    if (command.name == "tone") config_.picture.tone_map = command.word == "none" ? ToneMap::none : ToneMap::aces;
    if (command.name == "show") shows_ = command.word;
    if (command.name != "denoise" || denoises_ == (command.word == "on")) return {};
    denoises_ = !denoises_;
    complete_renderer().restart(seed_ = config_.render.seed);
    spp_ = 0;
    return {};
}

glm::vec3 View::point_at(std::size_t pixel, float depth) const {
    const unsigned width = config_.render.width, height = config_.render.height;
    const CameraData data = camera_data(*scene_.camera, float(width) / float(height));
    return point_through(data, unsigned(pixel % width), unsigned(pixel / width), width, height, depth);
}

void View::show_time(double time) {
    Scene then = config_.animation.scene_at(time);
    place_all(then);
    then.camera = scene_.camera, then.materials = scene_.materials;
    const bool deforms = !have_same_vertices(scene_, then);
    std::swap(then.textures, scene_.textures);
    try {
        renderer_->update(then, {.lights = true, .instances = true, .vertices = deforms});
    } catch (...) {
        std::swap(then.textures, scene_.textures);
        throw;
    }
    scene_ = std::move(then);
    history_.clear(), original_.lights.clear(), original_.instances.clear();
    spp_ = 0, time_ = time;
}

void View::pass_time() {
    const Clock::time_point before = std::exchange(time_at_, Clock::now());
    if (paused_) return;
    const Animation& animation = config_.animation;
    const double passed = std::chrono::duration<double>(time_at_ - before).count();
    const double time = time_ + (animation.step > 0 ? animation.step : passed);
    show_time(animation.seconds > 0 ? std::fmod(time, animation.seconds) : time);
}

void View::pass_spin() {
    const Clock::time_point before = std::exchange(spun_at_, Clock::now());
    if (paused_) return;
    const auto degrees = float(double(spin_) * std::chrono::duration<double>(spun_at_ - before).count());
    set_camera(orbit(*scene_.camera, degrees, 0));
}

std::string View::set_time(const ViewCommand& command) {
    if (!config_.animation.scene_at)
        refuse(command.name + ": the scene is not animated", "use a glTF file with an animation");
    if (command.name == "time") {
        show_time(double(command.numbers[0]));
        return {};
    }
    playing_ = !playing_, time_at_ = Clock::now();
    return printed(playing_ ? "plays from %.3g s" : "stopped at %.3g s", time_);
}

std::string View::resize(const ViewCommand& command) {
    const float width = std::floor(command.numbers[0]), height = std::floor(command.numbers[1]);
    if (!(width >= 1 && height >= 1 && width <= most_pixels_a_side && height <= most_pixels_a_side))
        refuse(printed("resize: the image cannot have %gx%g pixels", double(width), double(height)),
               "use 1 to 16384 per side");
    require_live_size(unsigned(width), unsigned(height));
    try {
        set_size(unsigned(width), unsigned(height));
    } catch (const Error& error) {
        set_size(config_.render.width, config_.render.height);  // throws if the device is lost
        throw Error(ErrorKind::user, std::string("resize: ") + error.what(), "the size is kept");
    }
    preview_.complete_grew(double(width) / config_.render.width * double(height) / config_.render.height);
    config_.render.width = unsigned(width), config_.render.height = unsigned(height);
    return {};
}

void View::set_size(unsigned width, unsigned height) {
    spp_ = 0, previewing_ = false;
    renderer_->resize(width, height);
}

/// `frames` and `finish` are for the loops that call next_frame.
std::string View::control(const ViewCommand& command) {
    if (command.name == "camera") return options_of(*scene_.camera);
    if (command.name == "pause") {
        paused_ = !paused_;
        return paused_ ? "paused" : "continued";
    }
    if (command.name == "spin") spin_ = command.numbers[0], spun_at_ = Clock::now();
    if (command.name == "quit") ended_ = true;
    return {};
}

ViewState View::state() const {
    ViewState state{shows_, denoises_, paused_, playing_, spin_, time_};
    if (selected_) state.instance = selected_->instance;
    state.material = material_, state.light = light_, state.revision = revision_, state.run = run_;
    if (selected_) state.pivot = middle_of_object();
    if (light_ && *light_ < scene_.lights.size() && !traits_of(scene_.lights[*light_].kind)->far)
        state.pivot = scene_.lights[*light_].position;
    return state;
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

Answer answer(View& view, const ViewCommand& command) try {
    return {view.run(command), false};
} catch (const Error& error) {
    if (error.kind() == ErrorKind::device) throw;
    return {error.what(), true};
}

Answer answer(View& view, const std::string& line) { return answer(view, parse_command(line)); }

}  // namespace claray::view
