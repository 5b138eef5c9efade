// Mitsuba 3's scene files: what becomes of each object, and every way in which a file can be bad.
#include <zlib.h>

#include <cmath>
#include <numbers>

#include "host/io/scene_readers.hpp"
#include "host/io/world/rough.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/io/world/spot_power.hpp"

namespace claray {
namespace {

using test::expect_error;
using test::power_between;
using test::power_of_spot;

const std::string square = "<shape type='rectangle'/>";
const std::string around = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";

class Mitsuba : public test::ReaderTest {
protected:
    Scene load(const std::string& body, const std::string& version = "3.0.0") {
        return load_text("scene.xml", "<scene version='" + version + "'>\n" + body + around + "</scene>\n");
    }
    Material material(const std::string& bsdf, const std::string& version = "3.0.0") {
        return load("<shape type='rectangle'>" + bsdf + "</shape>", version).materials.at(0);
    }
    void refuses(const std::string& body, const std::vector<std::string>& words) {
        expect_error(ErrorKind::user, words, [&] { (void)load(body); });
    }
};

TEST_F(Mitsuba, CameraSeesItsFieldOfViewAlongTheWidth) {
    const std::string sensor =
        "<sensor type='thinlens'><float name='fov' value='60'/>%s<float name='aperture_radius' value='0.1'/>"
        "<float name='focus_distance' value='4'/><transform name='to_world'><lookat origin='0,0,5' target='0,0,0' "
        "up='0,1,0'/>"
        "</transform><film type='hdrfilm'><integer name='width' value='200'/><integer name='height' "
        "value='100'/></film></sensor>";
    const auto with = [&](const std::string& axis) {
        std::string text = sensor;
        return load(text.replace(text.find("%s"), 2, axis) + square).camera.value();
    };
    const Camera camera = with("");
    const double half = std::tan(std::numbers::pi / 6);
    EXPECT_NEAR(camera.vertical_fov, 2 * std::atan(half / 2) * 180 / std::numbers::pi, 1e-4);
    EXPECT_EQ(camera.position, glm::vec3(0, 0, 5));
    EXPECT_EQ(camera.aperture_radius, 0.1f);
    EXPECT_EQ(camera.focus_distance, 4.f);
    EXPECT_NEAR(with("<string name='fov_axis' value='y'/>").vertical_fov, 60, 1e-4);
    EXPECT_NEAR(with("<string name='fov_axis' value='smaller'/>").vertical_fov, 60, 1e-4);
}

TEST_F(Mitsuba, Film) {
    const auto film = [&](const std::string& sensor) {
        return film_of(folder.file("film.xml", "<scene version='0.5.0'>" + sensor + "</scene>"));
    };
    EXPECT_FALSE(film("<sensor type='perspective'/>"));
    const auto plain = film("<sensor type='perspective'><film type='hdrfilm'/></sensor>").value();
    EXPECT_EQ(glm::uvec2(plain.width, plain.height), glm::uvec2(768, 576));
    EXPECT_FALSE(plain.is_part() || plain.exposure);
    const auto part =
        film(
            "<film type='ldrfilm' id='f'><integer name='width' value='100'/><integer name='height' value='50'/>"
            "<integer name='cropOffsetX' value='10'/><integer name='cropWidth' value='30'/>"
            "<float name='exposure' value='1.5'/></film><sensor type='perspective'><ref id='f'/></sensor>")
            .value();
    EXPECT_EQ(glm::uvec4(part.x, part.y, part.part_width, part.part_height), glm::uvec4(10, 0, 30, 50));
    EXPECT_EQ(part.exposure, 1.5f);
    expect_error(ErrorKind::user, {"film.xml", "no pixel"}, [&] {
        (void)film("<sensor type='a'><film type='hdrfilm'><integer name='crop_width' value='0'/></film></sensor>");
    });
}

TEST_F(Mitsuba, CameraThatMirrorsMirrorsTheWorld) {
    const std::string moved =
        "<shape type='rectangle'><transform name='to_world'><translate x='3'/></transform></shape>";
    const auto sensor = [](const std::string& steps) {
        return "<sensor type='perspective'><transform name='to_world'>" + steps +
               "<lookat origin='0,0,5' target='0,0,0' up='0,1,0'/></transform></sensor>";
    };
    EXPECT_EQ(bounds_of(load(sensor("") + moved)).hi.x, 4.f);
    EXPECT_EQ(bounds_of(load(sensor("<scale x='-1'/>") + moved)).lo.x, -4.f);
}

TEST_F(Mitsuba, TransformsFollowEachOther) {
    const Scene scene = load(
        "<shape type='rectangle'><transform name='to_world'><scale value='2'/><translate x='1' y='2' z='3'/>"
        "<rotate z='1' angle='90'/></transform></shape>");
    const Bounds bounds = bounds_of(scene);
    EXPECT_NEAR(glm::length(bounds.lo - glm::vec3(-4, -1, 3)), 0, 1e-5);
    EXPECT_NEAR(glm::length(bounds.hi - glm::vec3(0, 3, 3)), 0, 1e-5);
}

TEST_F(Mitsuba, LampsShineToOneSide) {
    const Scene scene =
        load("<shape type='rectangle'><emitter type='area'><rgb name='radiance' value='3, 2, 1'/></emitter></shape>");
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.materials.at(scene.meshes[0].materials[0]).emission, glm::vec3(3, 2, 1));
    EXPECT_EQ(scene.materials.at(scene.meshes[1].materials[0]).albedo, glm::vec3(0.f));  // Mitsuba's backs are black
    EXPECT_EQ(scene.meshes[0].normals.at(0), glm::vec3(0, 0, 1));
    const Scene turned =
        load("<shape type='rectangle'><boolean name='flip_normals' value='true'/><emitter type='area'/></shape>");
    EXPECT_EQ(turned.meshes[0].normals.at(0), glm::vec3(0, 0, -1));
}

TEST_F(Mitsuba, Lights) {
    const Scene scene = load(
        "<emitter type='point'><point name='position' x='1' y='2' z='3'/><rgb name='intensity' value='5'/></emitter>"
        "<emitter type='spot'><float name='cutoff_angle' value='40'/></emitter>"
        "<emitter type='directional'><vector name='direction' x='0' y='-1' z='0'/></emitter>"
        "<emitter type='sunsky'/>" +
        square);
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].position, glm::vec3(1, 2, 3));
    EXPECT_EQ(scene.lights[0].intensity, glm::vec3(5));
    EXPECT_NEAR(scene.lights[1].outer_angle, 40 * std::numbers::pi / 180, 1e-6);
    const double beam = 30 * std::numbers::pi / 180, cutoff = 40 * std::numbers::pi / 180;
    EXPECT_NEAR(power_of_spot(scene.lights[1]),
                power_between(cutoff, [&](double angle) { return std::min(1.0, (cutoff - angle) / (cutoff - beam)); }),
                1e-5);
    EXPECT_EQ(scene.lights[2].direction, glm::vec3(0, -1, 0));
    EXPECT_EQ(scene.sky.zenith, glm::vec3(1.f));
    EXPECT_EQ(warned("emitters 'sunsky' are left out"), 1u);
}

