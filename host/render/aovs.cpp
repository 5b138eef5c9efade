#include "host/render/aovs.hpp"

namespace claray {
namespace {

QueryOptions options_of(const SceneBuffers& scene, const Buffer<Visits>& counts) {
    QueryOptions options;
    options.visits = counts;
    options.cull_back_faces = scene.textures.culls_back_faces;
    return options;
}

}  // namespace

Defines defines_of_aovs(const SceneBuffers& scene, EffectSet effects) {
    Defines defines = defines_of(effects, Stage::aovs);
    for (const auto& define : scene.structure.defines()) defines.push_back(define);
    return defines;
}

AovStage::AovStage(const SceneBuffers& scene, EffectSet effects, std::uint32_t pixels,
                   const std::vector<glm::vec2>& uvs)
    : counts_(scene.structure.device(), pixels),
      trace_(scene.structure, QueryKernel::Kind::closest, options_of(scene, counts_), {}),
      write_(load_kernel(counts_.device(), "render/write_aovs.cl", "write_aovs", defines_of_aovs(scene, effects))) {
#define CLARAY_ALLOCATE(name, kind, letters, meaning) \
    name = Buffer<AovWord<aov_kinds::kind>>(counts_.device(), pixels * sizeof(aov_kinds::kind) / sizeof(float));
    CLARAY_AOVS(CLARAY_ALLOCATE)
#undef CLARAY_ALLOCATE
    if (!uvs.empty()) uvs_ = Buffer<float>(counts_.device(), std::span(&uvs[0].x, 2 * uvs.size()));
}

void AovStage::run(Wavefront& wavefront, const Batch& batch) {
    const std::uint32_t count = batch.pixels;
    wavefront.trace_first_hits(batch, trace_, true);
#define CLARAY_ARGUMENT(name, kind, letters, meaning) , arg(#name, name)
    write_.run({count, 64}, wavefront.step_of({}, 0, count), wavefront.scene, wavefront.queues.of_depth(0).rays,
               wavefront.queues.hits, counts_, arg("uvs", uvs_) CLARAY_AOVS(CLARAY_ARGUMENT));
#undef CLARAY_ARGUMENT
}

}  // namespace claray
