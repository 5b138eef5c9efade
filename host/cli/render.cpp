// claray render: renders a scene to an image.
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "claray/io.hpp"
#include "claray/scale/render_group.hpp"
#include "host/base/file.hpp"
#include "host/base/folders.hpp"
#include "host/base/process/process.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/job/job.hpp"
#include "host/cli/options/load.hpp"
#include "host/cli/options/render_flags.hpp"
#include "host/cli/options/render_targets.hpp"
#include "host/cli/output/frame_stream.hpp"
#include "host/cli/output/messages.hpp"
#include "host/cli/output/progress.hpp"
#include "host/cli/output/render_outputs.hpp"
#include "host/cli/picture/alpha.hpp"
#include "host/cli/picture/film.hpp"
#include "host/cli/picture/lens_options.hpp"
#include "host/cli/ranks.hpp"

namespace claray::cli {
namespace {

Scene load_for(const RenderOptions& options, FirstFrame* first = nullptr) {
    Scene scene = load_view(options.scene, options.view, options.config.width, options.config.height, first);
    use_light_maps(scene, options.light_maps);
    give_roles(scene, options);
    return scene;
}

void warn_of_culled(const RenderProgress& progress) {
    if (progress.culled > 0)
        print_warning("triangles that are not finite, huge, or without area are left out: " +
                      std::to_string(progress.culled));
}

/// Whether pictures take the exposure of a light that claray chooses. Other ranks, which render frames of their own, do
/// not know it.
bool takes_exposure_of_light(const RenderOptions& options) {
    const bool is_given = options.exposure || options.auto_exposure;
    return !is_given && is_shaped(options) && !(options.animation && rank_session() != nullptr);
}

/// Who renders a picture, and what becomes of it.
struct PictureJob {
    const std::vector<Device>& devices;
    ranks::Ranks* helpers = nullptr;                                        // ranks that render parts of it
    std::function<void(const std::vector<glm::vec3>&)> add_to_stream = {};  // instead of a file
    FrameCount* frames = nullptr;                                           // the picture is one of these
    std::optional<float>* exposure = nullptr;                               // of all frames; the first one sets it
    std::filesystem::path folder = {};                                      // for files, instead of the output's
    std::function<bool()> goes_on = [] { return !InterruptGuard::interrupted(); };
};

/// What renders a picture: one device, or several, those of other ranks among them.
struct PictureRenderer {
    std::unique_ptr<Renderer> one;
    std::unique_ptr<RenderGroup> group;
    std::unique_ptr<ranks::RemoteDevices> remote;

