#include <cmath>

#include "claray/error.hpp"
#include "claray/scene.hpp"

namespace claray {
namespace {

using std::to_string;

[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
    throw Error(ErrorKind::user, what, remedy);
}

std::string name_of(const std::string& kind, const std::string& name, std::size_t index) {
    return name.empty() ? kind + " " + to_string(index) : kind + " '" + name + "'";
}

bool sound(float value) { return std::isfinite(value) && value >= 0.f; }
bool sound(const glm::vec3& v) { return sound(v.x) && sound(v.y) && sound(v.z); }

void check_length(const std::string& mesh, const char* array, std::size_t length, std::size_t expected,
                  const char* per) {
    if (length != 0 && length != expected)
        refuse(mesh + ": " + to_string(length) + " " + array + " for " + to_string(expected) + " " + per,
               "give one each, or none");
}

void check_mesh(const Mesh& mesh, const std::string& name, std::size_t materials) {
    check_length(name, "normals", mesh.normals.size(), mesh.positions.size(), "vertices");
    check_length(name, "texture coordinates", mesh.uvs.size(), mesh.positions.size(), "vertices");
    check_length(name, "materials", mesh.materials.size(), mesh.triangles.size(), "triangles");
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::uvec3& t = mesh.triangles[i];
        for (int k = 0; k < 3; ++k)
            if (t[k] >= mesh.positions.size())
                refuse(name + ": triangle " + to_string(i) + " refers to vertex " + to_string(t[k]) + " of " +
                           to_string(mesh.positions.size()),
                       "indices count from 0");
        const std::uint32_t material = mesh.materials.empty() ? 0 : mesh.materials[i];
        if (material >= materials)
            refuse(name + ": triangle " + to_string(i) + " refers to material " + to_string(material) + " of " +
                       to_string(materials),
                   "add the material to the scene");
    }
}

void check_material(const Material& material, const std::string& name) {
    const auto check = [&](bool ok, const char* value) {
        if (!ok) refuse(name + ": its " + value + " is negative or not finite", "correct the value");
    };
    check(sound(material.albedo), "albedo");
    check(sound(material.emission), "emission");
    check(sound(material.roughness), "roughness");
    check(sound(material.ior) && material.ior > 0.f, "index of refraction");
    if (std::uint32_t(material.kind) > CLARAY_METAL) refuse(name + ": unknown kind", "use a MaterialKind");
}

}  // namespace

void validate(const Scene& scene) {
    for (std::size_t i = 0; i < scene.materials.size(); ++i)
        check_material(scene.materials[i], name_of("material", scene.materials[i].name, i));
    for (std::size_t i = 0; i < scene.meshes.size(); ++i)
        check_mesh(scene.meshes[i], name_of("mesh", scene.meshes[i].name, i), scene.materials.size());
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        const Light& light = scene.lights[i];
        if (glm::any(glm::isnan(light.position)) || glm::any(glm::isinf(light.position)) || !sound(light.intensity))
            refuse("point light " + to_string(i) + ": a value is not finite or negative", "correct the value");
    }
    if (!sound(scene.sky.horizon) || !sound(scene.sky.zenith))
        refuse("sky: a value is not finite or negative", "correct the value");
}

}  // namespace claray
