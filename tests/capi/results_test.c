/* claray.h: what renderers give, pictures, and image files. */
#include "capi_test.h"

enum { width = 24, height = 16, pixels = width * height, floats = 3 * pixels };

static void test_layers(claray_renderer* renderer) {
    float normals[floats], noise[pixels], error[pixels], sum = 0;
    uint32_t materials[pixels];
    STRUCT(claray_layer_info, info);
    EXPECT(claray_layer_get("normal", &info) == CLARAY_OK && info.channels == 3 && info.is_integer == 0);
    EXPECT(strcmp(info.letters, "XYZ") == 0 && strlen(info.meaning) > 5);
    EXPECT(claray_layer_get("material", &info) == CLARAY_OK && info.channels == 1 && info.is_integer == 1);
    EXPECT(claray_renderer_layer(renderer, "normal", normals, floats) == CLARAY_OK && normals[2] == 1);
    EXPECT(claray_renderer_layer(renderer, "material", materials, pixels) == CLARAY_OK && materials[pixels / 2] == 0);
    EXPECT(claray_renderer_layer(renderer, "noise", noise, pixels) == CLARAY_OK);
    EXPECT(claray_renderer_layer(renderer, "error", error, pixels) == CLARAY_OK);
    for (int i = 0; i < pixels; ++i) sum += noise[i];
    EXPECT(sum > 0 && error[pixels / 2] > 0);
    EXPECT_ERROR(claray_renderer_layer(renderer, "normal", normals, pixels), CLARAY_ERROR_USAGE, "count is 384");
    EXPECT_ERROR(claray_renderer_layer(renderer, "smell", normals, pixels), CLARAY_ERROR_USAGE, "name is 'smell'");
    EXPECT_ERROR(claray_renderer_layer(renderer, "depth", NULL, pixels), CLARAY_ERROR_USAGE, "the layer is NULL");
    EXPECT(claray_renderer_layer(renderer, "voxels", normals, floats) == CLARAY_ERROR_USAGE); /* no light grid */
}

static void test_images(claray_renderer* renderer, const float* image) {
    const float* radiance = NULL;
    double error = -1;
    double own = -1;
    float black[floats] = {0}, bright[floats];
    for (int i = 0; i < floats; ++i) bright[i] = 5 * image[i];
    EXPECT(claray_renderer_radiance(renderer, 0, 0, &radiance) == CLARAY_OK);
    EXPECT(memcmp(radiance, image, floats * sizeof *image) == 0);
    EXPECT(claray_renderer_radiance(renderer, 2, 2, &radiance) == CLARAY_OK && radiance[11] > 0);
    EXPECT(claray_renderer_error_of(renderer, image, floats, &own) == CLARAY_OK && own < 0.5);
    EXPECT(claray_renderer_error_of(renderer, bright, floats, &error) == CLARAY_OK && error > own && error > 0.7);
    EXPECT_ERROR(claray_renderer_error_of(renderer, black, 5, &error), CLARAY_ERROR_USAGE, "count is 5");
    STRUCT(claray_image_error, compared);
    EXPECT(claray_image_compare(image, image, width, height, &compared) == CLARAY_OK && compared.rmse == 0);
    EXPECT(claray_image_compare(black, image, width, height, &compared) == CLARAY_OK && compared.rmse > 0.8);
    EXPECT(compared.relmse > 0.5 && compared.perceptual > 0);
    EXPECT(claray_image_compare(black, image, 0, 0, &compared) == CLARAY_ERROR_USAGE);
}