    PictureRenderer(const PictureJob& job, const Scene& scene, const RenderConfig& config) {
        if (job.devices.size() == 1 && job.helpers == nullptr)
            one = std::make_unique<Renderer>(job.devices.front(), scene, config);
        else
            group = std::make_unique<RenderGroup>(job.devices, scene, config, print_warning);
        if (job.helpers) remote = std::make_unique<ranks::RemoteDevices>(*job.helpers, *group, scene, config);
    }
    /// Of a group, after it has rendered.
    [[nodiscard]] Renderer& renderer() const { return one ? *one : group->renderer(); }
    [[nodiscard]] const std::string& checkpoint_error() const {
        return one ? one->checkpoint_error() : group->checkpoint_error();
    }
    RenderProgress render(const Device& device, TargetPlan* plan,
                          const std::function<bool(const RenderProgress&)>& show) const {
        if (plan == nullptr) return group ? group->render(show) : one->render(show);
        return group ? render_to_target(*group, *plan, show) : render_to_target(device, *one, *plan, show);
    }
};

/// Says that a checkpoint cannot be written when it happens, not hours later: once, until one is written again.
class CheckpointWatch {
public:
    void look(const std::string& error) {
        if (!error.empty() && !warned_)
            print_warning("no checkpoint could be written: " + error + "; it is tried again");
        warned_ = !error.empty();
    }

private:
    bool warned_ = false;
};

/// Renders until a target is reached or a signal arrives.
Outcome run_renderer(const PictureJob& job, const PictureRenderer& picture, const RenderOptions& options,
                     TargetPlan* plan) {
    ProgressDisplay display(options.config, progress_style(options.quiet || is_other_rank()), stderr, job.frames);
    std::optional<InterruptGuard> guard;
    CheckpointWatch checkpoints;
    const auto show = [&](const RenderProgress& so_far) {
        checkpoints.look(picture.checkpoint_error());
        if (!guard && !is_other_rank()) {
            warn_of_culled(so_far);
            guard.emplace();
        }
        display.show(so_far);
        return job.goes_on();
    };
    const RenderProgress progress = picture.render(job.devices.front(), plan, show);
    display.finish(progress);
    if (progress.spp == 0)
        throw Error(ErrorKind::user, "interrupted before every pixel had a sample: no image was written");
    return {progress, !job.goes_on()};
}

void refuse_lost_checkpoint(const std::string& error) {
    if (!error.empty()) throw Error(ErrorKind::user, "the last checkpoint could not be written: " + error);
}

/// A warning, not an error: scripts use the same options for all kinds of images.
void warn_of_picture_options(const RenderOptions& options) {
    const bool shaped = options.exposure || options.auto_exposure || options.tone_map != RenderOptions{}.tone_map;
    if (options.output.empty()) return;
    const auto warn = [&](const char* what, const char* why) {
        print_warning(std::string(what) + ": '" + options.output.string() + "' " + why);
    };
    if (shaped && !is_shaped(options))
        warn("--exposure and --tone-map apply to .png, .jpg, .webp and videos only", "stores the radiance unchanged");
    const ImageEncoding encoding = encoding_of(options), defaults;
    const auto format = format_of(options);
    if (encoding.png_bits != defaults.png_bits && format != ImageFormat::png)
        warn("--png-bits applies to .png only", "has its own number of bits");
    const bool has_quality = encoding.quality != defaults.quality || encoding.lossless;
    if (has_quality && format != ImageFormat::jpeg && format != ImageFormat::webp)
        warn("--quality applies to .jpg and .webp only", "loses nothing by its encoding");
}

/// The image and its AOVs. Returns whether the image was written.
bool write_rendered(const PictureJob& job, Renderer& renderer, const std::vector<glm::vec3>& pixels,
                    RenderOptions options, Writes& writes) {
    if (job.add_to_stream) {
        job.add_to_stream(pixels);  // no later frame could follow one that is missing
        return true;
    }
    if (!job.folder.empty()) options.output = job.folder / options.output.filename();
    const bool is_written = writes.attempt([&] { write_picture(pixels, options, &renderer); });
    write_aovs(renderer, options, writes);
    return is_written;
}

/// The error that --error does not limit, by pixels without approximations.
double error_without_approximations(const Device& device, const Scene& scene, RenderConfig config,
                                    Renderer& approximate) {
    config.approximate = {}, config.light_grid = {};
    config.checkpoint.clear(), config.resume.clear();
    Renderer exact(device, scene, config);
    return approximation_error(approximate, exact);
}

/// Returns false if it was interrupted.
bool render_picture(const PictureJob& job, const Scene& scene, RenderOptions options, Writes& writes) {
    const Device& device = job.devices.front();
    RenderConfig config = options.config;
    if (!options.wait_for_kernels) config.compiler = this_program();
    std::optional<TargetPlan> plan;
    if (options.picks_settings) {
        plan = plan_render(device, scene, config, options.picks_builder, measuring_progress(options.quiet));
        config = plan->config;
    } else if (options.picks_builder) {
        config.bvh.builder = choose_builder_for_samples(device, scene, config);
    }
    PictureRenderer picture(job, scene, config);

    Outcome outcome = run_renderer(job, picture, options, plan ? &*plan : nullptr);
    Renderer& renderer = picture.renderer();
    if (config.error > 0 && config.approximate.any() && !outcome.interrupted)
        outcome.approximation_error = error_without_approximations(device, scene, config, renderer);
    const std::vector<DeviceShare> shares = picture.group ? picture.group->shares() : std::vector<DeviceShare>();
    const Denoised denoised = denoise(renderer, options);
    const std::vector<glm::vec3> pixels = options.denoiser ? denoised.image : renderer.image();
    if (job.exposure && *job.exposure) options.exposure = *job.exposure;
    choose_exposure(pixels, &renderer, options);
    if (job.exposure && !*job.exposure) *job.exposure = options.exposure;
    const bool is_written = write_rendered(job, renderer, pixels, options, writes);
    if (!options.trace.empty())
        writes.attempt([&] { write_trace(options.trace, device.profiler().records(), device.info().name); });
    const TargetPlan* planned = plan ? &*plan : nullptr;
    if (!picture.group) tell_of_idle_options(renderer, options);
    if (is_written && options.output != "-")  // else an error follows, or standard output has the picture
        options.json ? print_as_json(device, renderer, options, outcome, planned, denoised, shares)
                     : print_as_text(device, renderer, options, outcome, planned, denoised, shares);
    writes.attempt([&] { refuse_lost_checkpoint(picture.checkpoint_error()); });
    if (!outcome.interrupted) writes.attempt([&] { refuse_missed_error(config, outcome.progress); });
    return !outcome.interrupted;
}

RenderOptions options_of_frame(RenderOptions options, unsigned frame) {
    if (!is_stream(options)) options.output = numbered(options.output, frame);
    if (options.turntable == 0) options.view.load.time = frame / options.frame_rate;
    return options;
}

/// The frames of an animation. Its functions are called from several threads.
class Animation {
public:
    Animation(const std::vector<Device>& devices, const RenderOptions& options, Writes& writes)
        : devices_(devices),
          options_(options),
          writes_(writes),
          count_(options.animation->last - options.animation->first + 1),
          next_of_stream_(options.animation->first) {
        if (rank_session() != nullptr && !is_stream(options))  // other ranks do not know the first frame
            exposure_ = options.exposure.value_or(0.f);
        if (is_stream(options)) stream_.emplace(options);
    }
    /// The first call must be for the first frame.
    [[nodiscard]] Scene load(unsigned frame) {
        const std::lock_guard lock(loading_);
        Scene scene = load_for(options_of_frame(options_, frame), &first_);
        if (options_.view.exposes && !exposure_) exposure_ = first_.exposure();
        if (options_.turntable > 0)
            scene.camera = orbited(camera_of(scene), 360.f * float(frame) / float(options_.turntable));
        return scene;
    }
    /// Returns false if it was interrupted. The device keeps the kernels of one frame for the others.
    bool render(unsigned frame, const Scene& scene, ranks::Ranks* helpers) {
        PictureJob job{devices_, helpers};
        job.exposure = &exposure_, job.frames = &count_;
        if (stream_)
            job.add_to_stream = [&, frame](const std::vector<glm::vec3>& pixels) { add_to_stream(frame, pixels); };
        tell_of_signals_until_guarded();
        const bool goes_on = render_picture(job, scene, options_of_frame(options_, frame), writes_);
        std::fflush(stdout);
        count_.finish_one();
        return goes_on;
    }
    /// Whether another rank's frame is what it was asked for: files of this frame, or pixels of a stream.
    [[nodiscard]] bool fits(const ranks::RenderedFrame& rendered) const {
        const std::size_t pixels = std::size_t(options_.config.image_width()) * options_.config.image_height();
        const bool has_image = !stream_ || !rendered.failure.text.empty() || rendered.pixels.size() == pixels;
        const std::string stem = options_of_frame(options_, rendered.frame).output.stem().string();
        return has_image &&
               std::ranges::all_of(rendered.names, [&](const auto& name) { return name.starts_with(stem); });
    }
    /// Of another rank.
    void take(const ranks::RenderedFrame& rendered) {
        count_.finish_one();
        if (stream_) add_to_stream(rendered.frame, rendered.pixels);
        for (std::size_t i = 0; i < rendered.names.size(); ++i)
            writes_.attempt([&] { write_file(options_.output.parent_path() / rendered.names[i], rendered.files[i]); });
        const ranks::Failure& failure = rendered.failure;
        if (!failure.text.empty()) writes_.attempt([&] { throw Error(ErrorKind(failure.exit_code), failure.text); });
    }
    void commit() {
        if (stream_) stream_->commit();
    }

private:
    /// Frames that come too early wait.
    void add_to_stream(unsigned frame, const std::vector<glm::vec3>& pixels) {
        const std::lock_guard lock(adding_);
        early_.emplace(frame, pixels);
        for (; early_.contains(next_of_stream_); early_.erase(next_of_stream_++))
            stream_->add(early_[next_of_stream_], exposure_.value_or(0.f));
    }

