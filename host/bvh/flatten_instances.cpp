// Instances of groups of instances, as instances of one level.
#include <algorithm>

#include "claray/instances.hpp"

namespace claray {
namespace {

glm::dmat4 matrix_of(const Instance& instance) {
    glm::dmat4 m(1.0);
    for (int k = 0; k < 4; ++k)
        m[k].x = double(instance.row0[k]), m[k].y = double(instance.row1[k]), m[k].z = double(instance.row2[k]);
    return m;
}

class Walk {
public:
    Walk(std::span<const InstanceGroup> groups, std::uint32_t bottoms)
        : groups_(groups), bottoms_(bottoms), open_(groups.size()) {}

    void visit(std::span<const Instance> members, const glm::dmat4& placed, std::uint32_t mask) {
        for (std::size_t i = 0; i < members.size(); ++i) {
            path_.push_back(std::uint32_t(i));
            visit(members[i], placed * matrix_of(members[i]), mask & members[i].mask);
            path_.pop_back();
        }
    }

    FlatInstances flat{{}, {0}, {}};

private:
    void visit(const Instance& instance, const glm::dmat4& placed, std::uint32_t mask) {
        if (instance.bottom < bottoms_) return add(instance, placed, mask);
        const std::size_t group = instance.bottom - bottoms_;
        if (group >= groups_.size())
            throw Error(ErrorKind::usage, "an instance has the bottom level " + std::to_string(instance.bottom) +
                                              " of " + std::to_string(bottoms_) + " structures and " +
                                              std::to_string(groups_.size()) + " groups");
        if (open_[group])
            throw Error(ErrorKind::usage, "the instance group " + std::to_string(group) + " contains itself");
        open_[group] = true;
        visit(groups_[group].members, placed, mask);
        open_[group] = false;
    }

    void add(const Instance& instance, const glm::dmat4& placed, std::uint32_t mask) {
        if (flat.instances.size() >= CLARAY_SLOT - 1)
            throw Error(ErrorKind::user, "the instance groups hold more than 2^29 - 2 instances in total");
        flat.instances.push_back(make_instance(glm::mat4(placed), instance.bottom, mask, instance.id));
        flat.instances.back().tag = instance.tag;
        flat.steps.insert(flat.steps.end(), path_.begin(), path_.end());
        flat.offsets.push_back(std::uint32_t(flat.steps.size()));
    }

    std::span<const InstanceGroup> groups_;
    std::uint32_t bottoms_;
    std::vector<char> open_;  // groups on the way to the current instance
    std::vector<std::uint32_t> path_;
};

}  // namespace

FlatInstances flatten(std::span<const Instance> roots, std::span<const InstanceGroup> groups, std::uint32_t bottoms) {
    Walk walk(groups, bottoms);
    walk.visit(roots, glm::dmat4(1.0), 0xffffffffu);
    return std::move(walk.flat);
}

}  // namespace claray
