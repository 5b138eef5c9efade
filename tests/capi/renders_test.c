/* claray.h: renderers, and the pictures and files that they give. */
#include "capi_test.h"

enum { width = 24, height = 16, pixels = width * height, floats = 3 * pixels };

static claray_renderer* renderer_of(claray_device* device, const claray_scene* scene, uint32_t spp) {
    claray_renderer* renderer = NULL;
    STRUCT(claray_render_config, config);
    config.width = width, config.height = height, config.spp = spp;
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, NULL) == CLARAY_OK);
    return renderer;
}

static float mean_of(const float* image, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; ++i) sum += image[i];
    return (float)(sum / (double)count);
}

static void test_restart(claray_renderer* renderer) {
    float first[floats], other[floats], again[floats];
    STRUCT(claray_progress, reached);
    EXPECT(claray_renderer_image(renderer, first, floats) == CLARAY_OK && mean_of(first, floats) > 0.05f);
    EXPECT(claray_renderer_restart(renderer, 7, 0, 0) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, &reached) == CLARAY_OK && reached.spp == 4);
    EXPECT(reached.spp_target == 4 && reached.culled == 0 && reached.dropped_samples == 0 && reached.noise > 0);
    EXPECT(claray_renderer_image(renderer, other, floats) == CLARAY_OK && memcmp(first, other, sizeof first) != 0);
    EXPECT(claray_renderer_restart(renderer, 0, 2, 0) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, &reached) == CLARAY_OK && reached.spp == 2);
    EXPECT(claray_renderer_restart(renderer, 0, 4, 0) == CLARAY_OK);
    EXPECT(claray_renderer_render_for(renderer, 100, NULL, NULL, &reached) == CLARAY_OK && reached.spp == 4);
    EXPECT(claray_renderer_image(renderer, again, floats) == CLARAY_OK && memcmp(first, again, sizeof first) == 0);
    EXPECT(claray_renderer_render_for(renderer, (double)NAN, NULL, NULL, NULL) == CLARAY_ERROR_USAGE);
}

static float middle_depth(claray_renderer* renderer) {
    float depth[pixels];
    memset(depth, 0, sizeof depth);
    EXPECT(claray_renderer_layer(renderer, "depth", depth, pixels) == CLARAY_OK);
    return depth[height / 2 * width + width / 2];
}

static void test_update(claray_renderer* renderer, claray_scene* scene) {
    STRUCT(claray_camera, camera);
    float before[floats], after[floats];
    EXPECT(fabsf(middle_depth(renderer) - 4) < 0.05f);
    EXPECT(claray_scene_camera_get(scene, 1, &camera) == CLARAY_OK);
    camera.position[2] = 3;
    EXPECT(claray_scene_camera_set(scene, &camera) == CLARAY_OK);
    EXPECT(claray_renderer_image(renderer, before, floats) == CLARAY_OK);
    EXPECT(claray_renderer_update(renderer, scene, CLARAY_CHANGED_CAMERA) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, NULL) == CLARAY_OK);
    EXPECT(fabsf(middle_depth(renderer) - 3) < 0.05f);
    STRUCT(claray_material, lamp);
    EXPECT(claray_scene_material_get(scene, 1, &lamp) == CLARAY_OK);
    lamp.emission[0] = lamp.emission[1] = lamp.emission[2] = 12;
    EXPECT(claray_renderer_image(renderer, before, floats) == CLARAY_OK);
    EXPECT(claray_scene_material_set(scene, 1, &lamp) == CLARAY_OK);
    EXPECT(claray_renderer_update(renderer, scene, CLARAY_CHANGED_MATERIALS) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, NULL) == CLARAY_OK);
    EXPECT(claray_renderer_image(renderer, after, floats) == CLARAY_OK);
    EXPECT(fabsf(mean_of(after, floats) / mean_of(before, floats) - 2) < 0.01f);
    EXPECT_ERROR(claray_renderer_update(renderer, scene, 64), CLARAY_ERROR_USAGE, "changes is 64");
    EXPECT_ERROR(claray_renderer_update(renderer, NULL, 1), CLARAY_ERROR_USAGE, "scene is NULL");
}

