// Saving and loading: the loaded structure equals the saved one, and damaged files are refused.
#include <cmath>
#include <cstring>
#include <fstream>

#include "claray/query.hpp"
#include "tests/bvh/support.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t header_bytes = 168, digest_bytes = 16;  // docs/formats.md

class Save : public testing::Test {
protected:
    [[nodiscard]] fs::path path(const std::string& name = "tree.cbvh") const { return folder_ / name; }
    [[nodiscard]] fs::path file_of(const std::string& bytes) const {
        std::ofstream(path("changed"), std::ios::binary) << bytes;
        return path("changed");
    }
    [[nodiscard]] testing::AssertionResult refused(const std::string& bytes, const std::string& words) const {
        const fs::path file = file_of(bytes);
        const auto result = throws_error(ErrorKind::user, words, [&] { (void)Bvh::load(device(), file); });
        const std::string message = result.message();
        if (result && message.find("cannot load '" + file.string() + "': ") == std::string::npos)
            return testing::AssertionFailure() << "the file is not named: " << message;
        return result;
    }
    [[nodiscard]] std::string saved(const Bvh& bvh) const {
        bvh.save(path());
        return read_file(path());
    }
    [[nodiscard]] std::size_t file_count() const {
        return std::size_t(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
    }
    TemporaryFolder folder_;
};

bool same_bytes(const std::vector<Hit>& a, const std::vector<Hit>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Hit)) == 0;
}

void expect_same(const Bvh& a, const Bvh& b) {
    EXPECT_EQ(a.hash(), b.hash());
    EXPECT_EQ(a.triangle_count(), b.triangle_count());
    EXPECT_EQ(a.statistics().triangles, b.statistics().triangles);
    EXPECT_EQ(a.statistics().culled, b.statistics().culled);
    EXPECT_EQ(a.statistics().height, b.statistics().height);
    EXPECT_EQ(a.statistics().sah_cost, b.statistics().sah_cost);
    expect_valid(b);
    const std::vector<Ray> rays = random_rays(2000, 4.f, 1.f, 3);
    EXPECT_TRUE(same_bytes(closest_hit(a, rays), closest_hit(b, rays)));
    EXPECT_EQ(any_hit(a, rays), any_hit(b, rays));
}

TEST_F(Save, ComesBackAsItWas) {
    for (const Builder builder : {Builder::fast, Builder::balanced})
        for (const Layout from : {Layout::binary, Layout::wide})
            for (const Layout to : {Layout::binary, Layout::wide})
                for (const unsigned bits : {30u, 63u}) {
                    const Bvh bvh = build(soup(777, 0.2f, 5), bits, from, builder);
                    bvh.save(path());
                    const Bvh loaded = Bvh::load(device(), path(), to);
                    EXPECT_EQ(loaded.layout(), to);
                    // A wide tree, which forms leaves of its own, is built anew from a binary one whose leaves hold
                    // several.
                    const bool anew = from == Layout::binary && to == Layout::wide;
                    expect_same(anew ? build(soup(777, 0.2f, 5), bits, to, builder) : bvh, loaded);
                }
}

TEST_F(Save, NoneOneAndTwoTriangles) {
    for (const std::size_t count : {0, 1, 2, 3}) {
        const Bvh bvh = build(soup(count, 0.5f, 9), 63, Layout::automatic);
        bvh.save(path());
        expect_same(bvh, Bvh::load(device(), path()));
    }
}

TEST_F(Save, KeepsGeometriesMasksAndCulledTriangles) {
    std::vector<Mesh> meshes = {soup(100, 0.3f, 1), sphere(2, 0.5f), soup(50, 0.3f, 2)};
    meshes[1].mask = 2;
    meshes[2].positions[4].x = NAN;
    const Bvh bvh = Bvh::build(device(), meshes);
    bvh.save(path());
    const Bvh loaded = Bvh::load(device(), path());
    EXPECT_EQ(loaded.statistics().culled, 1u);
    expect_same(bvh, loaded);
    QueryOptions options;
    const std::vector<Ray> rays = random_rays(500, 4.f, 1.f, 3);
    options.ray_masks = Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>(rays.size(), 1u));
    const auto hits = closest_hit(loaded, rays, options);
    EXPECT_TRUE(same_bytes(closest_hit(bvh, rays, options), hits));
    for (const Hit& hit : hits) EXPECT_TRUE(hit.primitive == CLARAY_MISS || hit.geometry != 1) << "the mask hides it";
}

