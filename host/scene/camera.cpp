#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "claray/error.hpp"
#include "claray/scene.hpp"
#include "claray/shared/camera/lens.h"
#include "host/scene/camera.hpp"

namespace claray {
namespace {

bool finite_vector(const glm::vec3& v) { return !glm::any(glm::isnan(v)) && !glm::any(glm::isinf(v)); }

[[noreturn]] void refuse_camera(const char* what, const char* remedy) {
    throw Error(ErrorKind::usage, std::string("camera: ") + what, remedy);
}

/// From the front, about 24 degrees from the right and 16 degrees from above.
glm::dvec3 towards_camera() { return glm::normalize(glm::dvec3(0.45, 0.3, 1.0)); }

/// Calls `visit` with points in the world that span the scene, and with radii around them. Of many vertices a part.
template <class Visit>
void visit_points(const Scene& scene, const Visit& visit) {
    constexpr std::size_t enough = 2'000'000;
    const auto visit_mesh = [&](const Mesh& mesh, const glm::mat4& transform, std::size_t stride) {
        for (std::size_t i = 0; i < mesh.positions.size(); i += stride)
            visit(glm::dvec3(transform * glm::vec4(mesh.positions[i], 1.f)), 0.0);
    };
    std::size_t vertices = 0;
    const bool placed = !scene.instances.empty();
    for (const Mesh& mesh : scene.meshes) vertices += placed ? 0 : mesh.positions.size();
    const auto exists = [&](const MeshInstance& instance) { return instance.mesh < scene.meshes.size(); };
    for (const MeshInstance& instance : scene.instances)
        vertices += exists(instance) ? scene.meshes[instance.mesh].positions.size() : 0;
    const std::size_t stride = 1 + vertices / enough;
    for (const Mesh& mesh : scene.meshes)
        if (!placed) visit_mesh(mesh, glm::mat4(1.f), stride);
    for (const MeshInstance& instance : scene.instances)
        for (const glm::mat4& transform : {instance.transform, instance.transform_end.value_or(instance.transform)})
            if (exists(instance)) visit_mesh(scene.meshes[instance.mesh], transform, stride);
    for (const PrimitiveSet& set : scene.primitives) {
        const std::size_t step = set.kind == PrimitiveSet::Kind::discs ? 2 : 1;
        const bool cylinders = set.kind == PrimitiveSet::Kind::cylinders;  // of which the first end has the radius
        for (std::size_t i = 0; i < set.points.size(); i += step)
            visit(glm::dvec3(set.points[i]), double(set.points[cylinders ? i - i % 2 : i].w));
    }
}

/// What is in front of a camera, along one axis of the image: the two planes at its borders that touch the scene.
struct Span {
    double low = 1e300, high = -1e300;  // of x - k z and of x + k z, if the image ends at x = +-k depth

