#include "host/ranks/remote_devices.hpp"

#include <algorithm>

#include "host/scale/group_state.hpp"

namespace claray::ranks {
namespace {

using Clock = std::chrono::steady_clock;

/// Messages take a while.
constexpr std::size_t most_remote_orders = 4;

class RemoteDevice final : public Worker {
public:
    RemoteDevice(Session& session, int rank, std::uint32_t picture, std::uint32_t device, std::string name)
        : session_(session), rank_(rank), picture_(picture), device_(device), name_(std::move(name)) {}

    [[nodiscard]] const std::string& name() const override { return name_; }
    [[nodiscard]] std::size_t most_orders() const override { return most_remote_orders; }
    void carry_out(const Order& order, Film::Sums sums) override {
        session_.send(rank_, MessageKind::order, to_bytes(RemoteOrder{picture_, device_, order, std::move(sums)}));
    }

private:
    Session& session_;
    int rank_;
    std::uint32_t picture_, device_;
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

std::string place_of(int rank, const Hello& hello) {
    return "rank " + std::to_string(rank) + (hello.host.empty() ? "" : " on " + hello.host);
}

Failure failure_of(const Message& message) {
    Failure failure = failure_from(message.bytes);
    if (failure.text.empty())
        failure.text = "nothing was heard of it for " + std::to_string(int(Session::seconds_until_lost())) + " s";
    return failure;
}

Ranks::Ranks(Session& session, const Hello& own) : session_(session), hellos_(std::size_t(session.size())) {
    const Clock::time_point begin = Clock::now();
    const std::chrono::duration<double> limit(2 * Session::seconds_until_lost());
    for (int missing = session.size() - 1; missing > 0;) {
        const std::optional<Message> message = session.receive(std::chrono::milliseconds(100));
        if (Clock::now() - begin > limit)
            throw Error(ErrorKind::user,
                        std::to_string(missing) + " of " + std::to_string(session.size()) + " ranks did not answer",
                        "check that claray starts on all machines, or set CLARAY_RANK_SECONDS to more than " +
                            std::to_string(int(Session::seconds_until_lost())));
        if (!message) continue;
        Hello& hello = hellos_[std::size_t(message->from)];
        if (message->kind == MessageKind::failure) {
            const Failure failure = failure_from(message->bytes);
            throw Error(ErrorKind(failure.exit_code),
                        place_of(message->from, hello) + ": " + (failure.text.empty() ? "lost" : failure.text));
        }
        if (message->kind != MessageKind::hello) continue;
        hello = hello_from(message->bytes);
        refuse_difference(message->from, own, hello);
        --missing;
    }
}

RemoteDevices::RemoteDevices(Ranks& ranks, RenderGroup& group, const Scene& scene, const RenderConfig& config)
    : ranks_(ranks), inbox_(group.state().inbox), picture_(ranks.next_picture()) {
    Session& session = ranks.session();
    for (int rank = 1; rank < session.size(); ++rank) {
        const Hello& hello = ranks.hellos()[std::size_t(rank)];
        for (std::size_t device = 0; device < hello.devices.size(); ++device)
            group.state().add([&](Inbox&, std::size_t member) {
                places_.push_back({rank, device, member});
                return std::make_unique<RemoteDevice>(session, rank, picture_, std::uint32_t(device),
                                                      place_of(rank, hello) + ": " + hello.devices[device]);
            });
    }
    std::string picture = to_bytes(picture_, config, scene);  // may throw, before the session knows this object
    session.handle([this](const Message& message) { take(message); });
    while (const std::optional<Message> earlier = session.receive(std::chrono::milliseconds(0))) take(*earlier);
    session.broadcast(MessageKind::picture, std::move(picture));
}

RemoteDevices::~RemoteDevices() {
    ranks_.session().handle({});
    ranks_.session().broadcast(MessageKind::end, {});
}

void RemoteDevices::take(const Message& message) {
    if (message.kind == MessageKind::failure) return take_failure(message);
    if (message.kind != MessageKind::report) return;
    RemoteReport remote = report_from(message.bytes);
    if (remote.picture != picture_) return;
    for (const Place& place : places_)
        if (place.rank == message.from && place.device == remote.report.worker) {
            remote.report.worker = place.member;
            return inbox_.post(std::move(remote.report));
        }
}

void RemoteDevices::take_failure(const Message& message) {
    const Failure failure = failure_of(message);
    ranks_.lose(message.from);
    for (const Place& place : places_) {
        if (place.rank != message.from) continue;
        Report report{place.member, Report::Kind::failed};
        report.error = ErrorKind(failure.exit_code), report.what = failure.text;
        inbox_.post(std::move(report));
    }
}

}  // namespace claray::ranks
