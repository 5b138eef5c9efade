#include "host/render/scene_buffers.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "host/bsdf/material_data.hpp"
#include "host/effects/parts/part.hpp"
#include "host/textures/texture_use.hpp"

namespace claray {
namespace {

/// The materials that some triangle uses.
std::vector<Material> materials_in_use(const Scene& scene) {
    const std::vector<bool> used = used_materials(scene);
    std::vector<Material> found;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i]) found.push_back(scene.materials[i]);
    return found;
}

std::vector<glm::vec3> all_normals(const Scene& scene) {
    const bool any = std::any_of(scene.meshes.begin(), scene.meshes.end(), [](auto& m) { return !m.normals.empty(); });
    return any ? of_all_meshes(scene, &Mesh::normals) : std::vector<glm::vec3>();
}

/// Of triangles, then of primitives: by their numbers in hits.
std::vector<std::uint32_t> all_triangle_materials(const Scene& scene) {
    std::vector<std::uint32_t> materials;
    for (const Mesh& mesh : scene.meshes) {
        materials.insert(materials.end(), mesh.materials.begin(), mesh.materials.end());
        if (mesh.materials.empty()) materials.resize(materials.size() + mesh.triangles.size(), 0);
    }
    const std::vector<std::uint32_t> of_primitives = materials_of_primitives(scene);
    materials.insert(materials.end(), of_primitives.begin(), of_primitives.end());
    return materials;
}

}  // namespace

/// Collects tables one after the other, each aligned for vectors.
class SceneBuffers::TableWriter {
public:
    template <class T>
    void add(const std::vector<T>& table, std::uint32_t& where) {
        static_assert(sizeof(T) % sizeof(std::uint32_t) == 0);
        where = CLARAY_NO_TABLE;
        if (table.empty()) return;
        const std::size_t begin = rounded_up(words_.size());
        if (begin >= CLARAY_NO_TABLE) throw Error(ErrorKind::user, "the scene's tables are larger than 16 GB");
        words_.resize(begin + table.size() * sizeof(T) / sizeof(std::uint32_t));
        std::memcpy(&words_[begin], table.data(), table.size() * sizeof(T));
        tables_.emplace_back(&where, std::uint32_t(begin));
    }
    [[nodiscard]] const std::vector<std::uint32_t>& words() const { return words_; }
    /// Makes the offsets of the tables those of a section that begins here.
    void place(std::uint32_t begin) const {
        for (const auto& [where, offset] : tables_) *where = begin + offset;
    }
    static std::size_t rounded_up(std::size_t words) { return (words + alignment - 1) / alignment * alignment; }

private:
    static constexpr std::size_t alignment = 32;
    std::vector<std::uint32_t> words_;
    std::vector<std::pair<std::uint32_t*, std::uint32_t>> tables_;
};

SceneBuffers::TableWriter SceneBuffers::tables_of_meshes(const Scene& scene) {
    TableWriter writer;
    writer.add(all_normals(scene), where.normals);
    writer.add(all_triangle_materials(scene), where.triangle_materials);
    writer.add(std::exchange(on_host_->environment_texels, {}), where.environment_texels);
    writer.add(std::exchange(on_host_->environment_cdf, {}), where.environment_cdf);
    return writer;
}

SceneBuffers::TableWriter SceneBuffers::tables_of_materials(const Scene& scene) {
    const EnergyTables energy(materials_in_use(scene));
    std::vector<MaterialData> materials;
    for (const Material& material : scene.materials) {
        materials.push_back(material_data(material, energy));
        materials.back().maps = bits_of_maps(material);
        materials.back().shader = shader_of(material, shaders).value_or(0);  // 0: not used
    }
    TableWriter writer;
    writer.add(materials, where.materials);
    writer.add(energy.data(), where.energy);
    for (const Effect effect : all_effects())
        if (const auto tables = part_of(effect).tables)
            for (const auto& [member, words] : tables(scene)) writer.add(words, where.*member);
    return writer;
}

SceneBuffers::TableWriter SceneBuffers::tables_of_lights() {
    lights = on_host_->data;
    TableWriter writer;
    writer.add(on_host_->triangles, where.triangle_lights);
    writer.add(on_host_->punctual, where.punctual_lights);
    writer.add(on_host_->tree, where.light_tree);
    writer.add(on_host_->leaves, where.light_leaves);
    writer.add(on_host_->trails, where.light_trails);
    writer.add(on_host_->lists, where.light_lists);
    writer.add(on_host_->hot_spots, where.hot_spots);
    writer.add(on_host_->lamps, where.lamps);
    return writer;
}

