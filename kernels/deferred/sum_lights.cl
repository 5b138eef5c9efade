// Direct light of all lights without extent, without shadows, at the first surfaces of camera rays: each pixel sums over the list of
// its tile (list_lights.cl).
#include "deferred/tiles.clh"
#include "render/queue.clh"
#include "render/shade_hit.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif

/// The light of one light that the surface reflects to the viewer.
static inline float3 reflected_light(const ShadingPoint* at, float3 from, PunctualLight light) {
    LightView view;
    if (!PUNCTUAL_LIGHTS || !view_punctual_light(light, 1.0f, from, (float2)(0.0f), &view)) return (float3)(0.0f);
    bool viewers_side = dot_product(view.direction, at->surface.geometric) > 0.0f;
    // As in view_light_beside: rounded surfaces are lit as far as their normals allow.
    if (NORMALS) viewers_side |= largest(fabs(at->surface.lift)) > 0.0f && dot_product(view.direction, at->surface.shading) > 0.0f;
    if (!viewers_side && !is_translucent(&at->material)) return (float3)(0.0f);
    const float3 incoming = to_local(at->frame, view.direction);
    if (is_above(&at->material, incoming) != viewers_side) return (float3)(0.0f);
    float pdf;
    return eval_bsdf(&at->material, &at->view, incoming, &pdf) * view.radiance;
}

/// The light that the surface reflects to the viewer, of all lights of a list.
static inline float3 sum_of_list(const Lights* lights, TileLights list, float3 from, const ShadingPoint* at) {
    float3 sum = (float3)(0.0f);
    for (uint i = 0; i < list.count; ++i) sum += reflected_light(at, from, lights->punctual[light_in_list(list, i)]);
    return sum;
}

static inline PathState state_of_path(const Step* step, global const RayQueue* queue, uint path) {
    return queued_state(&states_of_queue((global RayQueue*)queue, step->room)[path]);
}

static inline float time_of_path(const Step* step, global const RayQueue* queue, uint path) {
    return INSTANCE_MOTION ? times_of_queue((global RayQueue*)queue, step->room)[path] : 0.0f;
}

/// Follows a path to its first surface. Returns false if no light is reflected there; else `at` is ready to reflect it. `last` may be
/// null.
static inline bool arrive_first(LastTriangle* last, const Step* step, const Lights* lights, SCENE_PARAMETERS, global const RayQueue* queue,
                                global const SceneHit* hits, uint path, float3* radiance, ShadingPoint* at) {
    const Ray ray = queued_ray((global const Ray*)queue + path);
    const PathSegment segment = camera_segment(&step->frame, ray, time_of_path(step, queue, path));
    PathState state = state_of_path(step, queue, path);
    if (!arrive(last, step, lights, 0, SCENE, &segment, hits[path], 0, &state, radiance, at)) return false;
    if (is_delta(&at->material)) return false;
    const SurfaceSamples samples = samples_at(samples_of(state, step->frame.seed), 0);
    float lobe;
    prepare_shading(&step->frame, SCENE, &samples, (float3)(-ray.dx, -ray.dy, -ray.dz), at, &lobe);
    return true;
}

/// The radiance of one path: the light of the points that stand for its hit. All lights are summed up, since these points may be
/// outside the tile's box.
static CLARAY_OUTLINED float3 sum_of_lit(const Step* step, const Lights* lights, SCENE_PARAMETERS, const TileGrid* tiles,
                                global const RayQueue* queue, global const SceneHit* hits, uint path) {
    const Ray ray = queued_ray((global const Ray*)queue + path);
    const TileLights all = {0, tiles->lights};
    const SceneHit found = hits[path];
    float3 sum;
    ShadingPoint there;
    if (!arrive_first(0, step, lights, SCENE, queue, hits, path, &sum, &there)) return sum;
    const Hit hit = hit_of(found INSTANCE_BUFFERS);
    if (!is_lit_elsewhere(&there.material) || IS_PRIMITIVE(hit)) return sum + sum_of_list(lights, all, met_point(ray, found.t), &there);
    const float time = time_of_path(step, queue, path);
    const SurfaceSamples samples = samples_at(samples_of(state_of_path(step, queue, path), step->frame.seed), 0);
    for (uint i = 0; i < LIT_POINTS; ++i) {
        ShadingPoint at = there;
        const float3 direction = move_to_lit(&step->frame, SCENE, found, hit, i, time, ray, &at);
        float lobe;
        prepare_shading(&step->frame, SCENE, &samples, -direction, &at, &lobe);
        sum += share_of_lit(hit, i) * sum_of_list(lights, all, at.surface.base + at.surface.inner, &at);
    }
    return sum;
}

#if CLARAY_CPU
#if !SHADING
#include "deferred/sum_sixteen.clh"
#endif

/// One work-item per tile.
kernel void sum_lights(Step step, SCENE_PARAMETERS, TileGrid tiles, global const uint* block_lists, global const uint* lists,
                       global const RayQueue* queue, global const SceneHit* hits, global float* radiance) {
    const uint tile = get_global_id(0);
    if (tile >= tiles.columns * tiles.rows) return;
    const Lights lights = lights_of(&step.frame, SCENE);
    const TileLights list = lights_of_tile(&tiles, lists, block_lists, tile);
#if !SHADING
    FlatTriangle triangles[FLAT_TRIANGLES];
    for (uint i = 0; i < FLAT_TRIANGLES; ++i) triangles[i].primitive = CLARAY_MISS;
#endif
    for (uint row = 0; row < CLARAY_TILE; ++row) {
        const PathRange paths = paths_of_row(&step, &tiles, tile, row);
#if SHADING
        for (uint path = paths.first; path < paths.end; ++path)
            vstore3(sum_of_lit(&step, &lights, SCENE, &tiles, queue, hits, path), path, radiance);
#else
        for (uint first = paths.first; first < paths.end; first += 16)
            sum_sixteen(triangles, &step, &lights, SCENE, list, queue, hits, first, min(first + 16, paths.end), radiance);
#endif
    }
}
#else
/// One work-item per path, tile by tile.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void sum_lights(Step step, SCENE_PARAMETERS, TileGrid tiles, global const uint* block_lists, global const uint* lists,
                global const RayQueue* queue, global const SceneHit* hits, global float* radiance) {
    const uint per_row = CLARAY_TILE * step.batch.samples, item = get_global_id(0);
    const uint tile = item / (CLARAY_TILE * per_row);
    if (tile >= tiles.columns * tiles.rows) return;
    const PathRange paths = paths_of_row(&step, &tiles, tile, item / per_row % CLARAY_TILE);
    const uint path = paths.first + item % per_row;
    if (path >= paths.end) return;
    const Lights lights = lights_of(&step.frame, SCENE);
#if SHADING
    vstore3(sum_of_lit(&step, &lights, SCENE, &tiles, queue, hits, path), path, radiance);
#else
    float3 sum;
    ShadingPoint at;
    if (arrive_first(0, &step, &lights, SCENE, queue, hits, path, &sum, &at))
        sum += sum_of_list(&lights, lights_of_tile(&tiles, lists, block_lists, tile),
                           met_point(queued_ray((global const Ray*)queue + path), hits[path].t), &at);
    vstore3(sum, path, radiance);
#endif
}
#endif
