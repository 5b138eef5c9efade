// A device that renders a part of an image, in a thread of its own.
#pragma once

#include <thread>

#include "claray/renderer.hpp"
#include "host/render/in_flight.hpp"
#include "host/scale/group_sums.hpp"
#include "host/scale/worker.hpp"

namespace claray {

class DeviceWorker final : public Worker {
public:
    /// Builds a Renderer in the thread and reports to `inbox` as `number`. `shared`: where orders that bring sums find
    /// them, and where sums go; if it is null, they come with the orders and go with the reports.
    /// All of these must outlive it.
    DeviceWorker(const Device& device, const Scene& scene, const RenderConfig& config, Inbox& inbox, std::size_t number,
                 const GroupSums* shared = nullptr);
    /// Waits for the order that is carried out.
    ~DeviceWorker() override;

    [[nodiscard]] const std::string& name() const override { return device_.info().name; }
    void carry_out(const Order& order, std::vector<FilmPixel> sums) override;
    [[nodiscard]] std::size_t most_orders() const override { return 2; }
    /// Must be used only when the worker is ready and has no order.
    [[nodiscard]] Renderer& renderer() { return *renderer_; }

private:
    using Clock = std::chrono::steady_clock;
    struct Job {
        Order order;
        std::vector<FilmPixel> sums;
        Clock::time_point sent;
    };

    void run();
    void set_up();
    [[nodiscard]] double measure_handover();
    /// Valid until the next call.
    [[nodiscard]] std::span<FilmPixel> read_sums(std::uint32_t first, std::uint32_t pixels);
    [[nodiscard]] std::optional<Job> next_job();
    void carry_out(const Job& job);
    void render(const Batch& batch);
    void report_done(Clock::time_point sent, std::vector<FilmPixel> sums = {});

    Device device_;
    const Scene& scene_;
    RenderConfig config_;
    Inbox& inbox_;
    std::size_t number_;
    const GroupSums* shared_;
    std::optional<Renderer> renderer_;
    std::optional<GroupSums> staging_;
    std::uint64_t samples_ = 0;
    Clock::time_point last_done_;

    std::mutex mutex_;
    std::condition_variable arrived_;
    std::deque<Job> jobs_;
    bool ends_ = false;
    std::thread thread_;
};

}  // namespace claray
