// The G-buffer's packed formats as the second pass of deferred shading reads them.
#include "claray/shared/gbuffer.h"

/// Packs directions (three numbers each) and unpacks them again.
kernel void pack_normals(uint count, uint spherical, global const float* directions, global uint* codes, global float* restored) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const UnitVector n = {directions[3 * i], directions[3 * i + 1], directions[3 * i + 2]};
    const uint code = spherical ? claray_pack_spherical(n) : claray_pack_octahedral(n);
    const UnitVector got = spherical ? claray_unpack_spherical(code) : claray_unpack_octahedral(code);
    codes[i] = code;
    vstore3((float3)(got.x, got.y, got.z), i, restored);
}

/// Positions from depths by the inverse of view and projection, given in four columns.
kernel void restore_positions(uint width, uint height, float4 x_column, float4 y_column, float4 depth_column, float4 one_column,
                              global const GBufferPixel* pixels, global float* positions) {
    const uint i = get_global_id(0);
    if (i >= width * height) return;
    const float x = 2.0f * (i % width + 0.5f) / width - 1.0f, y = 1.0f - 2.0f * (i / width + 0.5f) / height;
    const float4 place = x * x_column + y * y_column + pixels[i].depth * depth_column + one_column;
    vstore3(place.xyz / place.w, i, positions);
}
