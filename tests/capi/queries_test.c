/* claray.h: queries with options, lists, buffers of the device, moving instances and primitives. */
#include "capi_test.h"

static const claray_ray downward = {{0.25f, 0.25f, 2}, 0, {0, 0, -1}, 9};

static void test_options(claray_device* device) {
    static const char odd[] =
        "static inline bool accept_hit(global const float* data, float3 origin, float3 direction, const Hit* hit) {\n"
        "    return hit->primitive == (uint)data[0];\n"
        "}\n";
    claray_bvh* bvh = corner_of(device);
    const float wanted = 0;
    claray_query* query = NULL;
    claray_hit hits[2];
    claray_visits visits[2] = {{0, 0}, {0, 0}};
    const claray_ray rays[2] = {downward, downward};
    STRUCT(claray_query_options, options);
    STRUCT(claray_hit_filter, filter);
    filter.source = odd, filter.data = &wanted, filter.data_count = 1, filter.name = "odd";
    options.filter = &filter;
    EXPECT(claray_query_create(bvh, CLARAY_QUERY_CLOSEST, &options, NULL, &query) == CLARAY_OK);
    EXPECT(claray_query_run(query, rays, 1, hits) == CLARAY_OK && hits[0].primitive == 0 && hits[0].t == 2);
    claray_query_release(query);
    uint32_t counts[2] = {9, 9};
    EXPECT(claray_count_hits_with(bvh, rays, 2, &options, counts) == CLARAY_OK && counts[0] == 1 && counts[1] == 1);
    EXPECT(claray_nearest_hits_with(bvh, rays, 2, 1, &options, hits, counts) == CLARAY_OK && counts[1] == 1);
    EXPECT(hits[1].primitive == 0);
    filter.source = NULL, filter.first_geometry = 1, filter.end_geometry = 2;
    EXPECT(claray_count_hits_with(bvh, rays, 2, &options, counts) == CLARAY_OK && counts[0] == 0);
    filter.end_geometry = 1;
    EXPECT_ERROR(claray_count_hits_with(bvh, rays, 2, &options, counts), CLARAY_ERROR_USAGE, "filter.source is NULL");
    options.filter = NULL;

    const uint32_t masks[2] = {0, 1};
    options.ray_masks = masks, options.ray_count = 2;
    EXPECT(claray_query_create(bvh, CLARAY_QUERY_CLOSEST, &options, NULL, &query) == CLARAY_OK);
    EXPECT(claray_query_run(query, rays, 2, hits) == CLARAY_OK);
    EXPECT(hits[0].primitive == CLARAY_MISS && hits[1].primitive == 3);
    claray_query_release(query);
    options.ray_count = 1;
    EXPECT(claray_query_create(bvh, CLARAY_QUERY_CLOSEST, &options, NULL, &query) == CLARAY_OK);
    EXPECT_ERROR(claray_query_run(query, rays, 2, hits), CLARAY_ERROR_USAGE, "ray masks");
    claray_query_release(query);
    options.ray_count = 0;
    EXPECT_ERROR(claray_query_create(bvh, CLARAY_QUERY_CLOSEST, &options, NULL, &query), CLARAY_ERROR_USAGE,
                 "options.ray_count is 0");
    options.ray_masks = NULL, options.visits = visits, options.ray_count = 2;
    EXPECT(claray_query_create(bvh, CLARAY_QUERY_CLOSEST, &options, NULL, &query) == CLARAY_OK);
    EXPECT(claray_query_run(query, rays, 2, hits) == CLARAY_OK && hits[0].primitive == 3);
    EXPECT(visits[0].triangles > 0 && visits[1].triangles == visits[0].triangles);
    claray_query_release(query);
    options.visits = NULL, options.brute_force = 1;
    EXPECT(claray_query_create(bvh, CLARAY_QUERY_CLOSEST, &options, NULL, &query) == CLARAY_OK);
    EXPECT(claray_query_run(query, rays, 2, hits) == CLARAY_OK && hits[0].primitive == 3 && hits[0].t == 1.5f);
    claray_query_release(query), claray_bvh_release(bvh);
}

