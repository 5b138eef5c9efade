// Batches that are enqueued on the device and may not have finished yet.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "claray/device.hpp"
#include "host/render/schedule/pass_schedule.hpp"

namespace claray {

/// A marker in the queue, after all commands enqueued so far.
class Mark {
public:
    explicit Mark(const Device& device);
    /// Waits until these commands are done.
    void wait() const;
    /// When they were done, by the device's clock, if that can be asked. After `wait`.
    [[nodiscard]] std::optional<double> milliseconds() const;

private:
    Device device_;
    cl::Event event_;
};

/// The enqueued batches. Keeps the host from running far ahead of the device, so that a stop takes effect soon, and
/// reports times to the Pace: by the device's clock, since the host may see the end of a batch late; by the host's if
/// the driver tells no times of markers.
class InFlight {
public:
    InFlight(const Device& device, Pace& pace) : device_(device), pace_(pace) {}

    /// Number of paths in batches that may not be done.
    [[nodiscard]] std::uint64_t paths() const;
    /// Waits for all batches.
    void drain();
    /// Waits for all batches; the time until the next one is submitted is not measured.
    void pause();
    /// Must be called after each batch; waits for the batch before the last.
    void submitted(std::uint32_t paths);

private:
    struct Submitted {
        Mark done;
        std::uint32_t paths;
    };

    void wait_for_oldest();

    Device device_;
    Pace& pace_;
    std::deque<Submitted> batches_;
    struct Ended {
        double by_host;
        std::optional<double> by_device;
    };
    std::optional<Ended> before_;  // when the previous batch ended
};

}  // namespace claray
