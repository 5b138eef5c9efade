// Lenses, motion and projections.
#include <array>

#include "host/effects/parts/part.hpp"
#include "host/scene/placement.hpp"

namespace claray {
namespace {

void move(Mesh& mesh, const glm::vec3& offset) {
    for (glm::vec3& p : mesh.positions) p += offset;
}

void show_depth_of_field(Scene& s) {
    move(s.meshes[scenes::ball_material], {-0.2f, 0.f, -2.f});
    move(s.meshes[scenes::block_material], {-0.6f, 0.f, 0.9f});
    s.camera->aperture_radius = 0.1f, s.camera->focus_distance = 3.4f;
}

void show_camera_motion(Scene& s) {
    s.camera->position_end = s.camera->position + glm::vec3(0.25f, 0.f, 0.f);
    s.camera->target_end = s.camera->target + glm::vec3(0.25f, 0.f, 0.f);
}

constexpr std::array camera_parts = {
    EffectPart{.effect = Effect::depth_of_field,
               .in_camera = [](const Camera& camera) { return camera.aperture_radius > 0; },
               .strip_camera = [](Camera& camera) { camera.aperture_radius = 0.f; },
               .show = show_depth_of_field},
    EffectPart{.effect = Effect::camera_motion,
               .in_camera = [](const Camera& camera) { return moves(camera); },
               .strip_camera = [](Camera& camera) { camera.position_end = camera.target_end = {}; },
               .show = show_camera_motion},
#define CLARAY_ROW(name, NAME, text, flat, parallel, stretch)                                                    \
    EffectPart{                                                                                                  \
        .effect = Effect::name,                                                                                  \
        .in_camera = [](const Camera& camera) { return camera.projection == Projection::name; },                 \
        .strip_camera = [](Camera& camera) { camera.projection = Projection::perspective; },                     \
        .show = [](Scene& s) { s.camera->projection = Projection::name, s.camera->orthographic_height = 3.2f; }, \
        .apart = true},
    CLARAY_OTHER_PROJECTIONS(CLARAY_ROW)
#undef CLARAY_ROW
        EffectPart{.effect = Effect::stereo,
                   .in_camera = [](const Camera& camera) { return camera.stereo != Stereo::none; },
                   .strip_camera = [](Camera& camera) { camera.stereo = Stereo::none; },
                   .show = [](Scene& s) { s.camera->stereo = Stereo::side_by_side, s.camera->eye_distance = 0.3f; },
                   .apart = true},
    EffectPart{.effect = Effect::lens_shift,
               .in_camera = [](const Camera& camera) { return camera.shift != glm::vec2(0.f); },
               .strip_camera = [](Camera& camera) { camera.shift = glm::vec2(0.f); },
               .show =
                   [](Scene& s) {
                       s.camera->shift = {0.1f, -0.2f};
                   },
               .apart = true},
    EffectPart{
        .effect = Effect::tilted_focus,
        .in_camera = [](const Camera& camera) { return camera.tilt != glm::vec2(0.f) && camera.aperture_radius > 0; },
        .strip_camera = [](Camera& camera) { camera.tilt = glm::vec2(0.f); },
        .show =
            [](Scene& s) {
                show_depth_of_field(s);
                s.camera->tilt = {30.f, 0.f};
            },
        .apart = true},
};

}  // namespace

std::span<const EffectPart> parts_of_cameras() { return camera_parts; }

}  // namespace claray
