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

/// Throws for whatever no rank sends that was given a frame.
RenderedFrame FrameDealer::frame_in(const Message& message) const {
    refuse_unless(MessageKind::rendered, message);
    RenderedFrame rendered = rendered_from(message.bytes);
    if (!dealt_[std::size_t(message.from)].contains(rendered.frame) || !calls_.fits(rendered))
        refuse_message("brings a frame that nobody asked for");
    return rendered;
}

void FrameDealer::take_message(const Message& message) {
    if (ranks_.is_lost(message.from)) return;
    RenderedFrame rendered;
    try {
        if (message.kind == MessageKind::failure) return drop(message.from, failure_of(message).text);
        rendered = frame_in(message);
    } catch (const std::exception& error) {
        return drop(message.from, error.what());
    }
    calls_.take(rendered);
    const std::lock_guard lock(mutex_);
    dealt_[std::size_t(message.from)].erase(rendered.frame);
    changed_.notify_all();
}

void FrameDealer::drop(int rank, const std::string& why) {
    calls_.tell(ranks_.dropped(rank, why));
    const std::lock_guard lock(mutex_);
    ranks_.lose(rank);
    waiting_.merge(dealt_[std::size_t(rank)]);
    dealt_[std::size_t(rank)].clear();
    changed_.notify_all();
}

}  // namespace claray::ranks
