/* The C interface of claray: exact ray queries and path tracing by OpenCL.
 *
 * Functions return CLARAY_OK or the kind of the error; claray_last_error() tells what failed, where, and what to do. A
 * handle that a function writes to an argument is released by the _release function of its type; releasing NULL does
 * nothing. A handle keeps those alive that it was made from. Do not use the handles of one device from two threads
 * at once; claray_device_new_queue_create makes a device for another thread.
 *
 * Every struct with a member struct_size begins with it. Set it to sizeof of the struct, and all other members to 0 for
 * their defaults, as in  claray_mesh mesh = {sizeof mesh}.  Where 0 is not the default, an _init function sets the
 * members behind struct_size. Functions that end in _get write the members that the caller's version of the struct has.
 * Their pointers are valid until the object changes or is released. A later version only adds members at the end.
 *
 * A function with a const handle that ends in _count returns 0 for NULL. docs/c.md names the function of C for each of
 * C++. */
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

/* The names of a list: "material kinds", "light kinds", "projections", "primitive kinds", "builders", "scenes" (those
 * that are built in), "effects", "approximations" or "layers" (claray_renderer_layer). */
typedef struct claray_lines claray_lines;
CLARAY_API claray_status claray_names_create(const char* list, claray_lines** names);
CLARAY_API size_t claray_lines_count(const claray_lines* lines);
/* NULL if there is no line i; else valid while the handle is. */
CLARAY_API const char* claray_lines_at(const claray_lines* lines, size_t i);
CLARAY_API void claray_lines_release(claray_lines* lines);

/* Receives a line; of messages that come while something runs. */
typedef void (*claray_line_callback)(const char* line, void* user);

/* ---- devices ---- */

/* selector: "cpu", "gpu", an index, or a part of the name; NULL or "": $CLARAY_DEVICE, else the first GPU, else the
 * first. */
CLARAY_API claray_status claray_device_open(const char* selector, claray_device** device);
/* Uses a cl_context and an in-order cl_command_queue of the program; both are retained. */
CLARAY_API claray_status claray_device_adopt_create(void* context, void* queue, claray_device** device);
/* The same device and context with another in-order queue. */
CLARAY_API claray_status claray_device_new_queue_create(claray_device* device, claray_device** with_queue);
/* Several devices: selectors, separated by commas, or "all": every GPU and accelerator, and the CPU once. Writes
 * `count` handles, at most `room`, each with a release of its own. */
CLARAY_API claray_status claray_device_open_several(const char* selectors, claray_device** devices, size_t room,
                                                    size_t* count);
/* A part of the device with so many compute units; the device itself if its driver cannot divide it. */
CLARAY_API claray_status claray_device_with_units_create(claray_device* device, uint32_t units, claray_device** part);

typedef enum claray_device_type {
    CLARAY_DEVICE_CPU = 0,
    CLARAY_DEVICE_GPU = 1,
    CLARAY_DEVICE_OTHER = 2
} claray_device_type;

/* As OpenCL reports it. Sizes are in bytes. */
typedef struct claray_device_info {
    size_t struct_size;
    size_t index; /* among all devices of all platforms; a selector of claray_device_open */
    const char* platform;
    const char* name;
    const char* vendor;
    const char* driver;     /* its version */
    const char* version;    /* of OpenCL */
    const char* extensions; /* separated by spaces */
    claray_device_type type;
    uint32_t compute_units;
    uint64_t memory;
    uint64_t max_allocation; /* the largest buffer */
    uint64_t local_memory;
    size_t max_work_group;
    int32_t fp64;         /* double precision in kernels */
    int32_t exact_divide; /* divisions rounded correctly */
} claray_device_info;

typedef struct claray_device_list claray_device_list;
/* All devices of all platforms, none of them opened. */
CLARAY_API claray_status claray_device_list_create(claray_device_list** list);
CLARAY_API size_t claray_device_list_count(const claray_device_list* list);
CLARAY_API claray_status claray_device_list_get(const claray_device_list* list, size_t i, claray_device_info* info);
CLARAY_API void claray_device_list_release(claray_device_list* list);

CLARAY_API claray_status claray_device_get(const claray_device* device, claray_device_info* info);
/* Valid while the handle is. */
CLARAY_API const char* claray_device_name(const claray_device* device);
/* The cl_context and cl_command_queue, not retained. */
CLARAY_API void* claray_device_context(const claray_device* device);
CLARAY_API void* claray_device_queue(const claray_device* device);
/* Waits for all commands of the queue. */
CLARAY_API claray_status claray_device_finish(claray_device* device);
/* Commands enqueued from now on wait for these events (cl_event) of the context. Asynchronous. */
CLARAY_API claray_status claray_device_wait_for(claray_device* device, const void* const* events, size_t count);
/* An event that is complete when all commands enqueued so far are; release it by clReleaseEvent. Asynchronous. */
CLARAY_API claray_status claray_device_event(claray_device* device, void** event);
/* A value of the tuning table (kernels/tuning.txt) for this device. A new value holds for programs compiled later. */
CLARAY_API claray_status claray_device_tuning(const claray_device* device, const char* kernel, const char* parameter,
                                              uint32_t* value);
CLARAY_API claray_status claray_device_set_tuning(claray_device* device, const char* kernel, const char* parameter,
                                                  uint32_t value);
/* The rows of the user's tuning tables that were ignored, a line each. */
CLARAY_API claray_status claray_device_warnings_create(const claray_device* device, claray_lines** warnings);
CLARAY_API void claray_device_release(claray_device* device);

/* ---- kernels ---- */

typedef struct claray_render_config claray_render_config;

/* Compiles ahead, into the cache on disk. effects: NULL for what structures and queries need; else the effects of a
 * scene (claray_scene_effects_create), separated by commas, for renders of such scenes with `config`. config: NULL for
 * the defaults. Blocks: up to a minute on a GPU where claray never ran. */
CLARAY_API claray_status claray_prepare(claray_device* device, const char* effects, const claray_render_config* config);

/* Kernels done, and the sum of these and those that are known to be missing. text: one line for the user. Called from
 * any thread, one call at a time; must not use a device. */
typedef void (*claray_compiling_callback)(uint32_t done, uint32_t total, const char* text, void* user);
/* Calls back when a compilation begins and when a kernel is done; NULL ends that. For all devices. */
CLARAY_API claray_status claray_on_compiling(claray_compiling_callback callback, void* user);

typedef struct claray_compile_statistics {
    size_t struct_size;
    double milliseconds;     /* since the process began */
    uint32_t compiled;       /* programs compiled by the driver */
    uint32_t from_cache;     /* programs loaded from the cache on disk */
    const char* cache_error; /* why the latest program could not be cached, or ""; valid until the thread's next call */
} claray_compile_statistics;
CLARAY_API claray_status claray_compile_statistics_get(claray_compile_statistics* statistics);

typedef struct claray_instances claray_instances;

typedef struct claray_kernel_source {
    size_t struct_size;
    const char* source;    /* OpenCL C, which may include claray's device headers, such as "trace/closest_hit.clh" */
    const char* function;  /* the kernel */
    const char* name;      /* of the file in messages of the compiler; NULL: "user.cl" */
    const claray_bvh* bvh; /* NULL, or the structure that is bound to it */
    const claray_instances* instances; /* the same */
    const char* const* defines;        /* macros, "NAME=VALUE" each */
    size_t define_count;
    int32_t fast_math; /* 0: IEEE arithmetic */
} claray_kernel_source;
/* Writes a cl_kernel, which the program runs and releases by OpenCL. */
CLARAY_API claray_status claray_kernel_compile(claray_device* device, const claray_kernel_source* source,
                                               void** kernel);
/* Sets the arguments of a cl_kernel that the macros CLARAY_BVH_PARAMETERS and CLARAY_INSTANCES_PARAMETERS declare,
 * from *index on, and advances it. The kernel must be compiled for the structure. */
CLARAY_API claray_status claray_bvh_bind(const claray_bvh* bvh, void* kernel, uint32_t* index);
CLARAY_API claray_status claray_instances_bind(const claray_instances* placed, void* kernel, uint32_t* index);

/* ---- times of kernels and transfers ---- */

typedef struct claray_profile claray_profile;

/* A command, or all commands of one name since the last reset. Times in nanoseconds of the device's clock. */
typedef struct claray_profile_row {
    size_t struct_size;
    const char* name;
    uint64_t count;      /* 1 for a command */
    double milliseconds; /* in sum */
    double longest;      /* milliseconds of the longest command */
    uint64_t queued;     /* of a command; else 0 */
    uint64_t start;      /* of the first command */
    uint64_t end;        /* of the last one */
} claray_profile_row;

/* enabled: 0 measures nothing, which saves some microseconds of a GPU for each command; measuring is the default.
 * keep_records: also keeps a row for each command. Resets the totals. */
CLARAY_API claray_status claray_profiler_start(claray_device* device, int enabled, int keep_records);
/* The rows so far: of all commands that are kept, or the totals by name, in alphabetical order. Blocks. */
CLARAY_API claray_status claray_profile_create(claray_device* device, int records, claray_profile** profile);
CLARAY_API size_t claray_profile_count(const claray_profile* profile);
CLARAY_API claray_status claray_profile_get(const claray_profile* profile, size_t i, claray_profile_row* row);
CLARAY_API void claray_profile_release(claray_profile* profile);
/* Writes the commands that are kept as a trace for Perfetto and chrome://tracing. */
CLARAY_API claray_status claray_write_trace(claray_device* device, const char* path);

/* ---- structures ---- */

typedef enum claray_builder {
    CLARAY_BUILDER_AUTOMATIC = 0, /* the default: high on GPUs, else balanced */
    CLARAY_BUILDER_FAST = 1,      /* fastest to build */
    CLARAY_BUILDER_BALANCED = 2,  /* better tree, slower */
    CLARAY_BUILDER_HIGH = 3,      /* best tree, slowest; splits large triangles */
    CLARAY_BUILDER_BINNED = 4     /* binned SAH, nothing split: for geometry that is refitted */
} claray_builder;
/* What CLARAY_BUILDER_AUTOMATIC stands for on the device; others unchanged. */
CLARAY_API claray_status claray_builder_resolve(const claray_device* device, claray_builder builder,
                                                claray_builder* resolved);

