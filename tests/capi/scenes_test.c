/* claray.h: scenes from arrays and files. What is set is read again, member by member. */
#include "capi_test.h"

static const float floor_vertices[12] = {-2, -2, 0, 2, -2, 0, 2, 2, 0, -2, 2, 0};
static const float lamp_vertices[12] = {-1, -1, 5, -1, 1, 5, 1, 1, 5, 1, -1, 5};
static const float unit_uvs[8] = {0, 1, 1, 1, 1, 0, 0, 0};
static const uint32_t halves_of_square[6] = {0, 1, 2, 0, 2, 3};

static claray_mesh square_of(const float* vertices, const char* name, uint32_t material) {
    STRUCT(claray_mesh, mesh);
    mesh.vertices = vertices, mesh.vertex_count = 4, mesh.name = name, mesh.material = material;
    mesh.triangles = halves_of_square, mesh.triangle_count = 2, mesh.uvs = unit_uvs;
    return mesh;
}

claray_scene* lit_floor(void) {
    static const uint8_t texels[12] = {255, 255, 255, 200, 200, 200, 180, 180, 180, 255, 255, 255};
    claray_scene* scene = NULL;
    const claray_mesh ground = square_of(floor_vertices, "floor", 0), lamp = square_of(lamp_vertices, "lamp", 1);
    STRUCT(claray_material, material);
    STRUCT(claray_texture, texture);
    STRUCT(claray_camera, camera);
    EXPECT(claray_scene_create(&scene) == CLARAY_OK);
    EXPECT(claray_scene_set_name(scene, "lit floor") == CLARAY_OK);
    EXPECT(claray_scene_mesh_set(scene, 0, &ground) == CLARAY_OK);
    EXPECT(claray_scene_mesh_set(scene, 1, &lamp) == CLARAY_OK);
    texture.texels = texels, texture.width = texture.height = 2, texture.channels = 3, texture.name = "tiles";
    EXPECT(claray_scene_texture_set(scene, 0, &texture) == CLARAY_OK);
    EXPECT(claray_material_init(&material) == CLARAY_OK);
    material.name = "floor", material.albedo_map.texture = 0;
    EXPECT(claray_scene_material_set(scene, 0, &material) == CLARAY_OK);
    EXPECT(claray_material_init(&material) == CLARAY_OK);
    material.name = "lamp", material.emission[0] = material.emission[1] = material.emission[2] = 6;
    EXPECT(claray_scene_material_set(scene, 1, &material) == CLARAY_OK);
    EXPECT(claray_camera_init(&camera) == CLARAY_OK);
    camera.position[2] = 4, camera.vertical_fov = 30;
    EXPECT(claray_scene_camera_set(scene, &camera) == CLARAY_OK);
    EXPECT(claray_scene_validate(scene) == CLARAY_OK);
    return scene;
}

static void test_lists_of_scene(void) {
    claray_scene *scene = lit_floor(), *copy = NULL;
    float bounds[6];
    EXPECT(claray_scene_count(scene, CLARAY_MESHES) == 2 && claray_scene_count(scene, CLARAY_MATERIALS) == 2);
    EXPECT(claray_scene_count(scene, CLARAY_TEXTURES) == 1 && claray_scene_count(scene, CLARAY_PLACEMENTS) == 0);
    EXPECT(claray_scene_count(NULL, CLARAY_MESHES) == 0 && claray_scene_count(scene, (claray_scene_part)9) == 0);
    EXPECT(strcmp(claray_scene_name(scene), "lit floor") == 0 && strcmp(claray_scene_name(NULL), "") == 0);
    EXPECT(claray_scene_triangle_count(scene) == 4);
    EXPECT(claray_scene_copy_create(scene, &copy) == CLARAY_OK);
    EXPECT(claray_scene_truncate(scene, CLARAY_MESHES, 1) == CLARAY_OK && claray_scene_triangle_count(scene) == 2);
    EXPECT(claray_scene_triangle_count(copy) == 4);
    EXPECT_ERROR(claray_scene_truncate(scene, CLARAY_LIGHTS, 1), CLARAY_ERROR_USAGE, "0 lights");
    EXPECT_ERROR(claray_scene_truncate(scene, (claray_scene_part)9, 0), CLARAY_ERROR_USAGE, "part is 9");
    EXPECT(claray_scene_bounds(copy, bounds) == CLARAY_OK && bounds[0] == -2 && bounds[5] == 5);
    EXPECT(claray_scene_mesh_bounds(copy, 1, bounds) == CLARAY_OK && bounds[2] == 5 && bounds[3] == 1);
    EXPECT_ERROR(claray_scene_mesh_bounds(copy, 2, bounds), CLARAY_ERROR_USAGE, "index is 2, and there are 2 meshes");
    EXPECT_ERROR(claray_scene_bounds(copy, NULL), CLARAY_ERROR_USAGE, "bounds is NULL");
    claray_scene_release(scene), claray_scene_release(copy);
}

