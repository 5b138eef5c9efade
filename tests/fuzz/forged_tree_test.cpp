// Saved trees that were forged: refused, or used in every way without harm.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <fstream>

#include "claray/query.hpp"
#include "tests/fuzz/forge.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

class ForgedTrees : public testing::TestWithParam<Layout> {
protected:
    [[nodiscard]] FileBytes saved(const std::vector<Mesh>& meshes, const Bvh::Config& config) const {
        Bvh::build(device(), meshes, config).save(folder_ / "good.cbvh");
        const std::string text = read_file(folder_ / "good.cbvh");
        return {text.begin(), text.end()};
    }
    /// Trees of all builders; with geometries and masks, triangles that are left out, leaves of several triangles, and
    /// of next to nothing.
    [[nodiscard]] std::vector<FileBytes> good() const {
        std::vector<Mesh> meshes = {soup(40, 0.3f, 1), sphere(1, 0.5f), soup(20, 0.3f, 2)};
        meshes[1].mask = 2;
        meshes[2].positions[4].x = NAN;
        const Layout layout = GetParam();
        return {saved(meshes, {.layout = layout}),
                saved({soup(50, 0.4f, 3)}, {.builder = Builder::balanced, .layout = layout}),
                saved({sphere(2, 0.5f)}, {.builder = Builder::high, .layout = layout}),
                saved({soup(70, 0.2f, 4)}, {.layout = layout, .max_leaf_triangles = 1}),
                saved({soup(2, 0.5f, 5)}, {.layout = layout}),
                saved({soup(1, 0.5f, 6)}, {.layout = layout})};
    }
    [[nodiscard]] fs::path written(std::span<const std::uint8_t> file) const {
        const fs::path path = folder_ / "forged.cbvh";  // stays where a crash ends the test
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(file.data()), std::streamsize(file.size()));
        return path;
    }
    /// Whatever can be done with a structure.
    static void use(Bvh& bvh) {
        static const std::vector<Ray> rays = random_rays(64, 4.f, 1.f, 3);
        const auto trace = [&] {
            for (const Hit& hit : closest_hit(bvh, rays))
                ASSERT_TRUE(hit.primitive == CLARAY_MISS || hit.primitive < bvh.triangle_count());
            (void)any_hit(bvh, rays);
        };
        trace();
        (void)bvh.hash(), (void)bvh.statistics();
        bvh.refit();
        trace();
        bvh.rebuild();
        trace();
    }
    [[nodiscard]] bool is_read(std::span<const std::uint8_t> file) const {
        const fs::path path = written(file);
        try {
            Bvh bvh = Bvh::load(device(), path, GetParam());
            use(bvh);
            return true;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::user) << error.what();
            EXPECT_NE(std::string(error.what()).find("cannot load '" + path.string()), std::string::npos)
                << error.what();
            return false;
        }
    }
    TemporaryFolder folder_;
};

TEST_P(ForgedTrees, AreRefusedOrHarmless) {
    const auto begin = std::chrono::steady_clock::now();
    const ForgedOutcome outcome = try_forged(good(), forged_count(200), tree_header, mend_tree,
                                             [&](std::span<const std::uint8_t> file) { return is_read(file); });
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::printf("%u read, %u refused, memory grew by %.1f MB, in %.1f s\n", outcome.read, outcome.refused,
                double(outcome.grown_bytes) * 1e-6, seconds);
    EXPECT_GT(outcome.read, 0u) << "what changes a coordinate alone is read";
    EXPECT_GT(outcome.refused, outcome.read);
    EXPECT_LT(outcome.grown_bytes, 32u << 20) << "for files of 20 kB";
}

