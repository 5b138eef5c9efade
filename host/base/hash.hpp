// Checksums: XXH3 of 128 bits, in its canonical (big endian) form. They detect damage, not manipulation.
#pragma once

#include <array>
#include <memory>
#include <string>

namespace claray {

using Digest = std::array<unsigned char, 16>;

[[nodiscard]] Digest digest_of(const void* data, std::size_t bytes);
/// The same as 32 hexadecimal digits.
[[nodiscard]] std::string hash128(const std::string& data);

/// Computes the digest of data in parts.
class Hasher {
public:
    Hasher();
    ~Hasher();
    Hasher(const Hasher&) = delete;
    Hasher& operator=(const Hasher&) = delete;

    void add(const void* data, std::size_t bytes);
    [[nodiscard]] Digest digest() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace claray
