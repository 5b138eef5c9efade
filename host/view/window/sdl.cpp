#if CLARAY_WITH_WINDOW
#include "host/view/window/sdl.hpp"

#include "claray/error.hpp"
#include "host/base/process/plugin.hpp"

namespace claray::view {
namespace {

Sdl load() {
    Sdl sdl;
    void* const library = ::dlopen("libSDL2-2.0.so.0", RTLD_NOW | RTLD_LOCAL);
    bool complete = library != nullptr;
#define CLARAY_FIND(name) complete = complete && find_function(library, "SDL_" #name, sdl.name);
    CLARAY_SDL_FUNCTIONS(CLARAY_FIND)
#undef CLARAY_FIND
    if (!complete)
        throw Error(ErrorKind::user, "--window: SDL2 is not installed", "install libsdl2-2.0-0, or leave --window out");
    return sdl;
}

}  // namespace

const Sdl& sdl() {
    static const Sdl loaded = load();
    return loaded;
}

}  // namespace claray::view
#endif
