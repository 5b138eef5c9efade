// Videos without compression, for a pipe to ffmpeg: YUV4MPEG2, one frame after the other.
#pragma once

#include <filesystem>
#include <string>

#include "claray/io.hpp"
#include "host/base/file.hpp"

namespace claray {

class Y4mVideo {
public:
    /// `path`: a file, which appears when `commit` is called; a pipe is written from the first frame on, so that
    /// nothing is written if there is none. `rate`: frames per second, > 0. Throws as NewFile.
    Y4mVideo(const std::filesystem::path& path, unsigned width, unsigned height, double rate);

    /// Adds a frame: 8 bits of BT.601 in limited range, one value of each plane per pixel. Exposure in stops.
    void add(const std::vector<glm::vec3>& pixels, float exposure, ToneMap tone_map);
    void commit();

private:
    unsigned width_, height_;
    std::string header_;  // until it is written
    NewFile file_;
};

}  // namespace claray
