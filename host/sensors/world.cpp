#include <algorithm>
#include <cmath>

#include "host/scene/placement.hpp"
#include "host/sensors/world_state.hpp"

namespace claray {
namespace {

/// Fixed triangles beyond these stay instances if their meshes are placed several times.
constexpr std::size_t most_copied_triangles = std::size_t(1) << 26;

/// As validate, but a scene without materials is one of a white material.
void check(const Scene& scene) {
    if (!scene.materials.empty()) return validate(scene);
    Scene white = scene;
    white.materials.resize(1);
    validate(white);
}

std::vector<MeshInstance> instances_of(const Scene& scene) {
    std::vector<MeshInstance> instances = scene.instances;
    if (instances.empty())
        for (std::size_t i = 0; i < scene.meshes.size(); ++i) instances.push_back({.mesh = std::uint32_t(i)});
    return instances;
}

/// Whether each instance may move.
std::vector<bool> movable_of(std::span<const MeshInstance> instances, std::span<const std::uint32_t> movers) {
    std::vector<bool> movable;
    for (const MeshInstance& instance : instances) movable.push_back(moves(instance));
    for (const std::uint32_t i : movers) {
        if (i >= instances.size())
            throw Error(ErrorKind::usage, "movers: holds " + std::to_string(i) + ", but the scene has " +
                                              std::to_string(instances.size()) + " instances");
        movable[i] = true;
    }
    return movable;
}

std::vector<float> reflectances_of(const Scene& scene, std::span<const float> given) {
    std::vector<float> reflectances(given.begin(), given.end());
    if (reflectances.empty())
        for (const Material& material : scene.materials) reflectances.push_back(material.albedo.x);
    if (scene.materials.empty() && reflectances.empty()) reflectances.push_back(1);
    if (reflectances.size() != std::max<std::size_t>(1, scene.materials.size()))
        throw Error(ErrorKind::usage, "reflectances: has " + std::to_string(given.size()) +
                                          " numbers, but the scene has " + std::to_string(scene.materials.size()) +
                                          " materials");
    for (std::size_t i = 0; i < reflectances.size(); ++i)
        if (!(reflectances[i] >= 0) || std::isinf(reflectances[i]))
            throw Error(ErrorKind::usage, "reflectances: number " + std::to_string(i) + " is " +
                                              std::to_string(reflectances[i]) + "; use 0 or more");
    return reflectances;
}

glm::vec3 normal_of(const Mesh& mesh, const glm::uvec3& triangle) {
    const glm::dvec3 a(mesh.positions[triangle.x]), b(mesh.positions[triangle.y]), c(mesh.positions[triangle.z]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double length = glm::length(normal);
    return length > 0 && std::isfinite(length) ? glm::vec3(normal / length) : glm::vec3(0);
}

void append(std::vector<SensorTriangle>& triangles, const Mesh& mesh) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::vec3 n = normal_of(mesh, mesh.triangles[i]);
        triangles.push_back({n.x, n.y, n.z, mesh.materials.empty() ? 0u : mesh.materials[i]});
    }
}

/// Fills the tables of a world, and gathers what its structures are built from.
struct Parts {
    std::vector<Mesh> fixed;
    std::vector<std::uint32_t> moving_meshes;  // those that are instances
    std::vector<Instance> begins, ends;
    std::vector<SensorTriangle> triangles;
    std::vector<SensorPlace> places;

