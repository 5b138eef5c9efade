// claray bake, probe and normal-map, and claray render with what they wrote.
#include <fstream>

#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

/// A square that shines, so that nobody has to warn of the dark.
std::string write_square(const TemporaryFolder& folder) {
    const std::string path = (folder / "square.obj").string();
    std::ofstream(folder / "square.mtl") << "newmtl lamp\nKd 0.5 0.5 0.5\nKe 1 1 1\n";
    std::ofstream(path)
        << "mtllib square.mtl\nusemtl lamp\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
           "f 1/1 2/2 3/3 4/4\n";
    return path;
}

TEST(BakeCommand, WritesWhatRenderShows) {
    const TemporaryFolder folder;
    const std::string scene = write_square(folder), map = (folder / "light.pfm").string();
    const ProcessResult baked = run_claray({"bake", scene, "-o", map, "--size", "8x8", "--spp", "4"});
    ASSERT_EQ(baked.exit_code, 0) << baked.errors;
    EXPECT_NE(baked.output.find("8x8 texels on coordinates 0"), std::string::npos) << baked.output;
    const ProcessResult rendered = run_claray({"render", scene, "-o", (folder / "image.pfm").string(), "--size", "8x8",
                                               "--spp", "1", "--light-map", "0=" + map, "--quiet"});
    EXPECT_EQ(rendered.exit_code, 0) << rendered.errors;
}

TEST(BakeCommand, BadInput) {
    const TemporaryFolder folder;
    const std::string scene = write_square(folder), map = (folder / "light.pfm").string();
    EXPECT_TRUE(failed_with(run_claray({"bake", scene, "-o", "light.png"}), 2, ".hdr or .pfm"));
    EXPECT_TRUE(failed_with(run_claray({"bake", scene, "-o", map, "--mesh", "3"}), 1, "there is no mesh 3"));
    EXPECT_TRUE(failed_with(run_claray({"bake", "cornell", "-o", map}), 1, "no texture coordinates"));
    EXPECT_TRUE(failed_with(run_claray({"render", scene, "-o", map, "--light-map", "floor"}), 2, "MESH=FILE"));
}

TEST(ProbeCommand, WritesSurroundings) {
    const TemporaryFolder folder;
    const std::string scene = write_square(folder), panorama = (folder / "light.hdr").string();
    const ProcessResult probed =
        run_claray({"probe", scene, "-o", panorama, "--from", "0,1,0", "--size", "8", "--spp", "4"});
    ASSERT_EQ(probed.exit_code, 0) << probed.errors;
    EXPECT_NE(probed.output.find("a panorama of 32x16 pixels"), std::string::npos) << probed.output;
    const ProcessResult faces =
        run_claray({"probe", scene, "-o", panorama, "--from", "0,1,0", "--size", "8", "--spp", "4", "--faces"});
    ASSERT_EQ(faces.exit_code, 0) << faces.errors;
    for (const std::string& environment : {panorama, (folder / "light").string()}) {
        const ProcessResult rendered = run_claray({"render", scene, "-o", (folder / "image.pfm").string(), "--size",
                                                   "8x8", "--spp", "1", "--environment", environment, "--quiet"});
        EXPECT_EQ(rendered.exit_code, 0) << rendered.errors;
    }
}

TEST(ProbeCommand, BadInput) {
    EXPECT_TRUE(failed_with(run_claray({"probe", "cornell", "-o", "light.txt", "--from", "0,1,0"}), 2, ".pfm, .exr"));
    EXPECT_TRUE(failed_with(run_claray({"probe", "cornell", "-o", "light.hdr"}), 2, "--from"));
    EXPECT_TRUE(failed_with(run_claray({"probe", "cornell", "-o", "light.hdr", "--from", "1,2"}), 2, "X,Y,Z"));
    EXPECT_TRUE(failed_with(run_claray({"probe", "nowhere.obj", "-o", "light.hdr", "--from", "0,1,0"}), 1, "nowhere"));
}

TEST(NormalMapCommand, WritesNormals) {
    const TemporaryFolder folder;
    const std::string heights = (folder / "heights.pfm").string(), normals = (folder / "normals.png").string();
    std::ofstream(heights, std::ios::binary) << "Pf\n2 1\n-1.0\n" << std::string(8, '\0');
    const ProcessResult made = run_claray({"normal-map", heights, "-o", normals, "--strength", "4"});
    ASSERT_EQ(made.exit_code, 0) << made.errors;
    EXPECT_NE(made.output.find("2x1 normals"), std::string::npos) << made.output;
    EXPECT_TRUE(failed_with(run_claray({"normal-map", heights, "-o", "normals.hdr"}), 2, "use the extension .png"));
    EXPECT_TRUE(failed_with(run_claray({"normal-map", "none.png", "-o", normals}), 1, "none.png"));
    EXPECT_TRUE(failed_with(run_claray({"normal-map", heights, "-o", normals, "--wrap", "twice"}), 2, "--wrap"));
}

}  // namespace
}  // namespace claray::test