static void test_size(claray_renderer* renderer) {
    uint32_t wide = 0, high = 0;
    float image[3 * 8 * 4];
    EXPECT(claray_renderer_size(renderer, &wide, &high) == CLARAY_OK && wide == width && high == height);
    EXPECT(claray_renderer_resize(renderer, 8, 4) == CLARAY_OK);
    EXPECT(claray_renderer_size(renderer, &wide, &high) == CLARAY_OK && wide == 8 && high == 4);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, NULL) == CLARAY_OK);
    EXPECT(claray_renderer_image(renderer, image, 3 * 8 * 4) == CLARAY_OK && mean_of(image, 3 * 8 * 4) > 0.1f);
    EXPECT(claray_renderer_resize(renderer, 0, 4) == CLARAY_ERROR_USAGE);
    EXPECT(claray_renderer_resize(renderer, width, height) == CLARAY_OK);
}

static void test_region_and_alpha(claray_device* device, claray_scene* scene) {
    enum { part_width = 6, part_height = 5, part_pixels = part_width * part_height };
    claray_renderer* renderer = NULL;
    float image[3 * part_pixels], alpha[part_pixels], least = 2, most = -1;
    uint32_t wide = 0, high = 0;
    STRUCT(claray_material, material);
    STRUCT(claray_render_config, config);
    config.width = width, config.height = height, config.spp = 4, config.alpha = 1;
    config.region[0] = 2, config.region[1] = 3, config.region[2] = part_width, config.region[3] = part_height;
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, NULL) == CLARAY_OK);
    EXPECT(claray_renderer_size(renderer, &wide, &high) == CLARAY_OK && wide == part_width && high == part_height);
    EXPECT(claray_renderer_image(renderer, image, 3 * part_pixels) == CLARAY_OK);
    EXPECT(claray_renderer_alpha(renderer, alpha, part_pixels) == CLARAY_OK);
    for (int i = 0; i < part_pixels; ++i) least = fminf(least, alpha[i]), most = fmaxf(most, alpha[i]);
    EXPECT(least >= 0 && most <= 1 && most > 0);
    EXPECT_ERROR(claray_renderer_alpha(renderer, alpha, 3), CLARAY_ERROR_USAGE, "count is 3");
    EXPECT(claray_scene_material_get(scene, 0, &material) == CLARAY_OK && material.role == CLARAY_ROLE_SURFACE);
    material.role = CLARAY_ROLE_HOLDOUT;
    EXPECT(claray_scene_material_set(scene, 0, &material) == CLARAY_OK);
    EXPECT(claray_scene_material_get(scene, 0, &material) == CLARAY_OK && material.role == CLARAY_ROLE_HOLDOUT);
    material.role = CLARAY_ROLE_SURFACE;
    EXPECT(claray_scene_material_set(scene, 0, &material) == CLARAY_OK);
    claray_renderer_release(renderer);
    config.region[2] = width;
    EXPECT_ERROR(claray_renderer_create(device, scene, &config, &renderer), CLARAY_ERROR_USAGE, "not within the image");
}

static void test_kernels_of_renderer(claray_renderer* renderer) {
    int rebuilt = 7;
    double cut_off = -1;
    STRUCT(claray_bvh_config, config);
    STRUCT(claray_render_statistics, statistics);
    STRUCT(claray_bvh_statistics, bvh);
    float image[floats];
    EXPECT(claray_renderer_render(renderer, NULL, NULL, NULL) == CLARAY_OK);
    EXPECT(claray_renderer_settle(renderer) == CLARAY_OK);
    EXPECT(claray_renderer_image(renderer, image, floats) == CLARAY_OK && mean_of(image, floats) == 0); /* no samples */
    EXPECT(claray_renderer_render(renderer, NULL, NULL, NULL) == CLARAY_OK);
    config.builder = CLARAY_BUILDER_BINNED;
    EXPECT(claray_renderer_rebuild(renderer, &config, &rebuilt) == CLARAY_OK && rebuilt == 1);
    EXPECT(claray_renderer_cut_off(renderer, &cut_off) == CLARAY_OK && cut_off >= 0 && cut_off < 0.1);
    EXPECT(claray_renderer_statistics_get(renderer, &bvh, &statistics) == CLARAY_OK && bvh.triangles == 4);
    EXPECT(statistics.camera.rays > 0 && statistics.device_bytes > 0);
    EXPECT(statistics.own_kernels == 1);
    EXPECT(strstr(statistics.effects, "emissive-triangles") != NULL && statistics.parts == 1);
    EXPECT(statistics.first_pixel_seconds > 0 && strlen(statistics.longest_command) > 0);
    EXPECT(strcmp(statistics.checkpoint_error, "") == 0 && statistics.why_unguided != NULL);
    float before[floats], after[floats];
    EXPECT(claray_renderer_image(renderer, before, floats) == CLARAY_OK);
    EXPECT(claray_renderer_load_kernels(renderer) == CLARAY_OK); /* and keeps the samples */
    EXPECT(claray_renderer_image(renderer, after, floats) == CLARAY_OK && memcmp(before, after, sizeof before) == 0);
}

