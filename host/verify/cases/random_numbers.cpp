// The random numbers of paths: every bit of them, how evenly they fill the square, and what trees of lights make of
// them.
#include <array>
#include <bit>
#include <cmath>

#include "host/verify/cases/cases.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

/// Cells of 2^-a x 2^-b with a + b = m hold one each of the first 2^m points, whatever the shape of the cells, and so
/// do those of each further 2^m points.
bool fills_cells(std::span<const std::uint32_t> words, unsigned number, unsigned m) {
    for (std::size_t begin = 0; 6 * (begin + (1u << m)) <= words.size(); begin += 1u << m)
        for (unsigned a = 0; a <= m; ++a) {
            std::vector<bool> taken(1u << m);
            for (std::size_t i = begin; i < begin + (1u << m); ++i) {
                const std::uint64_t x = words[6 * i + 2 * number], y = words[6 * i + 2 * number + 1];
                const std::size_t cell = (x >> (32 - a) << (m - a)) | (y >> (32 - (m - a)));
                if (taken[cell]) return false;
                taken[cell] = true;
            }
        }
    return true;
}

/// The largest departure of a bit's mean from a half, in standard deviations.
double uneven_bits(std::span<const std::uint32_t> words) {
    const std::size_t count = words.size() / 6;
    double worst = 0;
    for (unsigned k = 0; k < 6; ++k)
        for (unsigned bit = 0; bit < 32; ++bit) {
            double sum = 0;
            for (std::size_t i = 0; i < count; ++i) sum += words[6 * i + k] >> bit & 1 ? 1 : -1;
            worst = std::max(worst, std::abs(sum) / std::sqrt(double(count)));
        }
    return worst;
}

void random_numbers(Run& run) {
    const std::uint32_t count = 1u << 13;
    Tally floats, cells;
    double worst = 0;
    for (std::uint32_t seed = 0; seed < run.count(8u, 200u); ++seed) {
        const Buffer<std::uint32_t> words(run.device(), 6 * std::size_t(count));
        const Buffer<float> values(run.device(), 6 * std::size_t(count));
        load_kernel(run.device(), "verify/random_numbers.cl", "draw_numbers")
            .run({count, 64}, std::uint32_t(run.seed() * 1000 + seed), count, arg("words", words),
                 arg("floats", values));
        const std::vector<std::uint32_t> found = words.read();
        const std::vector<float> as_floats = values.read();
        for (std::size_t i = 0; i < found.size(); ++i) floats.add(as_floats[i] == float(found[i] >> 8) * 0x1p-24f);
        for (unsigned number = 0; number < 3; ++number)
            for (const unsigned m : {1u, 4u, 9u, 13u})
                if (cells.add(fills_cells(found, number, m)))
                    run.failure("seed " + std::to_string(seed) + ": cells of 2^-" + std::to_string(m));
        worst = std::max(worst, uneven_bits(found));
    }
    run.check("numbers that are not the upper 24 bits of a word", floats, "numbers");
    run.check("sequences that miss a cell", cells, "sequences");
    run.check("means of bits off a half", count, worst, 5.5, "standard deviations");
}

// ---- trees of lights ---------------------------------------------------------------------------------------------

std::uint32_t hashed(std::uint32_t x) {  // hash_word of claray/shared/rng_words.h, which that test compares, too
    x ^= x >> 16, x *= 0x7feb352du, x ^= x >> 15, x *= 0x846ca68bu, x ^= x >> 16;
    return x;
}

struct Descent {
    float across, down, probability = 1;
    std::uint32_t word, child = 0;
};

/// One step, in float64 and rounded where the kernel rounds. Divisions by other numbers than powers of two have no
/// defined bits.
void step(Descent& at, const float* w) {
    const double lower = double(w[0]) + w[1], upper = double(w[2]) + w[3], total = lower + upper;
    const auto across = float(at.across * total);
    const bool right = across >= lower && upper > 0;
    const double half = right ? upper : lower, first = right ? w[2] : w[0], second = right ? w[3] : w[1];
    const auto down = float(at.down * half);
    const bool below = down >= first && second > 0;
    const double share = below ? second : first;
    at.child = 2 * right + below;
    at.probability = float(at.probability * (share / total));
    at.word = hashed(at.word + 0x9e3779b9u);
    const auto rest = [](double value, double digits, double scale, double by) {
        return std::min(std::max(float(float(digits * 0x1p-24 * scale + value) / by), 0.f), 0.99999994f);
    };
    at.across = rest(across - float(right ? lower : 0), (at.word >> 8) * 0x1p-24, total, half);
    at.down = rest(down - float(below ? first : 0), ((at.word << 8) >> 8) * 0x1p-24, half, share);
}

