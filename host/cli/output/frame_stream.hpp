// The frames of an animation in one file or pipe.
#pragma once

#include <optional>

#include "host/base/file.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/io/y4m.hpp"

namespace claray::cli {

/// A video, or encoded images one behind the other, as `ffmpeg -f image2pipe -i -` reads them.
class FrameStream {
public:
    /// `options`: those of a stream. Throws as NewFile.
    explicit FrameStream(const RenderOptions& options);

    /// The next frame. Exposure in stops.
    void add(const std::vector<glm::vec3>& pixels, float exposure);
    void commit();

private:
    const RenderOptions& options_;
    std::optional<Y4mVideo> video_;  // else
    std::optional<NewFile> images_;
};

}  // namespace claray::cli
