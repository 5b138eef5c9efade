#include "host/view/web/exchange.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace claray::view {
namespace {

constexpr std::size_t most_waiting = 256;  // commands
constexpr std::uint64_t most_streams = 32;
constexpr auto longest_wait = std::chrono::milliseconds(500);
constexpr auto longest_idle = std::chrono::milliseconds(50);     // until it is asked whether the view goes on
constexpr auto longest_display = std::chrono::milliseconds(25);  // as a browser on the same processor takes
constexpr auto longest_making = std::chrono::seconds(10);

Bytes shared(std::string bytes) { return std::make_shared<const std::string>(std::move(bytes)); }

}  // namespace

void Exchange::publish(std::string jpeg, std::string status, std::string state) {
    const std::lock_guard lock(mutex_);
    jpeg_ = shared(std::move(jpeg)), status_ = std::move(status), state_ = std::move(state), ++frames_;
    changed_.notify_all();
}

std::string Exchange::status() const {
    const std::lock_guard lock(mutex_);
    return status_;
}

std::string Exchange::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

void Exchange::set_state(std::string state) {
    const std::lock_guard lock(mutex_);
    state_ = std::move(state);
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
    if (seen <= frames_ && seen > shown_) shown_ = seen, asked_.notify_all();
    changed_.wait_for(lock, longest_wait, [&] { return frames_ != seen || ended_; });
    return std::exchange(seen, frames_) != frames_ ? jpeg_ : nullptr;
}

Bytes Exchange::ask(Made what) {
    std::unique_lock lock(mutex_);
    Wish& wish = wishes_.at(std::size_t(what));
    const std::uint64_t before = wish.count;
    wish.is_open = true;
    asked_.notify_all();
    changed_.wait_for(lock, longest_making, [&] { return wish.count > before || ended_; });
    return wish.count > before ? wish.bytes : nullptr;
}

bool Exchange::wants(Made what) const {
    const std::lock_guard lock(mutex_);
    return wishes_.at(std::size_t(what)).is_open;
}

void Exchange::give(Made what, std::string bytes) {
    const std::lock_guard lock(mutex_);
    Wish& wish = wishes_.at(std::size_t(what));
    wish.bytes = shared(std::move(bytes)), ++wish.count, wish.is_open = false;
    changed_.notify_all();
}

bool Exchange::add(ViewCommand command) {
    const std::lock_guard lock(mutex_);
    if (commands_.size() >= most_waiting) return false;
    commands_.push_back(std::move(command));
    asked_.notify_all();
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

void Exchange::wait_for_clients() {
    std::unique_lock lock(mutex_);
    asked_.wait_for(lock, longest_idle, [&] {
        return !commands_.empty() ||
               std::any_of(wishes_.begin(), wishes_.end(), [](const Wish& wish) { return wish.is_open; });
    });
}

void Exchange::wait_for_display() {
    std::unique_lock lock(mutex_);
    asked_.wait_for(lock, longest_display, [&] { return shown_ == frames_; });
}

void Exchange::end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
}

}  // namespace claray::view
