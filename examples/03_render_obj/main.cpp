// Example 3: render an OBJ file. Without one it writes a small one first: a table with a lamp above it.
//   example_03_render_obj [SCENE.obj [OUTPUT.png]]
#include <claray/io.hpp>
#include <claray/renderer.hpp>
#include <cstdio>

namespace {

const char* table_mtl = R"(
newmtl wood
Kd 0.55 0.32 0.15
newmtl wall
Kd 0.7 0.7 0.72
newmtl lamp
Kd 0 0 0
Ke 18 16 13
)";

// A floor, a table top, four legs as crossed quads, and a lamp. Faces may be polygons, and indices may count backwards.
const char* table_obj = R"(
mtllib table.mtl
v -4 0 -4
v  4 0 -4
v  4 0  4
v -4 0  4
usemtl wall
f -4 -1 -2 -3
v -1.0 1.0 -0.7
v  1.0 1.0 -0.7
v  1.0 1.0  0.7
v -1.0 1.0  0.7
v -1.0 0.9 -0.7
v  1.0 0.9 -0.7
v  1.0 0.9  0.7
v -1.0 0.9  0.7
usemtl wood
f 5 8 7 6
f 9 10 11 12
f 5 6 10 9
f 7 8 12 11
f 6 7 11 10
f 8 5 9 12
v -0.88 0 -0.5
v -0.72 0 -0.5
v -0.72 0.9 -0.5
v -0.88 0.9 -0.5
f -4 -3 -2 -1
v -0.8 0 -0.58
v -0.8 0 -0.42
v -0.8 0.9 -0.42
v -0.8 0.9 -0.58
f -4 -3 -2 -1
v -0.88 0 0.5
v -0.72 0 0.5
v -0.72 0.9 0.5
v -0.88 0.9 0.5
f -4 -3 -2 -1
v -0.8 0 0.42
v -0.8 0 0.58
v -0.8 0.9 0.58
v -0.8 0.9 0.42
f -4 -3 -2 -1
v 0.72 0 -0.5
v 0.88 0 -0.5
v 0.88 0.9 -0.5
v 0.72 0.9 -0.5
f -4 -3 -2 -1
v 0.8 0 -0.58
v 0.8 0 -0.42
v 0.8 0.9 -0.42
v 0.8 0.9 -0.58
f -4 -3 -2 -1
v 0.72 0 0.5
v 0.88 0 0.5
v 0.88 0.9 0.5
v 0.72 0.9 0.5
f -4 -3 -2 -1
v 0.8 0 0.42
v 0.8 0 0.58
v 0.8 0.9 0.58
v 0.8 0.9 0.42
f -4 -3 -2 -1
v -0.6 3.0 -0.6
v  0.6 3.0 -0.6
v  0.6 3.0  0.6
v -0.6 3.0  0.6
usemtl lamp
f -4 -3 -2 -1
)";

}  // namespace

int main(int argc, char** argv) try {
    std::string input = argc > 1 ? argv[1] : "table.obj";
    const std::string output = argc > 2 ? argv[2] : "table.png";
    if (argc <= 1) {
        claray::write_file("table.mtl", table_mtl);
        claray::write_file("table.obj", table_obj);
    }

    claray::check_writable(output);  // before time is spent
    claray::Warnings warnings;
    claray::Scene scene = claray::load_obj(input, warnings);
    for (const std::string& warning : warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
    if (scene.environment.images.empty())  // load_obj lights a scene without a lamp
        scene.sky = {glm::vec3(0.25f), glm::vec3(0.2f, 0.25f, 0.4f)};

    claray::RenderConfig config;
    config.width = 320, config.height = 240, config.spp = 64;
    const claray::Device device = claray::Device::open();
    claray::Renderer renderer(device, scene, config);
    const claray::RenderProgress done = renderer.render([](const claray::RenderProgress& progress) {
        std::printf("%u of %u samples a pixel\n", progress.spp, progress.spp_target);
        return true;  // false would stop here, with the image as it is
    });

    claray::write_image(output, {config.width, config.height, renderer.image()});
    std::printf("%s: %zu triangles, %u samples a pixel in %.2f s\n", output.c_str(), claray::triangle_count(scene),
                done.spp, done.seconds);
    return 0;
} catch (const claray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
