// Scenes for shading models: a ball of few triangles with a highlight, and hills of sines.
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

Material shiny(const char* name, const glm::vec3& albedo, float specular, float shininess) {
    Material material = lambert(name, albedo);
    material.kind = MaterialKind::blinn_phong;
    material.specular = glm::vec3(specular), material.shininess = shininess;
    return material;
}

/// Splits edges of a unit sphere, the longest first, until there are enough triangles.
class SplitSphere {
public:
    SplitSphere() {
        mesh_ = named_mesh("ball");
        for (int axis = 0; axis < 3; ++axis)
            for (const float side : {1.f, -1.f}) {
                glm::vec3 corner(0.f);
                corner[axis] = side;
                mesh_.positions.push_back(corner);
            }
        for (const std::uint32_t x : {0u, 1u})
            for (const std::uint32_t y : {2u, 3u})
                for (const std::uint32_t z : {4u, 5u})
                    add((x + y + z) % 2 == 0 ? glm::uvec3(x, y, z) : glm::uvec3(x, z, y));
    }

    [[nodiscard]] Mesh with_triangles(std::size_t count) {
        while (mesh_.triangles.size() + 1 < count) split_longest();
        if (mesh_.triangles.size() < count) halve_last();
        mesh_.normals = mesh_.positions;
        for (glm::vec3& normal : mesh_.normals) normal = glm::normalize(normal);
        mesh_.materials.assign(mesh_.triangles.size(), 0);
        return std::move(mesh_);
    }

private:
    using Edge = std::pair<std::uint32_t, std::uint32_t>;  // a direction of an edge; the other has the other triangle

    void add(const glm::uvec3& t) {
        mesh_.triangles.push_back(t);
        note(std::uint32_t(mesh_.triangles.size() - 1));
    }
    void note(std::uint32_t triangle) {
        const glm::uvec3 t = mesh_.triangles[triangle];
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            left_of_[{a, b}] = triangle;
            longest_.insert({-glm::distance(mesh_.positions[a], mesh_.positions[b]), std::min(a, b), std::max(a, b)});
        }
    }
    void split_longest() {
        const auto [length, a, b] = *longest_.begin();
        longest_.erase(longest_.begin());
        const auto middle = std::uint32_t(mesh_.positions.size());
        mesh_.positions.push_back(glm::normalize(mesh_.positions[a] + mesh_.positions[b]));
        for (const Edge& edge : {Edge{a, b}, Edge{b, a}}) {
            const std::uint32_t triangle = left_of_.at(edge);
            left_of_.erase(edge);
            const glm::uvec3 t = mesh_.triangles[triangle];
            const std::uint32_t c = t.x + t.y + t.z - a - b;
            mesh_.triangles[triangle] = {edge.first, middle, c};
            note(triangle);
            add({middle, edge.second, c});
        }
    }
    /// Closed meshes have even numbers of triangles: the last triangle is cut where it is, without a bend.
    void halve_last() {
        const glm::uvec3 t = mesh_.triangles.back();
        const auto middle = std::uint32_t(mesh_.positions.size());
        mesh_.positions.push_back(0.5f * (mesh_.positions[t.x] + mesh_.positions[t.y]));
        mesh_.triangles.back() = {t.x, middle, t.z};
        mesh_.triangles.emplace_back(middle, t.y, t.z);
    }

    Mesh mesh_;
    std::map<Edge, std::uint32_t> left_of_;
    std::set<std::tuple<float, std::uint32_t, std::uint32_t>> longest_;
};

Light white_point(const glm::vec3& position, float intensity) {
    Light light;
    light.kind = LightKind::point, light.position = position, light.intensity = glm::vec3(intensity);
    return light;
}

}  // namespace

Scene ball(std::size_t count) {
    Scene scene;
    scene.materials = {shiny("red", {0.55f, 0.08f, 0.06f}, 0.35f, 40.f)};
    scene.meshes = {SplitSphere().with_triangles(count)};
    scene.lights = {white_point({2.f, 2.5f, 3.f}, 30.f), white_point({-3.f, 0.5f, 1.5f}, 4.f)};
    scene.camera = Camera{{0.f, 0.f, 4.f}, glm::vec3(0.f), {0.f, 1.f, 0.f}, 32.f};
    return scene;
}

Scene waves() {
    constexpr unsigned columns = 48;
    Scene scene;
    scene.materials = {shiny("grass", {0.16f, 0.4f, 0.1f}, 0.2f, 24.f)};
    scene.meshes = {make_height_field(columns, 12.f, [](double x, double z) {
        return 0.8 * std::sin(0.9 * x) * std::sin(0.7 * z) + 0.3 * std::sin(2.1 * x + 1.3 * z);
    })};
    scene.meshes[0].materials.assign(scene.meshes[0].triangles.size(), 0);
    scene.lights = {white_point({0.f, 6.f, -4.f}, 160.f)};
    scene.sky = {{0.25f, 0.3f, 0.35f}, {0.1f, 0.15f, 0.3f}};
    scene.camera = Camera{{0.f, 5.f, 13.f}, {0.f, 0.f, 0.f}, {0.f, 1.f, 0.f}, 45.f};
    return scene;
}

}  // namespace claray::scenes
