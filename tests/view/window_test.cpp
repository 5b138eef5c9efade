// The view in a window, on a video driver of SDL that needs no display.
#include "host/view/window/window.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "host/base/format.hpp"
#include "host/compute/memory.hpp"
#include "host/view/camera_control.hpp"
#include "tests/support/errors.hpp"
#include "tests/view/scenes.hpp"

#if CLARAY_WITH_WINDOW
#define SDL_MAIN_HANDLED
#include <SDL.h>
#endif

namespace claray::test {
namespace {

using namespace view;

#if CLARAY_WITH_WINDOW

/// Each step runs when the picture of the step before is complete.
class Hands {
public:
    explicit Hands(View& view) : view_(view) {}

    void show(const std::vector<std::function<void()>>& steps) {
        auto next = steps.begin();
        run_in_window(view_, [&] {
            if (next == steps.end()) return false;
            const std::string title = SDL_GetWindowTitle(window());
            if (title.find(": 4 spp ") != std::string::npos && SDL_HasEvents(SDL_FIRSTEVENT, SDL_LASTEVENT) == 0)
                (*next++)();
            return ++rounds_ < 2000;
        });
        EXPECT_TRUE(next == steps.end()) << next - steps.begin() << " steps were done";
    }

    static SDL_Window* window() {
        for (Uint32 id = 1; id < 100; ++id)
            if (SDL_Window* found = SDL_GetWindowFromID(id)) return found;
        return nullptr;
    }
    static std::string title() { return SDL_GetWindowTitle(window()); }

    static void push(
        SDL_EventType type, const std::function<void(SDL_Event&)>& set = [](SDL_Event&) {}) {
        SDL_Event event{};
        event.type = type;
        set(event);
        SDL_PushEvent(&event);
    }
    static void write(const char* text) {
        push(SDL_TEXTINPUT, [&](SDL_Event& e) { SDL_strlcpy(e.text.text, text, sizeof e.text.text); });
    }
    static void press(SDL_Keycode key) {
        push(SDL_KEYDOWN, [&](SDL_Event& e) { e.key.keysym.sym = key; });
    }
    static void button(SDL_EventType type, int x, int y, int clicks) {
        push(type, [&](SDL_Event& e) {
            e.button.button = SDL_BUTTON_LEFT, e.button.clicks = Uint8(clicks), e.button.x = x, e.button.y = y;
        });
    }
    static void click(int x, int y, int clicks) {
        button(SDL_MOUSEBUTTONDOWN, x, y, clicks), button(SDL_MOUSEBUTTONUP, x, y, clicks);
    }
    static void drag(int x, int y) {
        button(SDL_MOUSEBUTTONDOWN, 5, 5, 1);
        for (int i = 0; i < 2; ++i)
            push(SDL_MOUSEMOTION, [&](SDL_Event& e) {
                e.motion.state = SDL_BUTTON_LMASK, e.motion.xrel = x / 2, e.motion.yrel = y / 2;
            });
        button(SDL_MOUSEBUTTONUP, 5 + x, 5 + y, 1);
    }
    static void wheel(int steps) {
        push(SDL_MOUSEWHEEL, [&](SDL_Event& e) { e.wheel.y = steps; });
    }
    static void change_size(int width, int height) {
        push(SDL_WINDOWEVENT, [&](SDL_Event& e) {
            e.window.event = SDL_WINDOWEVENT_SIZE_CHANGED, e.window.data1 = width, e.window.data2 = height;
        });
    }

