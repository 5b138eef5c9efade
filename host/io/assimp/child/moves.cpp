// Animations.
#include <algorithm>
#include <cmath>

#include "host/io/assimp/child/conversion.hpp"

namespace claray::assimp {
namespace {

void append(std::vector<float>& values, const aiVector3D& v) { values.insert(values.end(), {v.x, v.y, v.z}); }
void append(std::vector<float>& values, const aiQuaternion& q) {
    const float length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    const aiQuaternion unit = length > 0 ? aiQuaternion(q.w / length, q.x / length, q.y / length, q.z / length) : q;
    values.insert(values.end(), {unit.x, unit.y, unit.z, unit.w});
}

class Channels {
public:
    Channels(Glb& glb, double ticks_per_second) : glb_(glb), ticks_(ticks_per_second) {}

    /// Keys whose times do not rise, and values that are not finite, are left out.
    template <class Key>
    void add(std::span<const Key> keys, std::size_t node, const char* path, const char* type, std::size_t width) {
        std::vector<float> times, values;
        for (const Key& key : keys) {
            const auto seconds = float(key.mTime / ticks_);
            std::vector<float> value;
            append(value, key.mValue);
            const bool rises = times.empty() ? seconds >= 0 : seconds > times.back();
            const bool finite = std::all_of(value.begin(), value.end(), [](float x) { return std::isfinite(x); });
            if (!std::isfinite(seconds) || !rises || !finite) continue;
            times.push_back(seconds);
            values.insert(values.end(), value.begin(), value.end());
        }
        if (times.empty()) return;
        const std::size_t input = glb_.add_bounded(times, "SCALAR", 1), output = glb_.add_floats(values, type, width);
        channels_.push_back({{"sampler", samplers_.size()}, {"target", {{"node", node}, {"path", path}}}});
        samplers_.push_back({{"input", input}, {"output", output}, {"interpolation", "LINEAR"}});
    }

    void take(const char* name) {
        if (!samplers_.empty())
            glb_.push("animations", {{"name", name}, {"channels", channels_}, {"samplers", samplers_}});
    }

private:
    Glb& glb_;
    double ticks_;
    Json channels_ = Json::array(), samplers_ = Json::array();
};

}  // namespace

void add_animations(Glb& glb, const aiScene& scene, const std::map<std::string, std::size_t>& nodes,
                    LeftOut& left_out) {
    for (const aiAnimation* animation : std::span(scene.mAnimations, scene.mNumAnimations)) {
        Channels channels(glb, animation->mTicksPerSecond > 0 ? animation->mTicksPerSecond : 25);  // Assimp's default
        for (const aiNodeAnim* channel : std::span(animation->mChannels, animation->mNumChannels)) {
            const auto node = nodes.find(channel->mNodeName.C_Str());
            if (node == nodes.end()) continue;
            channels.add(std::span<const aiVectorKey>(channel->mPositionKeys, channel->mNumPositionKeys), node->second,
                         "translation", "VEC3", 3);
            channels.add(std::span<const aiQuatKey>(channel->mRotationKeys, channel->mNumRotationKeys), node->second,
                         "rotation", "VEC4", 4);
            channels.add(std::span<const aiVectorKey>(channel->mScalingKeys, channel->mNumScalingKeys), node->second,
                         "scale", "VEC3", 3);
        }
        left_out["animations of vertices"] += animation->mNumMeshChannels + animation->mNumMorphMeshChannels;
        channels.take(animation->mName.C_Str());
    }
}

}  // namespace claray::assimp