static void test_mesh(claray_scene* scene) {
    const float normals[12] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, uvs1[8] = {9};
    float tangents[16], colors[16];
    for (int i = 0; i < 16; ++i) tangents[i] = i % 4 == 0 || i % 4 == 3 ? 1.f : 0.f, colors[i] = 0.25f;
    const uint32_t materials[2] = {1, 0}, mask = 6, masks[2] = {1, 2};
    claray_mesh mesh = square_of(floor_vertices, "new", 0);
    STRUCT(claray_mesh, read);
    mesh.normals = normals, mesh.uvs1 = uvs1, mesh.tangents = tangents, mesh.colors = colors;
    mesh.materials = materials, mesh.masks = &mask, mesh.mask_count = 1;
    EXPECT(claray_scene_mesh_set(scene, 2, &mesh) == CLARAY_OK && claray_scene_count(scene, CLARAY_MESHES) == 3);
    EXPECT(claray_scene_mesh_get(scene, 2, &read) == CLARAY_OK && strcmp(read.name, "new") == 0);
    EXPECT(read.vertex_count == 4 && read.vertices[3] == 2 && read.triangle_count == 2 && read.triangles[5] == 3);
    EXPECT(read.normals[2] == 1 && read.uvs[1] == 1 && read.uvs1[0] == 9 && read.tangents[3] == 1);
    EXPECT(read.colors[5] == 0.25f && read.materials[0] == 1 && read.mask_count == 1 && read.masks[0] == 6);
    EXPECT(claray_scene_mesh_get(scene, 1, &read) == CLARAY_OK && read.normals == NULL && read.materials[1] == 1);
    EXPECT_ERROR(claray_scene_mesh_set(scene, 4, &mesh), CLARAY_ERROR_USAGE, "index is 4, and there are 3 meshes");
    mesh.masks = masks, mesh.mask_count = 2;
    EXPECT_ERROR(claray_scene_mesh_set(scene, 3, &mesh), CLARAY_ERROR_USAGE, "mesh.mask_count is 2");
    mesh.mask_count = 0, mesh.geometries = materials;
    EXPECT_ERROR(claray_scene_mesh_set(scene, 3, &mesh), CLARAY_ERROR_USAGE, "mesh.geometries");
    mesh.geometries = NULL, mesh.vertices = NULL;
    EXPECT_ERROR(claray_scene_mesh_set(scene, 3, &mesh), CLARAY_ERROR_USAGE, "mesh.vertices is NULL");
    EXPECT(claray_scene_truncate(scene, CLARAY_MESHES, 2) == CLARAY_OK);
}

static void test_placements(claray_scene* scene) {
    STRUCT(claray_placement, placement);
    STRUCT(claray_placement, read);
    placement.mesh = 1, placement.name = "second", placement.moves = 1;
    for (int i = 0; i < 12; ++i) placement.transform[i] = i % 5 == 0 ? 1.f : 0.f;
    memcpy(placement.transform_end, placement.transform, sizeof placement.transform);
    placement.transform_end[3] = 7, placement.transform[1] = 0.5f;
    EXPECT(claray_scene_placement_set(scene, 0, &placement) == CLARAY_OK);
    EXPECT(claray_scene_placement_get(scene, 0, &read) == CLARAY_OK && read.mesh == 1 && read.moves == 1);
    EXPECT(memcmp(read.transform, placement.transform, sizeof read.transform) == 0);
    EXPECT(memcmp(read.transform_end, placement.transform_end, sizeof read.transform) == 0);
    EXPECT(strcmp(read.name, "second") == 0 && claray_scene_triangle_count(scene) == 2);
    float bounds[6];
    EXPECT(claray_scene_bounds(scene, bounds) == CLARAY_OK && bounds[3] == 8); /* at the end of the motion */
    placement.mesh = 5;
    EXPECT(claray_scene_placement_set(scene, 1, &placement) == CLARAY_OK);
    EXPECT_ERROR(claray_scene_validate(scene), CLARAY_ERROR_INPUT, "5");
    EXPECT(claray_scene_truncate(scene, CLARAY_PLACEMENTS, 0) == CLARAY_OK);
}

