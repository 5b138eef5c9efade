#include "claray/device.hpp"

#include <gtest/gtest.h>

#include "claray/program.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

TEST(Devices, ListHoldsWhatOpenClSays) {
    const std::vector<DeviceInfo> infos = list_devices();
    ASSERT_FALSE(infos.empty());
    for (std::size_t i = 0; i < infos.size(); ++i) {
        EXPECT_EQ(infos[i].index, i);
        EXPECT_FALSE(infos[i].name.empty());
        EXPECT_FALSE(infos[i].driver.empty());
        EXPECT_EQ(infos[i].version.substr(0, 7), "OpenCL ");
        EXPECT_GT(infos[i].compute_units, 0u);
        EXPECT_GT(infos[i].max_allocation, 0u);
        EXPECT_GE(infos[i].memory, infos[i].max_allocation);
        EXPECT_GE(infos[i].max_work_group, 1u);
        EXPECT_EQ(infos[i].fp64, infos[i].has("cl_khr_fp64"));
        EXPECT_FALSE(infos[i].has("cl_khr_"));  // whole names only
    }
}

TEST(Devices, OpenByIndexAndByPartOfName) {
    for (const DeviceInfo& info : list_devices()) {
        EXPECT_EQ(Device::open(std::to_string(info.index)).info().index, info.index);
        std::string upper = info.name;
        for (char& c : upper) c = char(std::toupper(static_cast<unsigned char>(c)));
        if (list_devices().size() == 1) {
            EXPECT_EQ(Device::open(upper.substr(1)).info().name, info.name);
        }
    }
}

TEST(Devices, NoMatchNamesWhatExists) {
    EXPECT_TRUE(throws_error(ErrorKind::usage, "no device matches 'no such thing'",
                             [] { (void)Device::open("no such thing"); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, list_devices()[0].name, [] { (void)Device::open("no such thing"); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "no device matches '99'", [] { (void)Device::open("99"); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "no device matches '-1'", [] { (void)Device::open("-1"); }));
}

TEST(Devices, EnvironmentDecidesWithoutSelector) {
    const ScopedEnvironment wrong("CLARAY_DEVICE", "nowhere");
    EXPECT_TRUE(throws_error(ErrorKind::usage, "no device matches 'nowhere'", [] { (void)Device::open(); }));
    EXPECT_EQ(Device::open("0").info().index, 0u);  // a selector wins over the environment
    const ScopedEnvironment right("CLARAY_DEVICE", "0");
    EXPECT_EQ(Device::open().info().index, 0u);
}

/// Sums 1 + 2 on a device, by a kernel.
int three_on(const Device& device) {
    Buffer<int> value(device, 1);
    compile_kernel(device, "kernel void add(global int* c, int a, int b) { *c = a + b; }", "add").run({1}, value, 1, 2);
    return value.read()[0];
}

cl_command_queue make_queue(cl_command_queue_properties properties) {
    cl_int status = CL_SUCCESS;
    const cl::Context& context = device().context();
    const cl_device_id id = context.getInfo<CL_CONTEXT_DEVICES>()[0]();
    const cl_command_queue queue = clCreateCommandQueue(context(), id, properties, &status);
    EXPECT_EQ(status, CL_SUCCESS);
    return queue;
}

TEST(Devices, AdoptUsesTheHostProgramsQueue) {
    const cl_command_queue queue = make_queue(CL_QUEUE_PROFILING_ENABLE);
    {
        const Device adopted = Device::adopt(device().context()(), queue);
        EXPECT_EQ(adopted.queue()(), queue);
        EXPECT_EQ(adopted.info().name, device().info().name);
        EXPECT_EQ(adopted.info().index, device().info().index);
        EXPECT_EQ(three_on(adopted), 3);
        EXPECT_EQ(adopted.profiler().summary().at("add").count, 1u);
    }
    // All that were retained are released; the driver's own threads may take a while to let go of finished commands.
    EXPECT_TRUE(becomes_true([&] {
        cl_uint references = 0;
        clGetCommandQueueInfo(queue, CL_QUEUE_REFERENCE_COUNT, sizeof references, &references, nullptr);
        return references == 1;
    }));
    clReleaseCommandQueue(queue);
}

TEST(Devices, AdoptWithoutProfilingMeasuresNothing) {
    const cl_command_queue queue = make_queue(0);
    const Device adopted = Device::adopt(device().context()(), queue);
    clReleaseCommandQueue(queue);
    EXPECT_EQ(three_on(adopted), 3);
    EXPECT_TRUE(adopted.profiler().summary().empty());
}

TEST(Devices, AdoptRefusesWhatCannotWork) {
    const cl_context context = device().context()();
    const cl::Context other(device().context().getInfo<CL_CONTEXT_DEVICES>());
    const cl_command_queue queue = make_queue(0);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "another context", [&] { (void)Device::adopt(other(), queue); }));
    EXPECT_TRUE(throws_error(ErrorKind::device, "cannot adopt", [&] { (void)Device::adopt(context, nullptr); }));
    clReleaseCommandQueue(queue);
    const cl_command_queue disordered = make_queue(CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE);
    EXPECT_TRUE(
        throws_error(ErrorKind::usage, "out-of-order queue", [&] { (void)Device::adopt(context, disordered); }));
    clReleaseCommandQueue(disordered);
}

}  // namespace
}  // namespace claray::test
