// pbrt-v4's scene files: what becomes of each statement, and every way in which a file can be bad.
#include <cmath>
#include <numbers>

#include "host/io/scene_readers.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/io/world/spot_power.hpp"

namespace claray {
namespace {

using test::expect_error;
using test::power_between;
using test::power_of_spot;

const std::string triangle = "Shape \"trianglemesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0] \"integer indices\" [0 1 2]\n";

class Pbrt : public test::ReaderTest {
protected:
    Scene load(const std::string& text) { return load_text("scene.pbrt", text); }
    Scene world(const std::string& text) { return load("WorldBegin\nLightSource \"infinite\"\n" + text); }
    Material material(const std::string& text) { return world(text + triangle).materials.at(0); }
    void refuses(const std::string& text, const std::vector<std::string>& words) {
        expect_error(ErrorKind::user, words, [&] { (void)load(text); });
    }
};

TEST_F(Pbrt, CameraOfLookAtMirrorsTheWorld) {
    const Scene scene = load(
        "LookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 60\n"
        "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 400\nWorldBegin\n"
        "LightSource \"infinite\"\nTranslate 2 0 0\n" +
        triangle);
    ASSERT_TRUE(scene.camera);
    EXPECT_EQ(scene.camera->position, glm::vec3(0, 0, 5));
    EXPECT_NEAR(scene.camera->vertical_fov, 2 * std::atan(2 * std::tan(std::numbers::pi / 6)) * 180 / std::numbers::pi,
                1e-4);
    // pbrt's x is to the right here, looking along -z; in claray, too, once x is mirrored twice.
    EXPECT_EQ(bounds_of(scene).lo.x, -3.f);
    EXPECT_EQ(scene.environment.images.size(), 0u);
    EXPECT_EQ(scene.sky.horizon, glm::vec3(1.f));
}

/// pbrt-v4: the picture is multiplied by the seconds of the exposure and by ISO / 100.
TEST_F(Pbrt, Film) {
    const auto film = [&](const std::string& text) {
        return film_of(folder.file("film.pbrt", text + "\nWorldBegin\nFilm \"rgb\" \"integer xresolution\" 7\n"));
    };
    EXPECT_FALSE(film("Camera \"perspective\" \"float shutterclose\" 8"));
    const auto plain = film("Film \"rgb\" \"integer yresolution\" [300]").value();
    EXPECT_EQ(glm::uvec2(plain.width, plain.height), glm::uvec2(1280, 300));
    EXPECT_FALSE(plain.is_part() || plain.exposure);
    const std::string small = "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 50 ";
    const auto crop = [&](const std::string& text) {
        const SceneFilm part = film(small + text).value();
        return glm::uvec4(part.x, part.y, part.part_width, part.part_height);
    };
    EXPECT_EQ(crop("\"float cropwindow\" [0.125 0.5 0 0.1]"), glm::uvec4(13, 0, 37, 5));  // edges are rounded up
    EXPECT_EQ(crop("\"float cropwindow\" [0 1 -1 2]"), glm::uvec4(0));                    // all of it
    EXPECT_EQ(crop("\"integer pixelbounds\" [10 200 20 30]"), glm::uvec4(10, 20, 90, 10));
    expect_error(ErrorKind::user, {"film.pbrt", "line 1", "no pixel"},
                 [&] { (void)film(small + "\"float cropwindow\" [.5 .5 0 1]"); });
    folder.file("camera.pbrt", "Camera \"perspective\" \"float shutteropen\" 1 \"float shutterclose\" 1.5");
    EXPECT_FLOAT_EQ(film("Include \"camera.pbrt\"\n" + small + "\"float iso\" 1600")->exposure.value(), 3.f);
}

TEST_F(Pbrt, CameraOfAMirroringTransformLeavesTheWorld) {
    const Scene scene = load(
        "Scale -1 1 1\nLookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\n"
        "LightSource \"infinite\"\nTranslate 2 0 0\n" +
        triangle);
    EXPECT_EQ(bounds_of(scene).hi.x, 3.f);
}

TEST_F(Pbrt, BlocksAndTransforms) {
    const Scene scene = world(
        "AttributeBegin\nTranslate 1 2 3\nScale 2 2 2\nCoordinateSystem \"here\"\nAttributeEnd\n"
        "CoordSysTransform \"here\"\n" +
        triangle + "Transform [1 0 0 0 0 1 0 0 0 0 1 0 7 0 0 1]\nRotate 90 0 0 1\n" + triangle);
    EXPECT_EQ(scene.meshes.at(0).positions.at(1), glm::vec3(3, 2, 3));
    EXPECT_NEAR(glm::length(scene.meshes.at(1).positions.at(1) - glm::vec3(7, 1, 0)), 0, 1e-6);
}

TEST_F(Pbrt, ObjectsArePlaced) {
    const Scene scene =
        world("ObjectBegin \"tree\"\nTranslate 0 0 1\n" + triangle +
              "ObjectEnd\nTranslate 5 0 0\nObjectInstance \"tree\"\nTranslate 5 0 0\nObjectInstance \"tree\"\n");
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[1].transform[3], glm::vec4(10, 0, 0, 1));
    EXPECT_EQ(bounds_of(scene).hi, glm::vec3(11, 1, 1));
}

TEST_F(Pbrt, LampsShineToOneSide) {
    const Scene one = world("AreaLightSource \"diffuse\" \"rgb L\" [3 2 1] \"float scale\" 2\n" + triangle);
    ASSERT_EQ(one.meshes.size(), 2u);  // the lamp and its back
    EXPECT_EQ(one.materials.at(one.meshes[0].materials[0]).emission, glm::vec3(6, 4, 2));
    EXPECT_EQ(one.materials.at(one.meshes[1].materials[0]).emission, glm::vec3(0));
    EXPECT_TRUE(one.materials[0].cull_back && one.materials[1].cull_back);
    const Scene both = world("AreaLightSource \"diffuse\" \"bool twosided\" true\n" + triangle);
    EXPECT_EQ(both.meshes.size(), 1u);
    // 10 W from 1/2 unit of area: 10 / (pi / 2).
    const Scene power = world("AreaLightSource \"diffuse\" \"float power\" 10\n" + triangle);
    EXPECT_NEAR(power.materials.at(power.meshes[0].materials[0]).emission.x, 20 / std::numbers::pi, 1e-5);
    const Scene reversed =
        world("AttributeBegin ReverseOrientation AreaLightSource \"diffuse\"\n" + triangle + "AttributeEnd\n");
    EXPECT_EQ(reversed.meshes[0].triangles.at(0), glm::uvec3(0, 2, 1));
}

TEST_F(Pbrt, Lights) {
    const Scene scene = world(
        "LightSource \"point\" \"point3 from\" [1 2 3] \"rgb I\" [1 2 3] \"float scale\" 2\n"
        "LightSource \"spot\" \"point3 to\" [0 -2 0] \"float coneangle\" 40 \"float conedeltaangle\" 10\n"
        "LightSource \"distant\" \"blackbody L\" 5000 \"float illuminance\" 3\n" +
        triangle);
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].intensity, glm::vec3(2, 4, 6));
    EXPECT_EQ(scene.lights[0].position, glm::vec3(1, 2, 3));
    EXPECT_EQ(scene.lights[1].direction, glm::vec3(0, -1, 0));
    EXPECT_NEAR(scene.lights[1].outer_angle, 40 * std::numbers::pi / 180, 1e-6);
    const double inner = std::cos(30 * std::numbers::pi / 180), outer = scene.lights[1].outer_angle;
    const auto smooth_step = [&](double angle) {
        const double t = std::min(1.0, (std::cos(angle) - std::cos(outer)) / (inner - std::cos(outer)));
        return t * t * (3 - 2 * t);
    };
    EXPECT_NEAR(power_of_spot(scene.lights[1]), power_between(outer, smooth_step), 1e-5);
    const glm::vec3 warm = scene.lights[2].intensity;
    EXPECT_NEAR(0.2126f * warm.x + 0.7152f * warm.y + 0.0722f * warm.z, 3.f, 0.01f);
    EXPECT_GT(warm.x, warm.z);
}

