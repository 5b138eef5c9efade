// Example 7: a glTF scene of your own. Everything in it is computed here, written as glTF with PNG images beside it,
// and loaded back: a hall with columns that opens to a garden, 20 materials, instances, a sun, a spot light and a lamp.
// About 200,000 triangles at DETAIL 1.
//   example_07_gltf [FOLDER [DETAIL]]         then: claray render FOLDER/hall.gltf -o hall.png
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>

#include "paint.hpp"
#include "shapes.hpp"
#include "writer.hpp"

namespace {

json factors(vec3 color, float metallic, float roughness) {
    return {{"baseColorFactor", {color.x, color.y, color.z, 1.f}},
            {"metallicFactor", metallic},
            {"roughnessFactor", roughness}};
}

json glass(vec3 color, float roughness, float ior) {
    return {{"pbrMetallicRoughness", factors(color, 0.f, roughness)},
            {"extensions",
             {{"KHR_materials_transmission", {{"transmissionFactor", 1.f}}},
              {"KHR_materials_volume", {{"thicknessFactor", 1.f}}},  // otherwise these were thin walls, not solids
              {"KHR_materials_ior", {{"ior", ior}}}}}};
}

struct Materials {
    int floor, wall, plaster, marble, wood, bark, leaf, ground, gold, copper, steel, clear, green, frosted, paint,
        ceramic, lamp, neon, veil, rug;
};

int add_floor(Writer& out) {
    const vec2 count(4, 4);
    const auto color = [=](vec2 uv) {
        const bool dark = (int(uv.x * count.x) + int(uv.y * count.y)) % 2 != 0;
        const vec3 stone =
            (dark ? vec3(0.32f, 0.2f, 0.16f) : vec3(0.82f, 0.78f, 0.7f)) * (0.75f + 0.5f * clouds(uv * 8.f, 8));
        return vec4(glm::mix(vec3(0.25f), stone, bricks(uv, count, 0.f, 0.01f)), 1.f);
    };
    return out.material(
        "floor tiles",
        {{"doubleSided", true},
         {"normalTexture",
          out.texture("floor_normal", normals(512, [=](vec2 uv) { return 0.006f * bricks(uv, count, 0.f, 0.02f); }))},
         {"pbrMetallicRoughness",
          {{"baseColorTexture", out.texture("floor_color", image(512, 3, color))},
           {"metallicRoughnessTexture", out.texture("floor_rough", image(256, 3, [=](vec2 uv) {
                                                        return rough_metal(
                                                            glm::mix(0.9f, 0.12f + 0.3f * clouds(uv * 8.f, 8),
                                                                     bricks(uv, count, 0.f, 0.01f)),
                                                            0.f);
                                                    }))}}}});
}

int add_wall(Writer& out) {
    const vec2 count(6, 12);
    const auto color = [=](vec2 uv) {
        const float age = hash(brick_number(uv, count, 0.5f), 7);
        const vec3 clay =
            glm::mix(vec3(0.62f, 0.3f, 0.22f), vec3(0.75f, 0.45f, 0.33f), age) * (0.7f + 0.6f * clouds(uv * 16.f, 16));
        return vec4(glm::mix(vec3(0.7f, 0.68f, 0.64f), clay, bricks(uv, count, 0.5f, 0.012f)), 1.f);
    };
    const json repeat = {{"KHR_texture_transform", {{"scale", {2, 2}}}}};
    json map = out.texture("brick_color", image(512, 3, color));
    json relief = out.texture("brick_normal", normals(512, [=](vec2 uv) {
                                  return 0.012f * bricks(uv, count, 0.5f, 0.02f) + 0.004f * clouds(uv * 32.f, 32);
                              }));
    map["extensions"] = relief["extensions"] = repeat;
    out.use("KHR_texture_transform");
    return out.material(
        "brick wall",
        {{"doubleSided", true},
         {"normalTexture", relief},
         {"pbrMetallicRoughness", {{"baseColorTexture", map}, {"metallicFactor", 0.f}, {"roughnessFactor", 0.9f}}}});
}

void add_stones_and_wood(Writer& out, Materials& m) {
    const auto plaster = [](vec2 uv) { return 0.004f * clouds(uv * 24.f, 24); };
    m.plaster = out.material("plaster", {{"doubleSided", true},
                                         {"normalTexture", out.texture("plaster_normal", normals(256, plaster))},
                                         {"pbrMetallicRoughness", factors({0.85f, 0.83f, 0.78f}, 0.f, 0.95f)}});
    const auto veins = [](vec2 uv) {
        const float vein = std::abs(std::sin(6.f * pi * (uv.x + uv.y + 0.6f * clouds(uv * 4.f, 4))));
        return vec4(glm::mix(vec3(0.45f, 0.47f, 0.5f), vec3(0.93f, 0.91f, 0.88f), std::pow(vein, 0.3f)), 1.f);
    };
    m.marble = out.material(
        "marble", {{"pbrMetallicRoughness",
                    {{"baseColorTexture", out.texture("marble_color", image(512, 3, veins))},
                     {"metallicFactor", 0.f},
                     {"roughnessFactor", 0.45f}}},
                   {"extensions",
                    {{"KHR_materials_clearcoat", {{"clearcoatFactor", 0.6f}, {"clearcoatRoughnessFactor", 0.08f}}}}}});
    const auto rings = [](vec2 uv) {
        return 0.5f + 0.5f * std::sin(40.f * pi * (0.5f * uv.y + 0.12f * clouds(uv * vec2(4, 8), 8)));
    };
    const auto wood = [=](vec2 uv) {
        return vec4(glm::mix(vec3(0.36f, 0.2f, 0.1f), vec3(0.6f, 0.38f, 0.2f), rings(uv)), 1.f);
    };
    m.wood = out.material("wood", {{"pbrMetallicRoughness",
                                    {{"baseColorTexture", out.texture("wood_color", image(512, 3, wood))},
                                     {"metallicRoughnessTexture", out.texture("wood_rough", image(256, 3, [=](vec2 uv) {
                                                                                  return rough_metal(
                                                                                      0.35f + 0.3f * rings(uv), 0.f);
                                                                              }))}}}});
}

void add_plants(Writer& out, Materials& m) {
    const auto grooves = [](vec2 uv) { return clouds(uv * vec2(24, 4), 24); };
    m.bark = out.material(
        "bark",
        {{"normalTexture", out.texture("bark_normal", normals(256, [=](vec2 uv) { return 0.03f * grooves(uv); }))},
         {"pbrMetallicRoughness",
          {{"baseColorTexture",
            out.texture(
                "bark_color",
                image(256, 3, [=](vec2 uv) { return vec4(vec3(0.5f, 0.4f, 0.3f) * (0.4f + grooves(uv)), 1.f); }))},
           {"metallicFactor", 0.f},
           {"roughnessFactor", 1.f}}}});
    const auto leaf = [](vec2 uv) {
        const float width = 0.42f * std::sin(pi * uv.y) * (0.6f + 0.4f * uv.y), x = std::abs(uv.x - 0.5f);
        const float vein = 0.8f + 0.2f * glm::smoothstep(0.f, 0.03f, x) * (0.8f + 0.2f * std::sin(60.f * (uv.y + x)));
        return vec4(vec3(0.3f, 0.55f, 0.18f) * vein, x < width ? 1.f : 0.f);
    };
    m.leaf = out.material("leaf", {{"doubleSided", true},
                                   {"alphaMode", "MASK"},
                                   {"alphaCutoff", 0.5f},
                                   {"pbrMetallicRoughness",
                                    {{"baseColorTexture", out.texture("leaf_color", image(128, 4, leaf), true)},
                                     {"metallicFactor", 0.f},
                                     {"roughnessFactor", 0.6f}}}});
    const auto grass = [](vec2 uv) {
        return vec4(glm::mix(vec3(0.25f, 0.4f, 0.15f), vec3(0.5f, 0.45f, 0.3f), clouds(uv * 16.f, 16)) *
                        (0.7f + 0.6f * noise(uv * 128.f, 128)),
                    1.f);
    };
    m.ground = out.material("ground", {{"pbrMetallicRoughness",
                                        {{"baseColorTexture", out.texture("ground_color", image(512, 3, grass))},
                                         {"metallicFactor", 0.f},
                                         {"roughnessFactor", 1.f}}}});
}

void add_metals_and_glass(Writer& out, Materials& m) {
    m.gold = out.material("gold", {{"pbrMetallicRoughness", factors({1.f, 0.77f, 0.34f}, 1.f, 0.15f)}});
    json copper = factors({0.96f, 0.64f, 0.54f}, 1.f, 1.f);  // green where it is no metal any more
    copper["metallicRoughnessTexture"] =
        out.texture("copper_rough", image(256, 3, [](vec2 uv) {
                        const float patina = glm::smoothstep(0.45f, 0.6f, clouds(uv * 6.f, 6));
                        return rough_metal(glm::mix(0.25f, 0.85f, patina), 1.f - patina);
                    }));
    m.copper = out.material("copper", {{"pbrMetallicRoughness", copper}});
    json steel = factors({0.62f, 0.62f, 0.64f}, 1.f, 1.f);
    steel["metallicRoughnessTexture"] = out.texture(
        "steel_rough",
        image(256, 3, [](vec2 uv) { return rough_metal(0.2f + 0.3f * noise(uv * vec2(2, 128), 128), 1.f); }));
    m.steel = out.material("brushed steel", {{"pbrMetallicRoughness", steel}});
    m.clear = out.material("clear glass", glass(vec3(1.f), 0.f, 1.5f));
    json green = glass(vec3(1.f), 0.f, 1.5f);
    green["extensions"]["KHR_materials_volume"] = {
        {"thicknessFactor", 0.5f}, {"attenuationDistance", 0.4f}, {"attenuationColor", {0.2f, 0.8f, 0.45f}}};
    m.green = out.material("green glass", green);
    m.frosted = out.material("frosted glass", glass({0.95f, 0.97f, 1.f}, 0.35f, 1.45f));
}

void add_coats_and_lamps(Writer& out, Materials& m) {
    m.paint = out.material(
        "car paint",
        {{"pbrMetallicRoughness", factors({0.6f, 0.02f, 0.03f}, 0.4f, 0.45f)},
         {"extensions",
          {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1.f}, {"clearcoatRoughnessFactor", 0.02f}}}}}});
    const auto stripes = [](vec2 uv) { return std::sin(16.f * pi * uv.y + 2.f * std::sin(12.f * pi * uv.x)) > 0.f; };
    m.ceramic = out.material(
        "ceramic",
        {{"pbrMetallicRoughness",
          {{"baseColorTexture", out.texture("ceramic_color", image(256, 3,
                                                                   [=](vec2 uv) {
                                                                       return stripes(uv)
                                                                                  ? vec4(0.12f, 0.2f, 0.55f, 1.f)
                                                                                  : vec4(0.92f, 0.92f, 0.9f, 1.f);
                                                                   }))},
           {"metallicFactor", 0.f},
           {"roughnessFactor", 0.7f}}},
         {"extensions",
          {{"KHR_materials_clearcoat",
            {{"clearcoatFactor", 1.f},
             {"clearcoatRoughnessFactor", 0.05f},
             {"clearcoatTexture", out.texture("ceramic_coat", image(256, 1, [=](vec2 uv) {
                                                  return vec4(stripes(uv) ? 1.f : 0.3f);
                                              }))}}}}}});
    const auto grid = [](vec2 uv) { return vec4(vec3(1.f, 0.93f, 0.8f) * bricks(uv, {4, 4}, 0.f, 0.03f), 1.f); };
    m.lamp =
        out.material("lamp", {{"emissiveFactor", {1.f, 1.f, 1.f}},
                              {"emissiveTexture", out.texture("lamp_light", image(128, 3, grid))},
                              {"pbrMetallicRoughness", factors(vec3(0.2f), 0.f, 0.5f)},
                              {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 12.f}}}}}});
    m.neon = out.material("neon", {{"emissiveFactor", {0.1f, 0.6f, 1.f}},
                                   {"pbrMetallicRoughness", factors(vec3(0.f), 0.f, 1.f)},
                                   {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 6.f}}}}}});
    m.veil = out.material(
        "veil",
        {{"doubleSided", true},
         {"alphaMode", "BLEND"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.9f, 0.85f, 0.8f, 0.45f}}, {"metallicFactor", 0.f}, {"roughnessFactor", 1.f}}}});
    json pattern = out.texture("rug_color",
                               image(512, 3,
                                     [](vec2 uv) {
                                         const vec2 p = glm::abs(uv - 0.5f) * 2.f;
                                         const float band = std::fmod(
                                             6.f * std::max(p.x, p.y) + 0.3f * std::sin(20.f * (p.x + p.y)), 2.f);
                                         return vec4((band < 1.f ? vec3(0.5f, 0.1f, 0.12f) : vec3(0.75f, 0.6f, 0.35f)) *
                                                         (0.8f + 0.3f * noise(uv * 256.f, 256)),
                                                     1.f);
                                     }),
                               true);
    pattern["texCoord"] = 1;
    m.rug = out.material("rug", {{"doubleSided", true},
                                 {"pbrMetallicRoughness",
                                  {{"baseColorTexture", pattern}, {"metallicFactor", 0.f}, {"roughnessFactor", 1.f}}}});
}

