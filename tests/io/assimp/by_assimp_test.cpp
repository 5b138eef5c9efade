// Scenes of other programs, read by claray-import: what becomes of them, and how a reader that fails is told.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "host/base/process/process.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/io/gltf/gltf_builder.hpp"
#include "tests/io/image/encoded_images.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;
using test::expect_error;
using test::ScopedEnvironment;

const fs::path foreign_files = fs::path(CLARAY_SOURCE_DIR) / "tests/io/assimp/files";

void expect_at(const glm::vec3& a, const glm::vec3& b) {
    EXPECT_LT(glm::distance(a, b), 1e-5f) << a.x << ' ' << a.y << ' ' << a.z;
}

class ByAssimp : public test::ReaderTest {
protected:
    void SetUp() override {
        if (!fs::exists(fs::path(this_program()).parent_path() / "claray-import"))
            GTEST_SKIP() << "claray was built without libassimp-dev";
    }

    /// A copy, beside which images may stand.
    [[nodiscard]] std::string copy(const std::string& name, const std::string& as) const {
        return folder.file(as, test::read_file(foreign_files / name)).string();
    }
    [[nodiscard]] Scene load(const std::string& name, const LoadOptions& options = {}) {
        warnings.clear();
        return load_scene(copy(name, name), warnings, options);
    }
    /// A vertex in the world.
    [[nodiscard]] static glm::vec3 vertex(const Scene& scene, std::size_t instance, std::size_t i) {
        const MeshInstance& placed = scene.instances.at(instance);
        return glm::vec3(placed.transform * glm::vec4(scene.meshes.at(placed.mesh).positions.at(i), 1.f));
    }
    /// In place of claray-import.
    [[nodiscard]] std::string program(const std::string& text) const {
        const fs::path path = folder.file("program", "#!/bin/sh\n" + text + "\n");
        fs::permissions(path, fs::perms::owner_all);
        return path.string();
    }
    void refuse(const std::vector<std::string>& words) {
        expect_error(ErrorKind::user, words, [&] { static_cast<void>(load("square.off")); });
    }
};

/// Its unit is half a metre, and z points upwards.
TEST_F(ByAssimp, Collada) {
    static_cast<void>(folder.file("wood.png", test::from_base64(test::png_rgba)));  // C:\maps\Wood.png
    const Scene scene = load("two.dae");
    ASSERT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 2u);
    expect_at(vertex(scene, 0, 1), {0.5f, 0, 0});
    expect_at(vertex(scene, 0, 2), {0, 0.5f, 0});
    expect_at(vertex(scene, 1, 0), {0, 0, -3});
    EXPECT_EQ(scene.meshes[0].uvs.at(2), glm::vec2(0, 0.75f)) << "v counts from the top";

    const Material& paint = scene.materials.at(0);
    EXPECT_EQ(paint.name, "paint");
    EXPECT_TRUE(paint.kind == MaterialKind::principled && paint.albedo_map.used());
    EXPECT_EQ(paint.albedo, glm::vec3(1.f));
    EXPECT_FLOAT_EQ(paint.opacity, 0.75f);
    EXPECT_TRUE(paint.alpha_mode == AlphaMode::blend);
    EXPECT_FLOAT_EQ(paint.roughness, 0.5f) << "alpha^2 = 2 / (30 + 2)";
    EXPECT_FLOAT_EQ(paint.specular_weight, 0.5f);
    EXPECT_EQ(paint.specular_tint, glm::vec3(1, 0.5f, 0));
    EXPECT_FALSE(paint.cull_back);

    ASSERT_TRUE(scene.camera);
    expect_at(scene.camera->position, {0, 5, 0});
    expect_at(glm::normalize(scene.camera->target - scene.camera->position), {0, -1, 0});
    EXPECT_NEAR(scene.camera->vertical_fov, glm::degrees(2 * std::atan(std::tan(glm::radians(30.0)) / 2)), 1e-3);

    ASSERT_EQ(scene.lights.size(), 1u);
    const Light& lamp = scene.lights[0];
    expect_at(lamp.position, {0, 2, 0});
    expect_at(lamp.intensity, std::numbers::pi_v<float> * glm::vec3(1, 0.5f, 0.25f));
    expect_at(lamp.attenuation, {1, 4, 12});
}

