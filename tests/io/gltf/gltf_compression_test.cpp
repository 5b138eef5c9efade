// Compressed geometry in glTF: what the packaged encoders wrote is read as it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/io/gltf/gltf_fixture.hpp"

#if CLARAY_WITH_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif
#if CLARAY_WITH_MESHOPT
#include <meshoptimizer.h>
#endif

namespace claray {
namespace {

using test::GltfBuilder;
using test::json;

class Compressed : public test::GltfTest {
protected:
    Scene load(bool binary = false) {
        warnings.clear();
        Scene scene = load_gltf(
            binary ? folder.file("scene.glb", builder.glb()) : folder.file("scene.gltf", builder.gltf()), warnings);
        validate(scene);
        return scene;
    }
};

/// What a build without the library says, too.
TEST_F(Compressed, ExtensionsThatAreNotKnownAreRefusedByName) {
    builder.triangle();
    builder.root["extensionsRequired"] = builder.root["extensionsUsed"] = {"KHR_zip_compression"};
    refuse({"requires the extension 'KHR_zip_compression'", "does not know"});
}

#if CLARAY_WITH_DRACO

/// A strip of triangles over a curved surface, with coordinates and colours.
Mesh strip() {
    Mesh mesh;
    for (int i = 0; i < 12; ++i) {
        const float x = 0.25f * float(i / 2), y = float(i % 2);
        mesh.positions.emplace_back(x, y, std::sin(x + y));
        mesh.uvs.emplace_back(0.125f * x, 1.f - y);
        mesh.colors.emplace_back(float(20 * i) / 255.f, 1.f, float(i) / 255.f, 51.f / 255.f);
        if (i >= 2) mesh.triangles.emplace_back(i - 2, i - 1 + i % 2, i - i % 2);
    }
    return mesh;
}

/// Everything about a triangle's corners, turned so that the least comes first, in an order that is the mesh' own.
std::vector<std::vector<float>> corners_of(const Mesh& mesh) {
    std::vector<std::vector<float>> all;
    for (const glm::uvec3& t : mesh.triangles) {
        std::vector<std::vector<float>> corners;
        for (int k = 0; k < 3; ++k) {
            const glm::vec3 p = mesh.positions[t[k]];
            const glm::vec2 uv = mesh.uvs[t[k]];
            const glm::vec4 c = mesh.colors[t[k]];
            corners.push_back({p.x, p.y, p.z, uv.x, uv.y, c.x, c.y, c.z, c.w});
        }
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        std::vector<float> joined;
        for (const auto& corner : corners) joined.insert(joined.end(), corner.begin(), corner.end());
        all.push_back(joined);
    }
    std::sort(all.begin(), all.end());
    return all;
}

struct Encoded {
    std::string bytes;
    json attributes;
    std::size_t points = 0;
};

Encoded encode(const Mesh& mesh) {
    draco::TriangleSoupMeshBuilder soup;
    soup.Start(int(mesh.triangles.size()));
    const int position = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32),
              uv = soup.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32),
              color = soup.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::uvec3 t = mesh.triangles[i];
        const draco::FaceIndex face{std::uint32_t(i)};
        glm::u8vec4 colors[3];
        for (int k = 0; k < 3; ++k) colors[k] = glm::u8vec4(glm::round(255.f * mesh.colors[t[k]]));
        soup.SetAttributeValuesForFace(position, face, &mesh.positions[t.x], &mesh.positions[t.y],
                                       &mesh.positions[t.z]);
        soup.SetAttributeValuesForFace(uv, face, &mesh.uvs[t.x], &mesh.uvs[t.y], &mesh.uvs[t.z]);
        soup.SetAttributeValuesForFace(color, face, &colors[0], &colors[1], &colors[2]);
    }
    const std::unique_ptr<draco::Mesh> built = soup.Finalize();
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(draco::Encoder().EncodeMeshToBuffer(*built, &buffer).ok());
    Encoded encoded;
    encoded.bytes.assign(buffer.data(), buffer.size());
    encoded.attributes = {{"POSITION", built->attribute(position)->unique_id()},
                          {"TEXCOORD_0", built->attribute(uv)->unique_id()},
                          {"COLOR_0", built->attribute(color)->unique_id()}};
    encoded.points = built->num_points();
    return encoded;
}

