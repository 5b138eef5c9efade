// claray render --light, --sky, --environment.
#include <cmath>
#include <fstream>
#include <numbers>

#include "tests/cli/claray.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

/// A grey floor seen from above, 1 mm of it.
class LightOptions : public InFolder {
protected:
    void SetUp() override {
        std::ofstream(folder_.path() / "floor.mtl") << "newmtl grey\nKd 0.5 0.5 0.5\n";
        std::ofstream(folder_.path() / "floor.obj")
            << "mtllib floor.mtl\nusemtl grey\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nv -9 0 -9\nf 1 2 3 4\n";
    }
    [[nodiscard]] ProcessResult render(const std::vector<std::string>& more) const {
        return run_claray(
            with({"render", path("floor.obj"), "-o", path("image.pfm"), "--size", "8x8", "--spp", "64", "--max-depth",
                  "1", "--camera", "0,1,0", "--look-at", "0,0,0", "--up", "0,0,-1", "--fov", "0.05", "--quiet"},
                 more));
    }
    /// Mean of the image's colours times pi over the albedo: irradiance.
    [[nodiscard]] double irradiance(const std::vector<std::string>& more) const {
        const ProcessResult result = render(more);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        double sum = 0;
        for (const float value : read_pfm(path("image.pfm"), 3)) sum += double(value) / (3 * 8 * 8);
        const std::string black = "claray: warning: the image is black";
        EXPECT_EQ(result.errors.substr(0, black.size()), sum == 0 ? black : "");
        return sum * pi / 0.5;
    }
};

TEST_F(LightOptions, EveryKindOfLight) {
    EXPECT_NEAR(irradiance({"--light", "point,position=0,2,0,intensity=8"}), 2, 1e-3);
    EXPECT_NEAR(irradiance({"--light", "directional,direction=3,-4,0,intensity=5"}), 4, 1e-3);
    const std::string spot = "spot,position=0,2,0,direction=1,-1,0,intensity=8,inner=20,outer=";
    EXPECT_EQ(irradiance({"--light", spot + "44"}), 0);
    const double degree = pi / 180, at = std::cos(45 * degree), outer = std::cos(60 * degree);
    const double inside = (at - outer) / (std::cos(20 * degree) - outer);
    EXPECT_NEAR(irradiance({"--light", spot + "60"}), 2 * inside * inside, 2e-3);
    EXPECT_NEAR(irradiance({"--light", "point,position=0,2,0,intensity=8,attenuation=1,2,0"}), 8.0 / 5, 1e-3);
    EXPECT_NEAR(irradiance({"--light", "point,position=0,2,0,intensity=8,range=4"}), 2 * (1 - 1.0 / 16), 1e-3);
    EXPECT_NEAR(irradiance({"--light", "point,position=0,2,0,intensity=8", "--light",
                            "directional,direction=0,-1,0,intensity=1,2,3"}),
                4, 4e-3);
}

TEST_F(LightOptions, SkyAndEnvironment) {
    EXPECT_NEAR(irradiance({"--sky", "0.5"}), 0.5 * pi, 1e-3);
    // 1 at the horizon, 2 at the zenith, linear in the cosine: its mean by the cosine is 1 + 2 / 3.
    EXPECT_NEAR(irradiance({"--sky", "1,1,1,2,2,2"}), pi * 5 / 3, 0.01);
    std::ofstream file(path("sky.hdr"), std::ios::binary);
    file << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
    for (int i = 0; i < 8; ++i) file << std::string("\x80\x80\x80\x81", 4);  // 1: half of 2^1
    file.close();
    EXPECT_NEAR(irradiance({"--environment", path("sky.hdr"), "--environment-strength", "3"}), 3 * pi, 0.03);
}

TEST_F(LightOptions, WithoutAnyTheStudioIsTold) {
    EXPECT_NE(render({}).errors.find("added a neutral studio as light"), std::string::npos);
}

TEST_F(LightOptions, BadOnesAreRefused) {
    EXPECT_TRUE(failed_with(render({"--light", "laser"}), 2, "unknown kind 'laser'"));
    EXPECT_TRUE(failed_with(render({"--light", "point,positon=0,0,0"}), 2, "unknown value 'positon'"));
    EXPECT_TRUE(failed_with(render({"--light", "point,position=0,0"}), 2, "position has 2 numbers"));
    EXPECT_TRUE(failed_with(render({"--light", "point,intensity=nan"}), 2, "is not a number"));
    EXPECT_TRUE(failed_with(render({"--sky", "-1"}), 2, "is not a radiance"));
    EXPECT_TRUE(failed_with(render({"--environment-strength", "2"}), 2, "change an environment"));
    EXPECT_TRUE(failed_with(render({"--environment", path("none.hdr")}), 1, "none.hdr"));
}

}  // namespace
}  // namespace claray::test
