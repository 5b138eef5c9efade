#include "host/trace/learning/ray_sample.hpp"

#include <algorithm>

namespace claray {

RaySample::RaySample(const Device& device) : rays_per_piece_(device.tuning("trace/learning", "RAYS_PER_PIECE")) {}

void RaySample::add(const Device& queue, QueryKind kind, const QueryOptions& options, const Buffer<Ray>& rays) {
    since_last_ += double(rays.size());
    if (rays.size() == 0 || since_last_ < double(rays_per_piece_)) return;
    const std::size_t at = next_ % most_pieces, count = std::min(rays.size(), rays_per_piece_);
    // Multiples of the golden ratio: the pieces of batches of one size are spread over the batch.
    const double place = double(next_++) * 0.6180339887498949;
    const auto first = std::size_t((place - std::size_t(place)) * double(rays.size() - count));
    if (at == pieces_.size()) pieces_.emplace_back();
    Piece& piece = pieces_[at];
    if (piece.rays.size() != count) piece.rays = Buffer<Ray>(queue, count);
    detail::copy(queue, rays.memory(), piece.rays.memory(), count * sizeof(Ray), 0, first * sizeof(Ray));
    piece.kind = kind, piece.options = options;
    piece.stands_for = since_last_;
    piece.copied = queue.event();
    since_last_ = 0;
}

}  // namespace claray
