#include "host/textures/textures.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <initializer_list>
#include <map>
#include <utility>

#include "host/bsdf/material_data.hpp"
#include "host/textures/cutouts.hpp"
#include "host/textures/mip_map.hpp"
#include "host/textures/texture_use.hpp"

namespace claray {
namespace {

// Kernels read these as numbers.
template <class Enum>
constexpr bool are_numbered(std::initializer_list<std::pair<Enum, std::uint32_t>> members) {
    return std::all_of(members.begin(), members.end(), [](auto& m) { return std::uint32_t(m.first) == m.second; });
}
static_assert(are_numbered<Wrap>(
    {{Wrap::repeat, CLARAY_REPEAT}, {Wrap::mirror, CLARAY_MIRRORED}, {Wrap::clamp, CLARAY_CLAMPED}}));
static_assert(are_numbered<Filter>({{Filter::nearest, CLARAY_NEAREST},
                                    {Filter::bilinear, CLARAY_BILINEAR},
                                    {Filter::trilinear, CLARAY_TRILINEAR},
                                    {Filter::nearest_level, CLARAY_NEAREST_LEVEL}}));
static_assert(are_numbered<TexelFormat>({{TexelFormat::srgb8, CLARAY_SRGB8},
                                         {TexelFormat::linear8, CLARAY_LINEAR8},
                                         {TexelFormat::float32, CLARAY_FLOAT32}}));

/// The maps that a material of this kind uses, at their CLARAY_..._MAP.
std::array<TextureUse, CLARAY_MAPS> maps_of(const Material& m) {
    std::array<TextureUse, CLARAY_MAPS> maps;
    maps[CLARAY_ALBEDO_MAP] = m.albedo_map;
    if (has_emission_map(m)) maps[CLARAY_EMISSION_MAP] = m.emission_map;
    maps[CLARAY_HEIGHT_MAP] = m.height_map;
    maps[CLARAY_NORMAL_MAP] = m.normal_map;
    const MaterialKind kind = kind_of(m);
    const bool principled = kind == MaterialKind::principled;
    if (reads_roughness(kind)) maps[CLARAY_METALLIC_ROUGHNESS_MAP] = m.metallic_roughness_map;
    if (principled) {
        maps[CLARAY_TRANSMISSION_MAP] = m.transmission_map;
        maps[CLARAY_CLEARCOAT_MAP] = m.clearcoat_map;
        maps[CLARAY_CLEARCOAT_ROUGHNESS_MAP] = m.clearcoat_roughness_map;
    }
    if (kind == MaterialKind::blinn_phong) {
        maps[CLARAY_SPECULAR_MAP] = m.specular_map;
        maps[CLARAY_SHININESS_MAP] = m.shininess_map;
    }
    if (has_specular_layer(m)) {
        maps[CLARAY_SPECULAR_MAP] = m.specular_map;
        maps[CLARAY_SPECULAR_WEIGHT_MAP] = m.specular_weight_map;
    }
    if (has_sheen(m)) {
        maps[CLARAY_SHEEN_MAP] = m.sheen_map;
        maps[CLARAY_SHEEN_ROUGHNESS_MAP] = m.sheen_roughness_map;
    }
    if (is_anisotropic(m)) maps[CLARAY_ANISOTROPY_MAP] = m.anisotropy_map;
    if (has_film(m)) {
        maps[CLARAY_IRIDESCENCE_MAP] = m.iridescence_map;
        maps[CLARAY_FILM_THICKNESS_MAP] = m.film_thickness_map;
    }
    if (has_layered_coat(m)) maps[CLARAY_COAT_NORMAL_MAP] = m.clearcoat_normal_map;
    if (kind == MaterialKind::lambert) maps[CLARAY_LIGHT_MAP] = m.light_map;
    return maps;
}

/// An anisotropic material without an image gets one, because it needs texture coordinates.
bool lacks_direction(const Material& m) { return is_anisotropic(m) && !m.anisotropy_map.used(); }

bool needs_tangents(std::uint32_t map) {
    return map == CLARAY_NORMAL_MAP || map == CLARAY_COAT_NORMAL_MAP || map == CLARAY_ANISOTROPY_MAP;
}

/// A growing store; its sections begin at multiples of 16 bytes.
class StoreWriter {
public:
    StoreWriter() : words_(sizeof(TextureStore) / 4) {}

