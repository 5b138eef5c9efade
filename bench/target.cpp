// What choosing by target holds of what it promises, at small sizes:
//   bench_target coverage|study|intervals|sweep|time|overhead [--scenes NAME,...] [--targets E,...] [--size N] [--seeds
//   N]
//   [--adaptive]
//       [--references FOLDER] [--csv FILE]
// coverage: renders to an error, against references: how many reach it, by how much, and with how many more samples
// than needed. study: coverage of forty scenes, three errors each. intervals: how many pixels have their true luminance
// within Renderer::error_map, and how well the error of a denoised image is predicted. sweep: what an error costs by
// the planner's choice, over what it costs by every fixed choice of builder and sampler. time: how well times are kept.
// overhead: what measuring takes.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "bench/support.hpp"
#include "claray/accuracy.hpp"
#include "claray/plan/target.hpp"
#include "host/lights/luminance.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device, csv, references;
    std::vector<std::string> scenes = {"cornell", "spheres", "crate", "hills", "terrain:2000"};
    std::vector<double> targets = {0.08, 0.04, 0.02};
    unsigned size = 48, seeds = 7, spp = 256;
    bool adaptive = false;
    std::vector<double> times = {0.5, 2, 10, 60};
};

Scene scene_of(const std::string& name) {
    Warnings warnings;
    return load_scene(name, warnings);
}

/// The reference's own error is taken away: both are independent.
double true_error(const std::vector<glm::vec3>& image, const ReferenceImage& reference, unsigned width) {
    const double all = image_error(image, reference.pixels, width).rmse, own = reference.uncertainty;
    return std::sqrt(std::max(all * all - own * own, 0.0));
}

ReferenceImage reference_of(const Device& device, const Scene& scene, const Options& options, double error) {
    return reference_image(device, scene, {.width = options.size, .height = options.size},
                           {.least_spp = 4096, .uncertainty = error, .folder = options.references});
}

/// Renders to an error, of several seeds.
class Trials {
public:
    struct Trial {
        std::uint32_t seed = 0;
        double error = 0, estimate = 0;
        unsigned spp = 0;
        bool is_sure = true;  // fireflies have little of the error
    };

    Trials(const Device& device, const Scene& scene, const ReferenceImage& reference, const Options& options,
           double target)
        : device_(device), scene_(scene), reference_(reference), options_(options), target_(target) {
        for (std::uint32_t seed = 1000; seed < 1000 + options.seeds; ++seed) {
            Renderer renderer(device, scene, config(seed, 1u << 24, target));
            const RenderProgress reached = renderer.render();
            all_.push_back({seed, error_of(renderer), reached.error, reached.spp, reached.error_is_sure()});
        }
    }

    [[nodiscard]] const std::vector<Trial>& all() const { return all_; }
    /// The median of the samples over the least, in sixteenths, by which the mean squared error reaches the target.
    [[nodiscard]] double over_least() const {
        unsigned few = 1, enough = 16;
        while (enough - few > 1) {
            const unsigned between = (few + enough) / 2;
            (reaches(between) ? enough : few) = between;
        }
        return 16.0 / enough;
    }

private:
    [[nodiscard]] RenderConfig config(std::uint32_t seed, unsigned spp, double error) const {
        RenderConfig config{.width = options_.size, .height = options_.size, .spp = spp, .seed = seed, .error = error};
        config.adaptive = options_.adaptive;
        return config;
    }
    [[nodiscard]] double error_of(const Renderer& renderer) const {
        return true_error(renderer.image(), reference_, options_.size);
    }
    [[nodiscard]] bool reaches(unsigned sixteenths) const {
        double squares = 0;
        for (const Trial& trial : all_) {
            const unsigned spp = (trial.spp * sixteenths + 15) / 16;
            if (spp == trial.spp) {
                squares += trial.error * trial.error;
                continue;
            }
            Renderer renderer(device_, scene_, config(trial.seed, spp, 0));
            renderer.render();
            squares += std::pow(error_of(renderer), 2);
        }
        return squares <= target_ * target_ * double(all_.size());
    }

    const Device& device_;
    const Scene& scene_;
    const ReferenceImage& reference_;
    const Options& options_;
    double target_;
    std::vector<Trial> all_;
};

struct Subject {
    std::string scene;
    std::vector<double> targets;
};