class Draco : public Compressed {
protected:
    /// A mesh of which the file holds nothing but Draco's data.
    void build(const Mesh& mesh) {
        const Encoded encoded = encode(mesh);
        const auto accessor = [&](const char* type, int component, bool normalized) {
            return builder.push(
                "accessors",
                {{"type", type}, {"componentType", component}, {"count", encoded.points}, {"normalized", normalized}});
        };
        const json attributes = {{"POSITION", accessor("VEC3", 5126, false)},
                                 {"TEXCOORD_0", accessor("VEC2", 5126, false)},
                                 {"COLOR_0", accessor("VEC4", 5121, true)}};
        const int indices = builder.push(
            "accessors", {{"type", "SCALAR"}, {"componentType", 5123}, {"count", 3 * mesh.triangles.size()}});
        const json extension = {{"bufferView", builder.view(encoded.bytes)}, {"attributes", encoded.attributes}};
        const json described = {{"attributes", attributes},
                                {"indices", indices},
                                {"extensions", {{"KHR_draco_mesh_compression", extension}}}};
        builder.push("nodes", {{"mesh", builder.push("meshes", {{"primitives", {described}}})}});
        builder.root["extensionsUsed"] = builder.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    }
    json& extension() { return primitive()["extensions"]["KHR_draco_mesh_compression"]; }
};

TEST_F(Draco, IsReadAsItWasWritten) {
    const Mesh mesh = strip();
    build(mesh);
    for (const bool binary : {false, true}) {
        const Scene scene = load(binary);
        ASSERT_EQ(scene.meshes.size(), 1u);
        EXPECT_EQ(scene.meshes[0].triangles.size(), 10u);
        EXPECT_EQ(corners_of(scene.meshes[0]), corners_of(mesh));
        for (const std::string& line : warnings) EXPECT_EQ(line.find("xtension"), std::string::npos) << line;
    }
}

/// Two primitives may name the same accessors and the same data.
TEST_F(Draco, SharedAccessorsAreReadTwice) {
    const Mesh mesh = strip();
    build(mesh);
    json& primitives = builder.root["meshes"][0]["primitives"];
    primitives.push_back(json(primitives[0]));
    const Scene scene = load();
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(corners_of(scene.meshes[1]), corners_of(mesh));
}

TEST_F(Draco, DamageIsAnError) {
    build(strip());
    const json good = builder.root;
    extension()["attributes"]["POSITION"] = 77;
    refuse({"scene.gltf", "mesh 0: POSITION refers to attribute 77"});
    builder.root = good;
    extension()["bufferView"] = 9;
    refuse({"mesh 0: its Draco data refers to buffer view 9 of 1"});
    extension()["bufferView"] = -1;
    refuse({"mesh 0: 'bufferView' is not an index or a size"});
    builder.root = good;
    builder.root["bufferViews"][0]["byteLength"] = 20;
    refuse({"mesh 0: its Draco data is damaged"});
}

/// Whatever bytes change, the file is read or refused.
TEST_F(Draco, ChangedBytesEndInNoCrash) {
    build(strip());
    const std::string glb = builder.glb();
    const std::size_t begin = glb.find("DRACO");
    ASSERT_NE(begin, std::string::npos);
    for (std::size_t i = begin; i + 4 < glb.size(); i += 3) {
        std::string changed = glb;
        changed[i] = char(changed[i] ^ (1 << i % 8));
        try {
            static_cast<void>(load_gltf(folder.file("changed.glb", changed), warnings));
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::user);
        }
    }
}

