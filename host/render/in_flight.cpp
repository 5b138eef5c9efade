#include "host/render/in_flight.hpp"

#include <chrono>

#include "host/compute/device_error.hpp"

namespace claray {
namespace {
constexpr std::size_t batches_in_flight = 2;
}

Mark::Mark(const Device& device) : device_(device) {
    try {
        device_.queue().enqueueMarkerWithWaitList(nullptr, &event_);
    } catch (const cl::Error& error) {
        throw_device_error(device_, "render", error);
    }
}

void Mark::wait() const try { event_.wait(); } catch (const cl::Error& error) {
    throw_device_error(device_, "render", error);
}

std::optional<double> Mark::milliseconds() const try {
    return 1e-6 * double(event_.getProfilingInfo<CL_PROFILING_COMMAND_END>());
} catch (const cl::Error&) {  // the queue belongs to a program that measures nothing
    return std::nullopt;
}

std::uint64_t InFlight::paths() const {
    std::uint64_t paths = 0;
    for (const Submitted& batch : batches_) paths += batch.paths;
    return paths;
}

void InFlight::drain() {
    while (!batches_.empty()) wait_for_oldest();
}

void InFlight::pause() {
    drain();
    before_.reset();
}

void InFlight::submitted(std::uint32_t paths) try {
    batches_.push_back({Mark(device_), paths});
    device_.queue().flush();
    if (batches_.size() >= batches_in_flight) wait_for_oldest();
} catch (const cl::Error& error) {
    throw_device_error(device_, "render", error);
}

void InFlight::wait_for_oldest() {
    batches_.front().done.wait();
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const Ended ended{std::chrono::duration<double, std::milli>(now).count(), batches_.front().done.milliseconds()};
    if (before_) {
        double took = ended.by_host - before_->by_host;
        if (ended.by_device && before_->by_device && *ended.by_device > *before_->by_device)
            took = *ended.by_device - *before_->by_device;
        pace_.took(batches_.front().paths, took);
    }
    before_ = ended;
    batches_.pop_front();
}

}  // namespace claray
