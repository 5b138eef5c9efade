// Memory: a build's need is known before it allocates, and it is refused before any work if memory is too small.
#include "host/compute/memory.hpp"

#include "claray/query.hpp"
#include "host/bvh/require_memory.hpp"
#include "host/compute/device_state.hpp"
#include "tests/bvh/support.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

/// The parameter is the tuning value SIDE_BY_SIDE: with 1 stages are constructed twice, the first time to learn which
/// kernels they load.
class Memory : public testing::TestWithParam<unsigned> {
protected:
    void SetUp() override { device_.set_tuning("compute/programs", "SIDE_BY_SIDE", GetParam()); }
    /// Gives the device this much memory beyond that in use.
    void leave(std::uint64_t bytes) { state_of(device_).info.memory = bytes_in_use(device_) + bytes; }
    [[nodiscard]] std::uint64_t needed(const Bvh::Config& config) const {
        return Bvh::memory_needed(device_, mesh_.positions.size(), mesh_.triangles.size(), config).bytes;
    }
    [[nodiscard]] Bvh build(const Bvh::Config& config) const {
        return Bvh::build(device_, std::span(&mesh_, 1), config);
    }
    Mesh mesh_ = soup(3000, 0.1f, 4);
    Device device_ = Device::open(std::to_string(device().info().index));  // with its own memory size
};

std::vector<Bvh::Config> all_configs() {
    std::vector<Bvh::Config> configs;
    for (const Builder builder : {Builder::fast, Builder::balanced, Builder::binned, Builder::high})
        for (const Layout layout : {Layout::binary, Layout::wide})
            for (const unsigned bits : {30u, 63u})
                configs.push_back({.builder = builder, .morton_bits = bits, .layout = layout});
    return configs;
}

TEST_P(Memory, NeededIsWhatIsTaken) {
    for (const Bvh::Config& config : all_configs()) {
        const std::uint64_t before = bytes_in_use(device_);
        {
            const Bvh bvh = build(config);
            EXPECT_EQ(bytes_in_use(device_) - before, needed(config));
        }
        EXPECT_EQ(bytes_in_use(device_), before) << "all is given back";
    }
}

TEST_P(Memory, ExactlyEnoughIsEnough) {
    for (const Bvh::Config& config : all_configs()) {
        leave(needed(config));
        EXPECT_NO_THROW((void)build(config));
    }
}

TEST_P(Memory, TooLittleIsRefusedBeforeAnyWork) {
    for (const Bvh::Config& config : all_configs()) {
        leave(needed(config) - 1);
        const std::uint64_t before = bytes_in_use(device_);
        device_.finish();
        device_.profiler().reset();
        EXPECT_TRUE(throws_error(ErrorKind::device,
                                 "out of device memory: a tree of 3000 triangles needs " + size_text(needed(config)) +
                                     " on " + device_.info().name + ", which has " +
                                     size_text(bytes_available(device_)) + " of its " +
                                     size_text(device_.info().memory),
                                 [&] { (void)build(config); }));
        EXPECT_TRUE(device_.profiler().summary().empty()) << "nothing was uploaded or run";
        EXPECT_EQ(bytes_in_use(device_), before);
    }
}

TEST_P(Memory, TheRemedyHelps) {
    const Bvh::Config least = {.builder = Builder::fast, .morton_bits = 30, .layout = Layout::binary};
    const Bvh::Config most = {.builder = Builder::balanced, .morton_bits = 63, .layout = Layout::wide};
    const auto chooses = [&](const std::string& words, const Bvh::Config& smaller, const Bvh::Config& config) {
        leave(needed(smaller));
        EXPECT_TRUE(throws_error(ErrorKind::device,
                                 "; choose " + words + ", with which it needs " + size_text(needed(smaller)) + ", or",
                                 [&] { (void)build(config); }));
        EXPECT_NO_THROW((void)build(smaller));
    };
    Bvh::Config high = most, smaller = most;
    high.builder = Builder::high;
    chooses("the builder balanced", smaller, high);
    smaller.builder = Builder::fast;
    chooses("the builder fast", smaller, high);
    chooses("the builder fast", smaller, most);
    smaller.layout = Layout::binary;
    chooses("the builder fast and the binary layout", smaller, high);
    chooses("the builder fast, the binary layout and codes of 30 bits", least, most);
    leave(needed(least));
    EXPECT_NO_THROW((void)build(least));
    leave(needed(least) - 1);
    EXPECT_TRUE(throws_error(ErrorKind::device, "; use fewer triangles", [&] { (void)build(most); }));
    EXPECT_TRUE(throws_error(ErrorKind::device, "; use fewer triangles", [&] { (void)build(least); }));
}