TEST_F(ByAssimp, MissingImagesAreTold) {
    EXPECT_EQ(load("two.dae").materials.at(0).albedo, glm::vec3(0.5f));
    EXPECT_EQ(warned("Wood.png"), 1u);
}

TEST_F(ByAssimp, Animations) {
    const std::string path = copy("two.dae", "moves.dae");
    EXPECT_EQ(animation_seconds(path), 2.0);
    expect_at(vertex(load_scene(path, warnings, {.time = 1.0}), 0, 0), {1, 0, 0});
    expect_at(vertex(load_scene(path, warnings, {.time = 9.0}), 0, 0), {2, 0, 0});
    expect_error(ErrorKind::usage, {"moves.dae", "variant"},
                 [&] { static_cast<void>(load_scene(path, warnings, {.variant = "x"})); });
}

/// Its unit is 10 centimetres.
TEST_F(ByAssimp, Fbx) {
    const Scene scene = load("square.fbx", {.live = true});
    EXPECT_EQ(triangle_count(scene), 4u);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[1].name, "right");
    expect_at(vertex(scene, 0, 0), {-3, 0, 0});
    expect_at(vertex(scene, 1, 0), {3, 0, 0});
    expect_at(vertex(scene, 1, 1), {3, 4, 0});
    const Material& paint = scene.materials.at(0);
    expect_at(paint.albedo, {0.8f, 0.4f, 0.2f});
    expect_at(paint.emission, {0, 0, 3});
    EXPECT_FLOAT_EQ(paint.roughness, 0.5f);
    EXPECT_FLOAT_EQ(paint.metallic, 0.f);
}

/// 3ds Max aims cameras at a node of their own.
TEST_F(ByAssimp, FbxCameraWithTarget) {
    std::string text = test::read_file(foreign_files / "square.fbx");
    const auto insert = [&](const std::string& before, const std::string& what) {
        text.insert(text.find(before), what);
    };
    const auto model = [](const std::string& head, const std::string& place) {
        return "Model: " + head +
               " {\n Version: 232\n Properties70:  {\n  P: \"Lcl Translation\", \"Lcl Translation\", "
               "\"\", \"A\"," +
               place + "\n }\n}\n";
    };
    insert("\tMaterial: 300", "NodeAttribute: 400, \"NodeAttribute::eye\", \"Camera\" {\n TypeFlags: \"Camera\"\n}\n" +
                                  model("210, \"Model::eye\", \"Camera\"", "0,0,100") +
                                  model("211, \"Model::eye.Target\", \"Null\"", "0,40,70"));
    insert("\tC: \"OO\",200,0", "C: \"OO\",210,0\nC: \"OO\",211,0\nC: \"OO\",400,210\n");
    const Scene scene = load_scene(folder.file("aimed.fbx", text).string(), warnings);
    ASSERT_TRUE(scene.camera);
    expect_at(scene.camera->position, {0, 0, 10});
    expect_at(glm::normalize(scene.camera->target - scene.camera->position), {0, 0.8f, -0.6f});
}

TEST_F(ByAssimp, Autodesk3ds) {
    const Scene scene = load("square.3ds");
    EXPECT_EQ(triangle_count(scene), 2u);
    expect_at(scene.materials.at(0).albedo, {0.8f, 0.2f, 0.1f});
    const Bounds bounds = bounds_of(scene);
    expect_at(bounds.lo, {0, 0, -1});
    expect_at(bounds.hi, {1, 0, 0});
    ASSERT_EQ(scene.lights.size(), 1u);
    expect_at(scene.lights[0].position, {0, 5, 0});
}

TEST_F(ByAssimp, Off) {
    const Scene scene = load("square.off");
    EXPECT_EQ(triangle_count(scene), 3u);
    expect_at(bounds_of(scene).lo, {0, 0, -1});
    expect_at(bounds_of(scene).hi, {2, 2, 0});
}

