// The trees of a scene that is split into parts. As many of them are on the device as its memory holds; the others wait
// in host memory.
#pragma once

#include "host/bvh/pages/tree_pages.hpp"
#include "host/render/parts/scene_split.hpp"

namespace claray {

/// An instance of the scene: at shutter open, at shutter close, and its object.
struct PlacedObject {
    Instance begin, end;
    std::size_t object = 0;
};

class SceneParts {
public:
    /// `triangles`: of all meshes, in order. `instances`: empty for scenes without. Builds one part after the other.
    /// Throws ErrorKind::device if the memory does not hold a single part.
    SceneParts(const Device& device, const Scene& scene, const std::vector<SceneObject>& objects,
               const std::vector<PlacedObject>& instances, bool any_moves, const TriangleBuffers& triangles,
               unsigned parts, const Bvh::Config& config);

    struct Part {
        Bvh bvh;                                 // of scenes without instances
        std::optional<InstancedBvh> instanced;   // of others
        Buffer<std::uint32_t> instance_numbers;  // in the scene, of the part's
        TreePages pages;
        std::uint64_t last_use = 0;
    };
    [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
    /// Triangles, bytes and costs of all parts, and the largest height.
    [[nodiscard]] const BvhStatistics& statistics() const { return statistics_; }
    /// Whether the memory that is free does not hold the parts that wait.
    [[nodiscard]] bool take_turns() const;
    /// What the parts hold on the device now.
    [[nodiscard]] std::uint64_t bytes() const;
    [[nodiscard]] std::uint64_t bytes_paged() const { return bytes_paged_; }
    void set_cutouts(const Buffer<std::uint32_t>& store);

    /// Calls visit(index) for each part while its tree is on the device. The order alternates, so that the part that
    /// was visited last need not be copied again.
    template <class Visit>
    void for_each(const Visit& visit) {
        backwards_ = !backwards_;
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            const std::size_t part = backwards_ ? parts_.size() - 1 - i : i;
            fetch(parts_[part]);
            visit(part, i == 0);
        }
    }

private:
    void add_part(const Scene& scene, const std::vector<SceneObject>& objects, const std::vector<ObjectPiece>& pieces,
                  const std::vector<PlacedObject>& instances, bool any_moves, const Bvh::Config& config);
    [[nodiscard]] Bvh build(const Scene& scene, const SceneObject& object, const ObjectPiece& piece,
                            const Bvh::Config& config);
    void fetch(Part& part);
    [[nodiscard]] Part* oldest_on_device();

    Device device_;
    TriangleBuffers triangles_;
    std::vector<Part> parts_;
    BvhStatistics statistics_;
    std::uint64_t uses_ = 0, bytes_paged_ = 0;
    bool backwards_ = true;
};

/// An upper limit of the bytes that the scene takes on a device while its tree is built, without queues and images.
[[nodiscard]] std::uint64_t ample_bytes_of(const Scene& scene);

/// The number of parts in which a scene is to be split, so that the device's memory holds one of them beside what
/// cannot be split: vertices, materials, textures and queues. 1: the whole scene fits. Throws ErrorKind::device if no
/// number is enough.
[[nodiscard]] unsigned parts_needed(const Device& device, const Scene& scene, const Bvh::Config& config);

}  // namespace claray