TEST_F(Pbrt, Materials) {
    const Material diffuse = material("Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3]\n");
    EXPECT_EQ(int(diffuse.kind), int(MaterialKind::lambert));
    EXPECT_EQ(diffuse.albedo, glm::vec3(.1f, .2f, .3f));
    const Material gold = material(
        "Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\" "
        "\"float roughness\" 0.25 \"bool remaproughness\" false\n");
    EXPECT_EQ(int(gold.kind), int(MaterialKind::metal));
    EXPECT_FLOAT_EQ(gold.roughness, 0.5f);  // alpha is its square
    EXPECT_GT(gold.albedo.x, 0.8f);
    EXPECT_LT(gold.albedo.z, 0.5f);
    const Material remapped = material("Material \"conductor\" \"float roughness\" 0.0625\n");
    EXPECT_FLOAT_EQ(remapped.roughness, 0.5f);  // alpha = sqrt(roughness)
    const Material glass = material("Material \"dielectric\" \"float eta\" 1.33\n");
    EXPECT_EQ(int(glass.kind), int(MaterialKind::glass));
    EXPECT_FLOAT_EQ(glass.ior, 1.33f);
    EXPECT_TRUE(material("Material \"thindielectric\"\n").thin_walled);
    const Material plastic = material("Material \"coateddiffuse\" \"rgb reflectance\" [1 .5 0]\n");
    EXPECT_EQ(int(plastic.kind), int(MaterialKind::principled));
    EXPECT_NEAR(plastic.albedo.x, 1.f, 1e-6f);
    EXPECT_LT(plastic.albedo.y, 0.35f);
    const Material coated = material("Material \"coatedconductor\" \"rgb reflectance\" [.9 .9 .9]\n");
    EXPECT_EQ(coated.clearcoat, 1.f);
    EXPECT_EQ(coated.metallic, 1.f);
    const Material mixed = material(
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0]\n"
        "MakeNamedMaterial \"b\" \"string type\" \"conductor\" \"rgb reflectance\" [0 1 0]\n"
        "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" 0.25\n");
    EXPECT_FLOAT_EQ(mixed.metallic, 0.25f);
    EXPECT_EQ(mixed.albedo, glm::vec3(0.75f, 0.25f, 0));
    (void)material("Material \"hair\"\n");
    EXPECT_EQ(warned("materials 'hair' are not supported"), 1u);
}

