#include "host/trace/learning/comparison.hpp"

#include <algorithm>

namespace claray {

double Comparison::ratio() const {
    std::vector<Pair> ordered = pairs_;
    std::sort(ordered.begin(), ordered.end(),
              [](const Pair& a, const Pair& b) { return a.second * b.first < b.second * a.first; });
    // The shorter time: a disturbed one must not weigh more.
    const auto weight = [](const Pair& pair) { return std::min(pair.first, pair.second); };
    double rest = 0;
    for (const Pair& pair : ordered) rest += weight(pair) / 2;
    for (const Pair& pair : ordered)
        if ((rest -= weight(pair)) <= 0) return pair.second / pair.first;
    return 1;
}

}  // namespace claray