static void test_pictures(claray_renderer* renderer, const float* image) {
    const uint8_t* rgba = NULL;
    uint8_t mapped[floats];
    STRUCT(claray_picture_config, config);
    int wrong = 0;
    for (int bright = 0; bright < 2; ++bright) {
        config.exposure = (float)bright, config.tone_map = bright ? CLARAY_TONE_MAP_NONE : CLARAY_TONE_MAP_ACES;
        EXPECT(claray_renderer_picture(renderer, &config, &rgba) == CLARAY_OK);
        EXPECT(claray_tone_map_apply(image, floats, &config, mapped) == CLARAY_OK);
        for (int i = 0; i < pixels; ++i)
            wrong += memcmp(rgba + 4 * i, mapped + 3 * i, 3) != 0 || rgba[4 * i + 3] != 255;
    }
    EXPECT(wrong == 0);
    const float half = 0.5f;
    EXPECT(claray_tone_map_apply(&half, 1, &config, mapped) == CLARAY_OK && mapped[0] == 255);
    EXPECT(claray_linear_from_srgb(255) == 1 && fabsf(claray_linear_from_srgb(188) - 0.5f) < 0.01f);
    config.denoised = 1;
    EXPECT(claray_renderer_picture(renderer, &config, &rgba) == CLARAY_OK && rgba[3] == 255);
    config.tone_map = (claray_tone_map)2;
    EXPECT_ERROR(claray_renderer_picture(renderer, &config, &rgba), CLARAY_ERROR_USAGE, "config.tone_map is 2");
}

/* Neighbours differ less than they did. */
static double roughness_of(const float* image) {
    double sum = 0;
    for (int i = 3; i < floats; ++i) sum += fabs((double)image[i] - (double)image[i - 3]);
    return sum;
}

static void test_denoisers(claray_renderer* renderer, const float* image) {
    float denoised[floats];
    claray_denoiser picked = CLARAY_DENOISER_AUTOMATIC;
    EXPECT(claray_denoiser_resolve(CLARAY_DENOISER_AUTOMATIC, &picked) == CLARAY_OK);
    EXPECT(picked == CLARAY_DENOISER_CLARAY || picked == CLARAY_DENOISER_OIDN);
    const int installed = claray_denoiser_resolve(CLARAY_DENOISER_OIDN, &picked) == CLARAY_OK;
    EXPECT(installed || strstr(claray_last_error(), "Open Image Denoise") != NULL);
    EXPECT(claray_renderer_denoised(renderer, CLARAY_DENOISER_CLARAY, denoised, floats) == CLARAY_OK);
    EXPECT(roughness_of(denoised) < 0.7 * roughness_of(image));
    STRUCT(claray_render_statistics, before);
    STRUCT(claray_render_statistics, after);
    EXPECT(claray_renderer_statistics_get(renderer, NULL, &before) == CLARAY_OK);
    EXPECT(claray_renderer_release_denoiser(renderer) == CLARAY_OK);
    EXPECT(claray_renderer_statistics_get(renderer, NULL, &after) == CLARAY_OK);
    EXPECT(after.device_bytes < before.device_bytes);
    EXPECT_ERROR(claray_renderer_denoised(renderer, CLARAY_DENOISER_CLARAY, denoised, 4), CLARAY_ERROR_USAGE,
                 "count is 4");
    EXPECT_ERROR(claray_renderer_denoised(renderer, (claray_denoiser)3, denoised, floats), CLARAY_ERROR_USAGE,
                 "denoiser is 3");
}

static void test_gbuffer(claray_renderer* renderer) {
    claray_gbuffer_pixel buffer[pixels];
    double matrix[16];
    float normals[floats], positions[floats];
    EXPECT(claray_renderer_gbuffer(renderer, CLARAY_NORMALS_OCTAHEDRAL, buffer, pixels, matrix) == CLARAY_OK);
    EXPECT(claray_gbuffer_unpack(buffer, width, height, CLARAY_NORMALS_OCTAHEDRAL, matrix, normals, positions) ==
           CLARAY_OK);
    EXPECT(fabsf(normals[floats / 2 + 2] - 1) < 1e-4f && fabsf(positions[floats / 2 + 2]) < 1e-3f);
    EXPECT(buffer[0].depth > 0 && buffer[0].albedo_material >> 24 == 0);
    EXPECT_ERROR(claray_gbuffer_unpack(buffer, width, height, CLARAY_NORMALS_SPHERICAL, NULL, NULL, positions),
                 CLARAY_ERROR_USAGE, "world_from_image is NULL");
    EXPECT_ERROR(claray_renderer_gbuffer(renderer, (claray_normal_packing)2, buffer, pixels, NULL), CLARAY_ERROR_USAGE,
                 "packing is 2");
    EXPECT_ERROR(claray_renderer_gbuffer(renderer, CLARAY_NORMALS_SPHERICAL, buffer, 3, NULL), CLARAY_ERROR_USAGE,
                 "count is 3");
}

