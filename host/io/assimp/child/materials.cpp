#include <assimp/material.h>
#include <algorithm>
#include <cmath>
#include <optional>

#include "host/io/assimp/child/conversion.hpp"

namespace claray::assimp {
namespace {

/// RFC 3986, section 2.1.
std::string percent_encoded(const std::string& name) {
    std::string uri;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte) != 0 || std::string("-_.~/").find(c) != std::string::npos) {
            uri += c;
        } else {
            char code[4];
            std::snprintf(code, sizeof code, "%%%02X", byte);
            uri += code;
        }
    }
    return uri;
}

/// Texels without compression, as Assimp has them: blue, green, red, alpha.
std::string tga_of(const aiTexture& texture) {
    std::string bytes(18, '\0');
    bytes[2] = 2, bytes[16] = 32, bytes[17] = 0x28;  // colours, of 32 bits, 8 of them alpha, from the top left
    bytes[12] = char(texture.mWidth), bytes[13] = char(texture.mWidth >> 8);
    bytes[14] = char(texture.mHeight), bytes[15] = char(texture.mHeight >> 8);
    const std::span texels(texture.pcData, std::size_t(texture.mWidth) * texture.mHeight);
    for (const aiTexel& t : texels) bytes += {char(t.b), char(t.g), char(t.r), char(t.a)};
    return bytes;
}

bool is_set(float value) { return std::isfinite(value); }

class Materials {
public:
    Materials(Glb& glb, const aiScene& scene, const SceneFolder& folder, LeftOut& left_out)
        : glb_(glb), scene_(scene), folder_(folder), left_out_(left_out) {}

    void add(const aiMaterial& source);

private:
    [[nodiscard]] static std::optional<float> number(const aiMaterial& source, const char* key) {
        float value = 0;
        const bool found = source.Get(key, 0, 0, value) == aiReturn_SUCCESS && is_set(value);
        return found ? std::optional(value) : std::nullopt;
    }
    [[nodiscard]] static std::optional<aiColor3D> color(const aiMaterial& source, const char* key) {
        aiColor3D value;
        const bool found = source.Get(key, 0, 0, value) == aiReturn_SUCCESS;
        if (!found || !is_set(value.r) || !is_set(value.g) || !is_set(value.b)) return {};
        const auto clamped = [](float c) { return std::max(c, 0.f); };
        return aiColor3D(clamped(value.r), clamped(value.g), clamped(value.b));
    }

    void add_base(const aiMaterial& source, Json& material);
    void add_highlight(const aiMaterial& source, Json& material, Json& pbr);
    void add_emission(const aiMaterial& source, Json& material);
    void note_left_out(const aiMaterial& source);
    [[nodiscard]] std::optional<Json> texture(const aiMaterial& source, std::initializer_list<aiTextureType> types);
    [[nodiscard]] std::size_t image(const std::string& name);
    [[nodiscard]] std::size_t embedded_image(const aiTexture& texture);

    Glb& glb_;
    const aiScene& scene_;
    const SceneFolder& folder_;
    LeftOut& left_out_;
    std::map<std::string, std::size_t> images_;
    std::map<std::tuple<std::size_t, int, int>, std::size_t> textures_;
};

std::size_t Materials::embedded_image(const aiTexture& texture) {
    const bool is_file = texture.mHeight == 0;
    const std::string raw = is_file ? std::string() : tga_of(texture);
    const std::size_t view =
        is_file ? glb_.add_view(texture.pcData, texture.mWidth) : glb_.add_view(raw.data(), raw.size());
    return glb_.push("images", {{"bufferView", view}, {"mimeType", "image/png"}});  // its bytes tell what it is
}

std::size_t Materials::image(const std::string& name) {
    const auto known = images_.find(name);
    if (known != images_.end()) return known->second;
    const aiTexture* const embedded = scene_.GetEmbeddedTexture(name.c_str());
    const std::size_t index =
        embedded != nullptr
            ? embedded_image(*embedded)
            : glb_.push("images", {{"uri", percent_encoded(folder_.find(name).value_or(name))}, {"name", name}});
    return images_[name] = index;
}

