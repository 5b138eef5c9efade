/* claray.h: devices, kernels that are compiled, and times. */
#include "capi_test.h"

static int holds(const claray_lines* lines, const char* text) {
    for (size_t i = 0; i < claray_lines_count(lines); ++i)
        if (strcmp(claray_lines_at(lines, i), text) == 0) return 1;
    return 0;
}

static void test_names(void) {
    static const struct {
        const char *list, *name;
    } rows[] = {{"material kinds", "principled"}, {"light kinds", "sun"},         {"projections", "panorama"},
                {"primitive kinds", "discs"},     {"builders", "binned"},         {"scenes", "cornell"},
                {"effects", "smooth-normals"},    {"approximations", "tile-sum"}, {"layers", "depth"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; ++i) {
        claray_lines* names = NULL;
        EXPECT(claray_names_create(rows[i].list, &names) == CLARAY_OK);
        EXPECT(claray_lines_count(names) > 2 && holds(names, rows[i].name));
        EXPECT(claray_lines_at(names, claray_lines_count(names)) == NULL);
        claray_lines_release(names);
    }
    claray_lines* none = NULL;
    EXPECT_ERROR(claray_names_create("colours", &none), CLARAY_ERROR_USAGE, "list is 'colours'");
    EXPECT_ERROR(claray_names_create(NULL, &none), CLARAY_ERROR_USAGE, "list is NULL");
    EXPECT(none == NULL && claray_lines_count(NULL) == 0 && claray_lines_at(NULL, 0) == NULL);
}

static void test_list(claray_device* device) {
    claray_device_list* list = NULL;
    STRUCT(claray_device_info, info);
    EXPECT(claray_device_list_create(&list) == CLARAY_OK && claray_device_list_count(list) > 0);
    EXPECT(claray_device_list_get(list, 0, &info) == CLARAY_OK);
    EXPECT(info.index == 0 && strlen(info.name) > 0 && strlen(info.platform) > 0 && info.memory > 1 << 20);
    EXPECT(info.compute_units > 0 && info.max_allocation <= info.memory && strstr(info.version, "OpenCL") != NULL);
    EXPECT_ERROR(claray_device_list_get(list, 999, &info), CLARAY_ERROR_USAGE, "i is 999");
    claray_device_list_release(list);
    EXPECT(claray_device_get(device, &info) == CLARAY_OK && strcmp(info.name, claray_device_name(device)) == 0);
    EXPECT(strstr(info.extensions, "cl_khr_") != NULL && info.type <= CLARAY_DEVICE_OTHER);
    /* An older program has a smaller struct: what is behind it stays. */
    info.struct_size = 3 * sizeof(size_t), info.name = "kept", info.index = 99;
    EXPECT(claray_device_get(device, &info) == CLARAY_OK && strcmp(info.name, "kept") == 0 && info.index != 99);
    info.struct_size = 0;
    EXPECT_ERROR(claray_device_get(device, &info), CLARAY_ERROR_USAGE, "info.struct_size is 0");
    EXPECT_ERROR(claray_device_get(device, NULL), CLARAY_ERROR_USAGE, "info is NULL");
}

static void test_several(claray_device* device) {
    claray_device *several[4] = {NULL}, *part = NULL;
    size_t count = 0;
    EXPECT(claray_device_open_several("0", several, 4, &count) == CLARAY_OK && count == 1 && several[0] != NULL);
    claray_device_release(several[0]);
    EXPECT_ERROR(claray_device_open_several("0", several, 0, &count), CLARAY_ERROR_USAGE, "room is 0");
    STRUCT(claray_device_info, whole);
    STRUCT(claray_device_info, divided);
    EXPECT(claray_device_with_units_create(device, 1, &part) == CLARAY_OK);
    EXPECT(claray_device_get(device, &whole) == CLARAY_OK && claray_device_get(part, &divided) == CLARAY_OK);
    EXPECT(divided.compute_units == 1 || divided.compute_units == whole.compute_units);
    EXPECT_ERROR(claray_device_with_units_create(device, 0, &part), CLARAY_ERROR_USAGE, "units is 0");
    claray_device_release(part);
}

static void test_tuning(claray_device* device) {
    uint32_t before = 0, after = 0;
    claray_lines* warnings = NULL;
    EXPECT(claray_device_tuning(device, "bvh/automatic", "BUILDER", &before) == CLARAY_OK);
    EXPECT(claray_device_set_tuning(device, "bvh/automatic", "BUILDER", before + 1) == CLARAY_OK);
    EXPECT(claray_device_tuning(device, "bvh/automatic", "BUILDER", &after) == CLARAY_OK && after == before + 1);
    EXPECT(claray_device_set_tuning(device, "bvh/automatic", "BUILDER", before) == CLARAY_OK);
    EXPECT(claray_device_tuning(device, "no/kernel", "BUILDER", &after) != CLARAY_OK);
    EXPECT(claray_device_warnings_create(device, &warnings) == CLARAY_OK && warnings != NULL &&
           claray_lines_count(warnings) == 0);
    claray_lines_release(warnings);
    claray_builder builder = CLARAY_BUILDER_AUTOMATIC;
    EXPECT(claray_builder_resolve(device, CLARAY_BUILDER_AUTOMATIC, &builder) == CLARAY_OK);
    EXPECT(builder == CLARAY_BUILDER_HIGH || builder == CLARAY_BUILDER_BALANCED);
    EXPECT(claray_builder_resolve(device, CLARAY_BUILDER_FAST, &builder) == CLARAY_OK &&
           builder == CLARAY_BUILDER_FAST);
}

static void count_compilations(uint32_t done, uint32_t total, const char* text, void* user) {
    *(int*)user += done <= total && strstr(text, "compiling") != NULL ? 1 : 100;
}

/* A kernel that sums up an array, in a name of its own so that no cache has it. */
static cl_kernel compile(claray_device* device, int* calls) {
    static char text[400];
    void* kernel = NULL;
    static const char* const defines[] = {"FACTOR=3"};
    STRUCT(claray_kernel_source, source);
    snprintf(text, sizeof text, "/* %p */ kernel void triple(global uint* x) { x[get_global_id(0)] *= FACTOR; }",
             (void*)calls);
    source.source = text, source.function = "triple", source.defines = defines, source.define_count = 1;
    EXPECT(claray_on_compiling(count_compilations, calls) == CLARAY_OK);
    EXPECT(claray_kernel_compile(device, &source, &kernel) == CLARAY_OK);
    EXPECT(claray_on_compiling(NULL, NULL) == CLARAY_OK);
    void* none = NULL;
    source.function = "quadruple";
    EXPECT_ERROR(claray_kernel_compile(device, &source, &none), CLARAY_ERROR_USAGE, "quadruple");
    source.source = "nonsense", source.define_count = 0;
    EXPECT(claray_kernel_compile(device, &source, &none) == CLARAY_ERROR_DEVICE && none == NULL);
    source.source = NULL;
    EXPECT_ERROR(claray_kernel_compile(device, &source, &none), CLARAY_ERROR_USAGE, "source.source is NULL");
    return (cl_kernel)kernel;
}

/* The program's kernel waits for one queue in another. */
static void test_kernel(claray_device* device) {
    uint32_t values[2] = {5, 7};
    int calls = 0;
    cl_kernel kernel = compile(device, &calls);
    claray_device* other = NULL;
    void* event = NULL;
    const size_t items = 2;
    cl_context context = (cl_context)claray_device_context(device);
    cl_mem memory = clCreateBuffer(context, CL_MEM_COPY_HOST_PTR, sizeof values, values, NULL);
    EXPECT(clSetKernelArg(kernel, 0, sizeof memory, &memory) == CL_SUCCESS);
    EXPECT(clEnqueueNDRangeKernel((cl_command_queue)claray_device_queue(device), kernel, 1, NULL, &items, NULL, 0, NULL,
                                  NULL) == CL_SUCCESS);
    EXPECT(claray_device_event(device, &event) == CLARAY_OK && event != NULL);
    EXPECT(claray_device_new_queue_create(device, &other) == CLARAY_OK);
    const void* const events[] = {event};
    EXPECT(claray_device_wait_for(other, events, 1) == CLARAY_OK);
    EXPECT(clEnqueueReadBuffer((cl_command_queue)claray_device_queue(other), memory, CL_TRUE, 0, sizeof values, values,
                               0, NULL, NULL) == CL_SUCCESS);
    EXPECT(values[0] == 15 && values[1] == 21);
    const void* const nothing[] = {NULL};
    EXPECT_ERROR(claray_device_wait_for(other, nothing, 1), CLARAY_ERROR_USAGE, "events holds NULL");
    EXPECT(calls > 0 && calls < 100);
    STRUCT(claray_compile_statistics, statistics);
    EXPECT(claray_compile_statistics_get(&statistics) == CLARAY_OK && statistics.compiled > 0);
    EXPECT(statistics.milliseconds > 0 && strcmp(statistics.cache_error, "") == 0);
    clReleaseEvent((cl_event)event), clReleaseMemObject(memory), clReleaseKernel(kernel);
    claray_device_release(other);
}

/* A kernel of the program traces a ray in a structure of claray. */
static void test_bound_kernel(claray_device* device) {
    static const char text[] =
        "#include \"trace/closest_hit.clh\"\n"
        "kernel void height(CLARAY_BVH_PARAMETERS, global float* t) {\n"
        "    const Ray ray = {0.25f, 0.25f, 9, 0, 0, 0, -1, 100};\n"
        "    t[0] = claray_closest_hit(CLARAY_BVH, ray).t;\n"
        "}\n";
    claray_bvh* bvh = corner_of(device);
    void* kernel = NULL;
    uint32_t index = 0;
    float height = 0;
    const size_t one = 1;
    STRUCT(claray_kernel_source, source);
    source.source = text, source.function = "height", source.bvh = bvh;
    EXPECT(claray_kernel_compile(device, &source, &kernel) == CLARAY_OK);
    EXPECT(claray_bvh_bind(bvh, kernel, &index) == CLARAY_OK && index > 0);
    cl_context context = (cl_context)claray_device_context(device);
    cl_command_queue queue = (cl_command_queue)claray_device_queue(device);
    cl_mem memory = clCreateBuffer(context, CL_MEM_READ_WRITE, sizeof height, NULL, NULL);
    EXPECT(clSetKernelArg((cl_kernel)kernel, index, sizeof memory, &memory) == CL_SUCCESS);
    EXPECT(clEnqueueNDRangeKernel(queue, (cl_kernel)kernel, 1, NULL, &one, NULL, 0, NULL, NULL) == CL_SUCCESS);
    EXPECT(clEnqueueReadBuffer(queue, memory, CL_TRUE, 0, sizeof height, &height, 0, NULL, NULL) == CL_SUCCESS);
    EXPECT(height == 8.5f);
    EXPECT_ERROR(claray_bvh_bind(bvh, NULL, &index), CLARAY_ERROR_USAGE, "kernel is NULL");

    static const char placed_text[] =
        "#include \"trace/traverse_instances.clh\"\n"
        "kernel void none(CLARAY_INSTANCES_PARAMETERS, global float* t) { t[0] = 0; }\n";
    const claray_instance placement = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 1};
    const claray_bvh* const bvhs[1] = {bvh};
    claray_instances* placed = NULL;
    void* second = NULL;
    uint32_t behind = 1000;
    EXPECT(claray_instances_build(bvhs, 1, &placement, 1, &placed) == CLARAY_OK);
    source.source = placed_text, source.function = "none", source.bvh = NULL, source.instances = placed;
    EXPECT(claray_kernel_compile(device, &source, &second) == CLARAY_OK);
    EXPECT(claray_instances_bind(placed, second, &behind) != CLARAY_OK); /* there are no such arguments */
    behind = 0;
    EXPECT(claray_instances_bind(placed, second, &behind) == CLARAY_OK && behind > index);
    clReleaseMemObject(memory), clReleaseKernel((cl_kernel)kernel), clReleaseKernel((cl_kernel)second);
    claray_instances_release(placed), claray_bvh_release(bvh);
}

