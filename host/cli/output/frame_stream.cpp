#include "host/cli/output/frame_stream.hpp"

#include "host/cli/output/outputs.hpp"
#include "host/io/image/write/encode.hpp"

namespace claray::cli {

FrameStream::FrameStream(const RenderOptions& options) : options_(options) {
    const auto path = named_file(options.output);
    if (is_y4m(options))
        video_.emplace(path, options.config.image_width(), options.config.image_height(), options.frame_rate);
    else
        images_.emplace(path);
}

void FrameStream::add(const std::vector<glm::vec3>& pixels, float exposure) {
    if (video_) return video_->add(pixels, exposure, options_.tone_map);
    const Image image{options_.config.image_width(), options_.config.image_height(), pixels};
    const std::string bytes = encode_image(options_.output, image, exposure, options_.tone_map, encoding_of(options_));
    images_->write(bytes.data(), bytes.size());
}

void FrameStream::commit() { video_ ? video_->commit() : images_->commit(); }

}  // namespace claray::cli
