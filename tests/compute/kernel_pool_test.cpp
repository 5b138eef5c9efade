// host/compute/programs/kernel_pool.hpp: kernel objects that are used again.
#include "host/compute/programs/kernel_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <thread>

#include "claray/query.hpp"
#include "host/compute/device_state.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

Device fresh_device() { return Device::open(std::to_string(device().info().index)); }
Kernel loaded(const Device& of) { return load_kernel(of, "trace/closest_hit.cl", "closest_hit"); }

TEST(KernelPool, FreeQueriesMakeTheirKernelsOnce) {
    const Device own = fresh_device();
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    const Bvh bvh = Bvh::build(own, {&mesh, 1});
    const Ray ray{0.25f, 0.5f, 2.f, 0.f, 0.f, 0.f, -1.f, 1e30f};
    const auto distance = [&] { return closest_hit(bvh, {&ray, 1})[0].t; };
    EXPECT_EQ(distance(), 2.f);
    const unsigned made = state_of(own).kernels->made();
    EXPECT_GT(made, 0u);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(distance(), 2.f);
    EXPECT_EQ(state_of(own).kernels->made(), made);
}

TEST(KernelPool, LendsNoKernelTwice) {
    const Device own = fresh_device();
    Kernel first = loaded(own);
    const Kernel second = loaded(own);
    EXPECT_NE(first.handle()(), second.handle()());
    const Kernel copy = first;
    first = {};
    EXPECT_NE(loaded(own).handle()(), copy.handle()()) << "a copy is still in use";
    cl::Kernel kept;
    {
        const Kernel third = loaded(own);
        kept = third.handle();
    }
    EXPECT_NE(loaded(own).handle()(), kept()) << "the program holds the kernel object";
}

TEST(KernelPool, LendsNoKernelToTwoThreads) {
    const Device own = fresh_device();
    (void)loaded(own);  // compiles
    std::mutex mutex;
    std::set<cl_kernel> in_use;
    std::atomic<unsigned> twice = 0;
    const auto work = [&] {
        for (int i = 0; i < 200; ++i) {
            const Kernel kernel = loaded(own);
            {
                const std::lock_guard lock(mutex);
                if (!in_use.insert(kernel.handle()()).second) ++twice;
            }
            std::this_thread::yield();
            const std::lock_guard lock(mutex);
            in_use.erase(kernel.handle()());
        }
    };
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) threads.emplace_back(work);
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(twice, 0u);
    EXPECT_LE(state_of(own).kernels->made(), 4u);
}

}  // namespace
}  // namespace claray::test
