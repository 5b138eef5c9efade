// The members of claray's handles (Device, Bvh, Renderer and others), which their public headers do not show.
#pragma once

#include <memory>
#include <utility>

namespace claray {

/// The one friend of all handles.
struct Internals {
    template <class Handle>
    [[nodiscard]] static auto& pointer(Handle& handle) noexcept {
        return handle.state_;
    }
};

template <class Handle>
[[nodiscard]] typename Handle::State& state_of(const Handle& handle) noexcept {
    return *Internals::pointer(handle);
}

/// A handle of this state.
template <class Handle>
[[nodiscard]] Handle handle_of(std::shared_ptr<typename Handle::State> state) {
    Handle handle;
    Internals::pointer(handle) = std::move(state);
    return handle;
}

}  // namespace claray
