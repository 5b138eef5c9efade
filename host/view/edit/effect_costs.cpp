#include "host/view/edit/effect_costs.hpp"

#include <chrono>

namespace claray::view {
namespace {

constexpr unsigned side = 128;  // pixels: what is compared are times of the same samples

}  // namespace

void EffectCosts::begin(const Device& device, const Scene& scene, RenderConfig render) {
    cancel();
    render.width = render.height = side;
    measure::ExplainOptions options;
    options.only = effects_of(scene), options.approximations = {};
    options.everything = options.compile_times = false;
    const auto cancelled = cancelled_ = std::make_shared<std::atomic<bool>>(false);
    const auto go_on = [cancelled](const std::string&) {
        if (*cancelled) throw Error(ErrorKind::user, "the measurement was ended", "begin another");
    };
    measured_ = std::async(std::launch::async, [=, own = device.with_new_queue()] {
        return measure::explain(own, scene, render, options, go_on);
    });
}

bool EffectCosts::is_ready() const {
    return measured_.valid() && measured_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

bool EffectCosts::take() {
    if (!is_ready()) return false;
    explanation_ = measured_.get();
    return true;
}

/// The thread looks at this from one step to the next.
void EffectCosts::cancel() {
    if (!measured_.valid()) return;
    *cancelled_ = true;
    measured_.wait();
    measured_ = {};
}

}  // namespace claray::view
