// The same input gives the same output: in every run, on every device, whatever the schedule.
#include <algorithm>
#include <cstring>

#include "claray/renderer.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/committed.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

Mesh all_of(const Scene& scene) {
    Mesh all;
    for (const Mesh& mesh : scene.meshes) {
        const auto base = std::uint32_t(all.positions.size());
        all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
        for (const glm::uvec3& t : mesh.triangles) all.triangles.push_back(t + base);
    }
    return all;
}

/// Triangles in planes across all axes, whose boxes are flat where they overlap.
Mesh walls() {
    Mesh all;
    for (int axis = 0; axis < 3; ++axis) {
        Mesh wall = soup(500, 0.2f, 21 + std::uint64_t(axis));
        for (glm::vec3& p : wall.positions) p[axis] = 0.25f * float(axis + 1);
        all = joined(std::move(all), wall);
    }
    return all;
}

/// Each on a place of its own and mirrored there, so that splits come in pairs of the same cost but for roundings.
Mesh mirrored() {
    Random random(17);
    Mesh mesh;
    for (int place = 0; place < 128; ++place)
        for (int triangle = 0; triangle < 24; ++triangle) {
            const float size = triangle < 2 ? 0.5f : 0.03f;  // large ones, to be split, among small ones
            const glm::vec3 center = random.in_cube(0.5f - size);
            glm::vec3 corners[3];
            for (glm::vec3& corner : corners) corner = glm::round((center + random.in_cube(size)) * 1024.f) / 1024.f;
            for (const float side : {1.f, -1.f}) {
                const auto first = std::uint32_t(mesh.positions.size());
                for (const glm::vec3& c : corners)
                    mesh.positions.emplace_back(side * c.x + float(place % 16), c.y + float(place / 16), c.z);
                mesh.triangles.emplace_back(first, first + 1, first + 2);
            }
        }
    return mesh;
}

