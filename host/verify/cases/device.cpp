// The basis of all other cases: the device computes as IEEE 754 says, orders floats by their integers, and sorts
// stably.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "claray/program.hpp"
#include "host/base/format.hpp"
#include "host/sort/radix_sort.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

/// Zeros, denormals, ones, powers of two and their neighbours, the largest.
std::vector<float> special_floats() {
    std::vector<float> values = {0.f, 1e-45f, 1.17549435e-38f, 1.1754942e-38f, 1.f, 3.402823466e38f, 1e30f, 1e18f};
    for (int power = -149; power <= 127; power += 12)
        for (const float near : {0.99999994f, 1.f, 1.00000012f}) values.push_back(std::ldexp(near, power));
    const std::size_t positive = values.size();
    for (std::size_t i = 0; i < positive; ++i) values.push_back(-values[i]);
    return values;
}

/// Every third of specials alone, the others random, of all exponents or of few, where roundings are close.
float any_float(Random& random, const std::vector<float>& specials, std::uint32_t kind) {
    if (kind % 3 == 0) return specials[random.below(std::uint32_t(specials.size()))];
    const float mantissa = 1.f + random.uniform(), sign = random.below(2) ? 1.f : -1.f;
    return sign * std::ldexp(mantissa, kind % 3 == 1 ? int(random.below(250)) - 125 : int(random.below(3)) - 1);
}

std::string hexadecimal(double value) { return printed("%a", value); }

