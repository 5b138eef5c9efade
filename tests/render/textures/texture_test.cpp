// Lookups of textures against a float64 reference that shares nothing with the kernels: it wraps whole texel indices,
// and averages mip maps by overlapping areas.
#include "host/textures/textures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <tuple>

#include "claray/program.hpp"
#include "host/textures/mip_map.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

using Texel = std::array<double, 4>;

double srgb_curve(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

/// An image of linear values.
struct Reference {
    int width, height;
    std::vector<Texel> texels;
    [[nodiscard]] const Texel& at(int x, int y) const {
        return texels[std::size_t(y) * std::size_t(width) + std::size_t(x)];
    }
};

Reference decoded(const Texture& t) {
    Reference image{int(t.width), int(t.height), {}};
    for (std::size_t i = 0; i < std::size_t(t.width) * t.height; ++i) {
        std::vector<double> c;
        for (unsigned k = 0; k < t.channels; ++k) {
            const std::size_t at = i * t.channels + k;
            const bool alpha = k == 1 ? t.channels == 2 : k == 3;
            if (t.format == TexelFormat::float32)
                c.push_back(double(t.floats[at]));
            else if (t.format == TexelFormat::linear8 || alpha)
                c.push_back(t.bytes[at] / 255.0);
            else
                c.push_back(srgb_curve(t.bytes[at] / 255.0));
        }
        if (t.channels == 1) image.texels.push_back({c[0], c[0], c[0], 1});
        if (t.channels == 2) image.texels.push_back({c[0], c[0], c[0], c[1]});
        if (t.channels == 3) image.texels.push_back({c[0], c[1], c[2], 1});
        if (t.channels == 4) image.texels.push_back({c[0], c[1], c[2], c[3]});
    }
    return image;
}

/// Every texel is the mean over the area that it covers of the image above.
Reference halved(const Reference& above) {
    Reference image{std::max(1, above.width / 2), std::max(1, above.height / 2), {}};
    const double sx = double(above.width) / image.width, sy = double(above.height) / image.height;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            Texel sum{};
            for (int j = 0; j < above.height; ++j)
                for (int i = 0; i < above.width; ++i) {
                    const double w = std::min(i + 1.0, (x + 1) * sx) - std::max(double(i), x * sx);
                    const double h = std::min(j + 1.0, (y + 1) * sy) - std::max(double(j), y * sy);
                    if (w <= 0 || h <= 0) continue;
                    for (std::size_t k = 0; k < 4; ++k) sum[k] += w * h / (sx * sy) * above.at(i, j)[k];
                }
            image.texels.push_back(sum);
        }
    return image;
}

int wrapped(long i, int size, Wrap wrap) {
    if (wrap == Wrap::clamp) return int(std::clamp(i, 0l, long(size) - 1));
    const long period = wrap == Wrap::mirror ? 2l * size : size;
    const long m = ((i % period) + period) % period;
    return int(m < size ? m : period - 1 - m);
}

Texel bilinear(const Reference& image, const Texture& t, double u, double v) {
    const double x = u * image.width - 0.5, y = v * image.height - 0.5;
    const long x0 = long(std::floor(x)), y0 = long(std::floor(y));
    Texel sum{};
    for (long j = 0; j < 2; ++j)
        for (long i = 0; i < 2; ++i) {
            const double weight = (i ? x - double(x0) : 1 - x + double(x0)) * (j ? y - double(y0) : 1 - y + double(y0));
            const Texel& c = image.at(wrapped(x0 + i, image.width, t.wrap_u), wrapped(y0 + j, image.height, t.wrap_v));
            for (std::size_t k = 0; k < 4; ++k) sum[k] += weight * c[k];
        }
    return sum;
}

struct Lookup {
    float u, v, level;
};

