// Renderers that studies keep from image to image.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "claray/renderer.hpp"
#include "claray/shared/path.h"

namespace claray {

struct Rendered {
    std::vector<glm::vec3> image;
    double seconds = 0;  ///< of sampling only
};

/// Compiles kernels with other values of macros until the end of the scope.
class MacroScope {
public:
    struct Macro {
        const char* kernel;
        const char* name;
        unsigned value;
    };
    MacroScope(const Device& device, const std::vector<Macro>& macros);
    ~MacroScope();
    MacroScope(const MacroScope&) = delete;
    MacroScope& operator=(const MacroScope&) = delete;

private:
    Device device_;
    std::map<std::string, unsigned> before_;  // Device::State::tuning
};

/// Bytes of the device that a renderer of the scene may take, at most about.
[[nodiscard]] std::uint64_t bytes_of_renderer(const Device& device, const Scene& scene);

/// Renders with the settings of `config`, up to its number of samples, by kernels with these values of macros. The
/// first render makes a renderer and loads its kernels. Before it is made, those that were used longest ago are dropped
/// until it fits into the share of the device's memory that the tuning table names; they are made again when they are
/// used. The scene must outlive it. Kept renderers of a device are for one thread at a time.
class KeptRenderer {
public:
    /// `short_seconds`: after a shorter render the next one begins anew. `ambient`: for kernels with AMBIENT.
    KeptRenderer(const Device& device, const Scene& scene, const RenderConfig& config,
                 std::vector<MacroScope::Macro> macros = {}, double short_seconds = 0.1,
                 const AmbientData& ambient = {});
    ~KeptRenderer();
    KeptRenderer(const KeptRenderer&) = delete;
    KeptRenderer& operator=(const KeptRenderer&) = delete;

    /// A render of the same seed with fewer samples is continued, if it was the last one and not short: the image is
    /// the same bit for bit, and the seconds are the sum of all parts. `max_depth`: 0 for that of the configuration,
    /// which is the largest.
    [[nodiscard]] Rendered render(std::uint32_t seed, unsigned spp, unsigned max_depth = 0);
    /// Of the last image; null before the first and after it was dropped.
    [[nodiscard]] const Renderer* renderer() const { return renderer_ ? &*renderer_ : nullptr; }

private:
    void make();
    void make_room() const;
    [[nodiscard]] bool continues(std::uint32_t seed, unsigned spp, unsigned max_depth) const;

    Device device_;
    const Scene& scene_;
    RenderConfig config_;
    std::vector<MacroScope::Macro> macros_;
    double short_seconds_;
    AmbientData ambient_;
    std::optional<Renderer> renderer_;
    std::uint64_t last_use_ = 0;
    /// Of the last image.
    struct {
        std::uint32_t seed = 0;
        unsigned spp = 0, max_depth = 0;
        double seconds = 0;
    } last_;
};

/// Renders with this seed and so many samples per pixel.
using RenderMethod = std::function<Rendered(std::uint32_t seed, unsigned spp)>;
/// By a renderer that is kept until the last copy of the method is gone.
[[nodiscard]] RenderMethod render_with(const Device& device, const Scene& scene, const RenderConfig& config,
                                       std::vector<MacroScope::Macro> macros = {}, const AmbientData& ambient = {});
/// One image with all samples of `config.spp`.
[[nodiscard]] Rendered render_image(const Device& device, const Scene& scene, const RenderConfig& config);

}  // namespace claray
