#include "host/ranks/remote_devices.hpp"

#include <algorithm>

#include "host/base/seconds_since.hpp"
#include "host/scale/group_state.hpp"

namespace claray::ranks {
namespace {

using Clock = std::chrono::steady_clock;

/// Messages take a while.
constexpr std::size_t most_remote_orders = 4;

class RemoteDevice final : public Worker {
public:
    RemoteDevice(Session& session, int rank, std::uint32_t task, std::uint32_t device, std::string name)
        : session_(session), rank_(rank), task_(task), device_(device), name_(std::move(name)) {}

    [[nodiscard]] const std::string& name() const override { return name_; }
    [[nodiscard]] std::size_t most_orders() const override { return most_remote_orders; }
    void carry_out(const Order& order, std::vector<FilmPixel> sums) override {
        session_.send(rank_, MessageKind::order, to_bytes(RemoteOrder{task_, device_, order, std::move(sums)}));
    }

private:
    Session& session_;
    int rank_;
    std::uint32_t task_, device_;
    std::string name_;
};

void refuse_difference(int rank, const Hello& own, const Hello& other) {
    if (other.version != own.version)
        throw Error(ErrorKind::user,
                    place_of(rank, other) + " runs claray " + other.version + ", but rank 0 runs " + own.version,
                    "install one version on all machines");
    if (other.options != own.options)
        throw Error(ErrorKind::usage,
                    place_of(rank, other) + " has other options than rank 0: '" + other.options + "' instead of '" +
                        own.options + "'",
                    "start all ranks with the same options; only --device may differ");
}

}  // namespace

void refuse_unless(MessageKind kind, const Message& message) {
    if (message.kind == MessageKind::damaged) refuse_message("was damaged on its way");
    if (message.kind != kind) refuse_message("comes out of turn (kind " + std::to_string(int(message.kind)) + ")");
}

std::string place_of(int rank, const Hello& hello) {
    return "rank " + std::to_string(rank) + (hello.host.empty() ? "" : " on " + hello.host);
}

Failure failure_of(const Message& message) {
    Failure failure = failure_from(message.bytes);
    if (failure.text.empty())
        failure.text = "nothing was heard of it for " + std::to_string(int(Session::seconds_until_lost())) + " s";
    return failure;
}

std::string Ranks::dropped(int rank, const std::string& why) const {
    return place_of(rank, hellos_[std::size_t(rank)]) + " is dropped and the others go on: " + why;
}

/// Takes a rank's first message. Returns why the rank cannot take part, or nothing.
std::string Ranks::welcome(const Message& message) {
    Failure failure;
    try {
        if (message.kind == MessageKind::hello) {
            hellos_[std::size_t(message.from)] = hello_from(message.bytes);
            return {};
        }
        refuse_unless(MessageKind::failure, message);
        failure = failure_of(message);
    } catch (const std::exception& error) {
        return error.what();
    }
    if (message.bytes.empty()) return failure.text;  // it was lost
    throw Error(ErrorKind(failure.exit_code), "rank " + std::to_string(message.from) + ": " + failure.text);
}

Ranks::Ranks(Session& session, const Hello& own, const Tell& tell)
    : session_(session), hellos_(std::size_t(session.size())) {
    std::set<int> silent;
    for (int rank = 1; rank < session.size(); ++rank) silent.insert(rank);
    const Clock::time_point begin = Clock::now();
    while (!silent.empty() && seconds_since(begin) < Session::seconds_to_start()) {
        const std::optional<Message> message = session.receive(std::chrono::milliseconds(100));
        if (!message || (silent.erase(message->from) == 0 && is_lost(message->from))) continue;
        if (const std::string why = welcome(*message); !why.empty()) {
            lose(message->from);
            tell(dropped(message->from, why));
        } else {
            refuse_difference(message->from, own, hellos_[std::size_t(message->from)]);
        }
    }
    for (const int rank : silent) tell(dropped(rank, "it did not answer; check that claray starts on all machines"));
}

RemoteDevices::RemoteDevices(Ranks& ranks, RenderGroup& group, const Scene& scene, const RenderConfig& config)
    : ranks_(ranks), inbox_(state_of(group).inbox), task_(ranks.next_task()) {
    Session& session = ranks.session();
    for (int rank = 1; rank < session.size(); ++rank) {
        const Hello& hello = ranks.hellos()[std::size_t(rank)];
        for (std::size_t device = 0; device < hello.devices.size(); ++device)
            state_of(group).add([&](Inbox&, std::size_t member) {
                places_.push_back({rank, device, member});
                return std::make_unique<RemoteDevice>(session, rank, task_, std::uint32_t(device),
                                                      place_of(rank, hello) + ": " + hello.devices[device]);
            });
    }
    state_of(group).most_seconds_of_order = 20 * Session::seconds_until_lost();
    std::string task = to_bytes(task_, config, scene);  // may throw, before the session knows this object
    session.handle([this](const Message& message) { take(message); });
    while (const std::optional<Message> earlier = session.receive(std::chrono::milliseconds(0))) take(*earlier);
    session.broadcast(MessageKind::task, std::move(task));
}

RemoteDevices::~RemoteDevices() {
    ranks_.session().handle({});
    ranks_.session().broadcast(MessageKind::end, {});
}

/// In the session's thread, which must go on. A rank of which a message was not understood may never do what it was
/// asked for, so that it is dropped.
void RemoteDevices::take(const Message& message) {
    if (ranks_.is_lost(message.from)) return;
    try {
        message.kind == MessageKind::failure ? drop(message.from, failure_of(message)) : take_report(message);
    } catch (const std::exception& error) {
        drop(message.from, {int(ErrorKind::user), error.what()});
    }
}

/// A rank may still report of the task before, but not once it has begun this one.
void RemoteDevices::take_report(const Message& message) {
    refuse_unless(MessageKind::report, message);
    RemoteReport remote = report_from(message.bytes);
    if (remote.task < task_ && remote.task > 0 && !reporting_.contains(message.from)) return;
    const auto place = std::find_if(places_.begin(), places_.end(), [&](const Place& p) {
        return p.rank == message.from && p.device == remote.report.worker;
    });
    if (remote.task != task_ || place == places_.end()) refuse_message("reports of what nobody asked for");
    reporting_.insert(message.from);
    remote.report.worker = place->member;
    inbox_.post(std::move(remote.report));
}

void RemoteDevices::drop(int rank, const Failure& failure) {
    ranks_.lose(rank);
    for (const Place& place : places_) {
        if (place.rank != rank) continue;
        Report report{place.member, Report::Kind::failed};
        report.error = ErrorKind(failure.exit_code), report.what = failure.text;
        inbox_.post(std::move(report));
    }
}

}  // namespace claray::ranks
