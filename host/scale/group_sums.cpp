#include "host/scale/group_sums.hpp"

#include <algorithm>
#include <cstring>

namespace claray {

GroupSums::GroupSums(const Device* device, std::size_t pixels, std::span<const FilmPixel> from) {
    const std::size_t bytes = pixels * sizeof(FilmPixel);
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
    write(0, from);
}

std::span<FilmPixel> GroupSums::at(std::size_t first, std::size_t pixels) const {
    return pixels_.subspan(first, pixels);
}

void GroupSums::write(std::size_t first, std::span<const FilmPixel> sums) const {
    std::copy(sums.begin(), sums.end(), pixels_.begin() + std::ptrdiff_t(first));
}

}  // namespace claray
