#include "host/verify/apart/run_apart.hpp"

#include <algorithm>
#include <list>
#include <map>
#include <numeric>
#include <thread>

#include "host/base/format.hpp"
#include "host/scene/bytes.hpp"
#include "host/verify/apart/child.hpp"
#include "host/verify/apart/claims.hpp"

namespace claray {

template <IsOf<DeviceInfo> T, class Visit>
void visit_members(T& info, const Visit& visit) {
    auto& [index, platform, name, vendor, driver, version, type, compute_units, memory, max_allocation, local_memory,
           max_work_group, fp64, exact_divide, extensions] = info;
    visit(index, platform, name, vendor, driver, version, type, compute_units, memory, max_allocation, local_memory,
          max_work_group, fp64, exact_divide, extensions);
}

template <IsOf<VerifyCheck> T, class Visit>
void visit_members(T& check, const Visit& visit) {
    auto& [what, tried, worst, bar, unit, time, known] = check;
    visit(what, tried, worst, bar, unit, time, known);
}

template <IsOf<VerifyPicture::Shape> T, class Visit>
void visit_members(T& shape, const Visit& visit) {
    auto& [points, filled, color] = shape;
    visit(points, filled, color);
}

template <IsOf<VerifyPicture> T, class Visit>
void visit_members(T& picture, const Visit& visit) {
    auto& [title, shapes] = picture;
    visit(title, shapes);
}

template <IsOf<VerifyResult> T, class Visit>
void visit_members(T& result, const Visit& visit) {
    auto& [name, checks, facts, failures, pictures, seconds, seed, command, kernels] = result;
    visit(name, checks, facts, failures, pictures, seconds, seed, command, kernels);
}

namespace verify {
namespace {

using Clock = Child::Clock;

enum class MessageKind : int { opened, begun, ended, done, failed };

template <class... T>
std::string message_of(MessageKind kind, const T&... values) {
    ByteWriter writer;
    writer.add(kind, values...);
    return writer.take();
}

/// A process, and what was heard of it.
struct Worker {
    Worker(unsigned number, bool one_by_one, const std::function<void(const Child::Send&)>& work)
        : number(number), one_by_one(one_by_one), child(work) {}

    unsigned number;
    bool one_by_one;
    Child child;
    bool opened = false, done = false;
    Clock::time_point since = Clock::now();  // it was last heard
    std::map<std::size_t, Clock::time_point> under_way = {};
};

class Workers {
public:
    Workers(const ApartJob& job, std::vector<std::size_t> which, double limit, const ApartEvents& events)
        : job_(job),
          limit_(limit),
          events_(events),
          left_(std::move(which)),
          claims_(1 + *std::ranges::max_element(left_)) {}

    void run() {
        while (!left_.empty()) {
            if (workers_.empty()) start();
            wait();
            for (auto i = workers_.begin(); i != workers_.end();) {
                const auto worker = i++;
                if (const std::optional<std::string> why = end_of(*worker)) replace(worker, *why);
            }
        }
        for (Worker& worker : workers_) (void)worker.child.ended(Clock::now() + seconds_to_end);
    }

private:
    static constexpr std::chrono::seconds seconds_to_end{10};  // drivers may hang when programs end

    void start() {
        const unsigned number = ++started_;
        const bool one_by_one = one_by_one_;
        workers_.emplace_back(number, one_by_one,
                              [&](const Child::Send& send) { work_in_child(number, one_by_one, send); });
    }

    void work_in_child(unsigned number, bool one_by_one, const Child::Send& send) {
        const auto begun = [&](std::size_t i) {
            const bool mine = claims_.take(i, number);
            if (mine) send(message_of(MessageKind::begun, i));
            return mine;
        };
        const auto ended = [&](std::size_t i, const VerifyResult& result) {
            send(message_of(MessageKind::ended, i, result));
        };
        try {
            send(message_of(MessageKind::opened, job_.open()));
            job_.run(left_, one_by_one, {begun, ended});
            send(message_of(MessageKind::done));
        } catch (const Error& error) {
            send(message_of(MessageKind::failed, error.kind(), std::string(error.what())));
        } catch (const std::exception& error) {
            send(message_of(MessageKind::failed, ErrorKind::device, std::string(error.what())));
        }
    }

