#include "host/io/world/shapes.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "host/scene/builtin/shapes.hpp"

namespace claray {
namespace {

constexpr double pi = std::numbers::pi;
constexpr unsigned round_columns = 128;

glm::dvec3 normal_of(const Mesh& mesh, const glm::uvec3& t) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    return glm::cross(b - a, c - a);
}

glm::vec3 unit_or(const glm::dvec3& v, const glm::vec3& otherwise) {
    const double length = glm::length(v);
    return std::isfinite(length) && length > 0 ? glm::vec3(v / length) : otherwise;
}

}  // namespace

Mesh mesh_of_surface(unsigned columns, unsigned rows, const std::function<SurfacePoint(double, double)>& at) {
    Mesh mesh;
    for (unsigned row = 0; row <= rows; ++row) {
        for (unsigned column = 0; column <= columns; ++column) {
            const double u = double(column) / columns, v = double(row) / rows;
            const SurfacePoint point = at(u, v);
            mesh.positions.emplace_back(point.position);
            mesh.normals.emplace_back(point.normal);
            mesh.uvs.emplace_back(u, v);
        }
    }
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (mesh.positions[a] != mesh.positions[b] && mesh.positions[b] != mesh.positions[c] &&
            mesh.positions[c] != mesh.positions[a])  // at a pole, a cell is one triangle
            mesh.triangles.emplace_back(a, b, c);
    };
    for (unsigned row = 0; row < rows; ++row) {
        for (unsigned column = 0; column < columns; ++column) {
            const std::uint32_t a = row * (columns + 1) + column, b = a + 1, c = a + columns + 1, d = c + 1;
            add(a, b, d);
            add(a, d, c);
        }
    }
    face_normals(mesh);
    return mesh;
}

Mesh sphere_part(double most_phi, double from_theta, double to_theta) {
    return mesh_of_surface(round_columns, round_columns / 2, [&](double u, double v) {
        const double phi = u * most_phi, theta = from_theta + v * (to_theta - from_theta);
        const bool pole = std::abs(std::sin(theta)) < 1e-9, closed = u == 1 && most_phi >= 2 * pi;
        const double sine = pole ? 0 : std::sin(theta), angle = closed ? 0 : phi;
        const glm::dvec3 n(sine * std::cos(angle), sine * std::sin(angle),
                           pole ? std::round(std::cos(theta)) : std::cos(theta));
        return SurfacePoint{n, n};
    });
}

Mesh sphere_for_lamps() {
    Mesh mesh = scenes::make_sphere(glm::vec3(0.f), 1.f, 3, 0);
    const auto scale = float(std::sqrt(4 * pi / area_of(mesh)));
    for (glm::vec3& p : mesh.positions) p *= scale;
    mesh.materials.clear();
    return mesh;
}

Mesh disc_part(double hole_radius, double most_phi) {
    return mesh_of_surface(round_columns, 1, [&](double u, double v) {
        const double radius = 1 - v * (1 - hole_radius);
        return SurfacePoint{{radius * std::cos(u * most_phi), radius * std::sin(u * most_phi), 0}, {0, 0, 1}};
    });
}

Mesh tube_part(double most_phi) {
    return mesh_of_surface(round_columns, 1, [&](double u, double v) {
        const glm::dvec3 n(std::cos(u * most_phi), std::sin(u * most_phi), 0);
        return SurfacePoint{n + glm::dvec3(0, 0, v), n};
    });
}

Mesh square() {
    return mesh_of_surface(1, 1, [](double u, double v) { return SurfacePoint{{2 * u - 1, 2 * v - 1, 0}, {0, 0, 1}}; });
}

Mesh cube() {
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            Mesh face = square();
            const auto first = std::uint32_t(mesh.positions.size());
            for (std::size_t i = 0; i < face.positions.size(); ++i) {
                const glm::vec3 p = face.positions[i];
                glm::vec3 position, normal(0.f);
                position[axis] = normal[axis] = float(side);
                position[(axis + 1) % 3] = p.x * float(side), position[(axis + 2) % 3] = p.y;
                mesh.positions.push_back(position), mesh.normals.push_back(normal), mesh.uvs.push_back(face.uvs[i]);
            }
            for (const glm::uvec3& t : face.triangles) mesh.triangles.push_back(t + first);
        }
    }
    face_normals(mesh);
    return mesh;
}

void transform(Mesh& mesh, const glm::dmat4& to_world) {
    const glm::dmat3 linear(to_world), normals = glm::transpose(glm::inverse(linear));
    for (glm::vec3& p : mesh.positions) p = glm::vec3(glm::dvec3(to_world * glm::dvec4(glm::dvec3(p), 1.0)));
    for (glm::vec3& n : mesh.normals) n = unit_or(normals * glm::dvec3(n), {0.f, 0.f, 1.f});
    if (glm::determinant(linear) >= 0) return;
    for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
}

void turn_round(Mesh& mesh) {
    for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
    for (glm::vec3& n : mesh.normals) n = -n;
}

void face_normals(Mesh& mesh) {
    if (mesh.normals.empty()) return;
    for (glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 sum =
            glm::dvec3(mesh.normals[t.x]) + glm::dvec3(mesh.normals[t.y]) + glm::dvec3(mesh.normals[t.z]);
        if (glm::dot(normal_of(mesh, t), sum) < 0) std::swap(t.y, t.z);
    }
}

void add_smooth_normals(Mesh& mesh) {
    std::map<std::tuple<float, float, float>, glm::dvec3> sums;
    const auto key = [&](std::uint32_t i) {
        const glm::vec3& p = mesh.positions[i];
        return std::tuple(p.x, p.y, p.z);
    };
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 normal = normal_of(mesh, t);
        const double length = glm::length(normal);
        if (!(std::isfinite(length) && length > 0)) continue;
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 here(mesh.positions[t[k]]);
            const glm::dvec3 a = glm::dvec3(mesh.positions[t[(k + 1) % 3]]) - here,
                             b = glm::dvec3(mesh.positions[t[(k + 2) % 3]]) - here;
            sums[key(t[k])] += normal / length * std::atan2(length, glm::dot(a, b));
        }
    }
    mesh.normals.resize(mesh.positions.size());
    for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) {
        const auto found = sums.find(key(i));
        mesh.normals[i] = unit_or(found == sums.end() ? glm::dvec3(0.0) : found->second, {0.f, 0.f, 1.f});
    }
}

double area_of(const Mesh& mesh) {
    double area = 0;
    for (const glm::uvec3& t : mesh.triangles) area += glm::length(normal_of(mesh, t)) / 2;
    return area;
}

}  // namespace claray