static void test_profile(claray_device* device) {
    claray_profile *totals = NULL, *records = NULL;
    STRUCT(claray_profile_row, row);
    EXPECT(claray_profiler_start(device, 1, 1) == CLARAY_OK);
    claray_bvh* bvh = corner_of(device);
    EXPECT(claray_profile_create(device, 0, &totals) == CLARAY_OK && claray_profile_count(totals) > 0);
    EXPECT(claray_profile_create(device, 1, &records) == CLARAY_OK);
    EXPECT(claray_profile_count(records) >= claray_profile_count(totals));
    EXPECT(claray_profile_get(totals, 0, &row) == CLARAY_OK && strlen(row.name) > 0 && row.count > 0);
    EXPECT(row.end >= row.start && row.longest <= row.milliseconds);
    EXPECT(claray_profile_get(records, 0, &row) == CLARAY_OK && row.count == 1 && row.start >= row.queued);
    EXPECT_ERROR(claray_profile_get(records, 1 << 20, &row), CLARAY_ERROR_USAGE, "rows");
    EXPECT(claray_write_trace(device, "capi_trace.json") == CLARAY_OK && remove("capi_trace.json") == 0);
    claray_profile_release(totals), claray_profile_release(records);
    EXPECT(claray_profiler_start(device, 0, 0) == CLARAY_OK);
    claray_bvh_release(corner_of(device));
    EXPECT(claray_profile_create(device, 0, &totals) == CLARAY_OK && claray_profile_count(totals) == 0);
    claray_profile_release(totals), claray_bvh_release(bvh);
    EXPECT(claray_profiler_start(device, 1, 0) == CLARAY_OK);
}

static void test_prepare(claray_device* device) {
    STRUCT(claray_compile_statistics, before);
    STRUCT(claray_compile_statistics, after);
    EXPECT(claray_compile_statistics_get(&before) == CLARAY_OK);
    EXPECT(claray_prepare(device, "mirror,sky", NULL) == CLARAY_OK);
    EXPECT(claray_compile_statistics_get(&after) == CLARAY_OK);
    EXPECT(after.compiled + after.from_cache > before.compiled + before.from_cache);
    EXPECT_ERROR(claray_prepare(device, "lambert,velvet", NULL), CLARAY_ERROR_USAGE, "velvet");
    EXPECT_ERROR(claray_prepare(NULL, NULL, NULL), CLARAY_ERROR_USAGE, "device is NULL");
}

void test_devices(claray_device* device) {
    test_names();
    test_list(device);
    test_several(device);
    test_tuning(device);
    test_kernel(device);
    test_bound_kernel(device);
    test_profile(device);
    test_prepare(device);
}