/// Words of a saved tree, by docs/formats.md; a node's children, parent and height begin at its word 12.
class Words {
public:
    explicit Words(FileBytes file) : file_(std::move(file)) {}
    std::uint32_t& at(std::size_t byte) { return *reinterpret_cast<std::uint32_t*>(&file_[byte]); }
    std::uint32_t& header(std::size_t word) { return at(88 + 4 * word); }
    std::uint32_t& node(std::size_t node, std::size_t word) { return at(tree_header + 64 * node + 4 * word); }
    std::uint32_t& leaf(std::size_t leaf, std::size_t word) {
        return at(tree_header + 64 * std::size_t(at(40)) + 48 * leaf + 4 * word);
    }
    std::uint32_t& index(std::size_t i) {
        return at(tree_header + 64 * std::size_t(at(40)) + 48 * std::size_t(at(48)) + 4 * std::size_t(at(56)) + 4 * i);
    }
    [[nodiscard]] FileBytes mended() const {
        FileBytes file = file_;
        mend_tree(file);
        return file;
    }

private:
    FileBytes file_;
};

TEST_P(ForgedTrees, EveryKindOfFaultIsNamed) {
    constexpr std::size_t child = 12, parent = 14, height_count = 15, root = 6, valid = 7, culled = 8, height = 9,
                          inner = 13;
    std::vector<Mesh> meshes = {soup(20, 0.3f, 1), soup(20, 0.3f, 2)};
    meshes[1].mask = 2;
    const FileBytes good = saved(meshes, {.layout = GetParam(), .max_leaf_triangles = 1});
    std::uint32_t node = 0;  // a node whose first child is a node, too
    while (Words(good).node(node, child) & CLARAY_LEAF) ++node;
    const std::uint32_t below = Words(good).node(node, child), top = Words(good).header(root);
    const auto expect = [&](const char* words, const auto& change) {
        Words file(good);
        change(file);
        const fs::path path = written(file.mended());
        EXPECT_TRUE(throws_error(ErrorKind::user, words, [&] { (void)Bvh::load(device(), path, GetParam()); }));
    };
    EXPECT_TRUE(is_read(Words(good).mended()));
    expect("missing node 40;", [&](Words& f) { f.node(node, child) = 40; });
    expect("wrong parent of node", [&](Words& f) { f.node(node, child) = top; });
    expect("wrong parent of node", [&](Words& f) { f.node(below, parent) = below; });
    expect("invalid leaf 2147483688;", [&](Words& f) { f.node(node, child) = CLARAY_LEAF | 40; });
    expect("invalid leaf", [&](Words& f) { f.node(node, child) = CLARAY_LEAF | 1u << CLARAY_LEAF_COUNT_SHIFT; });
    expect("several leaves contain triangle", [&](Words& f) { f.node(node, child) = CLARAY_LEAF; });
    expect("wrong height or count in node", [&](Words& f) { f.node(node, height_count) += 1; });
    expect("wrong height or count in node", [&](Words& f) { f.node(node, height_count) += 1 << 24; });
    expect("its tree is higher than 96 levels", [&](Words& f) { f.header(height) = 97; });
    expect("its height is wrong", [&](Words& f) { f.header(height) += 1; });
    expect("missing parent of node", [&](Words& f) { f.header(root) = below; });
    expect("its root is missing", [&](Words& f) { f.header(root) = CLARAY_NO_CHILD; });
    expect("its root is missing", [&](Words& f) { f.header(root) = 1000; });
    expect("its header counts more nodes", [&](Words& f) { f.header(inner) = 1u << 30; });
    expect("differ in the number of triangles", [&](Words& f) { f.header(valid) -= 1; });
    expect("differ in the number of triangles", [&](Words& f) { f.header(culled) = 1; });
    expect("it has no bounds", [&](Words& f) { f.header(0) = 0x7fc00000u; });
    expect("missing triangle 40;", [&](Words& f) { f.leaf(3, 3) = 40; });
    expect("wrong geometry or mask in leaf 3;", [&](Words& f) { f.leaf(3, 7) ^= 1; });
    expect("wrong geometry or mask in leaf 3;", [&](Words& f) { f.leaf(3, 11) ^= 1; });
    expect("missing vertex 120;", [&](Words& f) { f.index(7) = 120; });
    expect("missing mask of geometry 9;", [&](Words& f) { f.index(120) = 9; });
    expect("the sizes of its arrays do not match each other",
           [&](Words& f) { --f.at(72), ++f.at(80); });  // a geometry is a mask
}

INSTANTIATE_TEST_SUITE_P(Layouts, ForgedTrees, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::wide ? "Wide" : "Binary"; });

}  // namespace
}  // namespace claray::test