SceneBuffers::SceneBuffers(const Device& device, const Scene& scene, const Structure& with, EffectSet added,
                           const LightSelection& selection, std::uint32_t light_grid, std::uint32_t listed_pixels,
                           std::uint32_t guide)
    : structure(with),
      effects(effects_of(scene)),
      shaders(shaders_of(scene)),
      on_host_(std::make_shared<Lights>(collect_lights(scene, selection))) {
    textures = Textures(device, scene, !(added & EffectSet{Effect::cut_outs, Effect::culling}).empty());
    structure.set_cutouts(textures.cutouts());
    const TableWriter meshes = tables_of_meshes(scene), materials = tables_of_materials(scene),
                      found = tables_of_lights();
    std::uint32_t end = place(meshes, 0).end();
    end = (of_materials_ = place(materials, end)).end();
    end = (of_lights_ = place(found, end)).end();
    where.light_grid = light_grid > 0 ? end : CLARAY_NO_TABLE;
    where.listed_pixels = listed_pixels > 0 ? end + light_grid : CLARAY_NO_TABLE;
    where.guide =
        guide > 0 ? std::uint32_t(TableWriter::rounded_up(end + light_grid + listed_pixels)) : CLARAY_NO_TABLE;
    tables = Buffer<std::uint32_t>(
        device, guide > 0 ? std::size_t(where.guide) + guide : std::size_t(end) + light_grid + listed_pixels);
    if (light_grid > 0) tables.write(std::vector<std::uint32_t>(light_grid), end);
    tables.write(meshes.words());
    tables.write(materials.words(), of_materials_.begin);
    tables.write(found.words(), of_lights_.begin);
}

SceneBuffers::Section SceneBuffers::place(const TableWriter& written, std::uint64_t begin, unsigned spare) {
    const std::uint64_t room = TableWriter::rounded_up(written.words().size()) * (1 + spare);
    if (begin + room >= CLARAY_NO_TABLE) throw Error(ErrorKind::user, "the scene's tables are larger than 16 GB");
    written.place(std::uint32_t(begin));
    return {std::uint32_t(begin), std::uint32_t(room)};
}

/// A section that outgrows its room moves to the end, with twice the room that it needs, so that a scene with ever more
/// lights seldom moves it.
void SceneBuffers::replace(const TableWriter& written, Section& section) {
    if (written.words().size() > section.room) {
        section = place(written, tables.size(), 1);
        const Buffer<std::uint32_t> larger(tables.device(), section.end());
        detail::copy(tables.device(), tables.memory(), larger.memory(), tables.bytes());
        tables = larger;
    } else {
        written.place(section.begin);
    }
    tables.write(written.words(), section.begin);
}

void SceneBuffers::replace_lights(const Scene& scene) {
    replace_punctual_lights(scene, *on_host_);
    replace(tables_of_lights(), of_lights_);
}

void SceneBuffers::replace_materials(const Scene& scene) {
    const std::vector<bool> used = used_materials(scene);
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i] && !shader_of(scene.materials[i], shaders)) shaders = shaders_of(scene);
    replace(tables_of_materials(scene), of_materials_);
    replace_emissive_triangles(scene);
}

void SceneBuffers::replace_emissive_triangles(const Scene& scene) {
    replace_triangle_lights(scene, *on_host_);
    replace(tables_of_lights(), of_lights_);
}

void SceneBuffers::write_light_grid(std::uint32_t level, const LightGrid& data) {
    std::vector<std::uint32_t> words(CLARAY_GRID_HEADER);
    std::memcpy(words.data(), &data, sizeof data);
    tables.write(words, where.light_grid + level * CLARAY_GRID_HEADER);
}

void SceneBuffers::list_pixels(const std::vector<std::uint32_t>& halves, std::uint32_t unit, std::uint32_t width,
                               std::uint32_t height) const {
    const Device& device = tables.device();
    const auto count = std::uint32_t(halves.size() / 3);
    load_kernel(device, "render/measure_film.cl", "list_pixels")
        .run({std::size_t(count) * CLARAY_TILE_SIDE * CLARAY_TILE_SIDE, 64},
             arg("halves", Buffer<std::uint32_t>(device, halves)), count, width, height, unit, arg("tables", tables),
             where.listed_pixels);
}

void SceneBuffers::move_normals(std::size_t first, std::span<const glm::vec3> normals) {
    if (where.normals == CLARAY_NO_TABLE || normals.empty()) return;
    std::vector<std::uint32_t> words(3 * normals.size());
    std::memcpy(words.data(), normals.data(), normals.size_bytes());
    tables.write(words, where.normals + 3 * first);
}

EffectSet SceneBuffers::effects_of_tables() const {
    EffectSet found;
    if (where.light_lists != CLARAY_NO_TABLE) found.add(Effect::light_lists);
    if (where.light_tree != CLARAY_NO_TABLE) found.add(Effect::many_lights);
    if (where.hot_spots != CLARAY_NO_TABLE) found.add(Effect::hot_spots);
    return found;
}

void SceneBuffers::bind(Kernel& kernel, unsigned& index) const {
    kernel.set(index, arg("positions", structure.triangles().positions));
    kernel.set(index, arg("indices", structure.triangles().indices));
    kernel.set(index, arg("tables", tables));
    kernel.set(index, arg("textures", textures.maps()));
    structure.bind(kernel, index);
}

std::uint64_t SceneBuffers::bytes() const { return structure.bytes() + tables.bytes() + textures.store.bytes(); }

}  // namespace claray