/* The number of rays is on the device. */
static void test_count_buffer(claray_device* device) {
    claray_bvh* bvh = corner_of(device);
    const claray_ray rays[2] = {downward, downward};
    claray_hit hits[2];
    uint32_t one = 1;
    claray_query* query = NULL;
    cl_context context = (cl_context)claray_device_context(device);
    cl_mem ray_memory = clCreateBuffer(context, CL_MEM_COPY_HOST_PTR, sizeof rays, (void*)rays, NULL);
    cl_mem count_memory = clCreateBuffer(context, CL_MEM_COPY_HOST_PTR, sizeof one, &one, NULL);
    memset(hits, 0x55, sizeof hits);
    cl_mem hit_memory = clCreateBuffer(context, CL_MEM_COPY_HOST_PTR, sizeof hits, hits, NULL);
    STRUCT(claray_query_options, options);
    options.coherence = CLARAY_COHERENCE_COHERENT, options.count_buffer = count_memory;
    EXPECT(claray_query_create(bvh, CLARAY_QUERY_CLOSEST, &options, NULL, &query) == CLARAY_OK);
    EXPECT(claray_query_enqueue(query, ray_memory, hit_memory, 2, NULL, 0, NULL) == CLARAY_OK);
    EXPECT(clEnqueueReadBuffer((cl_command_queue)claray_device_queue(device), hit_memory, CL_TRUE, 0, sizeof hits, hits,
                               0, NULL, NULL) == CL_SUCCESS);
    EXPECT(hits[0].primitive == 3 && hits[1].primitive == 0x55555555u);
    clReleaseMemObject(ray_memory), clReleaseMemObject(hit_memory), clReleaseMemObject(count_memory);
    claray_query_release(query), claray_bvh_release(bvh);
}

static void test_ragged_lists(claray_device* device) {
    claray_bvh* bvh = corner_of(device);
    claray_lists* lists = NULL;
    claray_ray rays[2] = {downward, downward};
    rays[0].origin[0] = 7;
    EXPECT(claray_all_hits_create(bvh, rays, 2, NULL, &lists) == CLARAY_OK && claray_lists_count(lists) == 2);
    const uint32_t* offsets = claray_lists_offsets(lists);
    EXPECT(offsets[0] == 0 && offsets[1] == 0 && offsets[2] == 2);
    EXPECT(claray_lists_hits(lists)[0].t == 1.5f && claray_lists_hits(lists)[1].t == 2);
    EXPECT(claray_lists_triangles(lists) == NULL);
    claray_lists_release(lists);
    const float boxes[12] = {0.1f, 0.1f, -1, 0.2f, 0.2f, 0.01f, 5, 5, 5, 6, 6, 6};
    const float spheres[8] = {0, 0.25f, 0.25f, 0.01f, 9, 9, 9, 1};
    uint32_t counts[2] = {9, 9};
    EXPECT(claray_box_overlaps_create(bvh, boxes, 2, &lists) == CLARAY_OK && claray_lists_count(lists) == 2);
    offsets = claray_lists_offsets(lists);
    EXPECT(offsets[1] == 1 && offsets[2] == 1 && claray_lists_triangles(lists)[0] == 0);
    EXPECT(claray_lists_hits(lists) == NULL);
    claray_lists_release(lists);
    EXPECT(claray_sphere_overlaps_create(bvh, spheres, 2, &lists) == CLARAY_OK);
    EXPECT(claray_lists_offsets(lists)[2] == 1 && claray_lists_triangles(lists)[0] == 2);
    claray_lists_release(lists);
    EXPECT(claray_count_box_overlaps(bvh, boxes, 2, counts) == CLARAY_OK && counts[0] == 1 && counts[1] == 0);
    counts[0] = counts[1] = 9;
    EXPECT(claray_count_sphere_overlaps(bvh, spheres, 2, counts) == CLARAY_OK && counts[0] == 1 && counts[1] == 0);
    lists = NULL;
    EXPECT_ERROR(claray_box_overlaps_create(bvh, NULL, 1, &lists), CLARAY_ERROR_USAGE, "boxes is NULL");
    EXPECT_ERROR(claray_count_sphere_overlaps(bvh, spheres, 2, NULL), CLARAY_ERROR_USAGE, "counts is NULL");
    EXPECT_ERROR(claray_all_hits_create(bvh, NULL, 2, NULL, &lists), CLARAY_ERROR_USAGE, "rays is NULL");
    EXPECT(lists == NULL && claray_lists_count(NULL) == 0 && claray_lists_offsets(NULL) == NULL);
    claray_bvh_release(bvh);
}