TEST_P(Memory, SeveralMeshesAndMasksAreCounted) {
    std::vector<Mesh> meshes = {mesh_, soup(500, 0.1f, 5)};
    meshes[1].mask = 2;
    for (const Bvh::Config& config : all_configs()) {
        const std::uint64_t before = bytes_in_use(device_);
        const Bvh bvh = Bvh::build(device_, meshes, config);
        EXPECT_EQ(bytes_in_use(device_) - before, memory_needed(device_, counts_of(meshes), config).bytes);
        EXPECT_EQ(memory_needed(device_, counts_of(bvh.triangles()), config).bytes,
                  memory_needed(device_, counts_of(meshes), config).bytes);
    }
}

TEST_P(Memory, ADriverThatRefusesIsHeardBeforeUploads) {
    const Bvh::Config config = {.builder = Builder::high, .layout = Layout::binary};
    unsigned nth = 1;
    for (bool done = false; !done; ++nth) {
        device_.finish();
        device_.profiler().reset();
        fail_allocation(device_, nth);
        try {
            (void)build(config);
            done = true;
        } catch (const Error& error) {
            const std::string text = error.what();
            EXPECT_NE(text.find("a tree of 3000 triangles needs " + size_text(needed(config))), std::string::npos)
                << text;
            EXPECT_NE(text.find("refuses some of it; choose the builder "), std::string::npos) << text;
            EXPECT_TRUE(device_.profiler().summary().empty()) << "allocation " << nth << ": after an upload";
        }
    }
    fail_allocation(device_, 0);
    EXPECT_GT(nth, 20u);
}

TEST_P(Memory, AHostWithoutMemoryIsTold) {
    (void)build({});
    fail_command_with(device_, 3, CL_OUT_OF_HOST_MEMORY);
    EXPECT_TRUE(throws_error(ErrorKind::device, "has no memory left for the kernel ", [&] { (void)build({}); }));
    fail_command_with(device_, 1, CL_OUT_OF_HOST_MEMORY);
    EXPECT_TRUE(throws_error(ErrorKind::device, "close other programs that use its memory", [&] { (void)build({}); }));
    fail_command(device_, 0);
}

TEST_P(Memory, TheMostIsRemembered) {
    const std::uint64_t before = bytes_in_use(device_), most = most_bytes_in_use(device_);
    {
        const Buffer<char> large(device_, most - before + 1000), small(device_, 10);
        EXPECT_EQ(most_bytes_in_use(device_), most + 1010);
    }
    EXPECT_EQ(bytes_in_use(device_), before);
    EXPECT_EQ(most_bytes_in_use(device_), most + 1010);
}

TEST_P(Memory, TrianglesOnTheDeviceAreNotCountedTwice) {
    const Bvh::Config config = {.layout = Layout::binary};
    const Bvh first = build(config);
    const TriangleBuffers triangles = first.triangles();
    const std::uint64_t more = needed(config) - triangles.positions.bytes() - triangles.indices.bytes();
    leave(more);
    EXPECT_NO_THROW((void)Bvh::build(device_, triangles, config));
    leave(more - 1);
    EXPECT_TRUE(throws_error(ErrorKind::device, "needs " + size_text(more),
                             [&] { (void)Bvh::build(device_, triangles, config); }));
}