std::vector<Texel> look_up(const Texture& texture, const std::vector<Lookup>& lookups) {
    Scene scene;
    scene.textures = {texture};
    scene.materials = {textured(0)};
    scene.meshes = {grid(1)};
    const Textures textures(device(), scene);
    const auto count = std::uint32_t(lookups.size());
    const Buffer<Lookup> at(device(), lookups);
    const Buffer<float> out(device(), 4 * lookups.size());
    compile_kernel(device(), R"(
        #include "textures/texture.clh"
        typedef struct Lookup { float u, v, level; } Lookup;
        kernel void look_up_all(global const uint* store, uint count, global const Lookup* at, global float* out) {
            const uint i = get_global_id(0);
            if (i < count) vstore4(sample_texture(store, 0, (float2)(at[i].u, at[i].v), at[i].level), i, out);
        })",
                   "look_up_all")
        .run({count, 64}, textures.store, count, at, out);
    const std::vector<float> values = out.read();
    std::vector<Texel> result(count);
    for (std::size_t i = 0; i < values.size(); ++i) result[i / 4][i % 4] = double(values[i]);
    return result;
}

/// Everywhere, beyond the image too, on the corners of texels, and on whole numbers.
std::vector<Lookup> many_lookups(const Texture& t, unsigned levels) {
    Random random(7);
    std::vector<Lookup> lookups;
    for (int i = 0; i < 3000; ++i)
        lookups.push_back(
            {random.uniform(-2.5f, 3.5f), random.uniform(-2.5f, 3.5f), random.uniform(-1.f, float(levels))});
    for (int i = -3; i <= 3; ++i)
        for (const float shift : {0.f, 0.5f, 1.f})
            lookups.push_back({float(i) + shift / float(t.width), float(i) - shift / float(t.height), 0.f});
    for (const float level : {0.f, 1.f, 2.f, 100.f}) lookups.push_back({0.3f, 0.7f, level});
    return lookups;
}

/// What a lookup may give: on a texel's border the nearest texel is either neighbour.
std::vector<Texel> expected(const std::vector<Reference>& levels, const Texture& t, const Lookup& at) {
    const double u = double(at.u), v = double(at.v);
    if (t.filter == Filter::bilinear) return {bilinear(levels[0], t, u, v)};
    std::vector<Texel> allowed;
    if (t.filter == Filter::nearest) {
        for (const double du : {-1e-6, 1e-6})
            for (const double dv : {-1e-6, 1e-6}) {
                const int x = wrapped(long(std::floor((u + du) * t.width)), int(t.width), t.wrap_u);
                const int y = wrapped(long(std::floor((v + dv) * t.height)), int(t.height), t.wrap_v);
                allowed.push_back(levels[0].at(x, y));
            }
        return allowed;
    }
    const double level = std::clamp(double(at.level), 0.0, double(levels.size() - 1));
    if (t.filter == Filter::nearest_level) return {bilinear(levels[std::size_t(std::ceil(level + 0.5) - 1)], t, u, v)};
    const auto fine = std::size_t(level), coarse = std::min(fine + 1, levels.size() - 1);
    const Texel a = bilinear(levels[fine], t, u, v), b = bilinear(levels[coarse], t, u, v);
    Texel c{};
    for (std::size_t k = 0; k < 4; ++k) c[k] = a[k] + (b[k] - a[k]) * (level - double(fine));
    return {c};
}

/// Nearest texels are exact but for the rounding of their values to float32. Positions are rounded at 3.5 times the
/// image's size. A level of bytes is rounded to half a step, which the curve's slope of up to 2.32 widens.
double tolerance_of(const Texture& t, const Lookup& at) {
    if (t.filter == Filter::nearest) return 6e-8;
    if (t.filter == Filter::bilinear || at.level <= 0 || t.format == TexelFormat::float32) return 4e-6;
    return 4e-6 + 0.5 / 255 * (t.format == TexelFormat::srgb8 ? 2.32 : 1);
}

bool near(const Texel& a, const Texel& b, double tolerance) {
    for (std::size_t k = 0; k < 4; ++k)
        if (!(std::abs(a[k] - b[k]) <= tolerance)) return false;
    return true;
}

class TextureLookup : public testing::TestWithParam<std::tuple<Wrap, Filter, TexelFormat>> {};

