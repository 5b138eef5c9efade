/* The C interface of claray: exact ray queries and path tracing by OpenCL.
 *
 * Functions return CLARAY_OK or the kind of the error; claray_last_error() tells what failed, where, and what to do. A
 * handle made by a function that ends in _open, _load, _build or _create is released by the _release function of its
 * type; releasing NULL does nothing. A handle keeps those alive that it was made from. Do not use the handles of one
 * device from two threads at once; claray_device_new_queue makes a device for another thread.
 *
 * Every struct with a member struct_size begins with it. Set it to sizeof of the struct, and all other members to 0 for
 * their defaults, as in  claray_mesh mesh = {sizeof mesh}.  A later version only adds members at the end. */
#ifndef CLARAY_H
#define CLARAY_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define CLARAY_API __attribute__((visibility("default")))
#else
#define CLARAY_API
#endif

typedef enum claray_status {
    CLARAY_OK = 0,
    CLARAY_ERROR_INPUT = 1,   /* a file, mesh or scene that cannot be used, or a full disk */
    CLARAY_ERROR_USAGE = 2,   /* an invalid argument */
    CLARAY_ERROR_DEVICE = 3,  /* OpenCL: no platform, a failed kernel build, out of device memory */
    CLARAY_ERROR_INTERNAL = 4 /* out of host memory, or a bug */
} claray_status;

typedef struct claray_device claray_device;
typedef struct claray_bvh claray_bvh;
typedef struct claray_query claray_query;
typedef struct claray_scene claray_scene;
typedef struct claray_renderer claray_renderer;

/* One line about the last error of this thread, valid until its next error; "" if there was none. */
CLARAY_API const char* claray_last_error(void);
/* The version of the library, such as "0.1.0". */
CLARAY_API const char* claray_version(void);

/* ---- devices ---- */

/* selector: "cpu", "gpu", an index, or a part of the name; NULL or "": $CLARAY_DEVICE, else the first GPU, else the
 * first. */
CLARAY_API claray_status claray_device_open(const char* selector, claray_device** device);
/* Uses a cl_context and an in-order cl_command_queue of the program; both are retained. */
CLARAY_API claray_status claray_device_adopt_create(void* context, void* queue, claray_device** device);
/* The same device and context with another in-order queue. */
CLARAY_API claray_status claray_device_new_queue_create(claray_device* device, claray_device** with_queue);
/* Valid while the handle is. */
CLARAY_API const char* claray_device_name(const claray_device* device);
/* The cl_context and cl_command_queue, not retained. */
CLARAY_API void* claray_device_context(const claray_device* device);
CLARAY_API void* claray_device_queue(const claray_device* device);
/* Waits for all commands of the queue. */
CLARAY_API claray_status claray_device_finish(claray_device* device);
CLARAY_API void claray_device_release(claray_device* device);

/* ---- structures ---- */

typedef enum claray_builder {
    CLARAY_BUILDER_AUTOMATIC = 0, /* the default: high on GPUs, else balanced */
    CLARAY_BUILDER_FAST = 1,      /* fastest to build */
    CLARAY_BUILDER_BALANCED = 2,  /* better tree, slower */
    CLARAY_BUILDER_HIGH = 3,      /* best tree, slowest; splits large triangles */
    CLARAY_BUILDER_BINNED = 4     /* binned SAH, nothing split: for geometry that is refitted */
} claray_builder;

typedef struct claray_mesh {
    size_t struct_size;
    const float* vertices; /* 3 floats for each vertex */
    size_t vertex_count;
    const uint32_t* triangles; /* 3 indices of vertices for each triangle; counter-clockwise in front */
    size_t triangle_count;
    const uint32_t* geometries; /* one for each triangle; NULL: all belong to geometry 0 */
    const uint32_t* masks;      /* one for each geometry: rays see it if their masks share a bit; NULL: all see all */
    size_t mask_count;
} claray_mesh;

typedef struct claray_bvh_config {
    size_t struct_size;
    claray_builder builder;
    float split_budget; /* CLARAY_BUILDER_HIGH: additional references per triangle; 0: 0.5, < 0: none */
    int learns; /* whether queries may replace the tree by a better one, once rays have been traced for long enough
                   (docs/queries.md); > 0: yes, < 0: no, 0: if the builder is CLARAY_BUILDER_AUTOMATIC */
} claray_bvh_config;

/* Copies the mesh to the device. config: NULL for the defaults. */
CLARAY_API claray_status claray_bvh_build(claray_device* device, const claray_mesh* mesh,
                                          const claray_bvh_config* config, claray_bvh** bvh);
