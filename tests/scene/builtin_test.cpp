// The built-in scenes: as many triangles as asked for, the same every time, sound, lit and in view.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <map>

#include "claray/error.hpp"
#include "claray/scene.hpp"

namespace claray {
namespace {

/// FNV-1a over the bits of all vertices, triangles and materials.
std::uint64_t hash_of(const Scene& scene) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto add = [&](std::uint32_t word) {
        for (int shift = 0; shift < 32; shift += 8) hash = (hash ^ (word >> shift & 0xff)) * 0x100000001b3u;
    };
    for (const Mesh& mesh : scene.meshes) {
        for (const glm::vec3& p : mesh.positions)
            for (int k = 0; k < 3; ++k) add(std::bit_cast<std::uint32_t>(p[k]));
        for (const glm::uvec3& t : mesh.triangles)
            for (int k = 0; k < 3; ++k) add(t[k]);
        for (const std::uint32_t material : mesh.materials) add(material);
    }
    return hash;
}

Scene make(const std::string& name) {
    std::optional<Scene> scene = builtin_scene(name);
    if (!scene) throw std::runtime_error(name + " is not built in");
    return *std::move(scene);
}

class Builtin : public ::testing::TestWithParam<std::string> {};

TEST_P(Builtin, IsValidNamedAndLit) {
    const Scene scene = make(GetParam());
    EXPECT_NO_THROW(validate(scene));
    EXPECT_EQ(scene.name, GetParam());
    const bool emits = std::any_of(scene.materials.begin(), scene.materials.end(),
                                   [](const Material& m) { return m.emission.x > 0.f; });
    EXPECT_TRUE(emits || scene.sky.zenith.x > 0.f || !scene.lights.empty());
    for (const Material& m : scene.materials) {
        EXPECT_LE(std::max({m.albedo.x, m.albedo.y, m.albedo.z}), 1.f) << m.name << " reflects more than it gets";
        EXPECT_FALSE(m.name.empty());
    }
    for (const Mesh& mesh : scene.meshes) EXPECT_FALSE(mesh.name.empty());
}

TEST_P(Builtin, IsTheSameEveryTime) { EXPECT_EQ(hash_of(make(GetParam())), hash_of(make(GetParam()))); }

TEST_P(Builtin, TrianglesHaveAreaAndNormalsUnitLength) {
    const Scene scene = make(GetParam());
    for (const Mesh& mesh : scene.meshes) {
        for (const glm::uvec3& t : mesh.triangles) {
            const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
            const glm::dvec3 normal = glm::cross(b - a, c - a);
            ASSERT_GT(glm::length(normal), 0.0) << mesh.name;
            // Shading normals lie on the side of the geometric ones.
            for (int k = 0; k < 3 && !mesh.normals.empty(); ++k)
                ASSERT_GT(glm::dot(normal, glm::dvec3(mesh.normals[t[k]])), -0.5 * glm::length(normal)) << mesh.name;
        }
        for (const glm::vec3& n : mesh.normals) ASSERT_NEAR(glm::length(n), 1.f, 1e-5f);
    }
}

/// A third of all triangles, lamps left out, have their centre in view: no scene is looked past.
TEST_P(Builtin, CameraSeesIt) {
    const Scene scene = make(GetParam());
    ASSERT_TRUE(scene.camera);
    const CameraData c = camera_data(*scene.camera, 4.f / 3.f);
    const glm::vec3 eye(c.x, c.y, c.z), forward(c.forward_x, c.forward_y, c.forward_z);
    const glm::vec3 right(c.right_x, c.right_y, c.right_z), up(c.up_x, c.up_y, c.up_z);
    std::size_t seen = 0, all = 0;
    for (const Mesh& mesh : scene.meshes) {
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const glm::uvec3& t = mesh.triangles[i];
            if (scene.materials[mesh.materials[i]].emission != glm::vec3(0.f)) continue;
            const glm::vec3 view = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.f - eye;
            const float depth = glm::dot(view, forward);
            ++all;
            seen += depth > 0.f && std::abs(glm::dot(view, right) / glm::dot(right, right)) < depth &&
                    std::abs(glm::dot(view, up) / glm::dot(up, up)) < depth;
        }
    }
    EXPECT_GT(double(seen), 0.33 * double(all)) << seen << " of " << all;
}

INSTANTIATE_TEST_SUITE_P(All, Builtin,
                         ::testing::Values("cornell", "spheres", "crate", "hills", "waves", "statues", "ball:8",
                                           "ball:33", "ball:1000", "terrain:1", "terrain:2", "terrain:20000", "soup:1",
                                           "soup:5000", "fan:3", "fan:7", "fan:65536", "fan:200000", "hair:1", "hair:2",
                                           "hair:49", "hair:20000"),
                         [](const auto& test) {
                             std::string name = test.param;
                             std::replace(name.begin(), name.end(), ':', '_');
                             return name;
                         });