Materials add_materials(Writer& out) {
    Materials m{};
    m.floor = add_floor(out);
    m.wall = add_wall(out);
    add_stones_and_wood(out, m);
    add_plants(out, m);
    add_metals_and_glass(out, m);
    add_coats_and_lamps(out, m);
    return m;
}

/// 12 m by 8 m, 4.5 m high; open towards +x, where the garden is, and towards +z, where the camera stands.
void add_hall(Writer& out, const Materials& m, float detail) {
    out.node({{"mesh", out.mesh("floor", quad({-6, 0, 4}, {12, 0, 0}, {0, 0, -8}, {6, 4}), m.floor)}});
    out.node({{"mesh", out.mesh("back wall", quad({-6, 0, -4}, {12, 0, 0}, {0, 4.5f, 0}, {3, 1}), m.wall)}});
    out.node({{"mesh", out.mesh("left wall", quad({-6, 0, 4}, {0, 0, -8}, {0, 4.5f, 0}, {2, 1}), m.wall)}});
    out.node({{"mesh", out.mesh("ceiling", quad({-6, 4.5f, -4}, {12, 0, 0}, {0, 0, 8}, {6, 4}), m.plaster)}});
    const auto flutes = [](float v) {
        const float base = glm::smoothstep(0.f, 0.06f, v) * (1.f - glm::smoothstep(0.94f, 1.f, v));
        return vec2(0.38f - 0.12f * base + 0.02f * std::sin(24.f * pi * v) * base, 4.5f * v);
    };
    const int column = out.mesh("column", lathe(int(48 * detail), int(90 * detail), {2, 6}, flutes), m.marble);
    for (int i = 0; i < 4; ++i) out.node({{"mesh", column}}, vec3(5.4f, 0, -3.3f + 2.2f * float(i)), 0.7f * float(i));
    for (int i = 0; i < 2; ++i) out.node({{"mesh", column}}, vec3(-3.f + 4.f * float(i), 0, -3.4f));
    Shape panel = quad({-0.8f, 0, -0.8f}, {1.6f, 0, 0}, {0, 0, 1.6f}, {1, 1});
    const int lamp = out.mesh("lamp", panel, m.lamp);
    for (int i = 0; i < 2; ++i) out.node({{"mesh", lamp}}, vec3(-3.f + 5.f * float(i), 4.49f, 0.f));
    out.node({{"mesh", out.mesh("neon ring", torus(int(40 * detail), 0.03f, {1, 1}), m.neon)}}, {-5.7f, 2.6f, -3.9f},
             0.f, {0.9f, 0.9f, 0.9f});
    const auto folds = [](float u, float v) { return vec3(0.12f * std::sin(14.f * pi * u), 3.6f * v, -2.4f * u); };
    out.node({{"mesh", out.mesh("veil", surface(int(120 * detail), int(40 * detail), {1, 1}, folds), m.veil)}},
             {5.2f, 0.6f, 1.2f});
}

