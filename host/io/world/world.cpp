#include "host/io/world/world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "claray/error.hpp"
#include "host/io/image/image_file.hpp"
#include "host/io/scene_textures.hpp"
#include "host/io/world/shapes.hpp"
#include "host/scene/validate.hpp"

namespace claray {
namespace {

constexpr std::size_t most_surfaces = 1u << 24;  // meshes and instances

bool is_usable(const glm::dmat4& transform) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!(std::abs(transform[column][row]) < 1e30)) return false;
    return std::abs(glm::determinant(glm::dmat3(transform))) > 1e-30;
}

/// The factor by which a transform scales all lengths, if it does so equally.
std::optional<double> even_scale(const glm::dmat4& transform) {
    const glm::dmat3 squared = glm::transpose(glm::dmat3(transform)) * glm::dmat3(transform);
    const double scale2 = (squared[0][0] + squared[1][1] + squared[2][2]) / 3;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (std::abs(squared[i][j] - (i == j ? scale2 : 0)) > 1e-5 * scale2) return {};
    return std::sqrt(scale2);
}

glm::vec3 sound_radiance(const glm::vec3& radiance) {
    glm::vec3 sound(0.f);
    for (int k = 0; k < 3; ++k)
        if (std::isfinite(radiance[k])) sound[k] = std::max(radiance[k], 0.f);
    return sound;
}

/// Vertices have normals, coordinates and colours if all parts have them.
void append(Mesh& mesh, Mesh part) {
    part.materials.clear();
    if (mesh.positions.empty()) {
        mesh = std::move(part);
        return;
    }
    const auto first = std::uint32_t(mesh.positions.size());
    const auto join = [](auto& all, auto& more) {
        if (all.empty() || more.empty()) return all.clear();
        all.insert(all.end(), more.begin(), more.end());
    };
    join(mesh.positions, part.positions), join(mesh.normals, part.normals);
    join(mesh.uvs, part.uvs), join(mesh.colors, part.colors);
    for (const glm::uvec3& t : part.triangles) mesh.triangles.push_back(t + first);
}

bool transmits(const Material& m) { return m.transmission > 0.f || m.thin_walled || claray::transmits(m.kind); }

double degrees_of(double radians) { return radians * 180 / std::numbers::pi; }
double radians_of(double degrees) { return degrees * std::numbers::pi / 180; }

double vertical_fov(const View& view) {
    const double aspect = view.width / view.height, half = std::tan(radians_of(view.fov) / 2);
    double vertical = half;
    switch (view.fov_along) {
        case View::Along::height: break;
        case View::Along::width: vertical = half / aspect; break;
        case View::Along::shorter: vertical = aspect >= 1 ? half : half / aspect; break;
        case View::Along::longer: vertical = aspect >= 1 ? half / aspect : half; break;
        case View::Along::diagonal: vertical = half / std::sqrt(1 + aspect * aspect); break;
    }
    return degrees_of(2 * std::atan(vertical));
}

}  // namespace

/// The square of a line in the cosine has the mean 1/3.
void set_cone(Light& light, double inner, double outer, double share) {
    const double from = std::cos(inner), to = std::cos(outer);
    const double equal = 1.5 * (from - share * (from - to) - to / 3);
    light.outer_angle = float(outer);
    light.inner_angle = std::min(float(std::acos(std::clamp(equal, to, 1.0))), light.outer_angle);
}

World::World(const std::filesystem::path& path, Warnings& warnings)
    : path_(path), warnings_(warnings), paints_(path, scene_, warnings) {
    scene_.name = path.stem().string();
}

void World::warn(const std::string& text) {
    if (warned_.insert(text).second) warnings_.push_back("'" + path_.string() + "': " + text);
}

std::optional<Mesh> World::mesh_file(const std::string& name,
                                     const std::function<Mesh(const std::filesystem::path&)>& load) {
    const std::filesystem::path path = path_in_scene(path_.parent_path(), path_.parent_path(), name, path_);
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
        warnings_.push_back("'" + path_.string() + "': the mesh '" + path.string() + "' is missing and left out");
        return {};
    }
    Mesh mesh = load(path);
    if (mesh.name.empty()) mesh.name = path.stem().string();
    return mesh;
}

std::optional<Mesh> World::mesh_file(const std::string& name, LoadScene load) {
    return mesh_file(name, [load](const std::filesystem::path& path) {
        Warnings of_materials;  // which the scene's replace
        Mesh mesh;
        for (Mesh& part : load(path, of_materials, {}).meshes) append(mesh, std::move(part));
        mesh.name = path.stem().string();
        return mesh;
    });
}

std::size_t World::add_look(Look look) {
    looks_.push_back(std::move(look));
    return looks_.size() - 1;
}

void World::set_group(const std::string& name) { group_ = name.empty() ? nullptr : &groups_[name]; }

