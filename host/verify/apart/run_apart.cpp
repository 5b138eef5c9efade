#include "host/verify/apart/run_apart.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "host/base/format.hpp"
#include "host/scene/bytes.hpp"
#include "host/verify/apart/child.hpp"

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

enum class Kind : int { opened, begun, ended, failed };

template <class... T>
std::string message_of(Kind kind, const T&... values) {
    ByteWriter writer;
    writer.add(kind, values...);
    return writer.take();
}

void work_in_child(const ApartJob& job, std::span<const std::size_t> which, bool one_by_one, const Child::Send& send) {
    try {
        send(message_of(Kind::opened, job.open()));
        job.run(which, one_by_one,
                {[&](std::size_t i) { send(message_of(Kind::begun, i)); },
                 [&](std::size_t i, const VerifyResult& result) { send(message_of(Kind::ended, i, result)); }});
    } catch (const Error& error) {
        send(message_of(Kind::failed, error.kind(), std::string(error.what())));
    } catch (const std::exception& error) {
        send(message_of(Kind::failed, ErrorKind::device, std::string(error.what())));
    }
}

/// Hears one child process until it ends.
class Hearing {
public:
    Hearing(std::vector<std::size_t>& left, double seconds_to_open, double limit, const ApartEvents& events,
            bool& told_device)
        : left_(left), seconds_to_open_(seconds_to_open), limit_(limit), events_(events), told_device_(told_device) {}

    /// Returns why the process died; empty if all cases ended.
    [[nodiscard]] std::string hear(Child& child) {
        std::string message;
        for (;;) {
            const Child::Heard heard = child.hear(message, deadline());
            if (heard == Child::Heard::nothing) return printed("killed after %g s without an end", limit());
            if (heard == Child::Heard::end) break;
            since_ = Clock::now();
            take(message);
        }
        const std::string how = child.ended(since_ + seconds_to_end);
        if (left_.empty()) return {};  // a driver that crashes when its program ends has done its work
        return "the driver ended the process " + (how.empty() ? "with exit code 0" : how);
    }
    [[nodiscard]] bool opened() const { return opened_; }
    [[nodiscard]] const std::map<std::size_t, Clock::time_point>& under_way() const { return under_way_; }

private:
    static constexpr std::chrono::seconds seconds_to_end{10};  // drivers may hang when programs end

    /// 0: none.
    [[nodiscard]] double limit() const { return opened_ ? limit_ : seconds_to_open_; }
    [[nodiscard]] Clock::time_point deadline() const {
        if (left_.empty()) return since_ + seconds_to_end;
        if (limit() <= 0) return Clock::time_point::max();
        Clock::time_point first = since_;
        for (const auto& [i, begun] : under_way_) first = std::min(first, begun);
        return first + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit()));
    }

    void take(const std::string& message) {
        ByteReader reader(message);
        Kind kind = Kind::opened;
        reader.get(kind);
        if (kind == Kind::opened) {
            DeviceInfo info;
            reader.get(info);
            opened_ = true;
            if (!std::exchange(told_device_, true)) events_.opened(info);
        } else if (kind == Kind::failed) {
            ErrorKind error = ErrorKind::device;
            std::string text;
            reader.get(error, text);
            const std::size_t end = std::min(text.find('\n'), text.size());
            throw Error(error, text.substr(0, end), {}, text.substr(std::min(end + 1, text.size())));
        } else {
            std::size_t i = 0;
            reader.get(i);
            if (kind == Kind::begun) {
                under_way_[i] = Clock::now();
                return;
            }
            VerifyResult result;
            reader.get(result);
            under_way_.erase(i);
            std::erase(left_, i);
            events_.ended(i, result);
        }
    }

    std::vector<std::size_t>& left_;
    double seconds_to_open_, limit_;
    const ApartEvents& events_;
    bool& told_device_;
    bool opened_ = false;
    Clock::time_point since_ = Clock::now();
    std::map<std::size_t, Clock::time_point> under_way_;
};

}  // namespace

void run_in_children(const ApartJob& job, std::size_t count, double limit, const ApartEvents& events) {
    std::vector<std::size_t> left(count);
    std::iota(left.begin(), left.end(), std::size_t(0));
    bool one_by_one = false, told_device = false;
    while (!left.empty()) {
        const std::vector<std::size_t> which = left;
        Child child([&](const Child::Send& send) { work_in_child(job, which, one_by_one, send); });
        Hearing hearing(left, job.seconds_to_open, limit, events, told_device);
        const std::string why = hearing.hear(child);
        if (left.empty()) return;
        if (!hearing.opened())
            throw Error(ErrorKind::device, "the device cannot be opened: " + why, "remove this driver, or update it");
        const auto& under_way = hearing.under_way();
        const bool certain = one_by_one || under_way.size() == 1;
        one_by_one = true;
        if (!certain) continue;
        const std::size_t guilty = under_way.empty() ? left.front() : under_way.begin()->first;
        std::erase(left, guilty);
        const double seconds =
            under_way.empty() ? 0 : std::chrono::duration<double>(Clock::now() - under_way.begin()->second).count();
        events.died(guilty, why, seconds);
    }
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
        if (one_by_one) with.threads = 1;
        run_numbered_cases(*device, names, which, with, events);
        device.reset();
    };
    DeviceInfo info;
    InOrder in_order(names.size(), report);
    const auto open_once = [&](const DeviceInfo& its) { opened(info = its); };
    const auto died = [&](std::size_t i, const std::string& why, double seconds) {
        in_order.add(i, unended(names[i], options, info, why, seconds));
    };
    run_in_children({open_it, run}, names.size(), limit,
                    {open_once, [&](std::size_t i, const VerifyResult& result) { in_order.add(i, result); }, died});
}

}  // namespace verify
}  // namespace claray