    void add_fixed(const Scene& scene, const MeshInstance& instance, std::uint32_t number) {
        places.push_back({number, std::uint32_t(triangles.size())});
        fixed.push_back(transformed(scene.meshes[instance.mesh], instance.transform));
        append(triangles, fixed.back());
    }
    void add_mover(const Scene& scene, const MeshInstance& instance, std::uint32_t number) {
        auto found = std::find(moving_meshes.begin(), moving_meshes.end(), instance.mesh);
        const auto bottom = std::uint32_t(found - moving_meshes.begin());
        if (found == moving_meshes.end()) {
            moving_meshes.push_back(instance.mesh), firsts.push_back(std::uint32_t(triangles.size()));
            append(triangles, scene.meshes[instance.mesh]);
        }
        places.push_back({number, firsts[bottom]});
        begins.push_back(make_instance(instance.transform, bottom));
        ends.push_back(make_instance(instance.transform_end.value_or(instance.transform), bottom));
    }

private:
    std::vector<std::uint32_t> firsts;  // of moving_meshes, in `triangles`
};

/// Whether each instance that does not move becomes a part of the world.
std::vector<bool> baked_of(const Scene& scene, std::span<const MeshInstance> instances,
                           const std::vector<bool>& movable) {
    std::vector<std::uint32_t> uses(scene.meshes.size(), 0);
    std::size_t copied = 0;
    for (std::size_t i = 0; i < instances.size(); ++i) {
        if (movable[i]) continue;
        copied += scene.meshes[instances[i].mesh].triangles.size();
        ++uses[instances[i].mesh];
    }
    std::vector<bool> baked(instances.size(), false);
    for (std::size_t i = 0; i < instances.size(); ++i) {
        const Mesh& mesh = scene.meshes[instances[i].mesh];
        baked[i] = !movable[i] && !mesh.triangles.empty() &&
                   (copied <= most_copied_triangles || uses[instances[i].mesh] == 1) &&
                   survives_baking(mesh, instances[i].transform);
    }
    return baked;
}

Parts parts_of(const Scene& scene, std::span<const MeshInstance> instances, const std::vector<bool>& movable) {
    const std::vector<bool> baked = baked_of(scene, instances, movable);
    Parts parts;
    const auto each = [&](const auto& add) {
        for (std::size_t i = 0; i < instances.size(); ++i) add(i, instances[i], std::uint32_t(i));
    };
    each([&](std::size_t i, const MeshInstance& instance, std::uint32_t number) {
        if (baked[i]) parts.add_fixed(scene, instance, number);
    });
    for (const bool moving : {true, false})
        each([&](std::size_t i, const MeshInstance& instance, std::uint32_t number) {
            const bool empty = scene.meshes[instance.mesh].triangles.empty();
            if (movable[i] == moving && !baked[i] && (moving || !empty)) parts.add_mover(scene, instance, number);
        });
    return parts;
}

void place(std::vector<Instance>& instances, std::span<const glm::mat4> matrices) {
    for (std::size_t i = 0; i < matrices.size(); ++i) instances[i] = make_instance(matrices[i], instances[i].bottom);
}

}  // namespace

SensorWorld SensorWorld::build(const Device& device, const Scene& scene, std::span<const std::uint32_t> movers,
                               std::span<const float> reflectances, Builder builder) {
    check(scene);
    if (claray::triangle_count(scene) == 0) throw Error(ErrorKind::usage, "scene: has no triangles");
    const std::vector<MeshInstance> instances = instances_of(scene);
    const std::vector<bool> movable = movable_of(instances, movers);
    Parts parts = parts_of(scene, instances, movable);
    auto state = std::make_shared<State>(State{.device = device});
    state->reflectances = Buffer<float>(device, reflectances_of(scene, reflectances));
    state->triangles = Buffer<SensorTriangle>(device, parts.triangles);
    state->places = Buffer<SensorPlace>(device, parts.places);
    state->fixed_places = std::uint32_t(parts.fixed.size());
    state->triangle_count = claray::triangle_count(scene);
    for (std::size_t i = 0; i < movable.size(); ++i)
        if (movable[i]) state->movable.push_back(std::uint32_t(i));
    if (!parts.fixed.empty()) {
        state->fixed = Bvh::build(device, parts.fixed, {.builder = builder});
        state->query =
            QueryKernel(*state->fixed, QueryKind::closest, {.coherence = Coherence::coherent}, "trace_beams");
    }
    if (!parts.begins.empty()) {
        std::vector<Bvh> bottoms;
        for (const std::uint32_t mesh : parts.moving_meshes)
            bottoms.push_back(Bvh::build(device, std::span(&scene.meshes[mesh], 1), {.builder = builder}));
        state->movers = InstancedBvh::build(bottoms, parts.begins, parts.ends, {});
        state->placed = std::move(parts.begins);
    }
    return handle_of<SensorWorld>(std::move(state));
}

const std::vector<std::uint32_t>& SensorWorld::movers() const { return state_->movable; }

void SensorWorld::move(std::span<const glm::mat4> begins, std::span<const glm::mat4> ends) {
    const std::size_t count = state_->movable.size();
    if (begins.size() != count || ends.size() != count)
        throw Error(ErrorKind::usage, std::string(begins.size() != count ? "transforms" : "ends") + ": has " +
                                          std::to_string(begins.size() != count ? begins.size() : ends.size()) +
                                          " matrices, but the world has " + std::to_string(count) + " movers");
    if (count == 0) return;
    Buffer<Instance> at_begin = state_->movers->instances(), at_end = state_->movers->ends();
    place(state_->placed, ends);
    at_end.write(std::span(state_->placed).first(count));
    place(state_->placed, begins);
    at_begin.write(std::span(state_->placed).first(count));
    state_->movers->rebuild();
}

const Device& SensorWorld::device() const { return state_->device; }
std::size_t SensorWorld::triangle_count() const { return state_->triangle_count; }

}  // namespace claray