/* Memory layout of the tree that is traversed. */
typedef enum claray_layout {
    CLARAY_LAYOUT_AUTOMATIC = 0, /* by the tuning table */
    CLARAY_LAYOUT_BINARY = 1,
    CLARAY_LAYOUT_WIDE = 2 /* 8 boxes in a node */
} claray_layout;

typedef struct claray_mesh {
    size_t struct_size;
    const float* vertices; /* 3 floats for each vertex */
    size_t vertex_count;
    const uint32_t* triangles; /* 3 indices of vertices for each triangle; counter-clockwise in front */
    size_t triangle_count;
    const uint32_t* geometries; /* one for each triangle; NULL: all belong to geometry 0 */
    const uint32_t* masks;      /* one for each geometry: rays see it if their masks share a bit; NULL: all see all */
    size_t mask_count;
    /* Of a mesh of a scene, which is one geometry with at most one mask. The arrays are for each vertex, or NULL. */
    const char* name;
    const float* normals;      /* 3 floats each, unit length; NULL: flat shading */
    const float* uvs;          /* 2 floats each; (0, 0) is the top left corner of an image */
    const float* uvs1;         /* a second set of coordinates */
    const float* tangents;     /* 4 floats each, the last is the sign of the bitangent; NULL: computed from the uvs */
    const float* colors;       /* 4 floats each, 0..1: linear RGB multiplies the albedo, alpha the opacity */
    const uint32_t* materials; /* one of the scene for each triangle; NULL: all have `material` */
    uint32_t material;
} claray_mesh;

typedef struct claray_bvh_config {
    size_t struct_size;
    claray_builder builder;
    float split_budget; /* CLARAY_BUILDER_HIGH: additional references per triangle; 0: 0.5, < 0: none */
    int32_t learns; /* whether queries may replace the tree by a better one, once rays have been traced for long enough
                   (docs/queries.md); > 0: yes, < 0: no, 0: if the builder is CLARAY_BUILDER_AUTOMATIC */
    claray_layout layout;
    uint32_t morton_bits;        /* of each Morton code: 30 or 63; 0: 63 */
    uint32_t max_leaf_triangles; /* binary layout: 1 to 4; 0: 4 */
} claray_bvh_config;

/* Copies the mesh to the device. config: NULL for the defaults. */
CLARAY_API claray_status claray_bvh_build(claray_device* device, const claray_mesh* mesh,
                                          const claray_bvh_config* config, claray_bvh** bvh);
/* Over the meshes of a scene, in world space; each is a geometry. */
CLARAY_API claray_status claray_bvh_scene_build(claray_device* device, const claray_scene* scene,
                                                const claray_bvh_config* config, claray_bvh** bvh);
/* Triangles in buffers (cl_mem) of the device's context. */
typedef struct claray_triangle_buffers {
    size_t struct_size;
    void* vertices; /* as the members of claray_mesh */
    size_t vertex_count;
    void* triangles;
    size_t triangle_count;
    void* geometries; /* NULL: all belong to geometry 0 */
    void* masks;      /* NULL: all rays see all */
    size_t mask_count;
} claray_triangle_buffers;
/* Over triangles that are on the device. Shares the buffers, for claray_bvh_update. */
CLARAY_API claray_status claray_bvh_buffers_build(claray_device* device, const claray_triangle_buffers* buffers,
                                                  const claray_bvh_config* config, claray_bvh** bvh);
/* The buffers of a structure, not retained. */
CLARAY_API claray_status claray_bvh_buffers_get(const claray_bvh* bvh, claray_triangle_buffers* buffers);
/* Device memory for a build, and the largest buffer of it, in bytes. largest: may be NULL. */
CLARAY_API claray_status claray_bvh_memory_needed(const claray_device* device, size_t vertex_count,
                                                  size_t triangle_count, const claray_bvh_config* config,
                                                  uint64_t* bytes, uint64_t* largest);
CLARAY_API claray_status claray_bvh_load(claray_device* device, const char* path, claray_bvh** bvh);
CLARAY_API claray_status claray_bvh_layout_load(claray_device* device, const char* path, claray_layout layout,
                                                claray_bvh** bvh);
CLARAY_API claray_status claray_bvh_save(const claray_bvh* bvh, const char* path);
/* Moves the vertices, as many as before. rebuild: 0 keeps the tree (fast, but queries get slower), else builds it
 * again. */
CLARAY_API claray_status claray_bvh_move(claray_bvh* bvh, const float* vertices, size_t vertex_count, int rebuild);
/* The same after the program has changed the buffers of the structure. */
CLARAY_API claray_status claray_bvh_update(claray_bvh* bvh, int rebuild);
/* The cost of the tree over that at its last build: 1 if nothing has moved. From 1.4 on, rebuilding pays off. */
CLARAY_API claray_status claray_bvh_cost_growth(const claray_bvh* bvh, double* growth);
CLARAY_API size_t claray_bvh_triangle_count(const claray_bvh* bvh);

typedef struct claray_bvh_statistics {
    size_t struct_size;
    uint32_t triangles;  /* in the tree */
    uint32_t culled;     /* left out: not finite, beyond 1e18, or with two equal vertices */
    uint32_t references; /* additional leaves of triangles that were split */
    uint32_t height;
    double sah_cost; /* surface area heuristic: 1 for each pair of boxes, 1 for each triangle */
    uint64_t bytes;  /* device memory of the structure */
    claray_layout layout;
} claray_bvh_statistics;
CLARAY_API claray_status claray_bvh_statistics_get(const claray_bvh* bvh, claray_bvh_statistics* statistics);

/* All numbers are 0 for a valid structure. */
typedef struct claray_bvh_validation {
    size_t struct_size;
    uint32_t leaves_missing;       /* triangles that are in no leaf */
    uint32_t leaves_repeated;      /* triangles that are in several leaves without being split */
    uint32_t boxes_not_containing; /* boxes that do not contain their subtree */
    uint32_t links_broken;
} claray_bvh_validation;
/* Checks every leaf, box and link on the device. Blocks. */
CLARAY_API claray_status claray_bvh_validate(const claray_bvh* bvh, claray_bvh_validation* validation);
/* 32 hexadecimal digits and a 0. Equal on all devices that build the same tree from the same triangles. */
CLARAY_API claray_status claray_bvh_hash(const claray_bvh* bvh, char hash[33]);
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

/* The cost of a query: boxes and triangles tested. */
typedef struct claray_visits {
    uint32_t nodes;
    uint32_t triangles;
} claray_visits;

/* Hits that count. source: OpenCL C that defines the function of claray/query/filter.hpp:
 *
 *     static inline bool accept_hit(global const float* data, float3 origin, float3 direction, const Hit* hit)
 *
 * It is called in any order. A ray goes on behind a hit that is not accepted. */
typedef struct claray_hit_filter {
    size_t struct_size;
    const char* name;   /* appears in messages of the compiler; may be NULL */
    const char* source; /* NULL: hits of the geometries from first_geometry to end_geometry - 1 */
    const float* data;  /* passed to the function */
    size_t data_count;
    uint32_t first_geometry, end_geometry;
} claray_hit_filter;

