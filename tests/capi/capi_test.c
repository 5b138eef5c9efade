/* claray.h, from C: results, errors, versions of structs, and that handles may be released in any order. */
#include "capi_test.h"

int failures = 0;

/* A square of two triangles in the plane z = 0. */
static const float square[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
static const uint32_t halves[] = {0, 1, 2, 0, 2, 3};

claray_mesh square_mesh(void) {
    claray_mesh mesh = {0};
    mesh.struct_size = sizeof mesh;
    mesh.vertices = square, mesh.vertex_count = 4;
    mesh.triangles = halves, mesh.triangle_count = 2;
    return mesh;
}

/* Over the square, one beside it, one from behind, one of no numbers. */
static void fill_rays(claray_ray rays[4]) {
    const claray_ray front = {{0.75f, 0.25f, 2}, 0, {0, 0, -1}, INFINITY};
    for (int i = 0; i < 4; ++i) rays[i] = front;
    rays[1].origin[0] = 5;
    rays[2].origin[2] = -3, rays[2].direction[2] = 1;
    rays[3].direction[0] = NAN;
}

static void test_queries(claray_device* device) {
    claray_mesh mesh = square_mesh();
    claray_bvh* bvh = NULL;
    claray_ray rays[4];
    claray_hit hits[4];
    uint8_t any[4];
    fill_rays(rays);
    EXPECT(claray_bvh_build(device, &mesh, NULL, &bvh) == CLARAY_OK);
    int closed_surface = -1;
    EXPECT(claray_bvh_triangle_count(bvh) == 2);
    EXPECT(claray_bvh_is_closed(bvh, &closed_surface) == CLARAY_OK && closed_surface == 0);
    EXPECT(claray_closest_hit(bvh, rays, 4, hits) == CLARAY_OK);
    EXPECT(hits[0].primitive == 0 && hits[0].t == 2 && hits[0].geometry == 0);
    EXPECT(hits[1].primitive == CLARAY_MISS && isinf(hits[1].t));
    EXPECT(hits[2].primitive == 0 && hits[2].t == 3);
    EXPECT(hits[3].primitive == CLARAY_MISS);
    EXPECT(claray_any_hit(bvh, rays, 4, any) == CLARAY_OK);
    EXPECT(any[0] == 1 && any[1] == 0 && any[2] == 1 && any[3] == 0);
    EXPECT(claray_closest_hit(bvh, NULL, 0, NULL) == CLARAY_OK);

    claray_query_options options = {0};
    claray_query* query = NULL;
    options.struct_size = sizeof options;
    options.cull_back_faces = 1;
    EXPECT(claray_query_create(bvh, CLARAY_QUERY_CLOSEST, &options, NULL, &query) == CLARAY_OK);
    claray_bvh_release(bvh); /* the query keeps it */
    for (int run = 0; run < 2; ++run) {
        memset(hits, 0xee, sizeof hits);
        EXPECT(claray_query_run(query, rays, 4, hits) == CLARAY_OK);
        EXPECT(hits[0].primitive == 0 && hits[2].primitive == CLARAY_MISS);
    }
    claray_query_release(query);
}

static void test_closed(claray_device* device) {
    claray_mesh mesh = square_mesh();
    claray_bvh* bvh = NULL;
    claray_query_options options = {0};
    const claray_ray border[4] = {{{1, 0.5f, 2}, 0, {0, 0, -1}, 9},
                                  {{0, 0.5f, 2}, 0, {0, 0, -1}, 9},
                                  {{0.5f, 1, 2}, 0, {0, 0, -1}, 9},
                                  {{0.5f, 0, 2}, 0, {0, 0, -1}, 9}};
    options.struct_size = sizeof options;
    EXPECT(claray_bvh_build(device, &mesh, NULL, &bvh) == CLARAY_OK);
    for (int closed = 0; closed < 2; ++closed) {
        claray_query* query = NULL;
        uint8_t any[4];
        options.closed = closed;
        EXPECT(claray_query_create(bvh, CLARAY_QUERY_ANY, &options, NULL, &query) == CLARAY_OK);
        EXPECT(claray_query_run(query, border, 4, any) == CLARAY_OK);
        EXPECT(any[0] + any[1] + any[2] + any[3] == (closed ? 4 : 2)); /* half open: one of opposite borders */
        claray_query_release(query);
    }
    claray_bvh_release(bvh);
}

/* The words of a saved tree in order, since the numbers of its nodes depend on the schedule. */
static int by_value(const void* a, const void* b) {
    const uint32_t x = *(const uint32_t*)a, y = *(const uint32_t*)b;
    return x < y ? -1 : x > y;
}

static size_t saved_words(claray_device* device, const claray_bvh_config* config, uint32_t* words, size_t room) {
    enum { triangles = 64 };
    static float vertices[9 * triangles];
    static uint32_t indices[3 * triangles];
    for (int i = 0; i < 9 * triangles; ++i) vertices[i] = (float)((i * 7919 + i / 3 * 104729) % 1009);
    for (int i = 0; i < 3 * triangles; ++i) indices[i] = (uint32_t)i;
    claray_mesh mesh = {0};
    claray_bvh* bvh = NULL;
    mesh.struct_size = sizeof mesh;
    mesh.vertices = vertices, mesh.vertex_count = 3 * triangles;
    mesh.triangles = indices, mesh.triangle_count = triangles;
    EXPECT(claray_bvh_build(device, &mesh, config, &bvh) == CLARAY_OK);
    EXPECT(claray_bvh_save(bvh, "capi_builder.cbvh") == CLARAY_OK);
    claray_bvh_release(bvh);
    FILE* file = fopen("capi_builder.cbvh", "rb");
    const size_t count = file ? fread(words, sizeof *words, room, file) : 0;
    if (file) fclose(file);
    remove("capi_builder.cbvh");
    EXPECT(count > 1000 && count < room);
    qsort(words, count, sizeof *words, by_value);
    return count;
}

/* How many words two trees do not have in common. Those of one builder differ in a checksum and a few numbers at most.
 */
static size_t differences(const uint32_t* a, size_t a_count, const uint32_t* b, size_t b_count) {
    size_t i = 0, k = 0, common = 0;
    while (i < a_count && k < b_count) {
        if (a[i] == b[k])
            ++common, ++i, ++k;
        else if (a[i] < b[k])
            ++i;
        else
            ++k;
    }
    return a_count + b_count - 2 * common;
}

/* A config of zeros builds as no config does, and otherwise than the fast builder. */
static void test_builders(claray_device* device) {
    enum { room = 1 << 14 };
    static uint32_t without[room], zeros[room], fast[room];
    claray_bvh_config config = {0};
    config.struct_size = sizeof config;
    EXPECT(config.builder == CLARAY_BUILDER_AUTOMATIC);
    const size_t without_count = saved_words(device, NULL, without, room);
    const size_t zeros_count = saved_words(device, &config, zeros, room);
    config.builder = CLARAY_BUILDER_FAST;
    const size_t fast_count = saved_words(device, &config, fast, room);
    const size_t same = differences(without, without_count, zeros, zeros_count);
    const size_t others = differences(without, without_count, fast, fast_count);
    EXPECT(same < 100 && others > 200);
    claray_bvh* bvh = NULL;
    claray_mesh mesh = square_mesh();
    config.builder = (claray_builder)(CLARAY_BUILDER_BINNED + 1);
    EXPECT_ERROR(claray_bvh_build(device, &mesh, &config, &bvh), CLARAY_ERROR_USAGE, "config.builder is 5");
}

static void test_refit(claray_device* device) {
    claray_mesh mesh = square_mesh();
    claray_bvh_config config = {0};
    claray_bvh* bvh = NULL;
    float moved[12];
    claray_ray rays[4];
    claray_hit hit;
    config.struct_size = sizeof config;
    config.builder = CLARAY_BUILDER_BINNED;
    fill_rays(rays);
    memcpy(moved, square, sizeof moved);
    EXPECT(claray_bvh_build(device, &mesh, &config, &bvh) == CLARAY_OK);
    for (int rebuild = 0; rebuild < 2; ++rebuild) {
        for (int i = 0; i < 4; ++i) moved[3 * i + 2] = 0.5f + (float)rebuild;
        EXPECT(claray_bvh_move(bvh, moved, 4, rebuild) == CLARAY_OK);
        EXPECT(claray_closest_hit(bvh, rays, 1, &hit) == CLARAY_OK && hit.t == 1.5f - (float)rebuild);
    }
    EXPECT_ERROR(claray_bvh_move(bvh, moved, 3, 0), CLARAY_ERROR_USAGE, "vertex_count is 3");
    claray_bvh_release(bvh);
}

/* Two queues, an event between them, and buffers of the device. */
static void test_buffers(claray_device* device) {
    claray_mesh mesh = square_mesh();
    claray_bvh* bvh = NULL;
    claray_device* other = NULL;
    claray_query* query = NULL;
    claray_query_options options = {0};
    claray_ray rays[4];
    claray_hit hits[4];
    cl_int error = 0;
    cl_event written = NULL;
    void* done = NULL;
    options.struct_size = sizeof options;
    options.coherence = CLARAY_COHERENCE_COHERENT;
    fill_rays(rays);
    EXPECT(claray_bvh_build(device, &mesh, NULL, &bvh) == CLARAY_OK);
    EXPECT(claray_device_new_queue_create(device, &other) == CLARAY_OK);
    EXPECT(claray_query_create(bvh, CLARAY_QUERY_CLOSEST, &options, other, &query) == CLARAY_OK);
    cl_context context = (cl_context)claray_device_context(device);
    EXPECT(context == (cl_context)claray_device_context(other) &&
           claray_device_queue(device) != claray_device_queue(other));
    cl_mem ray_memory = clCreateBuffer(context, CL_MEM_READ_WRITE, sizeof rays, NULL, &error);
    cl_mem hit_memory = clCreateBuffer(context, CL_MEM_READ_WRITE, sizeof hits, NULL, &error);
    EXPECT(clEnqueueWriteBuffer((cl_command_queue)claray_device_queue(device), ray_memory, CL_FALSE, 0, sizeof rays,
                                rays, 0, NULL, &written) == CL_SUCCESS);
    const void* wait_for[] = {written};
    EXPECT(claray_query_enqueue(query, ray_memory, hit_memory, 4, wait_for, 1, &done) == CLARAY_OK);
    cl_event finished = (cl_event)done;
    EXPECT(clWaitForEvents(1, &finished) == CL_SUCCESS);
    EXPECT(clEnqueueReadBuffer((cl_command_queue)claray_device_queue(other), hit_memory, CL_TRUE, 0, sizeof hits, hits,
                               0, NULL, NULL) == CL_SUCCESS);
    EXPECT(hits[0].primitive == 0 && hits[1].primitive == CLARAY_MISS && hits[2].t == 3);
    EXPECT_ERROR(claray_query_enqueue(query, ray_memory, hit_memory, 5, NULL, 0, NULL), CLARAY_ERROR_USAGE,
                 "are needed");
    EXPECT_ERROR(claray_query_enqueue(query, NULL, hit_memory, 4, NULL, 0, NULL), CLARAY_ERROR_USAGE, "null");

    claray_device* stranger = NULL; /* another context */
    claray_query* misplaced = NULL;
    EXPECT(claray_device_open("0", &stranger) == CLARAY_OK);
    EXPECT_ERROR(claray_query_create(bvh, CLARAY_QUERY_CLOSEST, NULL, stranger, &misplaced), CLARAY_ERROR_USAGE,
                 "different contexts");
    cl_mem foreign =
        clCreateBuffer((cl_context)claray_device_context(stranger), CL_MEM_READ_WRITE, sizeof rays, NULL, &error);
    EXPECT_ERROR(claray_query_enqueue(query, foreign, hit_memory, 4, NULL, 0, NULL), CLARAY_ERROR_USAGE,
                 "another context");
    clReleaseMemObject(foreign);
    claray_device_release(stranger);
    clReleaseEvent(finished), clReleaseEvent(written);
    clReleaseMemObject(ray_memory), clReleaseMemObject(hit_memory);
    claray_device_release(other);
    claray_bvh_release(bvh);
    claray_query_release(query);
}

/* A tetrahedron with three edges of length 1 along the axes; counter-clockwise from outside. */
claray_bvh* corner_of(claray_device* device) {
    static const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    claray_mesh mesh = {0};
    claray_bvh* bvh = NULL;
    mesh.struct_size = sizeof mesh;
    mesh.vertices = corners, mesh.vertex_count = 4;
    mesh.triangles = faces, mesh.triangle_count = 4;
    EXPECT(claray_bvh_build(device, &mesh, NULL, &bvh) == CLARAY_OK);
    return bvh;
}

static void test_points(claray_device* device) {
    claray_bvh* bvh = corner_of(device);
    const float points[] = {0.125f, 0.25f, 0.25f, 0.25f, 0.25f, -2, NAN, 0, 0};
    claray_nearest nearest[3];
    uint8_t inside[3];
    float distances[3];
    EXPECT(claray_nearest_point(bvh, points, 3, INFINITY, nearest) == CLARAY_OK);
    EXPECT(nearest[0].distance == 0.125f && nearest[0].point[0] == 0 && nearest[0].primitive == 2);
    EXPECT(nearest[1].distance == 2 && nearest[1].point[2] == 0 && nearest[1].primitive == 0);
    EXPECT(nearest[2].primitive == CLARAY_MISS);
    EXPECT(claray_nearest_point(bvh, points, 2, 0.5f, nearest) == CLARAY_OK);
    EXPECT(nearest[0].primitive == 2 && nearest[1].primitive == CLARAY_MISS && nearest[1].distance == 0.5f);
    EXPECT(claray_inside(bvh, points, 3, inside) == CLARAY_OK);
    EXPECT(inside[0] == 1 && inside[1] == 0 && inside[2] == 0);
    EXPECT(claray_signed_distance(bvh, points, 2, distances) == CLARAY_OK);
    EXPECT(distances[0] == -0.125f && distances[1] == 2);
    EXPECT(claray_inside(bvh, NULL, 0, NULL) == CLARAY_OK);
    int closed = -1;
    EXPECT(claray_bvh_is_closed(bvh, &closed) == CLARAY_OK && closed == 1);
    EXPECT_ERROR(claray_bvh_is_closed(bvh, NULL), CLARAY_ERROR_USAGE, "closed is NULL");
    EXPECT_ERROR(claray_bvh_is_closed(NULL, &closed), CLARAY_ERROR_USAGE, "bvh is NULL");
    EXPECT_ERROR(claray_nearest_point(bvh, points, 3, -1, nearest), CLARAY_ERROR_USAGE, "reach is -1");
    EXPECT_ERROR(claray_nearest_point(bvh, points, 3, NAN, nearest), CLARAY_ERROR_USAGE, "reach is");
    EXPECT_ERROR(claray_nearest_point(bvh, points, 3, 1, NULL), CLARAY_ERROR_USAGE, "nearest is NULL");
    EXPECT_ERROR(claray_inside(bvh, NULL, 3, inside), CLARAY_ERROR_USAGE, "points is NULL");
    EXPECT_ERROR(claray_signed_distance(NULL, points, 3, distances), CLARAY_ERROR_USAGE, "bvh is NULL");
    claray_bvh_release(bvh);
}

static void test_lists(claray_device* device) {
    claray_bvh* bvh = corner_of(device);
    const claray_ray rays[2] = {{{0.25f, 0.25f, -1}, 0, {0, 0, 1}, INFINITY}, {{5, 5, -1}, 0, {0, 0, 1}, INFINITY}};
    uint32_t counts[2];
    claray_hit hits[6];
    EXPECT(claray_count_hits(bvh, rays, 2, counts) == CLARAY_OK && counts[0] == 2 && counts[1] == 0);
    EXPECT(claray_nearest_hits(bvh, rays, 2, 3, hits, counts) == CLARAY_OK && counts[0] == 2 && counts[1] == 0);
    EXPECT(hits[0].t == 1 && hits[0].primitive == 0 && hits[1].t == 1.5f && hits[1].primitive == 3);
    EXPECT(claray_nearest_hits(bvh, rays, 1, 1, hits, counts) == CLARAY_OK && counts[0] == 1 && hits[0].t == 1);
    EXPECT(claray_count_hits(bvh, NULL, 0, NULL) == CLARAY_OK);
    EXPECT_ERROR(claray_count_hits(bvh, NULL, 1, counts), CLARAY_ERROR_USAGE, "rays is NULL");
    EXPECT_ERROR(claray_count_hits(bvh, rays, 2, NULL), CLARAY_ERROR_USAGE, "counts is NULL");
    EXPECT_ERROR(claray_nearest_hits(bvh, rays, 2, 0, hits, counts), CLARAY_ERROR_USAGE, "most is 0");
    EXPECT_ERROR(claray_nearest_hits(bvh, rays, 2, 1, NULL, counts), CLARAY_ERROR_USAGE, "hits is NULL");
    claray_bvh_release(bvh);
}

static void test_instances(claray_device* device) {
    claray_mesh mesh = square_mesh();
    claray_bvh *flat = NULL, *solid = corner_of(device);
    claray_instances* placed = NULL;
    claray_query *closest = NULL, *any = NULL;
    claray_instance_hit hits[2];
    uint8_t occluded[2];
    EXPECT(claray_bvh_build(device, &mesh, NULL, &flat) == CLARAY_OK);
    const claray_bvh* const bvhs[2] = {flat, solid};
    claray_instance instances[2] = {{{1, 0, 0, 10, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 1},
                                    {{1, 0, 0, 20, 0, 1, 0, 0, 0, 0, 1, 0}, 1, 1}};
    const claray_ray rays[2] = {{{10.75f, 0.25f, 2}, 0, {0, 0, -1}, 9}, {{20.25f, 0.25f, 2}, 0, {0, 0, -1}, 9}};
    EXPECT(claray_instances_build(bvhs, 2, instances, 2, &placed) == CLARAY_OK);
    EXPECT(claray_query_instances_create(placed, CLARAY_QUERY_CLOSEST, NULL, NULL, &closest) == CLARAY_OK);
    EXPECT(claray_query_instances_create(placed, CLARAY_QUERY_ANY, NULL, NULL, &any) == CLARAY_OK);
    claray_bvh_release(flat), claray_bvh_release(solid); /* the instances keep them */
    EXPECT(claray_query_run(closest, rays, 2, hits) == CLARAY_OK);
    EXPECT(hits[0].instance == 0 && hits[0].t == 2 && hits[0].primitive == 0);
    EXPECT(hits[1].instance == 1 && hits[1].t == 1.5f && hits[1].primitive == 3);
    for (int rebuild = 0; rebuild < 2; ++rebuild) {
        instances[0].transform[3] = 30.f + (float)rebuild;
        EXPECT(claray_instances_move(placed, instances, 2, rebuild) == CLARAY_OK);
        EXPECT(claray_query_run(any, rays, 2, occluded) == CLARAY_OK && occluded[0] == 0 && occluded[1] == 1);
    }
    claray_instances* none = NULL;
    EXPECT_ERROR(claray_instances_move(placed, instances, 1, 0), CLARAY_ERROR_USAGE, "count is 1");
    EXPECT_ERROR(claray_instances_move(placed, NULL, 2, 0), CLARAY_ERROR_USAGE, "instances is NULL");
    EXPECT_ERROR(claray_instances_build(bvhs, 0, instances, 1, &none), CLARAY_ERROR_USAGE, "structure 0 of 0");
    instances[1].bottom = 2;
    EXPECT_ERROR(claray_instances_move(placed, instances, 2, 0), CLARAY_ERROR_USAGE, "structure 2 of 2");
    EXPECT_ERROR(claray_instances_build(NULL, 1, instances, 1, &none), CLARAY_ERROR_USAGE, "bvhs is NULL");
    EXPECT_ERROR(claray_query_instances_create(NULL, CLARAY_QUERY_ANY, NULL, NULL, &any), CLARAY_ERROR_USAGE,
                 "placed is NULL");
    EXPECT(none == NULL);
    claray_instances_release(placed);
    claray_query_release(closest), claray_query_release(any);
}

/* A square in a group, two of them in a group of groups, and a square beside it. */
static void test_flat_instances(claray_device* device) {
    claray_mesh mesh = square_mesh();
    claray_bvh* bvh = NULL;
    claray_flat_instances* flat = NULL;
    claray_instances* placed = NULL;
    claray_query* closest = NULL;
    const claray_instance square = {{1, 0, 0, 10, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 6};
    claray_instance pair[2] = {{{2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 1}, 1, 3},
                               {{1, 0, 0, 0, 0, 1, 0, 50, 0, 0, 1, 0}, 1, 12}};
    const claray_instance roots[2] = {{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 1},
                                      {{1, 0, 0, 100, 0, 1, 0, 0, 0, 0, 1, 0}, 2, 7}};
    const claray_instance_group groups[2] = {{&square, 1}, {pair, 2}};
    EXPECT(claray_flat_instances_create(roots, 2, groups, 2, 1, &flat) == CLARAY_OK);
    EXPECT(claray_flat_instances_count(flat) == 3);
    const claray_instance* members = claray_flat_instances_members(flat);
    EXPECT(members[0].transform[3] == 0 && members[0].mask == 1 && members[0].bottom == 0);
    EXPECT(members[1].transform[0] == 2 && members[1].transform[3] == 120 && members[1].transform[11] == 1);
    EXPECT(members[1].mask == 2 && members[2].mask == 4 && members[2].transform[3] == 110 &&
           members[2].transform[7] == 50);
    size_t count = 9;
    const uint32_t* steps = claray_flat_instances_steps(flat, 2, &count);
    EXPECT(count == 3 && steps[0] == 1 && steps[1] == 1 && steps[2] == 0);
    EXPECT(claray_flat_instances_steps(flat, 3, &count) == NULL && count == 0);
    EXPECT(claray_bvh_build(device, &mesh, NULL, &bvh) == CLARAY_OK);
    const claray_bvh* const bvhs[1] = {bvh};
    EXPECT(claray_instances_build(bvhs, 1, members, 3, &placed) == CLARAY_OK);
    claray_flat_instances_release(flat);
    EXPECT(claray_query_instances_create(placed, CLARAY_QUERY_CLOSEST, NULL, NULL, &closest) == CLARAY_OK);
    const claray_ray ray = {{121.5f, 0.5f, 4}, 0, {0, 0, -1}, 9};
    claray_instance_hit hit;
    EXPECT(claray_query_run(closest, &ray, 1, &hit) == CLARAY_OK && hit.instance == 1 && hit.t == 3);
    pair[1].bottom = 2, flat = NULL;
    EXPECT_ERROR(claray_flat_instances_create(roots, 2, groups, 2, 1, &flat), CLARAY_ERROR_USAGE,
                 "group 1 contains itself");
    EXPECT_ERROR(claray_flat_instances_create(roots, 2, groups, 1, 1, &flat), CLARAY_ERROR_USAGE,
                 "bottom level 2 of 1");
    EXPECT_ERROR(claray_flat_instances_create(roots, 2, NULL, 2, 1, &flat), CLARAY_ERROR_USAGE, "groups is NULL");
    EXPECT_ERROR(claray_flat_instances_create(NULL, 2, NULL, 0, 1, &flat), CLARAY_ERROR_USAGE, "roots is NULL");
    EXPECT_ERROR(claray_flat_instances_create(roots, 1, NULL, 0, 1, NULL), CLARAY_ERROR_USAGE, "flat is NULL");
    EXPECT(flat == NULL && claray_flat_instances_count(NULL) == 0 && claray_flat_instances_members(NULL) == NULL);
    claray_instances_release(placed), claray_query_release(closest), claray_bvh_release(bvh);
    claray_flat_instances_release(NULL);
}

static void test_primitives(claray_device* device) {
    const char* const dots =
        "static inline PrimitiveBox bounds_of(global const float* data, uint i) {\n"
        "    const float3 c = vload3(i, data);\n"
        "    const PrimitiveBox box = {c - 1.0f, c + 1.0f};\n"
        "    return box;\n"
        "}\n"
        "static inline bool intersect(global const float* data, uint i, float3 o, float3 d, float tmin, Hit* hit) {\n"
        "    return take_hit((data[3 * i + 2] - o.z) / d.z, tmin, hit);\n"
        "}\n";
    const float spheres[8] = {0, 0, 0, 1, 5, 0, 0, 2}, own[3] = {5, 0, 0.5f};
    const float line[16] = {0, 0, 0, 0.5f, 2, 0, 0, 0.5f, 4, 0, 0, 0.5f, 6, 0, 0, 0.5f};
    const uint32_t first = 0;
    const claray_ray rays[2] = {{{5, 0, 9}, 0, {0, 0, -1}, 20}, {{5, 7, 9}, 0, {0, 0, -1}, 20}};
    claray_primitive_kind kind = {sizeof kind, "spheres", NULL, 0, 0};
    claray_primitives *balls = NULL, *dot = NULL, *hair = NULL, *none = NULL;
    claray_hit hits[2];
    uint8_t occluded[2];
    EXPECT(claray_primitives_build(device, &kind, spheres, 2, &balls) == CLARAY_OK);
    EXPECT(claray_primitives_closest_hit(balls, rays, 2, hits) == CLARAY_OK);
    EXPECT(hits[0].primitive == 1 && hits[0].t == 7 && hits[1].primitive == CLARAY_MISS);
    EXPECT(claray_primitives_any_hit(balls, rays, 2, occluded) == CLARAY_OK && occluded[0] == 1 && occluded[1] == 0);
    EXPECT(claray_curves_build(device, line, 4, &first, 1, 1, 0, &hair) == CLARAY_OK);
    EXPECT(claray_primitives_closest_hit(hair, rays, 2, hits) == CLARAY_OK);
    EXPECT(hits[0].primitive == 0 && hits[0].t == 8.5f && hits[1].primitive == CLARAY_MISS);
    kind.name = "dots", kind.source = dots, kind.floats = 3;
    EXPECT(claray_primitives_build(device, &kind, own, 1, &dot) == CLARAY_OK);
    EXPECT(claray_primitives_closest_hit(dot, rays, 2, hits) == CLARAY_OK && hits[0].t == 8.5f);
    kind.floats = 0;
    EXPECT_ERROR(claray_primitives_build(device, &kind, own, 1, &none), CLARAY_ERROR_USAGE, "kind.floats is 0");
    kind.source = NULL;
    EXPECT_ERROR(claray_primitives_build(device, &kind, own, 1, &none), CLARAY_ERROR_USAGE, "'dots' without a source");
    kind.name = NULL;
    EXPECT_ERROR(claray_primitives_build(device, &kind, own, 1, &none), CLARAY_ERROR_USAGE, "kind.name is NULL");
    EXPECT_ERROR(claray_primitives_build(device, NULL, own, 1, &none), CLARAY_ERROR_USAGE, "kind is NULL");
    kind.name = "spheres";
    EXPECT_ERROR(claray_primitives_build(device, &kind, NULL, 1, &none), CLARAY_ERROR_USAGE, "data is NULL");
    EXPECT_ERROR(claray_primitives_build(device, &kind, spheres, 2, NULL), CLARAY_ERROR_USAGE, "primitives is NULL");
    EXPECT_ERROR(claray_curves_build(device, line, 3, &first, 1, 0, 0, &none), CLARAY_ERROR_INPUT, "there are 3");
    EXPECT_ERROR(claray_primitives_closest_hit(balls, rays, 2, NULL), CLARAY_ERROR_USAGE, "hits is NULL");
    EXPECT_ERROR(claray_primitives_any_hit(NULL, rays, 2, occluded), CLARAY_ERROR_USAGE, "primitives is NULL");
    EXPECT(none == NULL);
    claray_primitives_release(balls), claray_primitives_release(hair), claray_primitives_release(dot);
    claray_primitives_release(NULL);
}

/* Nothing is made where there is no place for it: the leak checker sees what would be. */
static void test_no_place(claray_device* device) {
    claray_mesh mesh = square_mesh();
    claray_bvh* bvh = NULL;
    claray_scene* scene = NULL;
    const claray_instance one = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 1};
    EXPECT(claray_bvh_build(device, &mesh, NULL, &bvh) == CLARAY_OK);
    EXPECT(claray_scene_load("cornell", &scene) == CLARAY_OK);
    const claray_bvh* const bvhs[1] = {bvh};
    EXPECT_ERROR(claray_device_open("cpu", NULL), CLARAY_ERROR_USAGE, "device is NULL");
    EXPECT_ERROR(claray_device_adopt_create(NULL, claray_device_queue(device), &device), CLARAY_ERROR_USAGE, "NULL");
    EXPECT_ERROR(claray_device_adopt_create(claray_device_context(device), claray_device_queue(device), NULL),
                 CLARAY_ERROR_USAGE, "device is NULL");
    EXPECT_ERROR(claray_device_new_queue_create(device, NULL), CLARAY_ERROR_USAGE, "with_queue is NULL");
    EXPECT_ERROR(claray_bvh_build(device, &mesh, NULL, NULL), CLARAY_ERROR_USAGE, "bvh is NULL");
    EXPECT_ERROR(claray_bvh_scene_build(device, scene, NULL, NULL), CLARAY_ERROR_USAGE, "bvh is NULL");
    EXPECT_ERROR(claray_bvh_load(device, "tree.cbvh", NULL), CLARAY_ERROR_USAGE, "bvh is NULL");
    EXPECT_ERROR(claray_query_create(bvh, CLARAY_QUERY_ANY, NULL, NULL, NULL), CLARAY_ERROR_USAGE, "query is NULL");
    EXPECT_ERROR(claray_instances_build(bvhs, 1, &one, 1, NULL), CLARAY_ERROR_USAGE, "placed is NULL");
    EXPECT_ERROR(claray_scene_load("cornell", NULL), CLARAY_ERROR_USAGE, "scene is NULL");
    EXPECT_ERROR(claray_renderer_create(device, scene, NULL, NULL), CLARAY_ERROR_USAGE, "renderer is NULL");
    claray_scene_release(scene);
    claray_bvh_release(bvh);
}

static void test_files(claray_device* device) {
    claray_bvh *bvh = corner_of(device), *loaded = NULL;
    const claray_ray ray = {{0.25f, 0.25f, -1}, 0, {0, 0, 1}, INFINITY};
    claray_hit hit = {0};
    EXPECT(claray_bvh_save(bvh, "capi_test.cbvh") == CLARAY_OK);
    EXPECT(claray_bvh_load(device, "capi_test.cbvh", &loaded) == CLARAY_OK);
    EXPECT(claray_closest_hit(loaded, &ray, 1, &hit) == CLARAY_OK && hit.t == 1);
    EXPECT_ERROR(claray_bvh_save(bvh, "no/such/folder/tree.cbvh"), CLARAY_ERROR_INPUT, "no/such/folder");
    EXPECT_ERROR(claray_bvh_save(bvh, NULL), CLARAY_ERROR_USAGE, "path is NULL");
    EXPECT(remove("capi_test.cbvh") == 0);
    EXPECT_ERROR(claray_bvh_load(device, "capi_test.cbvh", &loaded), CLARAY_ERROR_INPUT, "capi_test.cbvh");
    claray_bvh_release(bvh), claray_bvh_release(loaded);
}

static void test_wrong_choices(claray_device* device) {
    claray_mesh mesh = square_mesh();
    claray_bvh_config config = {0};
    claray_query_options options = {0};
    claray_bvh *bvh = NULL, *none = NULL;
    claray_query* query = NULL;
    const uint32_t geometries[2] = {0, 3}, masks[2] = {1, 1};
    const claray_ray ray = {{0, 0, 1}, 0, {0, 0, -1}, 9};
    EXPECT(claray_bvh_build(device, &mesh, NULL, &bvh) == CLARAY_OK);
    config.struct_size = sizeof config, config.builder = (claray_builder)9;
    EXPECT_ERROR(claray_bvh_build(device, &mesh, &config, &none), CLARAY_ERROR_USAGE, "config.builder is 9");
    mesh.triangle_count = 0;
    EXPECT_ERROR(claray_bvh_build(device, &mesh, NULL, &none), CLARAY_ERROR_USAGE, "triangle_count is 0");
    mesh = square_mesh(), mesh.geometries = geometries, mesh.masks = masks, mesh.mask_count = 2;
    EXPECT_ERROR(claray_bvh_build(device, &mesh, NULL, &none), CLARAY_ERROR_USAGE, "geometry 3");
    EXPECT_ERROR(claray_query_create(bvh, (claray_query_kind)7, NULL, NULL, &query), CLARAY_ERROR_USAGE, "kind is 7");
    options.struct_size = sizeof options, options.coherence = (claray_coherence)5;
    EXPECT_ERROR(claray_query_create(bvh, CLARAY_QUERY_ANY, &options, NULL, &query), CLARAY_ERROR_USAGE,
                 "coherence is 5");
    options.struct_size = 5000;
    EXPECT_ERROR(claray_query_create(bvh, CLARAY_QUERY_ANY, &options, NULL, &query), CLARAY_ERROR_USAGE,
                 "options.struct_size is 5000");
    EXPECT_ERROR(claray_closest_hit(bvh, &ray, 1, NULL), CLARAY_ERROR_USAGE, "results is NULL");
    EXPECT_ERROR(claray_any_hit(bvh, NULL, 1, NULL), CLARAY_ERROR_USAGE, "rays is NULL");
    EXPECT_ERROR(claray_query_run(NULL, &ray, 1, NULL), CLARAY_ERROR_USAGE, "query is NULL");
    EXPECT(none == NULL && query == NULL);
    EXPECT(claray_bvh_is_replaced(NULL) == 0);
    EXPECT(claray_bvh_triangle_count(NULL) == 0 && claray_scene_triangle_count(NULL) == 0);
    claray_bvh_release(bvh);
}

static void test_errors(claray_device* device) {
    claray_mesh mesh = square_mesh();
    claray_bvh* bvh = NULL;
    claray_scene* scene = NULL;
    const uint32_t wrong[] = {0, 1, 7};
    EXPECT_ERROR(claray_bvh_build(NULL, &mesh, NULL, &bvh), CLARAY_ERROR_USAGE, "device is NULL");
    EXPECT_ERROR(claray_bvh_build(device, NULL, NULL, &bvh), CLARAY_ERROR_USAGE, "mesh is NULL");
    mesh.struct_size = 0;
    EXPECT_ERROR(claray_bvh_build(device, &mesh, NULL, &bvh), CLARAY_ERROR_USAGE, "mesh.struct_size is 0");
    mesh = square_mesh(), mesh.triangles = wrong, mesh.triangle_count = 1;
    EXPECT_ERROR(claray_bvh_build(device, &mesh, NULL, &bvh), CLARAY_ERROR_USAGE, "vertex 7 of 4");
    mesh = square_mesh(), mesh.vertices = NULL;
    EXPECT_ERROR(claray_bvh_build(device, &mesh, NULL, &bvh), CLARAY_ERROR_USAGE, "mesh.vertices is NULL");
    EXPECT_ERROR(claray_scene_load("nowhere.ply", &scene), CLARAY_ERROR_INPUT, "nowhere.ply");
    EXPECT_ERROR(claray_device_open("no such device", &device), CLARAY_ERROR_USAGE, "no such device");
    EXPECT(bvh == NULL && scene == NULL);

    /* A struct of a later version: larger, and harmless as long as the new members are 0. */
    struct {
        claray_mesh mesh;
        size_t later;
    } newer = {{0}, 0};
    newer.mesh = square_mesh(), newer.mesh.struct_size = sizeof newer;
    EXPECT(claray_bvh_build(device, &newer.mesh, NULL, &bvh) == CLARAY_OK);
    claray_bvh_release(bvh);
    newer.later = 1, bvh = NULL;
    EXPECT_ERROR(claray_bvh_build(device, &newer.mesh, NULL, &bvh), CLARAY_ERROR_USAGE, "does not know");
}

static int stop(const claray_progress* progress, void* user) {
    *(uint32_t*)user += progress->spp > 0 ? 1 : 100;
    return 0;
}

/* A render of more samples than there is time for ends with the first call. */
static void test_stop(claray_device* device, const claray_scene* scene) {
    claray_renderer* renderer = NULL;
    claray_render_config config = {0};
    uint32_t calls = 0;
    config.struct_size = sizeof config;
    config.width = 24, config.height = 16, config.spp = 1 << 24, config.seconds = 3;
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, stop, &calls, NULL) == CLARAY_OK && calls == 1);
    claray_renderer_release(renderer);
}

