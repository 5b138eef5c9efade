#include <algorithm>
#include <chrono>
#include <map>
#include <numbers>

#include "claray/renderer.hpp"
#include "host/bsdf/material_data.hpp"
#include "host/render/bake/texel_points.hpp"
#include "host/render/film/film.hpp"
#include "host/render/schedule/pass_schedule.hpp"
#include "host/render/wavefront/wavefront.hpp"

namespace claray {
namespace {

void check(const LightMapConfig& config) {
    const auto refuse = [](const std::string& what, const char* remedy) {
        throw Error(ErrorKind::usage, what, remedy);
    };
    if (config.width == 0 || config.height == 0 || config.width > 16384 || config.height > 16384)
        refuse(
            "invalid light map size " + std::to_string(config.width) + "x" + std::to_string(config.height) + " texels",
            "use 1 to 16384 texels per side");
    if (config.spp == 0) refuse("0 paths per texel", "use at least 1");
    if (config.max_depth == 0) refuse("a maximum depth of 0", "use at least 1, which is direct light only");
    if (config.uv_set > 1)
        refuse("light map on set " + std::to_string(config.uv_set) + " of coordinates", "use 0 or 1");
}

const std::vector<glm::vec2>& coordinates(const Scene& scene, std::size_t mesh, std::uint32_t uv_set) {
    if (mesh >= scene.meshes.size())
        throw Error(ErrorKind::user, "there is no mesh " + std::to_string(mesh),
                    "the scene has " + std::to_string(scene.meshes.size()));
    const std::vector<glm::vec2>& uvs = uv_set == 0 ? scene.meshes[mesh].uvs : scene.meshes[mesh].uvs1;
    if (uvs.empty())
        throw Error(ErrorKind::user,
                    "mesh " + std::to_string(mesh) + " has no texture coordinates in set " + std::to_string(uv_set),
                    "choose the other set, or unwrap the mesh");
    return uvs;
}

/// Fills unknown texels with the mean of their known neighbours, from the mesh outwards.
void continue_outwards(std::vector<glm::vec3>& texels, std::vector<bool>& known, unsigned width, unsigned height) {
    for (int pass = 0; pass < 4; ++pass) {
        std::vector<bool> now = known;
        for (unsigned y = 0; y < height; ++y)
            for (unsigned x = 0; x < width; ++x) {
                const std::size_t at = std::size_t(y) * width + x;
                if (known[at]) continue;
                glm::vec3 sum(0.f);
                int count = 0;
                for (unsigned j = y == 0 ? 0 : y - 1; j <= std::min(y + 1, height - 1); ++j)
                    for (unsigned i = x == 0 ? 0 : x - 1; i <= std::min(x + 1, width - 1); ++i)
                        if (known[std::size_t(j) * width + i]) sum += texels[std::size_t(j) * width + i], ++count;
                if (count > 0) texels[at] = sum / float(count), now[at] = true;
            }
        known = now;
    }
}

/// Traces the paths of a batch that begin at points of surfaces, one per pixel. The points are treated as white
/// Lambertians without emission, whatever their material. Asynchronous.
void trace_from(const Buffer<Hit>& points, const Batch& batch, Wavefront& wavefront) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    wavefront.make_room(paths);
    Queues& queues = wavefront.queues;
    const RayArrays& first = queues.of_depth(0);
    const TriangleBuffers& triangles = wavefront.scene.structure.triangles();
    queues.lengths.of_rays(0).fill(paths);
    wavefront.kernels.generate.run({paths, 64}, batch, arg("points", points), arg("positions", triangles.positions),
                                   triangles.indices, first.rays, first.states, arg("hits", queues.hits),
                                   arg("radiance", queues.radiance));
    wavefront.trace_stages(batch, true);
}

/// Radiance of white Lambertian points, one per texel.
std::vector<glm::vec3> radiance_of(const Device& device, const Scene& scene, const TexelPoints& texels,
                                   const LightMapConfig& config, const std::function<bool(double)>& progress) {
    const auto count = std::uint32_t(texels.points.size());
    const Structure structure(device, scene, 0, config.bvh);
    const SceneBuffers buffers(device, scene, structure);
    StageConfig stages = stages_of(buffers, config.sampler, buffers.effects | EffectSet{Effect::lambert});
    stages.task = PathTask::bake, stages.shaders = {};  // a texel is white, whatever its material
    Wavefront wavefront(buffers, frame_without_camera(scene, buffers, config), WavefrontKernels(buffers, stages),
                        std::uint64_t(count) * config.spp);
    const Buffer<Hit> points(device, texels.points);
    Film film(device, count);
    PassSchedule schedule(count, config.spp, wavefront.queues.capacity);
    Pace pace(device.tuning("render/wavefront", "FIRST_PATHS"), wavefront.queues.capacity);
    const double all = double(count) * config.spp;
    while (!schedule.finished()) {
        const auto begin = std::chrono::steady_clock::now();
        const Batch batch = schedule.next(pace.paths());
        trace_from(points, batch, wavefront);
        film.accumulate(batch, wavefront.queues.radiance);
        device.finish();
        const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;
        pace.took(batch.pixels * batch.samples, taken.count());
        if (progress && !progress(double(schedule.samples()) / all))
            throw Error(ErrorKind::user, "interrupted: no light map was written");
    }
    return film.image();
}

}  // namespace

