#include "claray/verify.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <future>
#include <map>
#include <set>
#include <thread>

#include "host/verify/cases/cases.hpp"
#include "host/verify/kernels_run.hpp"
#include "host/verify/run.hpp"

namespace claray {
namespace {

struct Entry {
    VerifyCase about;
    void (*run)(verify::Run&);
    bool measures_times = false;
};

using namespace verify;

const std::vector<Entry> entries = {
    {{"arithmetic", "device",
      "+ - * and fma, and with float64 division, are rounded as IEEE 754 says; nothing is contracted"},
     arithmetic},
    {{"approximations", "device", "Reciprocals and square roots are as accurate as the error bounds assume"},
     approximations},
    {{"float-atomics", "device", "Minima and maxima of floats by integer atomics, with -0, denormals and infinities"},
     float_atomics},
    {{"sort", "device", "Radix sort is stable with many equal keys"}, sort_order},
    {{"edges", "triangles", "Rays through edges from inside a closed mesh hit exactly one triangle"}, edges},
    {{"vertices", "triangles", "Rays through vertices from inside a closed mesh hit exactly one triangle"}, vertices},
    {{"integer-edges", "triangles", "Rays through edges and vertices with determinants of exactly 0"}, integer_edges},
    {{"fans", "triangles", "Fans of 4 to 65,536 triangles have exactly one hit everywhere"}, fans},
    {{"closed-meshes", "triangles", "Rays leave random closed meshes exactly once"}, closed_meshes},
    {{"slivers", "triangles", "Slivers and tiny triangles against exact arithmetic"}, slivers},
    {{"rays-in-planes", "triangles", "Rays in a triangle's plane hit nothing"}, rays_in_planes},
    {{"scales", "triangles", "Scaling by a power of two changes no hit"}, scales},
    {{"huge-coordinates", "triangles", "Scenes far from the origin against exact arithmetic"}, huge_coordinates},
    {{"far-origins", "triangles", "Rays that begin far from the scene against exact arithmetic"}, far_origins},
    {{"close-surfaces", "triangles", "The first of several sheets one rounding apart is hit"}, close_surfaces},
    {{"duplicates", "triangles", "The first in the input of several equal triangles is hit"}, duplicates},
    {{"ray-ends", "triangles", "Rays are open at tmin and closed at tmax; NaN, infinite and zero ones hit nothing"},
     ray_ends},
    {{"boxes", "boxes", "No box test misses a box that a grazing ray hits"}, boxes},
    {{"axis-rays", "boxes", "Rays along the axes that begin on faces of boxes: correct, and as fast as others"},
     axis_rays,
     true},
    {{"tiny-counts", "trees", "0, 1, 2 and a few triangles with every builder and layout"}, tiny_counts},
    {{"junk", "trees", "A tenth of NaN, infinite, huge and degenerate triangles changes no hit"}, junk, true},
    {{"equal-codes", "trees", "Equal, collinear and planar triangles: sound trees of bounded height"},
     equal_codes,
     true},
    {{"stadium", "trees", "Nine tenths of the triangles in a cluster of 1e-4 of the scene's size"}, stadium},
    {{"stack-depth", "trees", "The deepest tree that codes allow fits the stack"}, stack_depth},
    {{"rebuilds", "trees", "Repeated rebuilds give the same valid tree: the fences work"}, rebuilds},
    {{"ggx-density", "materials", "Density of narrow GGX lobes, alpha down to 1e-4"}, ggx_density},
    {{"ggx-energy", "materials", "Single scattering of GGX equals quadrature; 1 - ln 2 at alpha 1"}, ggx_energy},
    {{"furnaces", "materials", "White materials scatter all light and not more, at every angle and roughness"},
     furnaces},
    {{"fresnel", "materials", "Fresnel equations up to total reflection and with nearly equal indices"}, fresnel},
    {{"bsdf-reciprocity", "materials", "f(i, o) = f(o, i)"}, bsdf_reciprocity},
    {{"bsdf-sampling", "materials", "Sampled directions follow the stated density: chi-squared"}, bsdf_sampling},
    {{"shading-normals", "materials", "Shading normals face the viewer and reflect away from the surface"},
     shading_normals},
    {{"nested-media", "images", "Light in bodies that touch, overlap or enclose others, against float64"},
     nested_media},
    {{"self-intersection", "images", "Rays that leave a surface do not hit it at any scale, and begin close to it"},
     self_intersection},
    {{"nan-pixels", "images",
      "No sample of the built-in scenes is NaN or infinite, and such samples do not reach the image"},
     nan_pixels},
    {{"accumulation", "images", "Sums of millions of samples with heavy tails"}, accumulation},
    {{"srgb", "images", "The sRGB curve restores all bytes"}, srgb},
    {{"spherical-harmonics", "images", "Spherical harmonics are orthonormal and keep the irradiance of a constant sky"},
     spherical_harmonics},
    {{"environment-poles", "images", "Directions of an environment image, with its poles and its seam"},
     environment_poles},
    {{"height-fields", "images", "Normals from heights converge with the square of the texel size"}, height_fields},
    {{"alpha-coverage", "images", "Alpha masks cover the same area from far away"}, alpha_coverage},
    {{"light-at-distance-0", "images", "Lamps on a surface: finite, and no more than a hemisphere of light"},
     light_distance_zero},
    {{"shadow-terminator", "images", "A coarse sphere with smooth normals is lit according to its normals"},
     shadow_terminator},
    {{"image-statistics", "images", "Two samplers agree in every pixel within their noise"}, image_statistics},
    {{"depth-to-position", "images", "Positions restored from reversed float depth are those of the surfaces"},
     depth_to_position},
    {{"packed-normals", "images", "Octahedral and spherical normals of 2 x 16 bits are within half a step"},
     packed_normals},
    {{"wave-equation", "images", "Water obeys the wave equation: energy, dispersion, and the same heights everywhere"},
     wave_equation},
    {{"tree-hashes", "sameness", "All devices and runs build the same trees"}, tree_hashes},
    {{"hit-hashes", "sameness", "All devices, layouts, orders and schedules find the same hits"}, hit_hashes},
    {{"image-hashes", "sameness", "A device renders the same image in every run and with all batch sizes"},
     image_hashes},
};

const Entry& entry_of(const std::string& name) {
    for (const Entry& entry : entries)
        if (entry.about.name == name) return entry;
    std::string names;
    for (const Entry& entry : entries) names += (names.empty() ? "" : ", ") + entry.about.name;
    throw Error(ErrorKind::usage, "unknown case '" + name + "'", "choose one of " + names);
}

VerifyResult run_case(const Device& device, Devices& more, const std::string& name, const VerifyOptions& options) {
    const Entry& entry = entry_of(name);
    VerifyResult result;
    result.name = name, result.seed = options.seed;
    result.command = "claray verify --case " + name + (options.effort == Effort::full ? " --full" : " --quick") +
                     " --seed " + std::to_string(options.seed) + " --device '" + std::to_string(device.info().index) +
                     "'";
    const auto begin = std::chrono::steady_clock::now();
    verify::Run run(device, more, options, result);
    {
        const KernelsRun kernels(device, options.kernels, result.kernels);
        entry.run(run);
    }
    device.finish();
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return result;
}

/// A smaller number for cases that compile longer: nan-pixels renders with all effects at once.
int rank_of(const std::string& name) {
    const std::string family = entry_of(name).about.family;
    return name == "nan-pixels" ? 0 : family == "images" || family == "materials" ? 1 : 2;
}

/// Cases that run side by side, in an order that begins with those that compile longest.
class Crew {
public:
    Crew(const Device& device, Devices& more, std::vector<std::string> names, const VerifyOptions& options)
        : more_(more), names_(std::move(names)) {
        std::stable_sort(names_.begin(), names_.end(),
                         [](const std::string& a, const std::string& b) { return rank_of(a) < rank_of(b); });
        for (const std::string& name : names_) found_[name] = results_.emplace_back().get_future();
        work_ = std::thread([this, device, options] {
            side_by_side(device, more_, options.threads, names_.size(), [&](const Device& on, std::size_t i) {
                if (!ends_) run(on, i, options);
            });
        });
    }
    ~Crew() {
        ends_ = true;  // cases that have not begun are cancelled
        wait();
    }
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;

