#include "claray/shared/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "claray/program.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

/// The second dimension of Sobol's sequence from its direction numbers, one at a time.
std::uint32_t second_sobol_reference(std::uint32_t index) {
    std::uint32_t result = 0;
    for (std::uint32_t direction = 1u << 31; index != 0; index >>= 1, direction ^= direction >> 1)
        if (index & 1) result ^= direction;
    return result;
}

TEST(Rng, SecondSobolDimensionEqualsTheDirectionNumbers) {
    for (std::uint32_t i = 0; i < 100'000; ++i) {
        const std::uint32_t index = i < 50'000 ? i : hash_word(i);
        ASSERT_EQ(reverse_bits(sobol_second_reversed(index)), second_sobol_reference(index)) << index;
    }
}

/// Every elementary interval of 2^-bits area holds exactly one of the first 2^bits points: Owen's scrambling and the
/// shuffle of indices must keep that.
void expect_stratified(unsigned bits, std::uint32_t seed) {
    for (unsigned x_bits = 0; x_bits <= bits; ++x_bits) {
        std::set<std::uint64_t> cells;
        for (std::uint32_t i = 0; i < (1u << bits); ++i) {
            const SamplePair p = sobol_pair(i, seed);
            const std::uint64_t x = std::uint64_t(p.x) >> (32 - x_bits), y = std::uint64_t(p.y) >> (32 - bits + x_bits);
            cells.insert(x << 32 | y);
        }
        ASSERT_EQ(cells.size(), 1u << bits) << "seed " << seed << ", 2^" << x_bits << " columns";
    }
}

TEST(Rng, ScrambledSobolIsStratifiedInAllElementaryIntervals) {
    for (std::uint32_t seed = 0; seed < 20; ++seed)
        for (const unsigned bits : {1u, 4u, 7u, 10u}) expect_stratified(bits, hash_word(seed));
}

/// The samples of a pixel of even and of odd number: every elementary interval that should hold two samples of a half
/// holds two of each half, so that the halves' difference does not contain where their points are.
TEST(Rng, HalvesOfAPixelsSamplesAreStratified) {
    for (std::uint32_t pixel = 0; pixel < 20; ++pixel)
        for (unsigned bits = 2; bits <= 10; ++bits)
            for (unsigned x_bits = 0; x_bits < bits; ++x_bits) {
                const unsigned y_bits = bits - 1 - x_bits;
                std::vector<unsigned> counts(std::size_t(2) << (bits - 1));
                for (std::uint32_t sample = 0; sample < 2u << bits; ++sample) {
                    const SamplePair p = sample_pair(CLARAY_SOBOL, hash_word(pixel), sample, 3);
                    const std::uint64_t x = std::uint64_t(p.x) >> (32 - x_bits),
                                        y = std::uint64_t(p.y) >> (32 - y_bits);
                    ++counts[2 * (x << y_bits | y) + sample % 2];
                }
                ASSERT_EQ(std::count(counts.begin(), counts.end(), 2u), std::ptrdiff_t(counts.size()))
                    << "pixel " << pixel << ", 2^" << bits << " samples a half, 2^" << x_bits << " columns";
            }
}

TEST(Rng, SequencesOfDifferentSeedsAndDimensionsAreUncorrelated) {
    for (const std::uint32_t sampler : {CLARAY_SOBOL, CLARAY_INDEPENDENT})
        for (unsigned other = 0; other < 3; ++other) {
            if (other == 1 && sampler == CLARAY_SOBOL) continue;  // neighbours in one sequence
            double sum = 0;
            const int count = 20'000;  // pixels, one sample each
            for (int i = 0; i < count; ++i) {
                const SamplePair a = sample_pair(sampler, hash_words(i, 1), 0, 5);
                const SamplePair b = other == 0   ? sample_pair(sampler, hash_words(i, 1), 0, 6)
                                     : other == 1 ? sample_pair(sampler, hash_words(i, 1), 1, 5)
                                                  : sample_pair(sampler, hash_words(i, 2), 0, 5);
                sum += (unit_float(a.x) - 0.5) * (unit_float(b.x) - 0.5) * 12;
            }
            EXPECT_LT(std::abs(sum / count), 4 / std::sqrt(double(count))) << sampler << " " << other;
        }
}

/// Chi-squared over a 16 x 16 grid. Over pixels, so that stratification does not help: every draw is of another
/// sequence.
TEST(Rng, PairsAreUniformOverPixels) {
    for (const std::uint32_t sampler : {CLARAY_SOBOL, CLARAY_INDEPENDENT}) {
        std::vector<double> counts(256);
        const int draws = 256 * 400;
        for (int i = 0; i < draws; ++i) {
            const SamplePair p = sample_pair(sampler, hash_words(i, 9), i % 5, 2);
            ++counts[16 * (p.x >> 28) + (p.y >> 28)];
        }
        double chi2 = 0;
        for (const double count : counts) chi2 += (count - 400) * (count - 400) / 400;
        EXPECT_LT(chi2, 255 + 4 * std::sqrt(2 * 255.0)) << sampler;
        EXPECT_GT(chi2, 255 - 4 * std::sqrt(2 * 255.0)) << sampler;
    }
}

