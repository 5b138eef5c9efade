#include "host/measure/compare.hpp"

#include <algorithm>

#include "claray/renderer.hpp"
#include "host/measure/rays.hpp"

namespace claray::measure {
namespace {

/// Every file of kernels that a remedy is compiled into.
constexpr const char* files[] = {
    "trace/closest_hit", "trace/any_hit",        "trace/brute_force", "verify/count_claims",  "verify/graze_boxes",
    "verify/arithmetic", "verify/leave_surface", "verify/bsdf",       "render/shade_surface", "render/accumulate_film"};
const std::vector<std::string> geometry = {"CLARAY_TEXTBOOK_TRIANGLES", "CLARAY_TEXTBOOK_BOXES"};

void set_macros(const Device& device, const std::vector<std::string>& macros, unsigned value) {
    for (const char* const file : files)
        for (const std::string& macro : macros) device.set_tuning(file, macro, value);
}

/// The textbook's kernels until the end of the scope.
class Textbook {
public:
    Textbook(const Device& device, std::vector<std::string> macros) : device_(device), macros_(std::move(macros)) {
        set_macros(device_, macros_, 1);
    }
    ~Textbook() { set_macros(device_, macros_, 0); }
    Textbook(const Textbook&) = delete;
    Textbook& operator=(const Textbook&) = delete;

private:
    const Device& device_;
    std::vector<std::string> macros_;
};

/// Rays one by one until the end of the scope: neither packets nor sorting.
class OneByOne {
public:
    explicit OneByOne(const Device& device) : device_(device) {
        for (std::size_t i = 0; i < 2; ++i) {
            before_[i] = device_.tuning(files[i], "BATCH");
            device_.set_tuning(files[i], "BATCH", 0);
        }
    }
    ~OneByOne() {
        for (std::size_t i = 0; i < 2; ++i) device_.set_tuning(files[i], "BATCH", before_[i]);
    }
    OneByOne(const OneByOne&) = delete;
    OneByOne& operator=(const OneByOne&) = delete;

private:
    const Device& device_;
    unsigned before_[2] = {};
};

/// Where checks count failures (their bar is 0) all of them, else the worst figure.
double failures_of(const VerifyResult& result, std::uint64_t* tried, std::string* unit) {
    double counted = 0, worst = 0;
    bool counts = false;
    for (const VerifyCheck& c : result.checks) {
        *tried += c.tried;
        if (c.bar == 0)
            counted += c.worst, counts = true, *unit = c.unit;
        else if (!counts)
            worst = std::max(worst, c.worst), *unit = c.unit.empty() ? c.what : c.unit;
    }
    return counts ? counted : worst;
}

double least(const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); }

double median_ratio(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < a.size(); ++i) ratios.push_back(a[i] / b[i]);
    return median(ratios);
}

ComparedPair pair_of(const Device& device, const Timing& textbook, const Timing& robust) {
    return {textbook.milliseconds(), robust.milliseconds(), median_ratio(robust.rounds, textbook.rounds),
            least(robust.rounds) / least(textbook.rounds),
            device.info().type == DeviceType::cpu ? median_ratio(robust.processor, textbook.processor) : 0};
}

}  // namespace

const std::vector<Remedy>& remedies() {
    static const std::vector<Remedy> all = {
        {"filter and exact step",
         "Moeller-Trumbore in float32",
         {"CLARAY_TEXTBOOK_TRIANGLES"},
         {"edges", "vertices", "slivers", "close-surfaces"}},
        {"padded boxes",
         "fma(plane, 1/d, -o/d), no pad",
         {"CLARAY_TEXTBOOK_BOXES"},
         {"boxes", "axis-rays", "huge-coordinates"}},
        {"strict arithmetic",
         "-cl-fast-relaxed-math",
         {"CLARAY_FAST_MATH"},
         {"arithmetic", "edges", "ray-ends", "junk"}},
        {"offset by error bound", "a constant 1e-4", {"CLARAY_TEXTBOOK_OFFSET"}, {"self-intersection"}},
        {"GGX by the sine", "GGX by the cosine", {"CLARAY_TEXTBOOK_GGX"}, {"ggx-density"}},
        {"sums in two floats", "sums in one", {"CLARAY_TEXTBOOK_SUMS"}, {"accumulation"}},
    };
    return all;
}

std::vector<ComparedFailures> compare_failures(const Device& device, const Remedy& remedy,
                                               const VerifyOptions& options) {
    std::vector<ComparedFailures> all;
    VerifyOptions how = options;
    how.times = false;
    for (const std::string& name : remedy.cases) {
        ComparedFailures c{remedy.name, remedy.textbook, name, {}};
        const OneByOne one_by_one(device);
        std::uint64_t again = 0;
        c.shipped = failures_of(run_verify_case(device, name, how), &c.tried, &c.unit);
        const Textbook textbook(device, remedy.macros);
        c.by_textbook = failures_of(run_verify_case(device, name, how), &again, &c.unit);
        all.push_back(c);
    }
    return all;
}

std::vector<ComparedTimes> compare_times(const Device& device, const std::string& scene, unsigned width,
                                         unsigned height, int rounds) {
    const std::vector<Mesh> meshes = load_meshes(scene);
    const Bvh bvh = Bvh::build(device, meshes, {.builder = Builder::balanced});
    std::vector<std::string> with_fast_math = geometry;
    with_fast_math.emplace_back("CLARAY_FAST_MATH");
    std::vector<ComparedTimes> all;
    for (DeviceRays& rays : upload_rays(device, scene, meshes, width, height)) {
        const auto trace_by = [&](const std::vector<std::string>& macros) {
            const Textbook textbook(device, macros);
            rays.trace(bvh);
        };
        const auto one_by_one = [&](const std::vector<std::string>& macros) {
            const OneByOne scope(device);
            trace_by(macros);
        };
        const auto timings =
            measure_rounds(device, rounds,
                           {[&] { trace_by(geometry); }, [&] { trace_by({}); }, [&] { one_by_one(geometry); },
                            [&] { one_by_one({}); }, [&] { one_by_one(with_fast_math); }});
        all.push_back({scene, rays.name, pair_of(device, timings[0], timings[1]),
                       pair_of(device, timings[2], timings[3]), timings[4].milliseconds()});
    }
    return all;
}

std::vector<ComparedKernel> compare_kernels(const Device& device, int rounds) {
    const Scene scene = *builtin_scene("spheres");
    std::vector<ComparedKernel> all;
    const std::pair<std::size_t, const char*> pairs[] = {
        {3, "shade_surface"}, {4, "shade_surface"}, {5, "accumulate_film"}};
    for (const auto& [index, kernel] : pairs) {
        const Remedy& remedy = remedies()[index];
        const RenderConfig config{.width = 128, .height = 96, .spp = 4};
        const auto render = [&] { (void)Renderer(device, scene, config).render(); };
        const auto timings = measure_rounds(device, rounds,
                                            {[&] {
                                                 const Textbook textbook(device, remedy.macros);
                                                 render();
                                             },
                                             render});
        all.push_back({remedy.name, kernel, timings[0].commands.at(kernel), timings[1].commands.at(kernel),
                       timings[1].least.at(kernel) / timings[0].least.at(kernel)});
    }
    return all;
}

}  // namespace claray::measure
