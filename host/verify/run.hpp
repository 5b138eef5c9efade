// One case at work: what it may use, and where it writes down what it finds.
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

/// More of one device, each with a context of its own, since drivers compile one program after the other for each. What
/// is compiled for one is there for who takes it next. While they exist a renderer's programs are compiled in turn:
/// threads that compile for one context wait for each other, and hold up those of others.
class Devices {
public:
    explicit Devices(const Device& first)
        : selector_(std::to_string(first.info().index)), in_turn_(first, programs, at_once, 0) {}
    /// Nothing where the driver gives no more.
    [[nodiscard]] std::optional<Device> take();
    void give_back(const Device& device);

private:
    static constexpr const char *programs = "compute/programs", *at_once = "SIDE_BY_SIDE";
    std::string selector_;
    ScopedTuning in_turn_;
    std::mutex mutex_;
    std::vector<Device> idle_;
};

/// Calls piece(device, i) for every i below `count`: by so many threads, each with a device of its own, or here, where
/// one suffices. What a piece throws is thrown once all are done, the first of them.
void side_by_side(const Device& device, Devices& more, unsigned threads, std::size_t count,
                  const std::function<void(const Device&, std::size_t)>& piece);

class Run {
public:
    Run(const Device& device, Devices& more, const VerifyOptions& options, VerifyResult& result)
        : device_(device), more_(more), options_(options), result_(result) {}

    [[nodiscard]] const Device& device() const { return device_; }
    [[nodiscard]] std::uint64_t seed() const { return options_.seed; }
    [[nodiscard]] bool full() const { return options_.effort == Effort::full; }
    [[nodiscard]] bool times() const { return options_.times; }
    /// See verify::side_by_side: what takes kernels of its own many times, which drivers compile one after the other.
    void side_by_side(std::size_t count, const std::function<void(const Device&, std::size_t)>& piece) const;
    template <class T>
    [[nodiscard]] T count(T quick, T full_count) const {
        return full() ? full_count : quick;
    }

    /// Writes down a figure; it holds where worst <= bar.
    void check(const std::string& what, std::uint64_t tried, double worst, double bar, const std::string& unit);
    /// The same for how many times as long as `other` a task takes by the device's clock: medians of rounds by turns,
    /// so many that what disturbs a few of them doesn't matter.
    void check_time(const std::string& what, std::uint64_t tried, const std::function<void()>& task,
                    const std::function<void()>& other, double bar);
    void fact(const std::string& name, const std::string& value);
    /// The first wrong thing of a kind.
    void failure(const std::string& what);
    void picture(VerifyPicture picture);

private:
    const Device& device_;
    Devices& more_;
    const VerifyOptions& options_;
    VerifyResult& result_;
};

/// Wrong ones among many, with the first of them.
struct Tally {
    std::uint64_t tried = 0, wrong = 0, first = 0;
    void add(bool right) {
        if (!right && wrong++ == 0) first = tried;
        ++tried;
    }
};

/// In hexadecimal floating point, so that it can be typed in again exactly.
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
