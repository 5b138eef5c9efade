#include "claray/program.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "claray/shared/path.h"
#include "claray/shared/types.h"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

struct Particle {
    float position, velocity;
    std::int32_t bounces;
    std::uint8_t tag;
};

TEST(Program, AnyStructIsBoundRunAndReadBack) {
    for (const std::size_t count : {1u, 63u, 64u, 1000u}) {
        std::vector<Particle> particles(count);
        for (std::size_t i = 0; i < count; ++i) particles[i] = {float(i), 2.f, int(i) % 3, std::uint8_t(i)};
        const char* source =
            "typedef struct { float position, velocity; int bounces; uchar tag; } Particle;"
            "kernel void move(global Particle* particles, float dt, uint count) {"
            "    const uint i = get_global_id(0);"
            "    if (i >= count) return;"
            "    particles[i].position += dt * particles[i].velocity;"
            "    particles[i].bounces++;"
            "}";
        Buffer<Particle> buffer(device(), particles);
        compile_kernel(device(), source, "move").run({count, 64}, buffer, 0.25f, std::uint32_t(count));
        const std::vector<Particle> moved = buffer.read();
        for (std::size_t i = 0; i < count; ++i) {
            ASSERT_EQ(moved[i].position, float(i) + 0.5f);
            ASSERT_EQ(moved[i].bounces, int(i) % 3 + 1);
            ASSERT_EQ(moved[i].tag, std::uint8_t(i));
        }
    }
}

TEST(Program, StructByValueAndClarayHeaders) {
    const char* source =
        "#include \"claray/shared/types.h\"\n"
        "kernel void length_of(Ray ray, global float* length) { *length = ray.tmax - ray.tmin; }";
    Buffer<float> length(device(), 1);
    compile_kernel(device(), source, "length_of").run({1}, Ray{0, 0, 0, 1.5f, 0, 0, 0, 4.f}, length);
    EXPECT_EQ(length.read()[0], 2.5f);
}

TEST(Program, GlobalSizeIsRoundedUpToWholeGroups) {
    Buffer<std::uint32_t> sizes(device(), 1);
    Kernel kernel = compile_kernel(device(), "kernel void size(global uint* s) { *s = get_global_size(0); }", "size");
    kernel.run({100, 32}, sizes);
    EXPECT_EQ(sizes.read()[0], 128u);
    kernel.run({100}, sizes);
    EXPECT_EQ(sizes.read()[0], 100u);
    kernel.run({0, 32}, sizes);  // nothing to do, nothing done
    EXPECT_EQ(sizes.read()[0], 100u);
}

struct TwoArguments {
    int a, b;
    void bind(Kernel& kernel, unsigned& index) const {
        kernel.set(index, a);
        kernel.set(index, b);
    }
};

TEST(Program, ArgumentsOfEveryKind) {
    const char* source =
        "kernel void every_kind(global int* out, global const int* absent, local int* scratch, int a, int b) {"
        "    scratch[get_local_id(0)] = 1;"
        "    barrier(CLK_LOCAL_MEM_FENCE);"
        "    int sum = absent ? 1000 : 0;"
        "    for (uint i = 0; i < get_local_size(0); ++i) sum += scratch[i];"
        "    out[get_global_id(0)] = sum + a * b;"
        "}";
    Buffer<int> out(device(), 16);
    Kernel kernel = compile_kernel(device(), source, "every_kind");
    kernel.run({16, 16}, out, nullptr, LocalMemory{16 * sizeof(int)}, TwoArguments{3, 5});
    EXPECT_EQ(out.read(), std::vector<int>(16, 31));
    kernel.run({16, 16}, out, Buffer<int>(), LocalMemory{16 * sizeof(int)}, 3, 5);
    EXPECT_EQ(out.read(), std::vector<int>(16, 31));
    kernel.run({16, 16}, out, out, LocalMemory{16 * sizeof(int)}, 3, 5);
    EXPECT_EQ(out.read(), std::vector<int>(16, 1031));
}