/// The meshes whose hashes are committed; only + - * and square roots made them.
std::vector<std::pair<std::string, Mesh>> hashed_meshes() {
    return {{"soup", soup(5003, 0.05f, 5)},
            {"large soup", soup(20'011, 0.03f, 11)},  // GPUs split several of its nodes at once by many groups
            {"sphere", sphere(4)},
            {"grid", grid(40)},
            {"hair", all_of(*builtin_scene("hair:3000"))},
            {"walls", walls()},
            {"tiny", scaled(soup(1000, 0.06f, 9), 2.5e-18f)},  // at the smallest extents by which bins divide
            {"huge", scaled(soup(1000, 0.05f, 10), 3e9f)},     // beyond the cells of the Morton grid
            {"huge walls", scaled(walls(), 1e6f)},
            {"mirrored", mirrored()},
            {"shards", joined(soup(60, 1.f, 7), soup(3000, 0.02f, 8))}};
}

/// The part of a hit that is promised on every device: the triangle and the distance.
std::string hash_of_hits(const std::vector<Hit>& hits) {
    std::vector<std::uint32_t> words;
    for (const Hit& hit : hits) {
        std::uint32_t t;
        std::memcpy(&t, &hit.t, 4);
        words.push_back(hit.primitive), words.push_back(hit.primitive == CLARAY_MISS ? 0 : t);
    }
    return hash_of(words);
}

/// Builds a mesh by all builders and compares the trees with the committed ones.
void tree_hashes(Run& run, const std::string& name, const Mesh& mesh, const Form& form, Committed& committed,
                 Tally& again) {
    for (const BuilderTraits& traits : builders) {
        const auto hash = [&] {
            return build(run, mesh, {.builder = traits.builder, .layout = Layout::binary}).hash();
        };
        const std::string first = hash();
        const std::string tree = "tree " + name + ' ' + traits.name;
        if (form.settings.empty()) run.fact(tree, first);
        committed.compare_hash(tree, first);
        for (int i = 1; i < run.count(3, 100); ++i) again.add(hash() == first);
    }
}

/// Many small trees, one hash for each builder. Far from the origin floats are coarse: corners and centroids coincide.
void drawn_trees(const Run& run, Committed& committed) {
    struct Place {
        const char* name;
        float size;
        glm::vec3 at;
        unsigned morton_bits = 63;
    };
    const Place places[] = {{"", 1.f, {}},
                            {"tiny ", 0x1p-40f, {}},
                            {"huge ", 0x1p20f, {}},
                            {"far ", 1.f, far_away},
                            {"coarse ", 1.f, {}, 30}};
    for (const BuilderTraits& traits : builders) {
        for (const Place& place : places) {
            std::string hashes;
            for (std::uint64_t seed = 0; seed < 60; ++seed) {
                const Mesh mesh = translated(scaled(drawn_mesh(seed), place.size), place.at);
                hashes += build(run, mesh,
                                {.builder = traits.builder, .morton_bits = place.morton_bits, .layout = Layout::binary})
                              .hash();
            }
            committed.compare(std::string("drawn ") + place.name + "trees " + traits.name, hashes);
        }
    }
}

void tree_hashes(Run& run) {
    for (const Form& form : build_forms(run.device())) {
        const ScopedForm set(run.device(), form);
        Committed trees(run), drawn(run);
        Tally again;
        for (const auto& [name, mesh] : hashed_meshes()) tree_hashes(run, name, mesh, form, trees, again);
        drawn_trees(run, drawn);
        drawn.check(std::string("sets of small trees") + form.name);
        trees.check(std::string("trees") + form.name);
        if (again.wrong) run.failure("build " + std::to_string(again.first) + " gave another tree" + form.name);
        run.check(std::string("trees of further builds that differ") + form.name, again, "trees");
    }
}

/// The same hits in both layouts, for any order of the rays, in one query or many, by packets and one by one.
void hit_hashes(Run& run) {
    Committed committed(run);
    Tally same;
    for (const auto& [name, mesh] : hashed_meshes()) {
        if (name == "tiny" || name.starts_with("huge")) continue;  // no ray meets one, all meet the other
        const auto rays = random_rays(run.count<std::size_t>(70'000, 70'000), 3.f, 0.8f, 77);
        std::vector<std::uint32_t> order(rays.size());
        for (std::size_t i = 0; i < rays.size(); ++i) order[i] = std::uint32_t(i * 31'337 % rays.size());
        std::string first;
        for (const auto& [layout, layout_name] : layouts) {
            const Bvh bvh = build(run, mesh, {.layout = layout});
            const auto hits = closest_hit(bvh, rays);
            const std::string hash = hash_of_hits(hits);
            if (first.empty()) {
                first = hash;
                run.fact("hits " + name, hash);
                committed.compare_hash("hits " + name, hash);
            }
            same.add(hash == first);
            const auto expect = [&](const std::vector<Hit>& found, const std::string& how) {
                if (same.add(hash_of_hits(found) == first))
                    run.failure(name + ", " + layout_name + ", " + how + " gives other hits");
            };
            std::vector<Ray> shuffled;
            for (const std::uint32_t i : order) shuffled.push_back(rays[i]);
            const auto found = closest_hit(bvh, shuffled);
            std::vector<Hit> unshuffled(rays.size());
            for (std::size_t i = 0; i < rays.size(); ++i) unshuffled[order[i]] = found[i];
            expect(unshuffled, "another order of the rays");
            std::vector<Hit> parts;
            for (std::size_t begin = 0; begin < rays.size(); begin += 9'973) {
                const auto part =
                    closest_hit(bvh, std::span(rays).subspan(begin, std::min<std::size_t>(9'973, rays.size() - begin)));
                parts.insert(parts.end(), part.begin(), part.end());
            }
            expect(parts, "parts");
            for (const Coherence coherence : {Coherence::coherent, Coherence::incoherent}) {
                QueryOptions options;
                options.coherence = coherence;
                expect(closest_hit(bvh, rays, options),
                       coherence == Coherence::coherent ? "as coherent" : "as incoherent");
            }
            const ScopedTuning alone(run.device(), "trace/closest_hit", "BATCH", 0);
            expect(closest_hit(bvh, rays), "one by one");
        }
    }
    committed.check("sets of hits");
    run.check("sets of hits that differ", same, "sets");
}

struct Pairs {
    std::vector<Ray> rays;
    std::vector<float> corners;  // nine numbers a triangle
};

/// Rays at points of triangles of all sizes and shapes, a quarter of them at an edge, another at a corner, some beside.
Pairs drawn_pairs(std::size_t count) {
    Random random(31);
    Pairs pairs;
    for (std::size_t i = 0; i < count; ++i) {
        const float size = std::exp2(float(random.below(41)) - 20.f), away = std::exp2(float(random.below(13)));
        const glm::vec3 place = size * away * random.in_cube(1.f);
        glm::vec3 corners[3];
        for (glm::vec3& corner : corners) corner = place + size * random.in_cube(1.f);
        if (i % 5 == 0) corners[2] = corners[0] + 1e-3f * (corners[2] - corners[0]);
        float u = random.uniform(-0.1f, 1.f), v = random.uniform(-0.1f, 1.f);
        if (u + v > 1.05f) u = 1.f - u, v = 1.f - v;
        if (i % 4 == 1) v = 0.f;
        if (i % 4 == 2) u = v = 0.f;
        const glm::vec3 target = corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
        const glm::vec3 origin = target + size * std::exp2(float(random.below(13)) - 4.f) * random.in_cube(1.f);
        pairs.rays.push_back(make_ray(origin, target - origin));
        for (const glm::vec3& corner : corners)
            for (int axis = 0; axis < 3; ++axis) pairs.corners.push_back(corner[axis]);
    }
    return pairs;
}

/// Bits beyond those of a hit, which decide only in ties.
void solutions(Run& run) {
    if (!run.device().info().fp64) return run.fact("solutions", "the device has no float64");
    const Pairs pairs = drawn_pairs(200'000);
    const auto count = std::uint32_t(pairs.rays.size());
    const Buffer<std::uint64_t> words(run.device(), 5 * std::size_t(count));
    load_kernel(run.device(), "verify/solutions.cl", "solve_triangles")
        .run({count, 64}, arg("rays", Buffer<Ray>(run.device(), pairs.rays)),
             arg("corners", Buffer<float>(run.device(), pairs.corners)), count, arg("words", words));
    const std::vector<std::uint64_t> found = words.read();
    Tally hits;
    for (std::size_t i = 0; i < count; ++i) hits.add(found[5 * i] != 0);
    Committed bits(run);
    bits.compare("solutions", found);
    bits.check("sets of solutions");
    run.check("share of rays that miss", count, double(hits.wrong) / count, 0.5, "");
}

/// Images are the same bit for bit on all devices and for any batch sizes.
void image_hashes(Run& run) {
    Tally same;
    for (const char* const name : {"cornell", "spheres", "crate"}) {
        const Scene scene = *builtin_scene(name);
        const RenderConfig config{
            .width = run.count(37u, 131u), .height = run.count(23u, 97u), .spp = run.count(5u, 40u)};
        const auto image = [&] {
            Renderer renderer(run.device(), scene, config);
            renderer.render();
            return hash_of(renderer.image());
        };
        const std::string first = image();
        run.fact(std::string("image ") + name, first);
        same.add(image() == first);
        for (const unsigned paths : {501u, 4000u}) {
            const ScopedTuning tuning(run.device(), "render/wavefront", "PATHS", paths);
            same.add(image() == first);
        }
        const ScopedTuning tuning(run.device(), "render/wavefront", "BOUNCES_PER_LOOK", 3);
        same.add(image() == first);
        if (same.wrong) run.failure(std::string(name) + ": image " + std::to_string(same.first) + " differs");
    }
    run.check("images that differ by run or size of batch", same, "images");
}

}  // namespace

Cases sameness_cases() {
    return {
        {{"tree-hashes", "sameness", "All devices and runs build the same trees"}, tree_hashes},
        {{"solutions", "sameness", "The exact step of the triangle test finds the committed bits"}, solutions},
        {{"hit-hashes", "sameness", "All devices, layouts, orders and schedules find the same hits"}, hit_hashes},
        {{"image-hashes", "sameness", "A device renders the same image in every run and with all batch sizes"},
         image_hashes},
    };
}

}  // namespace claray::verify