TEST(BuiltinScenes, CountIsExact) {
    for (const std::string family : {"terrain", "soup", "fan", "hair"})
        for (const std::size_t count : {3, 4, 5, 31, 32, 33, 999, 1000, 65536, 65537, 131073})
            EXPECT_EQ(triangle_count(make(family + ":" + std::to_string(count))), count) << family;
    for (const std::size_t count : {8, 9, 10, 100, 3001})
        EXPECT_EQ(triangle_count(make("ball:" + std::to_string(count))), count);
    for (const std::string name : {"terrain:1", "soup:1", "hair:1"}) EXPECT_EQ(triangle_count(make(name)), 1u);
    EXPECT_EQ(triangle_count(make("terrain:2")), 2u);
    const Scene statues = make("statues");
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(statues.meshes[i].triangles.size(), 100'000u);
}

TEST(BuiltinScenes, CurvesAreTheStrandsOfHair) {
    for (const std::size_t count : {1, 2, 48, 49, 1000}) {
        const std::string n = ":" + std::to_string(count);
        const Scene hair = make("hair" + n), curves = make("curves" + n);
        EXPECT_EQ(triangle_count(curves), 0u);
        const PrimitiveSet& set = curves.primitives.at(0);
        EXPECT_LE(primitive_count(set), count / 3 + 2 * (count / 48 + 1));
        EXPECT_EQ(set.materials.size(), primitive_count(set));
        // The ribbons' border is within their half width of the curves' control points; an end's mirror image is a step
        // off.
        const Bounds of_hair = bounds_of(hair), of_curves = bounds_of(curves);
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(of_hair.lo[k], of_curves.lo[k], 0.15f) << n;
            EXPECT_NEAR(of_hair.hi[k], of_curves.hi[k], 0.15f) << n;
        }
        EXPECT_EQ(hair.materials.size(), curves.materials.size());
    }
}

TEST(BuiltinScenes, SameTrianglesOnEverySystem) {
    // Made by + - * / and square roots only, which IEEE 754 defines to the last bit. A change of these numbers changes
    // every measurement made with the scenes.
    const std::map<std::string, std::uint64_t> expected = {{"terrain:100000", 13676064398154369u},
                                                           {"soup:10000", 7696731321572545230u},
                                                           {"cornell", 5765582635334356047u}};
    for (const auto& [name, hash] : expected) EXPECT_EQ(hash_of(make(name)), hash) << name;
}

TEST(BuiltinScenes, NamesAreListedAndKnown) {
    std::size_t known = 0;
    for (std::string name : builtin_scene_names()) {
        if (name == "effect:NAME") name = "effect:glass";
        if (const std::size_t at = name.find(":N"); at != std::string::npos) name.replace(at, 2, ":10");
        EXPECT_TRUE(builtin_scene(name)) << name;
        ++known;
    }
    EXPECT_EQ(known, 14u);
    for (const std::string name : {"", "teapot", "cornell:3", "Cornell", "soups:3", "a/fan:3", "mesh.obj"})
        EXPECT_FALSE(builtin_scene(name)) << name;
}

TEST(BuiltinScenes, BadCountSaysWhatIsAllowed) {
    for (const std::string name : {"soup", "soup:", "soup:0", "soup:-1", "soup:abc", "soup:12x", "soup: 12", "soup:1.5",
                                   "soup:1431655766", "soup:99999999999999999999999", "terrain:0", "fan:2", "hair:0"}) {
        try {
            static_cast<void>(builtin_scene(name));
            ADD_FAILURE() << name;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            const std::string text = error.what();
            EXPECT_NE(text.find(name.starts_with("fan") ? "from 3 to 1431655765" : "from 1 to 1431655765"),
                      std::string::npos)
                << text;
        }
    }
}

/// The address space of this process grows by at most so many bytes while this lives.
class ScopedLimit {
public:
    explicit ScopedLimit(std::uint64_t more) {
        getrlimit(RLIMIT_AS, &before_);
        std::uint64_t pages = 0;
        std::ifstream("/proc/self/statm") >> pages;
        const rlimit limit{pages * std::uint64_t(sysconf(_SC_PAGESIZE)) + more, before_.rlim_max};
        setrlimit(RLIMIT_AS, &limit);
    }
    ~ScopedLimit() { setrlimit(RLIMIT_AS, &before_); }
    ScopedLimit(const ScopedLimit&) = delete;
    ScopedLimit& operator=(const ScopedLimit&) = delete;

private:
    rlimit before_{};
};