typedef struct claray_query_options {
    size_t struct_size;
    int32_t cull_back_faces; /* hit only triangles whose vertices appear counter-clockwise */
    int32_t closed;          /* rays that only touch a surface hit it */
    claray_coherence coherence;
    int32_t brute_force;             /* tests every triangle: the same hits, for comparison */
    const claray_hit_filter* filter; /* NULL: every hit counts. Not for instances */
    /* One for each ray, or NULL. The arrays are copied when the query is made; the visits are written by each run. With
     * in_buffers they are cl_mem, which are shared. */
    const void* ray_masks; /* uint32_t: a ray sees geometries and instances whose mask shares a bit with its own */
    const void* ray_times; /* float, 0 to 1, for instances that move */
    void* visits;          /* claray_visits: receives the cost of each ray */
    size_t ray_count;      /* elements of these */
    int32_t in_buffers;
    void* count_buffer; /* of claray_query_enqueue: a cl_mem of one uint32_t; only so many rays are traced. Else NULL */
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

/* The same with options, of which cull_back_faces, closed, ray_masks and filter are used. */
CLARAY_API claray_status claray_count_hits_with(const claray_bvh* bvh, const claray_ray* rays, size_t count,
                                                const claray_query_options* options, uint32_t* counts);
CLARAY_API claray_status claray_nearest_hits_with(const claray_bvh* bvh, const claray_ray* rays, size_t count,
                                                  uint32_t most, const claray_query_options* options, claray_hit* hits,
                                                  uint32_t* counts);
/* The same for rays, hits and counts in buffers (cl_mem) of the device's context, on its queue. The visits of the
 * options must be NULL. Asynchronous, except for structures with split triangles. */
CLARAY_API claray_status claray_count_hits_enqueue(const claray_bvh* bvh, void* rays, void* counts, size_t count,
                                                   const claray_query_options* options);
CLARAY_API claray_status claray_nearest_hits_enqueue(const claray_bvh* bvh, void* rays, void* hits, void* counts,
                                                     size_t count, uint32_t most, const claray_query_options* options);

/* A list for each query: list i has the elements offsets[i] .. offsets[i + 1] - 1. */
typedef struct claray_lists claray_lists;
/* All hits of each ray, in order of distance. Options as of claray_count_hits_with. */
CLARAY_API claray_status claray_all_hits_create(const claray_bvh* bvh, const claray_ray* rays, size_t count,
                                                const claray_query_options* options, claray_lists** lists);
/* The triangles that overlap each box or solid sphere, in ascending order; those that touch overlap. boxes: 6 floats
 * each, the lower corner and the upper one. spheres: 4 floats each, centre and radius. */
CLARAY_API claray_status claray_box_overlaps_create(const claray_bvh* bvh, const float* boxes, size_t count,
                                                    claray_lists** lists);
CLARAY_API claray_status claray_sphere_overlaps_create(const claray_bvh* bvh, const float* spheres, size_t count,
                                                       claray_lists** lists);
/* How many. counts: `count` numbers. Block. */
CLARAY_API claray_status claray_count_box_overlaps(const claray_bvh* bvh, const float* boxes, size_t count,
                                                   uint32_t* counts);
CLARAY_API claray_status claray_count_sphere_overlaps(const claray_bvh* bvh, const float* spheres, size_t count,
                                                      uint32_t* counts);
CLARAY_API size_t claray_lists_count(const claray_lists* lists);
/* One more than there are lists. This and the elements are valid while the handle is. */
CLARAY_API const uint32_t* claray_lists_offsets(const claray_lists* lists);
/* The elements of claray_all_hits_create; NULL of other lists. */
CLARAY_API const claray_hit* claray_lists_hits(const claray_lists* lists);
/* The elements of overlaps, indices of triangles; NULL of other lists. */
CLARAY_API const uint32_t* claray_lists_triangles(const claray_lists* lists);
CLARAY_API void claray_lists_release(claray_lists* lists);

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

typedef struct claray_point_options {
    size_t struct_size;
    float reach;         /* the largest distance at which a point is found; 0: any */
    int32_t brute_force; /* tests every triangle: the same answers, for comparison; binary layout only */
    int32_t unsorted;    /* answers points in their order. Affects speed only */
    int32_t vote; /* of surfaces that are not closed: the majority of 16 rays decides what is inside, not one ray */
    const uint32_t* masks; /* NULL, or one for each point, which sees geometries whose mask shares a bit with its own */
    claray_visits* visits; /* NULL, or receives the cost of each point */
} claray_point_options;
/* The same with options. */
CLARAY_API claray_status claray_nearest_point_with(const claray_bvh* bvh, const float* points, size_t count,
                                                   const claray_point_options* options, claray_nearest* nearest);
CLARAY_API claray_status claray_inside_with(const claray_bvh* bvh, const float* points, size_t count,
                                            const claray_point_options* options, uint8_t* inside);
CLARAY_API claray_status claray_signed_distance_with(const claray_bvh* bvh, const float* points, size_t count,
                                                     const claray_point_options* options, float* distances);

typedef enum claray_point_query {
    CLARAY_POINT_NEAREST = 0,        /* answers: claray_nearest */
    CLARAY_POINT_INSIDE = 1,         /* answers: bytes */
    CLARAY_POINT_SIGNED_DISTANCE = 2 /* answers: floats */
} claray_point_query;
/* The same for points and answers in buffers (cl_mem) of the device's context, on its queue. The visits of the options
 * must be NULL. Asynchronous, except with `vote` and for structures with split triangles. */
CLARAY_API claray_status claray_points_enqueue(const claray_bvh* bvh, claray_point_query query, void* points,
                                               void* answers, size_t count, const claray_point_options* options);

/* ---- instances ---- */

typedef struct claray_instance {
    float transform[12]; /* from the structure to the world: 3 rows of 4 floats, the translation last in each */
    uint32_t bottom;     /* index of its structure */
    uint32_t mask;       /* a ray sees it if their masks share a bit; without ray_masks, rays see all but 0 */
} claray_instance;

typedef struct claray_instance_hit {
    float t;
    float u, v;
    uint32_t primitive; /* of the instance's structure, as geometry */
    uint32_t geometry;
    uint32_t instance; /* CLARAY_MISS on a miss */
} claray_instance_hit;

/* A structure over instances of structures of one device. Those whose transform cannot be inverted are left out. */
CLARAY_API claray_status claray_instances_build(const claray_bvh* const* bvhs, size_t bvh_count,
                                                const claray_instance* instances, size_t count,
                                                claray_instances** placed);
typedef struct claray_instances_config {
    size_t struct_size;
    const claray_instance* ends; /* NULL, or the transforms at time 1 of instances that move, as many as instances */
    claray_builder builder;      /* of the tree over the instances; CLARAY_BUILDER_AUTOMATIC: fast */
    uint32_t morton_bits;        /* 30 or 63; 0: 63 */
} claray_instances_config;
CLARAY_API claray_status claray_instances_config_build(const claray_bvh* const* bvhs, size_t bvh_count,
                                                       const claray_instance* instances, size_t count,
                                                       const claray_instances_config* config,
                                                       claray_instances** placed);
/* Moves the instances, as many as before. rebuild: as of claray_bvh_move. */
CLARAY_API claray_status claray_instances_move(claray_instances* placed, const claray_instance* instances, size_t count,
                                               int rebuild);
/* The same for instances that were built with ends. */
CLARAY_API claray_status claray_instances_move_with_ends(claray_instances* placed, const claray_instance* instances,
                                                         const claray_instance* ends, size_t count, int rebuild);
/* The same after the program has changed the buffers, or after claray_instances_replace. */
CLARAY_API claray_status claray_instances_update(claray_instances* placed, int rebuild);
/* Replaces the structures, in any number, after they were changed. Call claray_instances_update afterwards. */
CLARAY_API claray_status claray_instances_replace(claray_instances* placed, const claray_bvh* const* bvhs,
                                                  size_t bvh_count);
/* The cl_mem of the instances (64 bytes each, claray/shared/instance.h), and of their ends or NULL; not retained. */
CLARAY_API claray_status claray_instances_buffers_get(const claray_instances* placed, void** instances, void** ends);
CLARAY_API size_t claray_instances_count(const claray_instances* placed);

typedef struct claray_instances_statistics {
    size_t struct_size;
    uint32_t instances;    /* in the tree */
    uint32_t culled;       /* left out */
    uint32_t height;       /* of the tree over the instances */
    float widening;        /* relative growth of every box with its distance from the ray (docs/numerics.md) */
    double sah_cost;       /* 1 for each pair of boxes, 1 for each instance */
    uint64_t top_bytes;    /* device memory of the tree over the instances */
    uint64_t bottom_bytes; /* of the structures */
    claray_layout layout;  /* of the structures */
} claray_instances_statistics;
CLARAY_API claray_status claray_instances_statistics_get(const claray_instances* placed,
                                                         claray_instances_statistics* statistics);
/* As claray_bvh_validate, of the tree over the instances. */
CLARAY_API claray_status claray_instances_validate(const claray_instances* placed, claray_bvh_validation* validation);
/* The tree over the instances, for its hash. */
CLARAY_API claray_status claray_instances_tree_create(const claray_instances* placed, claray_bvh** tree);

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
    const char*
        name; /* without a source "spheres", "discs", "cylinders", "curves" or "flat curves"; else for messages */
    const char* source; /* OpenCL C that defines bounds_of and intersect (docs/queries.md); NULL: a kind of claray */
    uint32_t floats;    /* in the data for each primitive, with a source: 1 or more */
    int32_t capsules;   /* with a source: its boxes are those of capsules (kernels/primitives/primitive.clh) */
} claray_primitive_kind;

/* A structure over `count` primitives. data of a sphere: 4 floats (centre, radius). Of a disc: 8 (centre, radius,
 * normal, radius of the hole). Of a cylinder: 8 (start, radius, end, 1 with caps or 0). Else kind->floats for each. */
CLARAY_API claray_status claray_primitives_build(claray_device* device, const claray_primitive_kind* kind,
                                                 const float* data, size_t count, claray_primitives** primitives);
/* The same with a config; nothing is split. config: NULL for the default of primitives. */
CLARAY_API claray_status claray_primitives_config_build(claray_device* device, const claray_primitive_kind* kind,
                                                        const claray_bvh_config* config, const float* data,
                                                        size_t count, claray_primitives** primitives);
/* Curves, of 4 control points for each segment, from the index in `segments` on. points: x, y, z and radius of each.
 * bezier: 0 for uniform B-splines. flat: 0 for round curves, else ribbons that face every ray. */
CLARAY_API claray_status claray_curves_build(claray_device* device, const float* points, size_t point_count,
                                             const uint32_t* segments, size_t segment_count, int bezier, int flat,
                                             claray_primitives** primitives);
/* The data of curves for claray_primitives_config_build and claray_primitives_move: 16 floats for each segment. */
CLARAY_API claray_status claray_curve_data(const float* points, size_t point_count, const uint32_t* segments,
                                           size_t segment_count, int bezier, float* data);
/* Replaces the data, as many floats as before; NULL and 0: the program has changed the buffer. rebuild: as of
 * claray_bvh_move. */
CLARAY_API claray_status claray_primitives_move(claray_primitives* primitives, const float* data, size_t float_count,
                                                int rebuild);
CLARAY_API size_t claray_primitives_count(const claray_primitives* primitives);
/* The cl_mem of the data, not retained. */
CLARAY_API void* claray_primitives_buffer(const claray_primitives* primitives);
/* The tree over the primitives' boxes, for its statistics, validation and hash. Queries refuse it. */
CLARAY_API claray_status claray_primitives_tree_create(const claray_primitives* primitives, claray_bvh** tree);
/* The closest hits, with the index of the primitive; u and v are what the kind sets. Block. The functions for points
 * and for all hits of a ray are for triangles. */
CLARAY_API claray_status claray_primitives_closest_hit(const claray_primitives* primitives, const claray_ray* rays,
                                                       size_t count, claray_hit* hits);
CLARAY_API claray_status claray_primitives_any_hit(const claray_primitives* primitives, const claray_ray* rays,
                                                   size_t count, uint8_t* occluded);
/* The same for rays and results in buffers (cl_mem) of the device's context, on its queue. Asynchronous. */
CLARAY_API claray_status claray_primitives_enqueue(const claray_primitives* primitives, claray_query_kind kind,
                                                   void* rays, void* results, size_t count);
CLARAY_API void claray_primitives_release(claray_primitives* primitives);

/* ---- scenes ---- */

/* Functions that end in _set replace object `index` of a list, or add one if `index` is the length of the list. They
 * copy what they are given. claray_scene_validate checks what belongs together, as creating a renderer does. */

/* A scene without objects. */
CLARAY_API claray_status claray_scene_create(claray_scene** scene);
/* A file of one of the formats in docs/formats.md, or a built-in scene, such as "cornell". */
CLARAY_API claray_status claray_scene_load(const char* name_or_path, claray_scene** scene);

/* Selects one variant of a glTF. A choice is a name or, if no name matches, an index; NULL: the default. */
typedef struct claray_load_options {
    size_t struct_size;
    const char* animation; /* default: the first; "all": all of them */
    const char* variant;   /* of materials; default: the default materials */
    const char* camera;    /* a camera or a node with one; default: the first in the scene */
    const char* scene;     /* default: the file's default scene, else its first */
    double time;           /* seconds from the begin of the animation, if has_time */
    int32_t has_time;      /* 0: does not animate */
    float stroke_radius;   /* of points and lines; 0: by the scene's size, < 0: leaves them out */
    int32_t no_images;     /* a white texel stands for each */
    int32_t live;          /* of a glTF: instances with the names of nodes place all meshes */
} claray_load_options;
/* options: NULL for the defaults. warnings: NULL, or receives what the loader found and corrected, a line each. */
CLARAY_API claray_status claray_scene_options_load(const char* name_or_path, const claray_load_options* options,
                                                   claray_lines** warnings, claray_scene** scene);
