// claray.h: structures over triangles.
#include "claray/scene.hpp"
#include "host/capi/members.hpp"
#include "host/capi/scene.hpp"
#include "host/scene/placement.hpp"

using namespace claray;
using namespace claray::capi;

namespace {

void check_indices(const claray_mesh& mesh) {
    if (mesh.triangle_count == 0) refuse("mesh.triangle_count is 0");
    for (std::size_t i = 0; i < 3 * mesh.triangle_count; ++i)
        if (mesh.triangles[i] >= mesh.vertex_count)
            refuse("mesh.triangles: triangle " + std::to_string(i / 3) + " has the vertex " +
                   std::to_string(mesh.triangles[i]) + " of " + std::to_string(mesh.vertex_count));
    for (std::size_t i = 0; mesh.geometries && mesh.masks && i < mesh.triangle_count; ++i)
        if (mesh.geometries[i] >= mesh.mask_count)
            refuse("mesh.masks: there is none for geometry " + std::to_string(mesh.geometries[i]));
}

Buffer<std::uint32_t> words(const Device& device, std::span<const std::uint32_t> values) {
    return values.empty() ? Buffer<std::uint32_t>() : Buffer<std::uint32_t>(device, values);
}

TriangleBuffers upload(const Device& device, const claray_mesh& mesh) {
    const auto vertices = array(mesh.vertices, 3 * mesh.vertex_count, "mesh.vertices");
    const auto triangles = array(mesh.triangles, 3 * mesh.triangle_count, "mesh.triangles");
    check_indices(mesh);
    const std::size_t geometries = mesh.geometries ? mesh.triangle_count : 0, masks = mesh.masks ? mesh.mask_count : 0;
    return {Buffer<float>(device, vertices), words(device, triangles), words(device, {mesh.geometries, geometries}),
            words(device, {mesh.masks, masks})};
}

/// Nothing for NULL.
Buffer<std::uint32_t> shared_words(const Device& device, void* memory, std::size_t count, const char* name) {
    return memory ? shared<std::uint32_t>(device, memory, count, name) : Buffer<std::uint32_t>();
}

TriangleBuffers share(const Device& device, const claray_triangle_buffers& given) {
    if (given.triangle_count == 0) refuse("buffers.triangle_count is 0");
    return {shared<float>(device, given.vertices, 3 * given.vertex_count, "buffers.vertices"),
            shared<std::uint32_t>(device, given.triangles, 3 * given.triangle_count, "buffers.triangles"),
            shared_words(device, given.geometries, given.triangle_count, "buffers.geometries"),
            shared_words(device, given.masks, given.mask_count, "buffers.masks")};
}

}  // namespace

namespace claray::capi {

Bvh::Config config_of(const claray_bvh_config* given, const Bvh::Config& standard) {
    Bvh::Config config = standard;
    if (given == nullptr) return config;
    const claray_bvh_config known = versioned(given, "config");
    const Builder builder = enumerator(known.builder, "config.builder");
    if (builder != Builder::automatic) config.builder = builder;
    config.layout = enumerator(known.layout, "config.layout");
    if (known.split_budget != 0) config.split_budget = known.split_budget < 0 ? 0 : double(known.split_budget);
    if (known.learns != 0) config.learns = known.learns > 0;
    if (known.morton_bits != 0) config.morton_bits = known.morton_bits;
    if (known.max_leaf_triangles != 0) config.max_leaf_triangles = known.max_leaf_triangles;
    return config;
}

claray_bvh_config config_of(const Bvh::Config& config) {
    claray_bvh_config known{};
    known.struct_size = sizeof known;
    put(known.builder, config.builder), put(known.layout, config.layout);
    known.split_budget = config.split_budget == 0 ? -1.f : float(config.split_budget);
    if (config.learns) known.learns = *config.learns ? 1 : -1;
    known.morton_bits = config.morton_bits, known.max_leaf_triangles = config.max_leaf_triangles;
    return known;
}

}  // namespace claray::capi

claray_status claray_builder_resolve(const claray_device* device, claray_builder builder, claray_builder* resolved) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        put(required(resolved, "resolved"), resolve(enumerator(builder, "builder"), on));
    });
}

claray_status claray_bvh_build(claray_device* device, const claray_mesh* mesh, const claray_bvh_config* config,
                               claray_bvh** bvh) {
    return guarded([&] {
        static_cast<void>(required(mesh, "mesh"));
        const Device& on = required(device, "device").device;
        const TriangleBuffers buffers = upload(on, versioned(mesh, "mesh"));
        hand_out(bvh, "bvh", [&] { return new claray_bvh{Bvh::build(on, buffers, config_of(config))}; });
    });
}

claray_status claray_bvh_scene_build(claray_device* device, const claray_scene* scene, const claray_bvh_config* config,
                                     claray_bvh** bvh) {
    return guarded([&] {
        const Scene& from = required(scene, "scene").scene;
        std::vector<Mesh> placed;
        for (const MeshInstance& instance : from.instances)
            placed.push_back(transformed(element(from.meshes, instance.mesh, "meshes", "scene: a placement's mesh"),
                                         instance.transform));
        hand_out(bvh, "bvh", [&] {
            return new claray_bvh{Bvh::build(required(device, "device").device,
                                             from.instances.empty() ? from.meshes : placed, config_of(config))};
        });
    });
}