/// Chi-squared over a grid of 16 x 16 x 16 cells, within one sequence. A draw is three numbers of two dimensions.
TEST(Rng, IndependentNumbersOfTwoDimensionsFillACube) {
    constexpr double cells = 16 * 16 * 16, draws_per_cell = 256;
    for (std::uint32_t seed = 1; seed <= 12; ++seed) {
        std::vector<double> counts[2] = {std::vector<double>(cells), std::vector<double>(cells)};
        for (std::uint32_t i = 0; i < std::uint32_t(cells * draws_per_cell); ++i) {
            const SamplePair a = sample_pair(CLARAY_INDEPENDENT, seed, i, 0),
                             b = sample_pair(CLARAY_INDEPENDENT, seed, i, 1);
            ++counts[0][256 * (a.x >> 28) + 16 * (a.y >> 28) + (b.x >> 28)];
            ++counts[1][256 * (a.x >> 28) + 16 * (b.x >> 28) + (b.y >> 28)];
        }
        for (const std::vector<double>& of_cells : counts) {
            double chi2 = 0;
            for (const double count : of_cells)
                chi2 += (count - draws_per_cell) * (count - draws_per_cell) / draws_per_cell;
            EXPECT_LT(std::abs(chi2 - cells), 5 * std::sqrt(2 * cells)) << "seed " << seed;
        }
    }
}

TEST(Rng, UnitFloatsAreBelowOne) {
    EXPECT_EQ(unit_float(0), 0.f);
    EXPECT_LT(unit_float(0xffffffffu), 1.f);
    EXPECT_EQ(unit_float(0x80000000u), 0.5f);
}

/// For a smooth integrand the error of scrambled Sobol points falls far below that of independent ones.
TEST(Rng, SobolConvergesFasterThanIndependentSamples) {
    const auto error = [](std::uint32_t sampler) {
        double squares = 0;
        for (std::uint32_t pixel = 0; pixel < 200; ++pixel) {
            double sum = 0;
            for (std::uint32_t s = 0; s < 256; ++s) {
                const SamplePair p = sample_pair(sampler, hash_word(pixel), s, 0);
                sum += std::exp(double(unit_float(p.x))) * unit_float(p.y);
            }
            const double wrong = sum / 256 - (std::exp(1.0) - 1) / 2;
            squares += wrong * wrong;
        }
        return std::sqrt(squares / 200);
    };
    EXPECT_LT(error(CLARAY_SOBOL), 0.1 * error(CLARAY_INDEPENDENT));
}

/// Kernels for CPUs draw in vectors, those for GPUs one by one.
TEST(Rng, NumbersAreBelowOneOnDevices) {
    const std::vector<std::uint32_t> words = {0u, 1u, 255u, 256u, 0x7fffffffu, 0xffffff7fu, 0xffffff80u, 0xffffffffu};
    Kernel convert = compile_kernel(device(), R"(
        #include "render/samples.clh"
        kernel void convert_words(global const uint* words, global float* numbers) {
            numbers[get_global_id(0)] = unit_float(words[get_global_id(0)]);
        })",
                                    "convert_words");
    Buffer<float> numbers(device(), words.size());
    convert.run({words.size()}, Buffer<std::uint32_t>(device(), words), numbers);
    const std::vector<float> converted = numbers.read();
    for (std::size_t i = 0; i < words.size(); ++i) {
        EXPECT_EQ(converted[i], unit_float(words[i])) << words[i];
        EXPECT_LT(converted[i], 1.f) << words[i];
    }
}

TEST(Rng, DevicesDrawWhatTheHostDraws) {
    const std::uint32_t count = 1000, seed = 7, dimensions = 4;
    for (const std::uint32_t sampler : {CLARAY_SOBOL, CLARAY_INDEPENDENT}) {
        Kernel draw = compile_kernel(device(), R"(
            #include "render/samples.clh"
            kernel void draw_all(uint count, uint seed, global uint* words) {
                const uint i = get_global_id(0);
                if (i >= count) return;
                const Batch batch = {5u, count, 3u, 6u, 0u};
                const SurfaceSamples at = samples_at(samples_of(first_state(batch, 0, i), seed), i % 7);
                for (uint which = 0; which < 4; ++which) {
                    const SamplePair pair = words_at(&at, which);
                    words[8 * i + 2 * which] = pair.x, words[8 * i + 2 * which + 1] = pair.y;
                }
            })",
                                     "draw_all", {{"SAMPLER", std::to_string(sampler)}});
        Buffer<std::uint32_t> words(device(), 2 * dimensions * count);
        draw.run({count, 0}, count, seed, words);
        const std::vector<std::uint32_t> drawn = words.read();
        for (std::uint32_t i = 0; i < count; ++i)
            for (std::uint32_t which = 0; which < dimensions; ++which) {
                const std::uint32_t depth = i % 7, dimension = which < 3 ? 1 + 3 * depth + which : 0x80000000u + depth;
                const SamplePair pair = sample_pair(sampler, hash_words(5 + i / 6, seed), 3 + i % 6, dimension);
                ASSERT_EQ(drawn[2 * (dimensions * i + which)], pair.x) << i << ' ' << which;
                ASSERT_EQ(drawn[2 * (dimensions * i + which) + 1], pair.y) << i << ' ' << which;
            }
    }
}

}  // namespace
}  // namespace claray::test