    const std::vector<Device>& devices_;
    const RenderOptions& options_;
    Writes& writes_;
    FrameCount count_;
    std::mutex loading_, adding_;
    FirstFrame first_;
    std::optional<float> exposure_;  // by the first frame
    std::optional<FrameStream> stream_;
    unsigned next_of_stream_;
    std::map<unsigned, std::vector<glm::vec3>> early_;
};

/// Each frame is rendered by one rank. Returns false if rank 0 was interrupted.
bool deal_frames(Animation& animation, ranks::Ranks& ranks, const RenderConfig& config, unsigned first, unsigned end) {
    const Scene scene = animation.load(first);
    ranks::FrameDealer dealer(ranks, config, first, end,
                              {[&](unsigned frame) { return animation.load(frame); },
                               [&](const ranks::RenderedFrame& rendered) { return animation.fits(rendered); },
                               [&](const ranks::RenderedFrame& rendered) { animation.take(rendered); }, print_warning});
    if (!animation.render(first, scene, nullptr)) return false;
    while (const auto frame = dealer.next())
        if (!animation.render(*frame, animation.load(*frame), nullptr)) return false;
    return true;
}

/// Ranks share those frames that would leave half of them or more without one.
void render_animation(const std::vector<Device>& devices, const RenderOptions& options, Writes& writes) {
    Animation animation(devices, options, writes);
    unsigned frame = options.animation->first;
    const unsigned end = options.animation->last + 1;
    ranks::Ranks* const ranks = meet_ranks();
    bool goes_on = true;
    if (ranks != nullptr) {
        const auto size = unsigned(ranks->hellos().size()), rest = (end - frame) % size;
        const unsigned end_of_dealt = 2 * rest <= size ? end - rest : end;
        if (frame < end_of_dealt) goes_on = deal_frames(animation, *ranks, options.config, frame, end_of_dealt);
        frame = end_of_dealt;
    }
    for (; goes_on && frame < end; ++frame) goes_on = animation.render(frame, animation.load(frame), ranks);
    animation.commit();
}

void enable_profilers(const std::vector<Device>& devices, const RenderOptions& options) {
    for (const Device& device : devices) {
        device.profiler().enable(options.stats || options.json || !options.trace.empty());
        device.profiler().keep_records(!options.trace.empty());
    }
}

/// A frame of an animation on another rank than 0, which gets the files.
std::optional<ranks::RenderedFrame> render_for_rank_0(const std::vector<Device>& devices, const RenderOptions& options,
                                                      const ranks::RenderTask& frame,
                                                      const std::function<bool()>& goes_on) {
    enable_profilers(devices, options);
    const auto folder = scratch_folder();
    ranks::RenderedFrame rendered;
    rendered.frame = frame.number;
    PictureJob job{devices, nullptr, {}, nullptr, nullptr, *folder, goes_on};
    std::optional<float> exposure = options.exposure.value_or(0.f);  // the same on all ranks
    job.exposure = &exposure;
    if (is_stream(options)) job.add_to_stream = [&](const std::vector<glm::vec3>& pixels) { rendered.pixels = pixels; };
    Writes writes;
    if (!render_picture(job, frame.scene, options_of_frame(options, frame.number), writes)) return std::nullopt;
    std::fflush(stdout);
    try {
        writes.finish();
    } catch (const Error& error) {
        rendered.failure = ranks::failure_of(error.kind(), error.what());
    }
    for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
        rendered.names.push_back(entry.path().filename().string());
        rendered.files.push_back(read_file(entry.path(), ""));
    }
    return rendered;
}

void check_all_outputs(const RenderOptions& options) {
    if (!options.animation || is_stream(options)) return check_outputs(options);
    for (const unsigned frame : {options.animation->first, options.animation->last}) {
        RenderOptions one = options;
        one.output = numbered(options.output, frame);
        check_outputs(one);
    }
}

void refuse_several(const std::vector<Device>& devices, const RenderOptions& options) {
    if (devices.size() == 1 && rank_session() == nullptr) return;
    const auto refuse = [](const char* option, const char* remedy) {
        throw Error(ErrorKind::usage, std::string(option) + " works on one device only", remedy);
    };
    if (options.fps > 0) refuse("--fps", "name one with --device, without mpirun");
    if (options.config.region.width > 0 && !options.animation)
        refuse("--region, or the crop of a file,", "name one with --device, without mpirun, or give --size");
    if (options.config.alpha) refuse("--alpha", "name one with --device, without mpirun");
    if (options.config.adaptive)
        refuse("--adaptive", "name one with --device, without mpirun, or leave out --adaptive");
    if (options.auto_exposure && options.animation && rank_session() != nullptr)
        refuse("--exposure automatic with --frames", "give a number of stops, so that all ranks use the same");
    if (!options.trace.empty()) refuse("--trace", "name one with --device, without mpirun, or leave out --trace");
}

/// Devices without float64 decide doubtful hits otherwise than those with it.
void warn_of_missing_float64(const std::vector<Device>& devices) {
    const auto lacks = [](const Device& device) { return !device.info().fp64; };
    const auto without = std::find_if(devices.begin(), devices.end(), lacks);
    if (without == devices.end() || std::all_of(devices.begin(), devices.end(), lacks)) return;
    print_warning("'" + without->info().name + "' has no float64: where hits are doubtful, it may find others");
}

void render(RenderOptions options) {
    use_film(options);
    if (is_other_rank())
        return serve_rank_0(
            options.device, options.wait_for_kernels ? "" : this_program(),
            [&](const std::vector<Device>& devices, const ranks::RenderTask& frame,
                const std::function<bool()>& goes_on) { return render_for_rank_0(devices, options, frame, goes_on); });
    check_all_outputs(options);
    if (options.denoiser) check_denoiser(*options.denoiser);
    tell_of_signals_until_guarded();
    const std::vector<Device> devices = open_devices(options.device);
    (void)meet_ranks();
    refuse_several(devices, options);
    warn_of_missing_float64(devices);
    enable_profilers(devices, options);
    warn_of_picture_options(options);
    options.view.exposes = takes_exposure_of_light(options);
    Writes writes;
    if (options.animation) {
        render_animation(devices, options, writes);
    } else {
        FirstFrame first;
        const Scene scene = load_for(options, &first);
        if (options.view.exposes && first.exposure()) options.exposure = first.exposure();
        if (options.fps > 0) return run_frames(devices.front(), scene, options);
        render_picture({devices, meet_ranks()}, scene, options, writes);
    }
    writes.finish();
}

}  // namespace

