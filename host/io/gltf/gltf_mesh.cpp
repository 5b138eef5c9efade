#include "host/io/gltf/gltf_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/gltf/gltf_accessor.hpp"

namespace claray {
namespace {

using std::to_string;

/// glTF 2.0, section 3.7.2.1: how vertices form triangles.
std::vector<glm::uvec3> triangles_of(const std::vector<std::uint32_t>& indices, int mode) {
    std::vector<glm::uvec3> triangles;
    const std::size_t count = indices.size();
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        triangles.reserve(count / 3);
        for (std::size_t i = 0; i + 2 < count; i += 3)
            triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
    } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        for (std::size_t i = 0; i + 2 < count; ++i)
            triangles.emplace_back(indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]);
    } else {
        for (std::size_t i = 0; i + 2 < count; ++i) triangles.emplace_back(indices[i + 1], indices[i + 2], indices[0]);
    }
    return triangles;
}

/// Points and segments, as host/io/strokes.hpp has them.
std::vector<glm::uvec3> strokes_of(const std::vector<std::uint32_t>& indices, int mode) {
    std::vector<glm::uvec3> strokes;
    const std::size_t count = indices.size(), step = mode == TINYGLTF_MODE_LINE ? 2 : 1;
    if (mode == TINYGLTF_MODE_POINTS)
        for (const std::uint32_t i : indices) strokes.emplace_back(i, i, i);
    else
        for (std::size_t i = 0; i + 1 < count; i += step)
            strokes.emplace_back(indices[i], indices[i + 1], indices[i + 1]);
    if (mode == TINYGLTF_MODE_LINE_LOOP && count > 1) strokes.emplace_back(indices[count - 1], indices[0], indices[0]);
    return strokes;
}

void check_whole(std::size_t indices, int mode, const std::string& name, const GltfFile& file) {
    const auto check = [&](int of, std::size_t corners, const char* shapes) {
        if (mode == of && indices % corners != 0)
            file.fail(name + ": " + to_string(indices) + " indices do not form whole " + shapes);
    };
    check(TINYGLTF_MODE_TRIANGLES, 3, "triangles");
    check(TINYGLTF_MODE_LINE, 2, "lines");
}

bool usable(const glm::vec3& v) {
    const float length = glm::length(v);
    return std::isfinite(length) && length > 1e-12f;
}

/// Normals of length 1; those of no length become that of the vertex's triangles.
void mend_normals(Mesh& mesh) {
    bool all = true;
    for (glm::vec3& normal : mesh.normals) {
        const bool good = usable(normal);
        normal = good ? glm::normalize(normal) : glm::vec3(0.f);
        all = all && good;
    }
    if (all) return;
    std::vector<glm::vec3> sums(mesh.positions.size(), glm::vec3(0.f));
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3& origin = mesh.positions[t.x];
        const glm::vec3 area = glm::cross(mesh.positions[t.y] - origin, mesh.positions[t.z] - origin);
        for (int k = 0; k < 3; ++k) sums[t[k]] += area;
    }
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (mesh.normals[i] == glm::vec3(0.f))
            mesh.normals[i] = usable(sums[i]) ? glm::normalize(sums[i]) : glm::vec3(0.f, 1.f, 0.f);
}

/// Tangents of length 1; where one is of no length, none are kept: they come from the triangles' own coordinates then.
void mend_tangents(Mesh& mesh) {
    for (glm::vec4& tangent : mesh.tangents) {
        if (!usable(glm::vec3(tangent)) || !std::isfinite(tangent.w)) return mesh.tangents.clear();
        tangent = glm::vec4(glm::normalize(glm::vec3(tangent)), tangent.w < 0.f ? -1.f : 1.f);
    }
}

void mend_uvs(std::vector<glm::vec2>& uvs) {
    for (glm::vec2& uv : uvs)
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = glm::vec2(0.f);
}

/// Reads the attributes of one primitive, as its morph targets change them.
class Attributes {
public:
    Attributes(const GltfFile& file, const tinygltf::Primitive& primitive, std::string name,
               const std::vector<double>& weights)
        : file_(file), primitive_(primitive), name_(std::move(name)), weights_(weights) {}

