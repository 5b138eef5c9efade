#include "host/render/parts/scene_parts.hpp"

#include <algorithm>

#include "host/bvh/bvh_state.hpp"
#include "host/bvh/instances_state.hpp"
#include "host/compute/memory.hpp"
#include "host/primitives/scene_primitives.hpp"
#include "host/render/wavefront/queues.hpp"

namespace claray {
namespace {

/// Bytes per triangle, more than any builder takes in all and in one buffer. To know more, the builder's kernels would
/// have to be compiled, for which a first picture does not wait.
constexpr std::uint64_t ample_bytes = 4096, ample_buffer = 1024;
constexpr std::uint64_t share_of_queues = 8;  // of the memory, which parts leave free
constexpr unsigned most_parts = 4096;

/// Of the triangles of a piece: vertices counted through the scene.
std::vector<std::uint32_t> indices_of(const Scene& scene, const SceneObject& object, const ObjectPiece& piece) {
    std::vector<std::uint32_t> indices;
    indices.reserve(3 * piece.triangles.size());
    std::size_t mesh = object.first_mesh;
    std::uint32_t first_triangle = 0, first_vertex = object.first_vertex;
    for (const std::uint32_t triangle : piece.triangles) {
        while (triangle - first_triangle >= scene.meshes[mesh].triangles.size()) {
            first_triangle += std::uint32_t(scene.meshes[mesh].triangles.size());
            first_vertex += std::uint32_t(scene.meshes[mesh].positions.size());
            ++mesh;
        }
        const glm::uvec3 t = scene.meshes[mesh].triangles[triangle - first_triangle];
        indices.insert(indices.end(), {first_vertex + t.x, first_vertex + t.y, first_vertex + t.z});
    }
    return indices;
}

/// Bytes of a scene on the device that are not trees, about.
std::uint64_t bytes_besides_trees(const Scene& scene) {
    std::uint64_t bytes = 0;
    for (const Mesh& mesh : scene.meshes)
        bytes += sizeof(glm::vec3) * (mesh.positions.size() + mesh.normals.size()) +
                 sizeof(glm::vec2) * (mesh.uvs.size() + mesh.uvs1.size()) + sizeof(glm::vec4) * mesh.tangents.size() +
                 sizeof(glm::vec3) * mesh.colors.size() + (sizeof(glm::uvec3) + 4) * mesh.triangles.size();
    for (const Texture& texture : scene.textures) bytes += (texture.bytes.size() + 4 * texture.floats.size()) * 4 / 3;
    for (const Texture& image : scene.environment.images) bytes += 2 * (image.bytes.size() + 4 * image.floats.size());
    return bytes + 3 * sizeof(Instance) * scene.instances.size() + bytes_of_primitives(scene);
}

std::size_t triangles_of(const Scene& scene) {
    std::size_t triangles = 0;
    for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
    return triangles;
}

}  // namespace

std::uint64_t ample_bytes_of(const Scene& scene) {
    return bytes_besides_trees(scene) + triangles_of(scene) * ample_bytes;
}

SceneParts::SceneParts(const Device& device, const Scene& scene, const std::vector<SceneObject>& objects,
                       const std::vector<PlacedObject>& instances, bool any_moves, const TriangleBuffers& triangles,
                       unsigned parts, const Bvh::Config& config)
    : device_(device), triangles_(triangles) {
    for (const std::vector<ObjectPiece>& pieces : split_scene(scene, objects, parts))
        add_part(scene, objects, pieces, instances, any_moves, config);
}

Bvh SceneParts::build(const Scene& scene, const SceneObject& object, const ObjectPiece& piece,
                      const Bvh::Config& config) {
    TriangleBuffers triangles;
    triangles.positions = triangles_.positions;
    triangles.indices = Buffer<std::uint32_t>(device_, indices_of(scene, object, piece));
    Bvh bvh = Bvh::build(device_, triangles, config);
    renumber_triangles(bvh, piece.triangles);
    const BvhStatistics built = bvh.statistics();
    statistics_.triangles += built.triangles, statistics_.culled += built.culled;
    statistics_.references += built.references, statistics_.bytes += built.bytes;
    statistics_.sah_cost += built.sah_cost;
    statistics_.height = std::max(statistics_.height, built.height);
    return bvh;
}

/// A part of a scene with instances places each piece as often as its object.
void SceneParts::add_part(const Scene& scene, const std::vector<SceneObject>& objects,
                          const std::vector<ObjectPiece>& pieces, const std::vector<PlacedObject>& instances,
                          bool any_moves, const Bvh::Config& config) {
    Part part;
    std::vector<Bvh> bottoms;
    for (Part& other : parts_) other.pages.page_out();  // a build needs the most memory
    for (const ObjectPiece& piece : pieces) bottoms.push_back(build(scene, objects[piece.object], piece, config));
    if (instances.empty()) {
        part.bvh = bottoms.front();
        part.pages = TreePages(part.bvh);
        parts_.push_back(std::move(part));
        return;
    }
    std::vector<Instance> begins, ends;
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < instances.size(); ++i)
        for (std::uint32_t bottom = 0; bottom < pieces.size(); ++bottom) {
            if (pieces[bottom].object != instances[i].object) continue;
            begins.push_back(instances[i].begin), ends.push_back(instances[i].end), numbers.push_back(i);
            begins.back().bottom = ends.back().bottom = bottom;
        }
    const InstancedBvh::Config top = {.builder = Builder::balanced, .morton_bits = config.morton_bits};
    part.instanced =
        any_moves ? InstancedBvh::build(bottoms, begins, ends, top) : InstancedBvh::build(bottoms, begins, top);
    part.instance_numbers = Buffer<std::uint32_t>(device_, numbers);
    bottoms.clear();
    part.pages = TreePages(*part.instanced);
    parts_.push_back(std::move(part));
}

