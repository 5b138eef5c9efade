// Which kernels the cases run: a kernel that no case runs is not verified.
#pragma once

#include "claray/verify.hpp"

namespace claray::verify {

/// Collects the names of the kernels that run on a device until its end.
class KernelsRun {
public:
    /// Does nothing unless `wanted`.
    KernelsRun(const Device& device, bool wanted, std::set<std::string>& names);
    ~KernelsRun();
    KernelsRun(const KernelsRun&) = delete;
    KernelsRun& operator=(const KernelsRun&) = delete;

private:
    const Device& device_;
    bool wanted_;
    std::set<std::string>& names_;
    std::size_t first_ = 0;  // of the profiler's records
};

}  // namespace claray::verify