    [[nodiscard]] bool has(const std::string& attribute) const { return primitive_.attributes.count(attribute) > 0; }

    /// 0 where the primitive has no such attribute.
    [[nodiscard]] int components(const char* attribute) const {
        const auto found = primitive_.attributes.find(attribute);
        const auto& accessors = file_.model.accessors;
        if (found == primitive_.attributes.end() || std::size_t(found->second) >= accessors.size()) return 0;
        return tinygltf::GetNumComponentsInType(std::uint32_t(accessors[std::size_t(found->second)].type));
    }

    /// Nothing where the primitive has no such attribute. `M`: components by which targets move it.
    template <int N, int M = N>
    [[nodiscard]] std::vector<glm::vec<N, float>> read(const std::string& attribute) {
        const auto found = primitive_.attributes.find(attribute);
        if (found == primitive_.attributes.end()) return {};
        auto values = read_vectors<N>(file_, found->second, name_ + ": " + attribute);
        if (vertices_ == none) vertices_ = values.size();
        check_size(values.size(), name_ + ": " + attribute);
        for (std::size_t i = 0; i < std::min(weights_.size(), primitive_.targets.size()); ++i)
            if (weights_[i] != 0) morph<N, M>(values, attribute, i);
        return values;
    }

private:
    static constexpr std::size_t none = ~std::size_t(0);

    void check_size(std::size_t elements, const std::string& what) const {
        if (elements != vertices_)
            file_.fail(what + " has " + to_string(elements) + " elements for " + to_string(vertices_) + " vertices");
    }

    /// Adds what a target of some weight moves (section 3.7.2.2).
    template <int N, int M>
    void morph(std::vector<glm::vec<N, float>>& values, const std::string& attribute, std::size_t target) const {
        const auto found = primitive_.targets[target].find(attribute);
        if (found == primitive_.targets[target].end()) return;
        const std::string what = name_ + ": " + attribute + " of morph target " + to_string(target);
        const auto moves = read_vectors<M>(file_, found->second, what);
        check_size(moves.size(), what);
        for (std::size_t i = 0; i < values.size(); ++i)
            for (int k = 0; k < M; ++k) values[i][k] += float(weights_[target]) * moves[i][k];
    }

    const GltfFile& file_;
    const tinygltf::Primitive& primitive_;
    std::string name_;
    const std::vector<double>& weights_;
    std::size_t vertices_ = none;
};

/// COLOR_0, clamped to 0..1 (glTF 2.0, section 3.7.2.1); nothing where all of it is white.
std::vector<glm::vec4> read_colors(Attributes& attributes, GltfLeftOut& left_out) {
    std::vector<glm::vec4> colors;
    if (attributes.components("COLOR_0") == 3)
        for (const glm::vec3& color : attributes.read<3>("COLOR_0")) colors.emplace_back(color, 1.f);
    else
        colors = attributes.read<4>("COLOR_0");
    bool clamped = false, white = true;
    for (glm::vec4& color : colors)
        for (int k = 0; k < 4; ++k) {
            const float given = color[k];
            color[k] = std::isnan(given) ? 1.f : std::clamp(given, 0.f, 1.f);
            clamped = clamped || color[k] != given;
            white = white && color[k] == 1.f;
        }
    left_out.with_clamped_colors += clamped;
    if (white) colors.clear();
    return colors;
}

std::vector<JointSet> joint_sets_of(Attributes& attributes, const tinygltf::Primitive& primitive,
                                    const std::string& name, const GltfFile& file) {
    std::vector<JointSet> sets;
    for (std::size_t i = 0; attributes.has("JOINTS_" + to_string(i)); ++i) {
        const std::string joints = "JOINTS_" + to_string(i), weights = "WEIGHTS_" + to_string(i);
        if (!attributes.has(weights)) file.fail(name + " has " + joints + " without " + weights);
        JointSet set{attributes.read<4>(joints), attributes.read<4>(weights)};
        const int type = file.model.accessors[std::size_t(primitive.attributes.at(joints))].componentType;
        if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)
            file.fail(name + ": " + joints + " are not unsigned bytes or shorts");
        sets.push_back(std::move(set));
    }
    return sets;
}

