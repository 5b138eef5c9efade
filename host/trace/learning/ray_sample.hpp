// A sample of the rays that queries trace.
#pragma once

#include <array>
#include <vector>

#include "claray/query.hpp"

namespace claray {

/// Pieces of the latest batches, each of neighbouring rays, so that a piece is as coherent as its batch.
class RaySample {
public:
    struct Piece {
        QueryKind kind = QueryKind::closest;
        QueryOptions options;
        Buffer<Ray> rays;
        double stands_for = 0;  ///< number of rays that were traced since the last piece
        cl::Event copied;
    };
    static constexpr std::size_t most_pieces = 16;

    explicit RaySample(const Device& device);

    /// Takes a piece of the batch, if enough rays were traced since the last one. Copied by the queue of `queue`;
    /// asynchronous.
    void add(const Device& queue, QueryKind kind, const QueryOptions& options, const Buffer<Ray>& rays);
    [[nodiscard]] const std::vector<Piece>& pieces() const { return pieces_; }
    /// Number of rays of all pieces, if batches are large enough.
    [[nodiscard]] std::size_t capacity() const { return most_pieces * rays_per_piece_; }
    void clear() { pieces_.clear(); }

private:
    std::size_t rays_per_piece_, next_ = 0;
    double since_last_ = 0;
    std::vector<Piece> pieces_;  // a ring, once it is full
};

}  // namespace claray
