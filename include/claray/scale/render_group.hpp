// Rendering of one image by several devices.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "claray/renderer.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// What a device contributed to an image.
struct DeviceShare {
    std::string name;
    std::uint64_t samples = 0;      ///< paths that it has rendered
    double samples_per_second = 0;  ///< measured lately
    std::string failure;            ///< why it was dropped; empty: it was not
};

/// Renders one image on several devices, of any platforms. Each pixel's samples are added in their order on one device
/// at a time. Therefore all devices together give the image of a single one bit for bit, whatever their makes, number
/// and speeds (docs/scale.md has the exceptions).
class RenderGroup {
public:
    /// Every device uploads the scene, builds its own structure and loads its own kernels, in a thread of its own. Work
    /// begins when the first device is ready; others join later. Adaptive sampling is refused with ErrorKind::usage.
    /// Other errors are those of Renderer; the scene must outlive the group. `tell` receives a line for each device
    /// that fails and is dropped, from `render`.
    RenderGroup(const std::vector<Device>& devices, const Scene& scene, const RenderConfig& config,
                std::function<void(const std::string&)> tell = {});
    ~RenderGroup();

    /// As Renderer::render. What a failing device has not handed over is rendered again by the others. Throws the last
    /// device's error if all of them fail; a checkpoint is written before.
    RenderProgress render(const std::function<bool(const RenderProgress&)>& progress = {});
    /// Returns the renderer of the first device that did not fail. After `render` it has the whole image: use it for
    /// images, AOVs, denoising and statistics of that device.
    [[nodiscard]] Renderer& renderer();
    /// Returns one entry per device, in order.
    [[nodiscard]] std::vector<DeviceShare> shares() const;
    /// As Renderer::checkpoint_error.
    [[nodiscard]] const std::string& checkpoint_error() const;

    struct State;  ///< not for users

private:
    friend struct Internals;
    std::unique_ptr<State> state_;
};

}  // namespace claray
#pragma GCC visibility pop