static void test_render(claray_device* device) {
    claray_scene* scene = NULL;
    claray_bvh* bvh = NULL;
    claray_renderer* renderer = NULL;
    claray_render_config config = {0};
    claray_progress reached = {0};
    float image[3 * 24 * 16], mean = 0;
    config.struct_size = sizeof config;
    config.width = 24, config.height = 16, config.spp = 4;
    reached.struct_size = sizeof reached;
    EXPECT(claray_scene_load("cornell", &scene) == CLARAY_OK);
    EXPECT(claray_scene_triangle_count(scene) > 20);
    EXPECT(claray_bvh_scene_build(device, scene, NULL, &bvh) == CLARAY_OK);
    EXPECT(claray_bvh_triangle_count(bvh) == claray_scene_triangle_count(scene));
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_OK);
    test_stop(device, scene);
    claray_scene_release(scene);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, &reached) == CLARAY_OK && reached.spp == 4);
    EXPECT(claray_renderer_image(renderer, image, 3 * 24 * 16) == CLARAY_OK);
    for (size_t i = 0; i < 3 * 24 * 16; ++i) mean += image[i] / (3 * 24 * 16);
    EXPECT(mean > 0.02f && mean < 1.f);
    EXPECT_ERROR(claray_renderer_image(renderer, image, 5), CLARAY_ERROR_USAGE, "count is 5");
    claray_renderer_release(renderer);
    claray_bvh_release(bvh);
}

