/* claray.h: renders to an error, for a time, at a rate, and with approximations. */
#include "capi_test.h"

static int stop_measuring(const char* what, void* user) {
    *(int*)user += what[0] != 0 ? 1 : 100;
    return 0;
}

static void test_models(claray_device* device, const claray_scene* scene) {
    claray_builder builder = CLARAY_BUILDER_AUTOMATIC;
    claray_lines* rows = NULL;
    int calls = 0;
    STRUCT(claray_device_model, model);
    model.known = 7;
    EXPECT(claray_device_model_get(device, &model) == CLARAY_OK);
    EXPECT(model.known == (model.fast.samples_per_second > 0));
    EXPECT(claray_device_model_measure(device, 1000, stop_measuring, &calls, &model) == CLARAY_OK);
    EXPECT(calls == 1 && model.known == 0);
    model.fast.build_nanoseconds = 1, model.fast.samples_per_second = 1e6;
    model.balanced.build_nanoseconds = 10, model.balanced.samples_per_second = 2e6;
    model.high.build_nanoseconds = 1000, model.high.samples_per_second = 3e6;
    model.independent_cost = 2;
    EXPECT(claray_device_model_rows_create(&model, &rows) == CLARAY_OK && claray_lines_count(rows) == 7);
    EXPECT(strstr(claray_lines_at(rows, 0), "plan/model") != NULL);
    claray_lines_release(rows), rows = NULL;
    EXPECT(claray_device_model_builder(&model, 1000, 1e-6, CLARAY_BUILDER_FAST, &builder) == CLARAY_OK);
    EXPECT(builder == CLARAY_BUILDER_FAST);
    EXPECT(claray_device_model_builder(&model, 1000, 1000, CLARAY_BUILDER_FAST, &builder) == CLARAY_OK);
    EXPECT(builder == CLARAY_BUILDER_HIGH);
    STRUCT(claray_render_config, config);
    STRUCT(claray_bvh_config, bvh);
    builder = CLARAY_BUILDER_AUTOMATIC, bvh.builder = CLARAY_BUILDER_BINNED, config.bvh = &bvh, config.spp = 1;
    EXPECT(claray_builder_for_samples(device, scene, &config, &builder) == CLARAY_OK);
    EXPECT(builder != CLARAY_BUILDER_AUTOMATIC);
    EXPECT_ERROR(claray_device_model_rows_create(NULL, &rows), CLARAY_ERROR_USAGE, "model is NULL");
}

static void test_plan(claray_device* device, const claray_scene* scene) {
    claray_plan* plan = NULL;
    claray_renderer* renderer = NULL;
    claray_group* group = NULL;
    claray_lines* picks = NULL;
    STRUCT(claray_render_config, config);
    STRUCT(claray_render_config, chosen);
    STRUCT(claray_progress, reached);
    STRUCT(claray_plan_result, result);
    config.width = 24, config.height = 16, config.spp = 4096, config.error = 0.2, config.approximate = "flat";
    config.effects = "+sky,-fog", config.checkpoint_seconds = 12, config.no_guide = 1;
    EXPECT(claray_plan_create(device, scene, &config, 1, NULL, NULL, &plan) == CLARAY_OK);
    EXPECT(claray_plan_config_get(plan, &chosen) == CLARAY_OK && chosen.width == 24 && chosen.error == 0.2);
    EXPECT(strcmp(chosen.approximate, "flat") == 0 && chosen.checkpoint_seconds == 12 && chosen.no_guide == 1);
    EXPECT(strstr(chosen.effects, "+sky") != NULL && strstr(chosen.effects, "-fog") != NULL);
    EXPECT(chosen.bvh != NULL && chosen.light_grid->side == 16);
    claray_plan_release(plan);
    config.effects = config.approximate = NULL;
    EXPECT(claray_plan_create(device, scene, &config, 1, NULL, NULL, &plan) == CLARAY_OK);
    EXPECT(claray_plan_config_get(plan, &chosen) == CLARAY_OK && chosen.approximate == NULL);
    EXPECT(claray_renderer_create(device, scene, &chosen, &renderer) == CLARAY_OK);
    EXPECT(claray_plan_render(plan, renderer, NULL, NULL, &reached) == CLARAY_OK);
    EXPECT(reached.spp >= 1 && reached.spp < 4096 && reached.error_bound > 0 && reached.error_bound <= 0.2);
    EXPECT(claray_plan_result_get(plan, &result) == CLARAY_OK && result.is_kept == 1 && strlen(result.account) > 10);
    EXPECT(claray_plan_picks_create(plan, &picks) == CLARAY_OK && claray_lines_count(picks) > 0);
    claray_device* const devices[1] = {device};
    EXPECT(claray_group_create(devices, 1, scene, &chosen, NULL, NULL, &group) == CLARAY_OK);
    reached.error_bound = 1;
    EXPECT(claray_plan_render_group(plan, group, NULL, NULL, &reached) == CLARAY_OK && reached.error_bound <= 0.2);
    claray_lines_release(picks), claray_group_release(group), claray_renderer_release(renderer);
    claray_plan_release(plan);
}