TEST(Program, WrongArgumentsAreRefused) {
    Buffer<int> out(device(), 1);
    Kernel kernel = compile_kernel(device(), "kernel void set(global int* out, int a) { *out = a; }", "set");
    EXPECT_TRUE(throws_error(ErrorKind::usage, "takes 2 arguments, 1 were given", [&] { kernel.run({1}, out); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "argument 2 of the kernel set", [&] { kernel.run({1}, out, 1, 2); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "argument 1 of the kernel set", [&] { kernel.run({1}, out, 1.0); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "never loaded", [&] { Kernel().run({1}); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "never loaded", [&] { Kernel().run({1}, out); }));
}

TEST(Program, CompilerErrorsKeepFileAndLine) {
    const auto compile = [](const std::string& source) {
        return [source] { (void)compile_kernel(device(), source, "f", {}, Math::strict, "mine.cl"); };
    };
    EXPECT_TRUE(throws_error(ErrorKind::device, "mine.cl:3", compile("\n\nthis is no kernel;\n")));
    EXPECT_TRUE(throws_error(ErrorKind::device, "no/such/header.h", compile("#include \"no/such/header.h\"\n")));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "'mine.cl' has no kernel 'f'; its kernels are g",
                             compile("kernel void g() {}")));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "no kernel file no/such/file.cl",
                             [] { (void)load_kernel(device(), "no/such/file.cl", "f"); }));
}

TEST(Program, DefinesReachTheSource) {
    Buffer<int> out(device(), 1);
    for (const char* value : {"7", "11"}) {
        compile_kernel(device(), "kernel void set(global int* out) { *out = VALUE; }", "set", {{"VALUE", value}})
            .run({1}, out);
        EXPECT_EQ(out.read()[0], std::atoi(value));
    }
}

TEST(Program, TuningValuesReachTheFileTheyAreFor) {
    // The group size becomes a macro of its file; an impossible value shows that it arrives, and that the caller wins.
    const Device fresh = Device::open(std::to_string(device().info().index));
    EXPECT_EQ(fresh.tuning("bvh/hploc", "GROUP_SIZE"), 128u);
    fresh.set_tuning("bvh/hploc", "GROUP_SIZE", 0);
    const auto load = [&](const Defines& defines) { (void)load_kernel(fresh, "bvh/hploc.cl", "build_hploc", defines); };
    EXPECT_TRUE(throws_error(ErrorKind::device, "-DGROUP_SIZE=0", [&] { load({}); }));
    EXPECT_NO_THROW(load({{"GROUP_SIZE", "64"}}));
}

TEST(Program, StrictMathDoesNotContract) {
    // a * b + c, whose product is exactly 1 + 2^-11 + 2^-24: contracted the sum is 2^-24, rounded in between 0.
    const char* source =
        "#include \"compute/portable.clh\"\n"
        "kernel void f(global float* out, float a, float b, float c) { *out = a * b + c; }";
    const float a = 1.f + std::ldexp(1.f, -12);
    const float c = -(1.f + std::ldexp(1.f, -11));
    Buffer<float> out(device(), 1);
    compile_kernel(device(), source, "f").run({1}, out, a, a, c);
    EXPECT_EQ(out.read()[0], 0.f);
    EXPECT_EQ(std::fma(a, a, c), std::ldexp(1.f, -24));
}