int wrap_of(aiTextureMapMode mode) {
    return mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? 33071
           : mode == aiTextureMapMode_Mirror                                ? 33648
                                                                            : 10497;  // glTF 2.0, section 5.26
}

std::optional<Json> Materials::texture(const aiMaterial& source, std::initializer_list<aiTextureType> types) {
    for (const aiTextureType type : types) {
        aiString path;
        unsigned uv = 0;
        aiTextureMapMode modes[2] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
        if (source.GetTexture(type, 0, &path, nullptr, &uv, nullptr, nullptr, modes) != aiReturn_SUCCESS ||
            path.length == 0)
            continue;
        int set = int(uv);  // TransformUVCoords may have moved it
        source.Get(AI_MATKEY_UVWSRC(type, 0), set);
        if (set < 0 || set > 1) {
            ++left_out_["textures with coordinates beyond the second set"];
            return {};
        }
        const int wrap_u = wrap_of(modes[0]), wrap_v = wrap_of(modes[1]);
        const std::size_t shown = image(path.C_Str());
        const auto [known, is_new] = textures_.try_emplace({shown, wrap_u, wrap_v});
        if (is_new) {
            const std::size_t sampler = glb_.push("samplers", {{"wrapS", wrap_u}, {"wrapT", wrap_v}});
            known->second = glb_.push("textures", {{"source", shown}, {"sampler", sampler}});
        }
        return Json{{"index", known->second}, {"texCoord", set}};
    }
    return {};
}

/// Colours of a material, and how much of it there is.
void Materials::add_base(const aiMaterial& source, Json& material) {
    Json& pbr = material["pbrMetallicRoughness"];
    const std::optional<Json> map = texture(source, {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE});
    if (map) pbr["baseColorTexture"] = *map;
    std::optional<aiColor3D> base = color(source, "$clr.base");
    if (!base) base = color(source, "$clr.diffuse");
    if (!base) base = aiColor3D(map ? 1.f : 0.8f);
    // Programs that show the image instead of the colour write a black one.
    if (map && base->IsBlack()) base = aiColor3D(1.f);
    float opacity = std::clamp(number(source, "$mat.opacity").value_or(1.f), 0.f, 1.f);
    if (opacity == 0.f) {  // files that count transparency the other way round
        ++left_out_["materials' opacities of 0"];
        opacity = 1.f;
    }
    pbr["baseColorFactor"] = {std::min(base->r, 1.f), std::min(base->g, 1.f), std::min(base->b, 1.f), opacity};
    aiString opacities, colors;
    const bool has_map = source.GetTexture(aiTextureType_OPACITY, 0, &opacities) == aiReturn_SUCCESS;
    const bool in_alpha = has_map && map &&
                          (source.GetTexture(aiTextureType_DIFFUSE, 0, &colors) == aiReturn_SUCCESS ||
                           source.GetTexture(aiTextureType_BASE_COLOR, 0, &colors) == aiReturn_SUCCESS) &&
                          opacities == colors;
    if (opacity < 1.f || in_alpha) material["alphaMode"] = "BLEND";
    left_out_["opacity maps of their own"] += has_map && !in_alpha;
}

