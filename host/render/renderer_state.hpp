// What a Renderer consists of.
#pragma once

#include <chrono>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "claray/renderer.hpp"
#include "host/compute/device_state.hpp"
#include "host/render/aovs.hpp"
#include "host/render/checkpoint/checkpoint.hpp"
#include "host/render/deferred/gbuffer.hpp"
#include "host/render/denoising_stage.hpp"
#include "host/render/film/error_estimate.hpp"
#include "host/render/film/film.hpp"
#include "host/render/film/tone_map.hpp"
#include "host/render/guiding/path_guide.hpp"
#include "host/render/in_flight.hpp"
#include "host/render/kernels/kernel_choice.hpp"
#include "host/render/layers/light_layers.hpp"
#include "host/render/layers/matte.hpp"
#include "host/render/layers/surface_numbers.hpp"
#include "host/render/schedule/adaptive_schedule.hpp"
#include "host/render/wavefront/wavefront.hpp"

namespace claray {

/// The user's scene, as far as it can change.
struct SceneShape {
    SceneShape() = default;
    /// `placed`, `places`, `numbers`: see PlacedScene.
    SceneShape(const Scene& scene, const Scene& placed, std::vector<InstancePlace> places, TriangleNumbers numbers);

    struct MeshSize {
        std::size_t vertices = 0, triangles = 0, normals = 0;
    };
    std::vector<MeshSize> meshes;
    std::size_t materials = 0, primitives = 0;
    std::vector<MeshInstance> instances;
    std::vector<InstancePlace> places;  // of the instances in the placed scene
    TriangleNumbers numbers;            // of the placed scene's triangles in the user's
    SurfaceNumbers surfaces;
    std::vector<std::size_t> first_vertices;  // of the meshes of the placed scene
    std::vector<glm::vec2> uvs;               // of its vertices; empty: no mesh has texture coordinates
};

/// How the lights are picked; sums over tiles pick none.
[[nodiscard]] LightSelection selection_of_lights(const RenderConfig& config);
[[nodiscard]] std::optional<LightGridStage> light_grid_of(const RenderConfig& config, const Scene& scene);
[[nodiscard]] inline std::uint32_t words_of(const std::optional<LightGridStage>& grid) {
    return grid ? grid->words() : 0;
}
[[nodiscard]] Bvh::Config with_layout(Bvh::Config config, Layout layout);
[[nodiscard]] inline float aspect_of(const RenderConfig& config) { return float(config.width) / float(config.height); }

/// The kernel that follows whole paths, or the last ones of each batch.
struct PathKernelChoice {
    KernelRequest kernel = {};
    KernelSet program = {};  // empty: there is none
    bool is_cached = true, is_loaded = false;
};

/// What a render knows of the process that compiles its own kernels.
struct CompilerInBackground {
    bool is_asked = false;  ///< false: that of another render runs
    std::chrono::steady_clock::time_point last_asked;
    bool is_waited_for = false;  ///< now, instead of sampling
    double waited = 0;           ///< seconds
};

/// The kernels of a render: those that it begins with, and its own.
struct RenderKernels {
    KernelPlan plan;
    double patience;                                // seconds of rendering before `of_paths` may be compiled
    bool are_own = false;                           // in use
    unsigned own_from = 0;                          // samples per pixel that were done when they took over
    std::optional<PathKernelChoice> of_paths = {};  // once every pixel was sampled
    CompilerInBackground compiler = {};
};

/// What is known of the user's scene.
struct SourceScene {
    SceneShape shape = {};
    Camera camera = {};
    unsigned parts = 1;  // of the structure
    std::uint32_t culled = 0;
    std::vector<Bounds> mesh_bounds = {};  // if paths may be guided
    Bounds bounds = {};                    // of the scene
};

/// Which samples are next, and how.
struct Sampling {
    AdaptiveSchedule schedule;
    Pace pace;
    unsigned most_spp;                    // for which the renderer was made
    std::optional<PathGuide> guide = {};  // of these samples
};

/// What a render needs to write checkpoints.
struct Checkpoints {
    RenderIdentity identity;
    std::string error;  // of the last one
};

/// What a program asked for besides the image. Each stage is made when it is first asked for.
struct RenderOutputs {
    std::optional<ToneMapper> tone_mapper;
    std::optional<AovStage> aovs;
    std::optional<GBufferStage> gbuffer;
    std::optional<DenoisingStage> denoising;
    std::optional<LightLayers> light_layers;
    std::optional<Matte> matte;  // of RenderConfig::alpha
    Checkpoints checkpoints;

