#include "host/io/gltf/gltf_animation.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numeric>
#include <tuple>

#include "claray/error.hpp"
#include "host/base/format.hpp"
#include "host/base/message.hpp"
#include "host/io/gltf/gltf_accessor.hpp"
#include "host/io/gltf/gltf_choice.hpp"
#include "host/io/gltf/gltf_nodes.hpp"

namespace claray {
namespace {

using std::to_string;

enum class Interpolation { step, linear, cubic };

/// What a channel does over time: a value of `width` numbers at each key; where cubic, between its two tangents.
struct Keys {
    Interpolation interpolation = Interpolation::linear;
    bool rotates = false;
    std::size_t width = 0;
    std::vector<float> times, values;

    /// `part`: -1 the tangent before, 0 the value, 1 the tangent behind.
    [[nodiscard]] double number(std::size_t key, std::size_t k, int part = 0) const {
        const std::size_t element = interpolation == Interpolation::cubic ? 3 * key + std::size_t(1 + part) : key;
        return double(values[element * width + k]);
    }
};

/// `fraction` of the way from `key` to the next, `span` seconds later.
struct Moment {
    std::size_t key = 0;
    double fraction = 0, span = 0;
};

/// Before the first key and behind the last one nothing moves (section 3.11).
Moment moment_at(const std::vector<float>& times, double time) {
    if (!(time > double(times.front()))) return {};
    if (time >= double(times.back())) return {times.size() - 1, 0, 0};
    const auto next = std::upper_bound(times.begin(), times.end(), time, [](double t, float key) { return t < key; });
    const double before = double(next[-1]), span = double(*next) - before;
    return {std::size_t(next - times.begin()) - 1, (time - before) / span, span};
}

glm::dquat rotation_at(const Keys& keys, std::size_t key) {
    return {keys.number(key, 3), keys.number(key, 0), keys.number(key, 1), keys.number(key, 2)};
}

/// A cubic Hermite spline (appendix C.5 of the specification).
double on_spline(const Keys& keys, const Moment& m, std::size_t k) {
    const double t = m.fraction, t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * keys.number(m.key, k) + (t3 - 2 * t2 + t) * m.span * keys.number(m.key, k, 1) +
           (3 * t2 - 2 * t3) * keys.number(m.key + 1, k) + (t3 - t2) * m.span * keys.number(m.key + 1, k, -1);
}

std::vector<double> value_at(const Keys& keys, double time) {
    const Moment m = moment_at(keys.times, time);
    const bool between = m.fraction > 0 && keys.interpolation != Interpolation::step;
    if (between && keys.rotates && keys.interpolation == Interpolation::linear) {
        const glm::dquat q = glm::slerp(glm::normalize(rotation_at(keys, m.key)),
                                        glm::normalize(rotation_at(keys, m.key + 1)), m.fraction);
        return {q.x, q.y, q.z, q.w};
    }
    std::vector<double> value(keys.width);
    for (std::size_t k = 0; k < keys.width; ++k)
        value[k] = !between ? keys.number(m.key, k)
                   : keys.interpolation == Interpolation::cubic
                       ? on_spline(keys, m, k)
                       : glm::mix(keys.number(m.key, k), keys.number(m.key + 1, k), m.fraction);
    return value;
}

/// A node that is animated has no matrix (section 3.5.3); where it has one all the same, it is taken apart.
void split_matrix(tinygltf::Node& node) {
    if (node.matrix.size() != 16) return;
    const auto column = [&](std::size_t i) {
        return glm::dvec3(node.matrix[4 * i], node.matrix[4 * i + 1], node.matrix[4 * i + 2]);
    };
    glm::dmat3 axes(column(0), column(1), column(2));
    glm::dvec3 scale(glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2]));
    if (glm::determinant(axes) < 0) scale.x = -scale.x;
    for (int k = 0; k < 3; ++k)
        if (scale[k] != 0) axes[k] /= scale[k];
    const glm::dquat q = glm::quat_cast(axes);
    node.translation = {node.matrix[12], node.matrix[13], node.matrix[14]};
    node.rotation = {q.x, q.y, q.z, q.w};
    node.scale = {scale.x, scale.y, scale.z};
    node.matrix.clear();
}

/// Seconds of the last key, as the file states it; 0 where it does not.
double length_of(const GltfFile& file, const tinygltf::Animation& animation) {
    double length = 0;
    for (const tinygltf::AnimationSampler& sampler : animation.samplers)
        if (sampler.input >= 0 && std::size_t(sampler.input) < file.model.accessors.size())
            for (const double most : file.model.accessors[std::size_t(sampler.input)].maxValues)
                if (most > length) length = most;
    return length;
}

std::string in_seconds(double time) { return printed("%.4g s", time); }