TEST_F(ByAssimp, ContentTellsTheFormat) {
    for (const char* name : {"two.dae", "square.fbx", "square.3ds", "square.off"})
        EXPECT_EQ(triangle_count(load_scene(copy(name, "model"), warnings)), triangle_count(load(name))) << name;
}

/// What is cut off is a scene or an error in one line, which names the file.
TEST_F(ByAssimp, CutFiles) {
    for (const char* name : {"two.dae", "square.fbx", "square.3ds", "square.off"}) {
        const std::string bytes = test::read_file(foreign_files / name);
        expect_error(ErrorKind::user, {name}, [&] {
            static_cast<void>(load_scene(folder.file(name, bytes.substr(0, bytes.size() / 3)).string(), warnings));
        });
        expect_error(ErrorKind::user, {name},
                     [&] { static_cast<void>(load_scene(folder.file(name, "").string(), warnings)); });
    }
}

TEST_F(ByAssimp, ProgramIsMissing) {
    const ScopedEnvironment none("CLARAY_IMPORT", (folder / "none").string());
    refuse({"square.off'", "claray-import", "OFF", "not installed", "libassimp-dev"});
}

TEST_F(ByAssimp, ProgramDies) {
    const ScopedEnvironment dies("CLARAY_IMPORT", program("kill -SEGV $$"));
    refuse({"square.off'", "reader of OFF crashed (signal 11)", "glTF"});
}

TEST_F(ByAssimp, ProgramHangs) {
    const ScopedEnvironment hangs("CLARAY_IMPORT", program("exec sleep 1000")), seconds("CLARAY_IMPORT_SECONDS", "0.3");
    refuse({"square.off'", "took more than 0.3 s", "CLARAY_IMPORT_SECONDS"});
}

TEST_F(ByAssimp, ProgramSaysWhy) {
    const ScopedEnvironment refuses("CLARAY_IMPORT", program("printf 'no \\033[31mway\\nand more' >&2; exit 1"));
    refuse({"square.off'", "says: no ?[31mway;"});
}

/// The glTF of a broken reader is trusted no more than any other.
TEST_F(ByAssimp, ProgramWritesNonsense) {
    for (const char* text :
         {"echo nonsense", "printf 'glTF\\2\\0\\0\\0\\377\\377\\377\\377\\377\\377\\377\\177JSON'", "true"}) {
        const ScopedEnvironment writes("CLARAY_IMPORT", program(text));
        refuse({"square.off'"});
    }
}

TEST_F(ByAssimp, WarningsNameTheFile) {
    const std::string glb = (folder / "good.glb").string(), bytes = test::read_file(foreign_files / "square.off");
    const std::string importer = (fs::path(this_program()).parent_path() / "claray-import").string();
    const ScopedEnvironment warns("CLARAY_IMPORT",
                                  program("echo 'left out: bump maps (2)' >&2; exec " + importer + " \"$@\""));
    EXPECT_EQ(triangle_count(load("square.off")), 3u);
    EXPECT_EQ(warned("square.off': left out: bump maps (2)"), 1u);
}

TEST(RunProgram, KeepsWithinItsLimits) {
    const ProgramOutput endless = run_program({"/bin/cat", "/dev/zero"}, {60, 100'000});
    EXPECT_TRUE(endless.end == ProgramOutput::End::too_long);
    EXPECT_LT(endless.output.size(), 200'000u);
    const ProgramOutput both = run_program({"/bin/sh", "-c", "echo out; echo errors >&2; exit 3"}, {60, 100});
    EXPECT_TRUE(both.end == ProgramOutput::End::exited);
    EXPECT_EQ(both.code, 3);
    EXPECT_EQ(both.output, "out\n");
    EXPECT_EQ(both.errors, "errors\n");
    EXPECT_TRUE(run_program({"/bin/sh", "-c", "kill -9 $$"}, {60, 100}).end == ProgramOutput::End::killed);
    EXPECT_TRUE(run_program({"/none"}, {60, 100}).end == ProgramOutput::End::not_started);
    EXPECT_TRUE(run_program({"/bin/sleep", "1000"}, {0.1, 100}).end == ProgramOutput::End::too_slow);
}

}  // namespace
}  // namespace claray
