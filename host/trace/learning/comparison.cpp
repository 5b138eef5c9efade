#include "host/trace/learning/comparison.hpp"

#include <algorithm>

namespace claray {

void Comparison::add(double first, double second) {
    if (first > 0 && second > 0) pairs_.push_back({first, second});
}

double Comparison::median() const {
    std::vector<Pair> ordered = pairs_;
    std::sort(ordered.begin(), ordered.end(), [](const Pair& a, const Pair& b) { return a.ratio() < b.ratio(); });
    // The shorter time: a disturbed one must not weigh more.
    const auto weight = [](const Pair& pair) { return std::min(pair.first, pair.second); };
    double rest = 0;
    for (const Pair& pair : ordered) rest += weight(pair) / 2;
    for (const Pair& pair : ordered)
        if ((rest -= weight(pair)) <= 0) return pair.ratio();
    return 1;
}

double Comparison::mean() const {
    constexpr double most = 2;
    double first = 0, second = 0;
    for (const Pair& pair : pairs_) {
        const double weight = std::min(pair.first, most * pair.second);
        first += weight;
        second += weight * std::clamp(pair.ratio(), 1 / most, most);
    }
    return first > 0 ? second / first : 1;
}

}  // namespace claray
