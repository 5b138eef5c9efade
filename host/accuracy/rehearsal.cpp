#include "host/accuracy/rehearsal.hpp"

#include <algorithm>
#include <chrono>
#include <exception>

#include "host/accuracy/studies/kept_renderer.hpp"
#include "host/compute/memory.hpp"

namespace claray {
namespace {

constexpr std::chrono::milliseconds between_looks{20};

/// The size of the image stays: which kernels a render uses depends on it.
StudyOptions shortened(const NamedStudy& study, StudyOptions options) {
    constexpr unsigned spp = 8, rays = 1024, side = 16;
    options.first_spp = options.most_spp = std::min(options.most_spp, spp);
    options.single_spp = options.compared_spp = 0;
    options.runs = 1, options.rays = rays, options.reference_factor = 1, options.reference_renders = 2;
    options.least_seconds = 0, options.most_seconds = 1e-9;
    options.references.clear(), options.before_timing = {}, options.measured = {};
    if (!study.samples) options.config.width = options.config.height = side;
    return options;
}

}  // namespace

unsigned Rehearsal::threads_within_memory(const Device& device, const Scene& scene, unsigned threads) {
    return unsigned(std::min<std::uint64_t>(threads, bytes_available(device) / 2 / bytes_of_renderer(device, scene)));
}

unsigned Rehearsal::threads_on(const Device& device, const Scene& scene) {
    if (device.info().type != DeviceType::gpu) return 0;
    return threads_within_memory(device, scene, contexts_at_once());
}

Rehearsal::Rehearsal(const Device& device, const Scene& scene, const StudyOptions& options,
                     std::vector<NamedStudy> studies, unsigned threads)
    : studies_(std::move(studies)), devices_(device) {
    at_work_ = unsigned(std::min<std::size_t>(threads, studies_.size()));
    for (unsigned i = 0, all = at_work_; i < all; ++i)
        threads_.emplace_back([this, &scene, options] {
            work(scene, options);
            --at_work_;
        });
}

Rehearsal::~Rehearsal() {
    ends_ = true;
    wait();
}

void Rehearsal::wait(const std::function<void()>& look) {
    for (; look && at_work_ > 0; std::this_thread::sleep_for(between_looks)) try {
            look();
        } catch (...) {
            ends_ = true;
            throw;
        }
    const std::lock_guard lock(joining_);
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
}

void Rehearsal::work(const Scene& scene, const StudyOptions& options) try {
    const std::optional<Device> device = devices_.take();
    if (!device) return;
    device->set_tuning("accuracy/renderers", "MEMORY_PERCENT", 0);  // one at a time
    const AccuracyProgress progress = [&](double, const std::string&) {
        if (ends_) throw Error(ErrorKind::user, "the rehearsal ends");
        return true;
    };
    for (std::size_t i; !ends_ && (i = next_++) < studies_.size();) try {
            const NamedStudy& study = studies_[i];
            const StudyOptions brief = shortened(study, options);
            (void)(study.run ? study.run(*device, scene, brief, progress)
                             : study.run_with_maps(*device, scene, brief, progress, nullptr));
        } catch (const std::exception&) {  // the study itself will tell
        }
} catch (const std::exception&) {  // no device to rehearse on
}

}  // namespace claray
