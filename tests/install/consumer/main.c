/* Traces one ray at one triangle by the C interface. */
#include <claray.h>
#include <stdio.h>

int main(void) {
    const float vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const unsigned triangles[] = {0, 1, 2};
    const claray_ray ray = {{0.25f, 0.5f, 2}, 0, {0, 0, -1}, 1e30f};
    claray_mesh mesh = {0};
    claray_device* device = NULL;
    claray_bvh* bvh = NULL;
    claray_hit hit = {0};
    mesh.struct_size = sizeof mesh;
    mesh.vertices = vertices, mesh.vertex_count = 3;
    mesh.triangles = triangles, mesh.triangle_count = 1;
    if (claray_device_open(NULL, &device) || claray_bvh_build(device, &mesh, NULL, &bvh) ||
        claray_closest_hit(bvh, &ray, 1, &hit)) {
        fprintf(stderr, "%s\n", claray_last_error());
        return 1;
    }
    printf("claray %s: primitive %u at distance %g\n", claray_version(), hit.primitive, (double)hit.t);
    claray_bvh_release(bvh);
    claray_device_release(device);
    return hit.primitive == 0 && hit.t == 2 ? 0 : 1;
}