#else
TEST_F(Compressed, DracoIsRefusedByName) {
    builder.triangle();
    primitive()["indices"] = builder.push("accessors", {{"type", "SCALAR"}, {"componentType", 5123}, {"count", 3}});
    primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}, {"attributes", json::object()}};
    builder.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    refuse({"requires the extension 'KHR_draco_mesh_compression', which this build of claray cannot decode"});
}
#endif

#if CLARAY_WITH_MESHOPT

std::string text_from(const std::vector<unsigned char>& bytes) { return {bytes.begin(), bytes.end()}; }

template <class T>
std::string encode_attributes(const std::vector<T>& values, std::size_t stride) {
    const std::size_t count = values.size() * sizeof(T) / stride;
    std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(count, stride));
    bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), values.data(), count, stride));
    return text_from(bytes);
}
std::string encode_triangles(const std::vector<unsigned>& indices, std::size_t vertices) {
    std::vector<unsigned char> bytes(meshopt_encodeIndexBufferBound(indices.size(), vertices));
    bytes.resize(meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), indices.data(), indices.size()));
    return text_from(bytes);
}
std::string encode_sequence(const std::vector<unsigned>& indices, std::size_t vertices) {
    std::vector<unsigned char> bytes(meshopt_encodeIndexSequenceBound(indices.size(), vertices));
    bytes.resize(meshopt_encodeIndexSequence(bytes.data(), bytes.size(), indices.data(), indices.size()));
    return text_from(bytes);
}