void cover(const Device& device, const Options& options, const std::vector<Subject>& subjects) {
    measure::Csv csv(options.csv, device, "scene,target,seed,spp,estimate,error,sure,over_least");
    unsigned runs = 0, held = 0, unsure = 0;
    std::vector<double> costs;
    std::printf("%-25s %7s %6s %6s %9s %9s %11s %7s %10s\n", "scene", "target", "held", "unsure", "median/E", "most/E",
                "estimate/e", "spp", "over least");
    for (const auto& [name, targets] : subjects) {
        const Scene scene = scene_of(name);
        const double finest = *std::min_element(targets.begin(), targets.end());
        const ReferenceImage reference = reference_of(device, scene, options, finest / 8);
        for (const double target : targets) {
            const Trials trials(device, scene, reference, options, target);
            std::vector<double> ratios, estimates, spp;
            unsigned sure = 0, good = 0;
            costs.push_back(trials.over_least());
            for (const Trials::Trial& trial : trials.all()) {
                csv.row(name, target, trial.seed, trial.spp, trial.estimate, trial.error, trial.is_sure, costs.back());
                ratios.push_back(trial.error / target), estimates.push_back(trial.estimate / trial.error);
                spp.push_back(trial.spp), sure += trial.is_sure, good += trial.is_sure && trial.error <= target;
            }
            runs += sure, held += good, unsure += options.seeds - sure;
            std::printf("%-25s %7.3f %4u/%u %6u %9.3f %9.3f %11.3f %7.0f %10.2f\n", name.c_str(), target, good, sure,
                        options.seeds - sure, measure::median(ratios), *std::max_element(ratios.begin(), ratios.end()),
                        measure::median(estimates), measure::median(spp), costs.back());
            std::fflush(stdout);
        }
    }
    std::printf("%u of %u renders without much error by fireflies are within their target (%.1f %%), %u are unsure\n",
                held, runs, 100.0 * held / std::max(1u, runs), unsure);
    std::printf("samples over the least: median %.2f, most %.2f\n", measure::median(costs),
                *std::max_element(costs.begin(), costs.end()));
    csv.write();
}

void coverage(const Device& device, const Options& options) {
    std::vector<Subject> subjects;
    for (const std::string& name : options.scenes) subjects.push_back({name, options.targets});
    cover(device, options, subjects);
}

/// Built-in scenes of many kinds. The errors are finer where four samples would already reach the first, and coarser
/// where few paths carry most of the light.
void study(const Device& device, const Options& options) {
    std::vector<Subject> subjects;
    const auto add = [&](std::vector<double> targets, std::initializer_list<const char*> names) {
        for (const char* name : names) subjects.push_back({name, targets});
    };
    add({0.08, 0.04, 0.02}, {"cornell", "spheres", "fan:2000", "soup:2000"});
    add({0.04, 0.02, 0.01}, {"crate", "hills", "terrain:2000", "terrain:50000", "ball:2000", "curves:3000"});
    const auto add_effects = [&](std::vector<double> targets, std::initializer_list<const char*> names) {
        for (const char* name : names) subjects.push_back({std::string("effect:") + name, targets});
    };
    add_effects({0.16, 0.08, 0.04}, {"clearcoat", "coated-metal", "hot-spots"});
    add_effects({0.08, 0.04, 0.02}, {"anisotropy", "rough-glass", "many-lights"});
    add_effects({0.04, 0.02, 0.01}, {"primitives",
                                     "smooth-normals",
                                     "mirror",
                                     "glass",
                                     "metal",
                                     "principled",
                                     "oren-nayar",
                                     "thin-walls",
                                     "transmission",
                                     "specular",
                                     "iridescence",
                                     "sheen",
                                     "absorption",
                                     "nested-media",
                                     "emissive-triangles",
                                     "point-lights",
                                     "directional-lights",
                                     "sky",
                                     "depth-of-field",
                                     "camera-motion",
                                     "textures",
                                     "cut-outs",
                                     "culling",
                                     "instances"});
    cover(device, options, subjects);
}

/// The part of the pixels whose true luminance is within their intervals.
double share_within(const std::vector<glm::vec3>& image, const std::vector<float>& widths,
                    const std::vector<glm::vec3>& truth) {
    unsigned within = 0;
    for (std::size_t i = 0; i < image.size(); ++i)
        within += std::abs(luminance(image[i]) - luminance(truth[i])) <= double(widths[i]);
    return double(within) / double(image.size());
}

