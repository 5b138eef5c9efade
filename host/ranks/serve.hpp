// What all ranks but the first do.
#pragma once

#include "claray/device.hpp"
#include "host/ranks/protocol.hpp"

namespace claray::ranks {

/// Renders a frame alone. Returns none if `goes_on`, which must be called now and then, returned false.
using RenderFrame = std::function<std::optional<RenderedFrame>(
    const std::vector<Device>& devices, const RenderTask& frame, const std::function<bool()>& goes_on)>;

/// Says hello, and renders what rank 0 asks for on these devices. `compiler`: RenderConfig::compiler. Returns the exit
/// code with which rank 0 quits. Throws ErrorKind::user if rank 0 is lost.
[[nodiscard]] int serve(Session& session, const std::vector<Device>& devices, Hello hello, const std::string& compiler,
                        const RenderFrame& render_frame);

}  // namespace claray::ranks
