// Triangles compressed by Draco (KHR_draco_mesh_compression).
#include "host/io/gltf/decode/gltf_compression.hpp"

#if CLARAY_WITH_DRACO
#include <draco/compression/decode.h>
#endif

namespace claray {
#if CLARAY_WITH_DRACO
namespace {

using std::to_string;

std::unique_ptr<draco::Mesh> decode_draco(const GltfFile& file, std::string_view bytes, const std::string& name) {
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) file.fail(name + ": its Draco data is damaged (" + decoded.status().error_msg_string() + ")");
    return std::move(decoded).value();
}

/// A buffer of its own for these bytes; the index of its view.
int add_view(tinygltf::Model& model, std::vector<unsigned char> bytes) {
    tinygltf::BufferView view;
    view.buffer = int(model.buffers.size());
    view.byteLength = bytes.size();
    model.buffers.emplace_back();
    model.buffers.back().data = std::move(bytes);
    model.bufferViews.push_back(view);
    return int(model.bufferViews.size()) - 1;
}

/// All values of an attribute as components of type T, a vertex' after the other.
template <class T>
std::vector<unsigned char> values_of(const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                                     std::size_t components) {
    std::vector<unsigned char> bytes(mesh.num_points() * components * sizeof(T));
    T* out = reinterpret_cast<T*>(bytes.data());
    for (draco::PointIndex i(0); i < mesh.num_points(); ++i, out += components)
        if (!attribute.ConvertValue<T>(attribute.mapped_index(i), std::int8_t(components), out)) return {};
    return bytes;
}

std::vector<unsigned char> values_of(const draco::Mesh& mesh, const draco::PointAttribute& attribute, int type,
                                     std::size_t components) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: return values_of<std::int8_t>(mesh, attribute, components);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return values_of<std::uint8_t>(mesh, attribute, components);
        case TINYGLTF_COMPONENT_TYPE_SHORT: return values_of<std::int16_t>(mesh, attribute, components);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return values_of<std::uint16_t>(mesh, attribute, components);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return values_of<std::uint32_t>(mesh, attribute, components);
        case TINYGLTF_COMPONENT_TYPE_FLOAT: return values_of<float>(mesh, attribute, components);
        default: return {};
    }
}

/// A copy of an accessor that refers to these bytes; its index.
int add_accessor(tinygltf::Model& model, tinygltf::Accessor accessor, std::size_t count,
                 std::vector<unsigned char> bytes) {
    accessor.bufferView = add_view(model, std::move(bytes));
    accessor.byteOffset = 0;
    accessor.count = count;
    accessor.sparse.isSparse = false;
    model.accessors.push_back(std::move(accessor));
    return int(model.accessors.size()) - 1;
}

int add_attribute(GltfFile& file, const draco::Mesh& mesh, std::uint32_t id, int accessor_index,
                  const std::string& name) {
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id);
    if (attribute == nullptr)
        file.fail(name + " refers to attribute " + to_string(id) + ", which is missing in its Draco data");
    tinygltf::Model& model = file.model;
    if (accessor_index < 0 || std::size_t(accessor_index) >= model.accessors.size())
        file.fail(name + " refers to accessor " + to_string(accessor_index) + " of " +
                  to_string(model.accessors.size()));
    const tinygltf::Accessor& accessor = model.accessors[std::size_t(accessor_index)];
    const int components = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
    if (components < 1 || components > 4) file.fail(name + " has a type that Draco data cannot have");
    std::vector<unsigned char> bytes = values_of(mesh, *attribute, accessor.componentType, std::size_t(components));
    if (bytes.empty() && mesh.num_points() > 0) file.fail(name + ": its Draco data has a different type");
    return add_accessor(model, accessor, mesh.num_points(), std::move(bytes));
}

int add_indices(GltfFile& file, const draco::Mesh& mesh) {
    std::vector<unsigned char> bytes(std::size_t(mesh.num_faces()) * 3 * sizeof(std::uint32_t));
    auto* out = reinterpret_cast<std::uint32_t*>(bytes.data());
    for (draco::FaceIndex i(0); i < mesh.num_faces(); ++i)
        for (const draco::PointIndex& corner : mesh.face(i)) *out++ = corner.value();
    tinygltf::Accessor accessor;
    accessor.type = TINYGLTF_TYPE_SCALAR;
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    return add_accessor(file.model, accessor, std::size_t(mesh.num_faces()) * 3, std::move(bytes));
}

}  // namespace

/// What the data holds are triangles, strips among them already taken apart.
void decode_draco_primitive(GltfFile& file, tinygltf::Primitive& primitive, const std::string& name) {
    const tinygltf::Value extension = primitive.extensions.at(draco_extension);
    const std::size_t view = count_in(file, extension, "bufferView", ~std::size_t(0), name);
    const std::unique_ptr<draco::Mesh> mesh =
        decode_draco(file, file.view(view > 0x7fffffffu ? -1 : int(view), name + ": its Draco data"), name);
    if (extension.Has("attributes") && extension.Get("attributes").IsObject())
        for (const auto& [attribute, id] : extension.Get("attributes").Get<tinygltf::Value::Object>()) {
            const auto found = primitive.attributes.find(attribute);
            if (found == primitive.attributes.end() || !id.IsInt()) continue;
            found->second =
                add_attribute(file, *mesh, std::uint32_t(id.GetNumberAsInt()), found->second, name + ": " + attribute);
        }
    primitive.indices = add_indices(file, *mesh);
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
}

#else
void decode_draco_primitive(GltfFile&, tinygltf::Primitive&, const std::string&) {}
#endif
}  // namespace claray