/// A constant spectrum of light has equal energy at all wavelengths, which is redder than white.
TEST_F(Mitsuba, ConstantSpectraOfLight) {
    const auto intensity = [&](const std::string& value) {
        return load("<emitter type='point'>" + value + "</emitter>" + square).lights.at(0).intensity;
    };
    const glm::vec3 light = intensity("<spectrum name='intensity' value='2'/>");
    EXPECT_NEAR(light.x, 2 * 1.205f, 0.01f);
    EXPECT_NEAR(light.y, 2 * 0.948f, 0.01f);
    EXPECT_NEAR(light.z, 2 * 0.909f, 0.01f);
    EXPECT_EQ(intensity("<rgb name='intensity' value='2'/>"), glm::vec3(2.f));
}

/// What a tint takes from a metal it takes at all angles: KHR_materials_specular scales F0 and F90.
TEST_F(Mitsuba, TintedMetals) {
    const auto metal = [&](const std::string& more) {
        return material(
            "<bsdf type='roughconductor'><string name='material' value='none'/><float name='alpha' "
            "value='0.25'/><string name='distribution' value='ggx'/>" +
            more + "</bsdf>");
    };
    EXPECT_EQ(int(metal("").kind), int(MaterialKind::metal));
    const Material tinted = metal("<rgb name='specular_reflectance' value='0.4, 0.2, 0.1'/>");
    EXPECT_EQ(int(tinted.kind), int(MaterialKind::principled));
    EXPECT_EQ(tinted.albedo, glm::vec3(0.f));
    EXPECT_EQ(tinted.metallic, 0.f);
    EXPECT_FLOAT_EQ(tinted.roughness, 0.5f);
    const float root = (tinted.ior - 1) / (tinted.ior + 1);
    EXPECT_FLOAT_EQ(tinted.specular_weight, 0.4f);
    EXPECT_LT(glm::length(tinted.specular_tint * root * root - glm::vec3(1.f, 0.5f, 0.25f)), 1e-6f);
    const Scene board = load(
        "<shape type='rectangle'><bsdf type='conductor'><texture type='checkerboard' "
        "name='specular_reflectance'><rgb name='color0' value='0.8'/><rgb name='color1' "
        "value='0.2'/></texture></bsdf></shape>");
    const TextureUse& weights = board.materials.at(0).specular_weight_map;
    ASSERT_TRUE(weights.used());
    const Texture& image = board.textures.at(weights.texture);
    ASSERT_EQ(image.channels, 4u);
    EXPECT_EQ(int(image.bytes.at(3)), 204);
    EXPECT_EQ(int(image.bytes.at(4 * (image.width - 1) + 3)), 51);
    EXPECT_EQ(int(image.bytes.at(0)), 255);
}

