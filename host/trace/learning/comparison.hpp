// Which of two trees is faster, by batches of rays that were traced in both.
#pragma once

#include <vector>

namespace claray {

class Comparison {
public:
    /// Seconds of the same rays in both trees. Times that are not positive do not count.
    void add(double first, double second);
    [[nodiscard]] std::size_t size() const { return pairs_.size(); }

    /// Seconds in the second tree for a second in the first, of the batch in the middle: all are ordered by this
    /// ratio, and each counts by its time. 1 if there are none.
    [[nodiscard]] double median() const;
    /// The same of all batches together. A ratio counts as at most 2 and at least 1/2, so that a disturbance of one
    /// batch does not decide. 1 if there are none.
    [[nodiscard]] double mean() const;
    /// Whether the gain is worth the memory of a second tree, by the median and by the mean.
    [[nodiscard]] bool second_pays() const { return median() < 0.97 && mean() < 0.97; }

private:
    struct Pair {
        double first, second;
        [[nodiscard]] double ratio() const { return second / first; }
    };
    std::vector<Pair> pairs_;
};

}  // namespace claray
