#include "host/scene/builtin/shapes.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>

namespace claray::scenes {
namespace {

std::uint32_t add_vertices(Mesh& mesh, std::initializer_list<glm::vec3> points) {
    const auto first = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), points);
    return first;
}

void add_face(Mesh& mesh, const glm::uvec3& face, std::uint32_t material) {
    mesh.triangles.push_back(face);
    mesh.materials.push_back(material);
}

Mesh unit_icosahedron() {
    constexpr float g = std::numbers::phi_v<float>;
    Mesh mesh;
    mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                      {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (glm::vec3& p : mesh.positions) p = glm::normalize(p);
    return mesh;
}

// Splits every triangle in four; neighbours share the new vertex in the middle of their edge.
void subdivide_on_sphere(Mesh& mesh) {
    std::unordered_map<std::uint64_t, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const std::uint64_t edge = std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
        const auto [found, is_new] = middles.try_emplace(edge, std::uint32_t(mesh.positions.size()));
        if (is_new) mesh.positions.push_back(glm::normalize(mesh.positions[a] + mesh.positions[b]));
        return found->second;
    };
    std::vector<glm::uvec3> split;
    split.reserve(4 * mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
        const std::uint32_t ab = middle(t.x, t.y), bc = middle(t.y, t.z), ca = middle(t.z, t.x);
        split.insert(split.end(), {{t.x, ab, ca}, {ab, t.y, bc}, {ca, bc, t.z}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(split);
}

Material make_material(const char* name, MaterialKind kind, const glm::vec3& albedo) {
    Material material;
    material.name = name;
    material.kind = kind;
    material.albedo = albedo;
    return material;
}

}  // namespace

Mesh named_mesh(const char* name, std::size_t vertices, std::size_t triangles) {
    Mesh mesh;
    mesh.name = name;
    mesh.positions.reserve(vertices);
    mesh.triangles.reserve(triangles);
    mesh.materials.reserve(triangles);
    return mesh;
}

void add_triangle(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, std::uint32_t material) {
    const std::uint32_t first = add_vertices(mesh, {a, b, c});
    add_face(mesh, {first, first + 1, first + 2}, material);
}

void add_quad(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d,
              std::uint32_t material) {
    const std::uint32_t first = add_vertices(mesh, {a, b, c, d});
    add_face(mesh, {first, first + 1, first + 2}, material);
    add_face(mesh, {first, first + 2, first + 3}, material);
}

void add_rectangle(Mesh& mesh, const glm::vec3& center, const glm::vec3& u, const glm::vec3& v,
                   std::uint32_t material) {
    add_quad(mesh, center - u - v, center + u - v, center + u + v, center - u + v, material);
}

void add_beveled_box(Mesh& mesh, const glm::vec3& center, const glm::mat3& axes, float bevel, std::uint32_t material) {
    // Each corner of the box becomes three vertices: vertex `axis` of a corner lies on the face across that axis.
    const auto first = std::uint32_t(mesh.positions.size());
    for (int corner = 0; corner < 8; ++corner) {
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 p = center;
            for (int k = 0; k < 3; ++k) {
                const float cut = k == axis ? 0.f : bevel / glm::length(axes[k]);
                p += (corner >> k & 1 ? 1.f : -1.f) * (1.f - cut) * axes[k];
            }
            mesh.positions.push_back(p);
        }
    }
    const auto vertex = [&](int corner, int axis) { return first + std::uint32_t(3 * corner + axis); };
    // Every face is convex and the box surrounds its centre, so outward is away from the centre.
    const auto outward = [&](glm::uvec3 face) {
        const auto& p = mesh.positions;
        const glm::vec3 normal = glm::cross(p[face.y] - p[face.x], p[face.z] - p[face.x]);
        if (glm::dot(normal, p[face.x] + p[face.y] + p[face.z] - 3.f * center) < 0.f) std::swap(face.y, face.z);
        add_face(mesh, face, material);
    };
    for (int axis = 0; axis < 3; ++axis) {
        const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
        for (const int side : {0, 1 << axis}) {  // the two faces across this axis
            outward({vertex(side, axis), vertex(side + u, axis), vertex(side + u + v, axis)});
            outward({vertex(side, axis), vertex(side + u + v, axis), vertex(side + v, axis)});
        }
        const int next = (axis + 1) % 3, last = (axis + 2) % 3;
        for (const int edge : {0, u, v, u + v}) {  // the four edges along this axis
            const int end = edge + (1 << axis);
            outward({vertex(edge, next), vertex(end, next), vertex(end, last)});
            outward({vertex(edge, next), vertex(end, last), vertex(edge, last)});
        }
    }
    for (int corner = 0; corner < 8; ++corner) outward({vertex(corner, 0), vertex(corner, 1), vertex(corner, 2)});
}

void add_frustum(Mesh& mesh, const glm::vec3& base, float base_radius, float top_radius, float height, unsigned sides,
                 std::uint32_t material) {
    const auto rim = [&](unsigned i, float radius, float y) {
        const double angle = 2.0 * std::numbers::pi * (i % sides) / sides;
        return base + glm::vec3(radius * float(std::cos(angle)), y, -radius * float(std::sin(angle)));
    };
    for (unsigned i = 0; i < sides; ++i) {
        const glm::vec3 a = rim(i, base_radius, 0.f), b = rim(i + 1, base_radius, 0.f);
        if (top_radius > 0.f)
            add_quad(mesh, a, b, rim(i + 1, top_radius, height), rim(i, top_radius, height), material);
        else
            add_triangle(mesh, a, b, base + glm::vec3(0.f, height, 0.f), material);
    }
}

Mesh make_sphere(const glm::vec3& center, float radius, unsigned levels, std::uint32_t material) {
    Mesh mesh = unit_icosahedron();
    for (unsigned level = 0; level < levels; ++level) subdivide_on_sphere(mesh);
    mesh.name = "sphere";
    mesh.normals = mesh.positions;
    for (glm::vec3& p : mesh.positions) p = center + radius * p;
    mesh.materials.assign(mesh.triangles.size(), material);
    return mesh;
}

Mesh make_height_field(unsigned columns, float half, const std::function<double(double, double)>& height) {
    Mesh mesh = named_mesh("ground");
    if (columns == 0) return mesh;
    const std::size_t side = std::size_t(columns) + 1;
    const double step = 2.0 * half / columns;
    mesh.positions.resize(side * side);
    for (std::size_t j = 0; j < side; ++j) {
        for (std::size_t i = 0; i < side; ++i) {
            const double x = double(i) * step - half, z = double(j) * step - half;
            mesh.positions[j * side + i] = glm::vec3(x, height(x, z), z);
        }
    }
    // Central differences, one-sided at the border.
    mesh.normals.resize(mesh.positions.size());
    for (std::size_t j = 0; j < side; ++j) {
        for (std::size_t i = 0; i < side; ++i) {
            const std::size_t west = i ? i - 1 : 0, east = std::min(i + 1, side - 1);
            const std::size_t north = j ? j - 1 : 0, south = std::min(j + 1, side - 1);
            const glm::vec3 along_x = mesh.positions[j * side + east] - mesh.positions[j * side + west];
            const glm::vec3 along_z = mesh.positions[south * side + i] - mesh.positions[north * side + i];
            mesh.normals[j * side + i] = glm::normalize(glm::cross(along_z, along_x));
        }
    }
    mesh.triangles.reserve(2 * std::size_t(columns) * columns);
    for (std::uint32_t j = 0; j < columns; ++j) {
        for (std::uint32_t i = 0; i < columns; ++i) {
            const auto a = std::uint32_t(j * side + i), b = std::uint32_t(a + side);
            mesh.triangles.emplace_back(a, b, b + 1);
            mesh.triangles.emplace_back(a, b + 1, a + 1);
        }
    }
    return mesh;
}

Mesh make_lamp(const glm::vec3& position, const glm::vec3& target, float half, std::uint32_t material) {
    Mesh mesh = named_mesh("lamp");
    const glm::vec3 forward = glm::normalize(target - position);
    const glm::vec3 u = glm::normalize(glm::cross(glm::vec3(0.31f, 0.2f, 0.93f), forward));
    add_rectangle(mesh, position, half * u, half * glm::cross(forward, u), material);
    return mesh;
}

Material lambert(const char* name, const glm::vec3& albedo) {
    return make_material(name, MaterialKind::lambert, albedo);
}

Material metal(const char* name, const glm::vec3& reflectance, float roughness) {
    Material material = make_material(name, MaterialKind::metal, reflectance);
    material.roughness = roughness;
    return material;
}

Material mirror(const char* name, const glm::vec3& reflectance) {
    return make_material(name, MaterialKind::mirror, reflectance);
}

Material glass(const char* name, const glm::vec3& tint, float ior) {
    Material material = make_material(name, MaterialKind::glass, tint);
    material.ior = ior;
    material.roughness = 0.f;
    return material;
}

Material lamp(const char* name, const glm::vec3& radiance) {
    Material material = make_material(name, MaterialKind::lambert, glm::vec3(0.f));
    material.emission = radiance;
    return material;
}

}  // namespace claray::scenes