/* A black ball and a black line before the camera hide what is behind them. */
static void test_scene_primitives(claray_device* device) {
    const float ball[4] = {0.278f, 0.273f, -0.3f, 0.05f}, black[6] = {0};
    const float line[16] = {0, 0.4f, 0, 0.04f, 0.2f, 0.4f, 0, 0.04f, 0.4f, 0.4f, 0, 0.04f, 0.6f, 0.4f, 0, 0.04f};
    const uint32_t first = 0, unknown = 99;
    claray_primitive_set balls = {0}, lines = {0};
    claray_render_config config = {0};
    claray_scene* scene = NULL;
    claray_renderer* renderer = NULL;
    float image[3 * 25 * 25];
    config.struct_size = sizeof config;
    config.width = 25, config.height = 25, config.spp = 4;
    balls.struct_size = lines.struct_size = sizeof balls;
    balls.kind = "spheres", balls.points = ball, balls.point_count = 1, balls.colors = black;
    lines.kind = "bezier curves", lines.points = line, lines.point_count = 4, lines.segments = &first;
    lines.segment_count = 1, lines.colors = black;
    EXPECT(claray_scene_load("cornell", &scene) == CLARAY_OK && claray_scene_primitive_count(scene) == 0);
    EXPECT(claray_scene_add_primitives(scene, &balls) == CLARAY_OK);
    EXPECT(claray_scene_add_primitives(scene, &lines) == CLARAY_OK && claray_scene_primitive_count(scene) == 2);
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, NULL) == CLARAY_OK);
    EXPECT(claray_renderer_image(renderer, image, 3 * 25 * 25) == CLARAY_OK);
    EXPECT(image[3 * (12 * 25 + 12)] == 0 && image[3 * (18 * 25 + 12)] > 0.01f);
    float least = 1;
    for (int y = 4; y < 10; ++y)
        if (image[3 * (y * 25 + 4)] < least) least = image[3 * (y * 25 + 4)];
    EXPECT(least < 0.01f);
    balls.materials = &unknown;
    EXPECT_ERROR(claray_scene_add_primitives(scene, &balls), CLARAY_ERROR_INPUT, "material 99");
    balls.kind = "cubes";
    EXPECT_ERROR(claray_scene_add_primitives(scene, &balls), CLARAY_ERROR_USAGE, "set.kind is 'cubes'");
    balls.kind = "spheres", balls.points = NULL;
    EXPECT_ERROR(claray_scene_add_primitives(scene, &balls), CLARAY_ERROR_USAGE, "set.points is NULL");
    EXPECT_ERROR(claray_scene_add_primitives(NULL, &balls), CLARAY_ERROR_USAGE, "scene is NULL");
    EXPECT(claray_scene_primitive_count(scene) == 2 && claray_scene_primitive_count(NULL) == 0);
    claray_renderer_release(renderer), claray_scene_release(scene);
}