/* The members behind the kind are floats, integers and uses of textures: all of them differ from their defaults. */
static void test_materials(claray_scene* scene) {
    const float parameters[2] = {3, 4};
    STRUCT(claray_material, material);
    STRUCT(claray_material, read);
    EXPECT(claray_material_init(&material) == CLARAY_OK && strcmp(material.kind, "lambert") == 0);
    EXPECT(material.albedo[0] == 0.7f && material.ior == 1.5f && material.normal_map.texture == CLARAY_NO_TEXTURE);
    EXPECT(material.shininess == 32 && material.opacity == 1 && material.alpha_cutoff == 0.5f);
    memset(&material.albedo, 0, sizeof material - offsetof(claray_material, albedo));
    float* const numbers = (float*)&material.albedo;
    const size_t count = (offsetof(claray_material, parameters) - offsetof(claray_material, albedo)) / sizeof *numbers;
    for (size_t i = 0; i < count; ++i) numbers[i] = (float)(i + 1);
    material.kind = "principled", material.name = "all", material.shininess = 5, material.custom = 3;
    material.thin_walled = 1, material.cull_back = 1, material.alpha_mode = CLARAY_ALPHA_BLEND;
    material.alpha_test = CLARAY_ALPHA_NOT_EQUAL, material.parameters = parameters, material.parameter_count = 2;
    EXPECT(claray_scene_material_set(scene, 2, &material) == CLARAY_OK);
    EXPECT(claray_scene_material_get(scene, 2, &read) == CLARAY_OK);
    EXPECT(memcmp(&read.albedo, &material.albedo, count * sizeof *numbers) == 0);
    EXPECT(strcmp(read.kind, "principled") == 0 && strcmp(read.name, "all") == 0 && read.shininess == 5);
    EXPECT(read.parameter_count == 2 && read.parameters[1] == 4 && read.custom == 3);
    material.kind = "velvet";
    EXPECT_ERROR(claray_scene_material_set(scene, 2, &material), CLARAY_ERROR_USAGE, "material.kind is 'velvet'");
    material.kind = "custom", material.alpha_mode = (claray_alpha_mode)3;
    EXPECT_ERROR(claray_scene_material_set(scene, 2, &material), CLARAY_ERROR_USAGE, "material.alpha_mode is 3");
    EXPECT(claray_scene_truncate(scene, CLARAY_MATERIALS, 2) == CLARAY_OK);
    EXPECT(claray_scene_set_culling(scene, CLARAY_CULLING_BACK) == CLARAY_OK);
    EXPECT(claray_scene_material_get(scene, 0, &read) == CLARAY_OK && read.cull_back == 1);
    EXPECT(claray_scene_set_culling(scene, CLARAY_CULLING_NONE) == CLARAY_OK);
    EXPECT(claray_scene_material_get(scene, 0, &read) == CLARAY_OK && read.cull_back == 0);
    EXPECT_ERROR(claray_scene_set_culling(scene, (claray_culling)3), CLARAY_ERROR_USAGE, "culling is 3");
    STRUCT(claray_mesh, mesh);
    EXPECT(claray_scene_flip_fronts(scene) == CLARAY_OK && claray_scene_mesh_get(scene, 0, &mesh) == CLARAY_OK);
    EXPECT(mesh.triangles[1] == 2 && mesh.triangles[2] == 1);
    EXPECT(claray_scene_flip_fronts(scene) == CLARAY_OK);
}

