// Texels of an image of 128 x 128 are read by their places, and by a sampler that takes the nearest, also beyond the borders.
constant sampler_t nearest = CLK_NORMALIZED_COORDS_FALSE | CLK_ADDRESS_CLAMP_TO_EDGE | CLK_FILTER_NEAREST;
constant sampler_t bordered = CLK_NORMALIZED_COORDS_FALSE | CLK_ADDRESS_CLAMP | CLK_FILTER_NEAREST;
constant sampler_t repeated = CLK_NORMALIZED_COORDS_TRUE | CLK_ADDRESS_REPEAT | CLK_FILTER_NEAREST;

uint texel(float4 color) {  // x / 255, to 1.5 ulp
    const uint4 c = convert_uint4_rte(color * 255);
    return all(fabs(color * 255 - convert_float4(c)) < 1e-4f) ? c.x | c.y << 8 | c.z << 16 | c.w << 24 : 0xbad;
}

kernel void probe(global const uint* words, global uint* wrong, read_only image2d_t image, write_only image2d_t out) {
    const uint i = get_global_id(0);
    const int x = i % 128, y = i / 128;
    uint bad = texel(read_imagef(image, nearest, (int2)(x, y))) != words[i];
    bad += texel(read_imagef(image, nearest, (float2)(x + 0.01f, y + 0.99f))) != words[i];
    bad += texel(read_imagef(image, nearest, (int2)(x - 64, y + 64))) != words[min(y + 64, 127) * 128 + max(x - 64, 0)];
    bad += texel(read_imagef(image, bordered, (int2)(x, y + 64))) != (y < 64 ? words[i + 64 * 128] : 0);
    bad += texel(read_imagef(image, repeated, (float2)((x + 0.5f) / 128 - 1, (y + 0.5f) / 128 + 0.5f))) != words[(y + 64) % 128 * 128 + x];
    bad += get_image_width(image) != 128 || get_image_height(image) != 128;
    const uint word = i * 2654435761u;
    write_imagef(out, (int2)(x, y), convert_float4((uint4)(word & 255, word >> 8 & 255, word >> 16 & 255, word >> 24)) / 255);
    wrong[i] = bad;
}
