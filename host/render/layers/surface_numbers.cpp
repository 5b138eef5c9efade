#include "host/render/layers/surface_numbers.hpp"

#include <algorithm>

namespace claray {
namespace {

template <class Named>
void add_names(std::vector<std::string>& names, const std::vector<Named>& of, const char* kind) {
    for (std::size_t i = 0; i < of.size(); ++i)
        names.push_back(of[i].name.empty() ? kind + std::to_string(i) : of[i].name);
}

SurfaceNames names_in(const Scene& scene) {
    SurfaceNames names;
    add_names(names.objects, scene.meshes, "mesh ");
    add_names(names.objects, scene.primitives, "primitives ");
    add_names(names.instances, scene.instances, "instance ");
    add_names(names.materials, scene.materials, "material ");
    return names;
}

}  // namespace

/// In the traced scene all baked meshes together are the first instance.
SurfaceNumbers::SurfaceNumbers(const Scene& scene, const std::vector<InstancePlace>& places,
                               const TriangleNumbers& numbers)
    : numbers_(numbers), names_(names_in(scene)) {
    std::uint32_t next = 0;
    const auto add = [&](std::size_t object, std::size_t primitives) {
        if (primitives > 0) runs_.push_back({next, std::uint32_t(object)});
        next += std::uint32_t(primitives);
    };
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) add(i, scene.meshes[i].triangles.size());
    for (std::uint32_t kind = 0; kind < CLARAY_PRIMITIVE_KINDS; ++kind)  // in the order of materials_of_primitives
        for (std::size_t i = 0; i < scene.primitives.size(); ++i)
            if (std::uint32_t(scene.primitives[i].kind) == kind)
                add(scene.meshes.size() + i, primitive_count(scene.primitives[i]));
    const auto put = [](std::vector<std::uint32_t>& list, std::size_t at, std::size_t instance) {
        if (list.size() <= at) list.resize(at + 1, CLARAY_MISS);
        list[at] = std::uint32_t(instance);
    };
    const auto baked = std::size_t(std::count_if(places.begin(), places.end(), [](auto& p) { return p.baked; }));
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (places[i].index == CLARAY_MISS) continue;
        if (places[i].baked)
            put(of_baked_, places[i].index, i);
        else
            put(of_placed_, places[i].index - baked + (baked > 0 ? 1 : 0), i);
    }
}

std::uint32_t SurfaceNumbers::object_of(std::uint32_t primitive) const {
    const auto after = std::upper_bound(runs_.begin(), runs_.end(), primitive,
                                        [](std::uint32_t number, const Run& run) { return number < run.first; });
    return primitive == CLARAY_MISS || after == runs_.begin() ? CLARAY_MISS : std::prev(after)->object;
}

std::uint32_t SurfaceNumbers::instance_of(std::uint32_t primitive, std::uint32_t instance) const {
    if (primitive == CLARAY_MISS) return CLARAY_MISS;
    if (instance < of_placed_.size() && of_placed_[instance] != CLARAY_MISS) return of_placed_[instance];
    const std::uint32_t mesh = numbers_.mesh_of(primitive);
    return mesh < of_baked_.size() ? of_baked_[mesh] : CLARAY_MISS;
}

}  // namespace claray