    /// Drops those whose kernels trace the scene.
    void drop_views() { aovs.reset(), gbuffer.reset(); }
};

/// The estimates of a render's error.
struct ErrorEstimates {
    ErrorProgress progress;
    bool is_new = false;            // not reported yet
    double measuring_seconds = 0;   // for noise and error
    std::optional<double> cut_off;  // once it was asked for
};

/// When a renderer was made, when it began, and what it may take.
struct RenderTimes {
    using Point = std::chrono::steady_clock::time_point;
    Point set_up;
    double set_up_processor = 0;                                    // processor seconds at that time
    double first_pixel = 0, first_pixel_processor = 0;              // seconds from then on
    std::optional<Point> begin = {};                                // of the samples
    Point first_begin = {};                                         // of all frames
    double call_seconds = std::numeric_limits<double>::infinity();  // that this call of Renderer::render_for may take
    Point call_begin = {};                                          // of that call
    double build = 0;                                               // of the structure, in milliseconds of the device
    std::map<std::string, double> of_kernels = {};                  // before this render, likewise
};

struct Renderer::State {
    using Clock = std::chrono::steady_clock;

    /// `baked`: see PlacedScene.
    State(const Device& on, const Scene& scene, const RenderConfig& with, std::size_t baked = 0);

    [[nodiscard]] std::uint32_t first_paths() const;
    [[nodiscard]] bool parts_take_turns() const;

    // kernels/kernel_switch.cpp
    [[nodiscard]] WavefrontKernels load_kernels(EffectSet effects) const;
    /// Of this scene's buffers, for kernels that know these effects.
    [[nodiscard]] StageConfig stages(EffectSet effects) const {
        return stages_of(buffers, config.sampler, effects, config.approximate, light_layers_of(config));
    }
    /// Of this scene, if it had these effects.
    [[nodiscard]] SceneTraits traits(EffectSet effects) const;
    void first_pixel();
    /// Called after each batch. `sampled`: every pixel has a sample.
    void choose_kernels(bool sampled);
    void take_over_when_compiled();
    void ask_for_compiler();
    [[nodiscard]] bool better_waits_for_kernels();
    void wait_for_kernels(InFlight& in_flight);
    void take_over();
    [[nodiscard]] bool may_follow_paths() const;
    [[nodiscard]] PathKernelChoice choose_path_kernel() const;
    /// `patience`: seconds of rendering before the kernel that follows paths may be compiled.
    void use_path_kernel(double patience);
    void adopt_path_kernel(bool may_compile);
    void adopt(const Structure& other, EffectSet effects);

    // renderer.cpp
    void refuse_with_checkpoints(const char* what) const;
    void follow_light();
    void sample_all_pixels();
    /// As Renderer::settle, without the kernels that move surfaces.
    void settle();
    /// Continues up to so many samples per pixel, at most those that the renderer was made for; seconds count from
    /// here. Not with adaptive sampling, whose rounds depend on the number of samples at the end.
    void extend(unsigned spp);
    void look_through(const Camera& view);
    [[nodiscard]] ToneMapper& mapper_of(std::uint32_t image_pixels);
    /// 0 stands for the size of the film.
    [[nodiscard]] ImageSizes sizes(unsigned width, unsigned height) const;
    void save_checkpoint();
    [[nodiscard]] AovStage& aov_stage();
    [[nodiscard]] DenoisingStage& denoising_stage();
    [[nodiscard]] DenoisingStage::Noisy noisy() const { return {buffers, wavefront.frame, film.pixels(), spp()}; }
    void discard_samples();

    // update.cpp
    void update(const Scene& scene, const SceneChanges& changes);
    void move(const Scene& scene, const SceneChanges& changes);
    [[nodiscard]] bool move_vertices(const Scene& scene, bool all);
    [[nodiscard]] bool move_instances(const Scene& scene);
    void rebuild_scene(const Scene& scene);
    void support_scene();
    /// Of the film: of the region, or of the whole image.
    [[nodiscard]] std::uint32_t pixels() const { return config.image_width() * config.image_height(); }
    [[nodiscard]] AdaptiveSchedule new_schedule() const {
        const double least_gain = device.tuning("render/adaptive", "LEAST_GAIN_PERCENT") / 100.0;
        return {config.image_width(),      config.image_height(), config.spp,
                wavefront.queues.capacity, config.adaptive,       least_gain};
    }
    /// Of the lists of rounds of adaptive sampling or of a region's pixels, and behind them of control pixels.
    [[nodiscard]] std::uint32_t words_of_listed_pixels() const {
        return words_of_rounds() + words_of_listed_controls();
    }
    [[nodiscard]] std::uint32_t words_of_rounds() const {
        return config.adaptive ? AdaptiveSchedule::words_per_pixel * pixels() : has_region() ? 2 * pixels() : 0;
    }