    /// 0: none.
    [[nodiscard]] double limit_of(const Worker& worker) const { return worker.opened ? limit_ : job_.seconds_to_open; }

    [[nodiscard]] Clock::time_point deadline_of(const Worker& worker) const {
        if (worker.done || limit_of(worker) <= 0) return Clock::time_point::max();
        Clock::time_point first = worker.since;
        for (const auto& [i, begun] : worker.under_way) first = std::min(first, begun);
        return first + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit_of(worker)));
    }

    /// Until a process says something, ends, or hangs.
    void wait() {
        std::vector<Child*> children;
        Clock::time_point until = Clock::time_point::max();
        for (Worker& worker : workers_) {
            children.push_back(&worker.child);
            until = std::min(until, deadline_of(worker));
        }
        (void)Child::wait(children, until);
    }

    /// Takes what the process has sent. Returns why it died: empty if it has done its work; nothing while it goes on.
    [[nodiscard]] std::optional<std::string> end_of(Worker& worker) {
        std::string message;
        Child::Heard heard = Child::Heard::message;
        while ((heard = worker.child.hear(message, Clock::now())) == Child::Heard::message) take(worker, message);
        if (heard == Child::Heard::end) {
            const std::string how = worker.child.ended(Clock::now() + seconds_to_end);
            if (worker.done) return "";  // a driver that crashes when its program ends has done its work
            return "the driver ended the process " + (how.empty() ? "with exit code 0" : how);
        }
        if (Clock::now() < deadline_of(worker)) return {};
        return printed("killed after %g s without an end", limit_of(worker));
    }

    void take(Worker& worker, const std::string& message) {
        worker.since = Clock::now();
        ByteReader reader(message);
        MessageKind kind = MessageKind::opened;
        reader.get(kind);
        if (kind == MessageKind::opened) {
            DeviceInfo info;
            reader.get(info);
            worker.opened = true;
            if (!std::exchange(told_device_, true)) begin_with(info);
        } else if (kind == MessageKind::failed) {
            ErrorKind error = ErrorKind::device;
            std::string text;
            reader.get(error, text);
            const std::size_t end = std::min(text.find('\n'), text.size());
            throw Error(error, text.substr(0, end), {}, text.substr(std::min(end + 1, text.size())));
        } else if (kind == MessageKind::done) {
            worker.done = true;
        } else {
            std::size_t i = 0;
            reader.get(i);
            if (kind == MessageKind::begun) {
                worker.under_way[i] = Clock::now();
                return;
            }
            VerifyResult result;
            reader.get(result);
            worker.under_way.erase(i);
            std::erase(left_, i);
            events_.ended(i, result);
        }
    }

    void begin_with(const DeviceInfo& info) {
        events_.opened(info);
        const unsigned processes = job_.processes ? job_.processes(info) : 1;
        while (started_ < std::min<std::size_t>(processes, left_.size())) start();
    }

    /// Of a process that ended.
    void replace(std::list<Worker>::iterator worker, const std::string& why) {
        std::list<Worker> ended;
        ended.splice(ended.end(), workers_, worker);
        if (!worker->done) blame(*worker, why);
        ended.clear();  // it is killed before another begins
        const auto is_free = [&](std::size_t i) { return claims_.owner(i) == 0; };
        if (std::ranges::any_of(left_, is_free)) start();
    }

