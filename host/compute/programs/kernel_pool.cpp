#include "host/compute/programs/kernel_pool.hpp"

#include <algorithm>

namespace claray {
namespace {

constexpr std::size_t most_idle = 32;  // of one kernel: a program may enqueue any number of queries before it waits

}  // namespace

struct KernelPool::Lease {
    std::weak_ptr<KernelPool> pool;
    Key key;
    Idle lent;

    Lease(std::weak_ptr<KernelPool> of, Key with, Idle idle)
        : pool(std::move(of)), key(std::move(with)), lent(std::move(idle)) {}
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease() {
        try {
            if (const auto all = pool.lock()) all->give_back(key, std::move(lent));
        } catch (const std::exception&) {  // the kernel is released
        }
    }
};

/// Drivers hold a kernel object until its commands are done, and programs may hold its handle.
bool KernelPool::take_idle(const Key& key, Idle& idle) {
    const std::lock_guard lock(mutex_);
    std::vector<Idle>& all = idle_[key];
    const auto found = std::find_if(
        all.begin(), all.end(), [](const Idle& one) { return one.kernel.getInfo<CL_KERNEL_REFERENCE_COUNT>() == 1; });
    if (found == all.end()) {
        ++made_;
        return false;
    }
    idle = std::move(*found);
    all.erase(found);
    return true;
}

Kernel KernelPool::take(const Device& device, const cl::Program& program, const std::string& function,
                        const std::function<Kernel()>& make) {
    const Key key{program(), function};
    Kernel kernel;
    if (Idle idle; take_idle(key, idle)) {
        kernel = Kernel(device, std::move(idle.kernel), function);
        kernel.parameters_ = std::move(idle.parameters);
    } else {
        kernel = make();
    }
    kernel.lease_ = std::make_shared<const Lease>(weak_from_this(), key, Idle{kernel.kernel_, kernel.parameters_});
    return kernel;
}

void KernelPool::give_back(const Key& key, Idle idle) {
    const std::lock_guard lock(mutex_);
    if (std::vector<Idle>& all = idle_[key]; all.size() < most_idle) all.push_back(std::move(idle));
}

void KernelPool::forget(const cl::Program& program) {
    const std::lock_guard lock(mutex_);
    std::erase_if(idle_, [&](const auto& of) { return of.first.first == program(); });
}

unsigned KernelPool::made() const {
    const std::lock_guard lock(mutex_);
    return made_;
}

}  // namespace claray
