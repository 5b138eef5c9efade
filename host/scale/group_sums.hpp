// The sums of all pixels of a group, as far as its devices have handed them over.
#pragma once

#include <optional>

#include "host/compute/memory.hpp"
#include "host/render/film/film.hpp"

namespace claray {

class GroupSums {
public:
    GroupSums() = default;
    /// Zeros, or `from` where it has sums. `device`: which copies to this memory fast, or null.
    GroupSums(const Device* device, std::size_t pixels, std::span<const FilmPixel> from);

    [[nodiscard]] std::size_t pixels() const { return pixels_.size(); }
    /// Those of `pixels` pixels from `first` on. The caller takes care that nobody else writes them.
    [[nodiscard]] std::span<FilmPixel> at(std::size_t first, std::size_t pixels) const;
    void write(std::size_t first, std::span<const FilmPixel> sums) const;

private:
    std::optional<HostMemory> fast_;
    std::vector<std::uint8_t> plain_;
    std::span<FilmPixel> pixels_;
};

}  // namespace claray