static void test_point_options(claray_device* device) {
    claray_bvh* bvh = corner_of(device);
    const float points[6] = {0.125f, 0.25f, 0.25f, 3, 0, 0};
    const uint32_t masks[2] = {0, 1};
    claray_visits visits[2] = {{0, 0}, {0, 0}};
    claray_nearest nearest[2];
    uint8_t inside[2];
    float distances[2];
    STRUCT(claray_point_options, options);
    options.masks = masks, options.visits = visits;
    EXPECT(claray_nearest_point_with(bvh, points, 2, &options, nearest) == CLARAY_OK);
    EXPECT(nearest[0].primitive == CLARAY_MISS && nearest[1].distance == 2 && visits[1].triangles > 0);
    options.masks = NULL, options.reach = 1, options.vote = 1, options.unsorted = 1;
    EXPECT(claray_nearest_point_with(bvh, points, 2, &options, nearest) == CLARAY_OK);
    EXPECT(nearest[0].primitive == 2 && nearest[1].primitive == CLARAY_MISS);
    options.visits = NULL;
    EXPECT(claray_inside_with(bvh, points, 2, &options, inside) == CLARAY_OK && inside[0] == 1 && inside[1] == 0);
    EXPECT(claray_signed_distance_with(bvh, points, 2, &options, distances) == CLARAY_OK);
    EXPECT(distances[0] == -0.125f && distances[1] == 1);
    options.reach = -1;
    EXPECT_ERROR(claray_inside_with(bvh, points, 2, &options, inside), CLARAY_ERROR_USAGE, "options.reach is -1");
    EXPECT_ERROR(claray_inside_with(bvh, points, 2, NULL, NULL), CLARAY_ERROR_USAGE, "inside is NULL");
    claray_bvh_release(bvh);
}

