/* claray.h: sensors above the floor of lit_floor. */
#include "capi_test.h"

static const double pi = 3.14159265358979;

static void test_patterns(void) {
    claray_beams* beams = NULL;
    const claray_beam* all = NULL;
    uint32_t rows = 0, columns = 0;
    const double elevations[2] = {0, -pi / 6};
    EXPECT(claray_spinning_beams_create(elevations, 2, 4, 0, 2 * pi, &beams) == CLARAY_OK);
    EXPECT(claray_beams_get(beams, &rows, &columns, &all) == CLARAY_OK && rows == 2 && columns == 4);
    EXPECT(fabsf(all[1].direction[1] - 1) < 1e-6f && all[1].time == 0.25f);
    EXPECT(fabsf(all[4].direction[2] + 0.5f) < 1e-6f);
    claray_beams_release(beams);
    EXPECT(claray_raster_beams_create(3, 5, 1, 0.5, &beams) == CLARAY_OK);
    EXPECT(claray_beams_get(beams, &rows, &columns, &all) == CLARAY_OK && rows == 3 && columns == 5);
    EXPECT(fabsf(all[7].direction[0] - 1) < 1e-6f); /* in the middle */
    claray_beams_release(beams);
    EXPECT(claray_rosette_beams_create(7, 0.5, 3, 2, 0, &beams) == CLARAY_OK);
    EXPECT(claray_beams_get(beams, &rows, &columns, &all) == CLARAY_OK && rows == 1 && columns == 7);
    EXPECT(all[0].direction[0] > 0.9f && all[6].time > 0.8f);
    claray_beams_release(beams), beams = NULL;
    EXPECT_ERROR(claray_spinning_beams_create(NULL, 2, 4, 0, 1, &beams), CLARAY_ERROR_USAGE, "elevations is NULL");
    EXPECT(claray_raster_beams_create(0, 5, 1, 1, &beams) == CLARAY_ERROR_USAGE);
    EXPECT(claray_rosette_beams_create(0, 1, 1, 1, 0, &beams) == CLARAY_ERROR_USAGE && beams == NULL);
}

/* A camera of 3 x 1 pixels at z = 4 looks down; its z is the world's -z, and its x the world's x. */
void test_sensors(claray_device* device) {
    claray_scene* scene = lit_floor();
    claray_beams* beams = NULL;
    claray_sensor_world* world = NULL;
    claray_sensor* sensor = NULL;
    claray_sensor_return returns[3];
    claray_sensor_pose pose;
    const uint32_t floor_of_scene = 0;
    const double down[12] = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 4};
    STRUCT(claray_lens, lens);
    STRUCT(claray_sensor_config, config);
    STRUCT(claray_sensor_world_config, world_config);
    STRUCT(claray_placement, placement);
    for (int i = 0; i < 12; ++i) placement.transform[i] = i % 5 == 0 ? 1.f : 0.f;
    EXPECT(claray_scene_placement_set(scene, 0, &placement) == CLARAY_OK);
    test_patterns();
    lens.fx = lens.fy = 1, lens.cx = 1;
    EXPECT(claray_camera_beams_create(3, 1, &lens, 0, &beams) == CLARAY_OK);
    EXPECT(claray_sensor_config_init(&config) == CLARAY_OK && config.farthest == 1000 && config.rays == 1);
    EXPECT(claray_beams_get(beams, &config.rows, &config.columns, &config.beams) == CLARAY_OK);
    EXPECT(claray_sensor_create(device, &config, &sensor) == CLARAY_OK && claray_sensor_size(sensor, 1) == 3);
    world_config.movers = &floor_of_scene, world_config.mover_count = 1;
    EXPECT(claray_sensor_world_build(device, scene, &world_config, &world) == CLARAY_OK);
    EXPECT(claray_sensor_world_triangle_count(world) == 2);
    size_t movers = 9;
    EXPECT(claray_sensor_world_movers(world, &movers)[0] == 0 && movers == 1);
    EXPECT(claray_sensor_pose_set(&pose, down, down) == CLARAY_OK && pose.begin[2] == 4);
    EXPECT(claray_sensor_scan(sensor, world, &pose, 1, 0, returns, 3) == CLARAY_OK);
    EXPECT(fabsf(returns[1].range - 4) < 1e-5f && returns[1].material == 0 && returns[1].instance == 0);
    EXPECT(fabsf(returns[1].normal[2] + 1) < 1e-5f && fabsf(returns[1].velocity) < 1e-5f);
    EXPECT(returns[0].primitive == CLARAY_MISS && isnan(returns[2].range)); /* beside the floor */
    /* The floor rises by 1 within the scan, which takes 0.1 s. */
    float begins[12], ends[12];
    memcpy(begins, placement.transform, sizeof begins), memcpy(ends, begins, sizeof ends);
    ends[11] = 1;
    EXPECT(claray_sensor_world_move(world, begins, ends, 1) == CLARAY_OK);
    EXPECT(claray_sensor_scan(sensor, world, &pose, 1, 0, returns, 3) == CLARAY_OK);
    EXPECT(fabsf(returns[1].velocity + 10) < 1e-3f);
    EXPECT_ERROR(claray_sensor_scan(sensor, world, &pose, 1, 0, returns, 2), CLARAY_ERROR_USAGE, "count is 2");
    EXPECT_ERROR(claray_sensor_scan(sensor, world, NULL, 1, 0, returns, 3), CLARAY_ERROR_USAGE, "poses is NULL");
    EXPECT(claray_sensor_world_move(world, begins, ends, 0) == CLARAY_ERROR_USAGE);
    claray_sensor_release(sensor), sensor = NULL;
    config.rays = 65;
    EXPECT_ERROR(claray_sensor_create(device, &config, &sensor), CLARAY_ERROR_USAGE, "rays");
    config.rays = 1, config.order = (claray_return_order)3;
    EXPECT_ERROR(claray_sensor_create(device, &config, &sensor), CLARAY_ERROR_USAGE, "config.order is 3");
    config.beams = NULL;
    config.order = CLARAY_RETURN_STRONGEST;
    EXPECT_ERROR(claray_sensor_create(device, &config, &sensor), CLARAY_ERROR_USAGE, "config.beams is NULL");
    EXPECT(sensor == NULL && claray_sensor_size(NULL, 1) == 0 && claray_sensor_world_triangle_count(NULL) == 0);
    claray_beams_release(beams), claray_sensor_world_release(world), claray_scene_release(scene);
}