void SceneParts::set_cutouts(const Buffer<std::uint32_t>& store) {
    for (Part& part : parts_)
        part.instanced ? state_of(*part.instanced).set_cutouts(store) : state_of(part.bvh).set_cutouts(store);
}

bool SceneParts::take_turns() const {
    std::uint64_t waiting = 0;
    for (const Part& part : parts_) waiting += part.pages.on_device() ? 0 : part.pages.bytes();
    return waiting > 0 && waiting + device_.info().memory / share_of_queues > bytes_available(device_);
}

std::uint64_t SceneParts::bytes() const {
    std::uint64_t bytes = 0;
    for (const Part& part : parts_)
        bytes += part.instance_numbers.bytes() +
                 (part.instanced ? state_of(*part.instanced).bytes() : state_of(part.bvh).bytes());
    return bytes;
}

SceneParts::Part* SceneParts::oldest_on_device() {
    Part* oldest = nullptr;
    for (Part& part : parts_)
        if (part.pages.on_device() && (oldest == nullptr || part.last_use < oldest->last_use)) oldest = &part;
    return oldest;
}

void SceneParts::fetch(Part& part) {
    part.last_use = ++uses_;
    if (part.pages.on_device()) return;
    const std::uint64_t wanted = part.pages.bytes() + device_.info().memory / share_of_queues;
    bool waited = false;
    for (Part* oldest = oldest_on_device(); oldest != nullptr && bytes_available(device_) < wanted;
         oldest = oldest_on_device()) {
        if (!waited) device_.finish();  // commands may still read the tree
        waited = true;
        oldest->pages.page_out();
    }
    part.pages.page_in();
    bytes_paged_ += part.pages.bytes();
}

unsigned parts_needed(const Device& device, const Scene& scene, const Bvh::Config& config) {
    const std::size_t triangles = triangles_of(scene);
    const std::uint64_t resident = bytes_besides_trees(scene), available = bytes_available(device);
    if (ample_bytes_of(scene) <= available && triangles * ample_buffer <= device.info().max_allocation) return 1;
    const bool placed = !scene.instances.empty();
    // Bottom levels are copied behind each other.
    const auto bytes_of = [&](std::size_t count) {
        return Bvh::memory_needed(device, 0, count, config).bytes * (placed ? 2 : 1);
    };
    const auto fits = [&](std::size_t count, std::uint64_t beside) {
        return count < CLARAY_SLOT && resident + bytes_of(count) + beside <= available &&
               gives_buffer(device, Bvh::memory_needed(device, 0, count, config).largest_buffer);
    };
    if (fits(triangles, device.info().memory / share_of_wavefront)) return 1;
    const std::uint64_t queues = device.info().memory / share_of_queues;
    for (unsigned parts = 2; parts <= most_parts; parts *= 2)
        if (fits((triangles + parts - 1) / parts, queues)) return parts;
    throw Error(ErrorKind::device,
                "out of device memory: " + device.info().name + " has " + size_text(available) + " of its " +
                    size_text(device.info().memory) + " left, but vertices, materials and textures need about " +
                    size_text(resident) + " and queues " + size_text(queues) + ", and only trees can be split",
                "use fewer or smaller textures, fewer triangles, or another device");
}

}  // namespace claray