    // region.cpp
    [[nodiscard]] bool has_catchers() const { return outputs.matte && outputs.matte->has_catchers(); }
    [[nodiscard]] bool has_region() const { return config.region.width > 0; }
    /// The number in the whole image of a pixel of the film.
    [[nodiscard]] std::uint32_t pixel_in_image(std::uint32_t pixel) const;
    /// Writes the list of a region's pixels, whose entries its batches number.
    void list_region();
    /// Of pixels of the film, as the kernels number them.
    [[nodiscard]] Batch in_image(Batch batch) const;
    void refuse_with_region(const char* what) const;

    // controls.cpp
    [[nodiscard]] std::uint32_t words_of_listed_controls() const { return 4 * std::min(most_control_pixels, pixels()); }
    /// What the film tells, with control pixels that have as many samples. `image` is valid until it is read again.
    struct ErrorLook {
        std::vector<float> variances, expected;
        std::span<const glm::vec3> image;
    };
    [[nodiscard]] ErrorLook look_at_controls();
    /// Takes the samples that control pixels lack, up to those of `like`, by other random numbers for each `word`.
    void sample_controls(std::vector<ControlPixel>& controls, const AdaptiveSchedule& like, std::uint32_t word);
    void trace_controls(const Batch& all, Film& film, std::uint32_t first_entry, std::uint32_t listed);
    void trace_beside(const Batch& batch, const std::function<void(const Batch&)>& add);

    void plan_round();
    void list_pixels() const;
    /// Samples of all pixels.
    [[nodiscard]] unsigned spp() const { return unsigned(sampling.schedule.samples() / pixels()); }
    [[nodiscard]] RenderProgress measure();
    template <class Measure>
    auto timed(const Measure& measure);
    [[nodiscard]] bool target_met();
    [[nodiscard]] bool limit_reached();
    [[nodiscard]] double seconds_left() const;
    /// Limits a call of Renderer::render_for for as long as it lasts.
    class TimeOfCall {
    public:
        TimeOfCall(State& state, double seconds) : state_(state) {
            state.time.call_seconds = seconds, state.time.call_begin = Clock::now();
        }
        ~TimeOfCall() { state_.time.call_seconds = std::numeric_limits<double>::infinity(); }
        TimeOfCall(const TimeOfCall&) = delete;
        TimeOfCall& operator=(const TimeOfCall&) = delete;

    private:
        State& state_;
    };
    [[nodiscard]] double noise_over_halves() const;  // noise over that of the halves
    [[nodiscard]] bool error_met();
    void look_at_error(unsigned spp);
    [[nodiscard]] double cut_off();
    [[nodiscard]] double error_left_to_noise();
    void warm_up();
    [[nodiscard]] std::uint32_t paths_of_next_batch(InFlight& in_flight) const;
    void trace(const Batch& batch, InFlight& in_flight);
    [[nodiscard]] std::uint32_t words_of_guide() const {
        return may_guide_paths(device, config) ? CLARAY_GUIDE_MAPS * CLARAY_GUIDE_WORDS : 0;
    }
    /// Whether later samples may need to know where the scene is.
    [[nodiscard]] bool may_ever_guide() const {
        return config.guide && words_of_guide() > 0 && sampling.most_spp > unguided_spp;
    }
    [[nodiscard]] bool may_guide() const;
    /// `vertices`: those of meshes changed.
    void set_bounds(const Scene& scene, bool vertices);
    /// Adds the samples to the film. Asynchronous, unless maps for guiding are made.
    void trace(const Batch& batch);
    [[nodiscard]] RayCount rays(const char* name, std::uint64_t count) const;

    Device device;
    RenderConfig config;
    RenderTimes time;
    SourceScene source;
    RenderKernels kernels;
    std::optional<LightGridStage> light_grid;
    SceneBuffers buffers;
    Wavefront wavefront;
    Film film;
    RenderOutputs outputs;
    Sampling sampling;
    ErrorEstimates error;
};

}  // namespace claray
