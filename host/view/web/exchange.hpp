// What passes between the loop that renders and the threads that answer requests.
#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>

#include "host/view/http/http.hpp"
#include "host/view/view_command.hpp"

namespace claray::view {

/// Frames and answers on their way out, commands on their way in. All functions may be called by any thread.
class Exchange {
public:
    void publish(std::string jpeg, std::string status);
    [[nodiscard]] std::string status() const;

    /// A client that shows all frames. Each has a number; only the newest have frames, so that forgotten ones do not
    /// keep all threads.
    [[nodiscard]] std::uint64_t open_stream();
    [[nodiscard]] bool is_open(std::uint64_t stream) const;
    /// Waits for another frame than number `seen`, but not long; null if none came. `seen` becomes its number.
    [[nodiscard]] Bytes next_frame(std::uint64_t& seen);

    /// Asks for what is seen as a PNG, and waits for it, but not long; null if it does not come.
    [[nodiscard]] Bytes picture();
    [[nodiscard]] bool wants_picture() const;
    void give_picture(std::string png);

    /// Returns false if too many are waiting.
    [[nodiscard]] bool add(ViewCommand command);
    [[nodiscard]] bool has_commands() const;
    [[nodiscard]] std::deque<ViewCommand> take();

    /// Ends all waits and streams.
    void end();

private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    Bytes jpeg_, png_;
    std::string status_;
    std::uint64_t frames_ = 0, streams_ = 0, pictures_ = 0;
    std::deque<ViewCommand> commands_;
    bool wants_picture_ = false, ended_ = false;
};

}  // namespace claray::view
