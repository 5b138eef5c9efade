// Query: made once and run often, on any queue; and buffers over memory of the host and of other programs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "claray/instances.hpp"
#include "claray/query.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

struct Scenery {
    Mesh mesh = soup(700, 0.2f, 5);
    Bvh bvh = Bvh::build(device(), std::span(&mesh, 1));
    std::vector<Ray> rays = random_rays(1001, 2.f, 0.6f, 9);
    std::vector<Hit> expected = closest_hit(bvh, rays);
};
const Scenery& scenery() {
    static const Scenery made;
    return made;
}

bool same(const std::vector<Hit>& a, const std::vector<Hit>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Hit)) == 0;
}

QueryOptions coherent() {
    QueryOptions options;
    options.coherence = Coherence::coherent;  // so that nothing is waited for
    return options;
}

TEST(Query, GivesTheSameHitsEveryTime) {
    const Scenery& s = scenery();
    Query query(s.bvh, QueryKind::closest);
    for (int run = 0; run < 2; ++run) {
        std::vector<Hit> hits(s.rays.size());
        query.run(s.rays, hits);
        EXPECT_TRUE(same(hits, s.expected));
    }
    std::vector<std::uint8_t> any(s.rays.size());
    Query(s.bvh, QueryKind::any).run(s.rays, any);
    for (std::size_t i = 0; i < any.size(); ++i) EXPECT_EQ(any[i] != 0, s.expected[i].primitive != CLARAY_MISS);
    query.run(std::span<const Ray>(), std::span<Hit>());  // no rays
}

TEST(Query, OrdersQueuesByEvents) {
    const Scenery& s = scenery();
    const Device first = device().with_new_queue(), second = device().with_new_queue();
    ASSERT_NE(first.queue()(), second.queue()());
    Query here(s.bvh, QueryKind::closest, coherent(), first), there(s.bvh, QueryKind::any, coherent(), second);
    const Buffer<Ray> rays(first, s.rays);
    Buffer<Hit> hits(first, s.rays.size());
    Buffer<std::uint8_t> any(second, s.rays.size());
    cl::UserEvent begin(device().context());
    const cl::Event begins[] = {begin};
    const cl::Event traced = here.run(rays, hits, begins);
    const cl::Event traced_events[] = {traced};
    const cl::Event occluded = there.run(rays, any, traced_events);
    EXPECT_GT(traced.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>(), CL_COMPLETE) << "before what it waits for";
    EXPECT_GT(occluded.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>(), CL_COMPLETE);
    begin.setStatus(CL_COMPLETE);
    occluded.wait();
    EXPECT_EQ(traced.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>(), CL_COMPLETE);
    EXPECT_TRUE(same(hits.read(), s.expected));
}

TEST(Query, KeepsItsFilter) {
    const Scenery& s = scenery();
    QueryOptions options = coherent();
    options.filter = {"odd",
                      "static inline bool accept_hit(global const float* data, float3 origin, float3 direction, const "
                      "Hit* hit) { return hit->primitive % 2 == 1; }\n"};
    const std::vector<Hit> expected = closest_hit(s.bvh, s.rays, options);
    ASSERT_FALSE(same(expected, s.expected));
    const Device queue = device().with_new_queue();
    std::vector<Hit> hits(s.rays.size());
    std::vector<std::uint8_t> any(s.rays.size());
    Query(s.bvh, QueryKind::closest, options, queue).run(s.rays, hits);
    Query(s.bvh, QueryKind::any, options, queue).run(s.rays, any);
    EXPECT_TRUE(same(hits, expected));
    for (std::size_t i = 0; i < any.size(); ++i) EXPECT_EQ(any[i] != 0, expected[i].primitive != CLARAY_MISS);
    const Instance one[] = {make_instance(glm::mat4(1.f))};
    const InstancedBvh placed = InstancedBvh::build(std::span(&s.bvh, 1), one);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "filter", [&] { Query(placed, QueryKind::any, options); }));
}

TEST(Query, OfInstancesWritesInstanceHits) {
    const Scenery& s = scenery();
    const Instance instances[] = {make_instance(glm::mat4(1.f)),
                                  make_instance(glm::translate(glm::mat4(1.f), glm::vec3(3, 0, 0)))};
    const InstancedBvh placed = InstancedBvh::build(std::span(&s.bvh, 1), instances);
    const std::vector<InstanceHit> expected = closest_hit(placed, s.rays);
    std::vector<InstanceHit> hits(s.rays.size());
    Query query(placed, QueryKind::closest);
    query.run(s.rays, hits);
    EXPECT_EQ(std::memcmp(hits.data(), expected.data(), hits.size() * sizeof(InstanceHit)), 0);
    std::vector<Hit> others(s.rays.size());
    EXPECT_TRUE(throws_error(ErrorKind::usage, "InstanceHit", [&] { query.run(s.rays, others); }));
}

