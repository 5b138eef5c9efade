#include "host/accuracy/studies/ray_variants.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "claray/shared/study_nodes.h"
#include "host/bvh/bvh_state.hpp"
#include "host/measure/measure.hpp"
#include "host/measure/rays.hpp"

namespace claray {
namespace {

/// A variant with its buffers.
class Tracer {
public:
    Tracer(const RayVariant& variant, const Bvh& binary, const Bvh& shipped, const Buffer<Ray>& rays)
        : variant_(variant), binary_(binary), shipped_(shipped), rays_(rays), hits_(binary.device(), rays.size()) {
        if (variant_.shipped) return;
        if (variant_.node_bits != 32) quantize();
        kernel_ = load(0);
    }

    void run() { variant_.shipped ? closest_hit(shipped_, rays_, hits_) : run(kernel_, Buffer<Visits>()); }
    [[nodiscard]] std::vector<Hit> hits() const { return hits_.read(); }

    [[nodiscard]] double boxes_a_ray() {
        if (!variant_.counts_boxes || rays_.size() == 0) return 0;
        const Buffer<Visits> visits(binary_.device(), rays_.size());
        run(load(1), visits);
        double sum = 0;
        for (const Visits& v : visits.read()) sum += v.nodes;
        return sum / double(rays_.size());
    }

private:
    void quantize() {
        const auto nodes = std::uint32_t(state_of(binary_).nodes.size());
        const std::size_t words = CLARAY_QUANTIZED_WORDS(variant_.node_bits);
        quantized_ = Buffer<std::uint32_t>(binary_.device(), words * nodes);
        load_kernel(binary_.device(), "accuracy/quantize_nodes.cl", "quantize_nodes",
                    {{"NODE_BITS", std::to_string(variant_.node_bits)}})
            .run({nodes, 64}, state_of(binary_).nodes, nodes, quantized_);
    }

    /// Groups and items are those of the shipped query.
    [[nodiscard]] Kernel load(unsigned count_visits) const {
        Defines defines = variant_.defines;
        const Device& device = binary_.device();
        defines.emplace_back("NODE_BITS", std::to_string(variant_.node_bits));
        defines.emplace_back("CLARAY_COUNT_VISITS", std::to_string(count_visits));
        defines.emplace_back("GROUP_SIZE", std::to_string(group()));
        defines.emplace_back("RAYS_PER_ITEM", std::to_string(rays_per_item()));
        return load_kernel(device, "accuracy/trace_variant.cl", "trace_variant", defines, variant_.math);
    }
    [[nodiscard]] unsigned group() const {
        return std::max(1u, binary_.device().tuning("trace/closest_hit", "GROUP_SIZE"));
    }
    [[nodiscard]] unsigned rays_per_item() const {
        return std::max(1u, binary_.device().tuning("trace/closest_hit", "RAYS_PER_ITEM"));
    }

    void run(Kernel kernel, const Buffer<Visits>& visits) {
        const auto count = std::uint32_t(rays_.size());
        const Range range{(count + rays_per_item() - 1) / rays_per_item(), group()};
        const auto start = [&](const auto& nodes) {
            kernel.run(range, state_of(binary_).header, nodes, state_of(binary_).leaves, rays_, count, hits_, visits);
        };
        variant_.node_bits == 32 ? start(state_of(binary_).nodes) : start(quantized_);
    }

    RayVariant variant_;
    const Bvh& binary_;
    const Bvh& shipped_;
    const Buffer<Ray>& rays_;
    Buffer<Hit> hits_;
    Buffer<std::uint32_t> quantized_;
    Kernel kernel_;
};

/// How many runs take at least `least_seconds`.
unsigned repeats_of(const Device& device, Tracer& tracer, double least_seconds) {
    constexpr double most = 1000;
    if (!(least_seconds > 0)) return 1;
    const double milliseconds = measure::measure(device, 1, [&] { tracer.run(); }).at("");
    return unsigned(std::clamp(std::ceil(1e3 * least_seconds / std::max(milliseconds, 1e-6)), 1.0, most));
}

}  // namespace

std::vector<TracedVariant> trace_variants(const Device& device, std::span<const Mesh> meshes, std::span<const Ray> rays,
                                          const std::vector<RayVariant>& variants, const StudyOptions& options,
                                          const AccuracyProgress& progress) {
    const unsigned rounds = rounds_of(options);
    const Bvh binary = Bvh::build(device, meshes, {.builder = Builder::balanced, .layout = Layout::binary});
    const Bvh shipped = Bvh::build(device, binary.triangles(), {.builder = Builder::balanced});
    const Buffer<Ray> device_rays(device, rays);
    std::vector<TracedVariant> traced(variants.size());
    std::vector<std::unique_ptr<Tracer>> tracers;
    const double steps = double(variants.size()) * (rounds + 3);  // compiling one takes about as long as two rounds
    double done = 0;
    bool goes_on = true;
    const auto tell = [&](double step, const std::string& what) {
        done += step;
        goes_on = goes_on && (!progress || progress(done / steps, what));
    };
    for (const RayVariant& variant : variants) {
        if (!goes_on) return traced;
        tracers.push_back(std::make_unique<Tracer>(variant, binary, shipped, device_rays));
        tell(2, "compiling " + variant.method + ", " + variant.setting);
    }
    std::vector<unsigned> repeats;
    for (const auto& tracer : tracers) repeats.push_back(repeats_of(device, *tracer, options.least_seconds));
    std::vector<std::function<void()>> tasks;
    for (std::size_t i = 0; i < tracers.size(); ++i)
        tasks.emplace_back([&, i] {
            if (!goes_on) return;
            for (unsigned k = 0; k < repeats[i]; ++k) tracers[i]->run();
            device.finish();
            tell(1, "tracing, " + variants[i].method);
        });
    const std::vector<measure::Timing> timings = measure::measure_rounds(device, int(rounds), tasks);
    if (!goes_on) return traced;
    for (std::size_t i = 0; i < tracers.size(); ++i) {
        traced[i].hits = tracers[i]->hits(), traced[i].boxes = tracers[i]->boxes_a_ray();
        for (const double ms : timings[i].rounds) traced[i].seconds.push_back(1e-3 * ms / repeats[i]);
    }
    return traced;
}

std::size_t rays_to_judge(std::size_t wanted, std::span<const Mesh> meshes) {
    std::size_t triangles = 1;
    for (const Mesh& mesh : meshes) triangles += mesh.triangles.size();
    return std::clamp<std::size_t>(std::size_t(2'000'000'000) / triangles, 1024, std::max<std::size_t>(wanted, 1024));
}

std::vector<Ray> rays_of_scene(const Device& device, const Scene& scene, std::span<const Mesh> meshes,
                               std::size_t count) {
    Scene world;
    world.meshes.assign(meshes.begin(), meshes.end());
    const Camera camera = camera_of(scene);
    const auto side = unsigned(std::max(1.0, std::sqrt(double(count) / 2)));
    measure::RaySets sets = measure::make_rays(device, world, {{camera, camera.position}}, side, side);
    sets.primary.insert(sets.primary.end(), sets.bounce.begin(), sets.bounce.end());
    return std::move(sets.primary);
}

}  // namespace claray
