// The live view: commands, camera, pictures, scripts, the web page and the terminal.
#include "host/view/view.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include "claray/program.hpp"
#include "host/compute/memory.hpp"
#include "host/scene/placement.hpp"
#include "host/view/camera_control.hpp"
#include "host/view/input.hpp"
#include "host/view/script.hpp"
#include "host/view/terminal.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/process.hpp"
#include "tests/view/scenes.hpp"

namespace claray::test {
namespace {

using namespace view;

std::vector<std::uint8_t> pixels(View& view) {
    const Frame& frame = view.complete_frame();
    return {frame.pixels.begin(), frame.pixels.end()};
}
TEST(ViewCommand, RowsParseAndAreRefused) {
    for (const CommandRow& row : view_commands()) {
        std::string line = row.name;
        const std::vector<std::string> choices = choices_of(row);
        const std::string word = !row.word ? "" : choices.empty() ? "word" : choices.back();
        line += " " + word;
        for (unsigned i = 0; i < row.numbers; ++i) line += " " + std::to_string(i + 1) + ".5";
        const ViewCommand command = parse_command(line);
        EXPECT_EQ(command.name, row.name);
        EXPECT_EQ(command.word, word);
        ASSERT_EQ(command.numbers.size(), row.numbers);
        for (unsigned i = 0; i < row.numbers; ++i) EXPECT_EQ(command.numbers[i], float(i) + 1.5f);
        const std::string usage = std::string("write ") + row.name;
        if (!choices.empty()) {
            EXPECT_TRUE(
                throws_error(ErrorKind::user, usage, [&] { (void)parse_command(row.name + std::string(" x")); }));
        }
        EXPECT_TRUE(throws_error(ErrorKind::user, usage, [&] { (void)parse_command(line + " 1"); }));
        EXPECT_TRUE(throws_error(ErrorKind::user, usage, [&] { (void)parse_command(line + " nan"); }));
        if (row.numbers > 0 || row.word) {
            EXPECT_TRUE(throws_error(ErrorKind::user, usage, [&] { (void)parse_command(row.name); }));
        }
    }
    EXPECT_TRUE(throws_error(ErrorKind::user, "unknown command", [] { (void)parse_command("jump 1"); }));
}

TEST(CameraControl, MovesKeepWhatTheySay) {
    const Camera camera{{1, 2, 5}, {0, 1, 0}, {0, 1, 0}, 50.f};
    const auto distance = [](const Camera& c) { return glm::length(c.position - c.target); };
    const auto near = [](const glm::vec3& a, const glm::vec3& b) { return glm::length(a - b) < 1e-5f; };
    const Camera round = orbit(camera, 70, 20);
    EXPECT_NEAR(distance(round), distance(camera), 1e-5);
    EXPECT_EQ(round.target, camera.target);
    EXPECT_FALSE(near(round.position, camera.position));
    EXPECT_TRUE(near(orbit(camera, 360, 0).position, camera.position));
    const glm::vec3 above = glm::normalize(orbit(camera, 0, 500).position - camera.target);
    EXPECT_NEAR(std::acos(above.y), glm::radians(1.f), 1e-4);
    EXPECT_EQ(turn(camera, 30, 10).position, camera.position);
    EXPECT_NEAR(distance(turn(camera, 30, 10)), distance(camera), 1e-5);
    for (const Camera& c : {pan(camera, 0.2f, 0.1f), fly(camera, 1, 2, 3)})
        EXPECT_TRUE(near(c.target - c.position, camera.target - camera.position));
    EXPECT_NEAR(distance(zoom(camera, 2)), 0.5 * distance(camera), 1e-5);
    EXPECT_TRUE(throws_error(ErrorKind::user, "factor", [&] { (void)zoom(camera, 0); }));
    Camera parallel = camera;
    parallel.projection = Projection::orthographic, parallel.orthographic_height = 1e-30f;
    EXPECT_TRUE(throws_error(ErrorKind::user, "height", [&] { (void)zoom(parallel, 1e30f); }));
}

TEST(CameraControl, WaysAlongTheImageAreInItsHeights) {
    const Camera camera{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 90.f};  // at the origin the image is 10 high
    const glm::vec3 there = along_image(camera, {1, -2, 0}, 0.25f, 0.5f),
                    nearer = along_image(camera, {0, 0, 4}, 0.25f, 0.5f);
    EXPECT_LT(glm::distance(there, glm::vec3(2.5f, 5, 0)), 1e-5f);
    EXPECT_LT(glm::distance(nearer, glm::vec3(0.5f, 1, 0)), 1e-5f);
}

TEST(CameraControl, PointsLieOnTheFloor) {
    Scene scene = two_spheres();
    scene.camera->orthographic_height = 6.f;
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        scene.camera->projection = projection;
        const Aovs aovs = Renderer(device(), scene, small_view.render).aovs();
        const CameraData data = camera_data(*scene.camera, 1.5f);
        unsigned floor = 0;
        for (unsigned i = 0; i < 24 * 16; ++i)
            if (aovs.primitive[i] < 2) {
                ++floor;
                EXPECT_NEAR(point_through(data, i % 24, i / 24, 24, 16, aovs.depth[i]).y, -1.f, 1e-4);
            }
        EXPECT_GT(floor, 20u);
    }
}

TEST(View, IsTheRenderersPicture) {
    View view(device(), two_spheres(), small_view);
    const auto first = pixels(view);
    EXPECT_EQ(first, rendered(two_spheres()));
    run(view, "pause"), run(view, "orbit 30 10");
    const Frame& paused = view.next_frame();
    EXPECT_TRUE(paused.complete);
    EXPECT_GT(paused.spp, 0u);
    run(view, "pause");
    EXPECT_NE(pixels(view), first);
    run(view, "home");
    EXPECT_EQ(pixels(view), first);
    for (const char* name : {"depth", "normal", "albedo", "primitive", "heat"}) {
        run(view, std::string("show ") + name);
        EXPECT_NE(pixels(view), first) << name;
    }
    run(view, "show image"), run(view, "resize 12 10");
    RenderConfig smaller = small_view.render;
    smaller.width = 12, smaller.height = 10;
    EXPECT_EQ(pixels(view), rendered(two_spheres(), smaller));
}

/// What drivers do at the first run of a kernel delays no answer.
TEST(View, HasAPictureBeforeTheFirstCommand) {
    const auto pictures = [] {
        const auto all = device().profiler().summary();
        return all.contains("tone_map") ? all.at("tone_map").count : 0;
    };
    const auto before = pictures();
    View view(device(), two_spheres(), small_view);
    EXPECT_EQ(pictures(), before + 1);
    EXPECT_GE(view.next_frame().spp, 1u);
    EXPECT_EQ(pixels(view), rendered(two_spheres()));
}

TEST(View, TellsPrimitivesButSelectsNone) {
    Scene scene = two_spheres();
    scene.primitives.emplace_back().points = {{0, 0, 0, 5}};
    View view(device(), scene, small_view);
    EXPECT_NE(run(view, "pick 16 8").find("primitive 0, which cannot be changed"), std::string::npos);
    EXPECT_TRUE(throws_error(ErrorKind::user, "nothing is selected", [&] { run(view, "material albedo 1 0 0"); }));
}

TEST(View, EditsAreThoseOfAFreshRenderer) {
    View view(device(), two_spheres(), small_view);
    const auto first = pixels(view);
    const std::string picked = run(view, "pick 16 8");
    EXPECT_NE(picked.find("mesh 'ball'"), std::string::npos) << picked;
    EXPECT_NE(picked.find("material 'red' (lambert)"), std::string::npos) << picked;
    for (const char* bad :
         {"material albedo -1 0 0", "material glow 1 0 0", "light 7 0 0 0", "aperture -1", "resize 0 4", "time 1",
          "tone x", "show x", "pick 99 0", "zoom -1", "zoom 1e-39", "fly 1e38 0 0", "play"})
        EXPECT_TRUE(throws_error(ErrorKind::user, "", [&] { run(view, bad); })) << bad;
    EXPECT_EQ(pixels(view), first);
    const unsigned compiled = compile_statistics().compiled;
    run(view, "material albedo 0.1 0.9 0.2"), run(view, "move 0 1 0"), run(view, "light 0 1 0 0");
    const auto edited = pixels(view);
    EXPECT_EQ(compile_statistics().compiled, compiled);
    Scene changed = two_spheres();
    changed.materials[1].albedo = {0.1f, 0.9f, 0.2f};
    changed.instances[2].transform[3].y += 1, changed.lights[0].position.x += 1;
    EXPECT_EQ(edited, rendered(changed));
}

TEST(View, MovesWhatNoInstancePlaces) {
    Scene scene = two_spheres();
    scene.meshes.push_back(transformed(scene.meshes[1], scene.instances[2].transform));
    scene.meshes[1] = transformed(scene.meshes[1], scene.instances[1].transform);
    scene.instances.clear();
    View view(device(), scene, small_view);
    EXPECT_EQ(pixels(view), rendered(scene));
    ASSERT_NE(run(view, "pick 16 8").find("mesh 'ball'"), std::string::npos);
    run(view, "move 0 1 0");
    scene.instances = {{0}, {1}, {2}};
    scene.instances[2].transform[3].y = 1;
    EXPECT_EQ(pixels(view), rendered(scene));
}

TEST(View, MovesAllPartsOfAnObject) {
    Scene scene = two_spheres();
    scene.instances = {{0}, {1}, {1}, {1}};
    scene.instances[1].transform[3].x = -2, scene.instances[1].name = "pair";
    scene.instances[2].transform[3].x = 2, scene.instances[2].name = "pair";
    scene.instances[3].transform[3].x = 2, scene.instances[3].name = "pair";
    View view(device(), scene, small_view);
    const std::string picked = run(view, "pick 16 8");
    EXPECT_TRUE(picked.starts_with("object 'pair', mesh 'ball'")) << picked;
    run(view, "move 0 1 0");
    scene.instances[2].transform[3].y = scene.instances[3].transform[3].y = 1;
    EXPECT_EQ(pixels(view), rendered(scene)) << "the part at another place is another object";
}

/// Round its own middle, which is not the origin of its mesh.
TEST(View, TurnsAndScalesAnObjectRoundItsMiddle) {
    Scene scene = two_spheres();
    for (glm::vec3& position : scene.meshes[1].positions) position += glm::vec3(0.5f, 0, 0);
    const glm::vec3 middle = bounds_of(scene.meshes[1]).center();
    View view(device(), scene, small_view);
    run(view, "object 2");
    ASSERT_TRUE(view.state().pivot);
    EXPECT_LT(glm::distance(*view.state().pivot, middle + glm::vec3(2, 0, 0)), 1e-5f);
    for (const char* bad : {"object 3", "object -1", "scale 1 0 1", "rotate 0 0 0 10", "edit 2"})
        EXPECT_TRUE(throws_error(ErrorKind::user, "", [&] { run(view, bad); })) << bad;
    run(view, "scale 1 2 0.5");
    run(view, "rotate 0 0 2 90");
    EXPECT_LT(glm::distance(*view.state().pivot, middle + glm::vec3(2, 0, 0)), 1e-5f);
    const glm::mat4& transform = view.scene().instances[2].transform;
    const auto moved = [&](const glm::vec3& from_middle) {
        return glm::vec3(transform * glm::vec4(middle + from_middle, 1)) - middle - glm::vec3(2, 0, 0);
    };
    EXPECT_LT(glm::distance(moved({1, 0, 0}), glm::vec3(0, 1, 0)), 1e-5f);
    EXPECT_LT(glm::distance(moved({0, 1, 0}), glm::vec3(-2, 0, 0)), 1e-5f);
    EXPECT_LT(glm::distance(moved({0, 0, 1}), glm::vec3(0, 0, 0.5f)), 1e-5f);
    EXPECT_EQ(pixels(view), rendered(view.scene()));
}

TEST(View, ChangesAreUndoneAndMadeAgain) {
    View view(device(), two_spheres(), small_view);
    const auto first = pixels(view);
    EXPECT_EQ(run(view, "undo"), "nothing to undo");
    run(view, "object 2"), run(view, "move 0 1 0");
    const auto moved = pixels(view);
    run(view, "material albedo 0.1 0.9 0.2");
    run(view, "select 0"), run(view, "lamp intensity 60 60 60");
    const auto last = pixels(view);
    EXPECT_NE(last, moved);
    run(view, "undo"), run(view, "undo");
    EXPECT_EQ(pixels(view), moved);
    run(view, "undo");
    EXPECT_EQ(pixels(view), first);
    EXPECT_EQ(run(view, "undo"), "nothing to undo");
    run(view, "redo"), run(view, "redo"), run(view, "redo");
    EXPECT_EQ(pixels(view), last);
    EXPECT_EQ(run(view, "redo"), "nothing to redo");
    run(view, "undo"), run(view, "lamp intensity 10 10 10");
    EXPECT_EQ(run(view, "redo"), "nothing to redo") << "another change was made";
}

TEST(View, WhatIsHeldIsOneStep) {
    View view(device(), two_spheres(), small_view);
    const auto first = pixels(view);
    run(view, "object 1"), run(view, "hold on");
    run(view, "material roughness 0.1 0 0"), run(view, "material albedo 1 0 0"), run(view, "material albedo 0 1 0");
    run(view, "hold off");
    const auto held = pixels(view);
    run(view, "move 0 0.5 0"), run(view, "move 0 0.5 0");
    EXPECT_EQ(view.history().to_undo(), 3u);
    run(view, "undo"), run(view, "undo");
    EXPECT_EQ(pixels(view), held);
    run(view, "undo");
    EXPECT_EQ(pixels(view), first);
}

TEST(View, OrbitsByItself) {
    View view(device(), two_spheres(), small_view);
    const Camera home = view.camera();
    run(view, "spin 90");
    (void)view.next_frame();
    EXPECT_NE(view.camera().position, home.position);
    EXPECT_EQ(view.camera().target, home.target);
    EXPECT_FALSE(view.next_frame().complete);
    run(view, "spin 0"), run(view, "look 0 1 8 0 0 0"), run(view, "fov 30");
    EXPECT_EQ(view.camera().position, home.position);
    EXPECT_EQ(view.camera().vertical_fov, 30.f);
    Scene scene = two_spheres();
    scene.camera->vertical_fov = 30;
    EXPECT_EQ(pixels(view), rendered(scene));
}

TEST(View, TellsHowTheNoiseFell) {
    ViewConfig config = small_view;
    config.render.spp = 64;
    View view(device(), two_spheres(), config);
    (void)view.complete_frame();
    const std::vector<CurvePoint> points = view.curve().points();
    ASSERT_FALSE(points.empty());
    EXPECT_EQ(points.back().spp, 64u);
    Renderer renderer(device(), view.scene(), config.render);
    EXPECT_NEAR(points.back().noise, renderer.render().noise, 1e-6);
    const unsigned before = view.state().run;
    run(view, "orbit 5 0");
    (void)view.next_frame();
    EXPECT_NE(view.state().run, before);
}

TEST(View, MeasuresEffectsWhileItGoesOn) {
    ViewConfig config = small_view;
    View view(device(), two_spheres(), config);
    EXPECT_TRUE(view.costs().explanation().effects.empty());
    run(view, "explain");
    EXPECT_TRUE(view.costs().is_running());
    run(view, "orbit 5 0");
    while (view.costs().is_running()) (void)view.next_frame();
    const std::vector<measure::ExplainedEffect>& effects = view.costs().explanation().effects;
    EXPECT_EQ(effects.size(), causes_of_effects(view.scene()).size());
    EXPECT_TRUE(std::any_of(effects.begin(), effects.end(), [](const auto& effect) { return !effect.fixed; }));
    run(view, "explain");  // and ends with the view
}

TEST(Curve, PointsAreApartOnALogarithmicAxis) {
    Curve curve;
    for (unsigned spp = 1; spp <= 1000; ++spp) curve.add(0.5, spp, spp == 1 ? 0 : 1 / std::sqrt(spp));
    EXPECT_EQ(curve.points().front().spp, 4u);
    EXPECT_EQ(curve.points().back().spp, 1000u);
    EXPECT_DOUBLE_EQ(curve.points().back().seconds, 500);
    EXPECT_LT(curve.points().size(), 60u);
    EXPECT_GT(curve.points().size(), 30u);
}

TEST(View, KeepsTheSizeThatFits) {
    View view(device(), two_spheres(), small_view);
    const auto first = pixels(view);
    for (const char* large : {"resize 16384 16384", "resize 8192 8192", "resize 16384 1025"})
        EXPECT_TRUE(throws_error(ErrorKind::user, "too many for a live view; use at most", [&] { run(view, large); }))
            << large;
    fail_allocation(device(), 1);
    EXPECT_TRUE(throws_error(ErrorKind::user, "the size is kept", [&] { run(view, "resize 64 48"); }));
    fail_allocation(device(), 0);
    EXPECT_EQ(pixels(view), first);
    EXPECT_EQ(view.frame().width, 24u);
}

TEST(View, FirstSamplesCanBeInterrupted) {
    ViewConfig config = small_view;
    config.render.width = config.render.height = 512, config.render.spp = 1;
    View view(device(), two_spheres(), config);
    const std::uint64_t first = view.next_frame().number;
    run(view, "orbit 20 0");
    const Frame& kept = view.next_frame([] { return true; });
    EXPECT_EQ(kept.number, first) << "no picture of a part of the pixels";
    EXPECT_FALSE(kept.complete);
    EXPECT_EQ(view.next_frame([] { return false; }).number, first + 1);
    EXPECT_EQ(view.next_frame([] { return true; }).number, first + 1) << "no better picture of what is changed next";
    Scene turned = two_spheres();
    turned.camera = view.camera();
    EXPECT_EQ(pixels(view), rendered(turned, config.render));
}

TEST(View, DragsWhatIsSelectedAlongTheImage) {
    View view(device(), two_spheres(), small_view);
    EXPECT_TRUE(throws_error(ErrorKind::user, "nothing is selected", [&] { run(view, "drag 0.1 0"); }));
    EXPECT_EQ(run(view, "next"), "light 0: point at 0 4 3");
    EXPECT_EQ(run(view, "next"), "light 0: point at 0 4 3") << "after the last one comes the first";
    EXPECT_TRUE(throws_error(ErrorKind::user, "there is no light 1", [&] { run(view, "select 1"); }));
    const glm::vec3 way = along_image(view.camera(), {0, 4, 3}, 0.25f, 0.5f);
    run(view, "drag 0.25 0.5");
    Scene changed = two_spheres();
    changed.lights[0].position += way;
    EXPECT_EQ(pixels(view), rendered(changed));
    ASSERT_NE(run(view, "pick 16 8").find("mesh 'ball'"), std::string::npos);
    run(view, "drag 0.25 0");
    EXPECT_NE(run(view, "pick 20 8").find("mesh 'ball'"), std::string::npos) << "a quarter of 16 pixels further right";
    EXPECT_EQ(run(view, "pick 14 8").find("mesh 'ball'"), std::string::npos);
}

TEST(View, DragsWhatWasMovedAsFarAsTheHand) {
    View view(device(), two_spheres(), small_view);
    ASSERT_NE(run(view, "pick 16 8").find("mesh 'ball'"), std::string::npos);
    run(view, "move 0 0 -4");
    ASSERT_NE(run(view, "pick 15 7").find("mesh 'ball'"), std::string::npos);
    run(view, "move 0 0 4"), run(view, "pick 16 8");
    run(view, "move 0 0 -4"), run(view, "drag 0 0.35");
    EXPECT_NE(run(view, "pick 15 1").find("mesh 'ball'"), std::string::npos)
        << "farther away, the same way along the image is a longer one in the scene";
}

TEST(View, DoesNotDragLightsWithoutAPlace) {
    Scene scene = two_spheres();
    scene.lights[0].kind = LightKind::directional;
    View view(device(), scene, small_view);
    EXPECT_EQ(run(view, "select 0"), "light 0: directional");
    EXPECT_TRUE(throws_error(ErrorKind::user, "has no place", [&] { run(view, "drag 0.1 0"); }));
}

TEST(View, ALostDeviceEndsItsLoop) {
    View view(device(), two_spheres(), small_view);
    (void)view.complete_frame();
    run(view, "orbit 5 0");
    fail_command(device(), 3);
    EXPECT_TRUE(throws_error(ErrorKind::device, "cannot run the kernel", [&] { (void)view.next_frame(); }));
    fail_command(device(), 0);
}

TEST(View, PickTellsTheEffectsOfASurface) {
    Scene scene = two_spheres();
    scene.meshes[1].normals = scene.meshes[1].positions;
    scene.materials[1].cull_back = true;
    scene.instances[2].transform_end = scene.instances[2].transform;
    scene.instances[2].transform_end->operator[](3).y += 0.1f;
    const auto effects_of_instance = [&](std::uint32_t i) {
        const std::uint32_t mesh = scene.instances[i].mesh, material = mesh;
        return parse_effects(
            effects_of_surface(scene, {.mesh = mesh, .material = material, .triangle = 1, .instance = i}));
    };
    const EffectSet ball = {Effect::lambert, Effect::smooth_normals, Effect::culling};
    EXPECT_EQ(effects_of_instance(0), EffectSet({Effect::lambert}));
    EXPECT_EQ(effects_of_instance(1), ball);
    EXPECT_EQ(effects_of_instance(2), ball | EffectSet({Effect::instances, Effect::instance_motion}));
}

TEST(ViewScript, WritesFramesAndNamesTheLine) {
    const TemporaryFolder folder;
    View view(device(), two_spheres(), small_view);
    const auto play = [&](const char* text) {
        return run_script(view, read_script(folder.file("s.txt", text)), folder.path(), [](const std::string&) {});
    };
    const ScriptReport report = play("# tour\n\nframes 2\norbit 9 0\nfinish\nsave last.png\nquit\nfinish\n");
    EXPECT_EQ(report.frame_seconds.size(), 2u);
    EXPECT_EQ(report.finish_seconds.size(), 1u) << "complete images take longer than frames";
    for (const char* name : {"frame-00001.png", "frame-00003.png", "last.png"})
        EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
    EXPECT_FALSE(std::filesystem::exists(folder / "frame-00004.png"));
    EXPECT_TRUE(throws_error(ErrorKind::user, "s.txt:2: ", [&] { play("save never.png\njump\n"); }));
    EXPECT_TRUE(throws_error(ErrorKind::user, "s.txt:1: ", [&] { play("light 7 0 0 0\nsave never.png\n"); }));
    EXPECT_FALSE(std::filesystem::exists(folder / "never.png"));
}

TEST(ViewScript, CommandsBeforeAFrameHaveOneAnswer) {
    const TemporaryFolder folder;
    View view(device(), two_spheres(), small_view);
    const Script script = read_script(folder.file("s.txt", "orbit 9 0\norbit 9 0\nframes 3\norbit 9 0\nframes 1\n"));
    const ScriptReport report = run_script(view, script, {}, [](const std::string&) {});
    EXPECT_EQ(report.frame_seconds.size(), 4u);
    EXPECT_EQ(report.answer_seconds.size(), 2u);
}

TEST(ViewTerminal, BlocksAndKeys) {
    const std::vector<std::uint8_t> two = {1, 2, 3, 255, 4, 5, 6, 255};
    EXPECT_NE(half_blocks({1, 2, two, 1, true}).find("38;2;1;2;3;48;2;4;5;6m\xe2\x96\x80"), std::string::npos);
    for (const KeyRow& row : key_rows()) EXPECT_NO_THROW((void)parse_command(command_of_key(row.key))) << row.key;
    EXPECT_EQ(command_of_key("z"), "");
    EXPECT_EQ(command_of_key(key_of_bytes("\x1b[C")), "orbit 5 0");
    EXPECT_EQ(command_of_key(key_of_bytes("w")), "fly 1 0 0");
}

/// Stands for standard input and output during its lifetime.
class Terminal {
public:
    Terminal() {
        winsize size{4, 6, 0, 0};
        if (::openpty(&program_, &terminal_, nullptr, nullptr, &size) != 0) throw std::runtime_error("no terminal");
        std::fflush(stdout);
        for (int i = 0; i < 2; ++i) before_[i] = ::dup(i), ::dup2(terminal_, i);
    }
    ~Terminal() {
        std::fflush(stdout);
        for (int i = 0; i < 2; ++i) ::dup2(before_[i], i), ::close(before_[i]);
        ::close(program_), ::close(terminal_);
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    [[nodiscard]] termios settings() const {
        termios settings{};
        ::tcgetattr(terminal_, &settings);
        return settings;
    }
    /// What was written to it so far.
    [[nodiscard]] std::string text() const {
        std::string text;
        char bytes[4096];
        for (pollfd written{program_, POLLIN, 0}; ::poll(&written, 1, 100) > 0;)
            text.append(bytes, std::size_t(std::max<ssize_t>(::read(program_, bytes, sizeof bytes), 0)));
        return text;
    }

private:
    int program_ = -1, terminal_ = -1, before_[2] = {-1, -1};
};

TEST(ViewTerminal, LeavesTheTerminalAsItWas) {
    View view(device(), two_spheres(), small_view);
    std::string text;
    termios before{}, during{}, after{};
    bool fails = false;
    {
        const Terminal terminal;
        before = terminal.settings();
        fails = throws_error(ErrorKind::device, "cannot run the kernel", [&] {
            run_in_terminal(view, [&] {
                during = terminal.settings();
                fail_command(device(), 2);
                return true;
            });
        });
        fail_command(device(), 0);
        text = terminal.text(), after = terminal.settings();
    }
    EXPECT_TRUE(fails);
    EXPECT_NE(during.c_lflag, before.c_lflag);
    EXPECT_EQ(after.c_lflag, before.c_lflag);
    EXPECT_EQ(after.c_cc[VMIN], before.c_cc[VMIN]);
    EXPECT_TRUE(text.starts_with("\x1b[?1049h")) << text;
    EXPECT_TRUE(text.ends_with("\x1b[?25h\x1b[?1049l")) << text;
}

}  // namespace
}  // namespace claray::test
