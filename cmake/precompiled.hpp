// What nearly all sources include, read once where CLARAY_QUICK_BUILD is on. Sources include what they need themselves.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "claray/opencl.hpp"