void tell_of_animations(const GltfFile& file, Warnings& warnings) {
    const std::vector<tinygltf::Animation>& animations = file.model.animations;
    if (animations.empty()) return;
    double longest = 0;
    for (const tinygltf::Animation& animation : animations) longest = std::max(longest, length_of(file, animation));
    const bool one = animations.size() == 1;
    const std::string length = longest > 0 ? (one ? " of " : " of up to ") + in_seconds(longest) : "";
    warnings.push_back("the scene is shown in its rest pose, it has " +
                       (one ? std::string("an animation") : to_string(animations.size()) + " animations") + length +
                       ": choose a time with --at SECONDS" +
                       (one ? "" : ", and one of " + listed(names_of(animations)) + " with --animation"));
}

/// What a channel animates.
struct Property {
    bool rotates = false;
    std::size_t width = 0;       ///< numbers that a value has
    std::size_t components = 0;  ///< numbers that an element of the accessor has
    std::vector<double> tinygltf::Node::*values = nullptr;
};

class Animator {
public:
    Animator(GltfFile& file, std::size_t index)
        : file_(file),
          animation_(file.model.animations[index]),
          name_(gltf_name("animation", animation_.name, index)) {}

    /// How many channels animate what is not known here.
    std::size_t apply(double time) {
        std::size_t left_out = 0;
        for (std::size_t i = 0; i < animation_.channels.size(); ++i) left_out += !apply(i, time);
        return left_out;
    }

    /// What KHR_animation_pointer moves besides nodes.
    void add_changes(std::size_t index, double time, std::vector<GltfChange>& changes);

private:
    bool apply(std::size_t channel, double time);
    [[nodiscard]] std::vector<double> value(int sampler, const Property& property, double time,
                                            const std::string& channel);
    [[nodiscard]] Property property_of(const tinygltf::Node& node, const std::string& path) const;
    [[nodiscard]] const Keys& keys_of(int sampler, const Property& property, const std::string& channel);
    [[nodiscard]] Keys read(int sampler, const Property& property, const std::string& channel) const;
    void read_times(Keys& keys, int accessor, const std::string& channel) const;

    GltfFile& file_;
    const tinygltf::Animation& animation_;
    std::string name_;
    std::map<std::tuple<int, std::size_t, bool>, Keys> known_;  ///< by sampler, width and whether they rotate
};

Property Animator::property_of(const tinygltf::Node& node, const std::string& path) const {
    if (path == "translation") return {false, 3, 3, &tinygltf::Node::translation};
    if (path == "rotation") return {true, 4, 4, &tinygltf::Node::rotation};
    if (path == "scale") return {false, 3, 3, &tinygltf::Node::scale};
    if (path == "weights") return {false, morph_targets(file_, node), 1, &tinygltf::Node::weights};
    return {};
}

void Animator::read_times(Keys& keys, int accessor, const std::string& channel) const {
    keys.times = read_numbers(file_, accessor, 1, channel + ": its times");
    if (keys.times.empty()) file_.fail(channel + " has no keys");
    for (std::size_t i = 0; i < keys.times.size(); ++i) {
        if (!std::isfinite(keys.times[i])) file_.fail(channel + ": the time of key " + to_string(i) + " is not finite");
        if (i > 0 && keys.times[i] < keys.times[i - 1])
            file_.fail(channel + ": key " + to_string(i) + " is before key " + to_string(i - 1));
    }
}

/// Many channels may share a sampler.
const Keys& Animator::keys_of(int sampler, const Property& property, const std::string& channel) {
    const std::tuple key(sampler, property.width, property.rotates);
    auto found = known_.find(key);
    if (found == known_.end()) found = known_.emplace(key, read(sampler, property, channel)).first;
    return found->second;
}

Keys Animator::read(int index, const Property& property, const std::string& channel) const {
    if (index < 0 || std::size_t(index) >= animation_.samplers.size())
        file_.fail(channel + " refers to sampler " + to_string(index) + " of " + to_string(animation_.samplers.size()));
    const tinygltf::AnimationSampler& sampler = animation_.samplers[std::size_t(index)];
    Keys keys;
    keys.rotates = property.rotates, keys.width = property.width;
    if (sampler.interpolation == "STEP")
        keys.interpolation = Interpolation::step;
    else if (sampler.interpolation == "CUBICSPLINE")
        keys.interpolation = Interpolation::cubic;
    else if (sampler.interpolation != "LINEAR")
        file_.fail(channel + " has the unknown interpolation '" + sampler.interpolation + "'");
    read_times(keys, sampler.input, channel);
    keys.values = read_numbers(file_, sampler.output, property.components, channel + ": its values");
    const std::size_t parts = keys.interpolation == Interpolation::cubic ? 3 : 1;
    if (keys.values.size() != keys.times.size() * parts * property.width)
        file_.fail(channel + " has " + to_string(keys.values.size() / property.components) + " values instead of " +
                   to_string(keys.times.size() * parts * property.width / property.components));
    return keys;
}

