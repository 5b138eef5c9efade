// Example 8: effects. A contact sheet of built-in scenes, one for every effect that claray knows and one that calls for
// all of them. Each render would compile kernels for just its scene; here all share the generic ones, which know every
// effect, so that the sheet is quickly there. What is in which picture is printed.
//   example_08_effects [OUTPUT.png [SPP [WIDTH]]]      WIDTH of one picture in pixels
#include <algorithm>
#include <claray/claray.hpp>
#include <claray/io.hpp>
#include <cstdio>
#include <cstdlib>

namespace {

constexpr unsigned columns = 6, gap = 4;

/// Copies a picture to column `i % columns`, row `i / columns` of the sheet.
void place(claray::Image& sheet, const claray::Image& picture, unsigned i) {
    const unsigned left = gap + (i % columns) * (picture.width + gap),
                   top = gap + (i / columns) * (picture.height + gap);
    for (unsigned y = 0; y < picture.height; ++y)
        for (unsigned x = 0; x < picture.width; ++x)
            sheet.pixels[std::size_t(top + y) * sheet.width + left + x] =
                picture.pixels[std::size_t(y) * picture.width + x];
}

}  // namespace

int main(int argc, char** argv) try {
    const char* output = argc > 1 ? argv[1] : "effects.png";
    claray::RenderConfig config;
    config.spp = argc > 2 ? unsigned(std::max(1, std::atoi(argv[2]))) : 64;
    config.width = argc > 3 ? unsigned(std::clamp(std::atoi(argv[3]), 2, 2048)) : 240;
    claray::check_writable(output);  // before time is spent
    config.height = config.width * 3 / 4;
    config.effects.add = claray::full_effects();

    std::vector<std::string> names;
    for (const claray::Effect effect : claray::all_effects())
        names.push_back(std::string("effect:") + claray::name_of(effect));
    names.emplace_back("effects");

    const unsigned rows = (unsigned(names.size()) + columns - 1) / columns;
    claray::Image sheet{columns * (config.width + gap) + gap, rows * (config.height + gap) + gap, {}};
    sheet.pixels.assign(std::size_t(sheet.width) * sheet.height, glm::vec3(1.f));
    const claray::Device device = claray::Device::open();
    for (unsigned i = 0; i < names.size(); ++i) {
        claray::Renderer renderer(device, claray::builtin_scene(names[i]).value(), config);
        renderer.render();
        place(sheet, {config.width, config.height, renderer.image()}, i);
        std::printf("row %u, column %u: %-26s %s\n", i / columns + 1, i % columns + 1, names[i].c_str(),
                    to_string(renderer.statistics().effects).c_str());
    }
    claray::write_image(output, sheet);
    std::printf("the sheet is %s\n", output);
    return 0;
} catch (const claray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