    /// What the window shows.
    static std::vector<std::uint8_t> pixels() {
        SDL_Surface* surface = SDL_GetWindowSurface(window());
        std::vector<std::uint8_t> bytes;
        for (int y = 0; y < surface->h; ++y)
            for (int x = 0; x < surface->w; ++x) {
                const auto* row = static_cast<const Uint8*>(surface->pixels) + y * surface->pitch;
                Uint32 pixel = 0;
                SDL_memcpy(&pixel, row + x * surface->format->BytesPerPixel, surface->format->BytesPerPixel);
                Uint8 red = 0, green = 0, blue = 0;
                SDL_GetRGB(pixel, surface->format, &red, &green, &blue);
                bytes.insert(bytes.end(), {red, green, blue, 255});
            }
        return bytes;
    }

private:
    View& view_;
    int rounds_ = 0;
};

Camera after(const Camera& camera, const std::string& line) {
    Scene scene = two_spheres();
    scene.camera = camera;
    View view(device(), scene, small_view);
    run(view, line);
    return view.camera();
}

class ViewWindow : public testing::Test {
protected:
    void SetUp() override { ::setenv("SDL_VIDEODRIVER", "dummy", 1); }
    void TearDown() override { ::unsetenv("SDL_VIDEODRIVER"); }
};

TEST_F(ViewWindow, ShowsThePictureAndFollowsItsSize) {
    View view(device(), two_spheres(), small_view);
    const auto size_is = [&](unsigned width, unsigned height) {
        const Frame& frame = view.next_frame();
        return frame.width == width && frame.height == height;
    };
    RenderConfig other = small_view.render;
    other.width = 20, other.height = 10;
    Hands(view).show({[&] {
                          EXPECT_EQ(Hands::pixels(), rendered(two_spheres()));
                          SDL_SetWindowSize(Hands::window(), 20, 10);
                      },
                      [&] {
                          EXPECT_TRUE(size_is(20, 10));
                          EXPECT_EQ(Hands::pixels(), rendered(two_spheres(), other));
                          Hands::change_size(0, 7);
                      },
                      [&] {
                          EXPECT_TRUE(size_is(20, 10));
                          EXPECT_EQ(Hands::title(), "claray view: 4 spp ");  // and no error
                      }});
}

TEST_F(ViewWindow, KeysAndTheMouseAreCommands) {
    View view(device(), two_spheres(), small_view);
    const Camera start = view.camera();
    std::vector<std::function<void()>> steps;
    const auto add = [&](const std::function<void()>& act, const std::string& command) {
        steps.emplace_back(act);
        steps.emplace_back([&view, start, command] {
            const Camera expected = after(start, command);
            EXPECT_LT(glm::length(view.camera().position - expected.position), 1e-5f) << command;
            EXPECT_LT(glm::length(view.camera().target - expected.target), 1e-5f) << command;
            run(view, "home");
            Hands::push(SDL_WINDOWEVENT, [](SDL_Event& e) { e.window.event = SDL_WINDOWEVENT_EXPOSED; });
        });
    };
    add([] { Hands::press(SDLK_RIGHT); }, "orbit 5 0");
    add([] { Hands::write("W"); }, "fly 1 0 0");
    add([] { Hands::wheel(1); }, "zoom 1.1");
    add([] { Hands::drag(10, -4); }, "orbit -4 -1.6");
    add([] { SDL_SetModState(KMOD_LSHIFT), Hands::drag(8, 4); }, "pan -0.5 0.25");
    add([] { SDL_SetModState(KMOD_NONE), Hands::click(16, 8, 2); }, "focus 16 8");
    steps.emplace_back([] { Hands::write("t"), SDL_SetModState(KMOD_LCTRL), Hands::drag(8, 4); });
    steps.emplace_back([&view] {
        SDL_SetModState(KMOD_NONE);
        const glm::vec3 way = along_image(view.camera(), {0, 4, 3}, 0.5f, -0.25f), at = glm::vec3(0, 4, 3) + way;
        EXPECT_EQ(run(view, "select 0"),
                  printed("light 0: point at %.6g %.6g %.6g", double(at.x), double(at.y), double(at.z)));
        Hands::write("c");
    });
    steps.emplace_back([&view] {
        const std::unique_ptr<char, decltype(&SDL_free)> copied(SDL_GetClipboardText(), SDL_free);
        EXPECT_EQ(std::string(copied.get()), run(view, "camera"));
    });
    steps.emplace_back([] { Hands::click(16, 8, 1); });
    steps.emplace_back([] {
        EXPECT_NE(Hands::title().find("mesh 'ball'"), std::string::npos) << Hands::title();
        Hands::write("z");  // has no command
    });
    Hands(view).show(steps);
    EXPECT_FALSE(view.ended());
}

TEST_F(ViewWindow, ClosingEndsTheView) {
    View view(device(), two_spheres(), small_view);
    int rounds = 0;
    run_in_window(view, [&] {
        Hands::push(SDL_QUIT);
        return ++rounds < 100;
    });
    EXPECT_TRUE(view.ended());
    EXPECT_EQ(rounds, 1);
}

TEST_F(ViewWindow, ALostDeviceClosesIt) {
    View view(device(), two_spheres(), small_view);
    int rounds = 0;
    EXPECT_TRUE(throws_error(ErrorKind::device, "cannot run the kernel", [&] {
        run_in_window(view, [&] {
            if (rounds == 0) Hands::press(SDLK_RIGHT), fail_command(device(), 3);
            return ++rounds < 100;
        });
    }));
    fail_command(device(), 0);
    EXPECT_FALSE(SDL_WasInit(SDL_INIT_VIDEO));
}

TEST_F(ViewWindow, WithoutADisplayIsRefused) {
    ::setenv("SDL_VIDEODRIVER", "none of these", 1);
    EXPECT_TRUE(throws_error(ErrorKind::user, "no display", require_window));
    const char* const display = std::getenv("DISPLAY");
    const std::string before = display ? display : "";
    ::unsetenv("SDL_VIDEODRIVER");
    ::setenv("DISPLAY", ":4711", 1);  // where nothing listens
    EXPECT_TRUE(throws_error(ErrorKind::user, "no display", require_window));
    display ? ::setenv("DISPLAY", before.c_str(), 1) : ::unsetenv("DISPLAY");
}

#else

TEST(ViewWindow, IsRefusedByABuildWithoutIt) {
    EXPECT_TRUE(throws_error(ErrorKind::user, "libsdl2-dev", require_window));
}

#endif

}  // namespace
}  // namespace claray::test