/* Over the meshes of a scene, in world space; each is a geometry. */
CLARAY_API claray_status claray_bvh_scene_build(claray_device* device, const claray_scene* scene,
                                                const claray_bvh_config* config, claray_bvh** bvh);
CLARAY_API claray_status claray_bvh_load(claray_device* device, const char* path, claray_bvh** bvh);
CLARAY_API claray_status claray_bvh_save(const claray_bvh* bvh, const char* path);
/* Moves the vertices, as many as before. rebuild: 0 keeps the tree (fast, but queries get slower), else builds it
 * again. */
CLARAY_API claray_status claray_bvh_move(claray_bvh* bvh, const float* vertices, size_t vertex_count, int rebuild);
CLARAY_API size_t claray_bvh_triangle_count(const claray_bvh* bvh);
/* Writes 1 if the triangles close, else 0: if every edge belongs to an even number of them. Edges are the same if the
 * coordinates of their ends are. Blocks. */
CLARAY_API claray_status claray_bvh_is_closed(const claray_bvh* bvh, int* closed);
/* 1 if queries trace a better tree than the one that was built: see claray_bvh_config. */
CLARAY_API int claray_bvh_is_replaced(const claray_bvh* bvh);
CLARAY_API void claray_bvh_release(claray_bvh* bvh);

/* ---- queries ---- */

/* A ray hits at distances tmin < t <= tmax, in units of the direction's length. tmin must not be negative. Rays that
 * are not finite hit nothing. */
typedef struct claray_ray {
    float origin[3];
    float tmin;
    float direction[3];
    float tmax;
} claray_ray;

#ifndef CLARAY_MISS
#define CLARAY_MISS 0xffffffffu
#endif

/* The hit point is (1 - u - v) v0 + u v1 + v v2. */
typedef struct claray_hit {
    float t; /* tmax on a miss */
    float u, v;
    uint32_t primitive; /* index of the triangle; CLARAY_MISS on a miss */
    uint32_t geometry;
} claray_hit;

typedef enum claray_query_kind { CLARAY_QUERY_CLOSEST = 0, CLARAY_QUERY_ANY = 1 } claray_query_kind;
typedef enum claray_coherence {
    CLARAY_COHERENCE_AUTOMATIC = 0, /* decided by a sample of the rays, which on CPUs is waited for */
    CLARAY_COHERENCE_COHERENT = 1,  /* neighbouring rays have similar directions */
    CLARAY_COHERENCE_INCOHERENT = 2
} claray_coherence;

typedef struct claray_query_options {
    size_t struct_size;
    int cull_back_faces; /* hit only triangles whose vertices appear counter-clockwise */
    int closed;          /* rays that only touch a surface hit it */
    claray_coherence coherence;
} claray_query_options;

/* A query that is made once, which loads its kernels, and run often. options: NULL for the defaults. queue: NULL, or a
 * device from claray_device_new_queue_create on whose queue it runs. */
CLARAY_API claray_status claray_query_create(const claray_bvh* bvh, claray_query_kind kind,
                                             const claray_query_options* options, claray_device* queue,
                                             claray_query** query);
/* Rays and results in host memory, which CPUs use in place. results: `count` claray_hit, or bytes (1: hit) for
 * CLARAY_QUERY_ANY. Blocks. */
CLARAY_API claray_status claray_query_run(claray_query* query, const claray_ray* rays, size_t count, void* results);
/* Rays and results in buffers (cl_mem) of the device's context. Waits for the events (cl_event) before, and returns an
 * event in *event unless that is NULL; release it by clReleaseEvent. Asynchronous with a coherence that is not
 * automatic. Sizes and contexts are checked before anything is enqueued. */
CLARAY_API claray_status claray_query_enqueue(claray_query* query, void* rays, void* results, size_t count,
                                              const void* const* wait_for, size_t wait_count, void** event);
CLARAY_API void claray_query_release(claray_query* query);

/* The same for one call. */
CLARAY_API claray_status claray_closest_hit(const claray_bvh* bvh, const claray_ray* rays, size_t count,
                                            claray_hit* hits);
CLARAY_API claray_status claray_any_hit(const claray_bvh* bvh, const claray_ray* rays, size_t count, uint8_t* occluded);

/* Counts the triangles that each ray hits; one through an edge counts once. counts: `count` numbers. Blocks. */
CLARAY_API claray_status claray_count_hits(const claray_bvh* bvh, const claray_ray* rays, size_t count,
                                           uint32_t* counts);
/* The `most` nearest hits of each ray, in order of distance. Those of ray i are hits[i * most] .. hits[i * most +
 * counts[i] - 1]; what follows them is undefined. hits: count * most elements. counts: `count` numbers. Blocks. */
