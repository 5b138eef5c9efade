#include "host/io/gltf/materials/gltf_material.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/gltf/decode/gltf_value.hpp"

namespace claray {
namespace {

using std::to_string;

/// Of a dielectric with an index of refraction of 1.5, at normal incidence.
constexpr float reflectance_at_1_5 = 0.04f;

glm::vec3 color(const std::vector<double>& values, const glm::vec3& fallback) {
    return values.size() < 3 ? fallback : glm::vec3(float(values[0]), float(values[1]), float(values[2]));
}

Wrap wrap_of(int mode, const GltfFile& file) {
    switch (mode) {
        case TINYGLTF_TEXTURE_WRAP_REPEAT: return Wrap::repeat;
        case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE: return Wrap::clamp;
        case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT: return Wrap::mirror;
        default: file.fail("a sampler has the unknown wrap mode " + to_string(mode));
    }
}

/// What is not said is filtered as well as can be; mip levels are left out where the file does.
Filter filter_of(const tinygltf::Sampler& sampler) {
    if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) return Filter::nearest;
    const bool no_levels =
        sampler.minFilter == TINYGLTF_TEXTURE_FILTER_NEAREST || sampler.minFilter == TINYGLTF_TEXTURE_FILTER_LINEAR;
    return no_levels ? Filter::bilinear : Filter::trilinear;
}

/// Green: 1 - alpha * `factor`, as KHR_materials_pbrSpecularGlossiness keeps glossiness in alpha.
Texture roughness_of_glossiness(Texture image, float factor) {
    const bool has_alpha = image.channels % 2 == 0, real = image.format == TexelFormat::float32;
    Texture result = image;
    result.channels = 3;
    result.bytes.clear(), result.floats.clear();
    for (std::size_t i = 0; i < std::size_t(image.width) * image.height; ++i) {
        const std::size_t alpha = i * image.channels + image.channels - 1;
        const float gloss = !has_alpha ? 1.f : real ? image.floats[alpha] : float(image.bytes[alpha]) / 255.f;
        const float roughness = std::clamp(1.f - gloss * factor, 0.f, 1.f);
        if (real)
            result.floats.insert(result.floats.end(), {0.f, roughness, 0.f});
        else
            result.bytes.insert(result.bytes.end(), {0, std::uint8_t(std::lround(255.f * roughness)), 0});
    }
    return result;
}

/// Only the base colour counts, and it is no lamp.
void make_unlit(Material& m) {
    Material unlit;
    unlit.name = m.name, unlit.kind = MaterialKind::unlit;
    unlit.albedo = m.albedo, unlit.albedo_map = m.albedo_map;
    unlit.opacity = m.opacity, unlit.alpha_mode = m.alpha_mode, unlit.alpha_cutoff = m.alpha_cutoff;
    unlit.cull_back = m.cull_back;
    m = unlit;
}

}  // namespace

std::uint32_t GltfMaterials::index_of(int material, const std::string& user) {
    const std::size_t count = file_.model.materials.size();
    if (material >= 0 && std::size_t(material) >= count)
        file_.fail(user + " refers to material " + to_string(material) + " of " + to_string(count));
    std::uint32_t& index = known_[material < 0 ? count : std::size_t(material)];
    if (index != unknown) return index;
    index = std::uint32_t(scene_.materials.size());
    static const tinygltf::Material standard;
    const tinygltf::Material& source = material < 0 ? standard : file_.model.materials[std::size_t(material)];
    used_sets_ = {no_set, no_set};
    Material made =
        make(source, material < 0 ? "the default material" : gltf_name("material", source.name, std::size_t(material)));
    scene_.materials.push_back(std::move(made));
    for (int slot = 0; slot < 2; ++slot)
        if (used_sets_[std::size_t(slot)] == no_set) used_sets_[std::size_t(slot)] = slot;
    uv_sets_.push_back(used_sets_);
    return index;
}

/// Of two places for sets of coordinates, the one of a set: of sets 0 and 1 their own if it is free.
std::optional<std::uint32_t> GltfMaterials::slot_of(int uv_set) {
    const std::uint32_t wanted = uv_set == 1 ? 1 : 0;
    for (const std::uint32_t slot : {wanted, 1 - wanted})
        if (used_sets_[slot] == uv_set) return slot;
    for (const std::uint32_t slot : {wanted, 1 - wanted})
        if (used_sets_[slot] == no_set) return used_sets_[slot] = uv_set, slot;
    return {};
}

