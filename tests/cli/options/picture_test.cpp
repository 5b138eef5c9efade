// claray render: parts of images, alpha, roles of materials, lenses, exposure and turntables.
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "claray/io.hpp"
#include "host/base/file.hpp"
#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

class PictureOptions : public InFolder {
protected:
    [[nodiscard]] ProcessResult render(const std::string& scene, const std::string& output,
                                       const std::vector<std::string>& more = {}) const {
        return run_claray(with({"render", scene, "-o", path(output), "--size", "48x32", "--spp", "4"}, more));
    }
    /// The image; it has this size and these channels.
    [[nodiscard]] Texture rendered(const std::string& scene, const std::string& output,
                                   const std::vector<std::string>& more, unsigned width = 48, unsigned height = 32,
                                   unsigned channels = 4) const {
        const ProcessResult result = render(scene, output, more);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        Texture image = load_image(path(output));
        EXPECT_EQ(image.width, width);
        EXPECT_EQ(image.height, height);
        EXPECT_EQ(image.channels, channels);
        return image;
    }
};

TEST_F(PictureOptions, RegionIsAPartOfTheImage) {
    ASSERT_EQ(render("cornell", "whole.pfm").exit_code, 0);
    ASSERT_EQ(render("cornell", "part.pfm", {"--region", "10,20,7,5", "--aov", "depth"}).exit_code, 0);
    ASSERT_EQ(render("cornell", "frame.pfm", {"--region", "10,20,7,5", "--full-frame"}).exit_code, 0);
    const std::vector<float> whole = read_pfm(path("whole.pfm"), 3), part = read_pfm(path("part.pfm"), 3),
                             frame = read_pfm(path("frame.pfm"), 3);
    ASSERT_EQ(part.size(), 3u * 7 * 5);
    ASSERT_EQ(frame.size(), whole.size());
    EXPECT_EQ(read_pfm(path("part.depth.pfm"), 1).size(), 7u * 5);
    for (unsigned i = 0; i < 48 * 32; ++i)  // rows from below
        for (unsigned k = 0; k < 3; ++k) {
            const unsigned x = i % 48, y = 31 - i / 48;
            const bool inside = x >= 10 && x < 17 && y >= 20 && y < 25;
            EXPECT_EQ(frame[3 * i + k], inside ? whole[3 * i + k] : 0.f);
            if (!inside) continue;
            EXPECT_EQ(part[3 * ((24 - y) * 7 + x - 10) + k], whole[3 * i + k]);
        }
    EXPECT_TRUE(failed_with(render("cornell", "a.png", {"--region", "10,20,7"}), 2, "--region"));
    EXPECT_TRUE(failed_with(render("cornell", "a.png", {"--region", "40,0,9,1"}), 2, "is not within the image"));
    EXPECT_TRUE(failed_with(render("cornell", "a.png", {"--region", "0,0,9,1", "--denoise"}), 2, "--denoise"));
    EXPECT_TRUE(failed_with(render("cornell", "a.png", {"--full-frame"}), 2, "--region"));
}

