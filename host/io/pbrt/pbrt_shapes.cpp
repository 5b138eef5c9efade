// Shapes of pbrt-v4.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "claray/error.hpp"
#include "host/io/pbrt/pbrt_scene.hpp"
#include "host/io/scene_readers.hpp"
#include "host/io/words.hpp"
#include "host/io/world/shapes.hpp"

namespace claray {
namespace {

double most_phi(const PbrtParameters& p) {
    return std::clamp(p.number("phimax", 360), 0.0, 360.0) * std::numbers::pi / 180;
}

/// pbrt counts v from the bottom of an image.
void count_from_top(Mesh& mesh) {
    for (glm::vec2& uv : mesh.uvs) uv.y = 1.f - uv.y;
}

}  // namespace

void PbrtScene::add_shape() {
    const std::string kind = tokens_.next_text();
    const PbrtParameters p = parameters_of("shape");
    if (!in_world_) tokens_.refuse("a shape stands before WorldBegin", "move it behind");
    add_shape(kind, p);
}

void PbrtScene::add_shape(const std::string& kind, const PbrtParameters& p) {
    const double radius = p.number("radius", 1);
    if (kind == "trianglemesh") return add_mesh(triangle_mesh(p, 3), p);
    if (kind == "bilinearmesh") return add_mesh(triangle_mesh(p, 4), p);
    if (kind == "loopsubdiv") {
        world_.warn("subdivision surfaces 'loopsubdiv' are shown as smooth control meshes");
        Mesh mesh = triangle_mesh(p, 3);
        add_smooth_normals(mesh);
        return add_mesh(std::move(mesh), p);
    }
    if (kind == "plymesh") {
        if (p.find("displacement")) world_.warn("displacement of shapes is left out");
        if (std::optional<Mesh> mesh = world_.mesh_file(p.text("filename"), load_ply_without_light))
            add_mesh(*std::move(mesh), p);
        return;
    }
    if (kind == "sphere") return add_sphere(p);
    if (kind == "curve") return add_curve(p);
    Mesh mesh;
    glm::dmat4 local(1.0);
    if (kind == "disk") {
        mesh = disc_part(radius > 0 ? std::clamp(p.number("innerradius", 0) / radius, 0.0, 1.0) : 0, most_phi(p));
        local = glm::translate(local, {0, 0, p.number("height", 0)}) * glm::scale(glm::dmat4(1.0), {radius, radius, 1});
    } else if (kind == "cylinder") {
        const double low = p.number("zmin", -1), high = p.number("zmax", 1);
        mesh = tube_part(most_phi(p));
        local = glm::translate(local, {0, 0, std::min(low, high)}) *
                glm::scale(glm::dmat4(1.0), {radius, radius, std::abs(high - low)});
    } else {
        return world_.warn("shapes " + claray::quoted(kind) + " are left out");
    }
    count_from_top(mesh);
    transform(mesh, local);
    add_mesh(std::move(mesh), p);
}

void PbrtScene::add_mesh(Mesh mesh, const PbrtParameters& p) {
    face_normals(mesh);
    if (now_.reversed) turn_round(mesh);
    double area = 0;
    if (now_.lamp.on) {
        Mesh at_place = mesh;
        transform(at_place, now_.to_world);
        area = area_of(at_place);
    }
    world_.add(std::move(mesh), placed(), materials_.look_of(now_.material, p), glow(area));
}

void PbrtScene::add_sphere(const PbrtParameters& p) {
    const double radius = p.number("radius", 1);
    const double low = std::clamp(p.number("zmin", -radius), -radius, radius),
                 high = std::clamp(p.number("zmax", radius), -radius, radius);
    if (!(radius > 0)) return world_.warn("a sphere without a radius is left out");
    const glm::dmat4 local = glm::scale(glm::dmat4(1.0), glm::dvec3(radius));
    if (low <= -radius && high >= radius && most_phi(p) >= 2 * std::numbers::pi - 1e-6) {
        const double mean = std::cbrt(std::abs(glm::determinant(glm::dmat3(now_.to_world)))) * radius;
        return world_.add_ball(placed() * local, materials_.look_of(now_.material, p),
                               glow(4 * std::numbers::pi * mean * mean), now_.reversed);
    }
    Mesh part =
        sphere_part(most_phi(p), std::acos(std::max(low, high) / radius), std::acos(std::min(low, high) / radius));
    transform(part, local);
    add_mesh(std::move(part), p);
}

void PbrtScene::add_curve(const PbrtParameters& p) {
    const std::string type = p.text("type", "flat"), basis = p.text("basis", "bezier");
    const std::vector<glm::vec3> points = p.vectors("P");
    if (p.number("degree", 3) != 3) return world_.warn("curves of another degree than 3 are left out");
    if (world_.in_group()) return world_.warn("curves in objects are left out");
    const bool spline = basis == "bspline";
    const std::size_t step = spline ? 1 : 3;
    if (points.size() < 4 || (points.size() - 4) % step != 0)
        tokens_.refuse("a curve has " + std::to_string(points.size()) + " control points",
                       "give 4, or more by its basis");
    if (type == "ribbon") world_.warn("ribbons face the viewer: their normals are ignored");
    PrimitiveSet set;
    set.kind = type == "cylinder" ? (spline ? PrimitiveSet::Kind::curves : PrimitiveSet::Kind::bezier_curves)
                                  : (spline ? PrimitiveSet::Kind::flat_curves : PrimitiveSet::Kind::flat_bezier_curves);
    const double width = p.number("width", 1), first = p.number("width0", width), last = p.number("width1", width);
    const glm::dmat4 to_world = placed();
    const double scale = std::cbrt(std::abs(glm::determinant(glm::dmat3(to_world))));
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double t = double(i) / double(points.size() - 1);
        set.points.emplace_back(glm::vec3(to_world * glm::dvec4(glm::dvec3(points[i]), 1)),
                                float(scale * (first + t * (last - first)) / 2));
    }
    for (std::size_t i = 0; i + 4 <= points.size(); i += step) set.segments.push_back(std::uint32_t(i));
    world_.add_primitives(std::move(set), materials_.look_of(now_.material, p));
}