std::vector<std::uint32_t> indices_of(const GltfFile& file, const tinygltf::Primitive& primitive, std::size_t vertices,
                                      const std::string& name) {
    if (primitive.indices >= 0) {
        std::vector<std::uint32_t> indices = read_indices(file, primitive.indices, name + ": its indices");
        for (std::size_t i = 0; i < indices.size(); ++i)
            if (indices[i] >= vertices)
                file.fail(name + ": index " + to_string(i) + " refers to vertex " + to_string(indices[i]) + " of " +
                          to_string(vertices));
        return indices;
    }
    std::vector<std::uint32_t> indices(vertices);
    for (std::size_t i = 0; i < vertices; ++i) indices[i] = std::uint32_t(i);
    return indices;
}

}  // namespace

bool is_strokes(const tinygltf::Primitive& primitive) { return primitive.mode < TINYGLTF_MODE_TRIANGLES; }

std::optional<Mesh> read_primitive(const GltfFile& file, std::size_t mesh_index, std::size_t primitive_index,
                                   const GltfLook& look, const GltfPose& pose, GltfLeftOut& left_out) {
    const tinygltf::Mesh& source = file.model.meshes[mesh_index];
    const tinygltf::Primitive& primitive = source.primitives[primitive_index];
    const std::string name = gltf_name("mesh", source.name, mesh_index) + ", primitive " + to_string(primitive_index);
    if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        file.fail(name + " has the unknown mode " + to_string(primitive.mode));
    Attributes attributes(file, primitive, name, pose.weights);
    if (!attributes.has("POSITION")) return ++left_out.without_positions, std::nullopt;

    Mesh mesh;
    mesh.name = source.name.empty() ? "mesh " + to_string(mesh_index) : source.name;
    if (source.primitives.size() > 1) mesh.name += " / " + to_string(primitive_index);
    mesh.positions = attributes.read<3>("POSITION");
    const std::vector<std::uint32_t> indices = indices_of(file, primitive, mesh.positions.size(), name);
    check_whole(indices.size(), primitive.mode, name, file);
    mesh.triangles =
        is_strokes(primitive) ? strokes_of(indices, primitive.mode) : triangles_of(indices, primitive.mode);
    mesh.materials.assign(mesh.triangles.size(), look.material);
    mesh.normals = attributes.read<3>("NORMAL");
    mesh.uvs = attributes.read<2>("TEXCOORD_" + to_string(look.uv_sets[0]));
    mesh.uvs1 = attributes.read<2>("TEXCOORD_" + to_string(look.uv_sets[1]));
    mesh.colors = read_colors(attributes, left_out);
    if (look.tangents && !mesh.normals.empty()) mesh.tangents = attributes.read<4, 3>("TANGENT");
    if (pose.joints) follow_joints(mesh, joint_sets_of(attributes, primitive, name, file), *pose.joints, file, name);
    mend_normals(mesh);
    mend_tangents(mesh);
    mend_uvs(mesh.uvs);
    mend_uvs(mesh.uvs1);
    if (mesh.triangles.empty()) return std::nullopt;
    return mesh;
}

Mesh transformed(Mesh mesh, const glm::dmat4& transform) {
    if (transform == glm::dmat4(1.0)) return mesh;
    const glm::dmat3 linear(transform);
    const bool mirrors = glm::determinant(linear) < 0.0;
    if (glm::determinant(linear) == 0.0) mesh.normals.clear(), mesh.tangents.clear();  // flattened
    const glm::dmat3 for_normals = glm::transpose(glm::inverse(linear));
    for (glm::vec3& p : mesh.positions) p = glm::vec3(transform * glm::dvec4(glm::dvec3(p), 1.0));
    for (glm::vec3& n : mesh.normals) n = glm::vec3(glm::normalize(for_normals * glm::dvec3(n)));
    for (glm::vec4& t : mesh.tangents)
        t = glm::vec4(glm::normalize(linear * glm::dvec3(t.x, t.y, t.z)), mirrors ? -t.w : t.w);
    if (mirrors)
        for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
    return mesh;
}

}  // namespace claray
