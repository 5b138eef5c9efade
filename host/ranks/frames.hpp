// The frames of an animation, each of which is rendered by one rank.
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <set>
#include <thread>

#include "host/ranks/remote_devices.hpp"

namespace claray::ranks {

/// Rank 0 sends frames to the other ranks while it renders some itself. Frames of a rank that is lost are dealt again.
class FrameDealer {
public:
    /// The other functions are called from a thread of the dealer: `load` before a frame is sent, `fits` and `take`
    /// with what a rank made of it, `tell` with a line for a rank that is lost. A rank whose frame does not fit is
    /// dropped.
    struct Calls {
        std::function<Scene(std::uint32_t frame)> load;
        std::function<bool(const RenderedFrame&)> fits;
        std::function<void(const RenderedFrame&)> take;
        std::function<void(const std::string&)> tell;
    };
    /// The frames from `first`, which rank 0 renders, to before `end`.
    FrameDealer(Ranks& ranks, const RenderConfig& config, std::uint32_t first, std::uint32_t end, Calls calls);
    ~FrameDealer();
    FrameDealer(const FrameDealer&) = delete;
    FrameDealer& operator=(const FrameDealer&) = delete;

    /// The next frame for rank 0, whose previous one is done; none if all frames are done, for which it waits. Throws
    /// what a function of `Calls` threw.
    [[nodiscard]] std::optional<std::uint32_t> next();

private:
    void run();
    void take_message(const Message& message);
    [[nodiscard]] RenderedFrame frame_in(const Message& message) const;
    void drop(int rank, const std::string& why);
    [[nodiscard]] std::optional<std::uint32_t> take(std::size_t rank);
    [[nodiscard]] bool all_done() const;

    Ranks& ranks_;
    const RenderConfig config_;
    const Calls calls_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::set<std::uint32_t> waiting_;             // frames for which nobody cares yet
    std::vector<std::set<std::uint32_t>> dealt_;  // frames by rank
    bool ends_ = false;
    std::exception_ptr error_;
    std::thread thread_;
};

}  // namespace claray::ranks
