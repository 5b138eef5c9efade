// Noise, and images painted by functions.
#pragma once

#include <claray/texture.hpp>
#include <cmath>
#include <functional>

using claray::Texture;
using glm::vec2;
using glm::vec3;
using glm::vec4;

inline float hash(int x, int y) {
    auto h = std::uint32_t(x) * 0x8da6b343u ^ std::uint32_t(y) * 0xd8163841u;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return float((h ^ (h >> 15)) >> 8) / 16777216.f;
}

/// Values at lattice points, smoothly between; repeats after `period`, so that images can be laid side by side.
inline float noise(vec2 p, int period) {
    const vec2 cell = glm::floor(p), t = glm::smoothstep(vec2(0.f), vec2(1.f), p - cell);
    const auto at = [&](int dx, int dy) {
        const auto wrap = [&](int i) { return ((i % period) + period) % period; };
        return hash(wrap(int(cell.x) + dx), wrap(int(cell.y) + dy));
    };
    return glm::mix(glm::mix(at(0, 0), at(1, 0), t.x), glm::mix(at(0, 1), at(1, 1), t.x), t.y);
}

inline float clouds(vec2 p, int period) {
    float sum = 0.f, weight = 0.5f;
    for (int octave = 0; octave < 5; ++octave, p *= 2.f, period *= 2, weight *= 0.5f) sum += weight * noise(p, period);
    return sum;
}

using Paint = std::function<vec4(vec2 uv)>;
using Height = std::function<float(vec2 uv)>;

inline Texture image(int size, unsigned channels, const Paint& paint) {
    Texture texture;
    texture.width = texture.height = unsigned(size);
    texture.channels = channels;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const vec4 color = glm::clamp(paint((vec2(x, y) + 0.5f) / float(size)), 0.f, 1.f);
            for (unsigned k = 0; k < channels; ++k)
                texture.bytes.push_back(std::uint8_t(std::lround(255.f * color[int(k)])));
        }
    return texture;
}

/// Tangent-space normals of a height in units of the image's width; +y is up in the image, against v.
inline Texture normals(int size, const Height& height) {
    return image(size, 3, [&](vec2 uv) {
        const float h = 1.f / float(size);
        const float du = (height(uv + vec2(h, 0)) - height(uv - vec2(h, 0))) / (2.f * h);
        const float dv = (height(uv + vec2(0, h)) - height(uv - vec2(0, h))) / (2.f * h);
        return vec4(0.5f + 0.5f * glm::normalize(vec3(-du, dv, 1.f)), 1.f);
    });
}

/// glTF's packing: roughness in green, metallic in blue.
inline vec4 rough_metal(float roughness, float metallic) { return {0.f, roughness, metallic, 1.f}; }

/// 1 inside bricks or tiles of a wall of columns x rows, falling to 0 in the joints.
inline float bricks(vec2 uv, vec2 count, float shift, float joint) {
    const float row = std::floor(uv.y * count.y);
    const vec2 p = glm::fract(vec2(uv.x * count.x + shift * row, uv.y * count.y));
    const vec2 edge = glm::min(p, 1.f - p) / count;
    return glm::smoothstep(0.5f * joint, joint, std::min(edge.x, edge.y));
}

inline int brick_number(vec2 uv, vec2 count, float shift) {
    const float row = std::floor(uv.y * count.y);
    const float column = std::floor(uv.x * count.x + shift * row);
    return int(std::fmod(column + count.x, count.x)) * 131 + int(row);
}
