#include "host/scale/device_worker.hpp"

#include <algorithm>
#include <new>

#include "host/base/seconds_since.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

constexpr std::uint32_t most_batches = 8;  // of an order: more would delay what comes next
constexpr std::uint32_t pixels_of_trial = 1 << 16;

/// The group decides when a render ends and saves its progress.
RenderConfig config_of_part(RenderConfig config) {
    config.checkpoint.clear(), config.resume.clear();
    return config;
}

}  // namespace

DeviceWorker::DeviceWorker(const Device& device, const Scene& scene, const RenderConfig& config, Inbox& inbox,
                           std::size_t number, const GroupSums* shared)
    : device_(device),
      scene_(scene),
      config_(config_of_part(config)),
      inbox_(inbox),
      number_(number),
      shared_(shared),
      thread_([this] { run(); }) {}

DeviceWorker::~DeviceWorker() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    arrived_.notify_one();
    thread_.join();
}

void DeviceWorker::carry_out(const Order& order, std::vector<FilmPixel> sums) {
    {
        const std::lock_guard lock(mutex_);
        jobs_.push_back({order, std::move(sums), Clock::now()});
    }
    arrived_.notify_one();
}

std::optional<DeviceWorker::Job> DeviceWorker::next_job() {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return ends_ || !jobs_.empty(); });
    if (ends_) return std::nullopt;
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    return job;
}

/// Into memory of its own: a device that fails while it reads must not spoil earlier sums. It is page-locked on GPUs,
/// since an H200 copies to other memory, also to that which another GPU has locked, at 1.4 instead of 50 GB/s.
std::span<FilmPixel> DeviceWorker::read_sums(std::uint32_t first, std::uint32_t pixels) {
    if (!staging_ || staging_->pixels() < pixels) staging_.emplace(&device_, pixels, std::span<const FilmPixel>());
    const std::span<FilmPixel> sums = staging_->at(0, pixels);
    state_of(*renderer_).film.read_sums(sums, first);
    return sums;
}

/// Seconds for the sums of a pixel from this device to the group, while another one takes those before: the least of
/// some copies, since the first one allocates, and others may be interrupted.
double DeviceWorker::measure_handover() {
    const std::uint32_t pixels = std::min(state_of(*renderer_).pixels(), pixels_of_trial);
    const GroupSums some(nullptr, pixels, {});
    double least = 1e9;
    for (int copy = 0; copy < 4; ++copy) {
        const Clock::time_point begin = Clock::now();
        some.write(0, read_sums(0, pixels));
        least = std::min(least, seconds_since(begin));
    }
    return least / pixels;
}

/// One CPU after the other: all are the same processor, and PoCL 3.1 aborts if two of its devices load the same kernel
/// at the same time ("ref_count > 0").
void DeviceWorker::set_up() {
    static std::mutex processor;
    std::unique_lock lock(processor, std::defer_lock);
    if (device_.info().type == DeviceType::cpu) lock.lock();
    renderer_.emplace(device_, scene_, config_);
    Renderer::State& state = state_of(*renderer_);
    state.wavefront.make_room(state.wavefront.queues.capacity);  // an H200 takes 5 ms for it
    state.warm_up();
    state.follow_light();
    device_.finish();
    const double handover = shared_ == nullptr ? 0 : measure_handover();
    state.time.begin = state.time.first_begin = Clock::now();
    const std::uint32_t first = state.first_paths();
    inbox_.post({number_, Report::Kind::ready, first,
                 state.parts_take_turns() ? first : most_batches * state.wavefront.queues.capacity, handover});
}

void DeviceWorker::run() {
    Report failure{number_, Report::Kind::failed};
    try {
        set_up();
        while (const std::optional<Job> job = next_job()) carry_out(*job);
        return;
    } catch (const Error& error) {
        failure.error = error.kind(), failure.what = error.what();
    } catch (const std::bad_alloc&) {
        failure.error = ErrorKind::user, failure.what = "out of memory; use a smaller scene or image";
    } catch (const std::exception& error) {
        failure.what = error.what();
    }
    inbox_.post(std::move(failure));
}

/// One order after the other: while a batch is traced, the host reads how many rays are left, so that the next order
/// would delay the report of this one, which tells its speed, until its own end.
void DeviceWorker::carry_out(const Job& job) {
    Film& film = state_of(*renderer_).film;
    const Batch& batch = job.order.batch;
    if (job.order.kind == Order::Kind::render) {
        if (job.order.brings_sums && shared_ != nullptr)
            film.set_sums(shared_->at(batch.first_pixel, batch.pixels), batch.first_pixel);
        else if (job.order.brings_sums)
            film.set_sums(job.sums, batch.first_pixel);
        render(batch);
        Mark(device_).wait();
        return report_done(job.sent);
    }
    const std::span<FilmPixel> read = read_sums(batch.first_pixel, batch.pixels);
    if (shared_ == nullptr) return report_done(job.sent, {read.begin(), read.end()});
    shared_->write(batch.first_pixel, read);
    report_done(job.sent);
}

/// In batches for which the renderer has room; each pixel's samples in their order.
void DeviceWorker::render(const Batch& all) {
    Renderer::State& state = state_of(*renderer_);
    PendingBatches left({all});
    while (!left.empty()) state.trace(left.next(state.wavefront.queues.capacity));
    samples_ += std::uint64_t(all.pixels) * all.samples;
    state.choose_kernels(samples_ >= state.pixels());
}

void DeviceWorker::report_done(Clock::time_point sent, std::vector<FilmPixel> sums) {
    const Clock::time_point now = Clock::now(), from = std::max(last_done_, sent);
    last_done_ = now;
    Report report{number_, Report::Kind::done};
    report.seconds = std::chrono::duration<double>(now - from).count();
    report.sums = std::move(sums);
    inbox_.post(std::move(report));
}

}  // namespace claray
