// claray.h: structures and queries.
#include "claray/query/all_hits.hpp"
#include "claray/scene.hpp"
#include "host/capi/capi.hpp"
#include "host/capi/scene.hpp"
#include "host/scene/placement.hpp"

using namespace claray;
using namespace claray::capi;

namespace {

static_assert(sizeof(claray_ray) == sizeof(Ray) && sizeof(claray_hit) == sizeof(Hit));

std::span<const Ray> rays_of(const claray_ray* rays, std::size_t count) {
    return {reinterpret_cast<const Ray*>(count != 0 ? &required(rays, "rays") : rays), count};
}

Bvh::Config config_of(const claray_bvh_config* given) {
    if (!given) return {};
    const claray_bvh_config known = versioned(given, "config");
    Bvh::Config config;
    const int builder = number_of(known.builder);
    if (builder < 0 || builder > int(std::size(builders)))
        throw Error(ErrorKind::usage, "config.builder is " + std::to_string(builder), "use a claray_builder");
    static_assert(CLARAY_BUILDER_AUTOMATIC == 0 && CLARAY_BUILDER_BINNED == int(Builder::binned) + 1);
    if (builder != CLARAY_BUILDER_AUTOMATIC) config.builder = Builder(builder - 1);
    if (known.split_budget != 0) config.split_budget = known.split_budget < 0 ? 0 : double(known.split_budget);
    if (known.learns != 0) config.learns = known.learns > 0;
    return config;
}

void check_indices(const claray_mesh& mesh) {
    if (mesh.triangle_count == 0) throw Error(ErrorKind::usage, "mesh.triangle_count is 0");
    for (std::size_t i = 0; i < 3 * mesh.triangle_count; ++i)
        if (mesh.triangles[i] >= mesh.vertex_count)
            throw Error(ErrorKind::usage, "mesh.triangles: triangle " + std::to_string(i / 3) + " has the vertex " +
                                              std::to_string(mesh.triangles[i]) + " of " +
                                              std::to_string(mesh.vertex_count));
    for (std::size_t i = 0; mesh.geometries && mesh.masks && i < mesh.triangle_count; ++i)
        if (mesh.geometries[i] >= mesh.mask_count)
            throw Error(ErrorKind::usage,
                        "mesh.masks: there is none for geometry " + std::to_string(mesh.geometries[i]));
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

/// Calls `use` with a value of the type of the query's results.
template <class Use>
void with_result(const claray_query& query, const Use& use) {
    if (query.kind == CLARAY_QUERY_ANY)
        use(std::uint8_t());
    else if (query.of_instances)
        use(InstanceHit());
    else
        use(Hit());
}

void run(claray_query& query, const claray_ray* rays, std::size_t count, void* results) {
    if (count == 0) return;
    static_cast<void>(required(rays, "rays"));
    if (results == nullptr) throw Error(ErrorKind::usage, "results is NULL");
    with_result(query, [&](auto result) {
        query.query.run(rays_of(rays, count), std::span(static_cast<decltype(result)*>(results), count));
    });
}

void enqueue(claray_query& query, cl_mem rays, cl_mem results, std::size_t count, const std::vector<cl::Event>& events,
             void** event) {
    const Device& device = query.query.device();
    const auto device_rays = Buffer<Ray>::adopt(device, rays, count);
    with_result(query, [&](auto result) {
        auto memory = Buffer<decltype(result)>::adopt(device, results, count);
        const cl::Event end = query.query.run(device_rays, memory, events);
        if (event == nullptr) return;
        clRetainEvent(end());
        *event = end();
    });
}

}  // namespace

namespace claray::capi {

QueryOptions options_of(const claray_query_options* given) {
    const claray_query_options known = versioned(given, "options");
    const int coherence = number_of(known.coherence);
    if (coherence < 0 || coherence > CLARAY_COHERENCE_INCOHERENT)
        throw Error(ErrorKind::usage, "options.coherence is " + std::to_string(coherence), "use a claray_coherence");
    QueryOptions options;
    options.cull_back_faces = known.cull_back_faces != 0;
    options.closed = known.closed != 0;
    options.coherence = Coherence(coherence);
    return options;
}

QueryKind kind_of(const claray_query_kind& kind) {
    const int number = number_of(kind);
    if (number != CLARAY_QUERY_CLOSEST && number != CLARAY_QUERY_ANY)
        throw Error(ErrorKind::usage, "kind is " + std::to_string(number), "use a claray_query_kind");
    return number == CLARAY_QUERY_ANY ? QueryKind::any : QueryKind::closest;
}

}  // namespace claray::capi

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
            placed.push_back(transformed(from.meshes.at(instance.mesh), instance.transform));
        hand_out(bvh, "bvh", [&] {
            return new claray_bvh{Bvh::build(required(device, "device").device,
                                             from.instances.empty() ? from.meshes : placed, config_of(config))};
        });
    });
}

