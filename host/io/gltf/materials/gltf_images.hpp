// The images of a glTF, in files of their own, buffers or data URIs.
#pragma once

#include <optional>

#include "host/io/gltf/gltf_file.hpp"
#include "host/io/scene_textures.hpp"

namespace claray {

class GltfImages {
public:
    /// `decodes`: LoadOptions::images.
    GltfImages(const GltfFile& file, Warnings& warnings, bool decodes)
        : file_(file), warnings_(warnings), decodes_(decodes) {}

    /// Throws where the file has no image of this index; `user` names who wants it.
    void check(int index, const std::string& user) const;

    /// `eight_bit`, `room`: as decode_texture. A white texel where images are not decoded. Nothing where it is missing,
    /// with a warning.
    [[nodiscard]] std::optional<Texture> decode(int index, TexelFormat eight_bit, std::size_t room) const;

private:
    [[nodiscard]] std::optional<ImageFile> read(const tinygltf::Image& image, const std::string& name) const;

    const GltfFile& file_;
    Warnings& warnings_;
    bool decodes_;
};

}  // namespace claray
