#include "host/io/gltf/gltf_instancing.hpp"

#include "host/io/gltf/gltf_accessor.hpp"

namespace claray {
namespace {

using std::to_string;

/// Reads the attributes of a node's instances, which have as many elements each.
class Instances {
public:
    Instances(const GltfFile& file, const std::string& name, const tinygltf::Value& extension)
        : file_(file), name_(name), attributes_(extension.Get("attributes")) {}

    /// Empty where there is no such attribute.
    template <int N>
    [[nodiscard]] std::vector<glm::vec<N, float>> read(const char* attribute) {
        if (!attributes_.IsObject() || !attributes_.Has(attribute)) return {};
        const tinygltf::Value& accessor = attributes_.Get(attribute);
        const std::string what = name_ + ": " + attribute + " of its instances";
        auto values = read_vectors<N>(file_, accessor.IsInt() ? accessor.GetNumberAsInt() : -1, what);
        if (count_.value_or(values.size()) != values.size())
            file_.fail(what + " has " + to_string(values.size()) + " elements for " + to_string(*count_) +
                       " instances");
        count_ = values.size();
        return values;
    }

    /// How many there are; nothing where no attribute was found.
    [[nodiscard]] std::optional<std::size_t> count() const { return count_; }

private:
    const GltfFile& file_;
    const std::string& name_;
    const tinygltf::Value& attributes_;
    std::optional<std::size_t> count_;
};

}  // namespace

std::vector<glm::dmat4> placements_of(const GltfFile& file, const PlacedNode& node) {
    const auto extension = node.node->extensions.find("EXT_mesh_gpu_instancing");
    if (extension == node.node->extensions.end() || !extension->second.IsObject()) return {node.world};
    Instances instances(file, node.name, extension->second);
    const std::vector<glm::vec3> translations = instances.read<3>("TRANSLATION");
    const std::vector<glm::vec4> rotations = instances.read<4>("ROTATION");
    const std::vector<glm::vec3> scales = instances.read<3>("SCALE");
    if (!instances.count()) return {node.world};
    std::vector<glm::dmat4> placements;
    placements.reserve(*instances.count());
    for (std::size_t i = 0; i < *instances.count(); ++i) {
        const glm::dvec4 rotation = rotations.empty() ? glm::dvec4(0, 0, 0, 1) : glm::dvec4(rotations[i]);
        if (!(glm::length(rotation) > 1e-6))
            file.fail(node.name + ": the rotation of its instance " + to_string(i) + " has length 0");
        placements.push_back(node.world *
                             transform_of(translations.empty() ? glm::dvec3(0.0) : glm::dvec3(translations[i]),
                                          rotation, scales.empty() ? glm::dvec3(1.0) : glm::dvec3(scales[i])));
    }
    return placements;
}

}  // namespace claray