std::uint32_t World::add_material(Material material) {
    scene_.materials.push_back(std::move(material));
    return std::uint32_t(scene_.materials.size() - 1);
}

std::uint32_t World::material_of(std::size_t look) {
    const auto [found, is_new] = materials_.try_emplace(look, 0);
    if (is_new) {
        Material material = looks_[look].material;
        material.cull_back |= !looks_[look].both_sides && !transmits(material);
        found->second = add_material(std::move(material));
    }
    return found->second;
}

void World::add_part(Mesh mesh, std::uint32_t material) {
    if (scene_.meshes.size() + placed_.size() >= most_surfaces)
        throw Error(ErrorKind::user, "'" + path_.string() + "' has more than 16 million surfaces", "leave some out");
    mesh.materials.assign(mesh.triangles.size(), material);
    const auto number = std::uint32_t(scene_.meshes.size());
    scene_.meshes.push_back(std::move(mesh));
    group_ ? group_->push_back(number) : placed_.push_back({number, glm::mat4(1.f)});
}

/// What is behind a surface whose back is black.
void World::add_back(Mesh mesh) {
    turn_round(mesh);
    if (!black_back_) {
        Material black;
        black.name = "black back", black.albedo = glm::vec3(0.f), black.cull_back = true;
        black_back_ = add_material(black);
    }
    add_part(std::move(mesh), *black_back_);
}

/// A lamp that shines to one side is a pair of one-sided surfaces: the one that shines, and its back.
void World::add_lamp(Mesh mesh, const Look& look, const Glow& glow) {
    const Paint radiance = glow.radiance;
    Material front = look.material;
    if (look.invisible) front = Material(), front.albedo = glm::vec3(0.f);
    Material back = front;
    front.emission = sound_radiance(radiance.factor);
    front.emission_map = radiance.use;
    if (glow.both_sides || transmits(front)) return add_part(std::move(mesh), add_material(front));
    front.cull_back = back.cull_back = true;
    add_part(mesh, add_material(front));
    if (!look.both_sides) return add_back(std::move(mesh));
    turn_round(mesh);
    add_part(std::move(mesh), add_material(back));
}

void World::add(Mesh mesh, const glm::dmat4& to_world, std::size_t look, const std::optional<Glow>& glow) {
    if (mesh.triangles.empty() || (looks_[look].invisible && !glow)) return;
    if (!is_usable(to_world)) return warn("a shape whose transform is not invertible is left out");
    transform(mesh, to_world);
    face_normals(mesh);
    if (glow) return add_lamp(std::move(mesh), looks_[look], *glow);
    const bool one_sided = !looks_[look].both_sides && !transmits(looks_[look].material);
    add_part(mesh, material_of(look));
    if (one_sided) add_back(std::move(mesh));
}

void World::add_ball(const glm::dmat4& to_world, std::size_t look, const std::optional<Glow>& glow, bool turned) {
    const Look& of = looks_[look];
    if (of.invisible && !glow) return;
    const std::optional<double> radius = even_scale(to_world);
    const bool plain = of.material.alpha_mode == AlphaMode::opaque && may_be_on_primitives(of.material);
    if (!glow && !in_group() && plain && radius && is_usable(to_world) && !(turned && transmits(of.material))) {
        PrimitiveSet set;
        set.kind = PrimitiveSet::Kind::spheres;
        set.points.emplace_back(glm::vec3(to_world[3]), float(*radius));
        return add_primitives(std::move(set), look);
    }
    Mesh mesh =
        glow && !glow->radiance.varies() ? sphere_for_lamps() : sphere_part(2 * std::numbers::pi, 0, std::numbers::pi);
    if (turned) turn_round(mesh);
    add(std::move(mesh), to_world, look, glow);
}

void World::add_primitives(PrimitiveSet set, std::size_t look) {
    const Material& wanted = looks_[look].material;
    std::uint32_t material = 0;
    if (may_be_on_primitives(wanted) && wanted.alpha_mode == AlphaMode::opaque &&
        !(are_curves(set) && transmits(wanted))) {
        material = material_of(look);
    } else {
        warn("curves of images, holes or glass have one colour and are diffuse");
        Paint color(wanted.albedo);
        color.use = wanted.albedo_map;
        Material plain;
        plain.albedo = glm::clamp(paints_.mean(color), 0.f, 1.f);
        material = add_material(std::move(plain));
    }
    set.materials.assign(primitive_count(set), material);
    if (!scene_.primitives.empty() && scene_.primitives.back().kind == set.kind && !are_curves(set)) {
        PrimitiveSet& last = scene_.primitives.back();
        last.points.insert(last.points.end(), set.points.begin(), set.points.end());
        last.materials.insert(last.materials.end(), set.materials.begin(), set.materials.end());
        return;
    }
    scene_.primitives.push_back(std::move(set));
}