/* Half the samples, a checkpoint, and the rest. */
static void test_checkpoint(claray_device* device, const claray_scene* scene) {
    claray_renderer* renderer = renderer_of(device, scene, 8);
    float whole[floats], resumed[floats];
    STRUCT(claray_render_config, config);
    STRUCT(claray_progress, reached);
    EXPECT(claray_renderer_image(renderer, whole, floats) == CLARAY_OK);
    claray_renderer_release(renderer);
    config.width = width, config.height = height, config.spp = 4, config.checkpoint = "capi.checkpoint";
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, NULL) == CLARAY_OK);
    EXPECT(claray_renderer_restart(renderer, 1, 0, 0) == CLARAY_ERROR_USAGE);
    claray_renderer_release(renderer);
    config.spp = 8, config.checkpoint = NULL, config.resume = "capi.checkpoint";
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, &reached) == CLARAY_OK && reached.spp == 8);
    EXPECT(claray_renderer_image(renderer, resumed, floats) == CLARAY_OK);
    EXPECT(memcmp(whole, resumed, sizeof whole) == 0);
    claray_renderer_release(renderer), renderer = NULL;
    config.seed = 5;
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_ERROR_INPUT);
    EXPECT(remove("capi.checkpoint") == 0 && renderer == NULL);
}

/* Every member of the config reaches the renderer: wrong values are refused by their own errors. */
static void test_config(claray_device* device, const claray_scene* scene) {
    claray_renderer* renderer = NULL;
    STRUCT(claray_render_config, config);
    STRUCT(claray_bvh_config, bvh);
    STRUCT(claray_light_grid_config, grid);
    config.width = 1 << 20;
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_ERROR_USAGE);
    config.width = 8, config.height = 8, config.spp = 1, config.sampler = (claray_sampler)2;
    EXPECT_ERROR(claray_renderer_create(device, scene, &config, &renderer), CLARAY_ERROR_USAGE, "config.sampler is 2");
    config.sampler = CLARAY_SAMPLER_SOBOL, config.effects = "+velvet";
    EXPECT_ERROR(claray_renderer_create(device, scene, &config, &renderer), CLARAY_ERROR_USAGE, "velvet");
    config.effects = NULL, config.approximate = "guessing";
    EXPECT_ERROR(claray_renderer_create(device, scene, &config, &renderer), CLARAY_ERROR_USAGE, "guessing");
    config.approximate = "light-grid", config.light_grid = &grid, grid.side = 1;
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_ERROR_USAGE);
    config.approximate = NULL, config.light_grid = NULL, config.bvh = &bvh, bvh.builder = (claray_builder)9;
    EXPECT_ERROR(claray_renderer_create(device, scene, &config, &renderer), CLARAY_ERROR_USAGE, "builder is 9");
    config.bvh = NULL, config.adaptive = 1, config.approximate = "tile-sum";
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_ERROR_USAGE); /* not both */
    EXPECT(renderer == NULL);
}

/* Two devices of one kind give the image of one, bit for bit. */
static void note(const char* line, void* user) { *(int*)user += (int)strlen(line); }