class Meshopt : public Compressed {
protected:
    /// A view of data that exists only compressed, in a fallback buffer that is in no file.
    int compressed(const std::string& bytes, std::size_t stride, std::size_t count, const char* mode,
                   const char* filter = nullptr) {
        const int packed = builder.view(bytes);
        const json where = builder.root["bufferViews"][packed];
        json extension = {{"buffer", 0},
                          {"byteOffset", where["byteOffset"]},
                          {"byteLength", where["byteLength"]},
                          {"byteStride", stride},
                          {"count", count},
                          {"mode", mode}};
        if (filter != nullptr) extension["filter"] = filter;
        json view = {{"buffer", 1},
                     {"byteOffset", fallback_bytes_},
                     {"byteLength", stride * count},
                     {"extensions", {{"EXT_meshopt_compression", extension}}}};
        if (std::string(mode) == "ATTRIBUTES") view["byteStride"] = stride;
        fallback_bytes_ += stride * count;
        return builder.push("bufferViews", view);
    }
    int accessor(int view, const char* type, int component, std::size_t count, bool normalized = false) {
        return builder.push("accessors", {{"bufferView", view},
                                          {"type", type},
                                          {"componentType", component},
                                          {"count", count},
                                          {"normalized", normalized}});
    }
    void finish(const json& primitive) {
        builder.push("nodes", {{"mesh", builder.push("meshes", {{"primitives", {primitive}}})}});
        builder.root["extensionsUsed"] =
            builder.root["extensionsRequired"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
        builder.more_buffers = {
            {{"byteLength", fallback_bytes_}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
    }
    json& extension(int view) { return builder.root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]; }

private:
    std::size_t fallback_bytes_ = 0;
};

const std::vector<float> fan_positions = {0, 0, 0, 1, 0, 0, 1, 1, 0.5f, 0, 1, 0.25f, -1, 0.5f, 3};
const std::vector<unsigned> fan_indices = {0, 1, 2, 0, 2, 3, 0, 3, 4};

/// The triangles' corners from the least index on: a triangle's first corner is the codec's to choose.
std::vector<std::vector<unsigned>> turned(const std::vector<glm::uvec3>& triangles) {
    std::vector<std::vector<unsigned>> all;
    for (const glm::uvec3& t : triangles) {
        std::vector<unsigned> corners = {t.x, t.y, t.z};
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        all.push_back(corners);
    }
    return all;
}

TEST_F(Meshopt, AttributesAndTriangles) {
    const int positions = compressed(encode_attributes(fan_positions, 12), 12, 5, "ATTRIBUTES");
    for (const std::size_t stride : {std::size_t(2), std::size_t(4)}) {
        const int indices = compressed(encode_triangles(fan_indices, 5), stride, 9, "TRIANGLES");
        finish({{"attributes", {{"POSITION", accessor(positions, "VEC3", 5126, 5)}}},
                {"indices", accessor(indices, "SCALAR", stride == 2 ? 5123 : 5125, 9)}});
    }
    for (const bool binary : {false, true}) {
        const Scene scene = load(binary);
        ASSERT_EQ(scene.meshes.size(), 2u);
        for (const Mesh& mesh : scene.meshes) {
            ASSERT_EQ(mesh.positions.size(), 5u);
            for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(mesh.positions[i / 3][int(i % 3)], fan_positions[i]);
            EXPECT_EQ(turned(mesh.triangles), (std::vector<std::vector<unsigned>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
        }
    }
}

/// KHR_meshopt_compression is the same where the codec has version 0; its version 1 needs a newer library.
TEST_F(Meshopt, ByTheNameOfKhronos) {
    const auto renamed = [](const json& object) {
        std::string text = object.dump();
        for (std::size_t at; (at = text.find("EXT_meshopt")) != text.npos;) text.replace(at, 3, "KHR");
        return json::parse(text);
    };
    const std::string packed = encode_attributes(fan_positions, 12);
    for (const bool is_new : {false, true}) {
        const int positions = compressed(is_new ? "\xa1" + packed.substr(1) : packed, 12, 5, "ATTRIBUTES");
        builder.root["meshes"] = builder.root["nodes"] = json::array();
        finish({{"mode", 6}, {"attributes", {{"POSITION", accessor(positions, "VEC3", 5126, 5)}}}});
        builder.root = renamed(builder.root), builder.more_buffers = renamed(builder.more_buffers);
        if (!is_new) {
            EXPECT_EQ(load(true).meshes.at(0).positions.at(4), glm::vec3(-1, 0.5f, 3));
        } else if (MESHOPTIMIZER_VERSION < 250) {
            refuse({"is compressed by version 1 of KHR_meshopt_compression, which needs meshoptimizer 0.25"});
        }
    }
}

TEST_F(Meshopt, IndexSequences) {
    const std::vector<unsigned> strip_indices = {0, 1, 3, 2, 4};
    const int positions = compressed(encode_attributes(fan_positions, 12), 12, 5, "ATTRIBUTES");
    const int indices = compressed(encode_sequence(strip_indices, 5), 2, 5, "INDICES");
    finish({{"mode", 5},
            {"attributes", {{"POSITION", accessor(positions, "VEC3", 5126, 5)}}},
            {"indices", accessor(indices, "SCALAR", 5123, 5)}});
    EXPECT_EQ(load().meshes.at(0).triangles, (std::vector<glm::uvec3>{{0, 1, 3}, {1, 2, 3}, {3, 2, 4}}));
}

/// Each filter against the numbers that were filtered, within the step of its bits.
TEST_F(Meshopt, Filters) {
    std::vector<std::uint32_t> exponential(15);
    meshopt_encodeFilterExp(exponential.data(), 5, 12, 15, fan_positions.data());
    const int positions = compressed(encode_attributes(exponential, 12), 12, 5, "ATTRIBUTES", "EXPONENTIAL");

    std::vector<float> normals, quaternions;
    for (int i = 0; i < 5; ++i) {
        const glm::vec3 n = glm::normalize(glm::vec3(0.3f * float(i) - 0.5f, 0.2f, i == 2 ? -0.7f : 0.8f));
        normals.insert(normals.end(), {n.x, n.y, n.z, 0.f});
        const glm::vec4 q = glm::normalize(glm::vec4(0.1f + float(i), 1.f, 2.f, 0.5f * float(i)));
        quaternions.insert(quaternions.end(), {q.x, q.y, q.z, q.w});
    }
    std::vector<std::int8_t> octahedral(20);
    meshopt_encodeFilterOct(octahedral.data(), 5, 4, 8, normals.data());
    const int normal_view = compressed(encode_attributes(octahedral, 4), 4, 5, "ATTRIBUTES", "OCTAHEDRAL");
    std::vector<std::int16_t> quaternion(20);
    meshopt_encodeFilterQuat(quaternion.data(), 5, 8, 12, quaternions.data());
    const int quaternion_view = compressed(encode_attributes(quaternion, 8), 8, 5, "ATTRIBUTES", "QUATERNION");

    const int indices = compressed(encode_triangles(fan_indices, 5), 2, 9, "TRIANGLES");
    finish({{"attributes",
             {{"POSITION", accessor(positions, "VEC3", 5126, 5)},
              {"NORMAL", accessor(normal_view, "VEC3", 5120, 5, true)},
              {"COLOR_0", accessor(quaternion_view, "VEC4", 5122, 5, true)}}},
            {"indices", accessor(indices, "SCALAR", 5123, 9)}});
    const Mesh mesh = load().meshes.at(0);
    for (std::size_t i = 0; i < 5; ++i) {
        double same = 0, opposite = 0;  // a quaternion and its negative are one rotation
        for (int k = 0; k < 4; ++k) {
            if (k < 3) {
                EXPECT_NEAR(mesh.positions[i][k], fan_positions[3 * i + std::size_t(k)], 3.f / 8192);
                EXPECT_NEAR(mesh.normals[i][k], normals[4 * i + std::size_t(k)], 0.02);
            }
            same = std::max(same, std::abs(double(mesh.colors[i][k] - quaternions[4 * i + std::size_t(k)])));
            opposite = std::max(opposite, std::abs(double(mesh.colors[i][k])));
        }
        EXPECT_LT(std::min(same, opposite), 2e-3) << "quaternion " << i;
    }
}

TEST_F(Meshopt, DamageIsAnError) {
    const int positions = compressed(encode_attributes(fan_positions, 12), 12, 5, "ATTRIBUTES");
    const int indices = compressed(encode_triangles(fan_indices, 5), 2, 9, "TRIANGLES");
    finish({{"attributes", {{"POSITION", accessor(positions, "VEC3", 5126, 5)}}},
            {"indices", accessor(indices, "SCALAR", 5123, 9)}});
    const json good = builder.root;
    const auto refuse_with = [&](int view, const char* key, const json& value, const char* words) {
        builder.root = good;
        extension(view)[key] = value;
        refuse({"scene.gltf", "buffer view " + std::to_string(view), words});
    };
    refuse_with(positions, "mode", "POINTS", "unknown mode 'POINTS'");
    refuse_with(positions, "filter", "MAGIC", "filter 'MAGIC'");
    refuse_with(indices, "filter", "EXPONENTIAL", "filter 'EXPONENTIAL'");
    refuse_with(positions, "byteStride", 13, "have 13 bytes");
    refuse_with(positions, "filter", "QUATERNION", "have 12 bytes");
    refuse_with(indices, "byteStride", 12, "have 12 bytes");
    refuse_with(indices, "count", 8, "8 compressed indices");
    refuse_with(positions, "buffer", 7, "buffer 7 of 2");
    refuse_with(positions, "byteOffset", 1 << 20, "exceeds its buffer");
    refuse_with(positions, "byteLength", 9, "damaged");
    refuse_with(positions, "count", 2'000'000'000, "cut off");
    refuse_with(positions, "count", -5, "'count' is not an index or a size");
    refuse_with(indices, "byteOffset", 0, "damaged");
}
#endif

}  // namespace
}  // namespace claray