Mesh PbrtScene::triangle_mesh(const PbrtParameters& p, unsigned corners) {
    Mesh mesh;
    mesh.positions = p.vectors("P"), mesh.normals = p.vectors("N"), mesh.uvs = p.pairs("uv");
    if (mesh.uvs.empty()) mesh.uvs = p.pairs("st");
    const std::size_t count = mesh.positions.size();
    if (mesh.normals.size() != count) mesh.normals.clear();
    if (mesh.uvs.size() != count) mesh.uvs.clear();
    count_from_top(mesh);
    std::vector<double> indices = p.numbers("indices");
    if (indices.empty() && count == corners)
        for (unsigned i = 0; i < corners; ++i) indices.push_back(i);
    for (std::size_t i = 0; i + corners <= indices.size(); i += corners) {
        std::uint32_t at[4] = {};
        for (unsigned k = 0; k < corners; ++k) {
            const double index = indices[i + k];
            if (!(index >= 0 && index < double(count)))
                throw Error(ErrorKind::user,
                            p.place() + ": a triangle names a vertex that is none of " + std::to_string(count),
                            "check the indices");
            at[k] = std::uint32_t(index);
        }
        if (corners == 3) {
            mesh.triangles.emplace_back(at[0], at[1], at[2]);
        } else {  // a bilinear patch: its corners are (0, 0), (1, 0), (0, 1), (1, 1)
            mesh.triangles.emplace_back(at[0], at[1], at[3]);
            mesh.triangles.emplace_back(at[0], at[3], at[2]);
        }
    }
    return mesh;
}

}  // namespace claray
