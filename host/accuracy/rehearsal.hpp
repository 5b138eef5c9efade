// Kernels of studies, compiled while earlier studies run.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "host/accuracy/study_list.hpp"
#include "host/compute/contexts.hpp"

namespace claray {

/// Runs studies with next to no samples and rays in threads with contexts of their own: drivers compile the programs of
/// one context one after the other. The studies then find their kernels in the cache. Only on GPUs, where compiling is
/// not the device's own work. Takes at most half of the memory that claray knows to be free: each thread has one
/// renderer at a time, and there are fewer threads, or none, if they would not fit. Ends with its object; errors are
/// left to the studies.
class Rehearsal {
public:
    /// The scene must outlive it.
    Rehearsal(const Device& device, const Scene& scene, const StudyOptions& options, std::vector<NamedStudy> studies)
        : Rehearsal(device, scene, options, std::move(studies), threads_on(device, scene)) {}
    Rehearsal(const Device& device, const Scene& scene, const StudyOptions& options, std::vector<NamedStudy> studies,
              unsigned threads);
    ~Rehearsal();
    /// As many of `threads` as the device has room for.
    [[nodiscard]] static unsigned threads_within_memory(const Device& device, const Scene& scene, unsigned threads);
    /// Waits until all studies are rehearsed, and calls `look` meanwhile: what it throws ends the rehearsal and is
    /// thrown again. Several threads may call it.
    void wait(const std::function<void()>& look = {});
    Rehearsal(const Rehearsal&) = delete;
    Rehearsal& operator=(const Rehearsal&) = delete;

private:
    [[nodiscard]] static unsigned threads_on(const Device& device, const Scene& scene);
    void work(const Scene& scene, const StudyOptions& options);

    std::vector<NamedStudy> studies_;
    Devices devices_;
    std::atomic<std::size_t> next_ = 0;
    std::atomic<bool> ends_ = false;
    std::atomic<unsigned> at_work_ = 0;  // threads
    std::mutex joining_;
    std::vector<std::thread> threads_;
};

}  // namespace claray