/* Seconds of the animation that the options choose; -1 if there is none. */
CLARAY_API claray_status claray_animation_seconds(const char* name_or_path, const claray_load_options* options,
                                                  double* seconds);
CLARAY_API claray_status claray_scene_copy_create(const claray_scene* scene, claray_scene** copy);
CLARAY_API void claray_scene_release(claray_scene* scene);

/* The lists of a scene. */
typedef enum claray_scene_part {
    CLARAY_MESHES = 0,
    CLARAY_PLACEMENTS = 1,
    CLARAY_PRIMITIVE_SETS = 2,
    CLARAY_MATERIALS = 3,
    CLARAY_TEXTURES = 4,
    CLARAY_LIGHTS = 5
} claray_scene_part;
CLARAY_API size_t claray_scene_count(const claray_scene* scene, claray_scene_part part);
/* Keeps the first `count` objects of a list. */
CLARAY_API claray_status claray_scene_truncate(claray_scene* scene, claray_scene_part part, size_t count);
/* Of all placed meshes. */
CLARAY_API size_t claray_scene_triangle_count(const claray_scene* scene);
/* Of all sets of primitives. */
CLARAY_API size_t claray_scene_primitive_count(const claray_scene* scene);
/* Its name; valid until it changes. */
CLARAY_API const char* claray_scene_name(const claray_scene* scene);
CLARAY_API claray_status claray_scene_set_name(claray_scene* scene, const char* name);

/* Geometries must be NULL, and masks have one element at most. */
CLARAY_API claray_status claray_scene_mesh_set(claray_scene* scene, size_t index, const claray_mesh* mesh);
CLARAY_API claray_status claray_scene_mesh_get(const claray_scene* scene, size_t index, claray_mesh* mesh);

/* A mesh placed in the scene. A scene without placements has every mesh once, as it is. */
typedef struct claray_placement {
    size_t struct_size;
    const char* name;        /* of the object that it is a part of; may be NULL */
    uint32_t mesh;           /* its index */
    int32_t moves;           /* while the shutter is open, to transform_end */
    float transform[12];     /* 3 rows of 4 floats, the translation last in each; invertible */
    float transform_end[12]; /* at shutter close */
} claray_placement;
CLARAY_API claray_status claray_scene_placement_set(claray_scene* scene, size_t index,
                                                    const claray_placement* placement);
CLARAY_API claray_status claray_scene_placement_get(const claray_scene* scene, size_t index,
                                                    claray_placement* placement);

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
    const char* name;
} claray_primitive_set;

/* Adds primitives, in world space, which are rendered as they are. Copies the arrays. Materials
 * must have no texture and no opacity. A scattered ray finds light that primitives emit, a light sample does not.
 * Structures of the scene (claray_bvh_scene_build) are over its meshes alone. */
CLARAY_API claray_status claray_scene_add_primitives(claray_scene* scene, const claray_primitive_set* set);
CLARAY_API claray_status claray_scene_primitives_get(const claray_scene* scene, size_t index,
                                                     claray_primitive_set* set);

/* How a material uses a texture: uv' = rotate(uv * scale, rotation) + offset. */
typedef struct claray_texture_use {
    uint32_t texture; /* index in the scene; CLARAY_NO_TEXTURE: none */
    uint32_t uv_set;  /* 0: claray_mesh::uvs, 1: uvs1 */
    float offset[2];
    float scale[2];
    float rotation; /* radians, counter-clockwise as the image is seen */
} claray_texture_use;
#define CLARAY_NO_TEXTURE 0xffffffffu

/* How the opacity is used. */
typedef enum claray_alpha_mode {
    CLARAY_ALPHA_OPAQUE = 0, /* ignored */
    CLARAY_ALPHA_MASK = 1,   /* the surface exists where the opacity passes alpha_test against alpha_cutoff */
    CLARAY_ALPHA_BLEND = 2   /* the surface exists with the opacity as probability */
} claray_alpha_mode;
typedef enum claray_alpha_test {
    CLARAY_ALPHA_GREATER_EQUAL = 0,
    CLARAY_ALPHA_GREATER = 1,
    CLARAY_ALPHA_LESS = 2,
    CLARAY_ALPHA_LESS_EQUAL = 3,
    CLARAY_ALPHA_EQUAL = 4,
    CLARAY_ALPHA_NOT_EQUAL = 5
} claray_alpha_test;
/* What a camera ray that meets the surface first adds to an image with alpha (claray_render_config). */
typedef enum claray_material_role {
    CLARAY_ROLE_SURFACE = 0,       /* its light, and an alpha of 1 */
    CLARAY_ROLE_HOLDOUT = 1,       /* nothing */
    CLARAY_ROLE_SHADOW_CATCHER = 2 /* only what the other surfaces change of its light */
} claray_material_role;

/* Colours are linear Rec. 709. A map multiplies the value of its name. docs/effects.md says what the kinds read. */
typedef struct claray_material {
    size_t struct_size;
    const char* name;
    const char* kind;   /* "lambert", "mirror", "glass", "metal", "blinn-phong", "principled", "unlit", "oren-nayar", or
                         * "custom" */
    float albedo[3];    /* of mirrors and metals the reflectance, of glass the tint, of principled the base colour */
    float emission[3];  /* radiance of front and back, W / (m^2 sr) */
    float roughness;    /* 0..1 */
    float ior;          /* index of refraction */
    float metallic;     /* 0..1 */
    float transmission; /* 0..1 */
    int32_t thin_walled;
    float clearcoat;           /* 0..1 */
    float clearcoat_roughness; /* 0..1 */
    float specular[3];         /* blinn-phong: colour of the highlight */
    float specular_weight;     /* 0..1 */
    float specular_tint[3];
    float sheen[3];
    float sheen_roughness;
    float anisotropy;
    float anisotropy_rotation; /* radians */
    float iridescence;
    float iridescence_ior;
    float film_thickness[2];    /* nanometres, where its map is 0 and where it is 1 */
    float attenuation[3];       /* what is left of white light after attenuation_distance inside */
    float attenuation_distance; /* 0: no absorption */
    float opacity;
    claray_alpha_mode alpha_mode;
    float alpha_cutoff;
    claray_alpha_test alpha_test;
    int32_t cull_back;                          /* rays pass through the back */
    claray_texture_use albedo_map;              /* RGB; its alpha multiplies the opacity */
    claray_texture_use emission_map;            /* RGB */
    claray_texture_use metallic_roughness_map;  /* green: roughness, blue: metallic */
    claray_texture_use transmission_map;        /* red */
    claray_texture_use clearcoat_map;           /* red */
    claray_texture_use clearcoat_roughness_map; /* green */
    claray_texture_use clearcoat_normal_map;    /* as normal_map */
    float clearcoat_normal_scale;
    claray_texture_use specular_map;        /* RGB: specular_tint; blinn-phong: specular */
    claray_texture_use specular_weight_map; /* alpha */
    claray_texture_use shininess_map;       /* red */
    claray_texture_use sheen_map;           /* RGB */
    claray_texture_use sheen_roughness_map; /* alpha */
    claray_texture_use anisotropy_map;      /* red and green: direction, blue: anisotropy */
    claray_texture_use iridescence_map;     /* red */
    claray_texture_use film_thickness_map;  /* green */
    claray_texture_use opacity_map;         /* red */
    claray_texture_use normal_map;          /* tangent space, 0.5 is 0, +y up in the image */
    float normal_scale;
    claray_texture_use height_map; /* red, times height_scale; changes the normal only */
    float height_scale;
    claray_texture_use light_map; /* RGB irradiance that replaces light from elsewhere */
    uint32_t custom;              /* of the kind "custom": the number from claray_add_bsdf */
    const float* parameters;      /* of the kind "custom": what its source reads */
    size_t parameter_count;
    float shininess;           /* blinn-phong: exponent of the highlight */
    claray_material_role role; /* in images with alpha */
} claray_material;
/* A new material: diffuse, grey, without maps. */
CLARAY_API claray_status claray_material_init(claray_material* material);
CLARAY_API claray_status claray_scene_material_set(claray_scene* scene, size_t index, const claray_material* material);
CLARAY_API claray_status claray_scene_material_get(const claray_scene* scene, size_t index, claray_material* material);
/* Adds a BSDF of the program to the kernels of this process, and writes its number. name: a C identifier. source:
 * OpenCL C that defines sample_NAME, eval_NAME and is_delta_NAME (kernels/bsdf/types.clh). parameters: floats of each
 * material. Call it before renderers are created. */
CLARAY_API claray_status claray_add_bsdf(const char* name, const char* source, uint32_t parameters, uint32_t* number);

/* The sides of surfaces that rays hit. */
typedef enum claray_culling {
    CLARAY_CULLING_BY_FILE = 0, /* as the materials say */
    CLARAY_CULLING_BACK = 1,    /* no backs except of solid glass */
    CLARAY_CULLING_NONE = 2
} claray_culling;
/* Sets cull_back of all materials. */
CLARAY_API claray_status claray_scene_set_culling(claray_scene* scene, claray_culling culling);
/* Exchanges the front and the back of all triangles. */
CLARAY_API claray_status claray_scene_flip_fronts(claray_scene* scene);

typedef struct claray_light {
    size_t struct_size;
    const char* name;
    const char* kind;     /* "point", "spot", "directional" or "sun" */
    float position[3];    /* not of directional lights and suns */
    float direction[3];   /* in which it shines; not of points */
    float intensity[3];   /* W / sr; of directional lights and suns irradiance, W / m^2 */
    float inner_angle;    /* of spots: radians from the axis, up to which it shines fully */
    float outer_angle;    /* of spots and suns: radians from the axis, beyond which it does not shine */
    float range;          /* beyond which it fades to nothing; 0: none */
    float attenuation[3]; /* a0, a1, a2: intensity / (a0 + a1 d + a2 d^2) at distance d; physical: 0, 0, 1 */
    int32_t linear_range; /* the range ends as 1 - d / range */
} claray_light;
/* A new light: a point of intensity 1 with the physical falloff. */
CLARAY_API claray_status claray_light_init(claray_light* light);
CLARAY_API claray_status claray_scene_light_set(claray_scene* scene, size_t index, const claray_light* light);
CLARAY_API claray_status claray_scene_light_get(const claray_scene* scene, size_t index, claray_light* light);