TEST(BuiltinScenes, ThatTheHostCannotHoldAreRefused) {
    const ScopedLimit limit(std::uint64_t(1) << 30);
    EXPECT_EQ(builtin_scene("soup:1000")->meshes[0].triangles.size(), 1000u);
    for (const std::string name : {"terrain:100000001", "soup:536870910", "soup:1431655765"}) try {
            static_cast<void>(builtin_scene(name));
            ADD_FAILURE() << name;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::user);
            EXPECT_NE(std::string(error.what()).find("of the host's memory, of which "), std::string::npos);
        }
}

TEST(BuiltinScenes, CornellIsClosedButForItsFront) {
    // Every edge of floor, walls, ceiling and lamp belongs to two triangles, but for those round the open front.
    const Scene scene = make("cornell");
    std::map<std::pair<std::array<float, 3>, std::array<float, 3>>, int> edges;
    const auto key = [](const glm::vec3& p) { return std::array{p.x, p.y, p.z}; };
    for (const Mesh& mesh : scene.meshes) {
        if (mesh.name.find("block") != std::string::npos) continue;
        for (const glm::uvec3& t : mesh.triangles)
            for (int k = 0; k < 3; ++k) {
                const auto a = key(mesh.positions[t[k]]), b = key(mesh.positions[t[(k + 1) % 3]]);
                ++edges[{std::min(a, b), std::max(a, b)}];
            }
    }
    int open = 0;
    for (const auto& [edge, count] : edges) {
        EXPECT_LE(count, 2);
        if (count == 2) continue;
        ++open;
        EXPECT_EQ(edge.first[2], 0.f);
        EXPECT_EQ(edge.second[2], 0.f);
    }
    EXPECT_EQ(open, 4);
}

TEST(BuiltinScenes, FansAreClosed) {
    for (const std::string name : {"fan:3", "fan:12", "fan:65536", "fan:70000"}) {
        const Mesh mesh = make(name).meshes.at(0);
        const std::size_t fans = mesh.positions.size() - mesh.triangles.size();
        EXPECT_EQ(fans, name == "fan:70000" ? 2u : 1u);
        std::vector<int> uses(mesh.positions.size());
        for (const glm::uvec3& t : mesh.triangles) {
            for (int k = 0; k < 3; ++k) ++uses[t[k]];
            const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
            ASSERT_GT(glm::cross(b - a, c - a).z, 0.f) << "all face +z";
        }
        EXPECT_EQ(std::size_t(std::count(uses.begin(), uses.end(), 2)), name == "fan:3" ? 3u : mesh.triangles.size())
            << "every rim vertex belongs to two triangles";
    }
}

TEST(BuiltinScenes, SoupLiesInTheUnitCube) {
    for (const std::string name : {"soup:1", "soup:10", "soup:50000"}) {
        const Bounds bounds = bounds_of(make(name));
        EXPECT_TRUE(glm::all(glm::greaterThanEqual(bounds.lo, glm::vec3(0.f)))) << name;
        EXPECT_TRUE(glm::all(glm::lessThanEqual(bounds.hi, glm::vec3(1.f)))) << name;
    }
    EXPECT_GT(glm::length(bounds_of(make("soup:50000")).extent()), 1.7f);
}

TEST(BuiltinScenes, HairIsLongAndThinAndPointsEverywhere) {
    const Mesh mesh = make("hair:500000").meshes.at(0);
    std::vector<double> slenderness;
    glm::dvec3 along(0.0);
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
        slenderness.push_back(longest * longest / glm::length(glm::cross(b - a, c - a)));  // length / height
        const glm::dvec3 edge = glm::normalize(c - a);
        along += edge * edge;
    }
    std::nth_element(slenderness.begin(), slenderness.begin() + 250000, slenderness.end());
    EXPECT_GT(slenderness[250000], 25.0);
    for (int axis = 0; axis < 3; ++axis) EXPECT_GT(along[axis], 0.1 * 500000) << "no axis is special";
}

TEST(BuiltinScenes, SpheresAreClosedAndRound) {
    const Scene scene = make("spheres");
    std::size_t spheres = 0;
    for (const Mesh& mesh : scene.meshes) {
        if (mesh.name != "sphere") continue;
        ++spheres;
        EXPECT_EQ(mesh.triangles.size(), 20480u);
        EXPECT_EQ(mesh.positions.size(), 10242u) << "Euler: V = 2 + F / 2 for a closed surface of genus 0";
        const Bounds bounds = bounds_of(mesh);
        const float radius = 0.5f * bounds.extent().x;
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            ASSERT_NEAR(glm::length(mesh.positions[i] - bounds.center()), radius, 2e-3f * radius);
            ASSERT_NEAR(glm::dot(mesh.positions[i] - bounds.center(), mesh.normals[i]), radius, 2e-3f * radius);
        }
        EXPECT_GE(bounds.lo.y, -1e-3f) << "above the floor";
    }
    EXPECT_EQ(spheres, 7u);
}

}  // namespace
}  // namespace claray
