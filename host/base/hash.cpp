#include "host/base/hash.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdio>
#include <cstring>

namespace claray {
namespace {

Digest canonical(XXH128_hash_t hash) {
    XXH128_canonical_t bytes;
    XXH128_canonicalFromHash(&bytes, hash);
    Digest digest;
    std::memcpy(digest.data(), bytes.digest, digest.size());
    return digest;
}

}  // namespace

Digest digest_of(const void* data, std::size_t bytes) { return canonical(XXH3_128bits(data, bytes)); }

std::string hash128(const std::string& data) {
    std::string text;
    for (const unsigned char byte : digest_of(data.data(), data.size())) {
        char digits[3];
        std::snprintf(digits, sizeof digits, "%02x", byte);
        text += digits;
    }
    return text;
}

struct Hasher::State {
    XXH3_state_t xxh;
};

Hasher::Hasher() : state_(std::make_unique<State>()) { XXH3_128bits_reset(&state_->xxh); }
Hasher::~Hasher() = default;
void Hasher::add(const void* data, std::size_t bytes) { XXH3_128bits_update(&state_->xxh, data, bytes); }
Digest Hasher::digest() const { return canonical(XXH3_128bits_digest(&state_->xxh)); }

}  // namespace claray
