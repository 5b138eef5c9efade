// What all ranks but the first do.
#pragma once

#include "claray/device.hpp"
#include "host/ranks/protocol.hpp"

namespace claray::ranks {

/// Says hello, and renders what rank 0 asks for on these devices. `compiler`: RenderConfig::compiler. Returns the exit
/// code with which rank 0 quits. Throws ErrorKind::user if rank 0 is lost.
[[nodiscard]] int serve(Session& session, const std::vector<Device>& devices, Hello hello, const std::string& compiler);

}  // namespace claray::ranks
