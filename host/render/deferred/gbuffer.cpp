#include "host/render/deferred/gbuffer.hpp"

#include <algorithm>

#include "claray/shared/lists/projections.h"
#include "host/compute/read_back.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

constexpr float near_share = 1e-3f;  // of the far distance

QueryOptions options_of_gbuffer(const SceneBuffers& scene) {
    QueryOptions options;
    options.cull_back_faces = scene.textures.culls_back_faces;
    return options;
}

/// From the position in the image (-1 to 1 on both axes, y upwards), the depth and 1 to a position, up to its w.
glm::dmat4 world_from_image(const CameraData& c, double near, double far) {
    const glm::dvec4 right(c.right_x, c.right_y, c.right_z, 0), up(c.up_x, c.up_y, c.up_z, 0);
    const glm::dvec4 forward(c.forward_x, c.forward_y, c.forward_z, 0), place(c.x, c.y, c.z, 1);
    if ((c.projection & (CLARAY_SIDE_BY_SIDE | CLARAY_TOP_BOTTOM | CLARAY_SHIFTED)) != 0)
        throw Error(claray::ErrorKind::usage, "no matrix describes the depths of two eyes or of a lens shift",
                    "use a camera with one eye and without shift");
    if (const ProjectionTraits* traits = traits_of(Projection(c.projection & CLARAY_KIND_BITS)); !traits->flat)
        throw Error(claray::ErrorKind::usage,
                    std::string("no matrix describes the depths of the projection ") + traits->name,
                    "ask for the AOV depth");
    if (has_parallel_rays(c.projection)) return {right, up, -far * forward, place + far * forward};
    return {near * right, near * up, place, near * forward};
}

}  // namespace

GBufferStage::GBufferStage(const SceneBuffers& scene, EffectSet effects, std::uint32_t pixels)
    : trace_(scene.structure, QueryKernel::Kind::closest, options_of_gbuffer(scene), {}),
      write_(load_kernel(scene.structure.device(), "deferred/write_gbuffer.cl", "write_gbuffer",
                         defines_of_aovs(scene, effects))),
      pixels_(scene.structure.device(), pixels) {}

GBuffer GBufferStage::run(Wavefront& wavefront, NormalPacking packing, float far) {
    const FrameData& frame = wavefront.frame;
    const float near = near_share * far;
    GBuffer buffer;
    buffer.width = frame.width, buffer.height = frame.height;
    buffer.normals = packing;
    buffer.world_from_image = world_from_image(frame.camera, near, far);
    const std::size_t all = std::size_t(frame.width) * frame.height;
    VectorRoom<GBufferPixel> pixels(all);
    for (std::size_t first = 0; first < all; first += pixels_.size()) {
        const auto count = std::uint32_t(std::min(pixels_.size(), all - first));
        wavefront.trace_first_hits({std::uint32_t(first), count, 0, 1, 0}, trace_, true);
        write_.run({count, 64}, wavefront.step_of({}, 0, count), wavefront.scene, wavefront.queues.of_depth(0).rays,
                   wavefront.queues.hits, near, far, std::uint32_t(packing == NormalPacking::spherical), pixels_);
        read_back(pixels_, pixels.span().subspan(first, count));
    }
    buffer.pixels = pixels.take();
    return buffer;
}

glm::vec3 normal_of(const GBuffer& buffer, std::size_t pixel) {
    const std::uint32_t code = buffer.pixels[pixel].normal;
    if (code == CLARAY_NO_SURFACE) return glm::vec3(0.f);
    const UnitVector n =
        buffer.normals == NormalPacking::spherical ? claray_unpack_spherical(code) : claray_unpack_octahedral(code);
    return {n.x, n.y, n.z};
}

glm::vec3 position_of(const GBuffer& buffer, std::size_t pixel) {
    const double x = 2 * (double(pixel % buffer.width) + 0.5) / buffer.width - 1;
    const double y = 1 - 2 * (double(pixel / buffer.width) + 0.5) / buffer.height;
    const glm::dvec4 place = buffer.world_from_image * glm::dvec4(x, y, buffer.pixels[pixel].depth, 1);
    return glm::vec3(glm::dvec3(place) / place.w);
}

GBuffer Renderer::gbuffer(NormalPacking packing) const {
    State& state = *state_;
    state.refuse_with_region("a G-buffer is of whole images only");
    if (!state.outputs.gbuffer)
        state.outputs.gbuffer.emplace(state.buffers, state.wavefront.kernels.config.effects,
                                      std::min<std::uint32_t>(state.wavefront.queues.capacity, state.pixels()));
    return state.outputs.gbuffer->run(state.wavefront, packing, float(2 * state.buffers.radius()));
}

}  // namespace claray
