// Several contexts of one device, for threads that compile at the same time.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "claray/device.hpp"

namespace claray {

/// Sets a tuning value until the end of the scope.
class ScopedTuning {
public:
    ScopedTuning(const Device& device, std::string kernel, std::string parameter, unsigned value)
        : device_(device),
          kernel_(std::move(kernel)),
          parameter_(std::move(parameter)),
          before_(device.tuning(kernel_, parameter_)) {
        device_.set_tuning(kernel_, parameter_, value);
    }
    ~ScopedTuning() { device_.set_tuning(kernel_, parameter_, before_); }
    ScopedTuning(const ScopedTuning&) = delete;
    ScopedTuning& operator=(const ScopedTuning&) = delete;

private:
    const Device& device_;
    std::string kernel_, parameter_;
    unsigned before_;
};

/// Further handles of one device. Each has a context of its own, because drivers compile the programs of one context
/// one after the other. A handle keeps its compiled programs for the next user. While handles exist, a renderer
/// compiles its programs in turn: threads that compile for one context wait for each other and delay those of other
/// contexts.
class Devices {
public:
    explicit Devices(const Device& first)
        : selector_(std::to_string(first.info().index)), in_turn_(first, programs, at_once, 0) {}
    /// Empty if the driver opens no further context.
    [[nodiscard]] std::optional<Device> take();
    void give_back(const Device& device);

private:
    static constexpr const char *programs = "compute/programs", *at_once = "SIDE_BY_SIDE";
    std::string selector_;
    ScopedTuning in_turn_;
    std::mutex mutex_;
    std::vector<Device> idle_;
};

/// The number of threads that compile for a GPU, each in a context of its own. More do not speed up the compiler of
/// NVIDIA's driver (bench/notebook/program.md).
[[nodiscard]] unsigned contexts_at_once();

/// Calls piece(device, i) for every i below `count`, on up to `threads` threads with a device each. The calling thread
/// is one of them. If pieces throw, the first exception is rethrown after all threads have ended.
void side_by_side(const Device& device, Devices& more, unsigned threads, std::size_t count,
                  const std::function<void(const Device&, std::size_t)>& piece);

}  // namespace claray