static void test_light_layers(claray_device* device, claray_scene* scene, const float* image) {
    claray_renderer* renderer = NULL;
    STRUCT(claray_render_config, config);
    STRUCT(claray_layer_info, info);
    float group[floats], rest[floats], same[floats];
    config.width = width, config.height = height, config.spp = 4;
    config.lobes = 1, config.light_groups = "air=sky";
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, NULL) == CLARAY_OK);
    EXPECT(claray_renderer_image(renderer, same, floats) == CLARAY_OK && memcmp(same, image, sizeof same) == 0);
    EXPECT(claray_layer_get("lobe_diffuse_direct", &info) == CLARAY_OK && info.channels == 3);
    EXPECT(claray_renderer_layer(renderer, "lobe_diffuse_direct", group, floats) == CLARAY_OK);
    EXPECT(claray_renderer_layer(renderer, "light_air", group, floats) == CLARAY_OK);
    EXPECT(claray_renderer_layer(renderer, "light_rest", rest, floats) == CLARAY_OK);
    for (int i = 0; i < floats; ++i) EXPECT(fabsf(group[i] + rest[i] - image[i]) <= 1e-6f * (1 + image[i]));
    EXPECT_ERROR(claray_renderer_layer(renderer, "light_moon", rest, floats), CLARAY_ERROR_USAGE, "does not keep");
    claray_renderer_release(renderer), renderer = NULL;
    config.light_groups = "air";
    EXPECT_ERROR(claray_renderer_create(device, scene, &config, &renderer), CLARAY_ERROR_USAGE, "has no lights");
}

static void test_cryptomatte(const claray_renderer* renderer) {
    claray_cryptomatte* matte = NULL;
    STRUCT(claray_cryptomatte_info, info);
    EXPECT(claray_cryptomatte_create(renderer, CLARAY_MATTE_MATERIAL, 8, &matte) == CLARAY_OK);
    EXPECT(claray_cryptomatte_get(matte, &info) == CLARAY_OK && strcmp(info.name, "crypto_material") == 0);
    EXPECT(info.part_count == (size_t)pixels * info.ranks && info.ranks % 2 == 0);
    EXPECT(info.parts[1] > 0 && info.parts[1] <= 1);
    EXPECT(strchr(info.manifest, '{') != NULL && claray_matte_hash("hello") == 0x248bfa47u);
    EXPECT(claray_matte_id(claray_matte_hash("hello")) > 0);
    const claray_cryptomatte* mattes[1] = {matte};
    const claray_status exr = claray_write_exr_with_mattes("capi_matte.exr", width, height, NULL, 0, mattes, 1);
    EXPECT(exr == CLARAY_OK || strstr(claray_last_error(), "OpenEXR") != NULL);
    if (exr == CLARAY_OK) remove("capi_matte.exr");
    claray_cryptomatte_release(matte);
    EXPECT_ERROR(claray_cryptomatte_create(renderer, (claray_matte)3, 8, &matte), CLARAY_ERROR_USAGE, "kind is 3");
    EXPECT_ERROR(claray_cryptomatte_create(renderer, CLARAY_MATTE_ASSET, 0, &matte), CLARAY_ERROR_USAGE,
                 "samples is 0");
}