/// The portable forms of compute/portable.clh give the same bits as those for this device.
TEST(Program, PortableFormsGiveTheSameBits) {
    const char* source = R"(
        #include "math/columns_sixteen.clh"
        kernel void f(global const uint* in, global uint* out) {
            const uint16 a = vload16(0, in), b = vload16(1, in), c = vload16(2, in), d = vload16(3, in);
            const Columns16 columns = transpose16(as_float16(a), as_float16(b), as_float16(c), as_float16(d));
            vstore16(as_uint16(columns.x), 0, out), vstore16(as_uint16(columns.y), 1, out);
            vstore16(as_uint16(columns.z), 2, out), vstore16(as_uint16(columns.w), 3, out);
            vstore16(as_uint16(pick4(as_float4(a.lo.lo), b & 3u)), 4, out);
            out[80] = movemask4(as_int4(a.lo.lo)), out[81] = movemask8(as_int8(b.hi)), out[82] = movemask16(as_int16(c));
            out[83] = lowest_bit(d.x | 0x10000u);
            uint listed[16];
            const uint count = append16(listed, d, 0xa53cu);
            out[84] = count;
            for (uint i = 0; i < count; ++i) out[85 + i] = listed[i];
        })";
    std::mt19937 random(5);
    std::vector<std::uint32_t> words(64);
    for (std::uint32_t& word : words) word = std::uint32_t(random()) & 0xbfffffffu;  // no NaN: its bits may change
    const Buffer<std::uint32_t> in(device(), words);
    std::vector<std::uint32_t> results[2];
    for (const bool portable : {false, true}) {
        const Buffer<std::uint32_t> out(device(), std::vector<std::uint32_t>(100));
        compile_kernel(device(), source, "f", {{"CLARAY_PORTABLE", portable ? "1" : "0"}}).run({1}, in, out);
        results[portable] = out.read();
    }
    EXPECT_EQ(results[0], results[1]);
    for (std::size_t i = 0; i < 64; ++i)  // columns of rows 0, 4, 8, 12; 1, 5, 9, 13; ...
        EXPECT_EQ(results[0][i], words[16 * (i % 4) + 4 * (i % 16 / 4) + i / 16]) << i;
}

/// What two buffers that changed places would be: another type, or the other's name. Nothing is enqueued.
TEST(Program, ArgumentsInEachOthersPlaceAreRefused) {
    if (device().info().platform != "Portable Computing Language") GTEST_SKIP() << "only PoCL is asked for parameters";
    const Buffer<std::uint32_t> length(device(), std::vector<std::uint32_t>{0});  // so that no item reads the others
    const Buffer<std::uint8_t> occluded(device(), 1);
    const Buffer<LightSample> light(device(), 1);
    const Buffer<float> radiance(device(), 3);
    Kernel add_light = load_kernel(device(), "render/add_light.cl", "add_light");
    add_light.run({1, 1}, length, 1u, occluded, light, radiance);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "is a buffer of float, but 'light' is a LightSample*", [&] {
        add_light.run({1, 1}, length, 1u, occluded, radiance, light);
    }));

    const Buffer<std::uint32_t> keys(device(), 1), counts(device(), 1u << 13);  // a run has as many buckets
    Kernel count_buckets = load_kernel(device(), "sort/bucket_sort.cl", "count_buckets", {{"KEY_BITS", "32"}});
    count_buckets.run({1, 1}, arg("keys", keys), 0u, 32u, 1u, arg("counts", counts));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "needs its name", [&] {
        count_buckets.run({1, 1}, keys, 0u, 32u, 1u, counts);
    }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "is called 'keys', not 'counts'", [&] {
        count_buckets.run({1, 1}, arg("counts", counts), 0u, 32u, 1u, arg("keys", keys));
    }));
}

TEST(Program, UnknownKernelsAreNamedWithThoseThatThereAre) {
    const char* source = "kernel void one(global uint* x) {} kernel void two(global uint* x) {}";
    for (const char* name : {"three", "on", ""})
        EXPECT_TRUE(throws_error(ErrorKind::usage, "'my.cl' has no kernel '" + std::string(name) + "'", [&] {
            static_cast<void>(compile_kernel(device(), source, name, {}, Math::strict, "my.cl"));
        }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "one, two",
                             [&] { static_cast<void>(compile_kernel(device(), source, "three")); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "its kernels are", [&] {
        static_cast<void>(load_kernel(device(), "sort/radix_sort.cl", "no_such_kernel"));
    }));
}

}  // namespace
}  // namespace claray::test
