// A live view of your own, here in the terminal: the camera swings, a lamp's colour and an object change, and when all
// is still the image improves.
//     example_11_view [FRAMES [PICTURE]]
// claray view is the complete one. What it is made of: Renderer::update takes changes without a compilation,
// Renderer::picture makes 8-bit colours on the device, and a small image that is enlarged answers fast while things
// move.
#include <chrono>
#include <claray/claray.hpp>
#include <claray/io.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned width = 96, height = 54;  // pixels; a character shows two, one above the other

// Two rows of pixels as one line of half blocks in 24-bit colours.
std::string drawn(std::span<const std::uint8_t> picture) {
    std::string text = "\033[H";  // the cursor to the top left
    for (unsigned y = 0; y < height; y += 2) {
        for (unsigned x = 0; x < width; ++x) {
            const std::uint8_t *upper = &picture[4 * (y * width + x)], *lower = &picture[4 * ((y + 1) * width + x)];
            char cell[64];
            std::snprintf(cell, sizeof cell, "\033[38;2;%u;%u;%um\033[48;2;%u;%u;%um\u2580", upper[0], upper[1],
                          upper[2], lower[0], lower[1], lower[2]);
            text += cell;
        }
        text += "\033[0m\n";
    }
    return text;
}

// Where the scene is at a time, in seconds. Returns what has changed.
claray::SceneChanges move(claray::Scene& scene, const claray::Camera& first, float seconds) {
    scene.camera = claray::orbited(first, 20.f * std::sin(seconds));  // the box is open to one side
    scene.materials[1].albedo =
        0.5f + 0.4f * glm::vec3(std::sin(seconds), std::sin(seconds + 2), std::sin(seconds + 4));
    return {.camera = true, .materials = true};
}

}  // namespace

int main(int argc, char** argv) try {
    const unsigned frames = argc > 1 ? unsigned(std::atoi(argv[1])) : 120;
    const char* const picture = argc > 2 ? argv[2] : "view.png";

    claray::Scene scene = claray::builtin_scene("cornell").value();
    const claray::Camera first = claray::camera_of(scene, float(width) / float(height));
    const claray::Device device = claray::Device::open();
    claray::Renderer renderer(device, scene, {.width = width / 2, .height = height / 2, .spp = 256});
    renderer.settle();  // loads all kernels, so that no frame waits for a compiler

    double slowest = 0;
    for (unsigned i = 0; i < frames; ++i) {
        const Clock::time_point begin = Clock::now();
        renderer.update(scene, move(scene, first, float(i) / 30));
        renderer.restart(i, 4);  // other random numbers in each frame, 4 samples per pixel
        (void)renderer.render();
        const std::string text = drawn(renderer.picture({.width = width, .height = height}));
        std::fputs(text.c_str(), stdout);
        slowest = std::max(slowest, std::chrono::duration<double>(Clock::now() - begin).count());
    }

    renderer.resize(width, height);  // still: all pixels, all samples
    renderer.restart(0, 256);
    (void)renderer.render();
    std::fputs(drawn(renderer.picture()).c_str(), stdout);
    claray::write_image(picture, {width, height, renderer.image()});
    std::printf("%u frames, the slowest in %.1f ms; wrote %s\n", frames, 1e3 * slowest, picture);
} catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
}
