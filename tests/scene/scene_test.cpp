// Bounds, cameras and validation.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

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

TEST(Bounds, HoldInstancesWhereTheyAreAndWhereTheyGo) {
    Scene scene = valid_scene();
    scene.meshes.push_back(triangle());
    MeshInstance instance;
    instance.mesh = 1;
    instance.transform[3] = glm::vec4(10, 0, 0, 1);
    scene.instances.push_back(instance);
    instance.transform[0] = glm::vec4(-2, 0, 0, 0);
    instance.transform_end = glm::mat4(1.f);
    (*instance.transform_end)[3] = glm::vec4(0, 5, 0, 1);
    scene.instances.push_back(instance);
    const Bounds bounds = bounds_of(scene);
    EXPECT_EQ(bounds.lo, glm::vec3(0, 0, 0));
    EXPECT_EQ(bounds.hi, glm::vec3(11, 6, 0));
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

TEST(Camera, OrthographicDataSpanTheImageItself) {
    Camera camera{{1, 2, 3}, {1, 2, -7}, {0, 5, 0}, 90.f};
    EXPECT_EQ(camera_data(camera, 2.f).projection, CLARAY_PERSPECTIVE);
    camera.projection = Projection::orthographic, camera.orthographic_height = 6.f;
    const CameraData data = camera_data(camera, 2.f);
    EXPECT_EQ(data.projection, CLARAY_ORTHOGRAPHIC);
    EXPECT_EQ(right(data), glm::vec3(6, 0, 0));
    EXPECT_EQ(up(data), glm::vec3(0, 3, 0));
    EXPECT_EQ(data.half_width, 6.f);
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
    for (const float height : {-1.f, 0.f, NAN, INFINITY})
        EXPECT_TRUE(refused([&](Camera& c) { c.orthographic_height = height; }, "orthographic height"));
    EXPECT_TRUE(refused([](Camera& c) { c.position_end = glm::vec3(NAN, 0, 0); }, "not finite"));
    EXPECT_TRUE(refused([](Camera& c) { c.target_end = glm::vec3(0, INFINITY, 0); }, "not finite"));
    EXPECT_TRUE(refused([](Camera& c) { c.position_end = glm::vec3(0, 0, -5); }, "reaches the target"));
    EXPECT_TRUE(
        refused([](Camera& c) { c.target_end = glm::vec3(0, 7, 5), c.target.y = -7; }, "parallel to the up vector"));
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

/// Of a scene: the largest places of its points in the image, to the right and upwards, -1 to 1.
Bounds places_in_image(const Camera& camera, float aspect, std::span<const glm::vec3> points) {
    const CameraData data = camera_data(camera, aspect);
    Bounds places;
    for (const glm::vec3& point : points) places.grow(glm::vec3(project(data, point), 0.f));
    return places;
}

/// Points of a ball, stretched.
Mesh stretched_ball(const glm::vec3& radii, const glm::vec3& middle) {
    Mesh mesh;
    for (int i = 0; i < 2000; ++i) {
        const float z = 1 - 2 * (float(i) + 0.5f) / 2000, angle = 2.39996323f * float(i), r = std::sqrt(1 - z * z);
        mesh.positions.push_back(middle + radii * glm::vec3(r * std::cos(angle), z, r * std::sin(angle)));
    }
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

TEST(AutomaticCamera, ASceneSpansMostOfTheImage) {
    for (const float aspect : {0.5f, 1.f, 16.f / 9.f})
        for (const glm::vec3 radii : {glm::vec3(1), glm::vec3(1, 5, 1), glm::vec3(4, 0.1f, 4), glm::vec3(1e-4f)}) {
            Scene scene;
            scene.meshes = {stretched_ball(radii, {7, 1, -3})};
            const auto expect_fit = [&](const char* what, std::span<const glm::vec3> points) {
                const Bounds places = places_in_image(camera_of(scene, aspect), aspect, points);
                const glm::vec3 half = 0.5f * places.extent();
                EXPECT_NEAR(std::max(half.x, half.y), 0.85f, 0.003f) << what;
                EXPECT_LT(std::max(half.x, half.y), 0.851f) << what;
                EXPECT_NEAR(half.x > half.y ? places.center().x : places.center().y, 0, 0.003f) << what;
            };
            expect_fit("mesh", scene.meshes[0].positions);
            std::vector<glm::vec3> points = scene.meshes[0].positions;
            for (glm::vec3& p : points) p = 2.f * p + glm::vec3(1, 2, 3);
            MeshInstance instance;
            instance.transform = glm::mat4(2.f);
            instance.transform[3] = {1, 2, 3, 1};
            scene.instances = {instance};
            expect_fit("instance", points);
            if (radii != glm::vec3(1)) continue;
            PrimitiveSet ball;
            ball.points = {{7, 1, -3, 1}};
            points = scene.meshes[0].positions;
            scene.meshes.clear(), scene.instances.clear();
            scene.primitives = {ball};
            expect_fit("sphere", points);
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
    scene.meshes[0].uvs1.resize(1);
    expect_invalid(scene, "1 second texture coordinates");
    scene = valid_scene();
    scene.meshes[0].tangents.resize(1);
    expect_invalid(scene, "1 tangents");
    scene = valid_scene();
    scene.meshes[0].materials = {0, 0};
    expect_invalid(scene, "2 materials for 1 triangles");
}

TEST(Validate, ChecksWhatVerticesCarry) {
    Scene scene = valid_scene();
    scene.meshes[0].uvs = {{0, 0}, {1, INFINITY}, {0, 1}};
    expect_invalid(scene, "vertex 1 of its texture coordinates is not finite");
    scene = valid_scene();
    scene.meshes[0].uvs1 = {{0, 0}, {1, 0}, {NAN, 1}};
    expect_invalid(scene, "vertex 2 of its second texture coordinates");
    scene = valid_scene();
    scene.meshes[0].tangents.resize(3, glm::vec4(1, 0, 0, NAN));
    expect_invalid(scene, "vertex 0 of its tangents");
}

TEST(Validate, ChecksMaterialIndices) {
    Scene scene = valid_scene();
    scene.meshes[0].materials = {1};
    expect_invalid(scene, "material 1 of 1");
    scene = valid_scene();
    scene.materials.clear();
    expect_invalid(scene, "material 0 of 0");
}

/// A valid scene that has one of everything, changed.
template <class Change>
Scene with(Change&& change) {
    Scene scene = valid_scene();
    Texture texture;
    texture.name = "wood";
    texture.width = 2, texture.height = 1, texture.channels = 3;
    texture.bytes = {1, 2, 3, 4, 5, 6};
    scene.textures = {texture};
    scene.materials[0].albedo_map.texture = 0;
    Light spot;
    spot.kind = LightKind::spot;
    scene.lights = {point_light({0, 0, 0}, {1, 1, 1}), spot};
    scene.instances = {MeshInstance{}};
    Texture sky;
    sky.width = sky.height = 2, sky.channels = 1;
    sky.format = TexelFormat::float32;
    sky.floats.assign(4, 1.f);
    scene.environment.images = {sky};
    scene.camera = Camera{};
    validate(scene);
    change(scene);
    return scene;
}

TEST(Validate, ChecksMaterialValues) {
    const auto expect = [](const std::string& word, auto change) {
        expect_invalid(with([&](Scene& s) { change(s.materials[0]); }), word);
    };
    expect("albedo is negative", [](Material& m) { m.albedo.y = -0.1f; });
    expect("emission", [](Material& m) { m.emission.z = NAN; });
    expect("roughness is not in 0..1", [](Material& m) { m.roughness = INFINITY; });
    expect("roughness", [](Material& m) { m.roughness = 1.5f; });
    expect("refraction", [](Material& m) { m.ior = 0.f; });
    expect("kind", [](Material& m) { m.kind = MaterialKind(6); });
    expect("metallic", [](Material& m) { m.metallic = -0.1f; });
    expect("transmission", [](Material& m) { m.transmission = 1.1f; });
    expect("clearcoat is", [](Material& m) { m.clearcoat = NAN; });
    expect("clearcoat roughness", [](Material& m) { m.clearcoat_roughness = 2.f; });
    expect("specular", [](Material& m) { m.specular.x = -1.f; });
    expect("specular weight", [](Material& m) { m.specular_weight = 1.5f; });
    expect("specular tint", [](Material& m) { m.specular_tint.y = -1.f; });
    expect("sheen colour", [](Material& m) { m.sheen.z = 2.f; });
    expect("sheen roughness", [](Material& m) { m.sheen_roughness = -1.f; });
    expect("anisotropy is", [](Material& m) { m.anisotropy = 1.1f; });
    expect("anisotropy rotation", [](Material& m) { m.anisotropy_rotation = INFINITY; });
    expect("iridescence is", [](Material& m) { m.iridescence = NAN; });
    expect("refraction of its iridescence", [](Material& m) { m.iridescence_ior = 0.f; });
    expect("film thickness", [](Material& m) { m.film_thickness.x = -1.f; });
    expect("clearcoat normal scale", [](Material& m) { m.clearcoat_normal_scale = NAN; });
    expect("kind", [](Material& m) { m.kind = MaterialKind(CLARAY_THIN_WALLS); });
    expect("shininess", [](Material& m) { m.shininess = -1.f; });
    expect("attenuation colour", [](Material& m) { m.attenuation.x = 1.5f; });
    expect("attenuation distance", [](Material& m) { m.attenuation_distance = -1.f; });
    expect("opacity", [](Material& m) { m.opacity = 1.5f; });
    expect("alpha mode", [](Material& m) { m.alpha_mode = AlphaMode(3); });
    expect("alpha cutoff", [](Material& m) { m.alpha_cutoff = -1.f; });
    expect("normal scale", [](Material& m) { m.normal_scale = NAN; });
    expect("height scale", [](Material& m) { m.height_scale = INFINITY; });
}

TEST(Validate, ChecksMaps) {
    TextureUse Material::*const maps[] = {
        &Material::albedo_map,          &Material::emission_map,         &Material::metallic_roughness_map,
        &Material::transmission_map,    &Material::clearcoat_map,        &Material::clearcoat_roughness_map,
        &Material::opacity_map,         &Material::normal_map,           &Material::height_map,
        &Material::light_map,           &Material::clearcoat_normal_map, &Material::specular_map,
        &Material::specular_weight_map, &Material::shininess_map,        &Material::sheen_map,
        &Material::sheen_roughness_map, &Material::anisotropy_map,       &Material::iridescence_map,
        &Material::film_thickness_map};
    for (const auto map : maps)
        expect_invalid(with([&](Scene& s) { (s.materials[0].*map).texture = 1; }), "map refers to texture 1 of 1");
    expect_invalid(with([](Scene& s) { s.materials[0].albedo_map.uv_set = 2; }), "texture coordinates 2");
    expect_invalid(with([](Scene& s) { s.materials[0].albedo_map.scale.x = NAN; }), "transform of its albedo map");
    expect_invalid(with([](Scene& s) { s.materials[0].albedo_map.rotation = INFINITY; }), "transform");
}

TEST(Validate, ChecksTextures) {
    const auto expect = [](const std::string& word, auto change) {
        expect_invalid(with([&](Scene& s) { change(s.textures[0]); }), word);
    };
    expect("texture 'wood': it has no texels", [](Texture& t) { t.width = 0; });
    expect("7 bytes for 2x1 texels of 3 channels", [](Texture& t) { t.bytes.push_back(0); });
    expect("0 floats", [](Texture& t) { t.format = TexelFormat::float32; });
    expect("5 channels", [](Texture& t) { t.channels = 5; });
    expect("wrap", [](Texture& t) { t.wrap_v = Wrap(3); });
    expect("texel format", [](Texture& t) { t.format = TexelFormat(3); });
    expect("texel (1, 0) is", [](Texture& t) {
        t.format = TexelFormat::float32;
        t.bytes.clear(), t.floats.assign(6, -1.f), t.floats[4] = NAN;
    });
}

TEST(Validate, ChecksLights) {
    const auto expect = [](const std::string& word, auto change) {
        expect_invalid(with([&](Scene& s) { change(s.lights[1]); }), word);
    };
    expect("light 1: its position", [](Light& l) { l.position.y = NAN; });
    expect("intensity", [](Light& l) { l.intensity.y = -1.f; });
    expect("range", [](Light& l) { l.range = NAN; });
    expect("attenuation", [](Light& l) { l.attenuation.x = -1.f; });
    expect("attenuation", [](Light& l) { l.attenuation = glm::vec3(0.f); });
    expect("direction", [](Light& l) { l.direction = glm::vec3(0.f); });
    expect("cone is from 57.296 to 45 degrees; use 0 <= inner <= outer <= 90 degrees",
           [](Light& l) { l.inner_angle = 1.f, l.outer_angle = std::numbers::pi_v<float> / 4; });
    expect("cone", [](Light& l) { l.inner_angle = 1.f; });
    expect("cone", [](Light& l) { l.outer_angle = 1.6f; });
    expect("light 'lamp': unknown kind", [](Light& l) { l.name = "lamp", l.kind = LightKind(99); });
    EXPECT_NO_THROW(validate(with([](Scene& s) { s.lights[0].direction = glm::vec3(0.f); }))) << "a point has none";
    expect_invalid(with([](Scene& s) { s.sky.zenith.x = -1.f; }), "sky");
}

TEST(Validate, ChecksInstances) {
    const auto expect = [](const std::string& word, auto change) {
        expect_invalid(with([&](Scene& s) { change(s.instances[0]); }), word);
    };
    expect("instance 0: it refers to mesh 1 of 1", [](MeshInstance& i) { i.mesh = 1; });
    expect("not finite", [](MeshInstance& i) { i.transform[3].x = NAN; });
    expect("not affine", [](MeshInstance& i) { i.transform[0].w = 0.1f; });
    expect("cannot be inverted", [](MeshInstance& i) { i.transform[1] = glm::vec4(0.f); });
    expect("cannot be inverted", [](MeshInstance& i) { i.transform[1] = 2.f * i.transform[0]; });
    expect("when the shutter closes cannot",
           [](MeshInstance& i) { i.transform_end = glm::mat4(0.f), (*i.transform_end)[3].w = 1.f; });
    EXPECT_NO_THROW(validate(with([](Scene& s) {
        for (int k = 0; k < 3; ++k) s.instances[0].transform[k] *= 1e-12f;
    }))) << "small is not flat";
}

TEST(Validate, ChecksEnvironment) {
    const auto expect = [](const std::string& word, auto change) {
        expect_invalid(with([&](Scene& s) { change(s.environment); }), word);
    };
    expect("strength", [](Environment& e) { e.strength = -1.f; });
    expect("rotation", [](Environment& e) { e.rotation = NAN; });
    expect("2 images", [](Environment& e) { e.images.push_back(e.images[0]); });
    expect("texel (1, 1) is -1", [](Environment& e) { e.images[0].floats[3] = -1.f; });
    expect("face 3 of its cube is 4x1", [](Environment& e) {
        e.images.resize(6, e.images[0]);
        e.images[3].width = 4, e.images[3].height = 1;
    });
    EXPECT_NO_THROW(validate(with([](Scene& s) { s.environment.images.resize(6, s.environment.images[0]); })));
    EXPECT_NO_THROW(validate(with([](Scene& s) { s.environment.images.clear(); })));
}

TEST(Validate, ChecksTheCamera) {
    expect_invalid(with([](Scene& s) { s.camera->aperture_radius = -1.f; }), "aperture");
    expect_invalid(with([](Scene& s) { s.camera->focus_distance = NAN; }), "focus");
    expect_invalid(with([](Scene& s) { s.camera->position_end = glm::vec3(NAN); }), "shutter");
    expect_invalid(with([](Scene& s) { s.camera->target_end = glm::vec3(INFINITY); }), "shutter");
}

}  // namespace
}  // namespace claray
