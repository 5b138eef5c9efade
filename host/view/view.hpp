// A live view of a scene: commands change what is seen, and every frame shows it. The front ends (web page, terminal,
// script) only translate.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "claray/io.hpp"
#include "claray/renderer.hpp"
#include "host/view/curve.hpp"
#include "host/view/edit/effect_costs.hpp"
#include "host/view/edit/history.hpp"
#include "host/view/picking.hpp"
#include "host/view/preview_size.hpp"
#include "host/view/view_command.hpp"

namespace claray::view {

/// Of the file that is shown.
struct Animation {
    /// Loads the scene at a time; its materials and textures are not used. Empty: it is not animated.
    std::function<Scene(double)> scene_at = {};
    double seconds = 0;  ///< after which it repeats; 0: it does not
    double time = 0;     ///< of the first scene
    double step = 0;     ///< seconds per frame while it plays; 0: those that pass
};

struct ViewConfig {
    RenderConfig render;          ///< `spp`: samples at which a still view stops
    double frame_seconds = 0.04;  ///< from one frame to the next; more if a sample per pixel takes longer
    /// A change that takes longer than this to show is shown as a smaller image first, which is enlarged; 0: never.
    double answer_seconds = 0.05;
    PictureConfig picture;
    Animation animation = {};
};

/// What a front end shows.
struct Frame {
    unsigned width = 0, height = 0;
    std::span<const std::uint8_t> pixels;  ///< red, green, blue, 255 per pixel; valid until the next frame
    unsigned spp = 0;
    bool complete = false;     ///< the next frame would be the same: it has all samples, or the view is paused
    std::uint64_t number = 0;  ///< frames so far; that of the frame before if no new one was made
};

/// What front ends show beside the image.
struct ViewState {
    std::string shows = "image";
    bool denoises = false, paused = false, playing = false;
    float spin = 0;                              ///< degrees per second round the target
    double time = 0;                             ///< of the animation
    std::optional<std::uint32_t> instance = {};  ///< selected: the first part of an object
    std::optional<std::uint32_t> material = {};  ///< selected
    std::optional<std::size_t> light = {};       ///< selected
    std::optional<glm::vec3> pivot = {};         ///< the middle of what is selected, in the world
    std::uint64_t revision = 0;                  ///< counts changes of all but the camera and the time
    unsigned run = 0;                            ///< counts restarts of the samples
};

/// True ends the sampling of a frame. Asked every 10 ms; while the first samples are made, about five times a second.
using Interrupted = std::function<bool()>;

/// Throws ErrorKind::user for an image whose frames would take too long.
void require_live_size(unsigned width, unsigned height);

class View {
public:
    /// Throws as Renderer does.
    View(const Device& device, Scene scene, const ViewConfig& config);

    /// Changes the view. Returns a line for the user, often empty. Throws ErrorKind::user for values out of range; the
    /// view is then unchanged.
    std::string run(const ViewCommand& command);
    /// Renders for the time of a frame. If it is interrupted, the frame before is kept, unless every pixel has its
    /// first samples since a change.
    [[nodiscard]] const Frame& next_frame(const Interrupted& interrupted = {});
    /// Renders until the image is complete.
    [[nodiscard]] const Frame& complete_frame();

    /// The last frame; at first one with the first samples.
    [[nodiscard]] const Frame& frame() const { return frame_; }
    [[nodiscard]] const Camera& camera() const { return *scene_.camera; }
    [[nodiscard]] const Scene& scene() const { return scene_; }
    [[nodiscard]] const ViewConfig& config() const { return config_; }
    [[nodiscard]] ViewState state() const;
    [[nodiscard]] const History& history() const { return history_; }
    /// What commands changed of materials, lights and instances since the scene was loaded, as `apply_edit` takes it.
    [[nodiscard]] std::vector<std::string> edits() const;
    /// The noise of the image since its samples began.
    [[nodiscard]] const Curve& curve() const { return curve_; }
    /// What the effects of the scene cost, once the command `explain` has measured it.
    [[nodiscard]] const EffectCosts& costs() const { return costs_; }
    [[nodiscard]] bool ended() const { return ended_; }

private:
    using Handler = std::string (View::*)(const ViewCommand&);
    void set_camera(const Camera& camera);
    /// Changes one list of the scene by `edit`; after an error the list is as before.
    template <class Part, class Edit>
    void change(std::vector<Part> Scene::*part, const SceneChanges& changes, const Edit& edit);
    void exchange_step(Step& step);
    [[nodiscard]] std::size_t pixel_of(const ViewCommand& command) const;
    [[nodiscard]] std::span<const std::uint8_t> shown();
    [[nodiscard]] float size() const;
    [[nodiscard]] glm::vec3 point_at(std::size_t pixel, float depth) const;
    void render(double seconds, const Interrupted& interrupted = {});
    [[nodiscard]] bool wants_preview() const;
    [[nodiscard]] bool rests() const;
    void preview();
    /// The renderer of the complete image, which has no samples after a preview.
    [[nodiscard]] Renderer& complete_renderer();
    void sample_frame(const Interrupted& interrupted);
    void show_time(double time);
    void pass_time();
    void pass_spin();
    void take_costs();
    [[nodiscard]] const Frame& shown_frame();

