// Kernel objects that nobody uses, for whoever loads the same kernel next.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "claray/program.hpp"

namespace claray {

/// A free function such as closest_hit loads its kernels in every call. Here it gets those of the call before, with the
/// descriptions of their parameters. A kernel object holds arguments, so it is never lent twice at the same time. Any
/// thread may call these functions.
class KernelPool : public std::enable_shared_from_this<KernelPool> {
public:
    /// Returns an idle kernel, or what `make` returns if there is none. It comes back with its last copy, and is lent
    /// again once neither a command nor a program holds the kernel object.
    [[nodiscard]] Kernel take(const Device& device, const cl::Program& program, const std::string& function,
                              const std::function<Kernel()>& make);
    /// Releases the idle kernels of a program.
    void forget(const cl::Program& program);
    /// How many kernels were made so far.
    [[nodiscard]] unsigned made() const;

private:
    using Key = std::pair<cl_program, std::string>;  // a kernel object retains its program
    struct Idle {
        cl::Kernel kernel;
        std::shared_ptr<const std::vector<Kernel::Parameter>> parameters;
    };
    struct Lease;
    [[nodiscard]] bool take_idle(const Key& key, Idle& idle);
    void give_back(const Key& key, Idle idle);

    mutable std::mutex mutex_;
    std::map<Key, std::vector<Idle>> idle_;
    unsigned made_ = 0;
};

}  // namespace claray