static void test_image_files(const float* image) {
    claray_image* loaded = NULL;
    STRUCT(claray_texture, texture);
    float values[pixels], rgb[floats] = {0};
    uint32_t numbers[pixels];
    for (int i = 0; i < pixels; ++i) values[i] = (float)i, numbers[i] = (uint32_t)(i % 5);
    EXPECT(claray_check_writable("capi_image.pfm") == CLARAY_OK);
    EXPECT_ERROR(claray_check_writable("capi_image.bmp"), CLARAY_ERROR_USAGE, "capi_image.bmp");
    EXPECT(claray_write_image("capi_image.pfm", image, width, height, NULL) == CLARAY_OK);
    EXPECT(claray_image_load("capi_image.pfm", CLARAY_TEXEL_SRGB8, &loaded) == CLARAY_OK);
    EXPECT(claray_image_get(loaded, &texture) == CLARAY_OK && texture.width == width && texture.channels == 3);
    EXPECT(memcmp(texture.texels, image, floats * sizeof *image) == 0);
    claray_image_release(loaded);
    EXPECT(claray_write_image("capi_image.png", image, width, height, NULL) == CLARAY_OK);
    EXPECT(claray_image_load("capi_image.png", CLARAY_TEXEL_SRGB8, &loaded) == CLARAY_OK);
    EXPECT(claray_image_get(loaded, &texture) == CLARAY_OK && texture.format == CLARAY_TEXEL_SRGB8);
    claray_image_release(loaded);
    EXPECT(claray_write_pfm("capi_image.pfm", values, width, height) == CLARAY_OK);
    EXPECT(claray_image_load("capi_image.pfm", CLARAY_TEXEL_SRGB8, &loaded) == CLARAY_OK);
    EXPECT(claray_image_get(loaded, &texture) == CLARAY_OK && texture.channels == 1);
    EXPECT(((const float*)texture.texels)[7] == 7);
    claray_image_release(loaded);
    const claray_exr_layer layers[2] = {{NULL, "RGB", image, NULL}, {"material", "X", NULL, numbers}};
    const claray_status exr = claray_write_exr("capi_image.exr", width, height, layers, 2);
    EXPECT(exr == CLARAY_OK || strstr(claray_last_error(), "OpenEXR") != NULL);
    if (exr == CLARAY_OK) {
        EXPECT(claray_image_load("capi_image.exr", CLARAY_TEXEL_SRGB8, &loaded) == CLARAY_OK);
        EXPECT(claray_image_get(loaded, &texture) == CLARAY_OK && texture.height == height);
        claray_image_release(loaded), remove("capi_image.exr");
    }
    const claray_exr_layer empty = {"depth", "Z", NULL, NULL};
    EXPECT_ERROR(claray_write_exr("capi_image.exr", width, height, &empty, 1), CLARAY_ERROR_USAGE, "'depth' needs");
    EXPECT(claray_false_color(values, pixels, rgb) == CLARAY_OK && memcmp(rgb, rgb + floats - 3, 12) != 0);
    EXPECT(claray_identifier_color(numbers, pixels, rgb) == CLARAY_OK && memcmp(rgb, rgb + 15, 12) == 0);
    EXPECT(memcmp(rgb, rgb + 3, 12) != 0);
    EXPECT_ERROR(claray_write_image("capi_image.png", NULL, width, height, NULL), CLARAY_ERROR_USAGE, "rgb is NULL");
    EXPECT_ERROR(claray_write_image("capi_image.png", image, 0, height, NULL), CLARAY_ERROR_USAGE, "width is 0");
    EXPECT(claray_write_image("no/folder/image.png", image, width, height, NULL) == CLARAY_ERROR_INPUT);
    EXPECT(remove("capi_image.png") == 0 && remove("capi_image.pfm") == 0);
}