static int count_frames(uint32_t done, void* user) {
    *(uint32_t*)user = done;
    return 1;
}

static void test_frames(claray_device* device, const claray_scene* scene) {
    claray_frames* frames = NULL;
    claray_lines* picks = NULL;
    uint32_t done = 0;
    STRUCT(claray_render_config, config);
    STRUCT(claray_frames_config, wanted);
    STRUCT(claray_frames_report, report);
    config.width = 16, config.height = 8, config.spp = 2;
    wanted.fps = 0.01, wanted.frames = 2, wanted.orbit = 10;
    EXPECT(claray_frames_create(device, scene, &config, &wanted, count_frames, &done, &frames) == CLARAY_OK);
    EXPECT(done == 2 && claray_frames_get(frames, &report) == CLARAY_OK && report.frame_count == 2);
    EXPECT(report.spp == 2 && report.seconds[1] > 0 && report.median > 0 && report.percentile >= report.median);
    EXPECT(report.image_count == 3 * 16 * 8 && report.image[3] > 0 && strcmp(report.approximate, "nothing") == 0);
    EXPECT(claray_frames_picks_create(frames, &picks) == CLARAY_OK && claray_lines_count(picks) > 0);
    claray_lines_release(picks), claray_frames_release(frames), frames = NULL;
    wanted.fps = -1;
    EXPECT(claray_frames_create(device, scene, &config, &wanted, NULL, NULL, &frames) == CLARAY_ERROR_USAGE);
    EXPECT(frames == NULL);
}

/* Without shadows the floor is as bright, since nothing is between it and the lamp; paths of one surface lose light. */
static void test_approximation(claray_device* device, const claray_scene* scene) {
    claray_renderer *exact = NULL, *approximate = NULL;
    double error = -1;
    STRUCT(claray_render_config, config);
    config.width = 24, config.height = 16, config.spp = 4;
    EXPECT(claray_renderer_create(device, scene, &config, &exact) == CLARAY_OK);
    config.approximate = "flat";
    EXPECT(claray_renderer_create(device, scene, &config, &approximate) == CLARAY_OK);
    EXPECT(claray_renderer_render(approximate, NULL, NULL, NULL) == CLARAY_OK);
    EXPECT(claray_approximation_error(approximate, exact, &error) == CLARAY_OK && error > 0.01 && error < 1);
    EXPECT_ERROR(claray_approximation_error(approximate, NULL, &error), CLARAY_ERROR_USAGE, "exact is NULL");
    claray_renderer_release(exact), claray_renderer_release(approximate);
}

void test_targets(claray_device* device) {
    claray_scene* scene = lit_floor();
    test_models(device, scene);
    test_plan(device, scene);
    test_frames(device, scene);
    test_approximation(device, scene);
    claray_scene_release(scene);
}