TEST_P(Memory, LoadingIsRefusedToo) {
    const TemporaryFolder folder;
    const Bvh::Config config = {.layout = Layout::binary};
    build(config).save(folder / "tree.cbvh");
    leave(needed(config) - 1);
    EXPECT_TRUE(throws_error(ErrorKind::device, "a tree of 3000 triangles needs",
                             [&] { (void)Bvh::load(device_, folder / "tree.cbvh", Layout::binary); }));
    leave(needed(config));
    EXPECT_EQ(Bvh::load(device_, folder / "tree.cbvh", Layout::binary).triangle_count(), 3000u);
}

TEST_P(Memory, LargestBufferIsForTheDriverToDecide) {
    // A device that reports less memory per buffer than it allocates: the larger size is used.
    state_of(device_).info.max_allocation = 1000;
    EXPECT_TRUE(gives_buffer(device_, 100'000));
    EXPECT_NO_THROW((void)build({}));
    // What it does not give is refused before any work, though there is memory in all.
    state_of(device_).info = device().info();
    state_of(device_).info.memory = std::uint64_t(1) << 62;
    state_of(device_).info.type = DeviceType::gpu;  // the memory of the host is not asked for
    TriangleBuffers triangles;
    {
        const MemoryPlan plan(device_);
        triangles.positions = Buffer<float>(device_, 300);
        triangles.indices = Buffer<std::uint32_t>(device_, 3 * (device_.info().max_allocation / sizeof(BvhNode) + 1));
    }
    if (triangles.indices.size() / 3 >= (1u << 29) - 2 || gives_buffer(device_, device_.info().max_allocation + 64))
        GTEST_SKIP() << "no such buffer on this device";
    EXPECT_TRUE(throws_error(ErrorKind::device, " triangles needs a buffer of ",
                             [&] { (void)Bvh::build(device_, triangles); }));
    EXPECT_TRUE(throws_error(ErrorKind::device,
                             "allocates at most " + size_text(device_.info().max_allocation) + " per buffer",
                             [&] { (void)Bvh::build(device_, triangles); }));
}

TEST_P(Memory, BuffersAreCountedWhileTheyLive) {
    const std::uint64_t before = bytes_in_use(device_);
    {
        const Buffer<float> buffer(device_, 1000);
        EXPECT_EQ(bytes_in_use(device_) - before, 4000u);
        const Buffer<float> same = buffer;
        EXPECT_EQ(bytes_in_use(device_) - before, 4000u);
        Buffer<char> grows;
        grows.reserve(device_, 10);
        grows.reserve(device_, 20);
        EXPECT_EQ(bytes_in_use(device_) - before, 4020u);
        leave(99);
        EXPECT_TRUE(throws_error(ErrorKind::device, "out of device memory: a buffer of 0.0 MB does not fit on",
                                 [&] { (void)Buffer<char>(device_, 100); }));
    }
    EXPECT_EQ(bytes_in_use(device_), before);
}

TEST_P(Memory, PlansMakeNothing) {
    const std::uint64_t before = bytes_in_use(device_);
    {
        const MemoryPlan plan(device_);
        const Buffer<double> buffer(device_, std::size_t(1) << 50);
        EXPECT_FALSE(buffer.allocated());
        const Buffer<char> none(device_, 0);
        EXPECT_EQ(plan.bytes(), (std::uint64_t(1) << 53) + 1);
        EXPECT_EQ(plan.largest(), std::uint64_t(1) << 53);
        EXPECT_TRUE(throws_error(ErrorKind::usage, "within another", [&] { const MemoryPlan inner(device_); }));
    }
    EXPECT_EQ(bytes_in_use(device_), before);
    EXPECT_TRUE(Buffer<char>(device_, 1).allocated());
}

INSTANTIATE_TEST_SUITE_P(SideBySide, Memory, testing::Values(0u, 1u));

}  // namespace
}  // namespace claray::test
