// Renders of a part of an image: batches of its pixels are listed, and its film has no others. A path depends on its
// pixel's number in the whole image, so the bits are those of the whole image.
#include "host/render/renderer_state.hpp"

namespace claray {

std::uint32_t Renderer::State::pixel_in_image(std::uint32_t pixel) const {
    const Region& region = config.region;
    if (!has_region()) return pixel;
    return (region.y + pixel / region.width) * config.width + region.x + pixel % region.width;
}

void Renderer::State::list_region() {
    if (!has_region()) return;
    std::vector<std::uint32_t> entries;
    for (std::uint32_t pixel = 0; pixel < pixels(); ++pixel) entries.insert(entries.end(), {pixel_in_image(pixel), 0});
    buffers.tables.write(std::span<const std::uint32_t>(entries), buffers.where.listed_pixels);
}

Batch Renderer::State::in_image(Batch batch) const {
    if (has_region()) batch.listed = 1;
    return batch;
}

void Renderer::State::refuse_with_region(const char* what) const {
    if (has_region()) throw Error(claray::ErrorKind::usage, what, "render the whole image");
}

}  // namespace claray