void add_table(Writer& out, const Materials& m, float detail) {
    Shape table;
    add_box(table, {-1.6f, 0.78f, -0.8f}, {1.6f, 0.85f, 0.8f});
    for (int i = 0; i < 4; ++i) {
        const vec3 foot(i & 1 ? 1.4f : -1.5f, 0.f, i >> 1 ? 0.6f : -0.7f);
        add_box(table, foot, foot + vec3(0.1f, 0.78f, 0.1f));
    }
    out.node({{"mesh", out.mesh("table", table, m.wood)}}, {-0.4f, 0, -0.6f}, 0.25f);
    const vec3 top(-0.4f, 0.85f, -0.6f);
    const int n = int(40 * detail);
    const auto ball = [&](const char* name, int material, vec3 at, float radius, vec2 repeats = {2, 1}) {
        out.node({{"mesh", out.mesh(name, sphere(n, repeats), material)}}, at + vec3(0, radius, 0), 0.f, vec3(radius));
    };
    ball("clear ball", m.clear, top + vec3(-1.f, 0, 0.3f), 0.22f);
    ball("green ball", m.green, top + vec3(-0.45f, 0, 0.45f), 0.2f);
    ball("frosted ball", m.frosted, top + vec3(0.05f, 0, 0.5f), 0.18f);
    ball("gold ball", m.gold, top + vec3(0.5f, 0, 0.2f), 0.2f);
    ball("painted ball", m.paint, vec3(1.9f, 0, 0.9f), 0.55f);
    ball("copper ball", m.copper, vec3(-3.2f, 0, 0.6f), 0.6f, {3, 2});
    const auto vase = [](float v) {
        return vec2(0.05f + 0.13f * std::sin(pi * (0.15f + 0.8f * v)) * (1.3f - 0.8f * v), 0.55f * v);
    };
    const int jar = out.mesh("vase", lathe(2 * n, n, {2, 1}, vase), m.ceramic);
    out.node({{"mesh", jar}}, top + vec3(0.05f, 0, -0.2f));
    out.node({{"mesh", jar}}, {-4.6f, 0, -2.4f}, 1.f, vec3(2.2f));
    out.node({{"mesh", jar}}, {3.9f, 0, -3.f}, 2.f, vec3(1.8f));
    const int ring = out.mesh("ring", torus(n, 0.25f, {6, 1}), m.steel);
    out.node({{"mesh", ring}}, top + vec3(1.05f, 0.06f, -0.25f), 0.f, vec3(0.24f));
    out.node({{"mesh", ring}}, vec3(0.6f, 0.14f, 2.2f), 0.4f, vec3(0.5f));

    const auto wave = [](float u, float v) {
        return vec3(3.6f * u - 1.8f, 0.012f + 0.008f * std::sin(9.f * u) * std::sin(8.f * v), 1.2f - 2.4f * v);
    };
    const Shape rug = surface(int(60 * detail), int(40 * detail), {8, 8}, wave);
    std::vector<vec2> once;
    for (const vec2& uv : rug.uvs) once.push_back(uv / 8.f);
    out.node({{"mesh", out.mesh("rug", rug, m.rug, once)}}, {-0.2f, 0, 1.6f}, -0.15f);
}

