// Input that breaks builders: nothing, junk, equal codes, clusters, depth, and many builds in a row.
#include <algorithm>
#include <bit>
#include <cmath>

#include "host/base/format.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/oracle.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

double faults_of(const Bvh& bvh) {
    const BvhValidation v = bvh.validate();
    return double(v.leaves_missing) + v.leaves_repeated + v.boxes_not_containing + v.links_broken;
}

QueryOptions without_tree() {
    QueryOptions options;
    options.brute_force = true;
    return options;
}

/// Counts hits that differ from those of brute force, which `slow` keeps for other trees of the same mesh.
Tally against_brute_force(Run& run, const Bvh& bvh, const std::vector<Ray>& rays, const std::string& what,
                          std::vector<Hit>& slow) {
    const auto fast = closest_hit(bvh, rays);
    if (slow.empty()) slow = closest_hit(bvh, rays, without_tree());
    Tally differ;
    for (std::size_t i = 0; i < rays.size(); ++i)
        differ.add(fast[i].primitive == slow[i].primitive && fast[i].t == slow[i].t);
    if (differ.wrong) run.failure(what + ", the tree hides a hit: " + text_of(rays[differ.first]));
    return differ;
}

void tiny_counts(Run& run, const Form& form) {
    const ScopedForm set(run.device(), form);
    double faults = 0;
    Tally differ;
    std::uint64_t trees = 0;
    for (const auto& [builder, builder_name, note, codes, splits] : builders)
        for (const auto& [layout, layout_name] : layouts)
            for (const std::size_t count : {0u, 1u, 2u, 3u, 4u, 5u, 9u})
                for (const char* const at : {"", " at 1e6"}) {
                    if (*at && !run.full() && builder != Builder::fast) continue;
                    Mesh mesh = soup(count, 0.5f, run.seed() + count);
                    if (*at) move_away(mesh);
                    const Bvh bvh = build(run, mesh, {.builder = builder, .layout = layout});
                    const double wrong = faults_of(bvh);
                    const std::string what = std::to_string(count) + " triangles" + at + ", " + builder_name + ", " +
                                             layout_name + form.name;
                    if (wrong > 0) run.failure(what + ": the tree is not sound");
                    faults += wrong, ++trees;
                    for (const std::size_t n : {1u, 200u}) {
                        Mesh none;
                        std::vector<Hit> slow;
                        std::vector<Ray> rays = random_rays(n, 3.f, 1.f, run.seed() + 5);
                        if (*at) move_away(none, rays);
                        const Tally t = against_brute_force(run, bvh, rays, what, slow);
                        differ.tried += t.tried, differ.wrong += t.wrong;
                    }
                    if (!closest_hit(bvh, std::span<const Ray>()).empty()) ++faults;
                }
    run.check(std::string("faults of trees") + form.name, trees, faults, 0, "faults");
    run.check(std::string("hits that differ from brute force") + form.name, differ, "rays");
}

void tiny_counts(Run& run) {
    for (const Form& form : build_forms(run.device())) tiny_counts(run, form);
}

/// A mesh with a tenth of junk among its triangles: NaN, infinite, 1e30 or without area.
struct JunkMesh {
    Mesh mesh;
    std::vector<std::uint32_t> original;  // of every triangle, or CLARAY_MISS
    std::uint32_t junk_count = 0;
};