CLARAY_API claray_status claray_nearest_hits(const claray_bvh* bvh, const claray_ray* rays, size_t count, uint32_t most,
                                             claray_hit* hits, uint32_t* counts);

/* ---- points ---- */

typedef struct claray_nearest {
    float point[3];     /* of the surface; the query's own point if nothing is in reach */
    float distance;     /* reach if nothing is in reach */
    float u, v;         /* as of a hit */
    uint32_t primitive; /* index of the triangle; CLARAY_MISS if nothing is in reach */
    uint32_t geometry;
} claray_nearest;

/* The point of the surface that is nearest to each point. points: 3 floats for each. reach: the largest distance at
 * which one is found; INFINITY: any. nearest: `count` elements. Points that are not finite find nothing. Blocks. */
CLARAY_API claray_status claray_nearest_point(const claray_bvh* bvh, const float* points, size_t count, float reach,
                                              claray_nearest* nearest);
/* Writes 1 for each point inside of the closed mesh, else 0. An open mesh (claray_bvh_is_closed) has no inside: a point
 * is then called inside if the ray from it along +z crosses the surface an odd number of times. Blocks. */
CLARAY_API claray_status claray_inside(const claray_bvh* bvh, const float* points, size_t count, uint8_t* inside);
/* The distance of each point to the surface of the closed mesh, negative inside (as of claray_inside). Blocks. */
CLARAY_API claray_status claray_signed_distance(const claray_bvh* bvh, const float* points, size_t count,
                                                float* distances);

/* ---- instances ---- */

typedef struct claray_instances claray_instances;

typedef struct claray_instance {
    float transform[12]; /* from the structure to the world: 3 rows of 4 floats, the translation last in each */
    uint32_t bottom;     /* index of its structure */
    uint32_t mask;       /* a ray sees it if their masks share a bit; rays of this interface see all but 0 */
} claray_instance;

typedef struct claray_instance_hit {
    float t;
    float u, v;
    uint32_t primitive; /* of the instance's structure, as geometry */
    uint32_t geometry;
    uint32_t instance; /* CLARAY_MISS on a miss */
} claray_instance_hit;

/* A structure over placements of structures of one device. Instances whose transform cannot be inverted are left out.
 */
CLARAY_API claray_status claray_instances_build(const claray_bvh* const* bvhs, size_t bvh_count,
                                                const claray_instance* instances, size_t count,
                                                claray_instances** placed);
/* Moves the instances, as many as before. rebuild: as of claray_bvh_move. */
CLARAY_API claray_status claray_instances_move(claray_instances* placed, const claray_instance* instances, size_t count,
                                               int rebuild);

typedef struct claray_instance_group {
    const claray_instance* members; /* placed together by an instance of the group */
    size_t count;
} claray_instance_group;
typedef struct claray_flat_instances claray_flat_instances;

/* Instances of several levels as those of one, for claray_instances_build. An instance whose bottom is below `bottoms`
 * is one of a structure, else one of groups[bottom - bottoms]; groups may hold groups. Transforms are multiplied; a
 * flat instance has the bits of all masks on its way. The order is that of a depth-first walk. */
CLARAY_API claray_status claray_flat_instances_create(const claray_instance* roots, size_t root_count,
                                                      const claray_instance_group* groups, size_t group_count,
                                                      uint32_t bottoms, claray_flat_instances** flat);
CLARAY_API size_t claray_flat_instances_count(const claray_flat_instances* flat);
/* Valid while the handle is. */
CLARAY_API const claray_instance* claray_flat_instances_members(const claray_flat_instances* flat);
/* How instance i is reached: the index of a root, then that of a member in its group, and so on. Returns NULL and a
 * count of 0 if there is no instance i; else valid while the handle is. */
CLARAY_API const uint32_t* claray_flat_instances_steps(const claray_flat_instances* flat, size_t i, size_t* count);
CLARAY_API void claray_flat_instances_release(claray_flat_instances* flat);

/* As claray_query_create. Results are claray_instance_hit, or bytes for CLARAY_QUERY_ANY. */
CLARAY_API claray_status claray_query_instances_create(const claray_instances* placed, claray_query_kind kind,
                                                       const claray_query_options* options, claray_device* queue,
                                                       claray_query** query);
CLARAY_API void claray_instances_release(claray_instances* placed);

/* ---- primitives that are not triangles ---- */

typedef struct claray_primitives claray_primitives;

typedef struct claray_primitive_kind {
    size_t struct_size;
    const char* name;   /* without a source "spheres", "discs" or "cylinders", else for messages */
    const char* source; /* OpenCL C that defines bounds_of and intersect (docs/queries.md); NULL: a kind of claray */
    uint32_t floats;    /* in the data for each primitive, with a source: 1 or more */
} claray_primitive_kind;