static void test_lights(claray_scene* scene) {
    STRUCT(claray_light, light);
    STRUCT(claray_light, read);
    EXPECT(claray_light_init(&light) == CLARAY_OK && strcmp(light.kind, "point") == 0 && light.intensity[1] == 1);
    EXPECT(light.attenuation[2] == 1 && light.direction[1] == -1);
    light.name = "spot", light.kind = "spot", light.linear_range = 1;
    for (int i = 0; i < 3; ++i) {
        light.position[i] = (float)i, light.direction[i] = (float)(i + 3), light.intensity[i] = (float)(i + 6);
        light.attenuation[i] = (float)(i + 9);
    }
    light.inner_angle = 0.1f, light.outer_angle = 0.2f, light.range = 3;
    EXPECT(claray_scene_light_set(scene, 0, &light) == CLARAY_OK);
    EXPECT(claray_scene_light_get(scene, 0, &read) == CLARAY_OK && strcmp(read.kind, "spot") == 0);
    EXPECT(memcmp(read.position, light.position, sizeof light - offsetof(claray_light, position)) == 0);
    light.kind = "candle";
    EXPECT_ERROR(claray_scene_light_set(scene, 0, &light), CLARAY_ERROR_USAGE, "light.kind is 'candle'");
    EXPECT(claray_scene_truncate(scene, CLARAY_LIGHTS, 0) == CLARAY_OK);
    STRUCT(claray_sky, sky);
    STRUCT(claray_sky, sky_read);
    sky.horizon[0] = 1, sky.zenith[1] = 2, sky.fog_color[2] = 3, sky.fog_density = 4, sky.fog_depth = 5;
    EXPECT(claray_scene_sky_set(scene, &sky) == CLARAY_OK && claray_scene_sky_get(scene, &sky_read) == CLARAY_OK);
    EXPECT(memcmp(&sky, &sky_read, sizeof sky) == 0);
    memset(sky.horizon, 0, sizeof sky - offsetof(claray_sky, horizon));
    EXPECT(claray_scene_sky_set(scene, &sky) == CLARAY_OK);
}

static void test_cameras(claray_scene* scene) {
    STRUCT(claray_camera, camera);
    STRUCT(claray_camera, read);
    const float box[6] = {10, 10, 10, 12, 12, 12};
    EXPECT(claray_camera_init(&camera) == CLARAY_OK && camera.position[2] == 5 && camera.vertical_fov == 40);
    camera.projection = "panorama", camera.aperture_radius = 0.1f, camera.focus_distance = 2;
    camera.orthographic_height = 3, camera.up[0] = 0.5f, camera.target[1] = 0.25f;
    camera.moves_position = camera.moves_target = 1, camera.position_end[0] = 6, camera.target_end[1] = 7;
    EXPECT(claray_scene_camera_set(scene, &camera) == CLARAY_OK);
    EXPECT(claray_scene_camera_get(scene, 1, &read) == CLARAY_OK && strcmp(read.projection, "panorama") == 0);
    EXPECT(memcmp(read.position, camera.position, sizeof camera - offsetof(claray_camera, position)) == 0);
    EXPECT(claray_camera_orbit(&read, 90) == CLARAY_OK && fabsf(read.position[2]) < 3 && read.moves_target == 1);
    EXPECT(claray_scene_camera_fit(scene, NULL, 40, 1, &read) == CLARAY_OK && fabsf(read.target[0]) < 1);
    EXPECT(claray_scene_camera_fit(NULL, box, 40, 1, &read) == CLARAY_OK && read.target[0] == 11);
    EXPECT(claray_scene_camera_set(scene, NULL) == CLARAY_OK);
    EXPECT(claray_scene_camera_get(scene, 1, &read) == CLARAY_OK && strcmp(read.projection, "perspective") == 0);
    EXPECT_ERROR(claray_scene_camera_get(scene, 0, &read), CLARAY_ERROR_USAGE, "aspect is 0");
    camera.projection = "cylinder";
    EXPECT_ERROR(claray_scene_camera_set(scene, &camera), CLARAY_ERROR_USAGE, "camera.projection is 'cylinder'");
}