claray_status claray_bvh_buffers_build(claray_device* device, const claray_triangle_buffers* buffers,
                                       const claray_bvh_config* config, claray_bvh** bvh) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const TriangleBuffers triangles = share(on, versioned(&required(buffers, "buffers"), "buffers"));
        hand_out(bvh, "bvh", [&] { return new claray_bvh{Bvh::build(on, triangles, config_of(config))}; });
    });
}

claray_status claray_bvh_buffers_get(const claray_bvh* bvh, claray_triangle_buffers* buffers) {
    return guarded([&] {
        const TriangleBuffers& of = required(bvh, "bvh").bvh.triangles();
        claray_triangle_buffers known{};
        known.vertices = of.positions.memory()(), known.vertex_count = of.positions.size() / 3;
        known.triangles = of.indices.memory()(), known.triangle_count = of.indices.size() / 3;
        known.geometries = of.geometries.memory()();
        known.masks = of.masks.memory()(), known.mask_count = of.masks.size();
        give(buffers, known, "buffers");
    });
}

claray_status claray_bvh_memory_needed(const claray_device* device, size_t vertex_count, size_t triangle_count,
                                       const claray_bvh_config* config, uint64_t* bytes, uint64_t* largest) {
    return guarded([&] {
        const BvhMemory needed =
            Bvh::memory_needed(required(device, "device").device, vertex_count, triangle_count, config_of(config));
        required(bytes, "bytes") = needed.bytes;
        if (largest) *largest = needed.largest_buffer;
    });
}

claray_status claray_bvh_load(claray_device* device, const char* path, claray_bvh** bvh) {
    return claray_bvh_layout_load(device, path, CLARAY_LAYOUT_AUTOMATIC, bvh);
}

claray_status claray_bvh_layout_load(claray_device* device, const char* path, claray_layout layout, claray_bvh** bvh) {
    return guarded([&] {
        hand_out(bvh, "bvh", [&] {
            return new claray_bvh{
                Bvh::load(required(device, "device").device, &required(path, "path"), enumerator(layout, "layout"))};
        });
    });
}

claray_status claray_bvh_save(const claray_bvh* bvh, const char* path) {
    return guarded([&] { required(bvh, "bvh").bvh.save(&required(path, "path")); });
}

claray_status claray_bvh_move(claray_bvh* bvh, const float* vertices, size_t vertex_count, int rebuild) {
    return guarded([&] {
        Bvh& moved = required(bvh, "bvh").bvh;
        Buffer<float> positions = moved.triangles().positions;
        if (3 * vertex_count != positions.size())
            refuse("vertex_count is " + std::to_string(vertex_count) + ", and the structure has " +
                   std::to_string(positions.size() / 3) + " vertices");
        positions.write(array(vertices, 3 * vertex_count, "vertices"));
        rebuild != 0 ? moved.rebuild() : moved.refit();
    });
}

claray_status claray_bvh_update(claray_bvh* bvh, int rebuild) {
    return guarded([&] {
        Bvh& changed = required(bvh, "bvh").bvh;
        rebuild != 0 ? changed.rebuild() : changed.refit();
    });
}

claray_status claray_bvh_cost_growth(const claray_bvh* bvh, double* growth) {
    return guarded([&] { required(growth, "growth") = required(bvh, "bvh").bvh.cost_growth(); });
}

claray_status claray_bvh_is_closed(const claray_bvh* bvh, int* closed) {
    return guarded([&] { required(closed, "closed") = is_closed(required(bvh, "bvh").bvh) ? 1 : 0; });
}
int claray_bvh_is_replaced(const claray_bvh* bvh) { return bvh && is_replaced(bvh->bvh) ? 1 : 0; }
size_t claray_bvh_triangle_count(const claray_bvh* bvh) { return bvh ? bvh->bvh.triangle_count() : 0; }

claray_status claray_bvh_statistics_get(const claray_bvh* bvh, claray_bvh_statistics* statistics) {
    return guarded([&] {
        const Bvh& of = required(bvh, "bvh").bvh;
        auto known = put_into<claray_bvh_statistics>(of.statistics());
        put(known.layout, of.layout());
        give(statistics, known, "statistics");
    });
}

claray_status claray_bvh_validate(const claray_bvh* bvh, claray_bvh_validation* validation) {
    return guarded(
        [&] { give(validation, put_into<claray_bvh_validation>(required(bvh, "bvh").bvh.validate()), "validation"); });
}

claray_status claray_bvh_hash(const claray_bvh* bvh, char hash[33]) {
    return guarded([&] {
        const std::string digits = required(bvh, "bvh").bvh.hash();
        std::memcpy(&required(hash, "hash"), digits.c_str(), digits.size() + 1);
    });
}

void claray_bvh_release(claray_bvh* bvh) { delete bvh; }
