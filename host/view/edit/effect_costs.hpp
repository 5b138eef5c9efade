// The cost of the effects of a scene, measured while the view goes on.
#pragma once

#include <atomic>
#include <future>
#include <memory>
#include <string>

#include "host/measure/explain.hpp"

namespace claray::view {

/// Measures in a thread of its own, with a queue of its own. The thread ends soon after this object.
class EffectCosts {
public:
    EffectCosts() = default;
    ~EffectCosts() { cancel(); }
    EffectCosts(EffectCosts&&) = default;
    EffectCosts& operator=(EffectCosts&& other) noexcept {
        cancel();
        cancelled_ = std::move(other.cancelled_), measured_ = std::move(other.measured_);
        explanation_ = std::move(other.explanation_);
        return *this;
    }

    /// Begins to measure the scene as it is now. Another measurement ends.
    void begin(const Device& device, const Scene& scene, RenderConfig render);
    [[nodiscard]] bool is_running() const { return measured_.valid(); }
    [[nodiscard]] bool is_ready() const;
    /// Takes the result once it is ready, and returns whether it did. Throws what went wrong.
    [[nodiscard]] bool take();
    /// The last result; without effects before the first.
    [[nodiscard]] const measure::Explanation& explanation() const { return explanation_; }

private:
    void cancel();

    std::shared_ptr<std::atomic<bool>> cancelled_;
    std::future<measure::Explanation> measured_;
    measure::Explanation explanation_;
};

}  // namespace claray::view
