// The device that the tests run on.
#pragma once

#include "claray/device.hpp"

namespace claray::test {

/// $CLARAY_DEVICE, else the first CPU device. Opened once for the whole process.
Device& device();

}  // namespace claray::test
