// Rank 0's view of the devices of the other ranks.
#pragma once

#include "claray/scale/render_group.hpp"
#include "host/ranks/protocol.hpp"

namespace claray::ranks {

/// "rank 2 on this host"
[[nodiscard]] std::string place_of(int rank, const Hello& hello);
/// What is known of a rank that ended or was lost.
[[nodiscard]] Failure failure_of(const Message& message);

/// The other ranks, once they have said hello with the same version and options.
class Ranks {
public:
    /// Waits for all of them. Throws ErrorKind::usage for unequal options, ErrorKind::user for unequal versions and for
    /// ranks that do not answer, and the error of a rank that failed.
    Ranks(Session& session, const Hello& own);

    [[nodiscard]] Session& session() const { return session_; }
    /// By rank; without devices for rank 0.
    [[nodiscard]] const std::vector<Hello>& hellos() const { return hellos_; }
    /// A number for the next picture.
    [[nodiscard]] std::uint32_t next_picture() { return ++pictures_; }
    [[nodiscard]] bool is_lost(int rank) const { return hellos_[std::size_t(rank)].devices.empty(); }
    void lose(int rank) { hellos_[std::size_t(rank)].devices.clear(); }

private:
    Session& session_;
    std::vector<Hello> hellos_;
    std::uint32_t pictures_ = 0;
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
    void take_failure(const Message& message);

    Ranks& ranks_;
    Inbox& inbox_;
    std::uint32_t picture_;
    std::vector<Place> places_;
};

}  // namespace claray::ranks
