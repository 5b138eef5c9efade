// Structs of include/claray/shared have the same size and offsets on the device as on the host.
#include <gtest/gtest.h>

#include <cstddef>
#include <sstream>

#include "claray/program.hpp"
#include "claray/shared/bvh_node.h"
#include "claray/shared/denoise.h"
#include "claray/shared/instance.h"
#include "claray/shared/path.h"
#include "claray/shared/scene.h"
#include "claray/shared/texture.h"
#include "claray/shared/types.h"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

struct Field {
    const char* type;
    const char* name;
    std::size_t offset, size;  // on the host
};

#define FIELD(type, name) \
    Field { #type, #name, offsetof(type, name), sizeof(type) }
const Field fields[] = {
    FIELD(Ray, ox),
    FIELD(Ray, tmin),
    FIELD(Ray, dz),
    FIELD(Ray, tmax),
    FIELD(Hit, t),
    FIELD(Hit, v),
    FIELD(Hit, primitive),
    FIELD(Hit, geometry),
    FIELD(NearestPoint, distance),
    FIELD(NearestPoint, v),
    FIELD(NearestPoint, geometry),
    FIELD(Visits, nodes),
    FIELD(Visits, triangles),
    FIELD(BvhNode, lo0x),
    FIELD(BvhNode, lo1y),
    FIELD(BvhNode, hi1z),
    FIELD(BvhNode, child0),
    FIELD(BvhNode, parent),
    FIELD(BvhNode, height_count),
    FIELD(LeafTriangle, v0x),
    FIELD(LeafTriangle, primitive),
    FIELD(LeafTriangle, geometry),
    FIELD(LeafTriangle, mask),
    FIELD(WideNode, lox),
    FIELD(WideNode, hiy),
    FIELD(WideNode, hiz),
    FIELD(WideNode, child),
    FIELD(WideNode, source),
    FIELD(TriangleBlock, v0x),
    FIELD(TriangleBlock, v2z),
    FIELD(TriangleBlock, primitive),
    FIELD(TriangleBlock, mask),
    FIELD(PrimitiveBlock, shape),
    FIELD(PrimitiveBlock, primitive),
    FIELD(BvhHeader, lox),
    FIELD(BvhHeader, root),
    FIELD(BvhHeader, culled),
    FIELD(BvhHeader, wide_nodes),
    FIELD(BvhHeader, widening),
    FIELD(BvhHeader, first_leaf),
    FIELD(Instance, row2),
    FIELD(Instance, bottom),
    FIELD(Instance, id),
    FIELD(PlacedInstance, row1),
    FIELD(PlacedInstance, mask),
    FIELD(MovingInstance, end),
    FIELD(InstanceHit, v),
    FIELD(InstanceHit, geometry),
    FIELD(InstanceHit, instance),
    FIELD(PrimitiveStore, data),
    FIELD(PrimitiveStore, colors),
    FIELD(Guide, glow_b),
    FIELD(Guide, nearness),
    FIELD(Sight, normal_x),
    FIELD(Sight, nearness),
    FIELD(GuideStep, listed),
    FIELD(FilterStep, spacing),
    FIELD(CameraPair, before),
    FIELD(MaterialData, albedo_r),
    FIELD(MaterialData, kind),
    FIELD(MaterialData, roughness),
    FIELD(MaterialData, ior),
    FIELD(MaterialData, thin_walled),
    FIELD(MaterialData, layers),
    FIELD(MaterialData, film_thickness),
    FIELD(MaterialData, coat_z),
    FIELD(TriangleLight, v0x),
    FIELD(TriangleLight, area),
    FIELD(TriangleLight, primitive),
    FIELD(TriangleLight, probability),
    FIELD(PunctualLight, x),
    FIELD(PunctualLight, intensity_b),
    FIELD(PunctualLight, direction_z),
    FIELD(PunctualLight, inverse_range),
    FIELD(PunctualLight, attenuation_2),
    FIELD(LightNode, radius),
    FIELD(LightNode, cos_reach),
    FIELD(LightNode, child),
    FIELD(LightTrail, leaf),
    FIELD(LightLeaf, start),
    FIELD(HotSpot, leaf),
    FIELD(CameraData, x),
    FIELD(CameraData, up_z),
    FIELD(CameraData, aperture),
    FIELD(CameraData, view_z),
    FIELD(CameraData, half_height),
    FIELD(CameraData, projection),
    FIELD(SkyData, horizon_r),
    FIELD(SkyData, zenith_b),
    FIELD(PathState, pdf),
    FIELD(PathState, path),
    FIELD(PathState, flags),
    FIELD(LightSample, path),
    FIELD(Batch, first_pixel),
    FIELD(Batch, samples),
    FIELD(Batch, listed),
    FIELD(FrameData, sky),
    FIELD(FrameData, seed),
    FIELD(FrameData, tables),
    FIELD(SceneTables, environment_cdf),
    FIELD(SceneTables, listed_pixels),
    FIELD(Step, frame),
    FIELD(Step, room),
    FIELD(Step, waves),
    FIELD(FrameData, lights),
    FIELD(LightsData, tree_probability),
    FIELD(LightsData, not_to_hot_spots),
    FIELD(LightsData, environment),
    FIELD(EnvironmentData, probability),
    FIELD(ColorSum, lost_r),
    FIELD(FilmPixel, odd_sum),
    FIELD(FilmPixel, count),
    FIELD(FilmPixel, dropped),
    FIELD(TextureStore, decode),
    FIELD(TextureStore, uvs),
    FIELD(TextureStore, cutouts),
    FIELD(TextureData, format),
    FIELD(TextureData, wrap_v),
    FIELD(TextureData, offset),
    FIELD(TextureUseData, m12),
    FIELD(TextureUseData, uv_set),
    FIELD(MaterialMaps, use),
    FIELD(MaterialMaps, height_scale),
    FIELD(MaterialMaps, coat_normal_scale),
    FIELD(RayCone, spread),
};
#undef FIELD

/// A kernel that writes offset and size of every field's struct.
std::string layout_kernel() {
    std::ostringstream source;
    for (const char* header : {"types", "bvh_node", "instance", "scene", "path", "texture", "denoise"})
        source << "#include \"claray/shared/" << header << ".h\"\n";
    source << "kernel void layout(global uint2* out) {\n";
    std::size_t i = 0;
    for (const Field& field : fields)
        source << "    out[" << i++ << "] = (uint2)((uint)(size_t)&((" << field.type << "*)0)->" << field.name
               << ", (uint)sizeof(" << field.type << "));\n";
    source << "}\n";
    return source.str();
}

TEST(SharedStructs, SameLayoutOnTheDevice) {
    struct OffsetAndSize {
        std::uint32_t offset, size;
    };
    Buffer<OffsetAndSize> out(device(), std::size(fields));
    compile_kernel(device(), layout_kernel(), "layout").run({1}, out);
    const auto on_device = out.read();
    for (std::size_t i = 0; i < std::size(fields); ++i) {
        EXPECT_EQ(on_device[i].offset, fields[i].offset) << fields[i].type << "::" << fields[i].name;
        EXPECT_EQ(on_device[i].size, fields[i].size) << fields[i].type;
    }
}

}  // namespace
}  // namespace claray::test