    void grow(double x, double z, double radius, double slope) {
        const double reach = radius * std::hypot(1.0, slope);
        high = std::max(high, x + slope * z + reach);
        low = std::min(low, x - slope * z - reach);
    }
    [[nodiscard]] double middle() const { return 0.5 * (low + high); }
    [[nodiscard]] double distance(double slope) const { return 0.5 * (high - low) / slope; }
};

}  // namespace

Camera automatic_camera(const Bounds& bounds, float vertical_fov, float aspect) {
    const glm::dvec3 center = bounds.empty() ? glm::dvec3(0.0) : glm::dvec3(bounds.center());
    const double radius = bounds.empty() ? 0.0 : 0.5 * glm::length(glm::dvec3(bounds.hi) - glm::dvec3(bounds.lo));

    // The sphere touches the frustum's narrower pair of planes at sin(half angle) = radius / distance.
    const double half_vertical = 0.5 * glm::radians(double(vertical_fov));
    const double half_horizontal = std::atan(std::tan(half_vertical) * aspect);
    double distance = radius / std::sin(std::min(half_vertical, half_horizontal));
    // Far from the origin the step back must not be lost in rounding.
    if (!(radius > 0.0)) distance = std::max(1.0, 1e-6 * glm::length(center));

    Camera camera;
    camera.position = glm::vec3(center + distance * towards_camera());
    camera.target = glm::vec3(center);
    camera.vertical_fov = vertical_fov;
    return camera;
}

Camera automatic_camera(const Scene& scene, float vertical_fov, float aspect) {
    constexpr double share = 0.85;
    const Bounds bounds = bounds_of(scene);
    Camera camera = automatic_camera(bounds, vertical_fov, aspect);
    if (bounds.empty() || bounds.extent() == glm::vec3(0.f)) return camera;

    const glm::dvec3 center(bounds.center()), back = towards_camera();
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(camera.up), back)), up = glm::cross(back, right);
    const double slope_up = share * std::tan(0.5 * glm::radians(double(vertical_fov))), slope_right = slope_up * aspect;
    Span across, upwards;
    visit_points(scene, [&](const glm::dvec3& point, double radius) {
        const glm::dvec3 p = point - center;
        const double x = glm::dot(p, right), y = glm::dot(p, up), z = glm::dot(p, back);
        if (!std::isfinite(x + y + z + radius)) return;
        across.grow(x, z, radius, slope_right);
        upwards.grow(y, z, radius, slope_up);
    });
    const double distance = std::max(across.distance(slope_right), upwards.distance(slope_up));
    if (!(distance > 0)) return camera;
    const glm::dvec3 target = center + across.middle() * right + upwards.middle() * up;
    camera.position = glm::vec3(target + distance * back);
    camera.target = glm::vec3(target);
    return camera;
}

Camera camera_of(const Scene& scene, float aspect) {
    return scene.camera ? *scene.camera : automatic_camera(scene, 40.f, aspect);
}

Camera orbited(const Camera& camera, float degrees) {
    const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), glm::radians(double(degrees)), glm::dvec3(camera.up)));
    const auto turned = [&](const glm::vec3& point, const glm::vec3& center) {
        return glm::vec3(glm::dvec3(center) + turn * (glm::dvec3(point) - glm::dvec3(center)));
    };
    Camera result = camera;
    result.position = turned(camera.position, camera.target);
    if (camera.position_end) result.position_end = turned(*camera.position_end, camera.target);
    if (camera.target_end) result.target_end = turned(*camera.target_end, camera.target);
    return result;
}

