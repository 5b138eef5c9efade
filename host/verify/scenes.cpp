#include "host/verify/scenes.hpp"

#include <bit>

namespace claray::verify {

void render(Renderer& renderer) {
    renderer.render();
    const std::uint64_t dropped = renderer.statistics().dropped_samples;
    if (dropped != 0)
        throw Error(ErrorKind::device, std::to_string(dropped) + " samples of a render are not finite", {});
}

std::vector<glm::vec3> render(const Run& run, const Scene& scene, const RenderConfig& config) {
    Renderer renderer(run.device(), scene, config);
    render(renderer);
    return renderer.image();
}

std::vector<float> numbers_of(const Aovs& aovs) {
    std::vector<float> all = aovs.depth;
    const auto add_numbers = [&](const std::vector<std::uint32_t>& numbers) {
        for (const std::uint32_t number : numbers) all.push_back(std::bit_cast<float>(number));
    };
    add_numbers(aovs.primitive), add_numbers(aovs.material);
    for (const std::vector<glm::vec3>* vectors : {&aovs.normal, &aovs.albedo})
        for (const glm::vec3& v : *vectors) all.insert(all.end(), {v.x, v.y, v.z});
    return all;
}

double mean_of(const std::vector<glm::vec3>& image) {
    double sum = 0;
    for (const glm::vec3& pixel : image) sum += pixel.x;
    return sum / double(image.size());
}

Material grey(float albedo, float radiance) {
    Material m;
    m.albedo = glm::vec3(albedo), m.emission = glm::vec3(radiance);
    return m;
}

Mesh square(float half, float y, std::uint32_t material) {
    Mesh mesh;
    mesh.positions = {{-half, y, half}, {half, y, half}, {half, y, -half}, {-half, y, -half}};
    mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.materials = {material, material};
    return mesh;
}

Camera narrow_camera(const glm::vec3& position, const glm::vec3& target) {
    Camera camera;
    camera.position = position, camera.target = target, camera.vertical_fov = 0.01f;
    const glm::vec3 view = glm::abs(target - position);
    if (view.y > 0.9f * glm::length(view)) camera.up = {0.f, 0.f, 1.f};
    return camera;
}

namespace {

Form followed_by_one_kernel(const char* name, unsigned most_bounces, unsigned last) {
    return {name,
            {{"render/trace_paths", "MOST_EFFECTS", 64},
             {"render/trace_paths", "MOST_BOUNCES_PERMILLE", most_bounces},
             {"render/trace_paths", "MOST_PATHS_PER_UNIT", 1'048'576},
             {"render/trace_paths", "PATIENCE_MILLISECONDS", 0},
             {"render/finish_paths", "MOST_PATHS_PER_UNIT", last}}};
}

}  // namespace

Form whole_paths() { return followed_by_one_kernel("whole paths", 100'000, 0); }
Form last_paths() { return followed_by_one_kernel("last paths", 0, 65'536); }

}  // namespace claray::verify