/* A structure over `count` primitives. data of a sphere: 4 floats (centre, radius). Of a disc: 8 (centre, radius,
 * normal, radius of the hole). Of a cylinder: 8 (start, radius, end, 1 with caps or 0). Else kind->floats for each. */
CLARAY_API claray_status claray_primitives_build(claray_device* device, const claray_primitive_kind* kind,
                                                 const float* data, size_t count, claray_primitives** primitives);
/* Curves, of 4 control points for each segment, from the index in `segments` on. points: x, y, z and radius of each.
 * bezier: 0 for uniform B-splines. flat: 0 for round curves, else ribbons that face every ray. */
CLARAY_API claray_status claray_curves_build(claray_device* device, const float* points, size_t point_count,
                                             const uint32_t* segments, size_t segment_count, int bezier, int flat,
                                             claray_primitives** primitives);
/* The closest hits, with the index of the primitive; u and v are what the kind sets. Block. The functions for points
 * and for all hits of a ray are for triangles. */
CLARAY_API claray_status claray_primitives_closest_hit(const claray_primitives* primitives, const claray_ray* rays,
                                                       size_t count, claray_hit* hits);
CLARAY_API claray_status claray_primitives_any_hit(const claray_primitives* primitives, const claray_ray* rays,
                                                   size_t count, uint8_t* occluded);
CLARAY_API void claray_primitives_release(claray_primitives* primitives);

/* ---- scenes and images ---- */

/* A file (.obj, .ply, .stl, .gltf, .glb) or a built-in scene, such as "cornell". */
CLARAY_API claray_status claray_scene_load(const char* name_or_path, claray_scene** scene);
CLARAY_API size_t claray_scene_triangle_count(const claray_scene* scene);

typedef struct claray_primitive_set {
    size_t struct_size;
    const char* kind;    /* "spheres", "discs", "cylinders", "curves" (B-splines), "bezier curves", "flat curves" or
                          * "flat bezier curves" */
    const float* points; /* 4 floats for each point; as of claray_primitives_build and claray_curves_build */
    size_t point_count;  /* one for each sphere, two for each disc or cylinder; control points of curves */
    const uint32_t* segments; /* of curves: the first control point of each; else NULL */
    size_t segment_count;
    const float* colors;       /* NULL, or 2 RGB for each primitive, at both ends, that multiply the albedo; 0..1 */
    const uint32_t* materials; /* one of the scene for each primitive; NULL: all get a new one, white and diffuse */
} claray_primitive_set;

/* Adds primitives, in world space, which are rendered as they are. Copies the arrays. Materials
 * must have no texture and no opacity. A scattered ray finds light that primitives emit, a light sample does not.
 * Structures of the scene (claray_bvh_scene_build) are over its meshes alone. */
CLARAY_API claray_status claray_scene_add_primitives(claray_scene* scene, const claray_primitive_set* set);
/* Of all sets that were added. */
CLARAY_API size_t claray_scene_primitive_count(const claray_scene* scene);
CLARAY_API void claray_scene_release(claray_scene* scene);

typedef struct claray_render_config {
    size_t struct_size;
    uint32_t width, height; /* pixels; 0: 512 */
    uint32_t spp;           /* samples per pixel at which rendering stops; 0: 64 */
    uint32_t max_depth;     /* surfaces per path; 0: 128 */
    uint32_t seed;
    double seconds; /* > 0: stop after this time */
    double noise;   /* > 0: stop at this relative standard error */
    double error;   /* > 0: stop at this error, RMSE over the mean */
} claray_render_config;

typedef struct claray_progress {
    size_t struct_size;
    uint32_t spp;
    double seconds, noise, error;
} claray_progress;

/* Return 0 to stop. */
typedef int (*claray_progress_callback)(const claray_progress* progress, void* user);

CLARAY_API claray_status claray_renderer_create(claray_device* device, const claray_scene* scene,
                                                const claray_render_config* config, claray_renderer** renderer);
/* Adds samples until a target is reached. Blocks. callback: NULL, or called several times a second. reached: NULL, or
 * receives the progress; set its struct_size. */
CLARAY_API claray_status claray_renderer_render(claray_renderer* renderer, claray_progress_callback callback,
                                                void* user, claray_progress* reached);
/* The mean linear radiance: 3 floats for each pixel, row by row from the top left. count: floats in rgb, 3 width
 * height. */
CLARAY_API claray_status claray_renderer_image(claray_renderer* renderer, float* rgb, size_t count);
CLARAY_API void claray_renderer_release(claray_renderer* renderer);

#ifdef __cplusplus
}
#endif

#endif