    /// The case that the process died of has died, if that is certain.
    void blame(const Worker& worker, const std::string& why) {
        if (!worker.opened)
            throw Error(ErrorKind::device, "the device cannot be opened: " + why, "remove this driver, or update it");
        std::vector<std::size_t> suspects = left_;
        std::erase_if(suspects, [&](std::size_t i) { return claims_.owner(i) != worker.number; });
        const bool certain = worker.one_by_one || suspects.size() == 1;
        one_by_one_ = true;
        if (!certain) {
            for (const std::size_t i : suspects) claims_.give_back(i);
            return;
        }
        if (suspects.empty()) {  // it died before it took the next one
            const auto next =
                std::ranges::find_if(left_, [&](std::size_t i) { return claims_.take(i, worker.number); });
            if (next == left_.end()) return;
            suspects = {*next};
        }
        const auto begun = worker.under_way.find(suspects[0]);
        const Clock::time_point since = begun == worker.under_way.end() ? Clock::now() : begun->second;
        std::erase(left_, suspects[0]);
        events_.died(suspects[0], why, std::chrono::duration<double>(Clock::now() - since).count());
    }

    const ApartJob& job_;
    double limit_;
    const ApartEvents& events_;
    std::vector<std::size_t> left_;
    Claims claims_;
    std::list<Worker> workers_ = {};
    unsigned started_ = 0;
    bool one_by_one_ = false, told_device_ = false;
};

}  // namespace

void run_in_children(const ApartJob& job, std::vector<std::size_t> which, double limit, const ApartEvents& events) {
    if (!which.empty()) Workers(job, std::move(which), limit, events).run();
}

void InOrder::add(std::size_t i, const VerifyResult& result) {
    results_[i] = result;
    while (next_ < results_.size() && results_[next_]) report_(*results_[next_++]);
}

VerifyResult unended(const std::string& name, const VerifyOptions& options, const DeviceInfo& device,
                     const std::string& why, double seconds) {
    VerifyResult result;
    result.name = name, result.seed = options.seed, result.seconds = seconds;
    result.checks = {{unended_figure, 1, 1, 0, "runs"}};
    result.failures = {why};
    result.command = command_of(name, options, device);
    return result;
}

/// Drivers of CPUs compile by one thread at a time, so that processors would wait.
static unsigned processes_for(const DeviceInfo& device, const VerifyOptions& options) {
    if (device.type != DeviceType::cpu) return 1;
    return options.threads != 0 ? options.threads : std::clamp(std::thread::hardware_concurrency(), 1u, 2u);
}

void run_verify_cases_apart(const std::function<Device()>& open, std::span<const std::string> names,
                            const VerifyOptions& options, double limit,
                            const std::function<void(const DeviceInfo&)>& opened,
                            const std::function<void(const VerifyResult&)>& report) {
    check_verify_cases(names);
    std::optional<Device> device;  // of a child
    const auto open_it = [&] {
        device = open();
        return device->info();
    };
    const auto run = [&](std::span<const std::size_t> which, bool one_by_one, const CaseEvents& events) {
        VerifyOptions with = options;
        if (one_by_one || device->info().type == DeviceType::cpu) with.threads = 1;
        run_numbered_cases(*device, names, which, with, events);
        device.reset();
    };
    DeviceInfo info;
    InOrder in_order(names.size(), report);
    bool told = false;
    const auto open_once = [&](const DeviceInfo& its) {
        if (!std::exchange(told, true)) opened(info = its);
    };
    const auto died = [&](std::size_t i, const std::string& why, double seconds) {
        in_order.add(i, unended(names[i], options, info, why, seconds));
    };
    const ApartEvents events = {open_once, [&](std::size_t i, const VerifyResult& result) { in_order.add(i, result); },
                                died};
    std::vector<std::size_t> timed, others;
    for (std::size_t i = 0; i < names.size(); ++i)
        (options.times && measures_times(names[i]) ? timed : others).push_back(i);
    const auto processes = [&](const DeviceInfo& its) { return processes_for(its, options); };
    run_in_children({.open = open_it, .run = run, .processes = processes}, others, limit, events);
    run_in_children({.open = open_it, .run = run}, timed, limit, events);
}

}  // namespace verify
}  // namespace claray
