#include "host/view/web/exchange.hpp"

#include <chrono>
#include <utility>

namespace claray::view {
namespace {

constexpr std::size_t most_waiting = 256;  // commands
constexpr std::uint64_t most_streams = 32;
constexpr auto longest_wait = std::chrono::milliseconds(500);
constexpr auto longest_picture = std::chrono::seconds(10);

Bytes shared(std::string bytes) { return std::make_shared<const std::string>(std::move(bytes)); }

}  // namespace

void Exchange::publish(std::string jpeg, std::string status) {
    const std::lock_guard lock(mutex_);
    jpeg_ = shared(std::move(jpeg)), status_ = std::move(status), ++frames_;
    changed_.notify_all();
}

std::string Exchange::status() const {
    const std::lock_guard lock(mutex_);
    return status_;
}

std::uint64_t Exchange::open_stream() {
    const std::lock_guard lock(mutex_);
    return ++streams_;
}

bool Exchange::is_open(std::uint64_t stream) const {
    const std::lock_guard lock(mutex_);
    return !ended_ && stream + most_streams > streams_;
}

Bytes Exchange::next_frame(std::uint64_t& seen) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, longest_wait, [&] { return frames_ != seen || ended_; });
    return std::exchange(seen, frames_) != frames_ ? jpeg_ : nullptr;
}

Bytes Exchange::picture() {
    std::unique_lock lock(mutex_);
    const std::uint64_t before = pictures_;
    wants_picture_ = true;
    changed_.wait_for(lock, longest_picture, [&] { return pictures_ > before || ended_; });
    return pictures_ > before ? png_ : nullptr;
}

bool Exchange::wants_picture() const {
    const std::lock_guard lock(mutex_);
    return wants_picture_;
}

void Exchange::give_picture(std::string png) {
    const std::lock_guard lock(mutex_);
    png_ = shared(std::move(png)), ++pictures_, wants_picture_ = false;
    changed_.notify_all();
}

bool Exchange::add(ViewCommand command) {
    const std::lock_guard lock(mutex_);
    if (commands_.size() >= most_waiting) return false;
    commands_.push_back(std::move(command));
    return true;
}

bool Exchange::has_commands() const {
    const std::lock_guard lock(mutex_);
    return !commands_.empty();
}

std::deque<ViewCommand> Exchange::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(commands_, {});
}

void Exchange::end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
}

}  // namespace claray::view
