// The layers and the header of an EXR with Cryptomattes.
#include <bit>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "claray/io.hpp"

namespace claray {
namespace {

std::string hexadecimal(std::uint32_t hash) {
    char text[9];
    std::snprintf(text, sizeof text, "%08x", hash);
    return text;
}

/// A colour for each id, as a picture shows it.
glm::vec3 color_of(float id) {
    const auto bits = std::bit_cast<std::uint32_t>(id);
    return glm::vec3(float(bits & 255), float(bits >> 8 & 255), float(bits >> 16 & 255)) / 255.f;
}

ImageLayer preview_of(const Cryptomatte& matte) {
    ImageLayer layer{.name = matte.name};
    for (std::size_t i = 0; i < matte.parts.size(); i += matte.ranks) {
        glm::vec3 sum(0.f);
        for (unsigned rank = 0; rank < matte.ranks; ++rank)
            sum += matte.parts[i + rank].coverage * color_of(matte.parts[i + rank].id);
        layer.values.insert(layer.values.end(), {sum.r, sum.g, sum.b});
    }
    return layer;
}

}  // namespace

std::vector<ImageLayer> layers_of(const Cryptomatte& matte) {
    std::vector<ImageLayer> layers = {preview_of(matte)};
    for (unsigned rank = 0; rank < matte.ranks; rank += 2) {
        char number[12];
        std::snprintf(number, sizeof number, "%02u", rank / 2);
        ImageLayer& layer = layers.emplace_back(ImageLayer{.name = matte.name + number, .channels = "RGBA"});
        for (std::size_t i = rank; i < matte.parts.size(); i += matte.ranks) {
            const MattePart &first = matte.parts[i], &second = matte.parts[i + 1];
            layer.values.insert(layer.values.end(), {first.id, first.coverage, second.id, second.coverage});
        }
    }
    return layers;
}

ImageAttributes attributes_of(const Cryptomatte& matte) {
    nlohmann::ordered_json names = nlohmann::ordered_json::object();
    for (const auto& [name, hash] : matte.manifest) names[name] = hexadecimal(hash);
    const std::string key = "cryptomatte/" + hexadecimal(matte_hash(matte.name)).substr(0, 7) + "/";
    const auto replaced = nlohmann::ordered_json::error_handler_t::replace;  // of what is no UTF-8
    return {{key + "name", matte.name},
            {key + "hash", "MurmurHash3_32"},
            {key + "conversion", "uint32_to_float32"},
            {key + "manifest", names.dump(-1, ' ', false, replaced)}};
}

}  // namespace claray