bool same(double a, double b) {
    return (std::isnan(a) && std::isnan(b)) || std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void check_operation(Run& run, Tally& tally, const char* name, const double* input, double found, double expected) {
    if (tally.add(same(found, expected)))
        run.failure(std::string(name) + " of " + hexadecimal(input[0]) + ' ' + hexadecimal(input[1]) + ' ' +
                    hexadecimal(input[2]) + " is " + hexadecimal(found) + " instead of " + hexadecimal(expected));
}

void arithmetic32(Run& run, const std::vector<float>& triples) {
    const char* const names[6] = {"a + b", "a - b", "a * b", "fma(a, b, c)", "a * b + c", "a * b - c * c"};
    const auto count = std::uint32_t(triples.size() / 3);
    const Buffer<float> out(run.device(), 6 * std::size_t(count));
    load_kernel(run.device(), "verify/arithmetic.cl", "arithmetic32")
        .run({count, 64}, count, arg("triples", Buffer<float>(run.device(), triples).memory()),
             arg("out", out.memory()));
    const auto found = out.read();
    Tally wrong[6];
    for (std::size_t i = 0; i < count; ++i) {
        const volatile float a = triples[3 * i], b = triples[3 * i + 1], c = triples[3 * i + 2];
        const volatile float ab = a * b, cc = c * c;  // volatile: rounded here, whatever the host's compiler would do
        const float expected[6] = {a + b, a - b, ab, std::fma(float(a), float(b), float(c)), ab + c, ab - cc};
        const double input[3] = {a, b, c};
        for (int k = 0; k < 6; ++k)
            check_operation(run, wrong[k], names[k], input, found[6 * i + std::size_t(k)], expected[k]);
    }
    for (int k = 0; k < 6; ++k) run.check(std::string("float32: ") + names[k], wrong[k], "wrongly rounded");
}

void arithmetic64(Run& run, const std::vector<float>& of) {
    const char* const names[6] = {"a + b", "a - b", "a * b", "fma(a, b, c)", "a / b", "sign of a a - b c"};
    std::vector<double> triples(of.begin(), of.end());
    for (std::size_t i = 0; i < triples.size(); ++i)
        triples[i] *= 1.0 + double(i % 97) * 0x1p-40;         // more bits than float32 has
    for (std::size_t i = 0; i + 2 < triples.size(); i += 12)  // a a - b c is then hardly anything
        triples[i + 1] = std::nextafter(triples[i], 1e300), triples[i + 2] = std::nextafter(triples[i], -1e300);
    const auto count = std::uint32_t(triples.size() / 3);
    const Buffer<double> out(run.device(), 6 * std::size_t(count));
    load_kernel(run.device(), "verify/arithmetic.cl", "arithmetic64")
        .run({count, 64}, count, arg("triples", Buffer<double>(run.device(), triples).memory()),
             arg("out", out.memory()));
    const auto found = out.read();
    Tally wrong[6];
    for (std::size_t i = 0; i < count; ++i) {
        const double a = triples[3 * i], b = triples[3 * i + 1], c = triples[3 * i + 2];
        const double expected[5] = {a + b, a - b, a * b, std::fma(a, b, c), a / b};
        for (int k = 0; k < 5; ++k)
            check_operation(run, wrong[k], names[k], &triples[3 * i], found[6 * i + std::size_t(k)], expected[k]);
        const double determinant = found[6 * i + 5], bc = b * c, error = std::fma(b, c, -bc),
                     difference = std::fma(a, a, -bc);
        const double sum = difference - error;  // of exact parts: its sign is right
        const auto sign = [](double x) { return double(x > 0) - double(x < 0); };
        check_operation(run, wrong[5], names[5], &triples[3 * i], sign(determinant), sign(sum));
    }
    for (int k = 0; k < 6; ++k) run.check(std::string("float64: ") + names[k], wrong[k], "wrongly rounded");
}

void arithmetic(Run& run) {
    Random random(run.seed() + 70);
    const auto specials = special_floats();
    std::vector<float> triples;
    for (std::uint32_t i = 0; i < run.count(60'000u, 4'000'000u); ++i)
        for (int k = 0; k < 3; ++k) triples.push_back(any_float(random, specials, i));
    arithmetic32(run, triples);
    if (run.device().info().fp64) {
        arithmetic64(run, triples);
    } else {
        run.fact("float64", "the device has none: hits are decided in float32");
    }
}

/// Error bounds rely on these: OpenCL promises a division to 2.5 ulp; kernels/compute/portable.clh the others.
void approximations(Run& run) {
    Random random(run.seed() + 71);
    const auto count = run.count(100'000u, 10'000'000u);
    std::vector<float> x(count);
    for (std::uint32_t i = 0; i < count; ++i) x[i] = std::ldexp(1.f + random.uniform(), int(random.below(200)) - 100);
    const Buffer<float> out(run.device(), 3 * std::size_t(count));
    load_kernel(run.device(), "verify/arithmetic.cl", "approximations")
        .run({count, 64}, count, arg("x", Buffer<float>(run.device(), x)), arg("out", out));
    const auto found = out.read();
    double worst[3] = {};
    for (std::size_t i = 0; i < count; ++i) {
        const double expected[3] = {1 / double(x[i]), 1 / double(x[i]), std::sqrt(double(x[i]))};
        for (std::size_t k = 0; k < 3; ++k) worst[k] = std::max(worst[k], std::abs(found[3 * i + k] / expected[k] - 1));
    }
    run.check("near_reciprocal", count, worst[0] * 0x1p24, 5, "* 2^-24");
    run.check("rough_reciprocal", count, worst[1] * 0x1p20, 1, "* 2^-20");
    run.check("near_sqrt", count, worst[2] * 0x1p21, 1, "* 2^-21");
    // Builders divide by + - * and fma alone, which the host repeats.
    const Buffer<float> strict(run.device(), 3 * std::size_t(count));
    load_kernel(run.device(), "verify/functions.cl", "strict_reciprocals_of")
        .run({count, 64}, count, arg("x", Buffer<float>(run.device(), x)), arg("out", strict));
    const auto reciprocals = strict.read();
    Tally wrong;
    double off = 0;
    for (std::size_t i = 0; i < reciprocals.size(); ++i) {
        const float of = x[i / 3];
        auto y = std::bit_cast<float>(0x7ef311c7u - std::bit_cast<std::uint32_t>(of));
        for (int step = 0; step < 4; ++step) y = std::fma(y, std::fma(-of, y, 1.f), y);
        wrong.add(reciprocals[i] == y);
        off = std::max(off, std::abs(reciprocals[i] * double(of) - 1));
    }
    run.check("strict reciprocals that are not those of the host", wrong, "numbers");
    run.check("strict reciprocals", reciprocals.size(), off * 0x1p24, 2, "* 2^-24");
}

void float_atomics(Run& run) {
    Random random(run.seed() + 72);
    auto words_of = special_floats();
    words_of.insert(words_of.end(), {-0.f, INFINITY, -INFINITY});
    const std::vector<float> specials = words_of;
    Kernel kernel = load_kernel(run.device(), "verify/float_atomics.cl", "float_atomics");
    Tally extremes, round_trip;
    for (int round = 0; round < run.count(40, 400); ++round) {
        std::vector<float> values(257);
        for (float& v : values) v = any_float(random, specials, std::uint32_t(round));
        if (round % 2) values[random.below(257)] = -0.f, values[random.below(257)] = 0.f;
        if (round % 4 == 0)
            for (float& v : values) v = std::abs(v) * 0x1p-140f;  // denormals and zeros alone
        if (round % 4 == 1)
            for (float& v : values) v = random.below(2) ? -0.f : 0.f;
        const Buffer<std::uint32_t> keys(run.device(), std::vector<std::uint32_t>{0xffffffffu, 0u});
        const Buffer<float> back(run.device(), values.size());
        kernel.run({values.size(), 64}, std::uint32_t(values.size()),
                   arg("words", Buffer<float>(run.device(), values).memory()), arg("keys", keys),
                   arg("back", back.memory()));
        const auto less = [](float a, float b) { return a < b || (a == b && std::signbit(a) && !std::signbit(b)); };
        const auto found = keys.read();
        const auto value_of = [](std::uint32_t key) {
            return std::bit_cast<float>(key ^ ((key >> 31) ? 0x80000000u : 0xffffffffu));
        };
        extremes.add(same(value_of(found[0]), *std::min_element(values.begin(), values.end(), less)));
        extremes.add(same(value_of(found[1]), *std::max_element(values.begin(), values.end(), less)));
        const auto returned = back.read();
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (round_trip.add(same(returned[i], values[i])))
                run.failure(hexadecimal(values[i]) + " comes back as " + hexadecimal(returned[i]));
        }
    }
    if (extremes.wrong) run.failure("extreme " + std::to_string(extremes.first) + " is wrong");
    run.check("wrong minima and maxima", extremes, "values");
    run.check("floats that integers do not restore", round_trip, "values");
}

/// Equal keys must keep their order, so that equal Morton codes always give the same tree.
template <class Key>
void sort_keys(Run& run, std::size_t count, std::uint64_t different, Tally& wrong) {
    Random random(run.seed() + count + different);
    std::vector<Key> keys(count);
    for (auto& key : keys)
        key = Key((std::uint64_t(random.below(0xffffffffu)) << 31 ^ random.below(0xffffffffu)) % different);
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return keys[a] < keys[b]; });
    Buffer<Key> device_keys(run.device(), keys);
    Buffer<std::uint32_t> values(run.device(), count);
    RadixSort<Key>(run.device(), count, RadixSort<Key>::config_for(run.device())).sort(device_keys, values, count);
    const auto found = values.read();
    for (std::size_t i = 0; i < count; ++i) wrong.add(found[i] == order[i]);
}

/// Tiles that know the sum of all before them, among others that know only their own: all ways of ending, after any
/// number of tiles.
void look_backs(Run& run) {
    constexpr std::uint32_t digits = 256, tile_only = 1u << 30, inclusive = 1u << 31;
    const std::uint32_t tiles = run.count(64u, 4096u);
    Random random(run.seed() + 73);
    std::vector<std::uint32_t> states(std::size_t(tiles) * digits), before(states.size());
    for (std::uint32_t digit = 0; digit < digits; ++digit)
        for (std::uint32_t tile = 0, sum = 0; tile < tiles; ++tile) {
            const std::uint32_t own = random.below(1000) * (random.below(4) != 0);
            before[tile * digits + digit] = sum, sum += own;
            const bool knows_all = tile == 0 || random.below(8) == 0;
            states[tile * digits + digit] = knows_all ? inclusive | sum : tile_only | own;
        }
    const Buffer<std::uint32_t> sums(run.device(), states.size());
    load_kernel(run.device(), "verify/look_back.cl", "look_back_at")
        .run({states.size(), 64}, tiles, arg("states", Buffer<std::uint32_t>(run.device(), states)), arg("sums", sums));
    const auto found = sums.read();
    Tally wrong;
    for (std::size_t i = 0; i < found.size(); ++i) wrong.add(found[i] == before[i]);
    run.check("wrong numbers of keys in tiles before", wrong, "numbers");
}

void sort_order(Run& run) {
    look_backs(run);
    for (const Form& form : build_forms(run.device())) {
        const ScopedForm set(run.device(), form);
        Tally wrong;
        for (const std::size_t count : {std::size_t(1), std::size_t(1000), run.count<std::size_t>(100'003, 4'000'003)})
            for (const std::uint64_t different : {1ull, 3ull, 5000ull, 1ull << 62}) {
                sort_keys<std::uint64_t>(run, count, different, wrong);
                sort_keys<std::uint32_t>(run, count, std::min<std::uint64_t>(different, 0xffffffffu), wrong);
            }
        if (wrong.wrong) run.failure("position " + std::to_string(wrong.first) + " of all is wrong" + form.name);
        run.check(std::string("keys out of their stable order") + form.name, wrong, "keys");
    }
}

}  // namespace

Cases device_cases() {
    return {
        {{"arithmetic", "device",
          "+ - * and fma, and with float64 division, are rounded as IEEE 754 says; nothing is contracted"},
         arithmetic},
        {{"approximations", "device", "Reciprocals and square roots are as accurate as the error bounds assume"},
         approximations},
        {{"float-atomics", "device",
          "Minima and maxima of floats by integer atomics, with -0, denormals and infinities"},
         float_atomics},
        {{"sort", "device", "Radix sort is stable with many equal keys"}, sort_order},
    };
}

}  // namespace claray::verify