TEST_F(Pbrt, TexturesCountFromTheBottom) {
    Image image{1, 2, {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)}};  // red above green
    write_image(folder / "map.pfm", image);
    const Scene scene = world(
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"map.pfm\" \"float scale\" 0.5 \"float vscale\" "
        "2\n"
        "Material \"diffuse\" \"texture reflectance\" \"t\"\n"
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [0 0 1 0 0 1]\n");
    const TextureUse& use = scene.materials.at(0).albedo_map;
    ASSERT_TRUE(use.used());
    EXPECT_EQ(scene.materials[0].albedo, glm::vec3(0.5f));
    const auto row = [&](std::size_t vertex) { return scene.meshes[0].uvs[vertex].y * use.scale.y + use.offset.y; };
    EXPECT_FLOAT_EQ(row(0), 1.f);   // v = 0: the bottom of the image
    EXPECT_FLOAT_EQ(row(2), -1.f);  // v = 1, twice: two images above
}

TEST_F(Pbrt, ComputedTextures) {
    const Scene board = world(
        "Texture \"c\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 1 1] \"rgb tex2\" [.2 .2 .2]\n"
        "Texture \"s\" \"spectrum\" \"scale\" \"texture tex\" \"c\" \"float scale\" 0.5\n"
        "Texture \"m\" \"spectrum\" \"mix\" \"rgb tex1\" [0 0 0] \"texture tex2\" \"s\" \"float amount\" 0.5\n"
        "Material \"diffuse\" \"texture reflectance\" \"m\"\n" +
        triangle);
    EXPECT_TRUE(board.materials.at(0).albedo_map.used());
    EXPECT_EQ(board.materials[0].albedo, glm::vec3(0.25f));
    (void)world("Texture \"w\" \"float\" \"wrinkled\"\nMaterial \"diffuse\" \"texture reflectance\" \"w\"\n" +
                triangle);
    EXPECT_EQ(warned("textures 'wrinkled' are not supported"), 1u);
}

