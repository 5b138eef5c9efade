#include "host/render/in_flight.hpp"

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

std::uint64_t InFlight::paths() const {
    std::uint64_t paths = 0;
    for (const Submitted& batch : batches_) paths += batch.paths;
    return paths;
}

void InFlight::drain() {
    while (!batches_.empty()) wait_for_oldest();
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
    const auto now = std::chrono::steady_clock::now();
    if (before_) pace_.took(batches_.front().paths, 1e3 * std::chrono::duration<double>(now - *before_).count());
    before_ = now;
    batches_.pop_front();
}

}  // namespace claray
