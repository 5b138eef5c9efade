// MurmurHash3_x86_32 by Austin Appleby (public domain), as Cryptomatte's specification asks for it.
#include <bit>

#include "claray/image/cryptomatte.hpp"

namespace claray {
namespace {

constexpr std::uint32_t scrambled(std::uint32_t word) { return std::rotl(word * 0xcc9e2d51u, 15) * 0x1b873593u; }

constexpr std::uint32_t byte_at(const std::string& text, std::size_t i) {
    return std::uint32_t(static_cast<unsigned char>(text[i])) << 8 * (i % 4);
}

}  // namespace

std::uint32_t matte_hash(const std::string& name) {
    std::uint32_t hash = 0, word = 0;
    for (std::size_t i = 0; i < name.size(); ++i) {
        word |= byte_at(name, i);
        if (i % 4 != 3) continue;
        hash = std::rotl(hash ^ scrambled(word), 13) * 5 + 0xe6546b64u;
        word = 0;
    }
    hash ^= scrambled(word) ^ std::uint32_t(name.size());
    hash = (hash ^ hash >> 16) * 0x85ebca6bu;
    hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
    return hash ^ hash >> 16;
}

float matte_id(std::uint32_t hash) {
    const std::uint32_t exponent = hash >> 23 & 255;
    return std::bit_cast<float>(exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash);
}

}  // namespace claray
