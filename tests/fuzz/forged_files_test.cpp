// Forged checkpoints, images and scenes: each is read or refused by one line, and none takes more memory than it
// promises. `./dev forge N` tries N of each.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <string_view>

#include "host/base/process/process.hpp"
#include "tests/fuzz/forge_formats.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

bool run(const char* target, std::span<const std::uint8_t> file) {
    for (const FuzzTarget& each : fuzz_targets())
        if (std::strcmp(each.name, target) == 0) return each.run(file);
    if (std::strchr(target, '.') != nullptr) return read_scene(target, file);
    ADD_FAILURE() << "no target " << target;
    return false;
}

std::vector<FileBytes> corpus(const std::string& target, std::initializer_list<const char*> names) {
    std::vector<FileBytes> files;
    for (const char* name : names) {
        const std::string text = read_file(fs::path(CLARAY_SOURCE_DIR) / "tests/fuzz/corpus" / target / name);
        EXPECT_FALSE(text.empty()) << name;
        files.emplace_back(text.begin(), text.end());
    }
    return files;
}

/// Some are read, some are refused unless nothing is `refusable`, and memory grows by no more than `most_bytes`.
/// `make(number)` forges.
template <class Make>
void expect_sound(const char* target, std::uint32_t count, std::uint64_t most_bytes, const Make& make,
                  bool refusable = true) {
    std::uint32_t next = 0;
    const std::vector<FileBytes> first = {make(0)};
    const ForgedOutcome outcome = try_forged(
        first, forged_count(count), 0, [&](FileBytes& file) { file = make(next++); },
        [&](std::span<const std::uint8_t> file) { return run(target, file); });
    std::printf("%s: %u read, %u refused, memory grew by %.1f MB\n", target, outcome.read, outcome.refused,
                double(outcome.grown_bytes) * 1e-6);
    EXPECT_GT(outcome.read, 0u);
    if (refusable) {
        EXPECT_GT(outcome.refused, 0u);
    }
    EXPECT_LE(outcome.grown_bytes, most_bytes);
}

constexpr std::uint64_t little = 16u << 20;  // what reading a file of some kB may take besides

/// Bits of 48 x 48 pixels, or as many as the file has bytes for at the best compression there is.
TEST(ForgedImages, Png) { expect_sound("image", 400, little, forged_png); }

TEST(ForgedCheckpoints, WithTheirDigests) {
    const std::vector<FileBytes> good = corpus("checkpoint", {"adaptive", "finished", "to_an_error", "within_pass"});
    constexpr std::size_t header = 152;  // docs/formats.md
    expect_sound("checkpoint", 400, little, [&](std::uint32_t number) {
        FileBytes file = forged(good[number % good.size()], number, header);
        mend_digests(file, header);
        return file;
    });
}

TEST(ForgedScenes, Gltf) {
    const std::vector<FileBytes> good = corpus("gltf", {"all.glb", "all.gltf", "least.gltf", "sparse.gltf"});
    std::uint64_t zeros = 0;
    for (std::uint32_t number = 0; number < forged_count(300); ++number)
        zeros = std::max(zeros, promised_zeros(forged_gltf(good[number % good.size()], number)));
    expect_sound("gltf", 300, little + zeros * 3 / 2,
                 [&](std::uint32_t number) { return forged_gltf(good[number % good.size()], number); });
}

TEST(ForgedScenes, Obj) {
    const std::vector<FileBytes> good = corpus("obj", {"odd.obj", "plain.obj", "polygons.obj", "relative.obj"});
    expect_sound("obj", 300, little,
                 [&](std::uint32_t number) { return forged_text(good[number % good.size()], number); });
}

TEST(ForgedScenes, Ply) {
    const std::vector<FileBytes> text = corpus("ply", {"text.ply", "strips.ply"}),
                                 binary = corpus("ply", {"little.ply", "big.ply"});
    expect_sound("ply", 300, little, [&](std::uint32_t number) {
        return number % 2 != 0 ? forged_text(text[number / 2 % 2], number) : forged(binary[number / 2 % 2], number, 0);
    });
}

TEST(ForgedScenes, Pbrt) {
    const std::vector<FileBytes> good = corpus("pbrt", {"all.pbrt", "least.pbrt"});
    expect_sound("pbrt", 300, little,
                 [&](std::uint32_t number) { return forged_text(good[number % good.size()], number); });
}

TEST(ForgedScenes, Mitsuba) {
    const std::vector<FileBytes> good = corpus("mitsuba", {"all.xml", "old.xml"});
    expect_sound("mitsuba", 300, little,
                 [&](std::uint32_t number) { return forged_text(good[number % good.size()], number); });
}

TEST(ForgedScenes, Stl) {
    const std::vector<FileBytes> text = corpus("stl", {"text.stl"}), binary = corpus("stl", {"binary.stl"});
    expect_sound("stl", 300, little, [&](std::uint32_t number) {
        return number % 2 != 0 ? forged_text(text[0], number) : forged(binary[0], number, 0);
    });
}

/// What claray-import reads: it may crash, this process may not.
TEST(ForgedScenes, ByAssimp) {
    if (!fs::exists(fs::path(claray::this_program()).parent_path() / "claray-import"))
        GTEST_SKIP() << "claray was built without libassimp-dev";
    for (const char* name : {"two.dae", "square.fbx", "square.3ds", "square.off"}) {
        const std::string text = read_file(fs::path(CLARAY_SOURCE_DIR) / "tests/io/assimp/files" / name);
        const FileBytes good(text.begin(), text.end());
        const bool is_text = text.find('\0') == text.npos;
        expect_sound(name, 60, little, [&](std::uint32_t number) {
            return is_text && number % 2 != 0 ? forged_text(good, number) : forged(good, number, 0);
        });
    }
}

TEST(ForgedScenes, ThreeMf) {
    const std::vector<FileBytes> good = corpus("3mf", {"tetrahedra.3mf", "properties.3mf"});
    expect_sound("3mf", 300, little, [&](std::uint32_t number) { return forged(good[number % 2], number, 0); });
}

TEST(ForgedScenes, Pcd) {
    const std::vector<FileBytes> good = corpus("pcd", {"text.pcd", "binary.pcd", "compressed.pcd"});
    expect_sound("pcd", 300, little, [&](std::uint32_t number) {
        const FileBytes& file = good[number % 3];
        return number % 3 == 0 ? forged_text(file, number) : forged(file, number, 0);
    });
}

TEST(ForgedScenes, Mtl) {
    const std::vector<FileBytes> good = corpus("mtl", {"all.mtl", "plain.mtl", "spectral.mtl"});
    expect_sound(
        "mtl", 300, little, [&](std::uint32_t number) { return forged_text(good[number % good.size()], number); },
        false);  // statements that are none and images that are missing are warnings
}

}  // namespace
}  // namespace claray::test