/* Commands that take some milliseconds. */
static void test_finish(claray_device* device) {
    const size_t bytes = (size_t)1 << 27;
    const cl_uint zero = 0;
    cl_event last = NULL;
    cl_int state = CL_QUEUED;
    cl_mem memory = clCreateBuffer((cl_context)claray_device_context(device), CL_MEM_READ_WRITE, bytes, NULL, NULL);
    for (int i = 0; i < 3; ++i) {
        if (last) clReleaseEvent(last);
        EXPECT(clEnqueueFillBuffer((cl_command_queue)claray_device_queue(device), memory, &zero, sizeof zero, 0, bytes,
                                   0, NULL, &last) == CL_SUCCESS);
    }
    EXPECT(claray_device_finish(device) == CLARAY_OK);
    EXPECT(clGetEventInfo(last, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof state, &state, NULL) == CL_SUCCESS);
    EXPECT(state == CL_COMPLETE);
    clReleaseEvent(last), clReleaseMemObject(memory);
}

static void test_basics(claray_device* device) {
    test_finish(device);
    test_queries(device);
    test_closed(device);
    test_builders(device);
    test_refit(device);
    test_buffers(device);
    test_points(device);
    test_lists(device);
    test_instances(device);
    test_flat_instances(device);
    test_primitives(device);
    test_no_place(device);
    test_files(device);
    test_wrong_choices(device);
    test_errors(device);
    test_render(device);
    test_scene_primitives(device);
}