void World::place(const std::string& group, const glm::dmat4& to_world) {
    if (!is_usable(to_world)) return warn("an instance whose transform is not invertible is left out");
    const auto found = groups_.find(group);
    if (found == groups_.end()) return;
    if (placed_.size() + found->second.size() >= most_surfaces)
        throw Error(ErrorKind::user, "'" + path_.string() + "' has more than 16 million surfaces", "leave some out");
    for (const std::uint32_t mesh : found->second) placed_.push_back({mesh, glm::mat4(to_world)});
    has_placed_groups_ = true;
}

void World::add_surroundings(unsigned width, unsigned height, Radiance radiance) {
    around_width_ = std::max(around_width_, width), around_height_ = std::max(around_height_, height);
    around_.push_back(std::move(radiance));
}

/// A constant is a sky. Images are sampled anew, at four directions of each texel: longitude along the width with -z in
/// the middle, latitude along the height with +y on top, as Environment has them.
void World::add_sky() {
    const glm::vec3 constant = sound_radiance(sky_);
    if (around_.empty()) {
        scene_.sky.horizon = scene_.sky.zenith = constant;
        return;
    }
    const unsigned height = std::clamp(around_height_, 2u, largest_image_side / 2),
                   width = std::clamp(around_width_, 4u, largest_image_side);
    Texture image;
    image.name = "surroundings", image.width = width, image.height = height, image.channels = 3;
    image.format = TexelFormat::float32;
    image.floats.reserve(std::size_t(width) * height * 3);
    constexpr int steps = 2;
    for (unsigned y = 0; y < height; ++y) {
        for (unsigned x = 0; x < width; ++x) {
            glm::dvec3 sum(constant);
            for (int i = 0; i < steps * steps; ++i) {
                const double u = (x + (i % steps + 0.5) / steps) / width, v = (y + (i / steps + 0.5) / steps) / height;
                const double longitude = 2 * std::numbers::pi * (u - 0.5), polar = std::numbers::pi * v;
                const glm::dvec3 direction(std::sin(polar) * std::sin(longitude), std::cos(polar),
                                           -std::sin(polar) * std::cos(longitude));
                for (const Radiance& radiance : around_) sum += radiance(direction) / double(steps * steps);
            }
            const glm::vec3 sound = sound_radiance(glm::vec3(sum));
            for (int k = 0; k < 3; ++k) image.floats.push_back(sound[k]);
        }
    }
    scene_.environment.images = {std::move(image)};
}

void World::add_camera() {
    if (!view_) return;
    const View& view = *view_;
    const glm::dvec3 position(view.to_world[3]), forward(glm::normalize(glm::dvec3(view.to_world[2])));
    const Bounds bounds = bounds_of(scene_);
    const double to_center = bounds.empty() ? 1 : glm::dot(glm::dvec3(bounds.center()) - position, forward);
    Camera camera;
    camera.position = glm::vec3(position);
    // The target is at the height of the scene's middle, so that a view can be turned round it.
    camera.target = glm::vec3(position + forward * (to_center > 1e-3 * glm::length(bounds.extent()) ? to_center : 1.0));
    camera.up = glm::vec3(glm::normalize(glm::dvec3(view.to_world[1])));
    camera.projection = view.projection;
    camera.vertical_fov = float(std::clamp(vertical_fov(view), 0.01, 179.0));
    camera.orthographic_height = float(std::max(2 * view.half_height, 1e-6));
    camera.aperture_radius = float(std::max(view.lens_radius, 0.0));
    camera.focus_distance = float(std::max(view.focus_distance, 0.0));
    if (camera.focus_distance <= 0.f) camera.aperture_radius = 0.f;
    const bool finite =
        std::isfinite(glm::dot(camera.position, camera.target)) && std::isfinite(glm::length(camera.up));
    if (!finite || camera.position == camera.target)
        return warn("its camera is not usable, and the automatic view is shown");
    scene_.camera = camera;
}

Scene World::take() {
    if (scene_.meshes.empty() && scene_.primitives.empty())
        throw Error(ErrorKind::user, "'" + path_.string() + "' has no shape that claray can show", "add one");
    std::vector<bool> used(scene_.meshes.size(), false);
    for (const Placed& placed : placed_) used[placed.mesh] = true;
    const bool leaves_out = std::find(used.begin(), used.end(), false) != used.end();
    if (has_placed_groups_ || leaves_out)
        for (const Placed& placed : placed_) scene_.instances.push_back({placed.mesh, placed.transform, {}, {}});
    if (placed_.empty()) scene_.meshes.clear();
    if (scene_.materials.empty()) scene_.materials.push_back(grey_look().material);
    add_sky();
    add_camera();
    return std::move(scene_);
}

}  // namespace claray