void intervals(const Device& device, const Options& options) {
    measure::Csv csv(options.csv, device, "scene,spp,seed,error,within,denoised_error,predicted");
    std::printf("%-18s %5s %9s %9s %15s %18s\n", "scene", "spp", "error", "within", "denoised error",
                "predicted/error");
    for (const std::string& name : options.scenes) {
        const Scene scene = scene_of(name);
        RenderConfig config{.width = options.size, .height = options.size, .spp = options.spp};
        const ReferenceImage reference =
            reference_image(device, scene, config, {.least_spp = 64 * options.spp, .folder = options.references});
        std::vector<double> errors, shares, denoised_errors, predictions;
        for (unsigned seed = 0; seed < options.seeds; ++seed) {
            config.seed = 1000 + seed;
            Renderer renderer(device, scene, config);
            renderer.render();
            const std::vector<glm::vec3> image = renderer.image(), denoised = renderer.denoised(DenoiserKind::claray);
            errors.push_back(true_error(image, reference, options.size));
            shares.push_back(share_within(image, renderer.error_map(), reference.pixels));
            denoised_errors.push_back(true_error(denoised, reference, options.size));
            predictions.push_back(renderer.error_of(denoised) / denoised_errors.back());
            csv.row(name, options.spp, seed, errors.back(), shares.back(), denoised_errors.back(), predictions.back());
        }
        std::printf("%-18s %5u %7.2f %% %9.3f %13.2f %% %18.2f\n", name.c_str(), options.spp,
                    100 * measure::median(errors), measure::median(shares), 100 * measure::median(denoised_errors),
                    measure::median(predictions));
        std::fflush(stdout);
    }
    csv.write();
}