/* What surrounds the surfaces; all 0: nothing. */
typedef struct claray_sky {
    size_t struct_size;
    float horizon[3]; /* radiance of rays that leave the scene, linear in the sine of their elevation */
    float zenith[3];
    float fog_color[3]; /* exp(-fog_density d) of the light is left after a distance d, the rest becomes this */
    float fog_density;
    float fog_depth; /* length of the fog before what is infinitely far */
} claray_sky;
CLARAY_API claray_status claray_scene_sky_set(claray_scene* scene, const claray_sky* sky);
CLARAY_API claray_status claray_scene_sky_get(const claray_scene* scene, claray_sky* sky);

/* The images of two eyes in one image. */
typedef enum claray_stereo {
    CLARAY_STEREO_NONE = 0,
    CLARAY_STEREO_SIDE_BY_SIDE = 1, /* the left eye's is the left half */
    CLARAY_STEREO_TOP_BOTTOM = 2    /* the left eye's is the upper half */
} claray_stereo;

typedef struct claray_camera {
    size_t struct_size;
    const char* projection; /* a name of the list projections (claray_names_create) */
    float position[3];
    float target[3];
    float up[3];
    float vertical_fov;                   /* degrees; perspective and fisheyes */
    float aperture_radius;                /* of a thin lens; 0: a pinhole */
    float focus_distance;                 /* of the sharp plane; 0: that of the target */
    float orthographic_height;            /* of the image in units of the scene; orthographic */
    int32_t moves_position, moves_target; /* while the shutter is open, to: */
    float position_end[3];
    float target_end[3];
    float shift[2]; /* of a perspective lens, in parts of the image's width and height */
    float tilt[2];  /* degrees by which the sharp plane is turned: its top goes away, its right goes away */
    claray_stereo stereo;
    float eye_distance; /* in units of the scene */
} claray_camera;
/* A new camera: at (0, 0, 5), towards the origin, 40 degrees. */
CLARAY_API claray_status claray_camera_init(claray_camera* camera);
/* NULL: an automatic one, which sees all of the scene. */
CLARAY_API claray_status claray_scene_camera_set(claray_scene* scene, const claray_camera* camera);
/* The camera of the scene, or the automatic one. aspect: width over height. */
CLARAY_API claray_status claray_scene_camera_get(const claray_scene* scene, float aspect, claray_camera* camera);
/* A camera that sees all of the scene. bounds: NULL, or a box of 6 floats that it sees instead. */
CLARAY_API claray_status claray_scene_camera_fit(const claray_scene* scene, const float* bounds, float vertical_fov,
                                                 float aspect, claray_camera* camera);
/* Turns the camera by degrees round the axis through its target along `up`. */
CLARAY_API claray_status claray_camera_orbit(claray_camera* camera, float degrees);

/* The box of all that is placed, with the ends of motion: the lower corner and the upper one. */
CLARAY_API claray_status claray_scene_bounds(const claray_scene* scene, float bounds[6]);
/* The box of a mesh, as it is. */
CLARAY_API claray_status claray_scene_mesh_bounds(const claray_scene* scene, size_t index, float bounds[6]);
/* Tells the first object with a wrong index, length or value. */
CLARAY_API claray_status claray_scene_validate(const claray_scene* scene);
/* Lines about the scene, such as one about primitives that emit light. */
CLARAY_API claray_status claray_scene_warnings_create(const claray_scene* scene, claray_lines** warnings);
/* The names of the effects that the scene uses. causes: NULL, or receives the first object that uses each. */
CLARAY_API claray_status claray_scene_effects_create(const claray_scene* scene, claray_lines** causes,
                                                     claray_lines** effects);
/* The scene without some effects, separated by commas: "textures,sky". */
CLARAY_API claray_status claray_scene_without_effects_create(const claray_scene* scene, const char* effects,
                                                             claray_scene** without);
/* The approximations (claray_render_config) that have an effect in this scene. */
CLARAY_API claray_status claray_scene_approximations_create(const claray_scene* scene, claray_lines** approximations);

/* ---- textures ---- */

typedef enum claray_texel_format {
    CLARAY_TEXEL_SRGB8 = 0,   /* bytes; colour by the sRGB curve, alpha linear */
    CLARAY_TEXEL_LINEAR8 = 1, /* bytes, 255 is 1 */
    CLARAY_TEXEL_FLOAT32 = 2  /* linear, unbounded */
} claray_texel_format;
/* How a coordinate outside 0..1 is mapped into it. */
typedef enum claray_wrap { CLARAY_WRAP_REPEAT = 0, CLARAY_WRAP_MIRROR = 1, CLARAY_WRAP_CLAMP = 2 } claray_wrap;
typedef enum claray_texture_filter {
    CLARAY_FILTER_TRILINEAR = 0, /* the default: between the two mip levels that match best */
    CLARAY_FILTER_NEAREST = 1,
    CLARAY_FILTER_BILINEAR = 2,
    CLARAY_FILTER_NEAREST_LEVEL = 3 /* bilinear in the mip level that matches best */
} claray_texture_filter;

/* Texels row by row from the top left, which is (u, v) = (0, 0). */
typedef struct claray_texture {
    size_t struct_size;
    const char* name;
    const void* texels;     /* width * height * channels bytes, or floats for CLARAY_TEXEL_FLOAT32 */
    uint32_t width, height; /* 1 to 16384 */
    uint32_t channels;      /* 1 to 4: grey, grey and alpha, RGB, RGBA */
    claray_texel_format format;
    claray_wrap wrap_u, wrap_v;
    claray_texture_filter filter;
} claray_texture;
CLARAY_API claray_status claray_scene_texture_set(claray_scene* scene, size_t index, const claray_texture* texture);
CLARAY_API claray_status claray_scene_texture_get(const claray_scene* scene, size_t index, claray_texture* texture);

/* A texture that claray made. */
typedef struct claray_image claray_image;
/* Reads PNG, JPEG, WebP, BMP, TGA, HDR, PFM or EXR. eight_bit: the meaning of bytes. */
CLARAY_API claray_status claray_image_load(const char* path, claray_texel_format eight_bit, claray_image** image);
/* The normals of a height field, for normal maps. strength: the height of 1 in texels. */
CLARAY_API claray_status claray_normal_map_create(const claray_texture* heights, float strength, claray_image** image);
/* The environment of a scene as one image in latitude and longitude, times its strength. */
CLARAY_API claray_status claray_panorama_create(const claray_scene* scene, claray_image** image);
CLARAY_API claray_status claray_image_get(const claray_image* image, claray_texture* texture);
CLARAY_API void claray_image_release(claray_image* image);
/* Writes texels without conversion: .png for bytes, .pfm for floats with 1 or 3 channels. */
CLARAY_API claray_status claray_write_texture(const char* path, const claray_texture* texture);

/* An image around the scene, which replaces the horizon and the zenith of the sky. */
typedef struct claray_environment {
    size_t struct_size;
    const claray_texture* const* images; /* one: latitude and longitude; six: faces +x -x +y -y +z -z of a cube */
    size_t image_count;                  /* 0: no environment */
    float strength;                      /* 0: 1 */
    float rotation;                      /* radians about +y, counter-clockwise seen from above */
} claray_environment;
CLARAY_API claray_status claray_scene_environment_set(claray_scene* scene, const claray_environment* environment);
/* Writes all members but `images`, which claray_scene_environment_image_get returns one by one. */
CLARAY_API claray_status claray_scene_environment_get(const claray_scene* scene, claray_environment* environment);
CLARAY_API claray_status claray_scene_environment_image_get(const claray_scene* scene, size_t index,
                                                            claray_texture* texture);
/* From an image, an EXR cube map, or a folder with the faces of a cube. warnings: NULL, or as of
 * claray_scene_options_load. */
CLARAY_API claray_status claray_scene_environment_load(claray_scene* scene, const char* path, claray_lines** warnings);

/* ---- sensors ---- */

/* A beam in the frame of its sensor. */
typedef struct claray_beam {
    float direction[3]; /* a unit vector */
    float time;         /* when it is sent, from 0 to 1 within a scan */
} claray_beam;
typedef struct claray_beams claray_beams;
/* A lidar that turns round z: a row for each elevation, in radians above the plane of x and y. Column j is sent at the
 * azimuth begin + turn * j / columns, from x towards y. */
CLARAY_API claray_status claray_spinning_beams_create(const double* elevations, size_t count, uint32_t columns,
                                                      double begin, double turn, claray_beams** beams);
/* A lidar that looks along x: evenly spaced angles over the fields of view, in radians. */
CLARAY_API claray_status claray_raster_beams_create(uint32_t rows, uint32_t columns, double horizontal_fov,
                                                    double vertical_fov, claray_beams** beams);
/* A lidar with two prisms that turn `first` and `second` times in a scan, and have turned `phase` before: one row of
 * `count` beams. */
CLARAY_API claray_status claray_rosette_beams_create(uint32_t count, double fov, double first, double second,
                                                     double phase, claray_beams** beams);
typedef enum claray_lens_kind {
    CLARAY_LENS_PINHOLE = 0,    /* x / z and y / z, distorted by k1, k2, p1, p2, k3 in OpenCV's order */
    CLARAY_LENS_EQUIDISTANT = 1 /* the angle to the axis, distorted by k1 to k4 */
} claray_lens_kind;
/* A camera's lens, in pixels; x is to the right, y down and z forwards. The first pixel's centre is at (0, 0). */
typedef struct claray_lens {
    size_t struct_size;
    double fx, fy, cx, cy;
    double distortion[5];
    claray_lens_kind kind;
} claray_lens;
/* The pixels of a camera. shutter: the time from the first row to the last one; 0: all at once. */
CLARAY_API claray_status claray_camera_beams_create(uint32_t width, uint32_t height, const claray_lens* lens,
                                                    double shutter, claray_beams** beams);
/* Row by row; valid while the handle is. */
CLARAY_API claray_status claray_beams_get(const claray_beams* beams, uint32_t* rows, uint32_t* columns,
                                          const claray_beam** all);
CLARAY_API void claray_beams_release(claray_beams* beams);

