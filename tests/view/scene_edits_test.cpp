// Changes of a scene as text.
#include "host/view/edit/scene_edits.hpp"

#include <gtest/gtest.h>

#include "tests/support/errors.hpp"
#include "tests/view/scenes.hpp"

namespace claray::test {
namespace {

using namespace view;

TEST(SceneEdits, RepeatWhatAViewShows) {
    const RenderConfig config = small_view.render;
    View view(device(), two_spheres(), small_view);
    for (const char* line :
         {"object 1", "rotate 1 2 3 40", "scale 1 2 0.5", "move 0.1 0.2 0.3", "material roughness 0.45 0 0",
          "material albedo 0.1 0.7 0.3", "select 0", "lamp intensity 9 8 7", "drag 0.1 0.2"})
        (void)run(view, line);
    const std::vector<std::string> edits = view.edits();
    EXPECT_EQ(edits.size(), 5u) << testing::PrintToString(edits);
    Scene scene = two_spheres();
    for (const std::string& edit : edits) apply_edit(scene, edit);
    EXPECT_EQ(scene.materials[1].albedo, glm::vec3(0.1f, 0.7f, 0.3f));
    EXPECT_EQ(scene.instances[1].transform, view.scene().instances[1].transform);
    EXPECT_EQ(scene.lights[0].position, view.scene().lights[0].position);
    const Frame& frame = view.complete_frame();
    EXPECT_EQ(rendered(scene, config), std::vector<std::uint8_t>(frame.pixels.begin(), frame.pixels.end()));
    EXPECT_NE(rendered(two_spheres(), config), rendered(scene, config));
    for (int step = 0; step < 9; ++step) (void)run(view, "undo");
    EXPECT_TRUE(view.edits().empty()) << testing::PrintToString(view.edits());
}

TEST(SceneEdits, PlaceMeshesWithoutInstances) {
    Scene scene = two_spheres();
    scene.instances.clear();
    apply_edit(scene, "instance 1 transform 1 0 0 5 0 1 0 6 0 0 1 7");
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[1].mesh, 1u);
    EXPECT_EQ(scene.instances[1].transform[3], glm::vec4(5, 6, 7, 1));
    EXPECT_EQ(scene.instances[0].transform, glm::mat4(1));
    apply_edit(scene, "instance 1 transform_end 1 0 0 8 0 1 0 0 0 0 1 0");
    EXPECT_EQ(scene.instances[1].transform_end.value()[3].x, 8);
    EXPECT_TRUE(moves_instance("instance 1 transform"));
    EXPECT_FALSE(moves_instance("light 1 position 0 0 0"));
}

TEST(SceneEdits, ThatDoNotFitAreRefused) {
    for (const auto& [edit, why] :
         {std::pair("material 2 roughness 0.3", "there is no material 2; the scene has 2; count from 0"),
          std::pair("material -1 roughness 0.3", "it is no change of a scene"),
          std::pair("material 0 gloss 1", "unknown value 'gloss'; use albedo, "),
          std::pair("material 0 albedo 1 1", "albedo has 2 numbers; give 3"),
          std::pair("material 0 roughness", "roughness has 0 numbers; give 1"),
          std::pair("material 0 roughness x", "'x' is not a finite number"),
          std::pair("light 0 range inf", "'inf' is not a finite number"),
          std::pair("instance 0 transform 1 2 3", "transform has 3 numbers; give 12"),
          std::pair("instance 0 place 1", "use transform or transform_end"),
          std::pair("camera 0 fov 3", "unknown kind 'camera'; use material, light or instance"),
          std::pair("", "write KIND NUMBER NAME NUMBERS...")}) {
        Scene scene = two_spheres();
        EXPECT_TRUE(throws_error(ErrorKind::usage, "'" + std::string(edit) + "': ", [&] { apply_edit(scene, edit); }))
            << edit;
        EXPECT_TRUE(throws_error(ErrorKind::usage, why, [&] { apply_edit(scene, edit); })) << edit;
    }
}

}  // namespace
}  // namespace claray::test