    [[nodiscard]] bool has(const std::string& name) const { return found_.contains(name); }
    /// Waits for the case.
    [[nodiscard]] const VerifyResult& result_of(const std::string& name) const { return found_.at(name).get(); }
    /// Waits until no case is running.
    void wait() {
        if (work_.joinable()) work_.join();
    }

private:
    void run(const Device& device, std::size_t i, const VerifyOptions& options) {
        try {
            results_[i].set_value(run_case(device, more_, names_[i], options));
        } catch (...) {
            results_[i].set_exception(std::current_exception());
        }
    }

    Devices& more_;
    std::vector<std::string> names_;
    std::deque<std::promise<VerifyResult>> results_;
    std::map<std::string, std::shared_future<VerifyResult>> found_;
    std::atomic<bool> ends_{false};
    std::thread work_;
};

/// A CPU driver already has a thread per processor. GPUs wait for compilers.
unsigned threads_for(const Device& device, const VerifyOptions& options) {
    if (options.threads != 0) return options.threads;
    if (device.info().type != DeviceType::gpu) return 1;
    return contexts_at_once();
}

VerifyOptions with_threads(const Device& device, VerifyOptions options) {
    options.threads = threads_for(device, options);
    return options;
}

}  // namespace

bool VerifyResult::holds() const {
    return std::all_of(checks.begin(), checks.end(), [](const VerifyCheck& c) { return c.holds(); });
}

const std::vector<VerifyCase>& verify_cases() {
    static const std::vector<VerifyCase> cases = [] {
        std::vector<VerifyCase> all;
        for (const Entry& entry : entries) all.push_back(entry.about);
        return all;
    }();
    return cases;
}

void check_verify_cases(std::span<const std::string> names) {
    for (const std::string& name : names) (void)entry_of(name);
}

VerifyResult run_verify_case(const Device& device, const std::string& name, const VerifyOptions& options) {
    Devices more(device);
    return run_case(device, more, name, with_threads(device, options));
}

void run_verify_cases(const Device& device, std::span<const std::string> names, const VerifyOptions& with,
                      const std::function<void(const VerifyResult&)>& report) {
    const VerifyOptions options = with_threads(device, with);
    std::set<std::string> side_by_side;
    for (const std::string& name : names)
        if (!(entry_of(name).measures_times && options.times) && options.threads > 1) side_by_side.insert(name);
    Devices more(device);
    Crew crew(device, more, {side_by_side.begin(), side_by_side.end()}, options);
    for (const std::string& name : names) {
        if (crew.has(name)) {
            report(crew.result_of(name));
            continue;
        }
        crew.wait();
        report(run_case(device, more, name, options));
    }
}

}  // namespace claray
