// What renders a part of an image: a device of this machine, or one elsewhere.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "claray/error.hpp"
#include "host/render/film/film.hpp"
#include "host/scale/dealer.hpp"

namespace claray {

/// What a worker reports.
struct Report {
    enum class Kind : std::uint32_t {
        ready,  ///< it can take orders
        done,   ///< its oldest order is done
        failed  ///< it takes no more orders
    };
    std::size_t worker = 0;
    Kind kind = Kind::ready;
    std::uint32_t first_paths = 0, most_paths = 0;  ///< of `ready`: see Dealer::add
    double handover = 0;                            ///< of `ready`: see Dealer::add
    double seconds = 0;                             ///< of `done`: see Dealer::done
    std::vector<FilmPixel> sums = {};               ///< of `done` for Order::Kind::read and give
    ErrorKind error = ErrorKind::device;            ///< of `failed`
    std::string what = {};                          ///< of `failed`
};

/// Reports of all workers, from any thread.
class Inbox {
public:
    void post(Report report) {
        {
            const std::lock_guard lock(mutex_);
            reports_.push_back(std::move(report));
        }
        arrived_.notify_one();
    }
    /// Waits for the next report; returns none after this time.
    [[nodiscard]] std::optional<Report> wait(std::chrono::microseconds most) {
        std::unique_lock lock(mutex_);
        if (!arrived_.wait_for(lock, most, [&] { return !reports_.empty(); })) return std::nullopt;
        Report report = std::move(reports_.front());
        reports_.pop_front();
        return report;
    }

private:
    std::mutex mutex_;
    std::condition_variable arrived_;
    std::deque<Report> reports_;
};

class Worker {
public:
    Worker() = default;
    virtual ~Worker() = default;
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    [[nodiscard]] virtual const std::string& name() const = 0;
    /// `sums`: those that the order brings. Asynchronous: the worker reports when the order is done.
    virtual void carry_out(const Order& order, std::vector<FilmPixel> sums) = 0;
    /// Orders that keep it busy while its reports and its next orders are on their way.
    [[nodiscard]] virtual std::size_t most_orders() const = 0;
};

}  // namespace claray