/// A highlight of Phong or Blinn, as a dielectric whose reflectance of 0.04 is tinted by its colour. Its exponent gives
/// the roughness, alpha^2 = 2 / (n + 2) (Walter et al. 2007).
void Materials::add_highlight(const aiMaterial& source, Json& material, Json& pbr) {
    const std::optional<float> metallic = number(source, "$mat.metallicFactor"),
                               rough = number(source, "$mat.roughnessFactor");
    const std::optional<Json> metal_map = texture(source, {aiTextureType_METALNESS}),
                              rough_map = texture(source, {aiTextureType_DIFFUSE_ROUGHNESS});
    const bool same_map = metal_map && rough_map && *metal_map == *rough_map;
    if (same_map) pbr["metallicRoughnessTexture"] = *metal_map;
    left_out_["maps of metalness or roughness alone"] += !same_map && (metal_map || rough_map);
    pbr["metallicFactor"] = std::clamp(metallic.value_or(same_map ? 1.f : 0.f), 0.f, 1.f);
    const std::optional<float> shininess = number(source, "$mat.shininess");
    // Of Phong's materials Assimp states a roughness, too.
    const bool is_physical = metallic || same_map || (rough && !shininess);
    const float exponent = std::max(shininess.value_or(0.f), 0.f);
    const float of_exponent = std::sqrt(std::sqrt(2.f / (exponent + 2.f)));
    pbr["roughnessFactor"] = std::clamp(is_physical ? rough.value_or(1.f) : of_exponent, 0.f, 1.f);
    if (is_physical) return;

    int shading = aiShadingMode_Phong;
    source.Get(AI_MATKEY_SHADING_MODEL, shading);
    const bool matt = shading == aiShadingMode_Flat || shading == aiShadingMode_Gouraud || exponent == 0.f;
    const float strength = std::max(number(source, "$mat.shinpercent").value_or(1.f), 0.f);
    const aiColor3D tint = color(source, "$clr.specular").value_or(aiColor3D(0.f)) * (matt ? 0.f : strength);
    const float weight = std::max({tint.r, tint.g, tint.b});
    Json specular = {{"specularFactor", std::min(weight, 1.f)}};
    if (weight > 0) specular["specularColorFactor"] = {tint.r / weight, tint.g / weight, tint.b / weight};
    if (weight > 0)
        if (const std::optional<Json> map = texture(source, {aiTextureType_SPECULAR}))
            specular["specularColorTexture"] = *map;
    material["extensions"]["KHR_materials_specular"] = specular;
    glb_.use("KHR_materials_specular");
}

void Materials::add_emission(const aiMaterial& source, Json& material) {
    const std::optional<Json> map = texture(source, {aiTextureType_EMISSION_COLOR, aiTextureType_EMISSIVE});
    aiColor3D emission = color(source, "$clr.emissive").value_or(aiColor3D(0.f));
    if (map && emission.IsBlack()) emission = aiColor3D(1.f);
    const float strength = std::max({emission.r, emission.g, emission.b, 1.f});
    if (map) material["emissiveTexture"] = *map;
    material["emissiveFactor"] = {emission.r / strength, emission.g / strength, emission.b / strength};
    if (strength <= 1.f) return;
    material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
    glb_.use("KHR_materials_emissive_strength");
}

void Materials::note_left_out(const aiMaterial& source) {
    constexpr std::pair<aiTextureType, const char*> maps[] = {{aiTextureType_HEIGHT, "bump maps"},
                                                              {aiTextureType_DISPLACEMENT, "displacement maps"},
                                                              {aiTextureType_REFLECTION, "reflection maps"},
                                                              {aiTextureType_SHININESS, "shininess maps"},
                                                              {aiTextureType_LIGHTMAP, "light maps"}};
    for (const auto& [type, name] : maps) left_out_[name] += source.GetTextureCount(type) > 0;
    left_out_["layers of colour beyond the first"] += source.GetTextureCount(aiTextureType_DIFFUSE) > 1;
}

void Materials::add(const aiMaterial& source) {
    aiString name;
    source.Get(AI_MATKEY_NAME, name);
    Json material = {{"name", name.C_Str()}, {"doubleSided", true}, {"pbrMetallicRoughness", Json::object()}};
    add_base(source, material);
    add_highlight(source, material, material["pbrMetallicRoughness"]);
    add_emission(source, material);
    if (const std::optional<Json> map = texture(source, {aiTextureType_NORMAL_CAMERA, aiTextureType_NORMALS}))
        material["normalTexture"] = *map;
    note_left_out(source);
    glb_.push("materials", std::move(material));
}

}  // namespace

void add_materials(Glb& glb, const aiScene& scene, const SceneFolder& folder, LeftOut& left_out) {
    Materials materials(glb, scene, folder, left_out);
    for (const aiMaterial* material : std::span(scene.mMaterials, scene.mNumMaterials)) materials.add(*material);
}

}  // namespace claray::assimp