/* Arguments: names of groups of tests; none: all. */
int main(int argc, char** argv) {
    static const struct {
        const char* name;
        void (*run)(claray_device* device);
    } groups[] = {{"basics", test_basics},   {"devices", test_devices}, {"queries", test_more_queries},
                  {"scenes", test_scenes},   {"renders", test_renders}, {"results", test_results},
                  {"targets", test_targets}, {"sensors", test_sensors}, {"bsdf", test_bsdf}};
    claray_device* device = NULL;
    EXPECT(strcmp(claray_last_error(), "") == 0);
    if (claray_device_open(getenv("CLARAY_DEVICE") ? NULL : "cpu", &device) != CLARAY_OK) {
        printf("%s\n", claray_last_error());
        return 1;
    }
    EXPECT(strlen(claray_device_name(device)) > 0 && strchr(claray_version(), '.') != NULL);
    for (size_t i = 0; i < sizeof groups / sizeof *groups; ++i) {
        int wanted = argc < 2;
        for (int k = 1; k < argc; ++k) wanted |= strcmp(argv[k], groups[i].name) == 0;
        if (wanted) groups[i].run(device);
    }
    EXPECT(claray_device_finish(device) == CLARAY_OK);
    claray_device_release(device);
    claray_device_release(NULL), claray_bvh_release(NULL), claray_query_release(NULL);
    printf("%d failures\n", failures);
    return failures == 0 ? 0 : 1;
}