Texture bake_light_map(const Device& device, const Scene& scene, std::size_t mesh, const LightMapConfig& config,
                       const std::function<bool(double)>& progress) {
    check(config);
    validate(scene);
    const std::vector<glm::vec2>& uvs = coordinates(scene, mesh, config.uv_set);
    if (!scene.instances.empty())
        throw Error(ErrorKind::user, "the scene has instances, which receive different light",
                    "bake a scene without instances");
    std::uint32_t first_triangle = 0;
    for (std::size_t i = 0; i < mesh; ++i) first_triangle += std::uint32_t(scene.meshes[i].triangles.size());
    const std::string name =
        scene.meshes[mesh].name.empty() ? "mesh " + std::to_string(mesh) : "mesh '" + scene.meshes[mesh].name + "'";
    const TexelPoints texels =
        find_texel_points(scene.meshes[mesh], uvs, config.width, config.height, first_triangle, name);
    if (texels.texels.empty())
        throw Error(ErrorKind::user, name + " covers no texel of the light map",
                    "give the mesh an area in texture coordinates");

    Scene lit = scene;
    for (Material& material : lit.materials) material.light_map = {};
    const std::vector<glm::vec3> radiance = radiance_of(device, lit, texels, config, progress);

    std::vector<glm::vec3> irradiance(std::size_t(config.width) * config.height, glm::vec3(0.f));
    std::vector<bool> known(irradiance.size());
    for (std::size_t i = 0; i < texels.texels.size(); ++i) {
        irradiance[texels.texels[i]] = std::numbers::pi_v<float> * radiance[i];
        known[texels.texels[i]] = true;
    }
    continue_outwards(irradiance, known, config.width, config.height);

    Texture map;
    map.name = name + ", light";
    map.width = config.width, map.height = config.height, map.channels = 3;
    map.format = TexelFormat::float32, map.filter = Filter::bilinear;
    map.wrap_u = map.wrap_v = Wrap::clamp;
    map.floats.reserve(3 * irradiance.size());
    for (const glm::vec3& e : irradiance)
        for (int k = 0; k < 3; ++k) map.floats.push_back(e[k]);
    return map;
}

void use_light_map(Scene& scene, std::size_t mesh, Texture light_map, std::uint32_t uv_set) {
    (void)coordinates(scene, mesh, uv_set);
    Mesh& lit = scene.meshes[mesh];
    if (lit.materials.empty()) lit.materials.assign(lit.triangles.size(), 0);
    std::map<std::uint32_t, std::uint32_t> copies;
    for (std::uint32_t& material : lit.materials) {
        if (kind_of(scene.materials.at(material)) != MaterialKind::lambert) continue;
        const auto [copy, fresh] = copies.try_emplace(material, std::uint32_t(scene.materials.size()));
        if (fresh) {
            scene.materials.push_back(Material(scene.materials[material]));
            TextureUse& use = scene.materials.back().light_map;
            use = {};
            use.texture = std::uint32_t(scene.textures.size()), use.uv_set = uv_set;
        }
        material = copy->second;
    }
    scene.textures.push_back(std::move(light_map));
}

std::uint32_t light_map_uv_set(const Scene& scene, std::size_t mesh) {
    return mesh < scene.meshes.size() && !scene.meshes[mesh].uvs1.empty() ? 1 : 0;
}

}  // namespace claray