void add_garden(Writer& out, const Materials& m, float detail) {
    const auto height = [](float x, float z) {
        return -0.15f + 1.2f * clouds(vec2(0.15f * x + 40.f, 0.15f * z + 40.f), 256) * glm::smoothstep(6.f, 14.f, x);
    };
    const auto hills = [=](float u, float v) {
        const float x = 6.f + 22.f * u, z = 14.f - 28.f * v;
        return vec3(x, height(x, z), z);
    };
    const int n = int(140 * std::sqrt(detail) * std::sqrt(detail));
    out.node({{"mesh", out.mesh("ground", surface(n, n, {12, 14}, hills), m.ground)}});
    const auto trunk = [](float v) { return vec2(0.22f - 0.12f * v + 0.03f * std::sin(25.f * v), 2.2f * v); };
    const int stem = out.mesh("trunk", lathe(int(32 * detail), int(40 * detail), {2, 4}, trunk), m.bark);
    const int leaves = out.mesh("crown", crown(int(5000 * detail * detail)), m.leaf);
    const vec3 places[] = {{8.5f, 0, -2.5f}, {10.f, 0, 1.5f}, {13.f, 0, -5.f}, {12.5f, 0, 4.f}};
    for (int i = 0; i < 4; ++i) {
        const vec3 at = places[i] + vec3(0, height(places[i].x, places[i].z) - 0.1f, 0);
        const float size = 0.9f + 0.25f * hash(i, 3);
        out.node({{"mesh", stem}}, at, float(i), vec3(size));
        out.node({{"mesh", leaves}}, at + vec3(0, 2.6f * size, 0), 1.7f * float(i), vec3(1.5f * size));
    }
}

