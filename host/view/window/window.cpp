#include "host/view/window/window.hpp"

#include "claray/error.hpp"

#if CLARAY_WITH_WINDOW
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "host/base/format.hpp"
#include "host/view/input.hpp"
#include "host/view/window/sdl.hpp"

namespace claray::view {
namespace {

constexpr int idle_milliseconds = 50;

[[noreturn]] void refuse(const std::string& what, const char* remedy) {
    throw Error(ErrorKind::user, "--window: " + what, remedy);
}

[[noreturn]] void refuse_without_display() {
    refuse("there is no display", "set DISPLAY or WAYLAND_DISPLAY, or leave --window out");
}

/// Asked before SDL, whose libraries print lines of their own where there is none.
bool names_a_display() {
    const auto is_set = [](const char* name) { return std::getenv(name) != nullptr; };
    return std::strcmp(sdl().GetPlatform(), "Linux") != 0 || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY") ||
           is_set("SDL_VIDEODRIVER");
}

/// SDL draws into memory if no display can be used.
bool shows_nothing() {
    const char* driver = sdl().GetCurrentVideoDriver();
    return std::getenv("SDL_VIDEODRIVER") == nullptr && driver != nullptr && std::strcmp(driver, "offscreen") == 0;
}

class Video {
public:
    Video() {
        sdl().SetMainReady();
        sdl().SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // Ctrl-C belongs to the program
        if (!names_a_display() || sdl().Init(SDL_INIT_VIDEO) != 0) refuse_without_display();
        if (shows_nothing()) sdl().Quit(), refuse_without_display();
    }
    ~Video() { sdl().Quit(); }
    Video(const Video&) = delete;
    Video& operator=(const Video&) = delete;
};

using WindowHandle = std::unique_ptr<SDL_Window, decltype(Sdl::DestroyWindow)>;
using SurfaceHandle = std::unique_ptr<SDL_Surface, decltype(Sdl::FreeSurface)>;

std::string key_of(const SDL_Keysym& key) {
    switch (key.sym) {
        case SDLK_LEFT: return "ArrowLeft";
        case SDLK_RIGHT: return "ArrowRight";
        case SDLK_UP: return "ArrowUp";
        case SDLK_DOWN: return "ArrowDown";
        default: return {};
    }
}

class Window {
public:
    explicit Window(View& view) : view_(view) {
        const Frame& frame = view_.next_frame();
        window_.reset(sdl().CreateWindow("claray view", SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED,
                                         int(frame.width), int(frame.height), SDL_WINDOW_RESIZABLE));
        if (!window_) refuse(std::string("no window can be made: ") + sdl().GetError(), "leave --window out");
        show(frame);
    }

    void run(const std::function<bool()>& goes_on) {
        while (!view_.ended() && goes_on()) {
            if (complete_) sdl().WaitEventTimeout(nullptr, idle_milliseconds);
            changed_ = false;
            for (SDL_Event event; sdl().PollEvent(&event) != 0;) take(event);
            end_drag();
            if (complete_ && !changed_) continue;
            show(view_.next_frame());
        }
    }

private:
    void tell(const std::string& line) {
        told_ = answer(view_, line).line;
        if (line == "camera") sdl().SetClipboardText(told_.c_str());
        changed_ = true;
    }

    /// Motions of one drag between two frames are one command.
    void end_drag() {
        if (drag_x_ == 0 && drag_y_ == 0) return;
        const auto held = [](int keys) { return (sdl().GetModState() & keys) != 0; };
        if (held(KMOD_CTRL))
            tell(printed("drag %g %g", drag_x_ / height_, -drag_y_ / height_));
        else if (held(KMOD_SHIFT))
            tell(printed("pan %g %g", -drag_x_ / height_, drag_y_ / height_));
        else
            tell(printed("orbit %g %g", -drag_x_ * degrees_per_pixel, drag_y_ * degrees_per_pixel));
        drag_x_ = drag_y_ = 0;
    }

    void take(const SDL_Event& event) {
        if (event.type == SDL_QUIT) tell("quit");
        if (event.type == SDL_KEYDOWN) press(key_of(event.key.keysym));
        if (event.type == SDL_TEXTINPUT) press(event.text.text);
        if (event.type == SDL_MOUSEWHEEL && event.wheel.y != 0)
            tell(printed("zoom %.9g", event.wheel.y > 0 ? zoom_per_step : 1 / zoom_per_step));
        if (event.type == SDL_WINDOWEVENT) follow(event.window);
        if (event.type == SDL_MOUSEBUTTONDOWN && event.button.button == SDL_BUTTON_LEFT) moved_ = 0;
        if (event.type == SDL_MOUSEMOTION && (event.motion.state & SDL_BUTTON_LMASK) != 0) {
            drag_x_ += event.motion.xrel, drag_y_ += event.motion.yrel;
            moved_ += std::abs(event.motion.xrel) + std::abs(event.motion.yrel);
        }
        if (event.type == SDL_MOUSEBUTTONUP && event.button.button == SDL_BUTTON_LEFT && moved_ < farthest_click)
            tell(printed("%s %d %d", event.button.clicks == 2 ? "focus" : "pick", event.button.x, event.button.y));
    }

    void press(std::string key) {
        if (key.size() == 1) key[0] = char(std::tolower(static_cast<unsigned char>(key[0])));
        if (const std::string command = command_of_key(key); !command.empty()) tell(command);
    }

    /// A window without an area shows nothing: the view keeps its size.
    void follow(const SDL_WindowEvent& event) {
        if (event.event == SDL_WINDOWEVENT_SIZE_CHANGED && event.data1 > 0 && event.data2 > 0)
            tell(printed("resize %d %d", event.data1, event.data2));
        if (event.event == SDL_WINDOWEVENT_EXPOSED) changed_ = true;
    }

    void show(const Frame& frame) {
        complete_ = frame.complete, height_ = frame.height;
        sdl().SetWindowTitle(window_.get(), (printed("claray view: %u spp ", frame.spp) + told_).c_str());
        SDL_Surface* surface = sdl().GetWindowSurface(window_.get());
        if (surface == nullptr || surface->w < 1 || surface->h < 1) return;  // minimized
        const SurfaceHandle picture(
            sdl().CreateRGBSurfaceWithFormatFrom(const_cast<std::uint8_t*>(frame.pixels.data()), int(frame.width),
                                                 int(frame.height), 32, int(4 * frame.width), SDL_PIXELFORMAT_RGBA32),
            sdl().FreeSurface);
        if (!picture) refuse("a frame cannot be shown", "use a smaller --size");
        sdl().SetSurfaceBlendMode(picture.get(), SDL_BLENDMODE_NONE);
        sdl().UpperBlitScaled(picture.get(), nullptr, surface, nullptr);
        sdl().UpdateWindowSurface(window_.get());
    }

    View& view_;
    WindowHandle window_{nullptr, sdl().DestroyWindow};
    std::string told_;
    double drag_x_ = 0, drag_y_ = 0, height_ = 1;  // pixels
    int moved_ = 0;                                // pixels since the button was pressed
    bool complete_ = false, changed_ = false;
};

}  // namespace

void require_window() { const Video video; }

void run_in_window(View& view, const std::function<bool()>& goes_on) {
    const Video video;
    Window(view).run(goes_on);
}

}  // namespace claray::view

#else

namespace claray::view {

void require_window() {
    throw Error(ErrorKind::user, "--window: this build of claray has no windows",
                "install libsdl2-dev and configure again, or leave --window out");
}

void run_in_window(View&, const std::function<bool()>&) { require_window(); }

}  // namespace claray::view

#endif