    std::uint32_t begin_section() {
        words_.resize((words_.size() + 3) / 4 * 4);
        if (words_.size() > 0xfffffff0u)
            throw Error(ErrorKind::user, "the textures take more than 16 GiB", "use smaller textures");
        return std::uint32_t(words_.size());
    }
    template <class T>
    std::uint32_t add(const std::vector<T>& values) {
        const std::uint32_t at = begin_section();
        words_.resize(words_.size() + values.size() * sizeof(T) / 4);
        std::memcpy(words_.data() + at, values.data(), values.size() * sizeof(T));
        return at;
    }
    [[nodiscard]] const std::vector<std::uint32_t>& finish(const TextureStore& sections) {
        std::memcpy(words_.data(), &sections, sizeof sections);
        return words_;
    }

private:
    std::vector<std::uint32_t> words_;
};

/// Collects the textures of used materials.
class Collector {
public:
    Collector(const Scene& scene, const std::vector<bool>& used)
        : scene_(scene), of_materials_(scene.materials.size()) {
        for (std::size_t i = 0; i < scene.materials.size(); ++i) {
            MaterialMaps& maps = of_materials_[i];
            std::fill(std::begin(maps.use), std::end(maps.use), CLARAY_NO_MAP);
            maps.normal_scale = scene.materials[i].normal_scale, maps.height_scale = scene.materials[i].height_scale;
            maps.coat_normal_scale = scene.materials[i].clearcoat_normal_scale;
            if (used[i]) add_maps(scene.materials[i], maps);
        }
    }

    unsigned uv_sets = 0;
    bool mipmaps = false, tangents = false;

    [[nodiscard]] bool empty() const { return textures_.empty(); }
    [[nodiscard]] bool has_maps() const { return !uses_.empty(); }

    /// Returns the texture's index in the store and marks it for upload.
    std::uint32_t slot_of(std::uint32_t texture) {
        const Texture& t = checked_texture(scene_, texture);
        const auto [at, fresh] = slots_.try_emplace(texture, std::uint32_t(textures_.size()));
        if (fresh) {
            textures_.push_back(texture);
            mipmaps = mipmaps || levels_of(t) > 1;
        }
        return at->second;
    }

    /// Writes images, uses and materials; returns the bytes of the images.
    std::uint64_t write(StoreWriter& store, TextureStore& sections) const {
        if (!empty()) sections.decode = store.add(decode_tables());
        std::vector<TextureData> data;
        std::uint64_t bytes = 0;
        for (const std::uint32_t index : textures_)
            data.push_back(write_texture(store, index == no_texture ? no_direction() : scene_.textures[index], bytes));
        sections.textures = store.add(data);
        sections.uses = store.add(uses_);
        sections.materials = store.add(of_materials_);
        return bytes;
    }

private:
    void add_use(MaterialMaps& maps, std::uint32_t map, const TextureUse& use, std::uint32_t slot) {
        maps.use[map] = std::uint32_t(uses_.size());
        tangents = tangents || needs_tangents(map);
        uv_sets |= 1u << use.uv_set;
        uses_.push_back(data_of(use, slot));
    }

    /// The slot of the image of materials that lack one.
    std::uint32_t slot_of_no_direction() {
        const auto [at, fresh] = slots_.try_emplace(no_texture, std::uint32_t(textures_.size()));
        if (fresh) textures_.push_back(no_texture);
        return at->second;
    }

    void add_maps(const Material& material, MaterialMaps& maps) {
        const std::array<TextureUse, CLARAY_MAPS> uses = maps_of(material);
        for (std::uint32_t map = 0; map < CLARAY_MAPS; ++map) {
            if (!uses[map].used()) continue;
            add_use(maps, map, uses[map], slot_of(uses[map].texture));
        }
        if (!lacks_direction(material)) return;
        TextureUse use;
        use.uv_set = material.normal_map.used() ? material.normal_map.uv_set : 0;
        add_use(maps, CLARAY_ANISOTROPY_MAP, use, slot_of_no_direction());
    }

    /// A texel with the direction of the tangent and strength 1.
    static Texture no_direction() {
        Texture texture;
        texture.width = texture.height = 1, texture.channels = 3;
        texture.format = TexelFormat::float32, texture.filter = Filter::nearest;
        texture.floats = {1.f, 0.5f, 1.f};
        return texture;
    }

    static unsigned levels_of(const Texture& t) { return reads_levels(t.filter) ? mip_levels(t.width, t.height) : 1; }