/// A pbrt file's picture has its size, its crop and its exposure, unless options tell others.
TEST_F(PictureOptions, FilmOfAFile) {
    const std::string scene = path("film.pbrt");
    std::ofstream(scene) << "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 30 "
                            "\"float cropwindow\" [0.25 0.5 0.2 0.7] \"float iso\" 50\n"
                            "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\nTranslate 0 0 3\n"
                            "Shape \"sphere\"\n";
    const auto picture = [&](const std::vector<std::string>& options) {
        const ProcessResult result =
            run_claray(with({"render", scene, "-o", path("a.png"), "--spp", "4", "--tone-map", "none"}, options));
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        Texture image = load_image(path("a.png"));
        return std::pair(glm::uvec2(image.width, image.height), int(image.bytes.at(0)));
    };
    const int half = 188, full = 255;  // of the sky of radiance 1: sRGB of 0.5
    EXPECT_EQ(picture({}), std::pair(glm::uvec2(10, 15), half));
    EXPECT_EQ(picture({"--exposure", "0"}), std::pair(glm::uvec2(10, 15), full));
    EXPECT_EQ(picture({"--region", "0,0,2,3"}), std::pair(glm::uvec2(2, 3), half));
    EXPECT_EQ(picture({"--size", "16x8"}), std::pair(glm::uvec2(16, 8), half));
    EXPECT_EQ(picture({"--denoise=claray"}), std::pair(glm::uvec2(40, 30), half));
    std::ofstream(scene) << "Film \"rgb\" \"integer xresolution\" 20000\nWorldBegin\nShape \"sphere\"\n";
    const ProcessResult large = run_claray({"render", scene, "-o", path("a.png")});
    EXPECT_TRUE(failed_with(large, 2, "20000x720"));
}

TEST_F(PictureOptions, AlphaIsStraightInAPngAndPremultipliedInAnExr) {
    const std::vector<std::string> options = {"--alpha", "--sky",      "0.4,0.4,0.4", "--exposure",
                                              "0",       "--tone-map", "none"};
    const Texture png = rendered("ball:500", "a.png", options);
    const Texture multiplied =
        rendered("ball:500", "b.png", with({"--alpha=premultiplied"}, {options.begin() + 1, options.end()}));
    unsigned full = 0, none = 0, part = 0;
    for (unsigned i = 0; i < 48 * 32; ++i) {
        const std::uint8_t alpha = png.bytes[4 * i + 3];
        full += alpha == 255, none += alpha == 0, part += alpha != 0 && alpha != 255;
        EXPECT_EQ(multiplied.bytes[4 * i + 3], alpha);
        for (unsigned k = 0; k < 3; ++k)
            EXPECT_NEAR(multiplied.bytes[4 * i + k], png.bytes[4 * i + k] * alpha / 255., 1);
    }
    EXPECT_GT(full, 100u);
    EXPECT_GT(none, 100u);
    EXPECT_GT(part, 10u);
    if (render("cornell", "x.exr").exit_code != 0) return;  // built without OpenEXR
    const Texture exr = rendered("ball:500", "a.exr", options),
                  straight =
                      rendered("ball:500", "b.exr", with({"--alpha=straight"}, {options.begin() + 1, options.end()}));
    for (unsigned i = 0; i < 48 * 32; ++i)
        for (unsigned k = 0; k < 3; ++k)
            EXPECT_NEAR(exr.floats[4 * i + k], straight.floats[4 * i + k] * exr.floats[4 * i + 3], 1e-5);
    EXPECT_TRUE(failed_with(render("cornell", "a.hdr", {"--alpha"}), 2, "no place for an alpha"));
    EXPECT_TRUE(failed_with(render("cornell", "a.png", {"--alpha", "--checkpoint", path("c")}), 2, "--checkpoint"));
}

TEST_F(PictureOptions, RolesOfMaterials) {
    const Texture held = rendered("cornell", "held.png", {"--holdout", "0"});
    unsigned cut = 0;
    for (unsigned i = 0; i < 48 * 32; ++i) cut += held.bytes[4 * i + 3] == 0;
    EXPECT_GT(cut, 100u);
    EXPECT_LT(cut, 48u * 32);
    const Texture shadow =
        rendered("ball:500", "shadow.png",
                 {"--shadow-catcher", "plane", "--light", "directional,direction=0,-1,0,intensity=3", "--spp", "16"});
    unsigned partly = 0;
    for (unsigned i = 0; i < 48 * 32; ++i) partly += shadow.bytes[4 * i + 3] > 20 && shadow.bytes[4 * i + 3] < 250;
    EXPECT_GT(partly, 20u);
    EXPECT_TRUE(failed_with(render("cornell", "a.png", {"--holdout", "99"}), 2, "the scene has no material '99'"));
}

