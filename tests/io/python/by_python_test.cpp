// Scenes of USD and Blender: what the processes that turn them into glTF may do. Programs of the shell stand in for
// Python.
#include <gtest/gtest.h>

#include "tests/io/expect_error.hpp"
#include "tests/io/gltf/gltf_builder.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;
using test::expect_error;
using test::ScopedEnvironment;

constexpr const char* extra =
    R"({"warnings": ["a curl is left out"], "sky": [1, 2, 3], "environment": null, "seconds": 2.5,)"
    R"( "suns": [{"direction": [0, -1, 0], "irradiance": [4, 5, 6], "angle": 0.25}]})";

class ByPython : public test::ReaderTest {
protected:
    /// In place of Python. Its arguments: -c SCRIPT FILE OUT.glb [SECONDS].
    [[nodiscard]] std::string python(const std::string& text) const {
        const fs::path path = folder.file("python", "#!/bin/sh\nout=\"$4\"\n" + text + "\n");
        fs::permissions(path, fs::perms::owner_all);
        return path.string();
    }
    /// One that writes a triangle, and `json` beside it.
    [[nodiscard]] std::string python_that_writes(const std::string& json) const {
        test::GltfBuilder builder;
        static_cast<void>(builder.triangle());
        static_cast<void>(folder.file("made.glb", builder.glb()));
        static_cast<void>(folder.file("made.json", json));
        return python("cp '" + (folder / "made.glb").string() + "' \"$out\"; cp '" + (folder / "made.json").string() +
                      "' \"${out%.glb}.json\"; echo \"$5\" > '" + (folder / "seconds").string() + "'");
    }
    [[nodiscard]] std::string usd() const { return folder.file("scene.usda", "#usda 1.0\n").string(); }
    void refuse(const std::string& file, const std::vector<std::string>& words) {
        expect_error(ErrorKind::user, words, [&] { static_cast<void>(load_scene(file, warnings)); });
    }
};

TEST_F(ByPython, SceneWithWhatGltfLacks) {
    const ScopedEnvironment variable("CLARAY_PYTHON", python_that_writes(extra));
    const Scene scene = load_scene(usd(), warnings, LoadOptions{.time = 1.5});
    EXPECT_EQ(triangle_count(scene), 1u);
    EXPECT_EQ(scene.sky.zenith, glm::vec3(1, 2, 3));
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].kind, LightKind::sun);
    EXPECT_EQ(scene.lights[0].intensity, glm::vec3(4, 5, 6));
    EXPECT_EQ(scene.lights[0].outer_angle, 0.25f);
    ASSERT_FALSE(warnings.empty());
    EXPECT_NE(warnings[0].find("scene.usda': a curl is left out"), std::string::npos) << warnings[0];
    EXPECT_EQ(test::read_file(folder / "seconds").substr(0, 3), "1.5");
    EXPECT_EQ(animation_seconds(usd()), 2.5);
}

/// By what the file begins with, and by its extension.
TEST_F(ByPython, FilesAreKnown) {
    const ScopedEnvironment variable("CLARAY_PYTHON", python_that_writes(extra));
    for (const char* begin : {"#usda 1.0\n", "PXR-USDC\1", "PK\3\4....scene.usdc"})
        EXPECT_EQ(triangle_count(load_scene(folder.file("file", begin).string(), warnings)), 1u) << begin;
}

TEST_F(ByPython, MissingPackagesAreNamed) {
    const ScopedEnvironment blender("CLARAY_BLENDER", "/nonexistent/blender");
    for (const std::string& interpreter : {python("exit 77"), std::string("/nonexistent/python")}) {
        const ScopedEnvironment variable("CLARAY_PYTHON", interpreter);
        refuse(usd(), {"scene.usda", "usd-core", "pip install claray usd-core"});
        refuse(folder.file("a.blend", "BLENDER-v500").string(), {"a.blend", "not installed", "pip install bpy"});
    }
}

TEST_F(ByPython, CrashesAndFaultsAreOneLine) {
    for (const auto& [program, words] : std::vector<std::pair<std::string, std::vector<std::string>>>{
             {"kill -SEGV $$", {"scene.usda", "crashed (signal 11)"}},
             {"echo first >&2; echo \"the last line\" >&2; exit 1", {"scene.usda", "says: the last line"}},
             {"exit 0", {"scene.usda", "wrote nothing"}},
             {": > \"$out\"; echo '[]' > \"${out%.glb}.json\"", {"scene.usda", "wrote no JSON"}},
             {": > \"$out\"; echo '{}' > \"${out%.glb}.json\"", {"scene.usda"}},
         }) {
        const ScopedEnvironment variable("CLARAY_PYTHON", python(program));
        refuse(usd(), words);
    }
    const ScopedEnvironment seconds("CLARAY_IMPORT_SECONDS", "0.1");
    const ScopedEnvironment variable("CLARAY_PYTHON", python("exec sleep 60"));
    refuse(usd(), {"scene.usda", "took more than", "CLARAY_IMPORT_SECONDS"});
}

TEST_F(ByPython, ExtraOfAnotherShapeIsAFault) {
    const ScopedEnvironment variable("CLARAY_PYTHON", python_that_writes(R"({"warnings": [], "sky": 1})"));
    refuse(usd(), {"scene.usda"});
}

/// Blender goes first, and Python's bpy where it is not installed.
TEST_F(ByPython, BlenderOrItsModule) {
    const ScopedEnvironment python_variable("CLARAY_PYTHON", python_that_writes(extra));
    const std::string file = folder.file("a.blend", "BLENDER-v500").string();
    {
        const ScopedEnvironment variable("CLARAY_BLENDER", "/nonexistent/blender");
        EXPECT_EQ(triangle_count(load_scene(file, warnings)), 1u);
        EXPECT_FALSE(animation_seconds(file).has_value()) << "the glTF that stands for it has none";
    }
    const fs::path blender = folder.file("blender", "#!/bin/sh\necho no >&2\nexit 1\n");
    fs::permissions(blender, fs::perms::owner_all);
    const ScopedEnvironment variable("CLARAY_BLENDER", blender.string());
    refuse(file, {"a.blend", "Blender says: no"});
}

}  // namespace
}  // namespace claray