    static TextureData write_texture(StoreWriter& store, const Texture& t, std::uint64_t& bytes) {
        TextureData data{};
        data.width = t.width, data.height = t.height, data.channels = t.channels;
        data.levels = levels_of(t);
        data.format = std::uint32_t(t.format), data.filter = std::uint32_t(t.filter);
        data.wrap_u = std::uint32_t(t.wrap_u), data.wrap_v = std::uint32_t(t.wrap_v);
        const std::vector<std::vector<std::uint32_t>> levels = packed_levels(t, data.levels);
        for (std::size_t level = 0; level < levels.size(); ++level) {
            data.offset[level] = store.add(levels[level]);
            bytes += 4 * levels[level].size();
        }
        return data;
    }

    static std::vector<float> decode_tables() {
        std::vector<float> tables;
        for (int i = 0; i < 256; ++i) tables.push_back(float(i) / 255.f);
        for (int i = 0; i < 256; ++i) tables.push_back(decode_srgb(std::uint8_t(i)));
        return tables;
    }

    const Scene& scene_;
    std::vector<MaterialMaps> of_materials_;
    std::vector<TextureUseData> uses_;
    std::vector<std::uint32_t> textures_;  // of the scene, in the order of the store
    std::map<std::uint32_t, std::uint32_t> slots_;
};

std::vector<glm::vec3> all_colors(const Scene& scene) {
    const std::vector<glm::vec4> all = of_all_meshes(scene, &Mesh::colors, glm::vec4(1.f));
    return {all.begin(), all.end()};
}

std::size_t triangles_of(const Scene& scene) {
    std::size_t triangles = 0;
    for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
    return triangles;
}

void add_cutouts(const Cutouts& cutouts, std::size_t triangles, StoreWriter& writer, TextureStore& sections) {
    sections.cutout_materials = writer.add(cutouts.materials);
    const std::uint32_t records = writer.add(cutouts.records);
    std::vector<std::uint32_t> of_triangles = cutouts.of_triangles;
    for (std::uint32_t& at : of_triangles)
        if (at != CLARAY_NO_MAP) at += records;
    of_triangles.resize(triangles, CLARAY_NO_MAP);  // none if all are solid
    sections.cutouts = writer.add(of_triangles);
}

}  // namespace

std::uint32_t bits_of_maps(const Material& material) {
    const std::array<TextureUse, CLARAY_MAPS> uses = maps_of(material);
    std::uint32_t bits = lacks_direction(material) ? 1u << CLARAY_ANISOTROPY_MAP : 0;
    for (std::uint32_t map = 0; map < CLARAY_MAPS; ++map) bits |= uses[map].used() ? 1u << map : 0;
    return bits;
}

bool has_colors(const Mesh& mesh) {
    return std::any_of(mesh.colors.begin(), mesh.colors.end(),
                       [](const glm::vec4& color) { return glm::vec3(color) != glm::vec3(1.f); });
}

Textures::Textures(const Device& device, const Scene& scene, bool with_cutouts) {
    const std::vector<bool> used = used_materials(scene);
    Collector found(scene, used);
    const Cutouts cutouts(scene, used, [&](std::uint32_t texture) { return found.slot_of(texture); });
    culls_back_faces = culls_everywhere(scene, used);
    const bool colors = std::any_of(scene.meshes.begin(), scene.meshes.end(), has_colors);
    has_maps = found.has_maps() || colors, has_cutouts = with_cutouts || !cutouts.empty();
    if (!has_maps && !has_cutouts) return;
    mipmaps = found.mipmaps;
    StoreWriter writer;
    TextureStore sections{};
    texel_bytes = found.write(writer, sections);
    if (found.uv_sets & 1u) sections.uvs[0] = writer.add(of_all_meshes(scene, &Mesh::uvs));
    if (found.uv_sets & 2u) sections.uvs[1] = writer.add(of_all_meshes(scene, &Mesh::uvs1));
    const bool tangents =
        std::any_of(scene.meshes.begin(), scene.meshes.end(), [](auto& m) { return !m.tangents.empty(); });
    if (found.tangents && tangents) sections.tangents = writer.add(of_all_meshes(scene, &Mesh::tangents));
    if (colors) sections.colors = writer.add(all_colors(scene));
    if (has_cutouts) add_cutouts(cutouts, triangles_of(scene), writer, sections);
    store = Buffer<std::uint32_t>(device, writer.finish(sections));
}

}  // namespace claray