void add_render_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("render", "Render a scene to an image by path tracing");
    command->footer(
        "Ctrl-C stops early and writes the image rendered so far.\n"
        "--error and --time choose the tree and the sampler from the measurements of claray tune on the device.\n"
        "--time limits sampling only; loading, building, compiling and writing are not counted. With --resume the "
        "time\n"
        "starts again from 0, and --spp may be larger than before.\n"
        "Examples:\n"
        "  claray render cornell -o cornell.png --error 0.02\n"
        "  claray render bunny.obj -o bunny.hdr --size 1920x1080 --time 60s --stats\n"
        "  claray render terrain:1000000 -o terrain.png --aov depth,heat --trace trace.json\n"
        "  claray render walk.glb -o walk.png --frames 0..47 --frame-rate 24 --animation Walk\n"
        "  claray render hills -o hills.png --spp 256 --print-job > hills.json; claray render hills.json");
    command->option_defaults()->take_last();  // so that scripts can override options
    auto options = std::make_shared<RenderOptions>();
    auto job = std::make_shared<JobOptions>();
    add_render_options(*command, *options);
    add_job_options(*command, *job);
    command->callback([&action, command, options, job] {
        check_targets(*command, *options);
        options->asks_for_guiding = options->config.guide && command->count("--guide") > 0;
        options->has_size = command->count("--size") > 0;
        check_render_options(*command);
        check_alpha_options(*command, *options);
        check_exposure_options(*command, *options);
        action = [options] { render(*options); };
        if (job->print) action = [command] { std::fputs(job_text(*command).c_str(), stdout); };
    });
}

}  // namespace claray::cli
