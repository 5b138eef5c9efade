// Which kernels the cases run: a kernel that no case runs is not verified.
#pragma once

#include "claray/verify.hpp"

namespace claray::verify {

/// Collects the functions of the kernels that run on a device until its end. Kernels may have other names where they
/// run: those of a render are called after their stages.
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
    std::set<std::string> run_;
    std::set<std::string>* before_;  // of a KernelsRun around this one
};

}  // namespace claray::verify