/// Its metal is darkened by what facets lose, and its diffuse lobe brightened by what claray's border keeps from it.
TEST_F(Mitsuba, PrincipledColors) {
    const auto albedo = [&](const std::string& metallic) {
        return material(
                   "<bsdf type='principled'><rgb name='base_color' value='0.5'/><float name='roughness' "
                   "value='0.8'/><float name='metallic' value='" +
                   metallic + "'/></bsdf>")
            .albedo.x;
    };
    const Facets facets{0.64};
    EXPECT_NEAR(albedo("1"), darkened_metal(0.5f, kept_by_facets(facets)), 1e-6f);
    EXPECT_NEAR(albedo("0"), 0.5 * burley_diffuse(0.8) / (1 - rough_border(1.5, facets).reflected), 1e-5);
    EXPECT_NEAR(albedo("0.25"), 0.75f * albedo("0") + 0.25f * albedo("1"), 1e-6f);
}

/// Half of Beckmann's facets are as steep as of GGX with 0.83 times its alpha.
TEST_F(Mitsuba, LobesOfBeckmann) {
    EXPECT_NEAR(material("<bsdf type='roughconductor'><float name='alpha' value='0.2'/></bsdf>").roughness,
                std::sqrt(0.2 * std::sqrt(std::log(2.0))), 1e-6);
}

TEST_F(Mitsuba, ImagesAroundTheScene) {
    // Mitsuba's first column shows -z, which is claray's middle.
    Image image{4, 2, {}};
    for (int i = 0; i < 8; ++i) image.pixels.emplace_back(i % 4 == 0 ? 1 : 0, i % 4 == 2 ? 1 : 0, 0);
    write_image(folder / "sky.pfm", image);
    warnings.clear();
    const auto path = folder.file(
        "sky.xml", "<scene version='3.0.0'><emitter type='envmap'><string name='filename' value='sky.pfm'/></emitter>" +
                       square + "</scene>");
    const Scene scene = load_scene(path.string(), warnings);
    ASSERT_EQ(scene.environment.images.size(), 1u);
    const Texture& made = scene.environment.images[0];
    const auto texel = [&](unsigned column, unsigned channel) { return made.floats[3 * column + channel]; };
    EXPECT_GT(texel(2, 0), 0.5f);
    EXPECT_LT(texel(0, 0), 0.3f);  // right of -z
    EXPECT_GT(texel(0, 1), 0.5f);
    EXPECT_LT(texel(2, 1), 0.3f);
}

