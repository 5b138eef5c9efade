#include "host/io/gltf/decode/gltf_compression.hpp"

namespace claray {

bool is_compression(std::string_view extension) { return extension == draco_extension || is_meshopt(extension); }

bool can_decode(std::string_view extension) {
    return (CLARAY_WITH_DRACO && extension == draco_extension) || (CLARAY_WITH_MESHOPT && is_meshopt(extension));
}

std::size_t count_in(const GltfFile& file, const tinygltf::Value& object, const char* key, std::size_t fallback,
                     const std::string& name) {
    if (!object.IsObject() || !object.Has(key)) return fallback;
    const tinygltf::Value& value = object.Get(key);
    if (!value.IsInt() || value.GetNumberAsInt() < 0) file.fail(name + ": '" + key + "' is not an index or a size");
    return std::size_t(value.GetNumberAsInt());
}

void decompress(GltfFile& file) {
    tinygltf::Model& model = file.model;
    for (std::size_t i = 0; i < model.bufferViews.size(); ++i)
        for (const char* extension : meshopt_extensions)
            if (can_decode(extension) && model.bufferViews[i].extensions.contains(extension))
                decode_meshopt_view(file, model.bufferViews[i], extension,
                                    gltf_name("buffer view", model.bufferViews[i].name, i));
    if (can_decode(draco_extension))
        for (std::size_t i = 0; i < model.meshes.size(); ++i)
            for (tinygltf::Primitive& primitive : model.meshes[i].primitives)
                if (primitive.extensions.count(draco_extension) > 0)
                    decode_draco_primitive(file, primitive, gltf_name("mesh", model.meshes[i].name, i));
}

}  // namespace claray
