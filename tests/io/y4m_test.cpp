// Films: the stream's header and planes, against the colours that went in.
#include "host/io/y4m.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/io/expect_error.hpp"
#include "tests/support/process.hpp"

namespace claray {
namespace {

using test::expect_error;
using test::TemporaryFolder;

TEST(Y4m, HoldsTheFramesInOrder) {
    const TemporaryFolder folder;
    const std::vector<glm::vec3> colors = {{1, 1, 1}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0.2f, 0.5f, 0.1f}, {0, 1, 0}};
    {
        Y4mVideo video(folder / "a.y4m", 3, 2, 24);
        video.add(std::vector<glm::vec3>(6, glm::vec3(0)), 0, ToneMap::none);
        video.add(colors, 0, ToneMap::none);
        EXPECT_FALSE(std::filesystem::exists(folder / "a.y4m")) << "not before it is complete";
        video.commit();
    }
    const std::string bytes = test::read_file(folder / "a.y4m"), header = "YUV4MPEG2 W3 H2 F24:1 Ip A1:1 C444\n";
    ASSERT_EQ(bytes.size(), header.size() + 2 * (6 + 18));
    EXPECT_EQ(bytes.substr(0, header.size()), header);
    EXPECT_EQ(bytes.substr(header.size(), 6), "FRAME\n");
    EXPECT_EQ(std::uint8_t(bytes[header.size() + 6]), 16);  // black
    const auto plane = [&](int p, std::size_t i) {
        return double(std::uint8_t(bytes[header.size() + 24 + 6 + std::size_t(p) * 6 + i]));
    };
    for (std::size_t i = 0; i < 6; ++i) {  // back by the inverse matrix of BT.601
        const double y = (plane(0, i) - 16) / 219, b = (plane(1, i) - 128) / 224, r = (plane(2, i) - 128) / 224;
        const double rgb[3] = {y + 1.402 * r, y - 0.344136 * b - 0.714136 * r, y + 1.772 * b};
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(255 * rgb[k], srgb_from_linear(colors[i][k]), 2.0) << i << " " << k;
    }
}

TEST(Y4m, AStopDoublesTheLight) {
    const TemporaryFolder folder;
    std::string videos[2];
    for (int i = 0; i < 2; ++i) {
        Y4mVideo video(folder / "a.y4m", 2, 1, 24);
        video.add({glm::vec3(i ? 0.1f : 0.2f), glm::vec3(i ? 0.3f : 0.6f, 0, 0)}, i ? 1.f : 0.f, ToneMap::aces);
        video.commit();
        videos[i] = test::read_file(folder / "a.y4m");
    }
    EXPECT_EQ(videos[0], videos[1]);
}

TEST(Y4m, WritesRatesAsFractions) {
    const TemporaryFolder folder;
    for (const auto& [rate, text] : {std::pair(30000.0 / 1001, " F30000:1001 "), std::pair(23.976, " F24000:1001 "),
                                     std::pair(25.0, " F25:1 "), std::pair(12.5, " F25:2 ")}) {
        Y4mVideo(folder / "a.y4m", 1, 1, rate).commit();
        EXPECT_NE(test::read_file(folder / "a.y4m").find(text), std::string::npos) << test::read_file(folder / "a.y4m");
    }
}

TEST(Y4m, RefusesFramesOfAnotherSize) {
    const TemporaryFolder folder;
    Y4mVideo video(folder / "a.y4m", 3, 2, 24);
    expect_error(ErrorKind::usage, {"5 pixels"}, [&] { video.add(std::vector<glm::vec3>(5), 0, ToneMap::none); });
}

}  // namespace
}  // namespace claray
