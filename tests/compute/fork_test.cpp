// Processes made by fork(), in which drivers have no threads.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <string>

#include "claray/program.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

/// The exit code of a child that does this: 0 if it is refused.
int refused_in_child(const std::function<void()>& act) {
    const pid_t child = ::fork();
    if (child == 0) {
        ::alarm(60);  // without the remedy, most calls would wait without end
        try {
            act();
        } catch (const Error& error) {
            ::_exit(error.kind() == ErrorKind::usage && std::string(error.what()).find("spawn") != std::string::npos
                        ? 0
                        : 2);
        }
        ::_exit(1);
    }
    int status = 0;
    return ::waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status) : 3;
}

TEST(Fork, EveryUseIsRefusedInTheChild) {
    Buffer<std::uint32_t> buffer(device(), 4);
    buffer.fill(7);
    Kernel kernel = compile_kernel(device(), "kernel void one(global uint* x) { *x = 1; }", "one");
    EXPECT_EQ(refused_in_child([&] { kernel.run({1}, buffer); }), 0);
    EXPECT_EQ(refused_in_child([&] { static_cast<void>(buffer.read()); }), 0);
    EXPECT_EQ(refused_in_child([&] { buffer.write(std::vector<std::uint32_t>(4)); }), 0);
    EXPECT_EQ(refused_in_child([&] { buffer.fill(1); }), 0);
    EXPECT_EQ(refused_in_child([&] { Buffer<float>(device(), 4); }), 0);
    EXPECT_EQ(refused_in_child([&] { device().finish(); }), 0);
    EXPECT_EQ(refused_in_child([&] { static_cast<void>(device().event()); }), 0);
    EXPECT_EQ(refused_in_child([&] { static_cast<void>(device().with_new_queue()); }), 0);
    EXPECT_EQ(refused_in_child([&] { static_cast<void>(Device::open()); }), 0);
    EXPECT_EQ(refused_in_child([&] { static_cast<void>(list_devices()); }), 0);
    EXPECT_EQ(buffer.read(), std::vector<std::uint32_t>(4, 7)) << "the parent goes on";
}

TEST(Fork, HandlesMayBeReleasedInTheChild) {
    const pid_t child = ::fork();
    if (child == 0) {
        ::alarm(60);
        {
            std::vector<Device> last = {device()};
            last.clear();
        }
        ::_exit(0);
    }
    int status = 1;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace claray::test