TEST_F(Mitsuba, Bsdfs) {
    EXPECT_EQ(material("<bsdf type='diffuse'><rgb name='reflectance' value='#ff0000'/></bsdf>").albedo,
              glm::vec3(1, 0, 0));
    const Material linear = material("<bsdf type='plastic'><rgb name='diffuse_reflectance' value='0.5'/></bsdf>"),
                   tinted = material("<bsdf type='plastic'><boolean name='nonlinear' value='true'/></bsdf>");
    EXPECT_EQ(linear.albedo, glm::vec3(0.5f));
    EXPECT_LT(tinted.albedo.x, 0.35f);
    EXPECT_NEAR(linear.ior, 1.49f / 1.000277f, 1e-5);
    const std::string ggx = "<string name='distribution' value='ggx'/>";
    EXPECT_FLOAT_EQ(material("<bsdf type='roughplastic'>" + ggx + "</bsdf>").roughness, std::sqrt(0.1f));
    const Material copper =
        material("<bsdf type='roughconductor'><string name='material' value='Cu'/><float name='alpha' value='0.25'/>" +
                 ggx + "</bsdf>");
    EXPECT_EQ(int(copper.kind), int(MaterialKind::metal));
    EXPECT_FLOAT_EQ(copper.roughness, 0.5f);
    EXPECT_GT(copper.albedo.x, copper.albedo.z);
    EXPECT_NEAR(material("<bsdf type='dielectric'/>").ior, 1.5046f / 1.000277f, 1e-5);
    EXPECT_NEAR(
        material(
            "<bsdf type='dielectric'><string name='int_ior' value='water'/><float name='ext_ior' value='1'/></bsdf>")
            .ior,
        1.333f, 1e-5);
    EXPECT_TRUE(material("<bsdf type='thindielectric'/>").thin_walled);
    const Material mask =
        material("<bsdf type='mask'><float name='opacity' value='0.3'/><bsdf type='diffuse'/></bsdf>");
    EXPECT_EQ(int(mask.alpha_mode), int(AlphaMode::blend));
    EXPECT_FLOAT_EQ(mask.opacity, 0.3f);
    const Material blend = material(
        "<bsdf type='blendbsdf'><float name='weight' value='0.25'/><bsdf type='diffuse'><rgb name='reflectance' "
        "value='1'/></bsdf><bsdf type='conductor'/></bsdf>");
    EXPECT_FLOAT_EQ(blend.metallic, 0.25f);
    const Material principled = material(
        "<bsdf type='twosided'><bsdf type='principled'><float name='roughness' value='0.4'/><float name='metallic' "
        "value='0.7'/></bsdf></bsdf>");
    EXPECT_FLOAT_EQ(principled.metallic, 0.7f);
    EXPECT_NEAR(principled.roughness, 0.4f, 1e-6f);
    EXPECT_NEAR(principled.ior, 1.5f, 1e-5f);
    (void)material("<bsdf type='hair'/>");
    EXPECT_EQ(warned("BSDFs 'hair' are not supported"), 1u);
}

/// An anisotropic lobe: claray's wider alpha is mix(roughness^2, 1, anisotropy^2).
TEST_F(Mitsuba, StretchedLobes) {
    const Material m = material(
        "<bsdf type='roughconductor'><string name='distribution' value='ggx'/><float name='alpha_u' value='0.1'/>"
        "<float name='alpha_v' value='0.3'/></bsdf>");
    const float alpha = m.roughness * m.roughness;
    EXPECT_NEAR(alpha, 0.1f, 1e-6f);
    EXPECT_NEAR(alpha + m.anisotropy * m.anisotropy * (1 - alpha), 0.3f, 1e-6f);
    EXPECT_NEAR(m.anisotropy_rotation, std::numbers::pi / 2, 1e-6);
}

TEST_F(Mitsuba, TexturesHaveTheirTransform) {
    write_image(folder / "map.pfm", Image{2, 2, std::vector<glm::vec3>(4, glm::vec3(0.5f))});
    const std::string bitmap = "<texture type='bitmap' name='reflectance'><string name='filename' value='map.pfm'/>";
    const Material now =
        material("<bsdf type='diffuse'>" + bitmap +
                 "<transform name='to_uv'><scale x='2' y='3'/><translate x='0.1'/></transform></texture></bsdf>");
    EXPECT_EQ(now.albedo_map.scale, glm::vec2(2, 3));
    EXPECT_EQ(now.albedo_map.offset, glm::vec2(0.1f, 0));
    const Material old =
        material("<bsdf type='diffuse'>" + bitmap +
                     "<float name='uscale' value='2'/><float name='vscale' value='3'/></texture></bsdf>",
                 "0.5.0");
    EXPECT_EQ(old.albedo_map.scale, glm::vec2(2, 3));
    const Material board = material("<bsdf type='diffuse'><texture type='checkerboard' name='reflectance'/></bsdf>");
    EXPECT_TRUE(board.albedo_map.used());
}

TEST_F(Mitsuba, NamesOfOldVersions) {
    const Material m = material(
        "<bsdf type='dielectric'><float name='intIOR' value='1.7'/><float name='extIOR' value='1'/></bsdf>", "0.5.0");
    EXPECT_FLOAT_EQ(m.ior, 1.7f);
}

