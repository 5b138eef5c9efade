#include "host/ranks/serve.hpp"

#include <algorithm>
#include <atomic>
#include <deque>
#include <thread>

#include "host/scale/device_worker.hpp"

namespace claray::ranks {
namespace {

/// The devices of this rank at work on one image.
class Job {
public:
    Job(Session& session, const std::vector<Device>& devices, RenderTask task) : task_(std::move(task)) {
        for (const Device& device : devices)
            workers_.push_back(
                std::make_unique<DeviceWorker>(device, task_.scene, task_.config, inbox_, workers_.size()));
        reporter_ = std::thread([this, &session] { report(session); });
    }
    ~Job() {
        ends_ = true;
        reporter_.join();
        workers_.clear();
    }
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;

    void carry_out(RemoteOrder order) {
        const bool is_late = order.task > 0 && order.task < task_.number && !has_begun_;
        if (is_late) return;  // of the task before
        const Batch& batch = order.order.batch;
        const std::uint64_t end = std::uint64_t(batch.first_pixel) + batch.pixels;
        if (order.task != task_.number || order.device >= workers_.size() || batch.pixels == 0 ||
            end > std::uint64_t(task_.config.width) * task_.config.height ||
            (order.order.brings_sums && order.sums.size() != batch.pixels))
            refuse_message("orders what is not there");
        has_begun_ = true;
        workers_[order.device]->carry_out(order.order, std::move(order.sums));
    }

private:
    void report(Session& session) {
        while (!ends_)
            if (std::optional<Report> report = inbox_.wait(std::chrono::milliseconds(20)))
                session.send(0, MessageKind::report, to_bytes(RemoteReport{task_.number, std::move(*report)}));
    }

    RenderTask task_;
    bool has_begun_ = false;
    Inbox inbox_;
    std::vector<std::unique_ptr<DeviceWorker>> workers_;
    std::atomic<bool> ends_{false};
    std::thread reporter_;
};

}  // namespace

int serve(Session& session, const std::vector<Device>& devices, Hello hello, const std::string& compiler,
          const RenderFrame& render_frame) {
    for (const Device& device : devices) hello.devices.push_back(device.info().name);
    session.send(0, MessageKind::hello, to_bytes(hello));
    std::unique_ptr<Job> job;
    std::deque<Message> waiting;  // that came while a frame was rendered
    const auto goes_on = [&] {
        while (std::optional<Message> message = session.receive(std::chrono::milliseconds(0)))
            waiting.push_back(std::move(*message));
        return std::none_of(waiting.begin(), waiting.end(), [](const Message& message) {
            return message.kind == MessageKind::quit || message.kind == MessageKind::failure;
        });
    };
    for (;;) {
        if (waiting.empty())
            if (std::optional<Message> message = session.receive(std::chrono::seconds(1)))
                waiting.push_back(std::move(*message));
        if (waiting.empty()) continue;  // the session tells if rank 0 is lost
        const Message message = std::move(waiting.front());
        waiting.pop_front();
        if (message.from != 0) continue;  // nobody else asks for anything
        switch (message.kind) {
            case MessageKind::task: {
                job.reset();
                RenderTask task = task_from(message.bytes);
                task.config.compiler = compiler;
                job = std::make_unique<Job>(session, devices, std::move(task));
                break;
            }
            case MessageKind::order:
                if (job) job->carry_out(order_from(message.bytes));
                break;
            case MessageKind::frame:
                job.reset();
                if (const auto rendered = render_frame(devices, task_from(message.bytes), goes_on))
                    session.send(0, MessageKind::rendered, to_bytes(*rendered));
                break;
            case MessageKind::end: job.reset(); break;
            case MessageKind::quit: return std::atoi(message.bytes.c_str());
            case MessageKind::failure: throw Error(ErrorKind::user, "rank 0 is lost");
            case MessageKind::damaged: refuse_message("was damaged on its way");
            default: break;
        }
    }
}

}  // namespace claray::ranks