TEST_F(PictureOptions, TurntableTurnsTheCameraOnce) {
    ASSERT_EQ(render("cornell", "turn.pfm", {"--turntable", "4", "--camera", "0,1,4", "--look-at", "0,1,0"}).exit_code,
              0);
    ASSERT_EQ(render("cornell", "ahead.pfm", {"--camera", "0,1,4", "--look-at", "0,1,0"}).exit_code, 0);
    EXPECT_EQ(read_pfm(path("turn.0000.pfm"), 3), read_pfm(path("ahead.pfm"), 3));
    EXPECT_NE(read_pfm(path("turn.0001.pfm"), 3), read_pfm(path("ahead.pfm"), 3));
    EXPECT_EQ(read_pfm(path("turn.0003.pfm"), 3).size(), 3u * 48 * 32);
    EXPECT_FALSE(std::ifstream(path("turn.0004.pfm")).good());
    ASSERT_EQ(render("cornell", "turn.y4m", {"--turntable", "3"}).exit_code, 0);
    const std::string film = read_file(path("turn.y4m"));
    std::size_t frames = 0;
    for (std::size_t at = film.find("FRAME\n"); at != std::string::npos; at = film.find("FRAME\n", at + 1)) ++frames;
    EXPECT_EQ(frames, 3u);
    EXPECT_TRUE(failed_with(render("cornell", "a.png", {"--turntable", "3", "--frames", "0..1"}), 2, "--frames"));
}

/// A sensor of ISO 100 at f/16 and 1/100 s is saturated by 30,720 cd/m^2.
TEST_F(PictureOptions, ExposureOfASensor) {
    const ProcessResult result =
        render("cornell", "a.png", {"--iso", "100", "--f-number", "16", "--shutter-time", "10ms", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const double stops = nlohmann::json::parse(result.output).at("exposure");
    EXPECT_NEAR(std::exp2(-stops), 30720, 1);
    EXPECT_TRUE(failed_with(render("cornell", "a.png", {"--iso", "100"}), 2, "--f-number"));
    EXPECT_TRUE(failed_with(render("cornell", "a.png", {"--f-number", "2"}), 2, "no effect"));
}

/// 24 mm over 2 * 20.785 mm is the tangent of 30 degrees.
TEST_F(PictureOptions, LensesOfAFocalLength) {
    const auto image = [&](const std::vector<std::string>& options) {
        const ProcessResult result = render("cornell", "a.pfm", options);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        return read_pfm(path("a.pfm"), 3);
    };
    const std::vector<float> degrees = image({"--fov", "60"}), millimetres = image({"--focal-length", "20.7846097"});
    double difference = 0, sum = 0;
    for (std::size_t i = 0; i < degrees.size(); ++i)
        difference += std::abs(double(degrees[i] - millimetres[i])), sum += double(degrees[i]);
    EXPECT_LT(difference, 1e-3 * sum);
    EXPECT_NE(image({"--focal-length", "50"}), image({"--focal-length", "50", "--f-number", "0.05"})) << "a lens";
    for (const std::vector<std::string>& options : {std::vector<std::string>{"--projection", "fisheye"},
                                                    {"--projection", "equisolid", "--fov", "200"},
                                                    {"--projection", "cube"},
                                                    {"--stereo", "side-by-side"},
                                                    {"--shift", "0.2,0"},
                                                    {"--projection", "panorama", "--stereo", "top-bottom"},
                                                    {"--aperture", "0.1", "--tilt", "20,5"}})
        EXPECT_NE(image(options), degrees);
    EXPECT_TRUE(failed_with(render("cornell", "a.png", {"--focal-length", "35", "--fov", "40"}), 2, "--fov"));
    EXPECT_TRUE(failed_with(render("cornell", "a.png", {"--shift", "1"}), 2, "pair of numbers"));
}

}  // namespace
}  // namespace claray::test