TEST_F(Mitsuba, ReferencesDefaultsAndIncludes) {
    (void)folder.file("part.xml", "<scene version='3.0.0'><shape type='cube'><ref id='red'/></shape></scene>");
    const Scene scene = load(
        "<default name='side' value='4'/><bsdf type='diffuse' id='red'><rgb name='reflectance' value='1, 0, 0'/></bsdf>"
        "<include filename='part.xml'/><shape type='sphere'><float name='radius' value='$side'/><ref "
        "id='red'/></shape>");
    EXPECT_EQ(scene.primitives.at(0).points.at(0).w, 4.f);
    EXPECT_EQ(scene.materials.size(), 2u);  // red, and black for backs
    (void)load("<shape type='cube'><ref id='absent'/></shape>");
    EXPECT_EQ(warned("'absent' is not defined"), 1u);
}

TEST_F(Mitsuba, GroupsArePlaced) {
    const Scene scene = load(
        "<shape type='shapegroup' id='g'><shape type='cube'/></shape>"
        "<shape type='instance'><ref id='g'/><transform name='to_world'><translate x='10'/></transform></shape>"
        "<shape type='instance'><ref id='g'/></shape>");
    ASSERT_EQ(scene.instances.size(), 4u);  // the fronts and the backs
    EXPECT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(bounds_of(scene).hi.x, 11.f);
}

/// A mesh of version 4, as Mitsuba writes it.
std::string serialized(std::uint32_t last_index) {
    std::string data;
    const auto add = [&](auto value) { data.append(reinterpret_cast<const char*>(&value), sizeof value); };
    add(std::uint32_t(1));  // normals
    data += "name", data += '\0';
    add(std::uint64_t(3)), add(std::uint64_t(1));
    for (const float p : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) add(p);
    for (int i = 0; i < 3; ++i)
        for (const float n : {0.f, 0.f, 1.f}) add(n);
    for (const std::uint32_t i : {0u, 1u, last_index}) add(i);
    std::string packed(compressBound(data.size()), '\0');
    uLongf size = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(data.data()), data.size());
    packed.resize(size);
    const std::string mesh = std::string("\x1c\x04\x04\x00", 4) + packed;
    std::string file = mesh + mesh;
    const auto tail = [&](auto value) { file.append(reinterpret_cast<const char*>(&value), sizeof value); };
    tail(std::uint64_t(0)), tail(std::uint64_t(mesh.size())), tail(std::uint32_t(2));
    return file;
}

TEST_F(Mitsuba, SerializedMeshes) {
    (void)folder.file("a.serialized", serialized(2));
    const std::string shape =
        "<shape type='serialized'><string name='filename' value='a.serialized'/><integer name='shape_index' value='";
    const Scene scene = load(shape + "1'/></shape>");
    EXPECT_EQ(scene.meshes.at(0).triangles, std::vector<glm::uvec3>{glm::uvec3(0, 1, 2)});
    refuses(shape + "2'/></shape>", {"a.serialized' has 2 meshes"});
    (void)folder.file("a.serialized", serialized(3));
    refuses(shape + "0'/></shape>", {"a.serialized' names vertices that it does not have"});
    (void)folder.file("a.serialized", serialized(2).substr(0, 20));
    refuses(shape + "0'/></shape>", {"a.serialized' is damaged"});
}

TEST_F(Mitsuba, BadFilesGetOneLineWithTheirPlace) {
    refuses("\n<shape type='cube'", {"scene.xml' line"});
    refuses("\n<shape type='sphere'><float name='radius' value='x'/></shape>",
            {"scene.xml' line 3", "'x' is no number"});
    refuses("<shape type='sphere'><float name='radius' value='$r'/></shape>", {"line 2", "$'r' has no default"});
    refuses("<shape type='cube'><transform name='to_world'><matrix value='1 2'/></transform></shape>",
            {"line 2", "9 or 16 numbers"});
    refuses("", {"scene.xml", "no shape"});
    (void)folder.file("loop.xml", "<scene version='3.0.0'><include filename='loop.xml'/></scene>");
    refuses("<include filename='loop.xml'/>", {"loop.xml' line 1", "64 deep"});
    refuses("<include filename='/etc/passwd'/>", {"is absolute"});
    refuses("<bsdf type='twosided' id='a'><ref id='a'/></bsdf><shape type='cube'><ref id='a'/></shape>", {"32 deep"});
    std::string deep;
    for (int i = 0; i < 5000; ++i) deep += "<shape type='merge'>";
    for (int i = 0; i < 5000; ++i) deep += "</shape>";
    refuses(deep, {"64 deep"});
    expect_error(ErrorKind::user, {"no <scene>"},
                 [&] { (void)load_scene(folder.file("b.xml", "<html/>").string(), warnings); });
}

}  // namespace
}  // namespace claray