using Shares = std::array<float, 4>;

/// `words`: four pairs for each item. Compares what the last two levels define: they divide by other numbers.
void judge_descents(Run& run, const std::vector<Shares>& shares, const std::vector<std::uint32_t>& words,
                    Tally (&wrong)[2]) {
    const auto levels = std::uint32_t(shares.size()), count = std::uint32_t(words.size() / 8);
    const Buffer<std::uint32_t> out(run.device(), 32 * std::size_t(levels) * count);
    std::vector<float> flat;
    for (const Shares& of : shares) flat.insert(flat.end(), of.begin(), of.end());
    load_kernel(run.device(), "verify/random_numbers.cl", "descend")
        .run({count, 64}, count, levels, arg("shares", Buffer<float>(run.device(), flat)),
             arg("words", Buffer<std::uint32_t>(run.device(), words)), arg("out", out));
    const std::vector<std::uint32_t> found = out.read();
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 4; ++k) {
            const std::uint32_t x = words[8 * i + k], y = words[8 * i + 4 + k];
            Descent place{float(x >> 8) * 0x1p-24f, float(y >> 8) * 0x1p-24f, 1, x};
            for (std::size_t level = 0; level < levels; ++level) {
                step(place, shares[level].data());
                const bool last = level + 1 == levels, last_two = level + 2 >= levels;
                for (std::size_t form = 0; form < 2; ++form) {
                    const std::uint32_t* at = &found[(2 * i + form) * 16 * levels + 16 * level + 4 * k];
                    const auto is = [&](std::size_t word, float value) {
                        return at[word] == std::bit_cast<std::uint32_t>(value);
                    };
                    if (wrong[form].add(at[0] == place.child && (last || is(1, place.across)) && is(2, place.down) &&
                                        (last_two || is(3, place.probability))))
                        run.failure("level " + std::to_string(level) + (form ? ", of four" : ", of one"));
                }
            }
        }
}

void light_descents(Run& run) {
    Random random(run.seed() + 5);
    std::vector<std::uint32_t> words(8 * run.count<std::size_t>(4096, 262'144));
    for (std::uint32_t& word : words) word = random.below(0xffffffffu);
    Tally wrong[2];
    judge_descents(run,
                   {{1, 1, 1, 1},
                    {0, 0, 1, 1},
                    {1, 1, 1, 1},
                    {2, 2, 4, 0},
                    {1, 0, 0, 0},
                    {4, 4, 8, 0},
                    {1, 1, 0, 2},
                    {1, 1, 1, 1},
                    {0, 2, 1, 1},
                    {1, 1, 1, 1},
                    {64, 64, 64, 64},
                    {1, 1, 2, 0},
                    {1, 1, 4, 4},
                    {1, 4, 0, 0}},
                   words, wrong);
    // Little is left of numbers next to a border, and roundings of the digits that are added show.
    for (std::size_t i = 0; i < words.size(); ++i)
        if (i % 8 >= 4) words[i] = (1u << 31) / 5 * 2 + (random.below(64) << 8);
    judge_descents(run, {{1, 4, 0, 0}}, words, wrong);
    run.check("wrong steps down a tree, of one ray", wrong[0], "steps");
    run.check("wrong steps down a tree, of four rays", wrong[1], "steps");
}

}  // namespace

Cases random_cases() {
    return {
        {{"random-numbers", "light", "Samples fill every elementary cell once, by all bits of their numbers"},
         random_numbers},
        {{"light-descents", "light", "Descents of trees of lights use every digit of a number, bit for bit"},
         light_descents},
    };
}

}  // namespace claray::verify
