// Includes claray's core library.
#pragma once

#include "claray/buffer.hpp"
#include "claray/bvh.hpp"
#include "claray/device.hpp"
#include "claray/effects.hpp"
#include "claray/error.hpp"
#include "claray/instances.hpp"
#include "claray/mesh.hpp"
#include "claray/picture.hpp"
#include "claray/profiler.hpp"
#include "claray/program.hpp"
#include "claray/query.hpp"
#include "claray/query/points.hpp"
#include "claray/renderer.hpp"
#include "claray/scene.hpp"