static void test_group(claray_device* device, const claray_scene* scene) {
    claray_renderer *one = renderer_of(device, scene, 4), *of_group = NULL;
    claray_device* second = NULL;
    claray_group* group = NULL;
    float alone[floats], together[floats];
    int told = 0;
    STRUCT(claray_render_config, config);
    STRUCT(claray_progress, reached);
    STRUCT(claray_device_share, share);
    config.width = width, config.height = height, config.spp = 4;
    EXPECT(claray_device_open(getenv("CLARAY_DEVICE") ? NULL : "cpu", &second) == CLARAY_OK);
    claray_device* const devices[2] = {device, second};
    EXPECT(claray_group_create(devices, 2, scene, &config, note, &told, &group) == CLARAY_OK);
    EXPECT(claray_group_render(group, NULL, NULL, &reached) == CLARAY_OK && reached.spp == 4);
    EXPECT(claray_group_renderer_create(group, &of_group) == CLARAY_OK);
    EXPECT(claray_renderer_image(one, alone, floats) == CLARAY_OK);
    EXPECT(claray_renderer_image(of_group, together, floats) == CLARAY_OK);
    EXPECT(memcmp(alone, together, sizeof alone) == 0 && told == 0);
    uint64_t samples = 0;
    for (size_t i = 0; i < 2; ++i) {
        EXPECT(claray_group_share_get(group, i, &share) == CLARAY_OK && strcmp(share.failure, "") == 0);
        samples += share.samples;
    }
    EXPECT(samples >= 4 * pixels && strlen(share.name) > 0);
    EXPECT(strcmp(claray_group_checkpoint_error(group), "") == 0);
    EXPECT_ERROR(claray_group_share_get(group, 2, &share), CLARAY_ERROR_USAGE, "i is 2, and there are 2 devices");
    claray_group_release(group), group = NULL;
    EXPECT(claray_renderer_layer(of_group, "depth", alone, pixels) == CLARAY_OK && alone[0] > 2); /* it lives on */
    EXPECT_ERROR(claray_group_create(devices, 0, scene, &config, NULL, NULL, &group), CLARAY_ERROR_USAGE, "count is 0");
    EXPECT(group == NULL);
    claray_renderer_release(one), claray_renderer_release(of_group), claray_device_release(second);
}

void test_renders(claray_device* device) {
    claray_scene* scene = lit_floor();
    claray_renderer* renderer = renderer_of(device, scene, 4);
    test_restart(renderer);
    test_checkpoint(device, scene);
    test_group(device, scene);
    test_config(device, scene);
    test_update(renderer, scene);
    test_size(renderer);
    test_region_and_alpha(device, scene);
    test_kernels_of_renderer(renderer);
    claray_renderer_release(renderer), claray_scene_release(scene);
}

/* A floor of an own BSDF reflects a quarter of what a white diffuse one reflects. */
void test_bsdf(claray_device* device) {
    static const char source[] =
        "#include \"bsdf/types.clh\"\n"
        "static inline float3 eval_grey(const MaterialData* material, const BsdfView* view, float3 i, float* pdf) {\n"
        "    const float cosine = fmax(i.z, 0.0f);\n"
        "    *pdf = cosine * INV_PI;\n"
        "    return (float3)(parameters_of(material, view)[0] * cosine * INV_PI);\n"
        "}\n"
        "static inline bool sample_grey(const MaterialData* material, const BsdfView* view, float3 random,\n"
        "                               BsdfSample* sample) {\n"
        "    sample->incoming = sample_cosine(random.xy);\n"
        "    sample->weight = (float3)(parameters_of(material, view)[0]);\n"
        "    sample->pdf = sample->incoming.z * INV_PI;\n"
        "    return true;\n"
        "}\n"
        "static inline bool is_delta_grey(const MaterialData* material) { return false; }\n";
    claray_scene* scene = lit_floor();
    float white[floats], grey[floats], quarter = 0.25f;
    uint32_t number = 99, second = 99;
    STRUCT(claray_material, material);
    EXPECT(claray_add_bsdf("grey", source, 1, &number) == CLARAY_OK && number != 99);
    EXPECT_ERROR(claray_add_bsdf("grey", source, 1, &second), CLARAY_ERROR_USAGE, "grey");
    EXPECT_ERROR(claray_add_bsdf("no name", source, 1, &second), CLARAY_ERROR_USAGE, "no name");
    EXPECT_ERROR(claray_add_bsdf("silver", NULL, 1, &second), CLARAY_ERROR_USAGE, "source is NULL");
    EXPECT(claray_material_init(&material) == CLARAY_OK);
    material.albedo[0] = material.albedo[1] = material.albedo[2] = 1;
    EXPECT(claray_scene_material_set(scene, 0, &material) == CLARAY_OK);
    claray_renderer* renderer = renderer_of(device, scene, 16);
    EXPECT(claray_renderer_image(renderer, white, floats) == CLARAY_OK);
    claray_renderer_release(renderer);
    material.kind = "custom", material.custom = number, material.parameters = &quarter, material.parameter_count = 1;
    EXPECT(claray_scene_material_set(scene, 0, &material) == CLARAY_OK);
    renderer = renderer_of(device, scene, 16);
    EXPECT(claray_renderer_image(renderer, grey, floats) == CLARAY_OK);
    EXPECT(fabsf(mean_of(grey, floats) / mean_of(white, floats) - 0.25f) < 0.02f);
    claray_renderer_release(renderer), claray_scene_release(scene);
}