TEST_F(Pbrt, Shapes) {
    const Scene ball = world("Translate 1 0 0\nShape \"sphere\" \"float radius\" 2\n");
    ASSERT_EQ(ball.primitives.size(), 1u);
    EXPECT_EQ(ball.primitives[0].points.at(0), glm::vec4(1, 0, 0, 2));
    const Scene others = world(
        "Shape \"disk\" \"float height\" 3\nShape \"cylinder\" \"float zmin\" 0 \"float zmax\" 2\n"
        "Shape \"sphere\" \"float zmin\" 0\nShape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n"
        "Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0] \"float width\" 0.2\nShape \"blob\"\n");
    EXPECT_EQ(others.meshes.size(), 4u);
    EXPECT_EQ(bounds_of(others.meshes[0]).lo.z, 3.f);
    EXPECT_EQ(others.primitives.at(0).points.at(0).w, 0.1f);
    EXPECT_EQ(warned("shapes 'blob' are left out"), 1u);
}

TEST_F(Pbrt, CurvesOfGlassAreDiffuse) {
    const Scene scene = world("Material \"dielectric\"\nShape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0]\n");
    EXPECT_EQ(int(scene.materials.at(scene.primitives.at(0).materials.at(0)).kind), int(MaterialKind::lambert));
    EXPECT_EQ(warned("curves of images, holes or glass"), 1u);
}

TEST_F(Pbrt, FilesAreIncluded) {
    (void)folder.file("geometry.pbrt", triangle);
    EXPECT_EQ(world("Include \"geometry.pbrt\"\nImport \"geometry.pbrt\"\n").meshes.size(), 2u);
    (void)folder.file("loop.pbrt", "Include \"loop.pbrt\"\n");
    refuses("WorldBegin\nInclude \"loop.pbrt\"\n", {"loop.pbrt' line 1", "32 deep"});
    refuses("WorldBegin\nInclude \"../../etc/passwd\"\n", {"scene.pbrt", "leaves the scene's folder"});
}

TEST_F(Pbrt, WhatIsLeftOutIsNamedOnce) {
    (void)world(
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\nMakeNamedMedium \"smoke\"\n"
        "LightSource \"laser\"\nShape \"plymesh\" \"string filename\" \"absent.ply\"\n" +
        triangle);
    EXPECT_EQ(warned("media, such as fog and smoke, are left out"), 1u);
    EXPECT_EQ(warned("lights 'laser' are left out"), 1u);
    EXPECT_EQ(warned("absent.ply' is missing and left out"), 1u);
}

TEST_F(Pbrt, BadFilesGetOneLineWithTheirPlace) {
    refuses("WorldBegin\n" + triangle + "Foo\n", {"scene.pbrt' line 3", "'Foo' is unknown"});
    refuses("WorldBegin\nShape \"sphere\n", {"line 2", "does not end"});
    refuses("WorldBegin\nShape \"sphere\" \"radius\" 2\n", {"line 2", "no type or no name"});
    refuses("WorldBegin\nShape \"sphere\" \"float radius\" [ 2\n", {"line 2", "a list does not end"});
    refuses("WorldBegin\nTranslate 1 2 x\n", {"line 2", "a number is expected", "'x'"});
    refuses("WorldBegin\nAttributeEnd\n", {"line 2", "has not begun"});
    refuses("WorldBegin\nObjectInstance \"a\"\n", {"line 2", "'a' is not defined"});
    refuses("LookAt 0 0 0 0 1 0 0 1 0\n", {"line 1", "up is along its view"});
    refuses(triangle, {"line 1", "before WorldBegin"});
    refuses("WorldBegin\n", {"scene.pbrt", "no shape"});
    refuses("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0] \"integer indices\" [0 1 2]\n",
            {"line 2", "none of 1"});
    refuses(
        "WorldBegin\nMakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [\"a\" \"a\"]\nNamedMaterial "
        "\"a\"\n" +
            triangle,
        {"line 2", "contain each other"});
    std::string deep = "WorldBegin\n";
    for (int i = 0; i < 2000; ++i) deep += "AttributeBegin ";
    refuses(deep, {"1024 deep"});
}

TEST_F(Pbrt, IsKnownByItsContent) {
    const auto path = folder.file(
        "scene", "# made by hand\nLookAt 0 0 5 0 0 0 0 1 0\nCamera \"perspective\"\nWorldBegin\n" + triangle);
    EXPECT_EQ(load_scene(path.string(), warnings).meshes.size(), 1u);
}

}  // namespace
}  // namespace claray