TEST_P(TextureLookup, AgreesWithTheReference) {
    const auto [wrap, filter, format] = GetParam();
    for (const unsigned channels : {1u, 2u, 3u, 4u})
        for (const glm::uvec2 size : {glm::uvec2(16, 8), glm::uvec2(13, 5), glm::uvec2(1, 3), glm::uvec2(1, 1)}) {
            Texture t = random_texture(size, channels, format, 11 * channels + size.x);
            t.wrap_u = wrap, t.filter = filter;
            t.wrap_v = wrap == Wrap::repeat ? Wrap::mirror : wrap == Wrap::mirror ? Wrap::clamp : Wrap::repeat;
            std::vector<Reference> levels = {decoded(t)};
            while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(halved(levels.back()));
            const std::vector<Lookup> lookups = many_lookups(t, unsigned(levels.size()));
            const std::vector<Texel> found = look_up(t, lookups);
            for (std::size_t i = 0; i < lookups.size(); ++i) {
                const std::vector<Texel> allowed = expected(levels, t, lookups[i]);
                const double tolerance = tolerance_of(t, lookups[i]);
                ASSERT_TRUE(std::any_of(allowed.begin(), allowed.end(),
                                        [&](const Texel& e) { return near(found[i], e, tolerance); }))
                    << size.x << "x" << size.y << ", " << channels << " channels, uv " << lookups[i].u << ' '
                    << lookups[i].v << ", level " << lookups[i].level << ": " << found[i][0] << " instead of "
                    << allowed[0][0];
            }
        }
}

std::string name_of(const testing::TestParamInfo<TextureLookup::ParamType>& p) {
    const char* const wraps[] = {"Repeat", "Mirror", "Clamp"};
    const char* const filters[] = {"Nearest", "Bilinear", "Trilinear", "NearestLevel"};
    const char* const formats[] = {"Srgb8", "Linear8", "Float32"};
    return std::string(wraps[int(std::get<0>(p.param))]) + filters[int(std::get<1>(p.param))] +
           formats[int(std::get<2>(p.param))];
}

INSTANTIATE_TEST_SUITE_P(
    All, TextureLookup,
    testing::Combine(testing::Values(Wrap::repeat, Wrap::mirror, Wrap::clamp),
                     testing::Values(Filter::nearest, Filter::bilinear, Filter::trilinear, Filter::nearest_level),
                     testing::Values(TexelFormat::srgb8, TexelFormat::linear8, TexelFormat::float32)),
    name_of);

TEST(TextureCoordinates, ThatAreNoNumbersGiveATexel) {
    const float inf = INFINITY, nan = NAN;
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
        for (const Filter filter : {Filter::nearest, Filter::trilinear}) {
            Texture t = random_texture({8, 8}, 3, TexelFormat::srgb8, 3);
            t.wrap_u = t.wrap_v = wrap, t.filter = filter;
            for (const Texel& c :
                 look_up(t, {{nan, 0.5f, 0.f}, {0.5f, inf, nan}, {-inf, nan, inf}, {1e30f, -1e30f, -inf}}))
                for (const double value : c) EXPECT_TRUE(value >= 0 && value <= 1) << value;
        }
}

// ---- mip maps and the curve
// ------------------------------------------------------------------------------------------

TEST(MipMap, EveryLevelKeepsTheMean) {
    for (const TexelFormat format : {TexelFormat::srgb8, TexelFormat::linear8, TexelFormat::float32}) {
        const Texture t = random_texture({96, 45}, 1, format, 5);
        const auto mean_of = [&](const std::vector<std::uint32_t>& words, std::size_t texels) {
            double sum = 0;
            for (std::size_t i = 0; i < texels; ++i) {
                const auto byte = std::uint8_t(words[i / (format == TexelFormat::float32 ? 1 : 4)] >> 8 * (i % 4));
                sum += format == TexelFormat::float32   ? double(std::bit_cast<float>(words[i]))
                       : format == TexelFormat::linear8 ? byte / 255.0
                                                        : srgb_curve(byte / 255.0);
            }
            return sum / double(texels);
        };
        const auto levels = packed_levels(t, mip_levels(t.width, t.height));
        ASSERT_EQ(levels.size(), 7u);
        const double mean = mean_of(levels[0], 96 * 45);
        for (unsigned level = 1; level < 7; ++level) {
            const std::size_t texels = std::max(1u, 96u >> level) * std::max(1u, 45u >> level);
            const double half_step = format == TexelFormat::float32 ? 1e-6 : 2.32 * 0.5 / 255;
            // Rounding a texel is uniform noise of half a step, which averages out over the level.
            EXPECT_NEAR(mean_of(levels[level], texels), mean,
                        std::max(1e-6, 2.5 * half_step / std::sqrt(3.0 * double(texels))))
                << "level " << level << ", format " << int(format);
        }
    }
}