static void test_textures(claray_scene* scene) {
    const float texels[8] = {0.25f, 0.5f, 1, 2, 3, 4, 5, 6};
    claray_image *normals = NULL, *panorama = NULL, *loaded = NULL;
    STRUCT(claray_texture, texture);
    STRUCT(claray_texture, read);
    texture.texels = texels, texture.width = 4, texture.height = 2, texture.channels = 1, texture.name = "heights";
    texture.format = CLARAY_TEXEL_FLOAT32, texture.filter = CLARAY_FILTER_NEAREST;
    texture.wrap_u = CLARAY_WRAP_CLAMP, texture.wrap_v = CLARAY_WRAP_MIRROR;
    EXPECT(claray_scene_texture_set(scene, 1, &texture) == CLARAY_OK);
    EXPECT(claray_scene_texture_get(scene, 1, &read) == CLARAY_OK && strcmp(read.name, "heights") == 0);
    EXPECT(read.width == 4 && read.height == 2 && read.channels == 1 && read.format == CLARAY_TEXEL_FLOAT32);
    EXPECT(read.filter == CLARAY_FILTER_NEAREST && read.wrap_u == CLARAY_WRAP_CLAMP);
    EXPECT(read.wrap_v == CLARAY_WRAP_MIRROR && memcmp(read.texels, texels, sizeof texels) == 0);
    EXPECT(claray_normal_map_create(&texture, 1, &normals) == CLARAY_OK);
    EXPECT(claray_image_get(normals, &read) == CLARAY_OK && read.width == 4 && read.channels >= 3);
    claray_image_release(normals);
    EXPECT(claray_write_texture("capi_heights.pfm", &texture) == CLARAY_OK);
    EXPECT(claray_image_load("capi_heights.pfm", CLARAY_TEXEL_SRGB8, &loaded) == CLARAY_OK);
    EXPECT(claray_image_get(loaded, &read) == CLARAY_OK && read.height == 2 && ((const float*)read.texels)[0] == 0.25f);
    claray_image_release(loaded), loaded = NULL;

    /* The six faces of a cube, then one image. */
    const claray_texture* images[6];
    for (int i = 0; i < 6; ++i) images[i] = &texture;
    STRUCT(claray_environment, environment);
    STRUCT(claray_environment, environment_read);
    environment.images = images, environment.image_count = 6, environment.strength = 2, environment.rotation = 3;
    EXPECT(claray_scene_environment_set(scene, &environment) == CLARAY_OK);
    EXPECT(claray_scene_environment_get(scene, &environment_read) == CLARAY_OK);
    EXPECT(environment_read.image_count == 6 && environment_read.strength == 2 && environment_read.rotation == 3);
    EXPECT(claray_scene_environment_image_get(scene, 5, &read) == CLARAY_OK && read.width == 4);
    EXPECT_ERROR(claray_scene_environment_image_get(scene, 6, &read), CLARAY_ERROR_USAGE, "6 images");
    environment.image_count = 1, environment.strength = 0;
    EXPECT(claray_scene_environment_set(scene, &environment) == CLARAY_OK);
    EXPECT(claray_panorama_create(scene, &panorama) == CLARAY_OK);
    EXPECT(claray_image_get(panorama, &read) == CLARAY_OK && read.width == 4 && read.format == CLARAY_TEXEL_FLOAT32);
    claray_image_release(panorama), panorama = NULL;
    environment.image_count = 0;
    EXPECT(claray_scene_environment_set(scene, &environment) == CLARAY_OK);
    EXPECT_ERROR(claray_panorama_create(scene, &panorama), CLARAY_ERROR_USAGE, "no environment");
    claray_lines* warnings = NULL;
    EXPECT(claray_scene_environment_load(scene, "capi_heights.pfm", &warnings) == CLARAY_OK);
    EXPECT(claray_scene_environment_get(scene, &environment_read) == CLARAY_OK && environment_read.image_count == 1);
    EXPECT(claray_lines_count(warnings) == 0);
    EXPECT(claray_scene_environment_set(scene, &environment) == CLARAY_OK);
    EXPECT(remove("capi_heights.pfm") == 0);
    EXPECT_ERROR(claray_image_load("capi_heights.pfm", CLARAY_TEXEL_SRGB8, &loaded), CLARAY_ERROR_INPUT,
                 "capi_heights");
    EXPECT_ERROR(claray_image_load("x.png", (claray_texel_format)3, &loaded), CLARAY_ERROR_USAGE, "eight_bit is 3");
    texture.width = 0;
    EXPECT_ERROR(claray_scene_texture_set(scene, 1, &texture), CLARAY_ERROR_USAGE, "texture.width is 0");
    texture.width = 4, texture.texels = NULL;
    EXPECT_ERROR(claray_scene_texture_set(scene, 1, &texture), CLARAY_ERROR_USAGE, "texture.texels is NULL");
    EXPECT(claray_scene_truncate(scene, CLARAY_TEXTURES, 1) == CLARAY_OK);
    claray_lines_release(warnings);
}