// A texture whose factor is 0 changes nothing and is not loaded.
Material GltfMaterials::make(const tinygltf::Material& source, const std::string& name) {
    const tinygltf::PbrMetallicRoughness& base = source.pbrMetallicRoughness;
    Material material;
    material.name = source.name;
    material.kind = MaterialKind::principled;
    material.albedo = color(base.baseColorFactor, glm::vec3(1.f));
    material.opacity = base.baseColorFactor.size() > 3 ? float(base.baseColorFactor[3]) : 1.f;
    material.metallic = float(base.metallicFactor);
    material.roughness = float(base.roughnessFactor);
    material.emission = color(source.emissiveFactor, glm::vec3(0.f));
    material.cull_back = !source.doubleSided;
    material.alpha_cutoff = float(source.alphaCutoff);
    if (source.alphaMode == "MASK")
        material.alpha_mode = AlphaMode::mask;
    else if (source.alphaMode == "BLEND")
        material.alpha_mode = AlphaMode::blend;
    else if (source.alphaMode != "OPAQUE")
        file_.fail(name + " has the unknown alpha mode '" + source.alphaMode + "'");

    material.albedo_map = use(base.baseColorTexture.index, base.baseColorTexture.texCoord,
                              base.baseColorTexture.extensions, TexelFormat::srgb8, name);
    if (base.baseColorTexture.index >= 0) show_missing(material);
    if (material.metallic != 0.f || material.roughness != 0.f)
        material.metallic_roughness_map =
            use(base.metallicRoughnessTexture.index, base.metallicRoughnessTexture.texCoord,
                base.metallicRoughnessTexture.extensions, TexelFormat::linear8, name);
    material.normal_map = use(source.normalTexture.index, source.normalTexture.texCoord,
                              source.normalTexture.extensions, TexelFormat::linear8, name);
    material.normal_scale = float(source.normalTexture.scale);
    if (material.emission != glm::vec3(0.f))
        material.emission_map = use(source.emissiveTexture.index, source.emissiveTexture.texCoord,
                                    source.emissiveTexture.extensions, TexelFormat::srgb8, name);
    if (source.emissiveTexture.index >= 0 && !material.emission_map.used()) material.emission = glm::vec3(0.f);
    add_extensions(material, source, name);
    return material;
}

void GltfMaterials::add_extensions(Material& material, const tinygltf::Material& source, const std::string& name) {
    const auto& all = source.extensions;
    material.emission *= gltf_number(gltf_extension(all, "KHR_materials_emissive_strength"), "emissiveStrength", 1.f);

    material.ior = gltf_number(gltf_extension(all, "KHR_materials_ior"), "ior", 1.5f);
    // The extension's way to leave the reflectance at normal incidence to KHR_materials_specular alone.
    const bool reflects_all = material.ior == 0.f;
    if (reflects_all) material.ior = 1.5f;

    add_transmission(material, all, name);
    add_clearcoat(material, gltf_extension(all, "KHR_materials_clearcoat"), name);
    add_specular(material, gltf_extension(all, "KHR_materials_specular"), name);
    if (reflects_all) material.specular_tint /= reflectance_at_1_5;
    add_sheen(material, gltf_extension(all, "KHR_materials_sheen"), name);
    add_anisotropy(material, gltf_extension(all, "KHR_materials_anisotropy"), name);
    add_iridescence(material, gltf_extension(all, "KHR_materials_iridescence"), name);
    add_glossiness(material, gltf_extension(all, "KHR_materials_pbrSpecularGlossiness"), name);
    if (reflects_all && material.transmission > 0.f)
        warnings_.push_back(name + " transmits light and has an index of refraction of 0: refraction uses 1.5");
    if (all.contains("KHR_materials_unlit")) make_unlit(material);
    if (material.transmission > 0.f && material.anisotropy > 0.f)
        warnings_.push_back(name + ": KHR_materials_anisotropy is not applied to transmitted light");
}

void GltfMaterials::add_transmission(Material& material, const tinygltf::ExtensionMap& all, const std::string& name) {
    const tinygltf::Value& transmission = gltf_extension(all, "KHR_materials_transmission");
    material.transmission = gltf_number(transmission, "transmissionFactor", 0.f);
    if (material.transmission != 0.f) material.transmission_map = use(transmission, "transmissionTexture", name);

    const tinygltf::Value& volume = gltf_extension(all, "KHR_materials_volume");
    material.attenuation = gltf_numbers<3>(volume, "attenuationColor", glm::vec3(1.f));
    material.attenuation_distance = gltf_number(volume, "attenuationDistance", 0.f);
    if (material.transmission == 0.f) return;
    material.thin_walled = gltf_number(volume, "thicknessFactor", 0.f) == 0.f;
    if (!material.thin_walled) material.cull_back = false;  // what enters a solid leaves by a back
}

