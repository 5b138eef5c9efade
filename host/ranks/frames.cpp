#include "host/ranks/frames.hpp"

#include <algorithm>

namespace claray::ranks {
namespace {

/// One is rendered while the next one is on its way. The last ones go to ranks that have nothing else to do.
constexpr std::size_t most_frames = 2;
/// Frames may be done this much earlier than the first one that is not, per rank: a film keeps them in memory.
constexpr std::uint32_t frames_ahead = 4;

}  // namespace

FrameDealer::FrameDealer(Ranks& ranks, const RenderConfig& config, std::uint32_t first, std::uint32_t end, Calls calls)
    : ranks_(ranks), config_(config), calls_(std::move(calls)), dealt_(ranks.hellos().size()) {
    dealt_[0].insert(first);
    for (std::uint32_t frame = first + 1; frame < end; ++frame) waiting_.insert(waiting_.end(), frame);
    thread_ = std::thread([this] { run(); });
}

FrameDealer::~FrameDealer() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    thread_.join();
}

std::optional<std::uint32_t> FrameDealer::next() {
    std::unique_lock lock(mutex_);
    dealt_[0].clear();
    std::optional<std::uint32_t> frame;
    changed_.notify_all();
    changed_.wait(lock, [&] { return error_ || all_done() || (frame = take(0)); });
    if (error_) std::rethrow_exception(error_);
    return frame;
}

bool FrameDealer::all_done() const {
    return waiting_.empty() && std::all_of(dealt_.begin(), dealt_.end(), [](const auto& f) { return f.empty(); });
}

/// The mutex must be locked.
std::optional<std::uint32_t> FrameDealer::take(std::size_t rank) {
    if (waiting_.empty()) return std::nullopt;
    const std::uint32_t frame = *waiting_.begin();
    for (const std::set<std::uint32_t>& frames : dealt_)
        if (!frames.empty() && frame - *frames.begin() > frames_ahead * dealt_.size() && *frames.begin() < frame)
            return std::nullopt;
    waiting_.erase(waiting_.begin());
    dealt_[rank].insert(frame);
    return frame;
}

void FrameDealer::run() try {
    for (;;) {
        for (std::size_t rank = 1; rank < dealt_.size(); ++rank) {
            std::unique_lock lock(mutex_);
            if (ends_) return;
            const std::size_t most = waiting_.size() >= dealt_.size() ? most_frames : 1;
            if (ranks_.is_lost(int(rank)) || dealt_[rank].size() >= most) continue;
            const std::optional<std::uint32_t> frame = take(rank);
            lock.unlock();
            if (frame)
                ranks_.session().send(int(rank), MessageKind::frame, to_bytes(*frame, config_, calls_.load(*frame)));
        }
        if (const auto message = ranks_.session().receive(std::chrono::milliseconds(20))) take_message(*message);
    }
} catch (...) {
    const std::lock_guard lock(mutex_);
    error_ = std::current_exception();
    changed_.notify_all();
}

void FrameDealer::take_message(const Message& message) {
    std::set<std::uint32_t>& dealt = dealt_[std::size_t(message.from)];
    if (message.kind == MessageKind::rendered) {
        const RenderedFrame rendered = rendered_from(message.bytes);
        calls_.take(rendered);
        const std::lock_guard lock(mutex_);
        dealt.erase(rendered.frame);
    } else if (message.kind == MessageKind::failure) {
        calls_.tell(place_of(message.from, ranks_.hellos()[std::size_t(message.from)]) +
                    " is dropped and the others go on: " + failure_of(message).text);
        const std::lock_guard lock(mutex_);
        ranks_.lose(message.from);
        waiting_.merge(dealt);
        dealt.clear();
    }
    changed_.notify_all();
}

}  // namespace claray::ranks