/* What sensors see: the triangles of a scene. */
typedef struct claray_sensor_world claray_sensor_world;
typedef struct claray_sensor_world_config {
    size_t struct_size;
    const uint32_t* movers; /* placements of the scene that may move, besides those that move in it */
    size_t mover_count;
    const float* reflectances; /* of each material, relative to a white surface; NULL: the red of their albedos */
    size_t reflectance_count;
    claray_builder builder;
} claray_sensor_world_config;
CLARAY_API claray_status claray_sensor_world_build(claray_device* device, const claray_scene* scene,
                                                   const claray_sensor_world_config* config,
                                                   claray_sensor_world** world);
/* Indices of the placements that may move, in increasing order; valid while the handle is. */
CLARAY_API const uint32_t* claray_sensor_world_movers(const claray_sensor_world* world, size_t* count);
/* Places all movers at the begin and at the end of the following scans: `count` times 3 rows of 4 floats. */
CLARAY_API claray_status claray_sensor_world_move(claray_sensor_world* world, const float* begins, const float* ends,
                                                  size_t count);
/* Of all placements. */
CLARAY_API size_t claray_sensor_world_triangle_count(const claray_sensor_world* world);
CLARAY_API void claray_sensor_world_release(claray_sensor_world* world);

/* Which returns of a beam are kept, and how they are ordered. */
typedef enum claray_return_order {
    CLARAY_RETURN_STRONGEST = 0,
    CLARAY_RETURN_FIRST = 1,
    CLARAY_RETURN_LAST = 2
} claray_return_order;
/* Lengths are in units of the scene, taken for metres; angles are in radians, times in seconds (docs/sensors.md). */
typedef struct claray_sensor_config {
    size_t struct_size;
    const claray_beam* beams; /* rows * columns */
    uint32_t rows, columns;
    uint32_t rays;    /* of a beam, 1 to 64 */
    uint32_t returns; /* most of a beam, 1 to `rays` */
    claray_return_order order;
    uint32_t seed;           /* of noise and dropouts */
    double divergence[2];    /* full angles of a beam, to the sides and up */
    float nearest, farthest; /* ranges that are measured */
    float range_resolution;  /* surfaces of a beam within these become one return */
    float velocity_resolution;
    float range_noise; /* standard deviations */
    float velocity_noise;
    float intensity_noise; /* relative */
    float dropout;         /* probability that a return is lost */
    float reference_range; /* where a white surface has the intensity 1; 0: intensities don't fall with the range */
    float extinction;      /* of the air, per unit of length */
    float least_intensity; /* weaker returns are lost */
    float duration;        /* of a scan; 0: velocities are 0 */
    int32_t in_world;      /* places and normals in the world, instead of the frame of the sensor */
} claray_sensor_config;
/* One ray and one return of each beam, up to a range of 1000, without noise. */
CLARAY_API claray_status claray_sensor_config_init(claray_sensor_config* config);

/* Where a sensor is at the begin and at the end of a scan; the turns are unit quaternions x, y, z, w. */
typedef struct claray_sensor_pose {
    float begin[3];
    float end[3];
    float turn_begin[4];
    float turn_end[4];
} claray_sensor_pose;
/* Of matrices from the sensor's frame to the world: 3 rows of 4 numbers, a rotation and a translation. */
CLARAY_API claray_status claray_sensor_pose_set(claray_sensor_pose* pose, const double begin[12], const double end[12]);

/* Without a return x, y, z, range and velocity are NaN, and material, placement and primitive are CLARAY_MISS. */
typedef struct claray_sensor_return {
    float point[3]; /* range times the beam's direction, in the frame of the sensor; or the place in the world */
    float intensity;
    float range;
    float velocity;  /* positive if surface and sensor depart from each other */
    float time;      /* of the beam, since the begin of the scan */
    float share;     /* of the beam's power that met these surfaces */
    float normal[3]; /* towards the sensor */
    uint32_t material;
    uint32_t instance;     /* the placement of the scene */
    uint32_t primitive;    /* triangle of its mesh */
    uint32_t ring, column; /* of the beam */
} claray_sensor_return;
typedef struct claray_sensor claray_sensor;
CLARAY_API claray_status claray_sensor_create(claray_device* device, const claray_sensor_config* config,
                                              claray_sensor** sensor);
/* Number of returns of a scan from so many poses. */
CLARAY_API size_t claray_sensor_size(const claray_sensor* sensor, size_t pose_count);
/* Scans the world from all poses. number: of the scan, for its noise. count: claray_sensor_size of the poses. Blocks.
 */
CLARAY_API claray_status claray_sensor_scan(claray_sensor* sensor, const claray_sensor_world* world,
                                            const claray_sensor_pose* poses, size_t pose_count, uint32_t number,
                                            claray_sensor_return* returns, size_t count);
CLARAY_API void claray_sensor_release(claray_sensor* sensor);

/* ---- renders ---- */

typedef enum claray_sampler {
    CLARAY_SAMPLER_SOBOL = 0,      /* Owen-scrambled Sobol points */
    CLARAY_SAMPLER_INDEPENDENT = 1 /* plain Monte Carlo */
} claray_sampler;

/* Of the approximation "light-grid" (docs/effects.md); members that are 0 have their defaults. */
typedef struct claray_light_grid_config {
    size_t struct_size;
    int32_t voxels;        /* instead of probes */
    uint32_t side;         /* probes along each axis, 2 to 64; 0: 16 */
    uint32_t coefficients; /* for each colour, 4 or 9; 0: 9 */
    uint32_t levels;       /* 1 to 4; 0: 1 */
    uint32_t gather;       /* surfaces that a path meets before the grid answers */
    uint32_t rays;         /* of each probe and update, 8 to 4096; 0: 64 */
    uint32_t updates;      /* before the first image; 0: 16 */
} claray_light_grid_config;

struct claray_render_config {
    size_t struct_size;
    uint32_t width, height; /* pixels; 0: 512 */
    uint32_t spp;           /* samples per pixel at which rendering stops; 0: 64 */
    uint32_t max_depth;     /* surfaces per path; 0: 128 */
    uint32_t seed;
    double seconds;     /* > 0: stop after this time */
    double noise;       /* > 0: stop at this relative standard error */
    double error;       /* > 0: stop at this error, RMSE over the mean */
    float sample_clamp; /* > 0: brighter samples are scaled down to it, which darkens the image */
    int32_t adaptive;   /* takes more samples where the error is large; spp is then the mean */
    int32_t no_guide;   /* paths do not learn where light comes from */
    claray_sampler sampler;
    double report_seconds;        /* between two calls of the callback; 0: 0.2 */
    const claray_bvh_config* bvh; /* NULL: the default */
    uint32_t parts;               /* of the tree, by space; 0: as many as the device's memory requires */
    const char* effects;          /* NULL, or overrides for experiments: "+textures,-sky" */
    const char* approximate;      /* NULL: none, or names, separated by commas (docs/effects.md): "flat,no-shadows" */
    const claray_light_grid_config* light_grid; /* NULL: the default */
    const char* compiler;      /* NULL, or the path of the program claray, which compiles in the background */
    const char* checkpoint;    /* NULL, or a file that is written periodically, to resume from */
    double checkpoint_seconds; /* 0: 30 */
    const char* resume;        /* NULL, or a checkpoint from which to continue */
    uint32_t region[4];        /* left, top, width and height of the pixels that are rendered; width 0: all */
    int32_t alpha;             /* the background is transparent (claray_renderer_alpha) */
    int32_t lobes;             /* layers of the light: "lobe_diffuse_direct" and so on (claray_renderer_layer) */
    const char* light_groups;  /* NULL, or groups of lights, each a layer "light_NAME": "key=lamp,light:3;air=sky" */
};

typedef struct claray_progress {
    size_t struct_size;
    uint32_t spp;
    double seconds, noise, error;
    double error_bound;        /* upper bound of the error in most renders */
    double error_of_fireflies; /* the part of the squared error that single bright pixels have, 0 to 1 */
    double cut_off;            /* as claray_renderer_cut_off, if claray_render_config::error is set */
    uint32_t spp_target;
    uint32_t error_spp;        /* samples per pixel at the time of the error estimate */
    int32_t error_is_sure;     /* 0: fireflies make the estimate uncertain */
    int32_t own_kernels;       /* the scene's own kernels are in use */
    int32_t waits_for_kernels; /* sampling pauses while the scene's own kernels are compiled */
    uint32_t culled;           /* triangles left out */
    uint64_t dropped_samples;  /* not finite, or above 1e30 */
} claray_progress;

/* Return 0 to stop. */
typedef int (*claray_progress_callback)(const claray_progress* progress, void* user);

CLARAY_API claray_status claray_renderer_create(claray_device* device, const claray_scene* scene,
                                                const claray_render_config* config, claray_renderer** renderer);
/* Adds samples until a target is reached. Blocks. callback: NULL, or called several times a second. reached: NULL, or
 * receives the progress; set its struct_size. */
CLARAY_API claray_status claray_renderer_render(claray_renderer* renderer, claray_progress_callback callback,
                                                void* user, claray_progress* reached);
/* The same for at most so many seconds, but not before every pixel has a sample. */
CLARAY_API claray_status claray_renderer_render_for(claray_renderer* renderer, double seconds,
                                                    claray_progress_callback callback, void* user,
                                                    claray_progress* reached);
/* Discards all samples and restarts with another seed. spp, max_depth: 0, or not larger than those of the config. */
CLARAY_API claray_status claray_renderer_restart(claray_renderer* renderer, uint32_t seed, uint32_t spp,
                                                 uint32_t max_depth);
