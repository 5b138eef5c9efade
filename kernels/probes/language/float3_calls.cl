// Functions that are not inlined take and return vectors of two, three and four components.
__attribute__((noinline)) float2 scaled2(float2 v) { return v * v.y; }
__attribute__((noinline)) float3 scaled3(float3 v) { return v * v.y; }
__attribute__((noinline)) float4 scaled4(float4 v) { return v * v.y; }
__attribute__((noinline)) float3 crossed(float3 a, float3 b) { return a.yzx * b.zxy - a.zxy * b.yzx; }

kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0), x = words[i] & 255, y = words[i + 16384] & 255, z = words[i + 32768] & 255;
    const float a = x, b = y, c = z;  // products of small integers are exact
    const float2 two = scaled2((float2)(a, b));
    const float3 three = scaled3((float3)(a, b, c)), cross = crossed((float3)(a, b, c), (float3)(b, c, a));
    const float4 four = scaled4((float4)(a, b, c, a));
    uint bad = two.x != a * b || two.y != b * b;
    bad += three.x != a * b || three.y != b * b || three.z != c * b;
    bad += four.x != a * b || four.y != b * b || four.z != c * b || four.w != a * b;
    bad += cross.x != b * a - c * c || cross.y != c * b - a * a || cross.z != a * c - b * b;
    wrong[i] = bad;
}