namespace {

/// The t between 0 and 1 for which the vector a + t b is shortest.
double nearest_to_zero(const glm::dvec3& a, const glm::dvec3& b) {
    const double length2 = glm::dot(b, b);
    return length2 > 0 ? std::clamp(-glm::dot(a, b) / length2, 0.0, 1.0) : 0.0;
}

void check_view(const glm::dvec3& view, const glm::dvec3& change, const glm::dvec3& up) {
    const bool moves = change != glm::dvec3(0.0);
    if (!(glm::length(view + nearest_to_zero(view, change) * change) > 0.0))
        refuse_camera(moves ? "during its motion the position reaches the target" : "its position is its target",
                      "move the position or the target");
    const glm::dvec3 sideways = glm::cross(view, up), sideways_change = glm::cross(change, up);
    const double t = nearest_to_zero(sideways, sideways_change);
    if (!(glm::length(sideways + t * sideways_change) > 1e-6 * glm::length(up) * glm::length(view + t * change)))
        refuse_camera(moves ? "during its motion the view becomes parallel to the up vector"
                            : "its view is parallel to the up vector",
                      "choose another up vector, for example 0,0,1");
}

bool is_fisheye(Projection projection) {
    return projection == Projection::fisheye || projection == Projection::equisolid;
}

void check_projection(const Camera& camera) {
    const ProjectionTraits* traits = traits_of(camera.projection);
    if (!traits) refuse_camera("its projection is unknown", "use a Projection");
    if (!(camera.orthographic_height > 0.f) || std::isinf(camera.orthographic_height))
        refuse_camera("the orthographic height is not positive and finite", "give the height of the image");
    if (!traits->flat && camera.aperture_radius > 0.f)
        refuse_camera("it has a lens, but its image is no plane", "use an aperture of 0");
    const bool circular = is_fisheye(camera.projection);
    if (circular && !(camera.vertical_fov > 0.f && camera.vertical_fov <= 360.f))
        refuse_camera("the field of view of its fisheye is not between 0 and 360 degrees", "use for example 180");
    if (!circular && !(camera.vertical_fov > 0.f && camera.vertical_fov < 180.f))
        refuse_camera("the field of view is not between 0 and 180 degrees", "use for example 40");
}

void check_lens(const Camera& camera) {
    if (!(camera.aperture_radius >= 0.f) || std::isinf(camera.aperture_radius))
        refuse_camera("the aperture is negative or not finite", "give the radius of the lens, or 0 for a pinhole");
    if (!(camera.focus_distance >= 0.f) || std::isinf(camera.focus_distance))
        refuse_camera("the focus distance is negative or not finite", "give the distance of the sharp plane");
}

void check_lens_numbers(const Camera& camera) {
    const auto all_finite = [](const glm::vec2& v) { return std::isfinite(v.x) && std::isfinite(v.y); };
    if (!all_finite(camera.shift) || !all_finite(camera.tilt) || !std::isfinite(camera.eye_distance))
        refuse_camera("its shift, tilt or distance of eyes is not finite", "give finite numbers");
    if (camera.stereo > Stereo::top_bottom) refuse_camera("its stereo layout is unknown", "use a Stereo");
    const bool shifted = camera.shift != glm::vec2(0.f), tilted = camera.tilt != glm::vec2(0.f);
    if (!shifted && !tilted && camera.stereo == Stereo::none) return;
    if (moves(camera)) refuse_camera("it moves, and has a shift, a tilt or two eyes", "leave one of them out");
    if (shifted && camera.projection != Projection::perspective)
        refuse_camera("it has a shift, but is not perspective", "use a shift of 0");
    if (std::abs(camera.tilt.x) >= 90.f || std::abs(camera.tilt.y) >= 90.f)
        refuse_camera("its tilt is not below 90 degrees", "use for example 5");
    const bool flat = traits_of(camera.projection)->flat;
    if (tilted && !flat) refuse_camera("it has a tilt, but its image is no plane", "use a tilt of 0");
    if (camera.stereo != Stereo::none && !flat && camera.projection != Projection::panorama)
        refuse_camera("it has two eyes, but is neither flat nor a panorama", "use another projection");
}

/// Degrees to half the image's height over `up`.
double half_height_of(const Camera& camera) {
    const double angle = glm::radians(double(camera.vertical_fov));
    switch (camera.projection) {
        case Projection::perspective: return std::tan(0.5 * angle);
        case Projection::orthographic: return 0.5 * double(camera.orthographic_height);
        case Projection::fisheye: return 0.5 * angle;
        case Projection::equisolid: return 2 * std::sin(0.25 * angle);
        default: return 1.0;
    }
}

/// Of one eye's image.
double aspect_of_eye(const Camera& camera, double aspect) {
    if (camera.stereo == Stereo::side_by_side) return aspect / 2;
    return camera.stereo == Stereo::top_bottom ? 2 * aspect : aspect;
}

/// Puts the numbers of claray/shared/camera/lens.h into a camera that does not move.
void add_lens(const Camera& camera, double distance, CameraData& data) {
    const bool shifted = camera.shift != glm::vec2(0.f), tilted = camera.tilt != glm::vec2(0.f);
    if (camera.stereo == Stereo::none && !shifted && !tilted) return;
    if (shifted) data.projection |= CLARAY_SHIFTED;
    if (tilted) data.projection |= CLARAY_TILTED;
    if (camera.stereo == Stereo::side_by_side) data.projection |= CLARAY_SIDE_BY_SIDE;
    if (camera.stereo == Stereo::top_bottom) data.projection |= CLARAY_TOP_BOTTOM;
    data.CLARAY_LENS_SHIFT_X = 2 * camera.shift.x, data.CLARAY_LENS_SHIFT_Y = 2 * camera.shift.y;
    data.CLARAY_LENS_EYE = 0.5f * camera.eye_distance;
    data.CLARAY_LENS_NEARNESS = float(1 / distance);
    data.CLARAY_LENS_TILT_X = std::tan(glm::radians(-camera.tilt.y));
    data.CLARAY_LENS_TILT_Y = std::tan(glm::radians(-camera.tilt.x));
}

}  // namespace