/* What has changed in a scene: bits of claray_renderer_update. */
typedef enum claray_scene_changes {
    CLARAY_CHANGED_CAMERA = 1,
    CLARAY_CHANGED_LIGHTS = 2,
    CLARAY_CHANGED_MATERIALS = 4, /* but not their textures */
    CLARAY_CHANGED_SKY = 8,
    CLARAY_CHANGED_INSTANCES = 16, /* transforms */
    CLARAY_CHANGED_VERTICES = 32   /* positions and normals */
} claray_scene_changes;
/* Discards all samples and continues with a scene that differs in `changes`; nothing else is read. */
CLARAY_API claray_status claray_renderer_update(claray_renderer* renderer, const claray_scene* scene, uint32_t changes);
/* Loads the fastest kernels now, so that no later render waits for one. Discards all samples. */
CLARAY_API claray_status claray_renderer_settle(claray_renderer* renderer);
/* Loads now what later renders would load or compile while they run. Keeps all samples. */
CLARAY_API claray_status claray_renderer_load_kernels(claray_renderer* renderer);
/* Discards all samples and makes the images this large. */
CLARAY_API claray_status claray_renderer_resize(claray_renderer* renderer, uint32_t width, uint32_t height);
CLARAY_API claray_status claray_renderer_size(const claray_renderer* renderer, uint32_t* width, uint32_t* height);
/* Rebuilds the tree. rebuilt: NULL, or 0 if the scene has instances or its own kernels are not in use. */
CLARAY_API claray_status claray_renderer_rebuild(claray_renderer* renderer, const claray_bvh_config* config,
                                                 int* rebuilt);
/* The share of light that is missing because paths end after max_depth surfaces, 0 to 1. An estimate. */
CLARAY_API claray_status claray_renderer_cut_off(const claray_renderer* renderer, double* cut_off);

/* The mean linear radiance: 3 floats for each pixel, row by row from the top left. count: floats in rgb, 3 width
 * height. */
CLARAY_API claray_status claray_renderer_image(claray_renderer* renderer, float* rgb, size_t count);
/* The alpha of each pixel, by which the image is premultiplied; 1 without claray_render_config::alpha. count: floats in
 * alpha, width * height. Of a region, width and height are the region's. */
CLARAY_API claray_status claray_renderer_alpha(const claray_renderer* renderer, float* alpha, size_t count);
/* The same in another size, without a copy; 0: as rendered. Valid until the next image of the renderer. */
CLARAY_API claray_status claray_renderer_radiance(const claray_renderer* renderer, uint32_t width, uint32_t height,
                                                  const float** rgb);

typedef enum claray_denoiser {
    CLARAY_DENOISER_AUTOMATIC = 0, /* Open Image Denoise if it is installed, else claray's own */
    CLARAY_DENOISER_CLARAY = 1,
    CLARAY_DENOISER_OIDN = 2
} claray_denoiser;
/* What CLARAY_DENOISER_AUTOMATIC stands for here; others unchanged. An error if CLARAY_DENOISER_OIDN is asked for and
 * not installed. */
CLARAY_API claray_status claray_denoiser_resolve(claray_denoiser denoiser, claray_denoiser* resolved);
/* The image without most of its noise (docs/denoise.md), as claray_renderer_image. The samples are kept. */
CLARAY_API claray_status claray_renderer_denoised(const claray_renderer* renderer, claray_denoiser denoiser, float* rgb,
                                                  size_t count);
/* Gives back what denoising keeps. */
CLARAY_API claray_status claray_renderer_release_denoiser(claray_renderer* renderer);

typedef struct claray_layer_info {
    size_t struct_size;
    const char* meaning; /* one line */
    uint32_t channels;   /* of each pixel */
    int32_t is_integer;  /* uint32_t, else float */
    const char* letters; /* of the channels in an EXR */
} claray_layer_info;
/* What a layer holds. Its name: "noise" or "error" (per pixel), "voxels" (of the light grid), or one of the first
 * surface at each pixel's centre, such as "depth" or "motion". claray_names_create lists these. Also "lobe_NAME" and
 * "light_NAME" of renders that keep layers of light (claray_render_config). */
CLARAY_API claray_status claray_layer_get(const char* name, claray_layer_info* info);
/* A layer, row by row from the top left. count: width * height * channels elements of 4 bytes. Blocks. */
CLARAY_API claray_status claray_renderer_layer(claray_renderer* renderer, const char* name, void* values, size_t count);

/* What a Cryptomatte tells apart. */
typedef enum claray_matte {
    CLARAY_MATTE_OBJECT = 0,   /* instances by their names; without instances meshes and sets of primitives */
    CLARAY_MATTE_MATERIAL = 1, /* materials */
    CLARAY_MATTE_ASSET = 2     /* meshes: all instances of a mesh are one */
} claray_matte;
typedef struct claray_cryptomatte claray_cryptomatte;
typedef struct claray_cryptomatte_info {
    size_t struct_size;
    const char* name;     /* of the layer */
    uint32_t ranks;       /* surfaces of each pixel, an even number */
    const float* parts;   /* id and coverage of `ranks` surfaces of each pixel, the largest first */
    size_t part_count;    /* width * height * ranks; each has two floats */
    const char* manifest; /* JSON: names, and their hashes in hexadecimal */
} claray_cryptomatte_info;
/* Which surfaces each pixel shows, by so many of its camera rays. Psyop's specification 1.2.0. Blocks. */
CLARAY_API claray_status claray_cryptomatte_create(const claray_renderer* renderer, claray_matte kind, uint32_t samples,
                                                   claray_cryptomatte** matte);
/* Valid while the handle is. */
CLARAY_API claray_status claray_cryptomatte_get(const claray_cryptomatte* matte, claray_cryptomatte_info* info);
CLARAY_API void claray_cryptomatte_release(claray_cryptomatte* matte);
/* The hash of a name, MurmurHash3_32, and its id as pixels hold it. */
CLARAY_API uint32_t claray_matte_hash(const char* name);
CLARAY_API float claray_matte_id(uint32_t hash);

/* Estimates the error of an image of this render, as claray_image_error::rmse; 0 if it is too small to tell. */
CLARAY_API claray_status claray_renderer_error_of(claray_renderer* renderer, const float* rgb, size_t count,
                                                  double* error);
/* Estimates the error of a render with approximations. exact: of the same scene and size, without them. */
CLARAY_API claray_status claray_approximation_error(claray_renderer* approximate, claray_renderer* exact,
                                                    double* error);

/* How unit vectors become two 16-bit numbers. */
typedef enum claray_normal_packing {
    CLARAY_NORMALS_OCTAHEDRAL = 0,
    CLARAY_NORMALS_SPHERICAL = 1
} claray_normal_packing;
/* What deferred shading keeps of a pixel's surface (claray/shared/gbuffer.h). */
typedef struct claray_gbuffer_pixel {
    uint32_t albedo_material; /* bytes from the lowest: red, green, blue as sRGB, and the material's index */
    uint32_t normal;
    float depth; /* reversed: 1 on the near plane, 0 infinitely far away */
} claray_gbuffer_pixel;
/* count: width * height. world_from_image: a matrix in columns, from image and depth to the world; NULL: not needed. */
CLARAY_API claray_status claray_renderer_gbuffer(const claray_renderer* renderer, claray_normal_packing packing,
                                                 claray_gbuffer_pixel* pixels, size_t count,
                                                 double world_from_image[16]);
/* Unpacks it: 3 floats for each pixel. normals: 0 0 0 where there is no surface. positions: not finite there. Both may
 * be NULL. */
CLARAY_API claray_status claray_gbuffer_unpack(const claray_gbuffer_pixel* pixels, uint32_t width, uint32_t height,
                                               claray_normal_packing packing, const double world_from_image[16],
                                               float* normals, float* positions);

typedef struct claray_ray_count {
    uint64_t rays;
    double milliseconds; /* of tracing; 0: unknown */
} claray_ray_count;
/* The kernels with which a render started. */
typedef enum claray_kernel_start {
    CLARAY_START_OWN = 0,     /* compiled for the scene's effects */
    CLARAY_START_GENERIC = 1, /* support all effects */
    CLARAY_START_QUICK = 2    /* compile fastest */
} claray_kernel_start;
typedef struct claray_render_statistics {
    size_t struct_size;
    double first_pixel_seconds;           /* from creating the renderer to the first samples */
    double first_pixel_processor_seconds; /* CPU time of the process in that period */
    claray_kernel_start start;
    uint32_t own_kernels_from; /* samples per pixel that were done when the scene's own kernels took over */
    int32_t own_kernels;       /* whether these are in use */
    uint32_t primitives;       /* that are not triangles */
    double build_milliseconds; /* device time of building the tree */
    claray_ray_count camera, bounce, shadow;
    claray_ray_count in_paths;   /* rays of the above that a kernel of whole paths traced */
    const char* effects;         /* of the scene, separated by commas */
    uint64_t device_bytes;       /* of this renderer's buffers */
    uint64_t most_device_bytes;  /* the most that all buffers on this device have been at once */
    uint64_t bytes_paged;        /* copied to the device because parts took turns */
    uint32_t parts;              /* of the tree */
    int32_t adapted;             /* some pixels got more samples than others */
    int32_t guided;              /* paths were guided, or will be */
    double longest_milliseconds; /* longest command of this device */
    const char* longest_command; /* its name */
    uint64_t dropped_samples;
    double measuring_seconds;     /* used to estimate noise and error */
    const char* why_unguided;     /* why paths are not guided, or "" */
    const char* checkpoint_error; /* why the last checkpoint could not be written, or "" */
} claray_render_statistics;
/* May wait for a kernel to be compiled. bvh: NULL, or receives those of the tree, but for its layout. Texts are valid
 * until the next call for the renderer. */
CLARAY_API claray_status claray_renderer_statistics_get(claray_renderer* renderer, claray_bvh_statistics* bvh,
                                                        claray_render_statistics* statistics);
CLARAY_API void claray_renderer_release(claray_renderer* renderer);

/* ---- pictures and image files ---- */

typedef enum claray_tone_map {
    CLARAY_TONE_MAP_ACES = 0, /* filmic curve */
    CLARAY_TONE_MAP_NONE = 1  /* clamps to 0..1 */
} claray_tone_map;
/* How radiance becomes colours of 8 bits. */
typedef struct claray_picture_config {
    size_t struct_size;
    float exposure; /* stops */
    claray_tone_map tone_map;
    uint32_t width, height; /* of a renderer's picture, interpolated; 0: as rendered */
    int32_t denoised;       /* of a renderer's picture: by claray's denoiser for frames that follow each other */
} claray_picture_config;
/* Red, green, blue and 255 of each pixel, in memory of the renderer, until its next picture. config: NULL for the
 * defaults. */
CLARAY_API claray_status claray_renderer_picture(claray_renderer* renderer, const claray_picture_config* config,
                                                 const uint8_t** rgba);
/* Exposure, tone map and the sRGB curve for `count` numbers. */
CLARAY_API claray_status claray_tone_map_apply(const float* radiance, size_t count, const claray_picture_config* config,
                                               uint8_t* srgb);
