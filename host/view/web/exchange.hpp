// What passes between the loop that renders and the threads that answer requests.
#pragma once

#include <array>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>

#include "host/view/http/http.hpp"
#include "host/view/view_command.hpp"

namespace claray::view {

/// What is made only if a client asks for it.
enum class Made { picture, scene, command_line, job };

/// Frames and answers on their way out, commands on their way in. All functions may be called by any thread.
class Exchange {
public:
    void publish(std::string jpeg, std::string status, std::string state);
    [[nodiscard]] std::string status() const;
    /// What belongs to the newest frame (describe_frame).
    [[nodiscard]] std::string state() const;
    /// Changes what belongs to the newest frame.
    void set_state(std::string state);

    /// A client that shows all frames. Each has a number; only the newest have frames, so that forgotten ones do not
    /// keep all threads.
    [[nodiscard]] std::uint64_t open_stream();
    [[nodiscard]] bool is_open(std::uint64_t stream) const;
    /// Waits for another frame than number `seen`, but not long; null if none came. `seen` becomes its number.
    [[nodiscard]] Bytes next_frame(std::uint64_t& seen);

    /// Asks for what is seen as a PNG, for the scene as JSON, a command line or a job, and waits for it, but not long;
    /// null if it does not come.
    [[nodiscard]] Bytes ask(Made what);
    [[nodiscard]] bool wants(Made what) const;
    void give(Made what, std::string bytes);

    /// Returns false if too many are waiting.
    [[nodiscard]] bool add(ViewCommand command);
    [[nodiscard]] bool has_commands() const;
    [[nodiscard]] std::deque<ViewCommand> take();

    /// Waits for a command or a wish, but not long.
    void wait_for_clients();
    /// Waits until a client asks for another frame than the newest, which it shows then, but not long.
    void wait_for_display();

    /// Ends all waits and streams.
    void end();

private:
    mutable std::mutex mutex_;
    std::condition_variable changed_, asked_;
    struct Wish {
        Bytes bytes;
        std::uint64_t count = 0;  // of those that were made
        bool is_open = false;
    };
    Bytes jpeg_;
    std::array<Wish, 4> wishes_;  // by Made
    std::string status_, state_;
    std::uint64_t frames_ = 0, streams_ = 0;
    std::uint64_t shown_ = 0;  // the newest frame after which a client asked for another
    std::deque<ViewCommand> commands_;
    bool ended_ = false;
};

}  // namespace claray::view