JunkMesh with_junk(const Mesh& clean) {
    JunkMesh result{clean, {}};
    Mesh& dirty = result.mesh;
    const float inf = INFINITY, nan = NAN;
    const auto bad = std::uint32_t(dirty.positions.size());
    dirty.positions.insert(dirty.positions.end(), {{nan, 0, 0},
                                                   {0, inf, 0},
                                                   {1e30f, 0, 0},
                                                   {0, 0, -inf},
                                                   {-3e38f, 0, 0},
                                                   {0.5f, nan, inf},
                                                   {1e-42f, 1e-43f, -1e-44f}});
    dirty.triangles.clear();
    for (std::uint32_t i = 0; i < clean.triangles.size(); ++i) {
        dirty.triangles.push_back(clean.triangles[i]), result.original.push_back(i);
        if (i % 10 != 0) continue;
        const std::uint32_t kind = i / 10 % 8;
        dirty.triangles.push_back(kind < 6    ? glm::uvec3(3 * i, 3 * i + 1, bad + kind)
                                  : kind == 6 ? glm::uvec3(3 * i, 3 * i, 3 * i + 1)
                                              : glm::uvec3(bad + 6, bad + 6, bad + 6));
        result.original.push_back(CLARAY_MISS), ++result.junk_count;
    }
    return result;
}

/// The other triangles must be hit as if the junk did not exist.
void junk(Run& run, const Mesh& clean, const std::vector<Ray>& rays, const Bvh::Config& config,
          const std::string& what) {
    const JunkMesh dirty = with_junk(clean);
    const Bvh a = build(run, clean, config);
    const Bvh b = build(run, dirty.mesh, config);
    const auto expected = closest_hit(a, rays), found = closest_hit(b, rays);
    Tally changed;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::uint32_t primitive =
            found[i].primitive == CLARAY_MISS ? CLARAY_MISS : dirty.original[found[i].primitive];
        changed.add(primitive == expected[i].primitive && found[i].t == expected[i].t && found[i].u == expected[i].u &&
                    found[i].v == expected[i].v);
    }
    if (changed.wrong) run.failure(what + ", junk changes a hit: " + text_of(rays[changed.first]));
    run.check("hits that junk changes, " + what, changed, "rays");
    run.check("junk not counted, " + what, dirty.junk_count, std::abs(double(b.statistics().culled) - dirty.junk_count),
              0, "triangles");
}