void add_lights_and_camera(Writer& out) {
    out.looking(
        out.light({{"type", "directional"}, {"name", "sun"}, {"color", {1.f, 0.92f, 0.78f}}, {"intensity", 6.f}}),
        {20, 16, 6}, {0, 0, 0});
    out.looking(out.light({{"type", "spot"},
                           {"name", "table spot"},
                           {"color", {1.f, 0.85f, 0.6f}},
                           {"intensity", 25.f},
                           {"spot", {{"innerConeAngle", 0.25f}, {"outerConeAngle", 0.5f}}}}),
                {-0.4f, 4.2f, -0.2f}, {-0.4f, 0.85f, -0.6f});
    out.node(out.light({{"type", "point"},
                        {"name", "corner"},
                        {"color", {0.6f, 0.75f, 1.f}},
                        {"intensity", 6.f},
                        {"range", 12.f}}),
             {-5.f, 3.f, 2.5f});
    out.looking(out.camera(0.85f), {-3.6f, 1.9f, 5.4f}, {1.f, 1.1f, -1.2f});
}

void run(const std::filesystem::path& folder, float detail) {
    Writer out(folder);
    const Materials materials = add_materials(out);
    add_hall(out, materials, detail);
    add_table(out, materials, detail);
    add_garden(out, materials, detail);
    add_lights_and_camera(out);
    out.write("hall");

    claray::Warnings warnings;
    const claray::Scene scene = claray::load_gltf(folder / "hall.gltf", warnings);
    for (const std::string& warning : warnings) std::printf("warning: %s\n", warning.c_str());
    std::printf("%s: %zu triangles in %zu placed meshes, %zu materials, %zu images, %zu lights\n",
                (folder / "hall.gltf").string().c_str(), out.placed(), scene.instances.size(), scene.materials.size(),
                scene.textures.size(), scene.lights.size());
}

}  // namespace

int main(int argc, char** argv) try {
    const double detail = argc > 2 ? std::atof(argv[2]) : 1.0;
    if (!(detail >= 0.1 && detail <= 10.0)) throw std::invalid_argument("DETAIL must be from 0.1 to 10");
    run(argc > 1 ? argv[1] : "gltf_scene", float(detail));
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "07_gltf: error: %s\n", error.what());
    return 1;
}