/* Triangles in buffers, which the program moves. */
static void test_triangle_buffers(claray_device* device) {
    float vertices[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t triangle[3] = {0, 1, 2};
    claray_bvh* bvh = NULL;
    claray_hit hit;
    uint64_t bytes = 0, largest = 0;
    double growth = 0;
    cl_context context = (cl_context)claray_device_context(device);
    STRUCT(claray_triangle_buffers, buffers);
    STRUCT(claray_triangle_buffers, of_bvh);
    cl_mem vertex_memory = clCreateBuffer(context, CL_MEM_COPY_HOST_PTR, sizeof vertices, vertices, NULL);
    cl_mem index_memory = clCreateBuffer(context, CL_MEM_COPY_HOST_PTR, sizeof triangle, (void*)triangle, NULL);
    buffers.vertices = vertex_memory, buffers.vertex_count = 3;
    buffers.triangles = index_memory, buffers.triangle_count = 1;
    EXPECT(claray_bvh_buffers_build(device, &buffers, NULL, &bvh) == CLARAY_OK);
    EXPECT(claray_closest_hit(bvh, &downward, 1, &hit) == CLARAY_OK && hit.t == 2);
    EXPECT(claray_bvh_buffers_get(bvh, &of_bvh) == CLARAY_OK && of_bvh.vertices == vertex_memory);
    EXPECT(of_bvh.vertex_count == 3 && of_bvh.triangle_count == 1 && of_bvh.masks == NULL);
    for (int rebuild = 0; rebuild < 2; ++rebuild) {
        for (int i = 0; i < 3; ++i) vertices[3 * i + 2] = 0.5f + (float)rebuild;
        EXPECT(clEnqueueWriteBuffer((cl_command_queue)claray_device_queue(device), vertex_memory, CL_TRUE, 0,
                                    sizeof vertices, vertices, 0, NULL, NULL) == CL_SUCCESS);
        EXPECT(claray_bvh_update(bvh, rebuild) == CLARAY_OK);
        EXPECT(claray_closest_hit(bvh, &downward, 1, &hit) == CLARAY_OK && hit.t == 1.5f - (float)rebuild);
    }
    EXPECT(claray_bvh_memory_needed(device, 3000, 1000, NULL, &bytes, &largest) == CLARAY_OK);
    EXPECT(bytes > 64000 && largest > 0 && largest <= bytes);
    EXPECT(claray_bvh_cost_growth(bvh, &growth) == CLARAY_OK && growth > 0);
    buffers.triangles = NULL;
    EXPECT_ERROR(claray_bvh_buffers_build(device, &buffers, NULL, &bvh), CLARAY_ERROR_USAGE,
                 "buffers.triangles is NULL");
    buffers.triangles = index_memory, buffers.triangle_count = 2;
    EXPECT(claray_bvh_buffers_build(device, &buffers, NULL, &bvh) == CLARAY_ERROR_USAGE); /* too small */
    clReleaseMemObject(vertex_memory), clReleaseMemObject(index_memory);
    claray_bvh_release(bvh);
}

static void test_structure(claray_device* device) {
    claray_bvh *bvh = corner_of(device), *wide = NULL;
    char hash[33], same[33];
    STRUCT(claray_bvh_statistics, statistics);
    STRUCT(claray_bvh_validation, validation);
    validation.links_broken = 7;
    EXPECT(claray_bvh_statistics_get(bvh, &statistics) == CLARAY_OK);
    EXPECT(statistics.triangles == 4 && statistics.culled == 0 && statistics.bytes > 0 && statistics.sah_cost > 0);
    EXPECT(claray_bvh_validate(bvh, &validation) == CLARAY_OK && validation.links_broken == 0);
    EXPECT(claray_bvh_hash(bvh, hash) == CLARAY_OK && strlen(hash) == 32);
    EXPECT(claray_bvh_save(bvh, "capi_layout.cbvh") == CLARAY_OK);
    EXPECT(claray_bvh_layout_load(device, "capi_layout.cbvh", CLARAY_LAYOUT_WIDE, &wide) == CLARAY_OK);
    EXPECT(claray_bvh_statistics_get(wide, &statistics) == CLARAY_OK && statistics.layout == CLARAY_LAYOUT_WIDE);
    EXPECT(claray_bvh_hash(wide, same) == CLARAY_OK && strcmp(hash, same) == 0);
    claray_bvh_release(wide), wide = NULL;
    EXPECT_ERROR(claray_bvh_layout_load(device, "capi_layout.cbvh", (claray_layout)4, &wide), CLARAY_ERROR_USAGE,
                 "layout is 4");
    remove("capi_layout.cbvh");
    claray_mesh mesh = square_mesh();
    STRUCT(claray_bvh_config, config);
    config.layout = CLARAY_LAYOUT_BINARY, config.morton_bits = 30, config.max_leaf_triangles = 1;
    config.builder = CLARAY_BUILDER_FAST;
    EXPECT(claray_bvh_build(device, &mesh, &config, &wide) == CLARAY_OK);
    EXPECT(claray_bvh_statistics_get(wide, &statistics) == CLARAY_OK && statistics.layout == CLARAY_LAYOUT_BINARY);
    claray_bvh_release(wide), claray_bvh_release(bvh), wide = NULL;
    config.morton_bits = 7;
    EXPECT_ERROR(claray_bvh_build(device, &mesh, &config, &wide), CLARAY_ERROR_USAGE, "30 or 63");
}

/* A structure moves by 2 along x while the shutter is open. */
static void test_moving_instances(claray_device* device) {
    claray_bvh *bvh = corner_of(device), *tree = NULL;
    const claray_bvh* const bvhs[1] = {bvh};
    const float times[2] = {0, 1};
    const claray_ray rays[2] = {downward, downward};
    claray_instance_hit hits[2];
    claray_instances* placed = NULL;
    claray_query* query = NULL;
    void *begin_memory = NULL, *end_memory = NULL;
    char hash[33] = "";
    claray_instance begin = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 1}, end = begin;
    STRUCT(claray_instances_config, config);
    STRUCT(claray_query_options, options);
    STRUCT(claray_instances_statistics, statistics);
    STRUCT(claray_bvh_validation, validation);
    end.transform[3] = 2, config.ends = &end;
    EXPECT(claray_instances_config_build(bvhs, 1, &begin, 1, &config, &placed) == CLARAY_OK);
    EXPECT(claray_instances_count(placed) == 1 && claray_instances_count(NULL) == 0);
    options.ray_times = times, options.ray_count = 2;
    EXPECT(claray_query_instances_create(placed, CLARAY_QUERY_CLOSEST, &options, NULL, &query) == CLARAY_OK);
    EXPECT(claray_query_run(query, rays, 2, hits) == CLARAY_OK && hits[0].instance == 0);
    EXPECT(hits[1].instance == CLARAY_MISS);
    begin.transform[3] = 2, end.transform[3] = 0;
    EXPECT(claray_instances_move_with_ends(placed, &begin, &end, 1, 1) == CLARAY_OK);
    EXPECT(claray_query_run(query, rays, 2, hits) == CLARAY_OK && hits[0].instance == CLARAY_MISS);
    EXPECT(hits[1].instance == 0);
    EXPECT(claray_instances_buffers_get(placed, &begin_memory, &end_memory) == CLARAY_OK);
    EXPECT(begin_memory != NULL && end_memory != NULL && begin_memory != end_memory);
    EXPECT(claray_instances_statistics_get(placed, &statistics) == CLARAY_OK && statistics.instances == 1);
    EXPECT(statistics.top_bytes > 0 && statistics.bottom_bytes > 0);
    validation.leaves_missing = 7;
    EXPECT(claray_instances_validate(placed, &validation) == CLARAY_OK && validation.leaves_missing == 0);
    EXPECT(claray_instances_tree_create(placed, &tree) == CLARAY_OK && claray_bvh_hash(tree, hash) == CLARAY_OK);
    EXPECT(strlen(hash) == 32);
    claray_bvh_release(tree), claray_query_release(query), claray_instances_release(placed), placed = NULL;
    EXPECT(claray_instances_build(bvhs, 1, &begin, 1, &placed) == CLARAY_OK);
    EXPECT_ERROR(claray_instances_move_with_ends(placed, &begin, &end, 1, 0), CLARAY_ERROR_USAGE, "ends");
    config.builder = (claray_builder)8;
    EXPECT_ERROR(claray_instances_config_build(bvhs, 1, &begin, 1, &config, &placed), CLARAY_ERROR_USAGE,
                 "config.builder is 8");
    /* A lower corner in place of the one that was built. */
    claray_mesh mesh = square_mesh();
    claray_bvh* flat = NULL;
    claray_ray ray = downward;
    claray_instance_hit hit;
    ray.origin[0] += 2;
    EXPECT(claray_bvh_build(device, &mesh, NULL, &flat) == CLARAY_OK);
    const claray_bvh* const others[1] = {flat};
    EXPECT(claray_instances_replace(placed, others, 1) == CLARAY_OK);
    EXPECT(claray_instances_update(placed, 1) == CLARAY_OK);
    EXPECT(claray_query_instances_create(placed, CLARAY_QUERY_CLOSEST, NULL, NULL, &query) == CLARAY_OK);
    EXPECT(claray_query_run(query, &ray, 1, &hit) == CLARAY_OK && hit.t == 2); /* the corner: 1.5 */
    EXPECT_ERROR(claray_instances_replace(placed, others, 0), CLARAY_ERROR_USAGE, "");
    /* An instance that the program moves in the buffer. */
    const float rows[12] = {1, 0, 0, 2, 0, 1, 0, 0, 0, 0, 1, 1};
    EXPECT(claray_instances_buffers_get(placed, &begin_memory, NULL) == CLARAY_OK);
    EXPECT(clEnqueueWriteBuffer((cl_command_queue)claray_device_queue(device), (cl_mem)begin_memory, CL_TRUE, 0,
                                sizeof rows, rows, 0, NULL, NULL) == CL_SUCCESS);
    EXPECT(claray_instances_update(placed, 0) == CLARAY_OK);
    EXPECT(claray_query_run(query, &ray, 1, &hit) == CLARAY_OK && hit.t == 1);
    claray_query_release(query), claray_instances_release(placed);
    claray_bvh_release(bvh), claray_bvh_release(flat);
}

