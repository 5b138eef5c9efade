// SDL2, loaded when a window is asked for: it brings some forty libraries, which no other command needs.
#pragma once

#define SDL_MAIN_HANDLED
#include <SDL.h>

/// The functions that a window needs, without SDL_.
#define CLARAY_SDL_FUNCTIONS(FUNCTION)                                                                                 \
    FUNCTION(SetMainReady)                                                                                             \
    FUNCTION(SetHint)                                                                                                  \
    FUNCTION(Init) FUNCTION(Quit) FUNCTION(GetError) FUNCTION(GetPlatform) FUNCTION(GetCurrentVideoDriver)             \
        FUNCTION(CreateWindow) FUNCTION(DestroyWindow) FUNCTION(SetWindowTitle) FUNCTION(GetWindowSurface)             \
            FUNCTION(UpdateWindowSurface) FUNCTION(CreateRGBSurfaceWithFormatFrom) FUNCTION(FreeSurface)               \
                FUNCTION(SetSurfaceBlendMode) FUNCTION(UpperBlitScaled) FUNCTION(WaitEventTimeout) FUNCTION(PollEvent) \
                    FUNCTION(GetModState) FUNCTION(SetClipboardText)

namespace claray::view {

struct Sdl {
#define CLARAY_MEMBER(name) decltype(&SDL_##name) name = nullptr;
    CLARAY_SDL_FUNCTIONS(CLARAY_MEMBER)
#undef CLARAY_MEMBER
};

/// Loads SDL2 at the first call. Throws ErrorKind::user if it is not installed.
[[nodiscard]] const Sdl& sdl();

}  // namespace claray::view