claray_status claray_bvh_load(claray_device* device, const char* path, claray_bvh** bvh) {
    return guarded([&] {
        hand_out(bvh, "bvh",
                 [&] { return new claray_bvh{Bvh::load(required(device, "device").device, &required(path, "path"))}; });
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
            throw Error(ErrorKind::usage, "vertex_count is " + std::to_string(vertex_count) +
                                              ", and the structure has " + std::to_string(positions.size() / 3) +
                                              " vertices");
        positions.write(array(vertices, 3 * vertex_count, "vertices"));
        rebuild != 0 ? moved.rebuild() : moved.refit();
    });
}

claray_status claray_bvh_is_closed(const claray_bvh* bvh, int* closed) {
    return guarded([&] { required(closed, "closed") = is_closed(required(bvh, "bvh").bvh) ? 1 : 0; });
}
int claray_bvh_is_replaced(const claray_bvh* bvh) { return bvh && is_replaced(bvh->bvh) ? 1 : 0; }
size_t claray_bvh_triangle_count(const claray_bvh* bvh) { return bvh ? bvh->bvh.triangle_count() : 0; }
void claray_bvh_release(claray_bvh* bvh) { delete bvh; }

claray_status claray_query_create(const claray_bvh* bvh, claray_query_kind kind, const claray_query_options* options,
                                  claray_device* queue, claray_query** query) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        hand_out(query, "query", [&] {
            Query made(over, kind_of(kind), options_of(options), queue ? queue->device : over.device());
            return new claray_query{kind, std::move(made), false};  // `kind` is checked
        });
    });
}

claray_status claray_query_run(claray_query* query, const claray_ray* rays, size_t count, void* results) {
    return guarded([&] { run(required(query, "query"), rays, count, results); });
}

claray_status claray_query_enqueue(claray_query* query, void* rays, void* results, size_t count,
                                   const void* const* wait_for, size_t wait_count, void** event) {
    return guarded([&] {
        claray_query& enqueued = required(query, "query");
        std::vector<cl::Event> events;
        for (const void* one : array(wait_for, wait_count, "wait_for")) {
            if (one == nullptr) throw Error(ErrorKind::usage, "wait_for holds NULL");
            events.emplace_back(static_cast<cl_event>(const_cast<void*>(one)), true);
        }
        enqueue(enqueued, static_cast<cl_mem>(rays), static_cast<cl_mem>(results), count, events, event);
    });
}

void claray_query_release(claray_query* query) { delete query; }

claray_status claray_closest_hit(const claray_bvh* bvh, const claray_ray* rays, size_t count, claray_hit* hits) {
    return guarded([&] {
        claray_query query{CLARAY_QUERY_CLOSEST, Query(required(bvh, "bvh").bvh, QueryKind::closest), false};
        run(query, rays, count, hits);
    });
}

claray_status claray_any_hit(const claray_bvh* bvh, const claray_ray* rays, size_t count, uint8_t* occluded) {
    return guarded([&] {
        claray_query query{CLARAY_QUERY_ANY, Query(required(bvh, "bvh").bvh, QueryKind::any), false};
        run(query, rays, count, occluded);
    });
}

claray_status claray_count_hits(const claray_bvh* bvh, const claray_ray* rays, size_t count, uint32_t* counts) {
    return guarded([&] {
        const std::vector<std::uint32_t> all = count_hits(required(bvh, "bvh").bvh, rays_of(rays, count));
        if (count != 0) std::copy(all.begin(), all.end(), &required(counts, "counts"));
    });
}

claray_status claray_nearest_hits(const claray_bvh* bvh, const claray_ray* rays, size_t count, uint32_t most,
                                  claray_hit* hits, uint32_t* counts) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        const std::span all = rays_of(rays, count);
        if (most == 0) throw Error(ErrorKind::usage, "most is 0", "ask for at least one hit");
        if (count == 0) return;
        const std::span found(reinterpret_cast<Hit*>(&required(hits, "hits")), count * most);
        const std::span numbers(&required(counts, "counts"), count);
        auto hit_buffer = Buffer<Hit>::under(over.device(), found);
        auto count_buffer = Buffer<std::uint32_t>::under(over.device(), numbers);
        nearest_hits(over, Buffer<Ray>::over(over.device(), all), most, hit_buffer, count_buffer);
        hit_buffer.fetch(found);
        count_buffer.fetch(numbers);
    });
}