static void test_moving_primitives(claray_device* device) {
    float spheres[4] = {0.25f, 0.25f, 0, 0.5f}, data[16] = {0};
    const float line[16] = {0, 0, 0, 0.5f, 2, 0, 0, 0.5f, 4, 0, 0, 0.5f, 6, 0, 0, 0.5f};
    const uint32_t first = 0;
    claray_primitives *balls = NULL, *hair = NULL;
    claray_bvh* tree = NULL;
    claray_hit hit;
    STRUCT(claray_primitive_kind, kind);
    STRUCT(claray_bvh_config, config);
    STRUCT(claray_bvh_statistics, statistics);
    kind.name = "spheres", config.builder = CLARAY_BUILDER_FAST;
    EXPECT(claray_primitives_config_build(device, &kind, &config, spheres, 1, &balls) == CLARAY_OK);
    EXPECT(claray_primitives_count(balls) == 1 && claray_primitives_count(NULL) == 0);
    spheres[2] = 1;
    EXPECT(claray_primitives_move(balls, spheres, 4, 0) == CLARAY_OK);
    EXPECT(claray_primitives_closest_hit(balls, &downward, 1, &hit) == CLARAY_OK && hit.t == 0.5f);
    EXPECT_ERROR(claray_primitives_move(balls, spheres, 3, 0), CLARAY_ERROR_USAGE, "float_count is 3");
    spheres[2] = -1;
    EXPECT(clEnqueueWriteBuffer((cl_command_queue)claray_device_queue(device), (cl_mem)claray_primitives_buffer(balls),
                                CL_TRUE, 0, sizeof spheres, spheres, 0, NULL, NULL) == CL_SUCCESS);
    EXPECT(claray_primitives_move(balls, NULL, 0, 1) == CLARAY_OK);
    EXPECT(claray_primitives_closest_hit(balls, &downward, 1, &hit) == CLARAY_OK && hit.t == 2.5f);
    EXPECT(claray_primitives_tree_create(balls, &tree) == CLARAY_OK);
    EXPECT(claray_bvh_statistics_get(tree, &statistics) == CLARAY_OK && statistics.triangles == 1);
    EXPECT(claray_closest_hit(tree, &downward, 1, &hit) == CLARAY_ERROR_USAGE);
    EXPECT(claray_curve_data(line, 4, &first, 1, 1, data) == CLARAY_OK && data[12] == 6 && data[15] == 0.5f);
    kind.name = "curves";
    EXPECT(claray_primitives_config_build(device, &kind, NULL, data, 1, &hair) == CLARAY_OK);
    const claray_ray ray = {{3, 0, 9}, 0, {0, 0, -1}, 20};
    EXPECT(claray_primitives_closest_hit(hair, &ray, 1, &hit) == CLARAY_OK && hit.t == 8.5f);
    EXPECT(claray_curve_data(line, 3, &first, 1, 1, data) == CLARAY_ERROR_INPUT);
    claray_bvh_release(tree), claray_primitives_release(balls), claray_primitives_release(hair);
}

