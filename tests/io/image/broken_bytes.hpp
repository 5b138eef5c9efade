// Images whose bytes are wrong.
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "claray/error.hpp"
#include "host/io/image/image_file.hpp"

namespace claray::test {

/// Whatever the bytes are, the result is an image that is whole, or one line. Every fourth trial also cuts the end off.
inline void expect_whole_or_one_line(const std::string& whole, int trials) {
    std::minstd_rand random(1);
    for (int trial = 0; trial < trials; ++trial) {
        std::string broken = whole.substr(0, trial % 4 == 0 ? random() % whole.size() : whole.size());
        for (unsigned flips = 1 + random() % 4; flips > 0 && !broken.empty(); --flips)
            broken[random() % broken.size()] = char(random() >> 8);
        try {
            const Texture t = decode_texture(broken, "it", TexelFormat::srgb8, 1u << 24);
            EXPECT_EQ(t.bytes.size() + t.floats.size(), std::size_t(t.width) * t.height * t.channels);
        } catch (const Error& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
    }
}

}  // namespace claray::test
