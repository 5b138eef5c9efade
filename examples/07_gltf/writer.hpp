// Writes glTF.
#pragma once

#include <algorithm>
#include <claray/io.hpp>
#include <nlohmann/json.hpp>

#include "shapes.hpp"

using nlohmann::json;

/// Collects one buffer and the JSON that describes it (glTF 2.0, chapters 3 and 5).
class Writer {
public:
    explicit Writer(std::filesystem::path folder) : folder_(std::move(folder)) {
        std::filesystem::create_directories(folder_);
        root_ = {{"asset", {{"version", "2.0"}, {"generator", "claray example 07_gltf"}}},
                 {"scene", 0},
                 {"scenes", {{{"nodes", json::array()}}}},
                 {"samplers",
                  {{{"wrapS", 10497}, {"wrapT", 10497}, {"magFilter", 9729}, {"minFilter", 9987}},
                   {{"wrapS", 33071}, {"wrapT", 33071}, {"magFilter", 9729}, {"minFilter", 9987}}}}};
    }

    /// Writes an image beside the glTF; the texture to be used by materials.
    json texture(const std::string& name, const Texture& texels, bool clamp = false) {
        claray::write_texture(folder_ / (name + ".png"), texels);
        const int source = push("images", {{"uri", name + ".png"}, {"name", name}});
        return {{"index", push("textures", {{"source", source}, {"sampler", clamp ? 1 : 0}})}};
    }

    int material(const std::string& name, json description) {
        description["name"] = name;
        if (description.contains("extensions"))
            for (const auto& extension : description["extensions"].items()) use(extension.key());
        return push("materials", description);
    }

    /// `second`: coordinates that become TEXCOORD_1.
    int mesh(const std::string& name, const Shape& shape, int material, const std::vector<vec2>& second = {}) {
        json attributes = {{"POSITION", positions(shape.positions)},
                           {"NORMAL", accessor(shape.normals, "VEC3", 5126)},
                           {"TEXCOORD_0", accessor(shape.uvs, "VEC2", 5126)}};
        if (!second.empty()) attributes["TEXCOORD_1"] = accessor(second, "VEC2", 5126);
        triangles_.push_back(shape.indices.size() / 3);
        return push("meshes", {{"name", name},
                               {"primitives",
                                {{{"attributes", attributes},
                                  {"indices", accessor(shape.indices, "SCALAR", 5125)},
                                  {"material", material}}}}});
    }

    /// Adds a node at the top; `node` may hold a mesh, a camera, a light.
    void node(json node, vec3 translation = vec3(0.f), float turn_y = 0.f, vec3 scale = vec3(1.f)) {
        if (translation != vec3(0.f)) node["translation"] = {translation.x, translation.y, translation.z};
        if (turn_y != 0.f) node["rotation"] = {0.f, std::sin(0.5f * turn_y), 0.f, std::cos(0.5f * turn_y)};
        if (scale != vec3(1.f)) node["scale"] = {scale.x, scale.y, scale.z};
        if (node.contains("mesh")) placed_ += triangles_[node["mesh"].get<std::size_t>()];
        root_["scenes"][0]["nodes"].push_back(push("nodes", node));
    }

    /// Adds a light or camera that stands at `from` and looks to `to`: glTF's look along -z.
    void looking(json what, vec3 from, vec3 to) {
        const vec3 back = glm::normalize(from - to);
        const vec3 right = glm::normalize(glm::cross(std::abs(back.y) > 0.99f ? vec3(1, 0, 0) : vec3(0, 1, 0), back));
        const vec3 up = glm::cross(back, right);
        what["matrix"] = {right.x, right.y, right.z, 0, up.x,   up.y,   up.z,   0,
                          back.x,  back.y,  back.z,  0, from.x, from.y, from.z, 1};
        node(what);
    }

    json light(const json& description) {
        use("KHR_lights_punctual");
        json& lights = root_["extensions"]["KHR_lights_punctual"]["lights"];
        lights.push_back(description);
        return {{"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}};
    }

    json camera(float vertical_fov) {
        return {{"camera", push("cameras",
                                {{"type", "perspective"}, {"perspective", {{"yfov", vertical_fov}, {"znear", 0.1}}}})}};
    }

    void use(const std::string& extension) {
        json& used = root_["extensionsUsed"];
        if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
    }

    void write(const std::string& name) {
        root_["buffers"] = {{{"uri", name + ".bin"}, {"byteLength", buffer_.size()}}};
        claray::write_file(folder_ / (name + ".bin"), buffer_);
        claray::write_file(folder_ / (name + ".gltf"), root_.dump(1) + "\n");
    }

    [[nodiscard]] std::size_t placed() const { return placed_; }

private:
    int push(const char* array, const json& object) {
        root_[array].push_back(object);
        return int(root_[array].size()) - 1;
    }

    template <class T>
    int accessor(const std::vector<T>& values, const char* type, int component) {
        const int view = push(
            "bufferViews", {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", values.size() * sizeof(T)}});
        buffer_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));  // little endian
        return push("accessors",
                    {{"bufferView", view}, {"componentType", component}, {"count", values.size()}, {"type", type}});
    }

    int positions(const std::vector<vec3>& values) {
        const int index = accessor(values, "VEC3", 5126);
        vec3 lo(values[0]), hi(values[0]);
        for (const vec3& p : values) lo = glm::min(lo, p), hi = glm::max(hi, p);
        root_["accessors"][std::size_t(index)]["min"] = {lo.x, lo.y, lo.z};
        root_["accessors"][std::size_t(index)]["max"] = {hi.x, hi.y, hi.z};
        return index;
    }

    std::filesystem::path folder_;
    json root_;
    std::string buffer_;
    std::vector<std::size_t> triangles_;
    std::size_t placed_ = 0;
};