void GltfMaterials::add_clearcoat(Material& material, const tinygltf::Value& clearcoat, const std::string& name) {
    material.clearcoat = gltf_number(clearcoat, "clearcoatFactor", 0.f);
    material.clearcoat_roughness = gltf_number(clearcoat, "clearcoatRoughnessFactor", 0.f);
    if (material.clearcoat == 0.f) return;
    material.clearcoat_map = use(clearcoat, "clearcoatTexture", name);
    material.clearcoat_roughness_map = use(clearcoat, "clearcoatRoughnessTexture", name);
    material.clearcoat_normal_map = use(clearcoat, "clearcoatNormalTexture", name);
    if (material.clearcoat_normal_map.used())
        material.clearcoat_normal_scale = gltf_number(clearcoat.Get("clearcoatNormalTexture"), "scale", 1.f);
}

void GltfMaterials::add_specular(Material& material, const tinygltf::Value& specular, const std::string& name) {
    material.specular_weight = gltf_number(specular, "specularFactor", 1.f);
    material.specular_tint = gltf_numbers<3>(specular, "specularColorFactor", glm::vec3(1.f));
    if (material.specular_weight == 0.f) return;
    material.specular_weight_map = use(specular, "specularTexture", name);
    if (material.specular_tint != glm::vec3(0.f))
        material.specular_map = use(specular, "specularColorTexture", name, TexelFormat::srgb8);
}

void GltfMaterials::add_sheen(Material& material, const tinygltf::Value& sheen, const std::string& name) {
    material.sheen = gltf_numbers<3>(sheen, "sheenColorFactor", glm::vec3(0.f));
    material.sheen_roughness = gltf_number(sheen, "sheenRoughnessFactor", 0.f);
    if (material.sheen == glm::vec3(0.f)) return;
    material.sheen_map = use(sheen, "sheenColorTexture", name, TexelFormat::srgb8);
    material.sheen_roughness_map = use(sheen, "sheenRoughnessTexture", name);
}

void GltfMaterials::add_anisotropy(Material& material, const tinygltf::Value& anisotropy, const std::string& name) {
    material.anisotropy = gltf_number(anisotropy, "anisotropyStrength", 0.f);
    material.anisotropy_rotation = gltf_number(anisotropy, "anisotropyRotation", 0.f);
    if (material.anisotropy != 0.f) material.anisotropy_map = use(anisotropy, "anisotropyTexture", name);
}

void GltfMaterials::add_iridescence(Material& material, const tinygltf::Value& iridescence, const std::string& name) {
    material.iridescence = gltf_number(iridescence, "iridescenceFactor", 0.f);
    material.iridescence_ior = gltf_number(iridescence, "iridescenceIor", 1.3f);
    material.film_thickness = {gltf_number(iridescence, "iridescenceThicknessMinimum", 100.f),
                               gltf_number(iridescence, "iridescenceThicknessMaximum", 400.f)};
    if (material.iridescence == 0.f) return;
    material.iridescence_map = use(iridescence, "iridescenceTexture", name);
    material.film_thickness_map = use(iridescence, "iridescenceThicknessTexture", name);
}

// A dielectric of index 1.5 whose reflectance at normal incidence, 0.04, is tinted into the specular colour; what that
// does not reflect enters the diffuse base.
void GltfMaterials::add_glossiness(Material& material, const tinygltf::Value& glossiness, const std::string& name) {
    if (!glossiness.IsObject()) return;
    const glm::vec4 diffuse = gltf_numbers<4>(glossiness, "diffuseFactor", glm::vec4(1.f));
    const float gloss = gltf_number(glossiness, "glossinessFactor", 1.f);
    material.albedo = glm::vec3(diffuse), material.opacity = diffuse.w;
    material.metallic = 0.f, material.ior = 1.5f;
    material.albedo_map = use(glossiness, "diffuseTexture", name, TexelFormat::srgb8);
    if (glossiness.Has("diffuseTexture")) show_missing(material);
    material.specular_weight = 1.f;
    material.specular_tint = gltf_numbers<3>(glossiness, "specularFactor", glm::vec3(1.f)) / reflectance_at_1_5;
    material.specular_map = use(glossiness, "specularGlossinessTexture", name, TexelFormat::srgb8);
    const Change to_roughness{" roughness of glossiness " + to_string(gloss),
                              [gloss](Texture image) { return roughness_of_glossiness(std::move(image), gloss); }};
    material.metallic_roughness_map =
        use(glossiness, "specularGlossinessTexture", name, TexelFormat::linear8, to_roughness);
    material.roughness = material.metallic_roughness_map.used() ? 1.f : 1.f - gloss;
}