/// Of the process where the device is a CPU (others may use the machine), by the clock where it is not.
template <class Work>
double seconds_of(const Device& device, const Work& work) {
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t processor = std::clock();
    work();
    if (device.info().type == DeviceType::cpu) return double(std::clock() - processor) / CLOCKS_PER_SEC;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Error squared times seconds, tree included: the time for equal error, since it falls with the root of the time.
struct Cost {
    double squares = 0, seconds = 0;
    void add(double error, double took) { squares += error * error, seconds += took; }
    [[nodiscard]] double product() const { return squares * seconds; }
};

void sweep(const Device& device, const Options& options) {
    constexpr double target = 0.03;
    constexpr const char* subjects[] = {"cornell", "spheres", "terrain:20000"};
    measure::Csv csv(options.csv, device, "scene,target,spp,choice,builder,sampler,rms_error,seconds,over_best");
    for (const char* name : subjects) {
        const Scene scene = scene_of(name);
        const ReferenceImage reference = reference_of(device, scene, options, target / 8);
        const RenderConfig to_error{
            .width = options.size, .height = options.size, .spp = 1u << 24, .seed = 1000, .error = target};
        struct Fixed {
            std::string builder, sampler;
            RenderConfig config;
            Cost cost;
        };
        std::vector<Fixed> fixed;
        for (const auto& [builder, preset] : measure::builders)
            for (const Sampler sampler : {Sampler::sobol, Sampler::independent}) {
                RenderConfig config = to_error;
                config.error = 0, config.sampler = sampler, config.bvh.builder = preset;
                fixed.push_back({builder, sampler == Sampler::sobol ? "Sobol" : "independent", config, {}});
            }
        Cost planned;
        std::vector<double> spp;
        std::string picked;
        const auto render_fixed = [&](Fixed& one, std::uint32_t seed, unsigned samples, bool counts) {
            one.config.seed = seed, one.config.spp = samples;
            std::vector<glm::vec3> image;
            const double seconds = seconds_of(device, [&] {
                Renderer renderer(device, scene, one.config);
                (void)renderer.render();
                image = renderer.image();
            });
            if (counts) one.cost.add(true_error(image, reference, options.size), seconds);
        };
        for (Fixed& one : fixed) render_fixed(one, 1, 1, false);     // compiles
        for (unsigned round = 0; round <= options.seeds; ++round) {  // by turns; the first does not count
            RenderConfig config = to_error;
            config.seed += round;
            std::vector<glm::vec3> image;
            TargetPlan plan = plan_render(device, scene, config);
            RenderProgress reached;
            const double seconds = seconds_of(device, [&] {
                Renderer renderer(device, scene, plan.config);
                reached = render_to_target(device, renderer, plan);
                image = renderer.image();
            });
            if (round == 0) continue;
            planned.add(true_error(image, reference, options.size), seconds);
            spp.push_back(reached.spp);
            picked = plan.picks.back();
            for (Fixed& one : fixed) render_fixed(one, 2000 + round, reached.spp, true);
        }
        const auto best = std::min_element(fixed.begin(), fixed.end(), [](const Fixed& a, const Fixed& b) {
            return a.cost.product() < b.cost.product();
        });
        const auto row = [&](const char* choice, const std::string& builder, const std::string& sampler,
                             const Cost& cost) {
            const double rms = std::sqrt(cost.squares / options.seeds), over = cost.product() / best->cost.product();
            std::printf("%-14s %-8s %-9s %-12s %8.4f %8.3f %8.3f\n", name, choice, builder.c_str(), sampler.c_str(),
                        rms, cost.seconds / options.seeds, over);
            csv.row(name, target, measure::median(spp), choice, builder, sampler, rms, cost.seconds / options.seeds,
                    over);
        };
        std::printf("%s, %.0f spp\n%-14s %-8s %-9s %-12s %8s %8s %8s\n", picked.c_str(), measure::median(spp), "scene",
                    "choice", "builder", "sampler", "error", "seconds", "of best");
        row("planner", "", "", planned);
        for (const Fixed& one : fixed) row("fixed", one.builder, one.sampler, one.cost);
        std::fflush(stdout);
    }
    csv.write();
}

void times(const Device& device, const Options& options) {
    measure::Csv csv(options.csv, device, "scene,promised,seconds,spp");
    for (const char* name : {"cornell", "terrain:20000"})
        for (const double seconds : options.times) {
            const Scene scene = scene_of(name);
            TargetPlan plan = plan_render(
                device, scene, {.width = options.size, .height = options.size, .spp = 1u << 24, .seconds = seconds});
            Renderer renderer(device, scene, plan.config);
            const RenderProgress reached = render_to_target(device, renderer, plan);
            std::printf("%-14s promised %6.2f s, took %6.3f s: %+.1f %%, %u spp\n", name, seconds, reached.seconds,
                        100 * (reached.seconds / seconds - 1), reached.spp);
            std::fflush(stdout);
            csv.row(name, seconds, reached.seconds, reached.spp);
        }
    csv.write();
}

/// Of renders to an error, by turns with renders of as many samples that look at nothing: in one pass, on one film.
void overhead(const Device& device, const Options& options) {
    measure::Csv csv(options.csv, device, "scene,target,spp,seconds,measuring_seconds,seconds_without");
    std::printf("%-14s %5s %6s %9s %13s %21s\n", "scene", "error", "spp", "seconds", "measuring", "seconds without");
    for (const std::string& name : options.scenes)
        for (const double target : options.targets) {
            const Scene scene = scene_of(name);
            RenderConfig config{.width = options.size, .height = options.size, .spp = 1u << 24, .error = target};
            Renderer looking(device, scene, config);
            config.spp = looking.render().spp, config.error = 0;
            Renderer blind(device, scene, config);
            std::vector<double> seconds, measuring, without;
            for (unsigned round = 0; round <= options.seeds; ++round) {
                const double before = looking.statistics().measuring_seconds;
                looking.restart(0), blind.restart(0);
                const double looked = looking.render().seconds, not_looked = blind.render().seconds;
                if (round == 0) continue;  // warms up
                seconds.push_back(looked), without.push_back(not_looked);
                measuring.push_back(looking.statistics().measuring_seconds - before);
            }
            const double took = measure::median(seconds), look = measure::median(measuring),
                         blindly = measure::median(without);
            std::printf("%-14s %5.2f %6u %9.4f %6.2f ms %.2f %% %9.4f, %+.1f %%\n", name.c_str(), target, config.spp,
                        took, 1e3 * look, 100 * look / took, blindly, 100 * (took / blindly - 1));
            std::fflush(stdout);
            csv.row(name.c_str(), target, config.spp, took, look, blindly);
        }
    csv.write();
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("What choosing by target holds of what it promises");
    Options options;
    app.require_subcommand(1);
    app.fallthrough();
    app.add_option("--device", options.device, "cpu, gpu, an index or part of a name");
    app.add_option("--scenes", options.scenes, "Scenes of coverage")->delimiter(',');
    app.add_option("--targets", options.targets, "Errors of coverage")->delimiter(',');
    app.add_option("--size", options.size, "Pixels a side [48]");
    app.add_option("--spp", options.spp, "Samples per pixel of intervals [256]");
    app.add_option("--seeds", options.seeds, "Renders of each scene and target [7]");
    app.add_flag("--adaptive", options.adaptive, "coverage: with adaptive sampling");
    app.add_option("--references", options.references, "Where references are kept");
    app.add_option("--csv", options.csv, "Write the results to FILE");
    const auto add = [&](const char* name, const char* what, auto run) {
        app.add_subcommand(name, what)->final_callback([&options, run] {
            const Device device = Device::open(options.device);
            device.profiler().enable(false);  // as claray render does
            run(device, options);
        });
    };
    app.add_option("--times", options.times, "Seconds to render for [0.5 2 10 60]")->delimiter(',');
    add("coverage", "Errors reached against errors asked for", coverage);
    add("study", "coverage of forty scenes; takes a GPU", study);
    add("intervals", "Pixels within their intervals, and errors of denoised images", intervals);
    add("sweep", "The planner against every fixed choice", sweep);
    add("time", "Times kept against times asked for", times);
    add("overhead", "What measuring takes", overhead);
    CLI11_PARSE(app, argc, argv);
    return 0;
} catch (const Error& error) {
    std::fprintf(stderr, "bench_target: %s\n", error.what());
    return int(error.kind());
}