static void read_buffer(claray_device* device, cl_mem memory, void* to, size_t bytes) {
    EXPECT(clEnqueueReadBuffer((cl_command_queue)claray_device_queue(device), memory, CL_TRUE, 0, bytes, to, 0, NULL,
                               NULL) == CL_SUCCESS);
}

/* What is asked and all answers are on the device. */
static void test_enqueued(claray_device* device) {
    claray_bvh* bvh = corner_of(device);
    claray_primitives* balls = NULL;
    const float points[4] = {0.125f, 0.25f, 0.25f, 0}, sphere[4] = {0.25f, 0.25f, 0, 0.5f};
    claray_nearest nearest = {{0, 0, 0}, 0, 0, 0, 0, 0};
    claray_hit hits[2];
    float distance = 0;
    uint32_t count = 0;
    uint8_t byte = 0;
    cl_context context = (cl_context)claray_device_context(device);
    cl_mem ray = clCreateBuffer(context, CL_MEM_COPY_HOST_PTR, sizeof downward, (void*)&downward, NULL);
    cl_mem point = clCreateBuffer(context, CL_MEM_COPY_HOST_PTR, sizeof points, (void*)points, NULL);
    cl_mem answer = clCreateBuffer(context, CL_MEM_READ_WRITE, 64, NULL, NULL);
    cl_mem counts = clCreateBuffer(context, CL_MEM_READ_WRITE, 4, NULL, NULL);
    STRUCT(claray_query_options, options);
    STRUCT(claray_point_options, point_options);
    STRUCT(claray_primitive_kind, kind);
    options.cull_back_faces = 1;
    EXPECT(claray_count_hits_enqueue(bvh, ray, counts, 1, &options) == CLARAY_OK);
    read_buffer(device, counts, &count, sizeof count);
    EXPECT(count == 1);
    EXPECT(claray_nearest_hits_enqueue(bvh, ray, answer, counts, 1, 2, NULL) == CLARAY_OK);
    read_buffer(device, counts, &count, sizeof count), read_buffer(device, answer, hits, sizeof hits);
    EXPECT(count == 2 && hits[0].t == 1.5f && hits[1].t == 2);
    EXPECT(claray_points_enqueue(bvh, CLARAY_POINT_NEAREST, point, answer, 1, NULL) == CLARAY_OK);
    read_buffer(device, answer, &nearest, sizeof nearest);
    EXPECT(nearest.distance == 0.125f && nearest.primitive == 2);
    EXPECT(claray_points_enqueue(bvh, CLARAY_POINT_INSIDE, point, answer, 1, &point_options) == CLARAY_OK);
    read_buffer(device, answer, &byte, 1);
    EXPECT(byte == 1);
    EXPECT(claray_points_enqueue(bvh, CLARAY_POINT_SIGNED_DISTANCE, point, answer, 1, NULL) == CLARAY_OK);
    read_buffer(device, answer, &distance, sizeof distance);
    EXPECT(distance == -0.125f);
    kind.name = "spheres";
    EXPECT(claray_primitives_build(device, &kind, sphere, 1, &balls) == CLARAY_OK);
    EXPECT(claray_primitives_enqueue(balls, CLARAY_QUERY_CLOSEST, ray, answer, 1) == CLARAY_OK);
    read_buffer(device, answer, hits, sizeof *hits);
    EXPECT(hits[0].t == 1.5f);
    EXPECT_ERROR(claray_primitives_enqueue(balls, (claray_query_kind)2, ray, answer, 1), CLARAY_ERROR_USAGE,
                 "kind is 2");
    EXPECT_ERROR(claray_points_enqueue(bvh, (claray_point_query)3, point, answer, 1, NULL), CLARAY_ERROR_USAGE,
                 "query is 3");
    EXPECT_ERROR(claray_count_hits_enqueue(bvh, NULL, counts, 1, NULL), CLARAY_ERROR_USAGE, "rays is NULL");
    EXPECT(claray_nearest_hits_enqueue(bvh, ray, answer, counts, 1, 9, NULL) == CLARAY_ERROR_USAGE); /* too small */
    options.visits = &count, options.ray_count = 1;
    EXPECT_ERROR(claray_count_hits_enqueue(bvh, ray, counts, 1, &options), CLARAY_ERROR_USAGE, "options.visits");
    clReleaseMemObject(ray), clReleaseMemObject(point), clReleaseMemObject(answer), clReleaseMemObject(counts);
    claray_primitives_release(balls), claray_bvh_release(bvh);
}

void test_more_queries(claray_device* device) {
    test_options(device);
    test_count_buffer(device);
    test_ragged_lists(device);
    test_point_options(device);
    test_triangle_buffers(device);
    test_structure(device);
    test_moving_instances(device);
    test_moving_primitives(device);
    test_enqueued(device);
}
