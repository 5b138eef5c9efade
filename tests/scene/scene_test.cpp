// Bounds, cameras and validation.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "claray/error.hpp"
#include "claray/scene.hpp"

namespace claray {
namespace {

glm::vec3 position(const CameraData& c) { return {c.x, c.y, c.z}; }
glm::vec3 forward(const CameraData& c) { return {c.forward_x, c.forward_y, c.forward_z}; }
glm::vec3 right(const CameraData& c) { return {c.right_x, c.right_y, c.right_z}; }
glm::vec3 up(const CameraData& c) { return {c.up_x, c.up_y, c.up_z}; }

Mesh triangle() {
    Mesh mesh;
    mesh.name = "tri";
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}
Scene valid_scene() {
    Scene scene;
    scene.meshes = {triangle()};
    scene.materials = {Material{}};
    return scene;
}

TEST(Bounds, OfNothingAreEmpty) {
    EXPECT_TRUE(bounds_of(Mesh{}).empty());
    EXPECT_TRUE(bounds_of(Scene{}).empty());
}

TEST(Bounds, LeaveOutWhatIsNotFinite) {
    Scene scene = valid_scene();
    scene.meshes[0].positions = {{1, -2, 3}, {NAN, 100, 100}, {-INFINITY, 100, 100}, {-1, 5, 2}};
    scene.meshes.push_back(Mesh{});
    scene.meshes.push_back(triangle());
    const Bounds bounds = bounds_of(scene);
    EXPECT_EQ(bounds.lo, glm::vec3(-1, -2, 0));
    EXPECT_EQ(bounds.hi, glm::vec3(1, 5, 3));
    EXPECT_EQ(triangle_count(scene), 2u);
}

TEST(Camera, DataSpanTheImagePlane) {
    const Camera camera{{1, 2, 3}, {1, 2, -7}, {0, 5, 0}, 90.f};
    const CameraData data = camera_data(camera, 2.f);
    EXPECT_EQ(position(data), camera.position);
    EXPECT_EQ(forward(data), glm::vec3(0, 0, -1));
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(right(data)[k], k == 0 ? 2.f : 0.f, 1e-6f);  // tan 45 degrees * aspect
        EXPECT_NEAR(up(data)[k], k == 1 ? 1.f : 0.f, 1e-6f);
    }
}

TEST(Camera, LensAndMotionAreChecked) {
    const auto refused = [](auto&& damage, const std::string& what) {
        Camera camera;
        damage(camera);
        try {
            static_cast<void>(camera_data(camera, 1.f));
        } catch (const Error& error) {
            return error.kind() == ErrorKind::usage && std::string(error.what()).find(what) != std::string::npos;
        }
        return false;
    };
    EXPECT_TRUE(refused([](Camera& c) { c.aperture_radius = -1.f; }, "aperture"));
    EXPECT_TRUE(refused([](Camera& c) { c.aperture_radius = NAN; }, "aperture"));
    EXPECT_TRUE(refused([](Camera& c) { c.aperture_radius = INFINITY; }, "aperture"));
    EXPECT_TRUE(refused([](Camera& c) { c.focus_distance = -1.f; }, "focus distance"));
    EXPECT_TRUE(refused([](Camera& c) { c.focus_distance = NAN; }, "focus distance"));
    EXPECT_TRUE(refused([](Camera& c) { c.position_end = glm::vec3(NAN, 0, 0); }, "not finite"));
    EXPECT_TRUE(refused([](Camera& c) { c.target_end = glm::vec3(0, INFINITY, 0); }, "not finite"));
    EXPECT_TRUE(refused([](Camera& c) { c.position_end = glm::vec3(0, 0, -5); }, "meets the point"));
    EXPECT_TRUE(refused([](Camera& c) { c.target_end = glm::vec3(0, 7, 5), c.target.y = -7; }, "along its up"));
}

TEST(Camera, FocusesOnItsTargetUnlessTold) {
    Camera camera;
    EXPECT_EQ(camera_data(camera, 1.f).focus, 5.f);
    EXPECT_FALSE(moves(camera));
    camera.target_end = camera.target;
    EXPECT_FALSE(moves(camera));
    camera.target_end = glm::vec3(1, 0, 0);
    EXPECT_TRUE(moves(camera));
    EXPECT_EQ(camera_data(camera, 1.f).focus, 0.f);  // of every time anew
    camera.focus_distance = 2.5f;
    EXPECT_EQ(camera_data(camera, 1.f).focus, 2.5f);
}

TEST(Camera, DataAreAtRightAnglesFromAnywhere) {
    const CameraData data = camera_data(Camera{{1e6f, -3, 7}, {2, 5e5f, 1}, {0.3f, 1, -0.2f}, 33.f}, 1.5f);
    EXPECT_NEAR(glm::length(forward(data)), 1.f, 1e-6f);
    EXPECT_NEAR(glm::dot(forward(data), right(data)), 0.f, 1e-6f);
    EXPECT_NEAR(glm::dot(forward(data), up(data)), 0.f, 1e-6f);
    EXPECT_NEAR(glm::dot(up(data), right(data)), 0.f, 1e-6f);
    EXPECT_NEAR(glm::length(up(data)), std::tan(glm::radians(16.5f)), 1e-6f);
    EXPECT_NEAR(glm::length(right(data)) / glm::length(up(data)), 1.5f, 1e-5f);
    EXPECT_GT(glm::dot(glm::cross(right(data), up(data)), -forward(data)), 0.f) << "right-handed";
}

void expect_usage_error(const Camera& camera, float aspect = 1.f) {
    try {
        static_cast<void>(camera_data(camera, aspect));
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
    }
}

TEST(Camera, ThatCannotSeeIsRefused) {
    expect_usage_error(Camera{{1, 2, 3}, {1, 2, 3}, {0, 1, 0}, 40.f});
    expect_usage_error(Camera{{0, 5, 0}, {0, 0, 0}, {0, 1, 0}, 40.f});
    expect_usage_error(Camera{{0, 0, 5}, {0, 0, 0}, {0, 0, 0}, 40.f});
    for (const float angle : {0.f, -10.f, 180.f, NAN})
        expect_usage_error(Camera{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, angle});
    expect_usage_error(Camera{{NAN, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40.f});
    expect_usage_error(Camera{{0, 0, 5}, {0, 0, 0}, {0, INFINITY, 0}, 40.f});
    for (const float aspect : {0.f, -1.f, NAN, INFINITY}) expect_usage_error(Camera{}, aspect);
}

/// Image coordinates, -1..1 where visible.
glm::vec2 project(const CameraData& c, const glm::vec3& point) {
    const glm::vec3 view = point - position(c);
    const float depth = glm::dot(view, forward(c));
    return {glm::dot(view, right(c)) / glm::dot(right(c), right(c)) / depth,
            glm::dot(view, up(c)) / glm::dot(up(c), up(c)) / depth};
}

TEST(AutomaticCamera, JustFitsTheBoundingSphere) {
    for (const float aspect : {0.5f, 1.f, 16.f / 9.f}) {
        for (const float size : {1e-6f, 1.f, 1e9f}) {
            Bounds bounds;
            bounds.grow(size * glm::vec3(3, 4, 5));
            bounds.grow(size * glm::vec3(4, 6, 8));
            const Camera camera = automatic_camera(bounds, 50.f, aspect);
            EXPECT_EQ(camera.target, bounds.center());
            EXPECT_GT(camera.position.x, camera.target.x);
            EXPECT_GT(camera.position.y, camera.target.y);
            EXPECT_GT(camera.position.z, camera.target.z);
            // sin(narrower half angle) = radius / distance
            const float radius = 0.5f * glm::length(bounds.extent());
            const float half = std::atan(std::tan(glm::radians(25.f)) * std::min(aspect, 1.f));
            EXPECT_NEAR(radius / glm::length(camera.position - camera.target), std::sin(half), 1e-5f);
            const CameraData data = camera_data(camera, aspect);
            for (int corner = 0; corner < 8; ++corner) {
                const glm::vec3 pick(corner & 1, corner >> 1 & 1, corner >> 2);
                const glm::vec2 p = project(data, glm::mix(bounds.lo, bounds.hi, pick));
                EXPECT_LE(std::abs(p.x), 1.f);
                EXPECT_LE(std::abs(p.y), 1.f);
            }
        }
    }
}

TEST(AutomaticCamera, LooksAtWhatHasNoExtent) {
    for (const glm::vec3 point : {glm::vec3(0), glm::vec3(1, 2, 3), glm::vec3(1e9f)}) {
        Bounds bounds;
        bounds.grow(point);
        const Camera camera = automatic_camera(bounds);
        EXPECT_EQ(camera.target, point);
        EXPECT_NO_THROW(static_cast<void>(camera_data(camera, 1.f)));
    }
    const Camera camera = automatic_camera(Bounds{});
    EXPECT_NEAR(glm::length(camera.position - camera.target), 1.f, 1e-6f);
}

void expect_invalid(const Scene& scene, const std::string& word) {
    try {
        validate(scene);
        ADD_FAILURE() << "valid, but " << word << " is wrong";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::user);
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
}

TEST(Validate, TakesWhatIsSound) {
    EXPECT_NO_THROW(validate(Scene{}));
    EXPECT_NO_THROW(validate(valid_scene()));
    Scene scene = valid_scene();
    scene.meshes[0].positions[1].x = NAN;  // culled later, not an error
    EXPECT_NO_THROW(validate(scene));
}

TEST(Validate, NamesMeshAndTriangle) {
    Scene scene = valid_scene();
    scene.meshes[0].triangles.push_back({0, 3, 1});
    expect_invalid(scene, "mesh 'tri': triangle 1 refers to vertex 3 of 3");
    scene.meshes[0].name.clear();
    expect_invalid(scene, "mesh 0: triangle 1");
}

TEST(Validate, ChecksLengths) {
    Scene scene = valid_scene();
    scene.meshes[0].normals.resize(2);
    expect_invalid(scene, "2 normals for 3 vertices");
    scene = valid_scene();
    scene.meshes[0].uvs.resize(4);
    expect_invalid(scene, "4 texture coordinates");
    scene = valid_scene();
    scene.meshes[0].materials = {0, 0};
    expect_invalid(scene, "2 materials for 1 triangles");
}

TEST(Validate, ChecksMaterials) {
    Scene scene = valid_scene();
    scene.meshes[0].materials = {1};
    expect_invalid(scene, "material 1 of 1");
    scene = valid_scene();
    scene.materials.clear();
    expect_invalid(scene, "material 0 of 0");
    const auto with = [](auto change) {
        Scene changed = valid_scene();
        change(changed.materials[0]);
        return changed;
    };
    expect_invalid(with([](Material& m) { m.albedo.y = -0.1f; }), "albedo");
    expect_invalid(with([](Material& m) { m.emission.z = NAN; }), "emission");
    expect_invalid(with([](Material& m) { m.roughness = INFINITY; }), "roughness");
    expect_invalid(with([](Material& m) { m.ior = 0.f; }), "refraction");
    expect_invalid(with([](Material& m) { m.kind = MaterialKind(4); }), "kind");
}

TEST(Validate, ChecksLights) {
    Scene scene = valid_scene();
    scene.lights = {Light{}, point_light({0, NAN, 0}, {1, 1, 1})};
    expect_invalid(scene, "point light 1");
    scene.lights = {point_light({0, 0, 0}, {1, -1, 1})};
    expect_invalid(scene, "point light 0");
    scene = valid_scene();
    scene.sky.zenith.x = -1.f;
    expect_invalid(scene, "sky");
}

}  // namespace
}  // namespace claray