    std::string move_camera(const ViewCommand& command);
    std::string focus(const ViewCommand& command);
    std::string set_lens(const ViewCommand& command);
    std::string set_exposure(const ViewCommand& command);
    std::string choose(const ViewCommand& command);
    std::string pick(const ViewCommand& command);
    std::string set_material(const ViewCommand& command);
    std::string move_light(const ViewCommand& command);
    std::string set_light(const ViewCommand& command);
    std::string move_object(const ViewCommand& command);
    std::string select(const ViewCommand& command);
    std::string select_light(const ViewCommand& command);
    std::string drag(const ViewCommand& command);
    std::string change_history(const ViewCommand& command);
    void hold_object(const Selection& selection);
    void hold_nothing();
    [[nodiscard]] std::size_t light_number(const std::string& command, double number) const;
    void shift_light(std::size_t light, const glm::vec3& way);
    /// Applies `edit` to the transforms of all parts of the selected object.
    void change_object(const std::string& command, const std::function<glm::mat4(const glm::mat4&)>& edit);
    void shift_object(const std::string& command, const glm::vec3& way);
    [[nodiscard]] glm::vec3 middle_of_object() const;
    std::string explain(const ViewCommand& command);
    std::string set_time(const ViewCommand& command);
    std::string resize(const ViewCommand& command);
    void set_size(unsigned width, unsigned height);
    std::string control(const ViewCommand& command);
    std::string save(const ViewCommand& command);

    Device device_;
    Scene scene_;
    ViewConfig config_;
    Camera home_;
    std::unique_ptr<Renderer> renderer_;
    std::string shows_ = "image";
    bool denoises_ = false;
    std::optional<Selection> selected_;
    std::vector<std::uint32_t> parts_;       // of the selected object: instances
    glm::vec3 middle_{0.f};                  // of the selected object, before its transform
    glm::vec3 held_{0.f};                    // the point at which it was selected
    std::optional<std::uint32_t> material_;  // selected
    std::optional<std::size_t> light_;       // selected instead of an object
    History history_;
    Scene original_;  // the lists that were changed, as they were
    Curve curve_;
    EffectCosts costs_;
    std::uint64_t revision_ = 0;
    unsigned run_ = 0;
    std::vector<std::uint8_t> false_colors_;  // of a view other than the image
    Frame frame_;
    unsigned spp_ = 0;
    bool previewing_ = false;  // the renderer's image is smaller
    PreviewSize preview_;
    std::uint32_t seed_ = 0;
    std::chrono::steady_clock::time_point sampled_at_;  // the end of the last sampling
    bool paused_ = false, playing_ = false, ended_ = false;
    float spin_ = 0;                                 // degrees per second
    std::chrono::steady_clock::time_point spun_at_;  // when the camera was turned last
    double time_ = 0;                                // of the animation
    std::chrono::steady_clock::time_point time_at_;  // when it was that while the animation played
};

/// What a command tells the user.
struct Answer {
    std::string line;  ///< often empty; the message of the error if it failed
    bool failed = false;
};

/// Runs a command. Device errors are thrown.
[[nodiscard]] Answer answer(View& view, const ViewCommand& command);
[[nodiscard]] Answer answer(View& view, const std::string& line);

}  // namespace claray::view
