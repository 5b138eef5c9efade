// Renderer::update: after every change, the image is that of a new renderer of the changed scene.
#include <gtest/gtest.h>

#include <functional>
#include <glm/gtc/matrix_transform.hpp>

#include "claray/program.hpp"
#include "host/bvh/bvh_state.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

constexpr SceneChanges everything = {true, true, true, true, true, true};
const RenderConfig small = {.width = 24, .height = 20, .spp = 4, .max_depth = 4};

glm::mat4 at(float x, float y, float z) { return glm::translate(glm::mat4(1.f), {x, y, z}); }

/// A floor, a sphere that is placed once, and three instances of a smooth sphere; lit by points.
Scene scene_of_all_kinds() {
    Scene scene;
    scene.materials = {lambert(0.6f), lambert(0.4f), material(MaterialKind::metal, 0.9f, 0.3f)};
    Mesh plain = sphere(2), smooth = sphere(2);
    smooth.normals = smooth.positions;
    plain.materials.assign(plain.triangles.size(), 1), smooth.materials.assign(smooth.triangles.size(), 2);
    scene.meshes = {square(4.f, -1.f), plain, smooth};
    scene.lights = {point_light({0, 3, 0}, glm::vec3(8)), point_light({2, 2, 2}, glm::vec3(1, 4, 2))};
    scene.sky = {glm::vec3(0.1f), glm::vec3(0.3f)};
    scene.camera = Camera{{0.5f, 2, 6}, {0, 0, 0}, {0, 1, 0}, 45.f};
    return scene;
}

Scene with_instances() {
    Scene scene = scene_of_all_kinds();
    scene.instances = {{0}, {1, at(-2, 0, 0)}};
    for (const float x : {0.f, 2.f, 3.f}) scene.instances.push_back({2, at(x, 0, -x)});
    return scene;
}

/// All instances are baked into one tree.
Scene with_baked_instances() {
    Scene scene = scene_of_all_kinds();
    scene.instances = {{0}, {1, at(-1.5f, 0, 0)}, {2, at(1.5f, 0, 0)}};
    return scene;
}

Scene with_lamp() {
    Scene scene = with_instances();
    scene.materials[1] = emitter(3.f);
    return scene;
}

struct Change {
    const char* name;
    std::function<Scene()> scene;
    SceneChanges changes;
    std::function<void(Scene&)> apply;
    bool compiles = false;  // kernels for other effects
};

void aim(Scene& scene) { scene.camera->position = {-3, 1, 5}, scene.camera->vertical_fov = 30.f; }
void open_lens(Scene& scene) { scene.camera->aperture_radius = 0.2f; }
void light_up(Scene& scene) {
    scene.lights[1].intensity = {0, 0, 9};
    scene.lights.push_back(point_light({-2, 3, 1}, glm::vec3(5)));
}
void add_spots(Scene& scene) {
    Light light;
    light.kind = LightKind::spot, light.range = 4.f;
    for (int i = 0; i < 40; ++i) light.position = {i % 7 - 3, 2, i / 7 - 3}, scene.lights.push_back(light);
}
void darken(Scene& scene) { scene.lights.clear(); }
void paint(Scene& scene) { scene.materials[0].albedo = {0.9f, 0.2f, 0.1f}, scene.materials[2].roughness = 0.6f; }
void glow(Scene& scene) { scene.materials[1].emission = glm::vec3(2, 1, 0); }
void dawn(Scene& scene) { scene.sky.horizon = {0.9f, 0.4f, 0.1f}; }
void shift(Scene& scene) { scene.instances.back().transform = at(1, 1, 1); }
void shift_baked(Scene& scene) { scene.instances[1].transform = glm::rotate(at(-1, 1, 0), 0.7f, {1, 0, 0}); }
void mirror(Scene& scene) { scene.instances[1].transform = glm::scale(at(-1, 1, 0), {1, -1, 1}); }
void shake(Scene& scene) { scene.instances.back().transform_end = at(1, 1, 1); }
void bend(Scene& scene) {
    for (glm::vec3& p : scene.meshes[2].positions) p.y *= 1.f + 0.3f * p.x;
    for (glm::vec3& n : scene.meshes[2].normals) n = glm::normalize(n + glm::vec3(0.2f, 0, 0));
}
void change_all(Scene& scene) { aim(scene), light_up(scene), paint(scene), dawn(scene), shift(scene), bend(scene); }

const Change changes[] = {
    {"Camera", scene_of_all_kinds, {.camera = true}, aim},
    {"Lens", scene_of_all_kinds, {.camera = true}, open_lens, true},
    {"Lights", scene_of_all_kinds, {.lights = true}, light_up},
    {"ManyLights", scene_of_all_kinds, {.lights = true}, add_spots, true},
    {"NoLights", scene_of_all_kinds, {.lights = true}, darken},
    {"LightsOfInstances", with_lamp, {.lights = true}, light_up},
    {"Materials", scene_of_all_kinds, {.materials = true}, paint},
    {"Emission", scene_of_all_kinds, {.materials = true}, glow, true},
    {"EmissionOfInstances", with_lamp, {.materials = true}, glow},
    {"Sky", scene_of_all_kinds, {.sky = true}, dawn},
    {"Instance", with_instances, {.instances = true}, shift},
    {"BakedInstance", with_baked_instances, {.instances = true}, shift_baked},
    {"BakedAmongInstances", with_instances, {.instances = true}, shift_baked},
    {"MirroredInstance", with_baked_instances, {.instances = true}, mirror},
    {"Motion", with_instances, {.instances = true}, shake, true},
    {"InstancesWithLamps", with_lamp, {.instances = true}, shift_baked},
    {"Vertices", scene_of_all_kinds, {.vertices = true}, bend},
    {"VerticesOfBaked", with_baked_instances, {.vertices = true}, bend},
    {"VerticesOfInstances", with_instances, {.vertices = true}, bend},
    {"Everything", with_instances, everything, change_all},
};