void junk(Run& run) {
    const Mesh clean = soup(run.count<std::size_t>(5000, 100'000), 0.1f, run.seed() + 3);
    const auto rays = random_rays(run.count<std::size_t>(20'000, 500'000), 3.f, 1.f, run.seed() + 4);
    Mesh far = clean;
    std::vector<Ray> far_rays(rays.begin(), rays.begin() + run.count<std::ptrdiff_t>(5000, 500'000));
    move_away(far, far_rays);
    for (const auto& [layout, name] : layouts)
        for (const auto& [builder, builder_name, note, codes, splits] : builders) {
            const Bvh::Config config{.builder = builder, .layout = layout};
            const std::string what = std::string(builder_name) + ", " + name;
            junk(run, clean, rays, config, what);
            if (run.full() || builder == Builder::fast) junk(run, far, far_rays, config, what + " at 1e6");
        }
    if (!run.times()) return;
    const Mesh dirty = with_junk(clean).mesh;
    Bvh a = build(run, clean, {.builder = Builder::fast}), b = build(run, dirty, {.builder = Builder::fast});
    run.check_time(
        "building with junk", dirty.triangles.size(), [&] { b.rebuild(); }, [&] { a.rebuild(); }, 1.5);
}

/// Triangles with equal codes, or with codes that differ only along a line or in a plane.
struct EqualMeshes {
    Mesh equal, line, plane;
};

EqualMeshes equal_meshes(std::size_t count, std::uint64_t seed) {
    EqualMeshes meshes{soup(1, 0.5f, seed), {}, grid(unsigned(std::sqrt(double(count) / 2)))};
    meshes.equal.triangles.assign(count, glm::uvec3(0, 1, 2));
    for (std::uint32_t i = 0; i < std::uint32_t(count); ++i) {
        const auto x = float(i);
        meshes.line.positions.insert(meshes.line.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x + 2, 0, 0}});
        meshes.line.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return meshes;
}

void equal_codes(Run& run, const EqualMeshes& all, const std::string& at) {
    double faults = 0, excess = 0;
    std::uint64_t trees = 0;
    const std::pair<const Mesh*, const char*> meshes[] = {
        {&all.equal, "equal"}, {&all.line, "collinear"}, {&all.plane, "planar"}};
    for (const auto& [mesh, name] : meshes)
        for (const unsigned bits : {30u, 63u})
            for (const auto& [builder, builder_name, note, codes, splits] : builders) {
                if (!codes && bits == 30) continue;
                const Bvh bvh = build(run, *mesh, {.builder = builder, .morton_bits = bits});
                const double wrong = faults_of(bvh);
                if (wrong > 0) run.failure(name + at + ", " + builder_name + ": the tree is not sound");
                faults += wrong, ++trees;
                const double bound =
                    builder == Builder::fast ? bits + std::bit_width(mesh->triangles.size() - 1) : CLARAY_MAX_HEIGHT;
                excess = std::max(excess, double(state_of(bvh).read_header().height) - bound);
            }
    run.check("leaves missing or repeated, boxes that do not contain" + at, trees, faults, 0, "faults");
    run.check("height above bits + ceil(log2 N)" + at, trees, std::max(excess, 0.0), 0, "levels");
}

void equal_codes(Run& run) {
    const auto count = run.count<std::size_t>(60'000, 1'000'000);
    const EqualMeshes meshes = equal_meshes(count, run.seed());
    for (const Form& form : build_forms(run.device())) {
        const ScopedForm set(run.device(), form);
        equal_codes(run, meshes, form.name);
    }
    EqualMeshes far = equal_meshes(run.count<std::size_t>(5000, 100'000), run.seed());
    for (glm::vec3& p : far.line.positions) p += far_away;  // whole numbers, exactly
    move_away(far.equal), move_away(far.plane);
    equal_codes(run, far, " at 1e6");
    if (!run.times()) return;
    const Mesh uniform = soup(count, 0.01f, run.seed() + 2);
    Bvh a = build(run, meshes.equal, {.builder = Builder::fast}), b = build(run, uniform, {.builder = Builder::fast});
    run.check_time(
        "equal triangles against random ones", count, [&] { a.rebuild(); }, [&] { b.rebuild(); }, 2);
}

/// Aims every second ray at the cluster, which is the mesh's first `cluster` triangles.
void stadium(Run& run, const Mesh& mesh, std::size_t cluster, std::vector<Ray> rays, const std::string& at) {
    double costs[2][3];
    for (std::size_t i = 0; i < rays.size(); i += 2) {
        const glm::vec3 target = mesh.positions[i % (3 * cluster)] + glm::vec3(1e-6f),
                        origin(rays[i].ox, rays[i].oy, rays[i].oz);
        rays[i] = make_ray(origin, target - origin);
    }
    Tally differ;
    std::vector<Hit> slow;
    for (int bits = 0; bits < 2; ++bits)
        for (int builder = 0; builder < 3; ++builder) {
            const Bvh bvh = build(run, mesh, {.builder = builders[builder].builder, .morton_bits = bits ? 63u : 30u});
            costs[bits][builder] = bvh.statistics().sah_cost;
            const std::string name = std::string(builders[builder].name) + (bits ? ", 63 bits" : ", 30 bits") + at;
            run.fact("SAH cost, " + name, printed("%.4g", costs[bits][builder]));
            if (run.full() || bits == 1) {
                const Tally t = against_brute_force(run, bvh, rays, name, slow);
                differ.tried += t.tried, differ.wrong += t.wrong;
            }
        }
    run.check("hits that differ from brute force" + at, differ, "rays");
    run.check("cost with 63 bits over cost with 30" + at, 3,
              std::max({costs[1][0] / costs[0][0], costs[1][1] / costs[0][1], costs[1][2] / costs[0][2]}), 1.001,
              "times");
}

Mesh stadium_mesh(std::size_t count, std::size_t cluster, std::uint64_t seed) {
    Mesh mesh = soup(count, 0.02f, seed);
    for (std::size_t i = 0; i < 3 * cluster; ++i)
        mesh.positions[i] = mesh.positions[i] * 1e-4f + glm::vec3(0.3f, 0.1f, -0.2f);
    return mesh;
}

/// Nine tenths of the triangles are in a cluster of 1e-4 of the scene: codes of 30 bits cannot distinguish them.
void stadium(Run& run) {
    const auto count = run.count<std::size_t>(20'000, 500'000), cluster = count * 9 / 10;
    stadium(run, stadium_mesh(count, cluster, run.seed() + 7), cluster,
            random_rays(run.count<std::size_t>(2000, 20'000), 3.f, 1.f, run.seed() + 8), "");
    const auto few = run.count<std::size_t>(5000, 100'000), few_clustered = few * 9 / 10;
    Mesh far = stadium_mesh(few, few_clustered, run.seed() + 9);
    auto rays = random_rays(run.count<std::size_t>(500, 5000), 3.f, 1.f, run.seed() + 10);
    move_away(far, rays, 0x1p18f);  // the cluster's triangles are some sixteenths
    stadium(run, far, few_clustered, rays, " at 1e6");
}

/// Triangles at distances 2^-k, whose codes share longer and longer prefixes, and equal ones: as deep as codes allow.
/// Scaled by `size` with its corner at `corner_at`, where floats may be as coarse as `least`.
Mesh deep_mesh(float size = 1.f, glm::vec3 corner_at = glm::vec3(0.f), float least = 0.f) {
    Mesh mesh;
    const auto add = [&](glm::vec3 at, float edge) {
        const auto base = std::uint32_t(mesh.positions.size());
        at = corner_at + size * at, edge = std::max(size * edge, least);
        mesh.positions.insert(mesh.positions.end(), {at, at + glm::vec3(edge, 0, 0), at + glm::vec3(0, edge, 0)});
        mesh.triangles.emplace_back(base, base + 1, base + 2);
    };
    for (int k = 0; k < 21; ++k)
        for (int corner = 1; corner < 8; ++corner)
            add(glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2) * std::exp2(-float(k)), std::exp2(-float(k) - 8.f));
    for (int copy = 0; copy < 4096; ++copy) add(glm::vec3(0), 1e-9f);
    return mesh;
}

/// Rays at its triangles, except the equal ones.
std::vector<Ray> rays_into(const Mesh& mesh, std::size_t count, std::uint64_t seed, float scene_size = 1.f,
                           glm::vec3 corner_at = glm::vec3(0.f)) {
    Random random(seed);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::uvec3 t = mesh.triangles[random.below(147)];
        const glm::vec3 a = mesh.positions[t.x], target = (a + mesh.positions[t.y] + mesh.positions[t.z]) / 3.f;
        const float size = mesh.positions[t.y].x - a.x;
        glm::vec3 origin = corner_at + scene_size * glm::vec3(random.uniform(-1, 2), random.uniform(-1, 2), 3.f),
                  direction = target - origin;
        if (i % 2)  // from nearby, where float32 can aim
            origin = target + size * (random.in_cube(0.5f) + glm::vec3(0, 0, 1)),
            direction = {random.uniform(-0.2f, 0.2f), random.uniform(-0.2f, 0.2f), -1};
        rays.push_back(make_ray(origin, direction));
    }
    return rays;
}

void stack_depth(Run& run, const Mesh& mesh, const std::vector<Ray>& rays, const std::string& at) {
    const Oracle oracle(std::span(&mesh, 1));
    for (const auto& [layout, layout_name] : layouts) {
        const Bvh bvh = build(run, mesh, {.builder = Builder::fast, .layout = layout});
        const std::string name = layout_name + at;
        if (faults_of(bvh) > 0) run.failure("the tree is not sound" + at);
        run.check("faults of the tree, " + name, 1, faults_of(bvh), 0, "faults");
        run.check("height over the stack, " + name, 1, state_of(bvh).read_header().height, CLARAY_MAX_HEIGHT, "levels");
        if (state_of(bvh).read_header().height < 70) run.check("height that was provoked, " + name, 1, 1, 0, "");
        const auto hits = closest_hit(bvh, rays);
        const Oracle::Verdict verdict = oracle.judge(rays, hits);
        if (verdict.wrong)
            run.failure(name + ", " + to_string(verdict.first_fault) + ": " + text_of(rays[verdict.first_wrong]));
        run.check("wrong hits, " + name, rays.size(), double(verdict.wrong), 0, "rays");
    }
}

void stack_depth(Run& run) {
    const Mesh mesh = deep_mesh();
    stack_depth(run, mesh, rays_into(mesh, run.count<std::size_t>(10'000, 200'000), run.seed() + 32), "");
    // Between half a million and a million floats are sixteenths: of 2^19 that is enough for 21 levels a coordinate.
    const glm::vec3 corner(0x1p19f, -0x1p20f, 0x1p19f);
    const Mesh far = deep_mesh(0x1p19f, corner, 0x1p-4f);
    auto rays = rays_into(far, run.count<std::size_t>(1000, 50'000), run.seed() + 36, 0x1p19f, corner);
    stack_depth(run, far, rays, " at 1e6");
}

/// The bottom-up build is a lock-free algorithm: without a fence at device scope it would sometimes fail, on large
/// trees.
void rebuilds(Run& run, const Mesh& mesh, const BuilderTraits& builder, const std::string& what) {
    Bvh bvh = build(run, mesh, {.builder = builder.builder, .layout = Layout::binary});
    const std::string expected = bvh.hash();
    const int every = run.count(1, 50);  // a hash reads the whole tree
    Tally sound, same;
    for (int i = 0; i < run.count(60, 10'000); ++i) {
        bvh.rebuild();
        sound.add(faults_of(bvh) == 0);
        if (i % every == 0) same.add(bvh.hash() == expected);
    }
    if (sound.wrong) run.failure(what + ": rebuild " + std::to_string(sound.first) + " is not sound");
    if (same.wrong)
        run.failure(what + ": another tree at rebuild " + std::to_string(same.first * std::uint64_t(every)));
    run.check("rebuilds that are not sound, " + what, sound, "trees");
    run.check("rebuilds with another hash, " + what, same, "trees");
}

void rebuilds(Run& run) {
    const Mesh mesh = soup(run.count<std::size_t>(20'011, 200'003), 0.02f, run.seed() + 5);
    for (const Form& form : build_forms(run.device())) {
        const ScopedForm set(run.device(), form);
        for (const BuilderTraits& builder : builders)
            if (builder.codes) rebuilds(run, mesh, builder, builder.name + std::string(form.name));
    }
}

// ---- validation --------------------------------------------------------------------------------------------------

struct Range3 {
    glm::vec3 lo, hi;
    [[nodiscard]] bool contains(const Range3& b) const {
        return glm::all(glm::lessThanEqual(lo, b.lo)) && glm::all(glm::lessThanEqual(b.hi, hi));
    }
    [[nodiscard]] bool meets(const Range3& b) const {
        return glm::all(glm::lessThanEqual(lo, b.hi)) && glm::all(glm::lessThanEqual(b.lo, hi));
    }
    [[nodiscard]] bool holds(const glm::dvec3& p, const glm::dvec3& slack) const {
        return glm::all(glm::lessThanEqual(glm::dvec3(lo) - slack, p)) &&
               glm::all(glm::lessThanEqual(p, glm::dvec3(hi) + slack));
    }
};

Range3 box_of(const BvhNode& n, unsigned side) {
    return side == 0 ? Range3{{n.lo0x, n.lo0y, n.lo0z}, {n.hi0x, n.hi0y, n.hi0z}}
                     : Range3{{n.lo1x, n.lo1y, n.lo1z}, {n.hi1x, n.hi1y, n.hi1z}};
}

Range3 box_of(const LeafTriangle& t) {
    const glm::vec3 a(t.v0x, t.v0y, t.v0z), b(t.v1x, t.v1y, t.v1z), c(t.v2x, t.v2y, t.v2z);
    return {glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c)};
}

/// A copy of a tree, to be damaged and validated.
struct OpenTree {
    explicit OpenTree(const Bvh& of)
        : bvh(of),
          nodes(state_of(of).nodes.read()),
          leaves(state_of(of).leaves.read()),
          header(state_of(of).header.read()[0]) {}

    [[nodiscard]] BvhValidation validated() const {
        Buffer<BvhNode>(state_of(bvh).nodes).write(nodes);
        Buffer<LeafTriangle>(state_of(bvh).leaves).write(leaves);
        return bvh.validate();
    }

    Bvh bvh;
    std::vector<BvhNode> nodes;
    std::vector<LeafTriangle> leaves;
    BvhHeader header;
};

/// What a tree without split triangles must be told of.
BvhValidation expected_of(const OpenTree& tree) {
    BvhValidation v;
    const std::uint32_t inner = tree.header.inner_nodes, valid = tree.header.valid;
    std::vector<unsigned> whole(valid), parts(valid);
    for (std::uint32_t i = 0; i < inner; ++i) {
        const BvhNode& node = tree.nodes[i];
        if (node.child0 == CLARAY_NO_CHILD) continue;  // free
        v.links_broken += node.parent == CLARAY_NO_CHILD && tree.header.root != i;
        for (const unsigned side : {0u, 1u}) {
            const std::uint32_t child = side == 0 ? node.child0 : node.child1;
            const Range3 box = box_of(node, side);
            if ((child & CLARAY_LEAF) == 0) {
                if (child >= inner || tree.nodes[child].child0 == CLARAY_NO_CHILD) {
                    ++v.links_broken;
                    continue;
                }
                const Range3 a = box_of(tree.nodes[child], 0), b = box_of(tree.nodes[child], 1);
                v.boxes_not_containing += !box.contains({glm::min(a.lo, b.lo), glm::max(a.hi, b.hi)});
                v.links_broken += tree.nodes[child].parent != i;
                continue;
            }
            const std::uint32_t first = child & CLARAY_SLOT, count = CLARAY_LEAF_COUNT(child);
            if (first + count > valid) {
                ++v.links_broken;
                continue;
            }
            for (std::uint32_t k = first; k < first + count; ++k) {
                const LeafTriangle& leaf = tree.leaves[k];
                if (leaf.primitive >= valid)
                    ++v.links_broken;
                else if (box.contains(box_of(leaf)))
                    ++whole[leaf.primitive];
                else if (box.meets(box_of(leaf)))
                    ++parts[leaf.primitive];
                else
                    ++v.boxes_not_containing;
            }
        }
    }
    for (std::uint32_t i = 0; i < valid; ++i) {
        v.leaves_missing += whole[i] + parts[i] == 0;
        v.leaves_repeated += whole[i] + parts[i] > 1;
        v.boxes_not_containing += whole[i] == 0 && parts[i] != 0;  // a corner is outside
    }
    return v;
}

void damage(OpenTree& tree, Random& random, unsigned kind) {
    std::uint32_t at = random.below(tree.header.inner_nodes);
    while (tree.nodes[at].child0 == CLARAY_NO_CHILD) at = random.below(tree.header.inner_nodes);
    BvhNode& node = tree.nodes[at];
    float* const faces[] = {&node.lo0x, &node.lo0y, &node.lo0z, &node.lo1x, &node.lo1y, &node.lo1z,
                            &node.hi0x, &node.hi0y, &node.hi0z, &node.hi1x, &node.hi1y, &node.hi1z};
    const std::uint32_t leaf = random.below(tree.header.valid), child = random.below(2);
    if (kind < 12)
        *faces[kind] = std::nextafter(*faces[kind], kind < 6 ? INFINITY : -INFINITY);
    else if (kind < 24)
        *faces[kind - 12] += kind < 18 ? 9.f : -9.f;  // a box that is empty
    else if (kind == 24)
        node.parent = node.parent == CLARAY_NO_CHILD ? 0u : node.parent ^ 1u;
    else if (kind == 25)
        node.parent = CLARAY_NO_CHILD;
    else if (kind == 26)
        (child ? node.child1 : node.child0) = tree.header.inner_nodes;
    else if (kind == 27)
        (child ? node.child1 : node.child0) = CLARAY_LEAF | tree.header.valid;
    else if (kind == 28)
        tree.leaves[leaf].primitive = tree.leaves[(leaf + 1) % tree.header.valid].primitive;
    else
        tree.leaves[leaf].primitive = tree.header.valid + leaf;
}

/// Points of a triangle that validation looks for in the boxes of its parts, without the corners.
std::vector<glm::dvec3> points_in(const LeafTriangle& t) {
    const glm::dvec3 a(t.v0x, t.v0y, t.v0z), b(t.v1x, t.v1y, t.v1z), c(t.v2x, t.v2y, t.v2z);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 6; ++i)
        for (int j = 0; i + j <= 6 && j < 6; ++j)
            if (i + j != 0) points.push_back(a * ((6 - i - j) / 6.0) + b * (i / 6.0) + c * (j / 6.0));
    return points;
}

bool has_corner(const Range3& box, const LeafTriangle& t) {
    const glm::dvec3 slack(1e-4);
    return box.holds({t.v0x, t.v0y, t.v0z}, slack) || box.holds({t.v1x, t.v1y, t.v1z}, slack) ||
           box.holds({t.v2x, t.v2y, t.v2z}, slack);
}

/// Ends a part's box a little before a point that no other box holds: too much from one slack on.
struct Gap {
    std::size_t node;
    unsigned side;
    double end, slack;
};

std::vector<Gap> gaps_of(const OpenTree& tree) {
    struct Part {
        std::size_t node;
        unsigned side, triangles;
        Range3 box;
    };
    std::vector<std::vector<Part>> parts(tree.header.valid);
    std::vector<LeafTriangle> triangles(tree.header.valid);
    for (std::size_t i = 0; i < tree.header.inner_nodes; ++i)
        for (const unsigned side : {0u, 1u}) {
            const std::uint32_t child = side == 0 ? tree.nodes[i].child0 : tree.nodes[i].child1;
            if ((child & CLARAY_LEAF) == 0) continue;
            for (std::uint32_t k = 0; k < CLARAY_LEAF_COUNT(child); ++k) {
                const LeafTriangle& leaf = tree.leaves[(child & CLARAY_SLOT) + k];
                parts[leaf.primitive].push_back({i, side, CLARAY_LEAF_COUNT(child), box_of(tree.nodes[i], side)});
                triangles[leaf.primitive] = leaf;
            }
        }
    std::vector<Gap> gaps;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        if (parts[p].size() < 2) continue;
        const Range3 whole = box_of(triangles[p]);
        const double slack = 4.8e-7 * std::max(std::abs(whole.lo.x), std::abs(whole.hi.x));
        const std::vector<glm::dvec3> points = points_in(triangles[p]);
        for (const Part& part : parts[p]) {
            if (part.triangles > 1 || has_corner(part.box, triangles[p])) continue;
            const glm::dvec3* last = nullptr;
            for (const glm::dvec3& point : points)
                if (part.box.holds(point, glm::dvec3(1e-4)) && (!last || point.x > last->x)) last = &point;
            if (!last || !part.box.holds(*last, glm::dvec3(-1e-4)) || last->x - part.box.lo.x < 1e-3) continue;
            const auto holders = std::count_if(parts[p].begin(), parts[p].end(), [&](const Part& other) {
                return other.box.holds(*last, glm::dvec3(1e-4));
            });
            if (holders == 1) gaps.push_back({part.node, part.side, last->x, slack});
        }
    }
    return gaps;
}

void broken_trees(Run& run) {
    Random random(run.seed() + 31);
    const OpenTree sound(
        build(run, soup(700, 0.05f, run.seed() + 11), {.builder = Builder::balanced, .layout = Layout::binary}));
    Tally told;
    for (int i = 0; i < run.count(90, 3000); ++i) {
        OpenTree tree = sound;
        damage(tree, random, unsigned(i) % 30);
        const BvhValidation found = tree.validated(), expected = expected_of(tree);
        if (told.add(found.leaves_missing == expected.leaves_missing &&
                     found.leaves_repeated == expected.leaves_repeated &&
                     found.boxes_not_containing == expected.boxes_not_containing &&
                     found.links_broken == expected.links_broken))
            run.failure(printed("damage %d: %u %u %u %u of %u %u %u %u missing, repeated, boxes, links", i % 30,
                                found.leaves_missing, found.leaves_repeated, found.boxes_not_containing,
                                found.links_broken, expected.leaves_missing, expected.leaves_repeated,
                                expected.boxes_not_containing, expected.links_broken));
    }
    run.check("trees whose damage is not told", told, "trees");

    // Large triangles among small ones, in many parts.
    Mesh shards = soup(60, 1.f, run.seed() + 12);
    const Mesh dust = soup(3000, 0.02f, run.seed() + 13);
    for (const glm::uvec3& t : dust.triangles) shards.triangles.push_back(t + std::uint32_t(shards.positions.size()));
    shards.positions.insert(shards.positions.end(), dust.positions.begin(), dust.positions.end());
    Tally covered, uncovered;
    for (const Form& form : build_forms(run.device())) {
        const ScopedForm set(run.device(), form);
        const OpenTree split(build(run, shards, {.builder = Builder::high, .layout = Layout::binary}));
        covered.add(split.validated().ok());
        const std::vector<Gap> gaps = gaps_of(split);
        if (gaps.size() < 10) run.failure("too few parts to damage");
        for (std::size_t i = 0; i < std::min<std::size_t>(gaps.size(), run.count(20, 200)); ++i)
            for (const double slacks : {0.25, 4.0}) {
                OpenTree tree = split;
                BvhNode& node = tree.nodes[gaps[i].node];
                (gaps[i].side == 0 ? node.hi0x : node.hi1x) = float(gaps[i].end - slacks * gaps[i].slack);
                if (uncovered.add((tree.validated().boxes_not_containing == 0) == (slacks < 1)))
                    run.failure(printed("a gap of %g roundings between parts", slacks));
            }
        uncovered.add(gaps.size() >= 10);
    }
    run.check("sound trees with split triangles that are refused", covered, "trees");
    run.check("gaps between parts that are not told, or told although they are roundings", uncovered, "trees");
}

}  // namespace

Cases tree_cases() {
    return {
        {{"tiny-counts", "trees", "0, 1, 2 and a few triangles with every builder and layout"}, tiny_counts},
        {{"junk", "trees", "A tenth of NaN, infinite, huge and degenerate triangles changes no hit"}, junk, true},
        {{"equal-codes", "trees", "Equal, collinear and planar triangles: sound trees of bounded height"},
         equal_codes,
         true},
        {{"stadium", "trees", "Nine tenths of the triangles in a cluster of 1e-4 of the scene's size"}, stadium},
        {{"stack-depth", "trees", "The deepest tree that codes allow fits the stack"}, stack_depth},
        {{"rebuilds", "trees", "Repeated rebuilds give the same valid tree: the fences work"}, rebuilds},
        {{"broken-trees", "trees", "Validation tells damaged boxes, links and leaves from sound ones"}, broken_trees},
    };
}

}  // namespace claray::verify
