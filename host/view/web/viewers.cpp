#include "host/view/web/viewers.hpp"

namespace claray::view {
namespace {

constexpr auto longest_silence = std::chrono::seconds(5);  // a page asks for frames twice a second
constexpr std::size_t most_names = 1000;

}  // namespace

void Viewers::forget(Clock::time_point now) {
    std::erase_if(seen_, [&](const auto& page) { return now - page.second > longest_silence; });
    if (!seen_.contains(steerer_)) steerer_.clear();
}

std::size_t Viewers::saw(const std::string& name) {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    if (!name.empty() && (seen_.contains(name) || seen_.size() < most_names)) seen_[name] = now;
    forget(now);
    if (steerer_.empty() && seen_.contains(name)) steerer_ = name;
    return seen_.size();
}

bool Viewers::may_steer(const std::string& name) {
    if (name.empty()) return true;
    (void)saw(name);
    return steers(name);
}

bool Viewers::steers(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    return !name.empty() && name == steerer_;
}

void Viewers::take(const std::string& name) {
    (void)saw(name);
    const std::lock_guard lock(mutex_);
    if (seen_.contains(name)) steerer_ = name;
}

}  // namespace claray::view