/* The inverse of the sRGB curve, 0..1. */
CLARAY_API float claray_linear_from_srgb(uint8_t value);
/* Writes linear RGB by extension: .png, .jpg and .webp (tone mapped), .hdr, .pfm or .exr. */
CLARAY_API claray_status claray_write_image(const char* path, const float* rgb, uint32_t width, uint32_t height,
                                            const claray_picture_config* config);
/* The errors of claray_write_image for this path. Call it before rendering. */
CLARAY_API claray_status claray_check_writable(const char* path);
/* One value for each pixel, as .pfm with a single channel. */
CLARAY_API claray_status claray_write_pfm(const char* path, const float* values, uint32_t width, uint32_t height);
/* Channels of an EXR, pixel by pixel: `values` or `numbers`. */
typedef struct claray_exr_layer {
    const char* name;     /* "" or NULL: the image itself */
    const char* channels; /* a letter each: "RGB" */
    const float* values;
    const uint32_t* numbers;
} claray_exr_layer;
CLARAY_API claray_status claray_write_exr(const char* path, uint32_t width, uint32_t height,
                                          const claray_exr_layer* layers, size_t count);
/* The same with Cryptomattes of that size. */
CLARAY_API claray_status claray_write_exr_with_mattes(const char* path, uint32_t width, uint32_t height,
                                                      const claray_exr_layer* layers, size_t count,
                                                      const claray_cryptomatte* const* mattes, size_t matte_count);
/* Perceptually uniform colours from the least to the largest finite value; others are black. rgb: 3 count floats. */
CLARAY_API claray_status claray_false_color(const float* values, size_t count, float* rgb);
/* A colour for each number; CLARAY_MISS is black. rgb: 3 count floats. */
CLARAY_API claray_status claray_identifier_color(const uint32_t* numbers, size_t count, float* rgb);

typedef struct claray_image_error {
    size_t struct_size;
    double rmse;       /* square root of the mean squared difference, over the reference's mean */
    double relmse;     /* mean of (difference / (reference + 1 % of its mean))^2 */
    double perceptual; /* 0 to 1: the colour term of FLIP */
} claray_image_error;
/* Compares images of linear RGB. */
CLARAY_API claray_status claray_image_compare(const float* rgb, const float* reference, uint32_t width, uint32_t height,
                                              claray_image_error* error);

/* ---- baking ---- */

/* Renders the light that arrives at a point: a cube of images of config->height pixels a side. It becomes the
 * environment of `to`, which may be the same scene. */
CLARAY_API claray_status claray_probe_render(claray_device* device, const claray_scene* scene, const float position[3],
                                             const claray_render_config* config, claray_scene* to);

typedef struct claray_light_map_config {
    size_t struct_size;
    uint32_t width, height; /* texels; 0: 128 */
    uint32_t spp;           /* paths of each texel; 0: 256 */
    uint32_t max_depth;     /* 0: 128 */
    uint32_t seed;
    uint32_t uv_set; /* coordinates that map the mesh to 0..1 without overlaps: 0 or 1; claray_light_map_uv_set */
    claray_sampler sampler;
    const claray_bvh_config* bvh;
} claray_light_map_config;
/* Receives the fraction done. Return 0 to stop, which is an error. */
typedef int (*claray_fraction_callback)(double done, void* user);
/* Bakes the irradiance of the front of a mesh, in W / m^2. config, callback: may be NULL. */
CLARAY_API claray_status claray_light_map_create(claray_device* device, const claray_scene* scene, size_t mesh,
                                                 const claray_light_map_config* config,
                                                 claray_fraction_callback callback, void* user, claray_image** image);
/* The second set of coordinates if the mesh has one, else the first. */
CLARAY_API claray_status claray_light_map_uv_set(const claray_scene* scene, size_t mesh, uint32_t* uv_set);
/* Assigns a light map to the Lambertian materials of a mesh, which are copied first. */
CLARAY_API claray_status claray_scene_light_map_set(claray_scene* scene, size_t mesh, const claray_texture* light_map,
                                                    uint32_t uv_set);

/* ---- several devices ---- */

typedef struct claray_group claray_group;
/* One image by several devices, bit for bit that of one. tell: NULL, or receives a line for each device that fails. */
CLARAY_API claray_status claray_group_create(claray_device* const* devices, size_t count, const claray_scene* scene,
                                             const claray_render_config* config, claray_line_callback tell, void* user,
                                             claray_group** group);
CLARAY_API claray_status claray_group_render(claray_group* group, claray_progress_callback callback, void* user,
                                             claray_progress* reached);
/* The renderer of the first device that did not fail, which has the whole image after a render. */
CLARAY_API claray_status claray_group_renderer_create(claray_group* group, claray_renderer** renderer);
typedef struct claray_device_share {
    size_t struct_size;
    const char* name;
    const char* failure; /* why the device was dropped, or "" */
    uint64_t samples;    /* paths that it has rendered */
    double samples_per_second;
} claray_device_share;
/* What device i contributed. Texts are valid until the next call for the group. */
CLARAY_API claray_status claray_group_share_get(claray_group* group, size_t i, claray_device_share* share);
/* Why the last checkpoint could not be written, or "". */
CLARAY_API const char* claray_group_checkpoint_error(const claray_group* group);
CLARAY_API void claray_group_release(claray_group* group);

/* ---- targets ---- */

/* Receives the name of the next measurement. Return 0 to stop. */
typedef int (*claray_measuring_callback)(const char* what, void* user);
/* How fast a device builds trees and renders. */
typedef struct claray_builder_model {
    double build_nanoseconds; /* of a triangle */
    double samples_per_second;
} claray_builder_model;
typedef struct claray_device_model {
    size_t struct_size;
    claray_builder_model fast, balanced, high;
    double independent_cost; /* time of independent samples over that of Sobol samples, at equal error */
    int32_t known;           /* 0: the device has not been measured */
} claray_device_model;
/* The model that is stored for the device. */
CLARAY_API claray_status claray_device_model_get(const claray_device* device, claray_device_model* model);
/* Measures it with so many triangles; 0: 100,000. Takes a few seconds. callback: may be NULL. */
CLARAY_API claray_status claray_device_model_measure(claray_device* device, size_t triangles,
                                                     claray_measuring_callback callback, void* user,
                                                     claray_device_model* model);
/* The model as rows of the tuning table: "kernel parameter value". */
CLARAY_API claray_status claray_device_model_rows_create(const claray_device_model* model, claray_lines** rows);
/* The builder with the least time for building and for tracing that takes `seconds` with the fast one. built: of the
 * tree that exists. */
CLARAY_API claray_status claray_device_model_builder(const claray_device_model* model, size_t triangles, double seconds,
                                                     claray_builder built, claray_builder* builder);
/* The same for a render of config->spp samples, by the stored model. */
CLARAY_API claray_status claray_builder_for_samples(const claray_device* device, const claray_scene* scene,
                                                    const claray_render_config* config, claray_builder* builder);

typedef struct claray_plan claray_plan;
/* Chooses sampler and builder for a render to config->error or within config->seconds. keep_builder: does not choose
 * it. callback: NULL, or called if the device must be measured, here or in a render. */
CLARAY_API claray_status claray_plan_create(claray_device* device, const claray_scene* scene,
                                            const claray_render_config* config, int keep_builder,
                                            claray_measuring_callback callback, void* user, claray_plan** plan);
/* The config with what was chosen: renderers and groups are created with it. Valid while the plan is. */
CLARAY_API claray_status claray_plan_config_get(claray_plan* plan, claray_render_config* config);
/* Renders to the target: as claray_renderer_render and claray_group_render. */
CLARAY_API claray_status claray_plan_render(claray_plan* plan, claray_renderer* renderer,
                                            claray_progress_callback callback, void* user, claray_progress* reached);
CLARAY_API claray_status claray_plan_render_group(claray_plan* plan, claray_group* group,
                                                  claray_progress_callback callback, void* user,
                                                  claray_progress* reached);
typedef struct claray_plan_result {
    size_t struct_size;
    double promised_seconds; /* sampling time, predicted after the first samples */
    int32_t is_kept;         /* the target was met by the latest render */
    const char* account;     /* one line that compares it with the target; valid until the plan's next call */
} claray_plan_result;
CLARAY_API claray_status claray_plan_result_get(claray_plan* plan, claray_plan_result* result);
/* Each choice and its reason. */
CLARAY_API claray_status claray_plan_picks_create(const claray_plan* plan, claray_lines** picks);
CLARAY_API void claray_plan_release(claray_plan* plan);

typedef struct claray_frames claray_frames;
typedef struct claray_frames_config {
    size_t struct_size;
    double fps;                          /* 0: 60 */
    uint32_t frames;                     /* 0: 300 */
    int32_t keep_builder;                /* does not choose it */
    double orbit;                        /* degrees by which the camera turns round its target over all frames */
    claray_measuring_callback measuring; /* NULL, or called for each measurement */
} claray_frames_config;
typedef struct claray_frames_report {
    size_t struct_size;
    uint32_t spp, max_depth;   /* that were chosen */
    uint32_t width, height;    /* of the images that are traced, and then enlarged */
    const char* approximate;   /* approximations, or "nothing" */
    double error;              /* RMSE of a frame over the mean, if one sample of full depth takes too long; else 0 */
    double median, percentile; /* of the seconds: median and 99th percentile */
    const double* seconds;     /* of each frame */
    size_t frame_count;
    const float* image; /* the last frame, in the size of the config */
    size_t image_count; /* its floats */
} claray_frames_report;
/* Receives the number of frames done. Return 0 to stop. */
typedef int (*claray_frame_callback)(uint32_t done, void* user);
/* Renders frames so that each takes at most 1 / fps. config->spp and config->max_depth are upper limits. */
CLARAY_API claray_status claray_frames_create(claray_device* device, const claray_scene* scene,
                                              const claray_render_config* config, const claray_frames_config* wanted,
                                              claray_frame_callback callback, void* user, claray_frames** frames);
CLARAY_API claray_status claray_frames_get(const claray_frames* frames, claray_frames_report* report);
/* Each choice and its reason. */
CLARAY_API claray_status claray_frames_picks_create(const claray_frames* frames, claray_lines** picks);
CLARAY_API void claray_frames_release(claray_frames* frames);

#ifdef __cplusplus
}
#endif

#endif
