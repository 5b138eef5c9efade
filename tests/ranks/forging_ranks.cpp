// Started by mpirun: rank 0 renders, and each of the others forges a message in its own way, or dies. Prints "as alone"
// if the image has the bits of one device, and a line for each rank that is dropped.
//   forging_ranks picture | frames | die | ranks
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <map>
#include <set>
#include <thread>

#include "host/ranks/frames.hpp"
#include "host/scale/group_state.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

using namespace ranks;

const Hello own_hello{"a version", "options", "host", {"a device"}};
const RenderConfig config{.width = 61, .height = 43, .spp = 24};

/// A message as a rank should send it.
struct Sent {
    MessageKind kind;
    std::string bytes;
};
using Forge = std::function<void(Sent&)>;

std::string cut(const std::string& bytes) { return bytes.substr(0, bytes.size() / 2); }

/// Forges a report.
Forge with(const std::function<void(RemoteReport&)>& change) {
    return [change](Sent& sent) {
        RemoteReport report = report_from(sent.bytes);
        change(report);
        sent.bytes = to_bytes(report);
    };
}

/// By what is forged: the first words, the report that a device is ready, the report that an order is done, a frame.
const std::vector<Forge> of_hello = {
    [](Sent& sent) { sent.bytes = cut(sent.bytes); },
    [](Sent& sent) {
        sent.bytes = to_bytes(Hello{own_hello.version, own_hello.options, "h", {}});
    },
    [](Sent& sent) { sent.kind = MessageKind::rendered; },
    [](Sent& sent) {
        sent = {MessageKind::failure, to_bytes(Failure{0, "nothing"})};
    },
    [](Sent& sent) { sent.kind = MessageKind(99); },
};
const std::vector<Forge> of_ready = {
    [](Sent& sent) { sent.bytes = cut(sent.bytes); },
    with([](RemoteReport& report) { report.report.kind = Report::Kind::done; }),  // before any order
    with([](RemoteReport& report) { report.task = 7; }),
    with([](RemoteReport& report) { report.report.worker = 5; }),
    with([](RemoteReport& report) { report.report.kind = Report::Kind(17); }),
};
const std::vector<Forge> of_done = {
    with([](RemoteReport& report) { report.report.sums.resize(report.report.sums.size() + 1); }),
    with([](RemoteReport& report) { report.report.seconds = NAN; }),
    with([](RemoteReport& report) { report.report.kind = Report::Kind::ready; }),  // again
    with([](RemoteReport& report) { report.task = 0; }),
    [](Sent& sent) { sent.kind = MessageKind::alive; },
    [](Sent& sent) {
        sent = {MessageKind::quit, "0"};
    },
    [](Sent& sent) {
        sent = {MessageKind::failure, to_bytes(Failure{77, "why"})};
    },
    [](Sent& sent) { sent.bytes += 'x'; },
    [](Sent& sent) {
        sent = {MessageKind::hello, to_bytes(own_hello)};
    },
    [](Sent& sent) {
        sent = {MessageKind::alive, {}};
    },  // sends nothing
};
const std::vector<Forge> of_frame = {
    [](Sent& sent) { sent.bytes = cut(sent.bytes); },
    [](Sent& sent) { sent.kind = MessageKind::report; },
    [](Sent& sent) {
        sent.bytes = to_bytes(RenderedFrame{99, {}, {}, {}, {}});
    },
    [](Sent& sent) {
        sent.bytes = to_bytes(RenderedFrame{rendered_from(sent.bytes).frame, {"of another size"}, {""}, {}, {}});
    },
};

/// Takes part in a picture or in frames until rank 0 quits.
class Forger {
public:
    Forger(Session& session, bool of_frames) : session_(session) {
        std::size_t left = std::size_t(session.rank()) - 1;
        if (of_frames) {
            forge_[MessageKind::frame] = of_frame.at(left);
            return;
        }
        for (const auto& [request, all] :
             {std::pair(MessageKind::hello, of_hello), std::pair(MessageKind::task, of_ready),
              std::pair(MessageKind::order, of_done)}) {
            if (left < all.size()) {
                forge_[request] = all[left];
                return;
            }
            left -= all.size();
        }
    }

