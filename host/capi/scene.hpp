// The scene of claray.h.
#pragma once

#include "claray/scene.hpp"

struct claray_scene {
    claray::Scene scene;
};
