// The processes that mpirun started together, the ranks, and the messages between them.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace claray::ranks {

enum class MessageKind : int {
    alive,     ///< nothing else
    hello,     ///< a rank's version, options and devices
    failure,   ///< a rank ends: exit code and text
    task,      ///< configuration and scene of the next image
    order,     ///< for a device of a rank
    report,    ///< of a device
    end,       ///< of the task
    frame,     ///< configuration and scene of a frame that this rank is to render alone
    rendered,  ///< what a rank made of a frame
    quit,      ///< the program ends with this exit code
    damaged    ///< not what the rank sent
};

struct Message {
    int from = 0;
    MessageKind kind = MessageKind::alive;
    std::string bytes = {};
};

/// Adds a checksum to what is sent, and takes it off; none if the bytes are not those that were sealed.
[[nodiscard]] std::string sealed(std::string bytes);
[[nodiscard]] std::optional<std::string> unsealed(std::string bytes);

/// Whether mpirun, or another launcher that speaks PMI, started several processes of this program. Cheap.
[[nodiscard]] bool started_together();
/// The number of this process among them; 0 if it is alone.
[[nodiscard]] int rank_by_launcher();

/// One thread makes all calls of MPI, so that messages arrive while others compute or wait, and tells the other ranks
/// periodically that this one is alive. Functions may be called from any thread.
class Session {
public:
    /// If MPI does not start in time, as where a rank has died, rank 0 goes on alone, and the others end with 1.
    /// Throws ErrorKind::user without MPI.
    Session();
    /// Ends as `end(0)`.
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    [[nodiscard]] int rank() const;
    /// 1 if rank 0 goes on alone.
    [[nodiscard]] int size() const;

    /// Asynchronous.
    void send(int to, MessageKind kind, std::string bytes = {});
    /// From rank 0 to all others, along a tree of ranks.
    void broadcast(MessageKind kind, std::string bytes);
    /// Receives messages in the session's thread instead of `receive`; null: no longer. Afterwards the handler that was
    /// set before is not running. A lost rank is a message of kind `failure`.
    void handle(std::function<void(const Message&)> handler);
    /// Waits for the next message, at most this long.
    [[nodiscard]] std::optional<Message> receive(std::chrono::milliseconds most);
    /// A rank of which nothing was heard for this time is lost: $CLARAY_RANK_SECONDS, or 30.
    [[nodiscard]] static double seconds_until_lost();
    /// The time in which all ranks must have started: a minute, or twice the time above if that is longer.
    [[nodiscard]] static double seconds_to_start();

    /// Rank 0 tells all others to quit with this exit code. Blocks for some seconds at most. If a rank was lost, ends
    /// the process.
    void end(int exit_code);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace claray::ranks