TextureUse GltfMaterials::use(int index, int uv_set, const tinygltf::ExtensionMap& extensions, TexelFormat format,
                              const std::string& user, const Change& change) {
    TextureUse result;
    if (index < 0) return result;
    const tinygltf::Value& transform = gltf_extension(extensions, "KHR_texture_transform");
    result.offset = gltf_numbers<2>(transform, "offset", glm::vec2(0.f));
    result.scale = gltf_numbers<2>(transform, "scale", glm::vec2(1.f));
    result.rotation = gltf_number(transform, "rotation", 0.f);
    const int set = gltf_index(transform, "texCoord", uv_set);
    if (set < 0) file_.fail(user + ": a texture has coordinates of no number");
    const std::optional<std::uint32_t> image = texture(index, format, user, change);
    if (!image) return {};
    const std::optional<std::uint32_t> slot = slot_of(set);
    if (!slot) {
        warnings_.push_back(user + ": a texture with coordinates TEXCOORD_" + to_string(set) +
                            " is left out, a material has at most two sets of coordinates");
        return {};
    }
    result.uv_set = *slot;
    result.texture = *image;
    return result;
}

TextureUse GltfMaterials::use(const tinygltf::Value& object, const char* key, const std::string& user,
                              TexelFormat format, const Change& change) {
    if (!object.IsObject() || !object.Has(key)) return {};
    const tinygltf::Value& info = object.Get(key);
    tinygltf::ExtensionMap extensions;
    if (info.IsObject() && info.Has("extensions") && info.Get("extensions").IsObject())
        extensions = info.Get("extensions").Get<tinygltf::Value::Object>();
    return use(gltf_index(info, "index", -1), gltf_index(info, "texCoord", 0), extensions, format, user, change);
}

/// The image of a texture: by an extension that claray reads, else the plain one; -1 if there is none at all.
int GltfMaterials::source_of(const tinygltf::Texture& texture, const std::string& name) const {
    const int webp =
        CLARAY_WITH_WEBP ? gltf_index(gltf_extension(texture.extensions, "EXT_texture_webp"), "source", -1) : -1;
    if (webp >= 0) return webp;
    if (texture.source >= 0) return texture.source;
    const int basis = gltf_index(gltf_extension(texture.extensions, "KHR_texture_basisu"), "source", -1);
    if (basis >= 0) return basis;
    if (texture.extensions.empty()) return -1;
    file_.fail(name + " only has an image of the extension '" + texture.extensions.begin()->first +
                   "', which claray cannot decode",
               "export images as PNG or JPEG");
}

std::optional<std::uint32_t> GltfMaterials::texture(int index, TexelFormat format, const std::string& user,
                                                    const Change& change) {
    const tinygltf::Model& model = file_.model;
    if (std::size_t(index) >= model.textures.size())
        file_.fail(user + " refers to texture " + to_string(index) + " of " + to_string(model.textures.size()));
    const tinygltf::Texture& texture = model.textures[std::size_t(index)];
    const std::string name = gltf_name("texture", texture.name, std::size_t(index));
    const int source = source_of(texture, name);
    if (source < 0) {
        warnings_.push_back("'" + file_.path.string() + "': " + name +
                            " has no image, and what it would colour is grey");
        return {};
    }
    images_.check(source, name);
    TextureSettings settings;
    settings.eight_bit = format;
    if (texture.sampler >= 0) {
        if (std::size_t(texture.sampler) >= model.samplers.size())
            file_.fail(name + " refers to sampler " + to_string(texture.sampler) + " of " +
                       to_string(model.samplers.size()));
        const tinygltf::Sampler& sampler = model.samplers[std::size_t(texture.sampler)];
        settings.wrap_u = wrap_of(sampler.wrapS, file_);
        settings.wrap_v = wrap_of(sampler.wrapT, file_);
        settings.filter = filter_of(sampler);
    }
    return textures_.add(to_string(source) + change.name, settings, [&](TexelFormat eight_bit, std::size_t room) {
        std::optional<Texture> image = images_.decode(source, eight_bit, room);
        return image && change.apply ? change.apply(*std::move(image)) : image;
    });
}

}  // namespace claray
