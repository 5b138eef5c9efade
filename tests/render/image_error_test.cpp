// host/render/film/image_error.cpp: the difference of two images.
#include "claray/image/image_error.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace claray::test {
namespace {

using Image = std::vector<glm::vec3>;

Image ramp(unsigned width, unsigned height) {
    Image image;
    for (unsigned y = 0; y < height; ++y)
        for (unsigned x = 0; x < width; ++x)
            image.emplace_back(0.2f + 0.6f * float(x) / float(width), 0.5f, 0.2f + 0.5f * float(y) / float(height));
    return image;
}

TEST(ImageError, IsWhatTheFormulasSay) {
    const Image reference(64, glm::vec3(0.5f));
    Image off = reference;
    for (std::size_t i = 0; i < off.size(); ++i) off[i] += i % 2 == 0 ? 0.05f : -0.05f;
    const ImageError none = image_error(reference, reference, 8), some = image_error(off, reference, 8);
    EXPECT_EQ(none.rmse, 0);
    EXPECT_EQ(none.relmse, 0);
    EXPECT_EQ(none.perceptual, 0);
    EXPECT_NEAR(some.rmse, 0.1, 1e-6);
    EXPECT_NEAR(some.relmse, 0.05 * 0.05 / (0.505 * 0.505), 1e-7);
    EXPECT_THROW((void)image_error(off, Image(63), 8), Error);
    EXPECT_THROW((void)image_error(Image(), Image(), 8), Error);
}

TEST(ImageError, SeesWhatEyesSee) {
    const unsigned width = 48;
    const Image reference = ramp(width, width);
    // The same error as a grain too fine to be seen well, and as a patch.
    Image grain = reference, patch = reference, black(reference.size(), glm::vec3(0));
    for (unsigned y = 0; y < width; ++y)
        for (unsigned x = 0; x < width; ++x) {
            grain[y * width + x] *= (x + y) % 2 == 0 ? 1.1f : 0.9f;
            patch[y * width + x] *= x < width / 2 ? 1.1f : 0.9f;
        }
    const double fine = image_error(grain, reference, width).perceptual;
    const double coarse = image_error(patch, reference, width).perceptual;
    EXPECT_GT(coarse, 3 * fine);
    EXPECT_GT(image_error(black, reference, width).perceptual, 2 * coarse);
    EXPECT_LE(image_error(black, reference, width).perceptual, 1);
    // It does not matter how bright both are.
    Image brighter = reference, brighter_patch = patch;
    for (glm::vec3& p : brighter) p *= 1000.f;
    for (glm::vec3& p : brighter_patch) p *= 1000.f;
    EXPECT_NEAR(image_error(brighter_patch, brighter, width).perceptual, coarse, 1e-4);
}

}  // namespace
}  // namespace claray::test
