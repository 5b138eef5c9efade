// Steps that can be undone.
#pragma once

#include <deque>
#include <utility>
#include <variant>
#include <vector>

#include "claray/scene.hpp"

namespace claray::view {

/// A list of the scene before a change. One step keeps one list.
using Step = std::variant<std::vector<Material>, std::vector<Light>, std::vector<MeshInstance>>;

/// Steps that can be undone, and those that were. The oldest are forgotten when all together take much memory.
class History {
public:
    /// A new step. While `held`, changes of the list that the last step holds belong to it.
    void add(Step before) {
        undone_.clear();
        if (held_ && grows_ && !done_.empty() && done_.back().index() == before.index()) return;
        done_.push_back(std::move(before)), grows_ = true;
        while (done_.size() > 1 && bytes() > most_bytes_) done_.pop_front();
    }
    /// From now on, until it is false, the changes of one list are one step: those of a slider, for example.
    void hold(bool held) { held_ = held, grows_ = false; }
    void clear() { done_.clear(), undone_.clear(); }

    [[nodiscard]] std::size_t to_undo() const { return done_.size(); }
    [[nodiscard]] std::size_t to_redo() const { return undone_.size(); }
    /// Takes back the last step: `swap(Step&)` exchanges its list with the scene's. Both return false if there is none.
    template <class Swap>
    [[nodiscard]] bool undo(const Swap& swap) {
        return shift(done_, undone_, swap);
    }
    template <class Swap>
    [[nodiscard]] bool redo(const Swap& swap) {
        return shift(undone_, done_, swap);
    }

private:
    static constexpr std::size_t most_bytes_ = 256 << 20;

    [[nodiscard]] std::size_t bytes() const {
        std::size_t sum = 0;
        for (const Step& step : done_)
            sum += std::visit([](const auto& list) { return list.size() * sizeof list[0]; }, step);
        return sum;
    }
    template <class Swap>
    bool shift(std::deque<Step>& from, std::deque<Step>& to, const Swap& swap) {
        if (from.empty()) return false;
        swap(from.back());
        to.push_back(std::move(from.back())), from.pop_back(), grows_ = false;
        return true;
    }

    std::deque<Step> done_, undone_;
    bool held_ = false, grows_ = false;  // grows_: the last step was made while it is held
};

}  // namespace claray::view
