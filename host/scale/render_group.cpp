#include "claray/scale/render_group.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "host/base/file.hpp"
#include "host/base/seconds_since.hpp"
#include "host/render/config/checks.hpp"
#include "host/render/renderer_state.hpp"
#include "host/scale/group_state.hpp"

namespace claray {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::microseconds patience{20'000};
/// What a device that fails loses at most, if there are no checkpoints.
constexpr double seconds_between_sums = 30;

/// Members that have nothing to do are many at the end of a render by hundreds: after so many the group looks at
/// reports.
constexpr unsigned most_refused = 8;

/// Of the lead's film: the next ones are read while it takes these.
constexpr std::uint32_t pixels_at_once = 1 << 16;

/// At the end of an interrupted render, since launchers kill a program that does not end at once: Open MPI after 1 s.
constexpr double seconds_to_hand_over = 0.5;

const RenderConfig& shareable(const RenderConfig& config) {
    if (config.adaptive)
        throw Error(ErrorKind::usage, "adaptive sampling cannot be shared by several devices",
                    "use one device, or leave out adaptive sampling");
    check_alone(config);
    return config;
}

void put(std::vector<PixelRun>& runs, std::uint32_t pixels, std::uint32_t samples) {
    if (pixels == 0) return;
    const std::uint32_t first = runs.empty() ? 0 : runs.back().first + runs.back().pixels;
    runs.push_back({first, pixels, samples});
}

/// Samples of each pixel at the position of a checkpoint.
std::vector<PixelRun> runs_of(const Checkpoint& from, std::uint32_t pixels) {
    const PassSchedule::Position& at = from.position.at;
    std::vector<PixelRun> runs;
    if (from.position.pending.empty()) {
        put(runs, at.pixel, at.done + at.pass);
        if (at.pixel < pixels) put(runs, at.sample > 0 ? 1 : 0, at.done + at.sample);
        const std::uint32_t covered = runs.empty() ? 0 : runs.back().first + runs.back().pixels;
        put(runs, pixels - covered, at.done);
        return runs;
    }
    std::uint32_t next = 0;
    for (const Batch& batch : from.position.pending) {
        put(runs, batch.first_pixel - next, at.done);
        put(runs, batch.pixels, batch.first_sample);
        next = batch.first_pixel + batch.pixels;
    }
    put(runs, pixels - next, at.done);
    return runs;
}

/// GPUs do not guide paths: some pixels would have more noise than others.
RenderConfig config_for(const std::vector<Device>& devices, RenderConfig config) {
    const auto is_cpu = [](const Device& device) { return device.info().type == DeviceType::cpu; };
    const auto cpus = std::count_if(devices.begin(), devices.end(), is_cpu);
    if (cpus != 0 && std::size_t(cpus) != devices.size()) config.guide = false;
    return config;
}

/// Each member works in a thread of its own: a device that is listed again gets another queue.
std::vector<Device> with_own_queues(std::vector<Device> devices) {
    std::set<const void*> seen;
    for (Device& device : devices)
        if (!seen.insert(&state_of(device)).second) device = device.with_new_queue();
    return devices;
}

}  // namespace

RenderGroup::State::State(const std::vector<Device>& devices, const Scene& of, const RenderConfig& with,
                          std::function<void(const std::string&)> told)
    : scene(of), config(config_for(devices, shareable(with))), tell(std::move(told)) {
    if (devices.empty()) throw Error(ErrorKind::usage, "a group needs at least one device");
    const bool resumes = !config.resume.empty(), saves = !config.checkpoint.empty();
    if (resumes || saves) validate(scene), identity = identity_of(scene, config);
    if (resumes) start = read_checkpoint(config.resume, identity, config.spp);
    if (resumes && !start.position.halves.empty())
        throw Error(ErrorKind::user,
                    "cannot continue from '" + config.resume.string() + "': it is of adaptive sampling",
                    "continue on one device with --adaptive");
    if (saves) check_file_writable(config.checkpoint);
    error = start.error;
    for (const Device& device : with_own_queues(devices))
        add([&](Inbox& in, std::size_t number) {
            return std::make_unique<DeviceWorker>(device, scene, config, in, number, &sums);
        });
    // An H200 fills its film three times as fast from memory that it has page-locked.
    const bool is_gpu = devices.front().info().type == DeviceType::gpu;
    sums = GroupSums(is_gpu ? &devices.front() : nullptr, std::size_t(config.width) * config.height, start.sums);
}

void RenderGroup::State::add(const std::function<std::unique_ptr<Worker>(Inbox&, std::size_t)>& make) {
    Member member;
    member.worker = make(inbox, members.size());
    member.device = dynamic_cast<DeviceWorker*>(member.worker.get());
    members.push_back(std::move(member));
}

DeviceWorker& RenderGroup::State::lead() { return *members[led_by].device; }

void RenderGroup::State::wait_for_lead() {
    while (!members[led_by].is_ready) take_report(patience);
}

/// The lead's room for paths limits the passes as on a single device.
void RenderGroup::State::begin_dealing() {
    wait_for_lead();
    const Renderer::State& state = state_of(lead().renderer());
    dealer.emplace(runs_of(start, state.pixels()),
                   PassSchedule::longest_pass(state.pixels(), state.wavefront.queues.capacity),
                   std::max(4096u, 16 * std::uint32_t(members.size())));
    for (Member& member : members)
        if (member.is_ready && !member.has_failed) join_dealing(member);
    expect_members();
}

void RenderGroup::State::expect_members() {
    dealer->expect(unsigned(std::count_if(members.begin(), members.end(), [](const Member& member) {
        return member.number >= 0 || !member.has_failed;
    })));
}

void RenderGroup::State::join_dealing(Member& member) {
    const bool keeps_sums = &member == &members[led_by];
    member.number = dealer->add(member.first_paths, member.most_paths, keeps_sums ? 0 : member.handover);
}

bool RenderGroup::State::time_is_up() const {
    return config.seconds > 0 && seconds_since(*begin) >= config.seconds && dealer->least() > 0;
}

double RenderGroup::State::seconds_left() const {
    return config.seconds > 0 ? config.seconds - seconds_since(*begin) : 1e9;
}

/// Up to where nothing is to be decided. Pixels of unequal numbers of samples, as after an interruption, become equal
/// first.
std::uint32_t RenderGroup::State::first_limit() const {
    if (!has_targets()) return config.spp;
    const PassSchedule::Position& at = start.position.at;
    const bool within = at.pixel != 0 || at.sample != 0;
    return std::max(1u, at.done + (within ? at.pass : 0));
}

/// Decides as a single device does, by the lead's film, which has all sums. Returns false if the render is done.
bool RenderGroup::State::raise_limit() {
    const std::uint32_t done = dealer->limit();
    if (!has_targets()) return done < config.spp;
    Renderer::State& state = state_of(lead().renderer());
    state.error.progress = error, state.time.begin = begin;
    state.sampling.schedule = state.new_schedule();
    (void)state.sampling.schedule.go_to({{done, 0, 0, 0}, {}});
    const bool met = state.target_met();
    error = state.error.progress, measured = state.measure();
    if (met) return false;
    dealer->set_limit(done + state.sampling.schedule.pass_samples());
    return true;
}

RenderProgress RenderGroup::State::render(const Progress& progress) {
    if (!dealer) begin_dealing();
    if (!begin) begin = Clock::now();
    last_sums = Clock::now(), last_shown = {};
    dealer->set_limit(first_limit());
    bool goes_on = true;
    do {
        goes_on = reach_limit(progress);
        gather(false);
        // A device that fails can leave pixels without samples.
        goes_on = goes_on || (!hurries && dealer->least() == 0);
    } while (goes_on && (!dealer->finished() || raise_limit()));
    if (!config.checkpoint.empty()) gather(true);
    const RenderProgress reached = hand_over();
    if (!config.checkpoint.empty()) save_checkpoint();
    return reached;
}

/// Returns false if the time is up or `progress` does not want more.
bool RenderGroup::State::reach_limit(const Progress& progress) {
    while (!dealer->finished()) {
        if (time_is_up()) return false;
        deal();
        take_report(patience);
        keep_now_and_then();
        hurries = !show(progress);
        if (hurries) return false;
    }
    return true;
}

bool RenderGroup::State::show(const Progress& progress) {
    if (!progress || !lead_has_begun || seconds_since(last_shown) < config.report_seconds) return true;
    last_shown = Clock::now();
    RenderProgress so_far = measured;
    const Renderer::State& state = state_of(lead().renderer());
    so_far.spp = unsigned(dealer->samples() / state.pixels()), so_far.spp_target = config.spp;
    so_far.seconds = seconds_since(*begin);
    so_far.culled = state.source.culled;
    return progress(so_far);
}

/// One order for each member in turn, until none takes another one.
void RenderGroup::State::deal() {
    unsigned refused = 0;
    for (std::size_t left = members.size(); left > 0 && refused < most_refused; --left) {
        next_dealt = (next_dealt + 1) % members.size();
        Member& member = members[next_dealt];
        if (!member.takes_orders() || member.orders.size() >= member.worker->most_orders()) continue;
        std::optional<Order> order = dealer->next(member.number, seconds_left());
        if (!order && next_dealt != led_by) order = dealer->read_finished(member.number);
        if (order) {
            send(member, *order);
            left = members.size() + 1;
        } else {
            ++refused;
        }
    }
}

void RenderGroup::State::send(Member& member, const Order& order) {
    if (member.orders.empty()) member.since = Clock::now();
    member.orders.push_back(order);
    const bool sends_sums = order.brings_sums && member.device == nullptr;
    std::vector<FilmPixel> sent;
    if (sends_sums) {
        const std::span<FilmPixel> some = sums.at(order.batch.first_pixel, order.batch.pixels);
        sent.assign(some.begin(), some.end());
    }
    member.worker->carry_out(order, std::move(sent));
}

void RenderGroup::State::take_report(std::chrono::microseconds most) {
    std::optional<Report> report = inbox.wait(most);
    for (; report; report = inbox.wait(std::chrono::microseconds(0))) {
        Member& member = members[report->worker];
        if (member.has_failed) continue;
        if (!fits(member, *report)) {
            drop(report->worker, "its report does not fit its orders");
            continue;
        }
        switch (report->kind) {
            case Report::Kind::ready:
                member.is_ready = true;
                member.first_paths = report->first_paths, member.most_paths = report->most_paths;
                member.handover = report->handover;
                if (dealer) join_dealing(member);
                break;
            case Report::Kind::done: take_done(member, *report); break;
            case Report::Kind::failed: drop(member, *report); break;
        }
    }
    drop_silent();
}

/// Whether a report is possible. Those of other processes may be wrong.
bool RenderGroup::State::fits(const Member& member, const Report& report) const {
    if (report.kind == Report::Kind::failed) return true;
    if (report.kind == Report::Kind::ready) return !member.is_ready;
    if (member.orders.empty()) return false;
    const Order& order = member.orders.front();
    const bool brings_sums = member.device == nullptr && order.kind != Order::Kind::render;
    const std::size_t pixels = brings_sums ? order.batch.pixels : 0;
    return report.sums.size() == pixels;
}

void RenderGroup::State::take_done(Member& member, Report& report) {
    const Order order = member.orders.front();
    member.orders.pop_front();
    member.since = Clock::now();
    if (!report.sums.empty()) sums.write(order.batch.first_pixel, report.sums);
    dealer->done(member.number, order, report.seconds);
    lead_has_begun |= &member == &members[led_by];
}

/// If it led, the next device leads.
void RenderGroup::State::drop(Member& member, const Report& report) {
    member.has_failed = true, member.failure = report.what;
    member.orders.clear();
    if (member.number >= 0) dealer->lost(member.number);
    if (dealer) expect_members();
    const auto works = [](const Member& other) { return other.device != nullptr && !other.has_failed; };
    const auto next = std::find_if(members.begin(), members.end(), works);
    if (next == members.end()) {
        if (dealer && !config.checkpoint.empty()) save_checkpoint();
        throw Error(report.error, report.what);
    }
    if (led_by != std::size_t(next - members.begin()) && members[led_by].has_failed) {
        led_by = std::size_t(next - members.begin());
        lead_has_begun = false;
    }
    if (tell) tell(member.worker->name() + " is dropped and the others go on: " + report.what);
}

void RenderGroup::State::drop(std::size_t member, const std::string& why) {
    drop(members[member], {member, Report::Kind::failed, 0, 0, 0, 0, {}, ErrorKind::user, why});
}

/// A process that is alive and does not answer. A piece takes a tenth of a second, unless kernels are compiled before.
void RenderGroup::State::drop_silent() {
    for (std::size_t m = 0; m < members.size(); ++m)
        if (members[m].device == nullptr && !members[m].orders.empty() &&
            seconds_since(members[m].since) > most_seconds_of_order)
            drop(m, "it did not carry out an order in " + std::to_string(int(most_seconds_of_order)) + " s");
}

/// Waits until no member has an order for any of these pixels.
void RenderGroup::State::wait_for_orders(std::uint32_t first, std::uint32_t pixels) {
    const auto concerns = [&](const Order& order) {
        return order.batch.first_pixel < first + pixels && first < order.batch.first_pixel + order.batch.pixels;
    };
    const auto is_busy = [&](const Member& member) {
        return std::any_of(member.orders.begin(), member.orders.end(), concerns);
    };
    const Clock::time_point since = Clock::now();
    while (std::any_of(members.begin(), members.end(), is_busy)) {
        take_report(patience);
        if (!hurries || seconds_since(since) < seconds_to_hand_over) continue;
        for (std::size_t m = 0; m < members.size(); ++m)
            if (is_busy(members[m]) && members[m].device == nullptr) drop(m, "its last samples came too late");
    }
}

std::size_t RenderGroup::State::failures() const {
    return std::size_t(
        std::count_if(members.begin(), members.end(), [](const Member& member) { return member.has_failed; }));
}

bool RenderGroup::State::asked_for_sums() const {
    return std::any_of(members.begin(), members.end(), [](const Member& member) {
        return std::any_of(member.orders.begin(), member.orders.end(),
                           [](const Order& order) { return order.kind != Order::Kind::render; });
    });
}

void RenderGroup::State::ask_for_sums(bool of_lead) {
    for (std::size_t m = 0; m < members.size(); ++m)
        if (members[m].takes_orders() && (of_lead || m != led_by))
            for (const Order& order : dealer->handovers(members[m].number)) send(members[m], order);
}

/// Collects the sums of all workers in the lead's film. Afterwards no worker has an order.
void RenderGroup::State::gather(bool of_lead) {
    wait_for_orders();
    ask_for_sums(of_lead);
    while (!fill_film()) wait_for_orders();
    wait_for_orders();
}

/// Writes what the others have rendered to the lead's film, while they still read it. Returns false if a member failed,
/// so that the film must be filled anew.
bool RenderGroup::State::fill_film() {
    wait_for_lead();
    const std::size_t failed = failures();
    for (const PixelRun& run : dealer->held_by_others(members[led_by].number))
        for (std::uint32_t at = 0; at < run.pixels; at += pixels_at_once) {
            const std::uint32_t pixels = std::min(pixels_at_once, run.pixels - at);
            wait_for_orders(run.first + at, pixels);
            if (failures() != failed) return false;
            state_of(lead().renderer()).film.set_sums(sums.at(run.first + at, pixels), run.first + at);
        }
    return true;
}

namespace {

/// Where a single device continues: at the end of the pass that is furthest ahead, and not before the last look at the
/// error, but what is missing comes first.
AdaptiveSchedule::Position position_after(const std::vector<PixelRun>& runs, const Dealer& dealer, unsigned looked) {
    std::uint32_t most = 0;
    for (const PixelRun& run : runs) most = std::max(most, run.samples);
    const std::uint32_t end = runs.size() == 1 ? most : std::min(dealer.limit(), dealer.end_of_pass(most));
    const std::uint32_t done = std::max(end, looked);
    AdaptiveSchedule::Position position{{done, 0, 0, 0}, {}};
    for (const PixelRun& run : runs)
        if (run.samples < done) position.pending.push_back({run.first, run.pixels, run.samples, done - run.samples, 0});
    return position;
}

}  // namespace

/// The lead's renderer is left as if it had rendered all samples.
RenderProgress RenderGroup::State::hand_over() {
    Renderer::State& state = state_of(lead().renderer());
    (void)state.sampling.schedule.go_to(position_after(dealer->rendered(), *dealer, error.spp));
    state.error.progress = error, state.time.begin = begin;
    RenderProgress progress = state.measure();
    if (dealer->least() == 0) progress.spp = 0;  // no whole image
    return progress;
}

/// A device that fails later loses only what it has rendered since.
void RenderGroup::State::keep_now_and_then() {
    const bool saves = !config.checkpoint.empty();
    if (keeps && !asked_for_sums()) {
        keeps = false, last_sums = Clock::now();
        if (saves) save_checkpoint();
    }
    if (keeps || seconds_since(last_sums) < (saves ? config.checkpoint_seconds : seconds_between_sums)) return;
    ask_for_sums(true);
    keeps = true;
}

/// As a single device does, a full disk does not end the render. Where nothing is known a device that failed may have
/// left anything.
void RenderGroup::State::save_checkpoint() {
    const std::vector<PixelRun> known = dealer->known();
    const std::span<FilmPixel> all = sums.at(0, sums.pixels());
    Checkpoint checkpoint{position_after(known, *dealer, error.spp), error, {all.begin(), all.end()}};
    for (const PixelRun& run : known) {
        if (run.samples != 0) continue;
        std::fill_n(checkpoint.sums.begin() + run.first, run.pixels, FilmPixel{});
    }
    try {
        write_checkpoint(config.checkpoint, identity, checkpoint);
        checkpoint_error.clear();
    } catch (const Error& error) {
        checkpoint_error = error.what();
    }
}

RenderGroup::RenderGroup(const std::vector<Device>& devices, const Scene& scene, const RenderConfig& config,
                         std::function<void(const std::string&)> tell)
    : state_(std::make_unique<State>(devices, scene, config, std::move(tell))) {}

RenderGroup::~RenderGroup() = default;

RenderProgress RenderGroup::render(const std::function<bool(const RenderProgress&)>& progress) {
    return state_->render(progress);
}

Renderer& RenderGroup::renderer() { return state_->lead().renderer(); }

std::vector<DeviceShare> RenderGroup::shares() const {
    std::vector<DeviceShare> shares;
    for (const State::Member& member : state_->members) {
        DeviceShare share{member.worker->name(), 0, 0, member.failure};
        if (member.number >= 0) {
            share.samples = state_->dealer->samples_of(member.number);
            share.samples_per_second = state_->dealer->speed(member.number);
        }
        shares.push_back(std::move(share));
    }
    return shares;
}

const std::string& RenderGroup::checkpoint_error() const { return state_->checkpoint_error; }

}  // namespace claray
