// The comparison with tinybvh starts the peer's kernels in whole groups of a stated size, whatever the number of rays:
// with a stub of the peer's traversal that tells how it was started.
#include <gtest/gtest.h>

#include <fstream>

#include "bench/peers/tinybvh_kernels.hpp"
#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

namespace claray::measure {
namespace {

constexpr const char* stub = R"(
float4 traverse_ailalaine(global const struct BVHNode* nodes, global const uint* idx, global const float4* corners,
                          global const uint* opmap, float3 o, float3 d, float3 rd, float tmax, uint* steps) {
    return (float4)(o.x, get_local_size(0), get_global_size(0), tmax);
}
bool isoccluded_ailalaine(global const struct BVHNode* nodes, global const uint* idx, global const float4* corners,
                          global const uint* opmap, float3 o, float3 d, float3 rd, float tmax) {
    return tmax > 2.0f;
}
)";

class TinybvhLaunch : public testing::Test {
protected:
    TinybvhLaunch() {
        std::ofstream(folder_.path() / "traverse_bvh2.cl") << stub;
        program_ = build_tinybvh(test::device(), folder_.path().string());
    }

    template <class Result>
    std::vector<Result> start(const char* name, std::size_t count, std::size_t group, const Result& untouched) {
        std::vector<Ray> rays(count + 300);
        for (std::size_t i = 0; i < rays.size(); ++i) rays[i] = {float(i), 0, 0, 0, 0, 0, 1, float(i % 5)};
        const Buffer<std::uint32_t> unused(test::device(), 1);
        const Buffer<Ray> on_device(test::device(), rays);
        const Buffer<Result> results(test::device(), std::vector<Result>(rays.size(), untouched));
        cl::Kernel kernel(program_, name);
        for (const cl_uint i : {0u, 1u, 2u}) kernel.setArg(i, unused.memory());
        kernel.setArg(3, on_device.memory()), kernel.setArg(5, results.memory());
        start_tinybvh(test::device(), kernel, count, group);
        return results.read();
    }

private:
    test::TemporaryFolder folder_;
    cl::Program program_;
};

constexpr std::size_t counts[] = {1, 63, 64, 97, 128, 1009, 1024};  // 97 and 1009 are prime

TEST_F(TinybvhLaunch, GroupsAreWholeForAnyNumberOfRays) {
    for (const std::size_t group : {64, 128})
        for (const std::size_t count : counts) {
            const std::vector<glm::vec4> hits = start("closest", count, group, glm::vec4(-7));
            const auto whole = float((count + group - 1) / group * group);
            for (std::size_t i = 0; i < hits.size(); ++i) {
                const glm::vec4 expected =
                    i < count ? glm::vec4(float(i), float(group), whole, float(i % 5)) : glm::vec4(-7);
                ASSERT_EQ(hits[i], expected) << "ray " << i << " of " << count << " in groups of " << group;
            }
        }
}

TEST_F(TinybvhLaunch, ShadowRaysBehindTheLastAreNotTraced) {
    for (const std::size_t count : counts) {
        const std::vector<std::uint8_t> occluded = start<std::uint8_t>("occlusion", count, 64, 9);
        for (std::size_t i = 0; i < occluded.size(); ++i)
            ASSERT_EQ(occluded[i], i < count ? i % 5 > 2 : 9) << "ray " << i << " of " << count;
    }
}

TEST(PrimeUpTo, IsTheLargest) {
    EXPECT_EQ(prime_up_to(2), 2u);
    EXPECT_EQ(prime_up_to(4), 3u);
    EXPECT_EQ(prime_up_to(128), 127u);
    EXPECT_EQ(prime_up_to(6'220'800), 6'220'777u);
}

}  // namespace
}  // namespace claray::measure
