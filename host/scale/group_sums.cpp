#include "host/scale/group_sums.hpp"

#include <algorithm>
#include <cstring>

namespace claray {

GroupSums::GroupSums(const Device* device, std::size_t pixels, bool odd, const Film::Sums& from) {
    const std::size_t bytes = pixels * (sizeof(FilmPixel) + (odd ? sizeof(ColorSum) : 0));
    std::uint8_t* memory = nullptr;
    if (device != nullptr) try {
            // Commands of a new queue do not wait for those of the device's set-up.
            fast_.emplace(device->with_new_queue(), bytes);
            memory = fast_->data();
        } catch (const Error&) {  // page-locked memory is scarce
            fast_.reset();
        }
    if (memory == nullptr) {
        plain_.resize(bytes);
        memory = plain_.data();
    }
    std::memset(memory, 0, bytes);
    pixels_ = {reinterpret_cast<FilmPixel*>(memory), pixels};
    odd_ = {reinterpret_cast<ColorSum*>(memory + pixels * sizeof(FilmPixel)), odd ? pixels : 0};
    write(0, from);
}

Film::SumsSpan GroupSums::at(std::size_t first, std::size_t pixels) const {
    return {pixels_.subspan(first, pixels), odd_.empty() ? odd_ : odd_.subspan(first, pixels)};
}

void GroupSums::write(std::size_t first, const Film::ConstSumsSpan& sums) const {
    std::copy(sums.pixels.begin(), sums.pixels.end(), pixels_.begin() + std::ptrdiff_t(first));
    if (!odd_.empty()) std::copy(sums.odd.begin(), sums.odd.end(), odd_.begin() + std::ptrdiff_t(first));
}

Film::Sums GroupSums::copy(std::size_t first, std::size_t pixels) const {
    const Film::SumsSpan some = at(first, pixels);
    return {{some.pixels.begin(), some.pixels.end()}, {some.odd.begin(), some.odd.end()}};
}

}  // namespace claray
