// A scene's shading data in device memory.
#pragma once

#include "claray/shared/light_grid.h"
#include "claray/shared/path.h"
#include "host/effects/effects.hpp"
#include "host/lights/lights.hpp"
#include "host/render/structure.hpp"
#include "host/textures/textures.hpp"

namespace claray {

struct SceneBuffers {
    /// Uploads the data that the scene needs. `added`: effects that kernels support in addition.
    /// `light_grid`: words of the table of Approximations::light_grid, all 0. `listed_pixels`: room of
    /// SceneTables::listed_pixels. `guide`: words of SceneTables::guide.
    SceneBuffers(const Device& device, const Scene& scene, const Structure& structure, EffectSet added = {},
                 const LightSelection& selection = {}, std::uint32_t light_grid = 0, std::uint32_t listed_pixels = 0,
                 std::uint32_t guide = 0);

    Structure structure;  // shares its positions and indices
    /// Replaces the lights of all kinds in the list of claray/shared/lists/lights.h. Nothing else is uploaded.
    void replace_lights(const Scene& scene);
    /// Replaces the values of materials and what follows from them: their tables and the emissive triangles. The maps
    /// of materials stay.
    void replace_materials(const Scene& scene);
    /// The same for triangles that have moved, whose materials stay.
    void replace_emissive_triangles(const Scene& scene);
    /// Replaces what is known about a level of the light grid; its data stays.
    void write_light_grid(std::uint32_t level, const LightGrid& data);
    /// Lists the entries of a round on the device; `halves` and `unit` as in AdaptiveSchedule::Round.
    void list_pixels(const std::vector<std::uint32_t>& halves, std::uint32_t unit, std::uint32_t width,
                     std::uint32_t height) const;
    /// Replaces the normals of the vertices from `first` on.
    void move_normals(std::size_t first, std::span<const glm::vec3> normals);

    Buffer<std::uint32_t> tables;  // all in one buffer, so that kernels have few arguments
    SceneTables where{};           // offsets in `tables`
    Textures textures;
    LightsData lights{};             // see has_lights
    EffectSet effects;               // of the scene
    std::vector<EffectSet> shaders;  // see shaders_of; kept while they are enough for changed materials

    [[nodiscard]] const Lights& lights_on_host() const { return *on_host_; }
    /// Of the scene, as LightsData takes it.
    [[nodiscard]] double radius() const { return on_host_->radius; }
    /// The effects that depend on more than one part of the scene.
    [[nodiscard]] EffectSet effects_of_tables() const;
    /// Binds SCENE_PARAMETERS of shade/scene.clh.
    void bind(Kernel& kernel, unsigned& index) const;
    [[nodiscard]] std::uint64_t bytes() const;

private:
    /// Tables that are replaced together: words of `tables`.
    struct Section {
        std::uint32_t begin = 0, room = 0;
        [[nodiscard]] std::uint32_t end() const { return begin + room; }
    };
    class TableWriter;
    [[nodiscard]] TableWriter tables_of_meshes(const Scene& scene);
    [[nodiscard]] TableWriter tables_of_materials(const Scene& scene);
    [[nodiscard]] TableWriter tables_of_lights();
    /// `spare`: room that is left free, as a multiple of what is needed.
    [[nodiscard]] static Section place(const TableWriter& written, std::uint64_t begin, unsigned spare = 0);
    void replace(const TableWriter& written, Section& section);

    std::shared_ptr<Lights> on_host_;  // what follows from other lights than those replaced is not computed again
    Section of_materials_, of_lights_;
};

}  // namespace claray