bool Animator::apply(std::size_t index, double time) {
    const tinygltf::AnimationChannel& channel = animation_.channels[index];
    if (channel.target_node < 0) return false;
    const std::string name = name_ + ", channel " + to_string(index);
    std::vector<tinygltf::Node>& nodes = file_.model.nodes;
    if (std::size_t(channel.target_node) >= nodes.size())
        file_.fail(name + " refers to node " + to_string(channel.target_node) + " of " + to_string(nodes.size()));
    tinygltf::Node& node = nodes[std::size_t(channel.target_node)];
    const Property property = property_of(node, channel.target_path);
    if (property.width == 0) return false;
    std::vector<double> moved = value(channel.sampler, property, time, name);
    if (property.components > 1) split_matrix(node);
    node.*property.values = std::move(moved);
    return true;
}

void Animator::add_changes(std::size_t index, double time, std::vector<GltfChange>& changes) {
    for (const GltfPointer& pointer : file_.pointers) {
        if (pointer.animation != index) continue;
        const std::string name = name_ + ", channel of '" + one_line(pointer.place) + "'";
        const std::vector<tinygltf::AnimationSampler>& samplers = animation_.samplers;
        const auto sampler = std::size_t(pointer.sampler);
        const int accessor = sampler < samplers.size() ? samplers[sampler].output : -1;
        const bool is_known = accessor >= 0 && std::size_t(accessor) < file_.model.accessors.size();
        const int type = is_known ? file_.model.accessors[std::size_t(accessor)].type : TINYGLTF_TYPE_SCALAR;
        const auto width = std::size_t(std::max(1, tinygltf::GetNumComponentsInType(std::uint32_t(type))));
        changes.push_back({pointer.place, value(pointer.sampler, {false, width, width}, time, name)});
    }
}

std::vector<double> Animator::value(int sampler, const Property& property, double time, const std::string& channel) {
    std::vector<double> value = value_at(keys_of(sampler, property, channel), time);
    for (const double number : value)
        if (!std::isfinite(number)) file_.fail(channel + ": its value at " + in_seconds(time) + " is not finite");
    return value;
}

/// The indices of those that the options choose.
std::vector<std::size_t> chosen_animations(const GltfFile& file, const LoadOptions& options) {
    const std::vector<tinygltf::Animation>& animations = file.model.animations;
    const std::vector<std::string> names = names_of(animations);
    const bool is_name = std::find(names.begin(), names.end(), options.animation) != names.end();
    if (options.animation == "all" && !is_name && !animations.empty()) {
        std::vector<std::size_t> all(animations.size());
        std::iota(all.begin(), all.end(), std::size_t(0));
        return all;
    }
    if (options.animation.empty() && !animations.empty()) return {0};
    return {choose(file, "animation", options.animation, names)};
}

}  // namespace

std::optional<double> seconds_of_animation(const GltfFile& file, const LoadOptions& options) {
    if (file.model.animations.empty()) return {};
    double longest = 0;
    for (const std::size_t i : chosen_animations(file, options))
        longest = std::max(longest, length_of(file, file.model.animations[i]));
    return longest;
}

std::size_t morph_targets(const GltfFile& file, const tinygltf::Node& node) {
    const std::vector<tinygltf::Mesh>& meshes = file.model.meshes;
    if (node.mesh < 0 || std::size_t(node.mesh) >= meshes.size()) return 0;
    const tinygltf::Mesh& mesh = meshes[std::size_t(node.mesh)];
    return mesh.primitives.empty() ? 0 : mesh.primitives[0].targets.size();
}

void pose(GltfFile& file, const LoadOptions& options, Warnings& warnings) {
    if (!options.time) {
        if (!options.animation.empty())
            throw Error(ErrorKind::usage, "an animation is chosen without a time", "also choose a time");
        return tell_of_animations(file, warnings);
    }
    if (!std::isfinite(*options.time))
        throw Error(ErrorKind::usage, "the time is not finite", "give a time in seconds");
    const std::vector<std::size_t> chosen = chosen_animations(file, options);
    std::vector<GltfChange> changes;
    for (const std::size_t i : chosen) Animator(file, i).add_changes(i, *options.time, changes);
    std::size_t left_out = file.channels_left_out + file.change(changes);
    for (const std::size_t i : chosen) left_out += Animator(file, i).apply(*options.time);
    if (left_out > 0)
        warnings.push_back(to_string(left_out) + " channels animate unsupported properties: they are left out");
}

}  // namespace claray
