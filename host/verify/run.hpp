// What a verification case may use, and where it records its results.
#pragma once

#include <deque>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "claray/bvh.hpp"
#include "claray/query.hpp"
#include "claray/verify.hpp"
#include "host/compute/contexts.hpp"

namespace claray::verify {

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
    void check(const std::string& what, std::uint64_t tried, double worst, double bar, const std::string& unit,
               bool known = false);
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

/// Runs a task with GuardedMemory. Throws if kernels write beyond a buffer.
void with_guards(const Device& device, const std::function<void()>& task);

/// All queries of a case trace the same tree.
[[nodiscard]] inline Bvh build(const Run& run, const Mesh& mesh, Bvh::Config config = {}) {
    config.learns = false;
    return Bvh::build(run.device(), std::span(&mesh, 1), config);
}

/// A value of the tuning table.
struct Setting {
    const char *kernel, *parameter;
    unsigned value;
};
/// A way of doing the same thing, which devices choose by their tables.
struct Form {
    const char* name;
    std::vector<Setting> settings;
};
/// Sets the values of a form until the end of the scope.
class ScopedForm {
public:
    ScopedForm(const Device& device, const Form& form) {
        for (const Setting& s : form.settings) tunings_.emplace_back(device, s.kernel, s.parameter, s.value);
    }

private:
    std::deque<ScopedTuning> tunings_;
};
/// How trees are built and keys are sorted: as the device's table says, and on CPUs also as GPUs do.
[[nodiscard]] std::vector<Form> build_forms(const Device& device);

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