TEST_F(Save, LargerThanAChunk) {
    const Bvh bvh = build(soup(200'000, 0.01f, 5), 63, Layout::automatic);
    bvh.save(path());
    EXPECT_GT(fs::file_size(path()), (16u << 20));
    expect_same(bvh, Bvh::load(device(), path()));
}

TEST_F(Save, WhatWasLoadedCanBeRefittedAndRebuilt) {
    for (const Layout layout : {Layout::binary, Layout::wide}) {
        Bvh bvh = build(soup(500, 0.3f, 7), 63, layout);
        bvh.save(path());
        Bvh loaded = Bvh::load(device(), path(), layout);
        std::vector<float> moved = bvh.triangles().positions.read();
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += 0.3f * std::sin(float(i));
        for (Bvh* one : {&bvh, &loaded}) {
            Buffer<float> positions = one->triangles().positions;
            positions.write(moved);
            one->refit();
        }
        expect_same(bvh, loaded);
        bvh.rebuild();
        loaded.rebuild();
        expect_same(bvh, loaded);
    }
}

TEST_F(Save, ReplacesTheFileAtOnceOrNotAtAll) {
    const Bvh bvh = build(soup(100, 0.3f, 7));
    bvh.save(path());
    const std::string before = read_file(path());
    build(soup(200, 0.3f, 7)).save(path());
    EXPECT_NE(read_file(path()), before);
    EXPECT_EQ(file_count(), 1u) << "no temporary file stays";
    EXPECT_TRUE(throws_error(ErrorKind::user, "no/such", [&] { bvh.save(folder_ / "no/such/tree.cbvh"); }));
    EXPECT_TRUE(throws_error(ErrorKind::user, "/dev/full", [&] { bvh.save("/dev/full"); })) << "a full disk";
}

TEST_F(Save, MissingFilesAndStrangersAreRefused) {
    EXPECT_TRUE(throws_error(ErrorKind::user, "none.cbvh': No such file or directory; check the path",
                             [&] { (void)Bvh::load(device(), path("none.cbvh")); }));
    EXPECT_TRUE(throws_error(ErrorKind::user, "it is a folder", [&] { (void)Bvh::load(device(), folder_.path()); }));
    EXPECT_TRUE(refused("", "it is not a saved structure"));
    EXPECT_TRUE(refused("v 0 0 0\n", "it is not a saved structure"));
    EXPECT_TRUE(refused(std::string(100'000, 'x'), "it is not a saved structure"));
}

TEST_F(Save, EveryFlippedBitOfTheHeaderIsRefused) {
    const std::string good = saved(build(soup(20, 0.3f, 7)));
    for (std::size_t at = 0; at < header_bytes; ++at)
        for (int bit = 0; bit < 8; ++bit) {
            std::string bad = good;
            bad[at] = char(bad[at] ^ (1 << bit));
            ASSERT_TRUE(refused(bad, "; ")) << at << "." << bit;
        }
}

TEST_F(Save, FlippedBitsAnywhereAreRefused) {
    const std::string good = saved(build(soup(200, 0.3f, 7)));
    Random random(5);
    for (int i = 0; i < 150; ++i) {
        std::string bad = good;
        const std::size_t at = header_bytes + random.below(std::uint32_t(good.size() - header_bytes));
        bad[at] = char(bad[at] ^ (1 << random.below(8)));
        ASSERT_TRUE(refused(bad, "the file is damaged: its checksum is wrong; build the structure again")) << at;
    }
    for (std::size_t at = good.size() - digest_bytes; at < good.size(); ++at) {
        std::string bad = good;
        bad[at] = char(~bad[at]);
        ASSERT_TRUE(refused(bad, "its checksum is wrong"));
    }
}

TEST_F(Save, TruncatedAndLongerFilesAreRefused) {
    const std::string good = saved(build(soup(60, 0.3f, 7)));
    for (std::size_t bytes = 1; bytes < good.size(); bytes += bytes < header_bytes + 20 ? 1 : 97)
        ASSERT_TRUE(refused(good.substr(0, bytes), "the file is damaged: it ")) << bytes;
    EXPECT_TRUE(refused(good.substr(0, good.size() - 1), "bytes instead of"));
    EXPECT_TRUE(refused(good + "x", "bytes instead of"));
}

TEST_F(Save, OtherVersionsAndByteOrdersAreNamed) {
    const std::string good = saved(build(soup(20, 0.3f, 7)));
    const auto with_word = [&](std::size_t at, std::uint32_t word) {
        std::string bytes = good;
        std::memcpy(bytes.data() + at, &word, 4);
        return bytes;
    };
    EXPECT_TRUE(refused(with_word(8, 3), "it has format 3, but this claray reads format 2; use a newer claray"));
    EXPECT_TRUE(refused(with_word(8, 1), "it has format 1, but this claray reads format 2; build the structure again"));
    EXPECT_TRUE(refused(with_word(12, 0x04030201), "a different byte order"));
}

}  // namespace
}  // namespace claray::test