static void test_effects_of_scene(claray_scene* scene) {
    claray_lines *effects = NULL, *causes = NULL, *approximations = NULL, *warnings = NULL;
    claray_scene* without = NULL;
    EXPECT(claray_scene_effects_create(scene, &causes, &effects) == CLARAY_OK);
    const size_t count = claray_lines_count(effects);
    EXPECT(count > 2 && claray_lines_count(causes) == count);
    int of_lamp = 0;
    for (size_t i = 0; i < count; ++i)
        if (strcmp(claray_lines_at(effects, i), "emissive-triangles") == 0)
            of_lamp = strstr(claray_lines_at(causes, i), "lamp") != NULL;
    EXPECT(of_lamp);
    claray_lines_release(effects), effects = NULL;
    EXPECT(claray_scene_without_effects_create(scene, "textures,emissive-triangles", &without) == CLARAY_OK);
    EXPECT(claray_scene_effects_create(without, NULL, &effects) == CLARAY_OK && claray_lines_count(effects) < count);
    EXPECT_ERROR(claray_scene_without_effects_create(scene, "velvet", &without), CLARAY_ERROR_USAGE, "velvet");
    EXPECT(claray_scene_approximations_create(scene, &approximations) == CLARAY_OK);
    EXPECT(claray_lines_count(approximations) > 0);
    EXPECT(claray_scene_warnings_create(scene, &warnings) == CLARAY_OK && claray_lines_count(warnings) == 0);
    claray_lines_release(warnings), warnings = NULL;
    /* A ball that shines. */
    const float ball[4] = {0, 0, 1, 0.5f};
    const uint32_t lamp = 1;
    STRUCT(claray_primitive_set, set);
    STRUCT(claray_primitive_set, read);
    set.kind = "spheres", set.points = ball, set.point_count = 1, set.materials = &lamp, set.name = "ball";
    EXPECT(claray_scene_add_primitives(scene, &set) == CLARAY_OK);
    EXPECT(claray_scene_primitives_get(scene, 0, &read) == CLARAY_OK && strcmp(read.kind, "spheres") == 0);
    EXPECT(read.point_count == 1 && read.points[3] == 0.5f && read.materials[0] == 1 && strcmp(read.name, "ball") == 0);
    EXPECT(claray_scene_warnings_create(scene, &warnings) == CLARAY_OK && claray_lines_count(warnings) == 1);
    EXPECT(claray_scene_truncate(scene, CLARAY_PRIMITIVE_SETS, 0) == CLARAY_OK);
    claray_lines_release(effects), claray_lines_release(causes), claray_lines_release(approximations);
    claray_lines_release(warnings), claray_scene_release(without);
}

static void write_text(const char* path, const char* text) {
    FILE* file = fopen(path, "w");
    EXPECT(file != NULL && fputs(text, file) >= 0);
    if (file) fclose(file);
}

/* A file whose material library is missing; the scene is loaded, with a warning. */
static void test_loading(void) {
    claray_lines* warnings = NULL;
    claray_scene* scene = NULL;
    double seconds = 0;
    STRUCT(claray_load_options, options);
    write_text("capi_scene.obj", "mtllib nowhere.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl wood\nf 1 2 3\n");
    EXPECT(claray_scene_options_load("capi_scene.obj", NULL, &warnings, &scene) == CLARAY_OK);
    EXPECT(claray_scene_triangle_count(scene) == 1 && claray_lines_count(warnings) > 0);
    EXPECT(strstr(claray_lines_at(warnings, 0), "nowhere.mtl") != NULL);
    EXPECT(claray_animation_seconds("capi_scene.obj", NULL, &seconds) == CLARAY_OK && seconds == -1);
    claray_lines_release(warnings), claray_scene_release(scene), scene = NULL;
    options.variant = "blue";
    EXPECT_ERROR(claray_scene_options_load("capi_scene.obj", &options, NULL, &scene), CLARAY_ERROR_USAGE, "variant");
    EXPECT(scene == NULL);
    remove("capi_scene.obj");
    EXPECT_ERROR(claray_scene_options_load(NULL, NULL, NULL, &scene), CLARAY_ERROR_USAGE, "name_or_path is NULL");
}

void test_scenes(claray_device* device) {
    (void)device;
    claray_scene* scene = lit_floor();
    test_lists_of_scene();
    test_mesh(scene);
    test_placements(scene);
    test_materials(scene);
    test_lights(scene);
    test_cameras(scene);
    test_textures(scene);
    test_effects_of_scene(scene);
    test_loading();
    claray_scene_release(scene);
}
