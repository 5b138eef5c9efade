// The path tracer as a sequence of stages over queues of rays (Laine, Karras and Aila 2013, "Megakernels considered
// harmful"): generate_rays; then for each bounce trace, shade_surface, trace shadow rays, and add_light unless shadow
// rays add their light; after the last bounce empty_queues.
#pragma once

#include "host/render/wavefront/path_kernels.hpp"
#include "host/render/wavefront/queues.hpp"

namespace claray {

/// With a black horizon and zenith if an environment replaces them.
[[nodiscard]] SkyData sky_data(const Scene& scene);

/// `config`: RenderConfig or LightMapConfig.
template <class Config>
FrameData frame_without_camera(const Scene& scene, const SceneBuffers& buffers, const Config& config) {
    FrameData frame{};
    frame.sky = sky_data(scene);
    frame.width = config.width, frame.height = config.height;
    frame.seed = config.seed, frame.max_depth = config.max_depth;
    frame.lights = buffers.lights;
    return frame;
}

struct Wavefront {
    Wavefront(const SceneBuffers& on, const FrameData& of, WavefrontKernels with, std::uint64_t most_paths);

    /// Switches to other kernels and the tree that they traverse, from the next batch on, and drops `path_kernels`.
    void take_over(const Structure& structure, WavefrontKernels with);
    /// Switches to other buffers of the scene, from the next batch on.
    void replace_scene(const SceneBuffers& by);
    /// For images of another size, seen by the camera that is set next. `most_paths` of a render.
    void resize(std::uint32_t width, std::uint32_t height, std::uint64_t most_paths);
    /// Allocates what this many paths need, at most `queues.capacity`; `trace` does so itself.
    void make_room(std::uint32_t paths);

    /// Traces the paths of a batch of at most `queues.capacity`; asynchronous. Their radiance is in `queues`.
    void trace(const Batch& batch);
    /// First hits of camera rays: as `generate`; asynchronous.
    void trace_first_hits(const Batch& batch, SceneQuery& query, bool centers);

    /// First hits of the rays of `trace`, whose radiance stays; `room`: 3 floats for each path, which become 0.
    void trace_camera_rays(const Batch& batch, const Buffer<float>& room);

    // The stages; asynchronous. `limit`: an upper limit of the rays in the queue.
    [[nodiscard]] Step step_of(const Batch& batch, std::uint32_t depth, std::uint32_t limit) const;
    /// Rays through random points of the pixels, or through their centres.
    void generate(const Batch& batch, bool centers) { generate(batch, centers, queues.radiance); }
    /// All stages of the rays of `first_depth`. `arrived`: their hits are known.
    void trace_stages(const Batch& batch, bool arrived, std::uint32_t first_depth = 0);
    /// `scatter` and `look_for_light`.
    void bounce(const Batch& batch, std::uint32_t depth, std::uint32_t limit, bool arrived);
    /// `always`: also the rays that no wave follows.
    void scatter(const Batch& batch, std::uint32_t depth, std::uint32_t limit, bool arrived, bool always);
    void look_for_light(std::uint32_t depth, std::uint32_t limit);
    /// Counts the rays that shade_surface has not counted.
    void empty_queues();

    [[nodiscard]] std::uint64_t bytes() const { return buffer_bytes(queues, totals, kernels); }

    SceneBuffers scene;
    /// What all later batches see. Its size is that of the last `resize`; its guide is for the stages of kernels that
    /// know one.
    FrameData frame;
    WavefrontKernels kernels;
    Queues queues;
    RayTotals totals;
    PathKernels path_kernels;

private:
    void generate(const Batch& batch, bool centers, const Buffer<float>& radiance);
    void trace_paths(const Batch& batch);
    void trace_last_paths(const Batch& batch, std::uint32_t depth, std::uint32_t limit);
    void sum_tiles(const Batch& batch);
    void trace_shadows(std::uint32_t limit, const Buffer<std::uint32_t>& length);
    [[nodiscard]] std::uint32_t waves() const;
    [[nodiscard]] std::size_t floats_per_path() const;
    [[nodiscard]] bool is_guided() const { return frame.guide.lessons != 0 || frame.guide.guides != 0; }

    unsigned bounces_per_look_, shade_group_, paths_per_item_;
};

}  // namespace claray
