#include "host/io/gltf/materials/gltf_images.hpp"

#include "host/io/gltf/decode/data_uri.hpp"
#include "host/io/image/image_file.hpp"

namespace claray {

using std::to_string;

void GltfImages::check(int index, const std::string& user) const {
    const std::size_t count = file_.model.images.size();
    if (index < 0 || std::size_t(index) >= count)
        file_.fail(user + " refers to image " + to_string(index) + " of " + to_string(count));
}

/// Encoded.
std::optional<ImageFile> GltfImages::read(const tinygltf::Image& image, const std::string& name) const {
    ImageFile file{name + " of '" + file_.path.string() + "'", {}};
    if (image.bufferView >= 0) {
        file.bytes = file_.view(image.bufferView, name);
        return file;
    }
    if (!is_data_uri(image.uri))
        return read_image_of_scene(file_.path, file_.path.parent_path(), percent_decoded(image.uri), warnings_);
    std::optional<std::string> bytes = decode_data_uri(image.uri);
    if (!bytes) file_.fail(name + ": the base64 of its data URI is damaged");
    file.bytes = *std::move(bytes);
    return file;
}

std::optional<Texture> GltfImages::decode(int index, TexelFormat eight_bit, std::size_t room) const {
    const tinygltf::Image& image = file_.model.images[std::size_t(index)];
    Texture texture;
    if (!decodes_) {
        texture.width = texture.height = 1, texture.channels = 4, texture.format = eight_bit;
        texture.bytes.assign(4, 255);
    } else {
        const std::optional<ImageFile> file = read(image, gltf_name("image", image.name, std::size_t(index)));
        if (!file) return {};
        texture = decode_texture(file->bytes, file->name, eight_bit, room);
    }
    const bool has_name = !image.name.empty(), has_file = image.bufferView < 0 && !is_data_uri(image.uri);
    texture.name = has_name ? image.name : has_file ? image.uri : "image " + to_string(index);
    return texture;
}

}  // namespace claray
