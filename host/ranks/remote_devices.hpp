// Rank 0's view of the devices of the other ranks.
#pragma once

#include <set>

#include "claray/scale/render_group.hpp"
#include "host/ranks/protocol.hpp"

namespace claray::ranks {

/// Throws ErrorKind::user if a message is of another kind.
void refuse_unless(MessageKind kind, const Message& message);
/// "rank 2 on this host"
[[nodiscard]] std::string place_of(int rank, const Hello& hello);
/// What is known of a rank that ended or was lost.
[[nodiscard]] Failure failure_of(const Message& message);

/// The other ranks, once they have said hello with the same version and options.
class Ranks {
public:
    using Tell = std::function<void(const std::string&)>;
    /// Waits for all of them. Goes on without those that are lost, do not answer or are not understood, and tells a
    /// line of each. Throws ErrorKind::usage for unequal options, ErrorKind::user for unequal versions, and the error
    /// of a rank that failed.
    Ranks(Session& session, const Hello& own, const Tell& tell);

    [[nodiscard]] Session& session() const { return session_; }
    /// By rank; without devices for rank 0.
    [[nodiscard]] const std::vector<Hello>& hellos() const { return hellos_; }
    /// A number for the next task.
    [[nodiscard]] std::uint32_t next_task() { return ++tasks_; }
    [[nodiscard]] bool is_lost(int rank) const { return hellos_[std::size_t(rank)].devices.empty(); }
    void lose(int rank) { hellos_[std::size_t(rank)].devices.clear(); }
    /// "rank 2 on this host is dropped and the others go on: why"
    [[nodiscard]] std::string dropped(int rank, const std::string& why) const;

private:
    [[nodiscard]] std::string welcome(const Message& message);

    Session& session_;
    std::vector<Hello> hellos_;
    std::uint32_t tasks_ = 0;
};

/// Adds the devices of the other ranks to a group, and sends them the scene. Destroy it before the group.
class RemoteDevices {
public:
    RemoteDevices(Ranks& ranks, RenderGroup& group, const Scene& scene, const RenderConfig& config);
    ~RemoteDevices();
    RemoteDevices(const RemoteDevices&) = delete;
    RemoteDevices& operator=(const RemoteDevices&) = delete;

private:
    /// The members of the group by rank and device.
    struct Place {
        int rank;
        std::size_t device, member;
    };
    void take(const Message& message);
    void take_report(const Message& message);
    void drop(int rank, const Failure& failure);

    Ranks& ranks_;
    Inbox& inbox_;
    std::uint32_t task_;
    std::vector<Place> places_;
    std::set<int> reporting_;  // ranks that have begun this task
};

}  // namespace claray::ranks
