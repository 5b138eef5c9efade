// Traces one ray at one triangle, writes one pixel and plans a render: needs the core library, its kernels and
// claray_io.
#include <claray/claray.hpp>
#include <claray/io.hpp>
#include <cstdio>

/// Targets of time and frame rate need no library but the core.
static bool plans(const claray::Device& device, const claray::Mesh& mesh) {
    claray::Scene scene;
    scene.meshes = {mesh};
    const claray::TargetPlan plan = claray::plan_render(device, scene, {.width = 8, .height = 8, .seconds = 0.1});
    try {
        (void)claray::render_frames(device, scene, plan.config, {.fps = 0});
    } catch (const claray::Error&) {  // no frames at that rate
        return plan.triangles == 1;
    }
    return false;
}

int main(int, char** argv) try {
    claray::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    const claray::Device device = claray::Device::open();
    const auto bvh = claray::Bvh::build(device, {&mesh, 1});
    const claray::Ray ray{0.25f, 0.5f, 2.f, 0.f, 0.f, 0.f, -1.f, 1e30f};
    const claray::Hit hit = claray::closest_hit(bvh, {&ray, 1})[0];
    claray::write_image(std::string(argv[0]) + ".pfm", {1, 1, {glm::vec3(hit.t)}});
    std::printf("primitive %u at distance %g\n", hit.primitive, double(hit.t));
    return hit.primitive == 0 && hit.t == 2.f && hit.u == 0.25f && hit.v == 0.5f && plans(device, mesh) ? 0 : 1;
} catch (const claray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