class Update : public testing::TestWithParam<Change> {
protected:
    static void SetUpTestSuite() { state_of(Bvh::build(device(), std::vector<Mesh>{square(1.f, 0.f)})).load_refit(); }
};

TEST_P(Update, IsARendererOfTheChangedScene) {
    const Change& change = GetParam();
    const Scene before = change.scene();
    Scene after = before;
    change.apply(after);
    Renderer fresh(device(), after, small);
    (void)fresh.render();

    Renderer renderer(device(), before, small);
    (void)renderer.render();
    (void)renderer.aovs();
    ASSERT_FALSE(same_bits(renderer.image(), fresh.image())) << "the change is not seen";
    for (int turn = 0; turn < 2; ++turn) {  // there and back
        const Scene& now = turn == 0 ? after : before;
        const CompileStatistics compiled = compile_statistics();
        renderer.update(now, change.changes);
        EXPECT_TRUE(change.compiles || compile_statistics().compiled == compiled.compiled);
        (void)renderer.render();
        Renderer other(device(), now, small);
        (void)other.render();
        EXPECT_TRUE(same_bits(renderer.image(), other.image())) << (turn == 0 ? "there" : "back");
        EXPECT_EQ(renderer.aovs().primitive, other.aovs().primitive);
        EXPECT_EQ(renderer.aovs().albedo, other.aovs().albedo);
    }
}

INSTANTIATE_TEST_SUITE_P(Changes, Update, testing::ValuesIn(changes),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(UpdateOfAScene, ThatDoesNotFitIsRefusedAndChangesNothing) {
    const Scene scene = with_instances();
    Renderer renderer(device(), scene, small);
    (void)renderer.render();
    const std::vector<glm::vec3> before = renderer.image();
    const auto refuses = [&](ErrorKind kind, const char* words, const std::function<void(Scene&)>& spoil) {
        Scene other = scene;
        other.camera->position.x += 1;
        spoil(other);
        EXPECT_TRUE(throws_error(kind, words, [&] { renderer.update(other, everything); }));
    };
    refuses(ErrorKind::usage, "instances instead of 5", [](Scene& s) { s.instances.pop_back(); });
    refuses(ErrorKind::usage, "materials instead of 3", [](Scene& s) { s.materials.push_back({}); });
    refuses(ErrorKind::usage, "vertices in mesh 1", [](Scene& s) { s.meshes[1].positions.emplace_back(0.f); });
    refuses(ErrorKind::user, "its intensity", [](Scene& s) { s.lights[0].intensity.x = -1; });
    refuses(ErrorKind::user, "cannot be inverted", [](Scene& s) { s.instances[2].transform[0][0] = 0; });
    (void)renderer.render();
    EXPECT_TRUE(same_bits(renderer.image(), before));
}

TEST(UpdateOfAScene, LoadsNothingAfterSettling) {
    const Device alone = Device::open(std::to_string(device().info().index));  // which has loaded nothing yet
    Scene scene = scene_of_all_kinds();
    Renderer renderer(alone, scene, small);
    renderer.settle();
    const auto loaded = [] { return compile_statistics().compiled + compile_statistics().from_cache; };
    const unsigned before = loaded();
    aim(scene), light_up(scene), paint(scene), dawn(scene), bend(scene);
    renderer.update(scene, {.camera = true, .lights = true, .materials = true, .sky = true, .vertices = true});
    (void)renderer.render();
    EXPECT_EQ(loaded(), before);
}

TEST(UpdateOfAScene, CanFollowAnAnimation) {
    Scene scene = with_instances();
    Renderer renderer(device(), scene, small);
    for (int frame = 0; frame < 6; ++frame) {
        scene.instances[3].transform = at(2, 0.2f * float(frame), -2);
        scene.lights[0].position.x = 0.1f * float(frame);
        renderer.update(scene, {.lights = true, .instances = true});
        (void)renderer.render();
    }
    Renderer last(device(), scene, small);
    (void)last.render();
    EXPECT_TRUE(same_bits(renderer.image(), last.image()));
}

TEST(Resize, MakesTheImageOfARendererOfThatSize) {
    const Scene scene = scene_of_all_kinds();
    RenderConfig config = small;
    Renderer renderer(device(), scene, config);
    (void)renderer.render();
    for (const auto& [width, height] :
         {std::pair(48u, 40u), std::pair(12u, 10u), std::pair(31u, 7u), std::pair(24u, 20u)}) {
        config.width = width, config.height = height;
        renderer.resize(width, height);
        renderer.settle();
        (void)renderer.render();
        Renderer other(device(), scene, config);
        (void)other.render();
        const std::vector<glm::vec3> image = renderer.image(), expected = other.image();
        ASSERT_EQ(image.size(), expected.size());
        EXPECT_TRUE(same_bits(image, expected)) << width;
        EXPECT_EQ(renderer.picture().size(), 4u * width * height);
        EXPECT_EQ(renderer.aovs().depth.size(), width * height);
        EXPECT_EQ(renderer.denoised(DenoiserKind::claray).size(), width * height);
    }
    EXPECT_TRUE(throws_error(ErrorKind::usage, "invalid image size", [&] { renderer.resize(0, 5); }));
}

}  // namespace
}  // namespace claray::test