    void run() {
        answer(MessageKind::hello, {MessageKind::hello, to_bytes(own_hello)});
        for (;;) {
            const std::optional<Message> message = session_.receive(std::chrono::seconds(1));
            if (!message) continue;
            if (message->kind == MessageKind::quit || message->kind == MessageKind::failure) return;
            if (message->kind == MessageKind::task) {
                task_ = task_from(message->bytes).number;
                report({0, Report::Kind::ready, 16, 64}, message->kind);
            } else if (message->kind == MessageKind::order && forge_.contains(MessageKind::order)) {
                report({0, Report::Kind::done}, message->kind);
            } else if (message->kind == MessageKind::frame) {
                answer(message->kind, {MessageKind::rendered,
                                       to_bytes(RenderedFrame{task_from(message->bytes).number, {}, {}, {}, {}})});
            }
        }
    }

private:
    void report(Report report, MessageKind request) {
        answer(request, {MessageKind::report, to_bytes(RemoteReport{task_, std::move(report)})});
    }
    void answer(MessageKind request, Sent sent) {
        if (const auto forge = forge_.find(request); forge != forge_.end()) forge->second(sent);
        if (sent.kind == MessageKind::alive && sent.bytes.empty()) return;
        session_.send(0, sent.kind, std::move(sent.bytes));
    }

    Session& session_;
    std::map<MessageKind, Forge> forge_;  // by what it answers
    std::uint32_t task_ = 0;
};

std::atomic<int> dropped = 0;

void tell(const std::string& line) { std::printf("%s\n", line.c_str()); }
void tell_dropped(const std::string& line) { tell(line), ++dropped; }

bool same(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

/// All ranks that say that they are ready get an order.
void render_picture(Ranks& ranks) {
    const Scene scene = *builtin_scene("cornell");
    RenderGroup group({device()}, scene, config, tell);
    {
        const RemoteDevices remote(ranks, group, scene, config);
        RenderGroup::State& state = state_of(group);
        const auto starts = [](const auto& member) { return !member.is_ready && !member.has_failed; };
        while (std::any_of(state.members.begin(), state.members.end(), starts))
            state.take_report(std::chrono::milliseconds(20));
        (void)group.render();
    }
    Renderer alone(device(), scene, config);
    (void)alone.render();
    tell(same(group.renderer().image(), alone.image()) ? "as alone" : "another image");
}

void render_frames(Ranks& ranks) {
    const Scene scene = *builtin_scene("cornell");
    std::set<std::uint32_t> rendered = {0};
    {
        FrameDealer dealer(
            ranks, config, 0, 12,
            {[&](std::uint32_t) { return scene; }, [](const RenderedFrame& frame) { return frame.names.empty(); },
             [](const RenderedFrame& frame) { tell("took frame " + std::to_string(frame.frame)); }, tell_dropped});
        // Frame 0 is held until all others are dropped.
        while (dropped + 1 < ranks.session().size()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        while (const auto frame = dealer.next()) rendered.insert(*frame);
    }
    tell(rendered.size() == 12 ? "as alone" : "frames are missing");
}

int run(const std::string& what) {
    Session session;
    if (what == "die") ::kill(::getpid(), SIGKILL);
    if (session.rank() == 0) {
        Ranks ranks(session, own_hello, tell);
        what == "frames" ? render_frames(ranks) : render_picture(ranks);
    } else {
        Forger(session, what == "frames").run();
    }
    session.end(0);
    return 0;
}

}  // namespace
}  // namespace claray::test

int main(int argc, char** argv) {
    const std::string what = argc > 1 ? argv[1] : "";
    if (what != "ranks") return claray::test::run(what);
    std::printf("%zu %zu\n",
                1 + claray::test::of_hello.size() + claray::test::of_ready.size() + claray::test::of_done.size(),
                1 + claray::test::of_frame.size());
    return 0;
}