TEST(Query, ChecksBeforeItEnqueues) {
    const Scenery& s = scenery();
    Query query(s.bvh, QueryKind::closest, coherent());
    const Buffer<Ray> rays(device(), s.rays);
    Buffer<Hit> few(device(), s.rays.size() - 1), hits(device(), s.rays.size()), none;
    Buffer<std::uint8_t> bytes(device(), s.rays.size());
    EXPECT_TRUE(throws_error(ErrorKind::usage, "results", [&] { (void)query.run(rays, few); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "bytes", [&] { (void)query.run(rays, bytes); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "not allocated", [&] { (void)query.run(rays, none); }));
    const Device stranger = Device::open(std::to_string(device().info().index));
    Buffer<Hit> foreign(stranger, s.rays.size());
    EXPECT_TRUE(throws_error(ErrorKind::usage, "another context", [&] { (void)query.run(rays, foreign); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "different contexts",
                             [&] { (void)Query(s.bvh, QueryKind::any, {}, stranger); }));
    std::vector<Hit> short_hits(3);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "3 results", [&] { query.run(s.rays, short_hits); }));
}

TEST(Buffer, OverHostMemoryIsUsedOrCopied) {
    const Scenery& s = scenery();
    std::vector<Hit> hits(s.rays.size() + 1);
    for (const std::size_t shift : {0u, 1u}) {  // a hit is 20 bytes: the second place is not aligned, and is copied
        const auto rays = Buffer<Ray>::over(device(), s.rays);
        const std::span<Hit> place = std::span(hits).subspan(shift, s.rays.size());
        auto results = Buffer<Hit>::under(device(), place);
        (void)Query(s.bvh, QueryKind::closest).run(rays, results);
        results.fetch(place);
        EXPECT_TRUE(same({place.begin(), place.end()}, s.expected)) << shift;
    }
}

TEST(Buffer, OfAnotherProgramIsAdopted) {
    const std::vector<std::uint32_t> numbers = {1, 2, 3, 4};
    const Buffer<std::uint32_t> own(device(), numbers);
    EXPECT_EQ(Buffer<std::uint32_t>::adopt(device(), own.memory()(), 3).read(), (std::vector<std::uint32_t>{1, 2, 3}));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "16 bytes",
                             [&] { (void)Buffer<std::uint32_t>::adopt(device(), own.memory()(), 5); }));
    EXPECT_TRUE(
        throws_error(ErrorKind::usage, "null", [&] { (void)Buffer<std::uint32_t>::adopt(device(), nullptr, 1); }));
    const Device stranger = Device::open(std::to_string(device().info().index));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "another context",
                             [&] { (void)Buffer<std::uint32_t>::adopt(stranger, own.memory()(), 1); }));
}

class ClosedQuery : public testing::TestWithParam<Layout> {};

/// A box of 12 triangles, and rays along z through the edges and corners of its silhouette.
TEST_P(ClosedQuery, HitsWhereRaysOnlyTouch) {
    Mesh box;
    for (int i = 0; i < 8; ++i) box.positions.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const Bvh bvh = Bvh::build(device(), std::span(&box, 1), {.layout = GetParam()});
    std::vector<Ray> rays;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y) rays.push_back(make_ray({x, y, 5}, {0, 0, -1}));
    rays.push_back(make_ray({std::nextafter(1.f, 2.f), 0, 5}, {0, 0, -1}));
    QueryOptions closed;
    closed.closed = true;
    unsigned half_open = 0, touched = 0;
    for (const Hit& hit : closest_hit(bvh, rays)) half_open += hit.primitive != CLARAY_MISS;
    for (const Hit& hit : closest_hit(bvh, rays, closed)) touched += hit.primitive != CLARAY_MISS && hit.t == 4.f;
    EXPECT_EQ(half_open, 4u);  // the middle, two sides and their corner
    EXPECT_EQ(touched, 9u);
}
INSTANTIATE_TEST_SUITE_P(Layouts, ClosedQuery, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::wide ? "wide" : "binary"; });

}  // namespace
}  // namespace claray::test
