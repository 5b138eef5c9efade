// Which of two trees is faster, by batches of rays that were traced in both.
#pragma once

#include <vector>

namespace claray {

class Comparison {
public:
    /// Seconds of the same rays in both trees.
    void add(double first, double second) { pairs_.push_back({first, second}); }
    [[nodiscard]] std::size_t size() const { return pairs_.size(); }
    /// Seconds in the second tree for a second in the first: of the batch in the middle if all are ordered by this
    /// ratio and weighted by their time, so that a disturbance of one of them has little effect.
    [[nodiscard]] double ratio() const;
    /// Whether the gain is worth the memory of a second tree.
    [[nodiscard]] bool second_pays() const { return ratio() < 0.97; }

private:
    struct Pair {
        double first, second;
    };
    std::vector<Pair> pairs_;
};

}  // namespace claray
