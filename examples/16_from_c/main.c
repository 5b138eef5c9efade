/* Example 16: a scene from arrays, rendered from C. A glass ball and a metal one on tiles, below a lamp and a sky.
 *     example_16_from_c [PICTURE [SPP]] */
#include <claray.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { width = 480, height = 270, around = 48, along = 24, vertices = around * (along + 1) };

static void check(claray_status status) {
    if (status == CLARAY_OK) return;
    fprintf(stderr, "%s\n", claray_last_error());
    exit(status);
}

/* Every struct of claray.h begins with its size. */
#define STRUCT(type, name) \
    type name = {0};       \
    name.struct_size = sizeof name

/* A unit sphere at (0, 1, 0): positions, which are the normals as well, and two triangles for each patch. */
static void add_sphere(claray_scene* scene, uint32_t material) {
    static float normals[3 * vertices], positions[3 * vertices];
    static uint32_t triangles[6 * around * along];
    const double pi = 3.14159265358979;
    uint32_t* next = triangles;
    for (uint32_t v = 0; v <= along; ++v)
        for (uint32_t u = 0; u < around; ++u) {
            const uint32_t a = v * around + u, right = v * around + (u + 1) % around;
            const double polar = pi * v / along, azimuth = 2 * pi * u / around;
            normals[3 * a] = (float)(sin(polar) * cos(azimuth));
            normals[3 * a + 1] = (float)cos(polar);
            normals[3 * a + 2] = (float)(-sin(polar) * sin(azimuth));
            for (int i = 0; i < 3; ++i) positions[3 * a + i] = normals[3 * a + i] + (i == 1 ? 1.f : 0.f);
            if (v == along) continue;
            const uint32_t patch[6] = {a, a + around, right, right, a + around, right + around};
            for (int i = 0; i < 6; ++i) *next++ = patch[i];
        }
    STRUCT(claray_mesh, mesh);
    mesh.vertices = positions, mesh.normals = normals, mesh.vertex_count = vertices;
    mesh.triangles = triangles, mesh.triangle_count = 2 * around * along;
    mesh.material = material;
    check(claray_scene_mesh_set(scene, claray_scene_count(scene, CLARAY_MESHES), &mesh));
}

static void add_square(claray_scene* scene, float size, float y, uint32_t material) {
    const float corners[12] = {-size, y, size, size, y, size, size, y, -size, -size, y, -size};
    const float uvs[8] = {0, 0, 4, 0, 4, 4, 0, 4};
    const uint32_t up[6] = {0, 1, 2, 0, 2, 3};
    STRUCT(claray_mesh, mesh);
    mesh.vertices = corners, mesh.uvs = uvs, mesh.vertex_count = 4;
    mesh.triangles = up, mesh.triangle_count = 2, mesh.material = material;
    check(claray_scene_mesh_set(scene, claray_scene_count(scene, CLARAY_MESHES), &mesh));
}

static void place(claray_scene* scene, uint32_t mesh, float x, float z) {
    STRUCT(claray_placement, placement);
    placement.mesh = mesh;
    placement.transform[0] = placement.transform[5] = placement.transform[10] = 1;
    placement.transform[3] = x, placement.transform[11] = z;
    check(claray_scene_placement_set(scene, claray_scene_count(scene, CLARAY_PLACEMENTS), &placement));
}

/* An _init function sets the members that are not 0 by default. */
static claray_material material_of(const char* name, const char* kind, float red, float green, float blue) {
    STRUCT(claray_material, material);
    check(claray_material_init(&material));
    material.name = name, material.kind = kind;
    material.albedo[0] = red, material.albedo[1] = green, material.albedo[2] = blue;
    return material;
}

static void add_materials(claray_scene* scene) {
    static const uint8_t tiles[12] = {200, 200, 200, 60, 70, 90, 60, 70, 90, 200, 200, 200};
    STRUCT(claray_texture, texture);
    texture.texels = tiles, texture.width = texture.height = 2, texture.channels = 3;
    texture.filter = CLARAY_FILTER_NEAREST;
    check(claray_scene_texture_set(scene, 0, &texture));
    claray_material material = material_of("tiles", "lambert", 1, 1, 1);
    material.albedo_map.texture = 0;
    check(claray_scene_material_set(scene, 0, &material));
    material = material_of("glass", "glass", 1, 1, 1);
    material.roughness = 0;
    check(claray_scene_material_set(scene, 1, &material));
    material = material_of("gold", "metal", 1, 0.78f, 0.34f);
    material.roughness = 0.2f;
    check(claray_scene_material_set(scene, 2, &material));
    material = material_of("lamp", "lambert", 0, 0, 0);
    for (int i = 0; i < 3; ++i) material.emission[i] = 14;
    check(claray_scene_material_set(scene, 3, &material));
}

static claray_scene* two_balls(void) {
    claray_scene* scene = NULL;
    STRUCT(claray_camera, camera);
    STRUCT(claray_sky, sky);
    check(claray_scene_create(&scene));
    add_materials(scene);
    add_square(scene, 6, 0, 0);
    add_sphere(scene, 1);
    add_sphere(scene, 2);
    add_square(scene, 1, 5, 3);
    place(scene, 0, 0, 0), place(scene, 1, -1.1f, 0.3f), place(scene, 2, 1.1f, -0.3f), place(scene, 3, 0, 1);
    check(claray_camera_init(&camera));
    camera.position[0] = 0.6f, camera.position[1] = 2.2f, camera.position[2] = 7, camera.target[1] = 0.9f;
    camera.vertical_fov = 34, camera.aperture_radius = 0.05f;
    check(claray_scene_camera_set(scene, &camera));
    sky.zenith[2] = 0.5f, sky.zenith[1] = 0.35f, sky.zenith[0] = 0.25f;
    for (int i = 0; i < 3; ++i) sky.horizon[i] = 0.6f;
    check(claray_scene_sky_set(scene, &sky));
    check(claray_scene_validate(scene));
    return scene;
}

static int tell(const claray_progress* progress, void* user) {
    fprintf((FILE*)user, "%u of %u samples per pixel, noise %.3f\n", progress->spp, progress->spp_target,
            progress->noise);
    return 1;
}

int main(int argc, char** argv) {
    static float image[3 * width * height];
    const char* picture = argc > 1 ? argv[1] : "balls.png";
    claray_device* device = NULL;
    claray_renderer* renderer = NULL;
    STRUCT(claray_render_config, config);
    STRUCT(claray_progress, reached);
    config.width = width, config.height = height;
    config.spp = argc > 2 ? (uint32_t)atoi(argv[2]) : 64;
    check(claray_check_writable(picture));
    check(claray_device_open(NULL, &device));
    claray_scene* scene = two_balls();
    check(claray_renderer_create(device, scene, &config, &renderer));
    check(claray_renderer_render(renderer, tell, stderr, &reached));
    check(claray_renderer_denoised(renderer, CLARAY_DENOISER_AUTOMATIC, image, 3 * width * height));
    check(claray_write_image(picture, image, width, height, NULL));
    printf("%s: %zu triangles, %u samples per pixel in %.1f s on %s\n", picture, claray_scene_triangle_count(scene),
           reached.spp, reached.seconds, claray_device_name(device));
    claray_renderer_release(renderer);
    claray_scene_release(scene);
    claray_device_release(device);
    return 0;
}