bool moves(const Camera& camera) {
    return camera.position_end.value_or(camera.position) != camera.position ||
           camera.target_end.value_or(camera.target) != camera.target;
}

CameraData camera_data(const Camera& camera, float aspect) {
    const glm::vec3 position_end = camera.position_end.value_or(camera.position);
    const glm::vec3 target_end = camera.target_end.value_or(camera.target);
    if (!finite_vector(camera.position) || !finite_vector(camera.target) || !finite_vector(camera.up) ||
        !finite_vector(position_end) || !finite_vector(target_end))
        refuse_camera("a coordinate is not finite", "give three numbers for each of position, target and up");
    check_projection(camera);
    if (!(aspect > 0.f) || std::isinf(aspect))
        refuse_camera("the aspect ratio is not positive", "use a size of at least 1x1");
    check_lens(camera);
    check_lens_numbers(camera);

    const glm::dvec3 view = glm::dvec3(camera.target) - glm::dvec3(camera.position);
    const glm::dvec3 move = glm::dvec3(position_end) - glm::dvec3(camera.position);
    const glm::dvec3 view_move = glm::dvec3(target_end) - glm::dvec3(position_end) - view;
    check_view(view, view_move, camera.up);
    const double distance = glm::length(view);
    const glm::dvec3 forward = view / distance;
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(camera.up)));

    const bool keeps_aspect = traits_of(camera.projection)->flat || is_fisheye(camera.projection);
    const double half_height = half_height_of(camera);
    const double half_width = keeps_aspect ? half_height * aspect_of_eye(camera, aspect) : half_height;
    const glm::vec3 f(forward), r(right * half_width), u(glm::cross(right, forward) * half_height);
    const glm::vec3 m(move), v(view), w(view_move), a(glm::normalize(glm::dvec3(camera.up)));
    const glm::vec3& p = camera.position;
    const bool follows_target = camera.focus_distance == 0.f;
    const float lens = camera.aperture_radius;
    const float focus = !follows_target ? camera.focus_distance : moves(camera) ? 0.f : float(distance);
    const auto width = float(half_width), height = float(half_height);
    const auto projection = std::uint32_t(camera.projection);
    CameraData data{p.x, p.y, p.z, f.x, f.y, f.z, r.x, r.y, r.z, u.x, u.y, u.z,   lens,   focus,     m.x,
                    m.y, m.z, v.x, v.y, v.z, w.x, w.y, w.z, a.x, a.y, a.z, width, height, projection};
    add_lens(camera, distance, data);
    return data;
}

CameraRay camera_ray(const CameraData& c, double x, double y) {
    const glm::dvec3 right(c.right_x, c.right_y, c.right_z), up(c.up_x, c.up_y, c.up_z);
    const glm::dvec3 forward(c.forward_x, c.forward_y, c.forward_z), position(c.x, c.y, c.z);
    const auto [ray, from_forward] = aim_lens(c, x, y);
    return {position + (ray.from_right * right + ray.from_up * up + from_forward * forward),
            ray.forward * forward + (ray.right * right + ray.up * up)};
}

}  // namespace claray
