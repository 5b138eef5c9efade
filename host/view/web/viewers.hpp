// Who looks at the view, and who steers it.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>

namespace claray::view {

/// Pages that are open. Each has a name of its own; one of them steers. All functions may be called by any thread.
class Viewers {
public:
    /// A page asked for a frame. Returns how many pages did so in the last seconds.
    std::size_t saw(const std::string& name);
    /// Whether this page may send commands. A page that nobody steers before becomes the one that steers. Programs
    /// that give no name may always.
    [[nodiscard]] bool may_steer(const std::string& name);
    [[nodiscard]] bool steers(const std::string& name) const;
    /// From now on this page steers.
    void take(const std::string& name);

private:
    using Clock = std::chrono::steady_clock;
    void forget(Clock::time_point now);

    mutable std::mutex mutex_;
    std::map<std::string, Clock::time_point> seen_;
    std::string steerer_;
};

}  // namespace claray::view