static int stop_at_half(double done, void* user) {
    *(int*)user += 1;
    return done < 0;
}

/* Light at the floor, as a map of it and as a probe above it. */
static void test_baking(claray_device* device, claray_scene* scene) {
    claray_image* image = NULL;
    claray_scene* around = NULL;
    const float above[3] = {0, 0, 1};
    uint32_t uv_set = 9;
    int calls = 0;
    STRUCT(claray_light_map_config, config);
    STRUCT(claray_texture, map);
    STRUCT(claray_material, material);
    STRUCT(claray_environment, environment);
    STRUCT(claray_render_config, probe);
    EXPECT(claray_light_map_uv_set(scene, 0, &uv_set) == CLARAY_OK && uv_set == 0);
    config.width = config.height = 4, config.spp = 4;
    EXPECT(claray_light_map_create(device, scene, 0, &config, NULL, NULL, &image) == CLARAY_OK);
    EXPECT(claray_image_get(image, &map) == CLARAY_OK && map.width == 4 && map.format == CLARAY_TEXEL_FLOAT32);
    EXPECT(((const float*)map.texels)[15] > 0.5f);
    EXPECT(claray_scene_light_map_set(scene, 0, &map, 0) == CLARAY_OK);
    STRUCT(claray_mesh, mesh);
    EXPECT(claray_scene_mesh_get(scene, 0, &mesh) == CLARAY_OK);
    EXPECT(claray_scene_material_get(scene, mesh.materials ? mesh.materials[0] : 0, &material) == CLARAY_OK);
    EXPECT(material.light_map.texture != CLARAY_NO_TEXTURE);
    claray_image_release(image), image = NULL;
    EXPECT(claray_light_map_create(device, scene, 0, &config, stop_at_half, &calls, &image) == CLARAY_ERROR_INPUT);
    EXPECT(calls > 0 && image == NULL);
    EXPECT_ERROR(claray_light_map_uv_set(scene, 7, &uv_set), CLARAY_ERROR_USAGE, "mesh is 7");
    EXPECT(claray_light_map_create(device, scene, 7, &config, NULL, NULL, &image) == CLARAY_ERROR_INPUT);
    probe.width = probe.height = 4, probe.spp = 1;
    EXPECT(claray_scene_create(&around) == CLARAY_OK);
    EXPECT(claray_probe_render(device, scene, above, &probe, around) == CLARAY_OK);
    EXPECT(claray_scene_environment_get(around, &environment) == CLARAY_OK && environment.image_count == 6);
    EXPECT(claray_scene_environment_image_get(around, 4, &map) == CLARAY_OK && map.width == 4);
    float lamp = 0;
    for (size_t i = 0; i < 16 * map.channels; ++i) lamp += ((const float*)map.texels)[i];
    EXPECT(lamp > 1); /* which is towards +z */
    EXPECT_ERROR(claray_probe_render(device, scene, NULL, &probe, around), CLARAY_ERROR_USAGE, "position is NULL");
    claray_scene_release(around);
}

void test_results(claray_device* device) {
    claray_scene* scene = lit_floor();
    claray_renderer* renderer = NULL;
    float image[floats];
    STRUCT(claray_render_config, config);
    config.width = width, config.height = height, config.spp = 4;
    EXPECT(claray_renderer_create(device, scene, &config, &renderer) == CLARAY_OK);
    EXPECT(claray_renderer_render(renderer, NULL, NULL, NULL) == CLARAY_OK);
    EXPECT(claray_renderer_image(renderer, image, floats) == CLARAY_OK);
    test_layers(renderer);
    test_images(renderer, image);
    test_pictures(renderer, image);
    test_denoisers(renderer, image);
    test_gbuffer(renderer);
    test_cryptomatte(renderer);
    test_light_layers(device, scene, image);
    test_image_files(image);
    test_baking(device, scene);
    claray_renderer_release(renderer), claray_scene_release(scene);
}
