#include "host/accuracy/studies/kept_renderer.hpp"

#include <algorithm>
#include <memory>
#include <mutex>

#include "host/compute/memory.hpp"
#include "host/render/parts/scene_parts.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

/// All of them, of all devices.
struct AllKept {
    std::mutex mutex;
    std::vector<KeptRenderer*> renderers;
    std::uint64_t uses = 0;
};
AllKept& all_kept() {
    static AllKept all;
    return all;
}

}  // namespace

MacroScope::MacroScope(const Device& device, const std::vector<Macro>& macros)
    : device_(device), before_(state_of(device).tuning) {
    for (const Macro& macro : macros) device_.set_tuning(macro.kernel, macro.name, macro.value);
}
MacroScope::~MacroScope() { state_of(device_).tuning = before_; }

std::uint64_t bytes_of_renderer(const Device& device, const Scene& scene) {
    return ample_bytes_of(scene) + device.info().memory / share_of_wavefront;
}

KeptRenderer::KeptRenderer(const Device& device, const Scene& scene, const RenderConfig& config,
                           std::vector<MacroScope::Macro> macros, double short_seconds, const AmbientData& ambient)
    : device_(device),
      scene_(scene),
      config_(config),
      macros_(std::move(macros)),
      short_seconds_(short_seconds),
      ambient_(ambient) {
    config_.seconds = config_.noise = config_.error = 0;
    AllKept& all = all_kept();
    const std::lock_guard lock(all.mutex);
    all.renderers.push_back(this);
}

KeptRenderer::~KeptRenderer() {
    AllKept& all = all_kept();
    const std::lock_guard lock(all.mutex);
    std::erase(all.renderers, this);
}

void KeptRenderer::make_room() const {
    const std::uint64_t percent = device_.tuning("accuracy/renderers", "MEMORY_PERCENT");
    const std::uint64_t most = device_.info().memory / 100 * percent, needed = bytes_of_renderer(device_, scene_);
    AllKept& all = all_kept();
    const std::lock_guard lock(all.mutex);
    while (bytes_in_use(device_) + needed > most) {
        KeptRenderer* oldest = nullptr;
        for (KeptRenderer* other : all.renderers)
            if (&state_of(other->device_) == &state_of(device_) && other->renderer_ &&
                (!oldest || other->last_use_ < oldest->last_use_))
                oldest = other;
        if (!oldest) return;
        oldest->renderer_.reset();
    }
}

void KeptRenderer::make() {
    make_room();
    Renderer::State& state = state_of(renderer_.emplace(device_, scene_, config_));
    state.wavefront.frame.ambient = ambient_;
    state.settle();
    last_ = {};
}

/// The rounds of adaptive sampling depend on the number of samples at the end. A short guided render has not learned
/// all that a longer one needs. In a short render the parts take longer than the whole: each has launches of its own.
bool KeptRenderer::continues(std::uint32_t seed, unsigned spp, unsigned max_depth) const {
    const bool learns_more = may_guide_paths(device_, config_) && PathGuide::is_for(config_) &&
                             last_.spp <= teaching_spp && spp > unguided_spp;
    return !config_.adaptive && !learns_more && last_.seconds > short_seconds_ && last_.spp > 0 && last_.spp < spp &&
           last_.seed == seed && last_.max_depth == max_depth;
}

Rendered KeptRenderer::render(std::uint32_t seed, unsigned spp, unsigned max_depth) {
    const MacroScope scope(device_, macros_);
    if (!renderer_) make();
    {
        AllKept& all = all_kept();
        const std::lock_guard lock(all.mutex);
        last_use_ = ++all.uses;
    }
    double before = 0;
    if (continues(seed, spp, max_depth))
        state_of(*renderer_).extend(spp), before = last_.seconds;
    else
        renderer_->restart(seed, spp, max_depth);
    last_ = {seed, spp, max_depth, before + renderer_->render().seconds};
    return {renderer_->image(), last_.seconds};
}

RenderMethod render_with(const Device& device, const Scene& scene, const RenderConfig& config,
                         std::vector<MacroScope::Macro> macros, const AmbientData& ambient) {
    constexpr double short_seconds = 0.1;
    return [kept = std::make_shared<KeptRenderer>(device, scene, config, std::move(macros), short_seconds, ambient)](
               std::uint32_t seed, unsigned spp) { return kept->render(seed, spp); };
}

Rendered render_image(const Device& device, const Scene& scene, const RenderConfig& config) {
    return render_with(device, scene, config)(config.seed, config.spp);
}

}  // namespace claray