// ---- memory
// ----------------------------------------------------------------------------------------------------------

constexpr std::size_t fixed_bytes = sizeof(TextureStore) + 2 * 256 * sizeof(float);

/// A use, a texture and a material's maps; sections begin at multiples of 16 bytes, which all of these are.
std::size_t bytes_for(std::size_t textures, std::size_t uses, std::size_t materials) {
    return fixed_bytes + textures * sizeof(TextureData) + uses * sizeof(TextureUseData) +
           materials * sizeof(MaterialMaps);
}

Scene two_textures() {
    Scene scene;
    scene.textures = {random_texture({64, 64}, 3, TexelFormat::srgb8, 1),
                      random_texture({32, 32}, 4, TexelFormat::float32, 2)};
    scene.textures[0].filter = scene.textures[1].filter = Filter::bilinear;
    scene.materials = {textured(0), textured(1), lambert_material()};
    scene.meshes = {grid(4)};
    scene.meshes[0].materials.assign(32, 0);
    scene.meshes[0].uvs.assign(25, glm::vec2(0.f));
    scene.meshes[0].uvs1.assign(25, glm::vec2(0.f));
    return scene;
}

TEST(TextureMemory, HoldsWhatUsedMaterialsReferTo) {
    Scene scene = two_textures();
    const std::size_t uvs = (25 * sizeof(glm::vec2) + 15) / 16 * 16 - 8;  // the last section is not padded
    EXPECT_EQ(Textures(device(), scene).store.bytes(), bytes_for(1, 1, 3) + 64 * 64 * 4 + uvs);
    EXPECT_EQ(Textures(device(), scene).texel_bytes, 64u * 64u * 4u);
    scene.meshes[0].materials[3] = 1;
    EXPECT_EQ(Textures(device(), scene).texel_bytes, 64u * 64u * 4u + 32u * 32u * 16u);
    scene.materials[1].albedo_map.texture = 0;  // an image that two materials share is there once
    EXPECT_EQ(Textures(device(), scene).texel_bytes, 64u * 64u * 4u);
    scene.materials[1].albedo_map.uv_set = 1;
    EXPECT_EQ(Textures(device(), scene).store.bytes(), bytes_for(1, 2, 3) + 64 * 64 * 4 + 208 + uvs);
    scene.textures[0].filter = Filter::trilinear;
    EXPECT_EQ(Textures(device(), scene).texel_bytes, 4u * (4096 + 1024 + 256 + 64 + 16 + 4 + 1));
}

TEST(TextureMemory, NothingWithoutMaps) {
    Scene scene = two_textures();
    scene.meshes[0].materials.assign(32, 2);
    EXPECT_FALSE(Textures(device(), scene).store.allocated());
    scene.materials[2].clearcoat_map.texture = 0;  // says nothing to a Lambertian
    EXPECT_FALSE(Textures(device(), scene).store.allocated());
    scene.materials[2].emission_map.texture = 0;  // emits nothing
    EXPECT_FALSE(Textures(device(), scene).store.allocated());
}

TEST(TextureMemory, EightBitsStayEightBits) {
    for (const unsigned channels : {1u, 2u, 3u, 4u}) {
        Scene scene = two_textures();
        scene.textures[0] = random_texture({64, 64}, channels, TexelFormat::srgb8, 1);
        scene.textures[0].filter = Filter::bilinear;
        EXPECT_EQ(Textures(device(), scene).texel_bytes, 64u * 64u * (channels == 3 ? 4 : channels));
    }
}

TEST(TextureErrors, TooLargeForAMipMap) {
    Scene scene = two_textures();
    scene.textures[0] = random_texture({(1u << 14) + 1, 1}, 1, TexelFormat::linear8, 1);
    scene.textures[0].name = "bark.png";
    EXPECT_TRUE(throws_error(ErrorKind::user, "bark.png", [&] { Textures(device(), scene); }));
    scene.textures[0] = random_texture({1u << 14, 1}, 1, TexelFormat::linear8, 1);
    EXPECT_EQ(Textures(device(), scene).texel_bytes, (1u << 15) + 4u);  // the last two levels are padded to words
}

}  // namespace
}  // namespace claray::test
