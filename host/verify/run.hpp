// What a verification case may use, and where it records its results.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "claray/bvh.hpp"
#include "claray/query.hpp"
#include "claray/verify.hpp"

namespace claray::verify {

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

/// Calls piece(device, i) for every i below `count`, on up to `threads` threads with a device each. The calling thread
/// is one of them. If pieces throw, the first exception is rethrown after all threads have ended.
void side_by_side(const Device& device, Devices& more, unsigned threads, std::size_t count,
                  const std::function<void(const Device&, std::size_t)>& piece);

/// Counts wrong results and keeps the number of the first one.
struct Tally {
    std::uint64_t tried = 0, wrong = 0, first = 0;
    /// Returns true for the first wrong result.
    bool add(bool right) {
        const bool is_first = !right && wrong++ == 0;
        if (is_first) first = tried;
        ++tried;
        return is_first;
    }
};

class Run {
public:
    Run(const Device& device, Devices& more, const VerifyOptions& options, VerifyResult& result)
        : device_(device), more_(more), options_(options), result_(result) {}

    [[nodiscard]] const Device& device() const { return device_; }
    [[nodiscard]] std::uint64_t seed() const { return options_.seed; }
    [[nodiscard]] bool full() const { return options_.effort == Effort::full; }
    [[nodiscard]] bool times() const { return options_.times; }
    /// See verify::side_by_side. For pieces that compile kernels of their own.
    void side_by_side(std::size_t count, const std::function<void(const Device&, std::size_t)>& piece) const;
    template <class T>
    [[nodiscard]] T count(T quick, T full_count) const {
        return full() ? full_count : quick;
    }

    /// Records a figure; the check holds if worst <= bar.
    void check(const std::string& what, std::uint64_t tried, double worst, double bar, const std::string& unit);
    /// Holds if no result of the tally is wrong.
    void check(const std::string& what, const Tally& tally, const std::string& unit) {
        check(what, tally.tried, double(tally.wrong), 0, unit);
    }
    /// Records the device time of `task` over that of `other`. They run alternately, and the medians of many rounds are
    /// compared, so that a few disturbed rounds do not matter.
    void check_time(const std::string& what, std::uint64_t tried, const std::function<void()>& task,
                    const std::function<void()>& other, double bar);
    void fact(const std::string& name, const std::string& value);
    /// Records the first failure of a kind.
    void failure(const std::string& what);
    void picture(VerifyPicture picture);

private:
    const Device& device_;
    Devices& more_;
    const VerifyOptions& options_;
    VerifyResult& result_;
};

[[nodiscard]] inline Bvh build(const Run& run, const Mesh& mesh, const Bvh::Config& config = {}) {
    return Bvh::build(run.device(), std::span(&mesh, 1), config);
}

/// In hexadecimal floating point, which is exact.
[[nodiscard]] std::string text_of(const Ray& ray);

/// The triangles around a ray, seen along it; the ray is the dot in the middle, `wrong` is filled.
[[nodiscard]] VerifyPicture picture_along(const Ray& ray, const Mesh& mesh, std::uint32_t wrong,
                                          const std::string& title);
/// Curves over x, such as what was found and what was expected; scaled to their common range.
struct Curve {
    std::vector<double> x, y;
    std::uint32_t color;
};
[[nodiscard]] VerifyPicture picture_of_curves(std::vector<Curve> curves, const std::string& title);

/// Both layouts, for cases that must hold in either, with their names.
struct NamedLayout {
    Layout layout;
    const char* name;
};
inline constexpr NamedLayout layouts[] = {{Layout::binary, "binary"}, {Layout::wide, "wide"}};

}  // namespace claray::verify
