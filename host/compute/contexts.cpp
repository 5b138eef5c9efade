#include "host/compute/contexts.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

#include "claray/error.hpp"

namespace claray {

std::optional<Device> Devices::take() {
    {
        const std::lock_guard lock(mutex_);
        if (!idle_.empty()) {
            const Device device = idle_.back();
            idle_.pop_back();
            return device;
        }
    }
    try {
        const Device device = Device::open(selector_);
        device.set_tuning(programs, at_once, 0);
        return device;
    } catch (const Error&) {
        return {};
    }
}

void Devices::give_back(const Device& device) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(device);
}

unsigned contexts_at_once() { return std::clamp(std::thread::hardware_concurrency(), 1u, 5u); }

void side_by_side(const Device& device, Devices& more, unsigned threads, std::size_t count,
                  const std::function<void(const Device&, std::size_t)>& piece) {
    std::atomic<std::size_t> next{0};
    std::exception_ptr thrown;
    std::mutex mutex;
    const auto work = [&](const Device& on) {
        try {
            for (std::size_t i; (i = next++) < count;) piece(on, i);
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!thrown) thrown = std::current_exception();
        }
    };
    const auto work_on_own = [&] {
        const std::optional<Device> own = more.take();
        if (!own) return;  // others do what is left
        work(*own);
        more.give_back(*own);
    };
    std::vector<std::thread> others;
    for (std::size_t i = 1; i < std::min<std::size_t>(threads, count); ++i) others.emplace_back(work_on_own);
    work(device);
    for (std::thread& thread : others) thread.join();
    if (thrown) std::rethrow_exception(thrown);
}

}  // namespace claray
