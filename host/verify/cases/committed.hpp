// Results that are committed as hashes: every device must find the same bits.
#pragma once

#include <span>
#include <string>

#include "host/base/hash.hpp"
#include "host/verify/run.hpp"

namespace claray::verify {

template <class Values>
[[nodiscard]] std::string hash_of(const Values& values) {
    const auto bytes = std::as_bytes(std::span(values));
    return hash128(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

/// For what GPUs compute in another order than CPUs, for speed: sums of light grids and tiles, filters.
[[nodiscard]] inline std::string of_kind(const Run& run, const std::string& name) {
    return name + (run.device().info().type == DeviceType::cpu ? "" : ", as GPUs do it");
}

/// Collects comparisons with the committed hashes.
class Committed {
public:
    explicit Committed(Run& run) : run_(run) {}
    /// The first other hash is told: it is to be committed once the values are known to be right.
    template <class Values>
    void compare(const std::string& name, const Values& values) {
        compare_hash(name, hash_of(values));
    }
    void compare_hash(const std::string& name, const std::string& hash);
    /// Records how many were compared.
    void check(const std::string& what) const { run_.check(what + " that are not the committed ones", tally_, ""); }

private:
    Run& run_;
    Tally tally_;
};

}  // namespace claray::verify
