// cuBQL (github.com/NVIDIA/cuBQL) on recorded scenes and rays, for comparing with bench_build and bench_trace:
//   nvcc -O3 -std=c++17 -arch=native --extended-lambda -I CUBQL bench/peers/cubql.cu -o cubql && ./cubql NAME.scn...
// prints for each builder the build (boxes of the triangles included) and the three kinds of rays of NAME.ray, medians
// of 11 after two warm-ups, and rays that differ from NAME.ref. The peer gets what it likes best: triangles gathered
// ahead of time, Moeller and Trumbore's test, each leaf size, the best of three block sizes.
#include <cuda_runtime.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#define CUBQL_GPU_BUILDER_IMPLEMENTATION 1
#include "cuBQL/builder/cuda.h"
#include "cuBQL/builder/cuda/radix.h"
#include "cuBQL/builder/cuda/rebinMortonBuilder.h"
#include "cuBQL/bvh.h"
#include "cuBQL/traversal/rayQueries.h"

namespace {

using cuBQL::box3f;
using cuBQL::bvh3f;
using cuBQL::vec3f;

struct Ray {
    float origin[3], t_min, direction[3], t_max;
};
struct Triangle {
    float4 a, e1, e2;
};

void check(cudaError_t status) {
    if (status != cudaSuccess) throw std::runtime_error(cudaGetErrorString(status));
}

std::vector<std::uint32_t> read_words(const std::string& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw std::runtime_error(path + ": can't be read");
    std::vector<std::uint32_t> words(std::size_t(file.tellg() + std::streamoff(3)) / 4);
    file.seekg(0);
    file.read(reinterpret_cast<char*>(words.data()), std::streamsize(words.size() * 4));
    return words;
}

template <class T>
T* upload(const T* data, std::size_t count) {
    T* device = nullptr;
    check(cudaMalloc(&device, count * sizeof(T)));
    check(cudaMemcpy(device, data, count * sizeof(T), cudaMemcpyHostToDevice));
    return device;
}

template <class Work>
double median_ms(Work work, int repeat = 11) {
    cudaEvent_t begin, end;
    check(cudaEventCreate(&begin));
    check(cudaEventCreate(&end));
    std::vector<float> times;
    for (int i = -2; i < repeat; ++i) {
        check(cudaEventRecord(begin));
        work();
        check(cudaEventRecord(end));
        check(cudaEventSynchronize(end));
        float ms = 0;
        check(cudaEventElapsedTime(&ms, begin, end));
        if (i >= 0) times.push_back(ms);
    }
    check(cudaGetLastError());
    std::nth_element(times.begin(), times.begin() + repeat / 2, times.end());
    return times[repeat / 2];
}

__global__ void bound(box3f* boxes, const Triangle* triangles, std::uint32_t count) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    const Triangle t = triangles[i];
    const vec3f a(t.a.x, t.a.y, t.a.z), e1(t.e1.x, t.e1.y, t.e1.z), e2(t.e2.x, t.e2.y, t.e2.z);
    boxes[i] = box3f().extend(a).extend(a + e1).extend(a + e2);
}

__device__ bool hits(const Triangle* triangles, std::uint32_t id, const cuBQL::ray3f& ray, float* distance) {
    const float4 a4 = __ldg(&triangles[id].a), b4 = __ldg(&triangles[id].e1), c4 = __ldg(&triangles[id].e2);
    const vec3f a(a4.x, a4.y, a4.z), e1(b4.x, b4.y, b4.z), e2(c4.x, c4.y, c4.z);
    const vec3f p = cross(ray.direction, e2);
    const float inverse = 1.f / dot(e1, p);
    const vec3f s = ray.origin - a;
    const float u = dot(s, p) * inverse;
    const vec3f q = cross(s, e1);
    const float v = dot(ray.direction, q) * inverse;
    *distance = dot(e2, q) * inverse;
    return u >= 0.f && v >= 0.f && u + v <= 1.f && *distance > ray.tMin && *distance < ray.tMax;
}

__device__ cuBQL::ray3f load(const Ray* rays, std::uint32_t i) {
    const float4* words = reinterpret_cast<const float4*>(rays + i);
    const float4 o = words[0], d = words[1];
    return {vec3f(o.x, o.y, o.z), vec3f(d.x, d.y, d.z), o.w, d.w};
}

__global__ void closest(bvh3f bvh, const Triangle* triangles, const Ray* rays, std::uint32_t count, float2* found) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    cuBQL::ray3f ray = load(rays, i);
    std::uint32_t hit = ~0u;
    float nearest = ray.tMax;
    cuBQL::shrinkingRayQuery::forEachPrim(
        [&](std::uint32_t id) {
            float t;
            cuBQL::ray3f shorter = ray;
            shorter.tMax = nearest;
            if (hits(triangles, id, shorter, &t)) nearest = t, hit = id;
            return nearest;
        },
        bvh, ray);
    found[i] = make_float2(hit == ~0u ? 1e30f : nearest, __uint_as_float(hit));
}

__global__ void any(bvh3f bvh, const Triangle* triangles, const Ray* rays, std::uint32_t count, std::uint8_t* found) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    const cuBQL::ray3f ray = load(rays, i);
    bool occluded = false;
    cuBQL::fixedRayQuery::forEachLeaf(
        [&](const std::uint32_t* ids, std::size_t n) -> int {
            float t;
            for (std::size_t k = 0; k < n && !occluded; ++k) occluded = hits(triangles, ids[k], ray, &t);
            return occluded ? CUBQL_TERMINATE_TRAVERSAL : CUBQL_CONTINUE_TRAVERSAL;
        },
        bvh, ray);
    found[i] = occluded;
}

void measure(const std::string& path) {
    const std::string stem = path.substr(0, path.size() - 4);
    const auto scene = read_words(path), recorded = read_words(stem + ".ray"), reference = read_words(stem + ".ref");
    const std::uint32_t vertices = scene[1], count = scene[2];
    const auto* positions = reinterpret_cast<const float*>(scene.data() + 4);
    const std::uint32_t* indices = scene.data() + 4 + 3 * std::size_t(vertices);
    std::vector<Triangle> host(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const float *a = positions + 3 * std::size_t(indices[3 * i]),
                    *b = positions + 3 * std::size_t(indices[3 * i + 1]),
                    *c = positions + 3 * std::size_t(indices[3 * i + 2]);
        host[i] = {{a[0], a[1], a[2], 0},
                   {b[0] - a[0], b[1] - a[1], b[2] - a[2], 0},
                   {c[0] - a[0], c[1] - a[1], c[2] - a[2], 0}};
    }
    const Triangle* triangles = upload(host.data(), count);
    const std::uint32_t n[3] = {recorded[1], recorded[2], recorded[3]};
    const std::size_t all = std::size_t(n[0]) + n[1] + n[2];
    const Ray* rays = upload(reinterpret_cast<const Ray*>(recorded.data() + 4), all);
    const auto* t0 = reinterpret_cast<const float*>(reference.data() + 4);
    const auto* occluded = reinterpret_cast<const std::uint8_t*>(t0 + n[0]);
    std::vector<float> t2(n[2]);
    std::memcpy(t2.data(), occluded + n[1], n[2] * 4);
    box3f* boxes;
    check(cudaMalloc(&boxes, count * sizeof(box3f)));
    float2* found;
    check(cudaMalloc(&found, std::max(n[0], n[2]) * sizeof(float2)));
    std::uint8_t* found_any;
    check(cudaMalloc(&found_any, n[1]));

    const auto report = [&](const char* name, int leaf, auto build) {
        cuBQL::BuildConfig config;
        config.makeLeafThreshold = leaf;
        bvh3f bvh;
        bool built = false;
        const double build_ms = median_ms(
            [&] {
                if (built) cuBQL::cuda::free(bvh);
                built = true;
                bound<<<(count + 255) / 256, 256>>>(boxes, triangles, count);
                build(bvh, config);
            },
            11);
        double best[3] = {1e30, 1e30, 1e30};
        for (const int block : {32, 64, 128}) {
            const auto blocks = [&](std::uint32_t rays_here) { return (rays_here + block - 1) / block; };
            best[1] = std::min(best[1], median_ms([&] {
                                   any<<<blocks(n[1]), block>>>(bvh, triangles, rays + n[0], n[1], found_any);
                               }));
            best[2] = std::min(best[2], median_ms([&] {
                                   closest<<<blocks(n[2]), block>>>(bvh, triangles, rays + n[0] + n[1], n[2], found);
                               }));
        }
        const auto differences = [&](const float* expected, std::uint32_t rays_here) {
            std::vector<float2> hit(rays_here);
            check(cudaMemcpy(hit.data(), found, rays_here * sizeof(float2), cudaMemcpyDeviceToHost));
            std::size_t wrong = 0;
            for (std::uint32_t i = 0; i < rays_here; ++i)
                wrong += std::fabs(hit[i].x - expected[i]) > 1e-3f * std::max(1.f, std::fabs(expected[i]));
            return wrong;
        };
        const std::size_t wrong_bounce = differences(t2.data(), n[2]);
        for (const int block : {32, 64, 128})
            best[0] = std::min(best[0], median_ms([&] {
                                   closest<<<(n[0] + block - 1) / block, block>>>(bvh, triangles, rays, n[0], found);
                               }));
        std::printf(
            "%s %s leaf %d: build %.3f ms; primary %.0f, shadow %.0f, bounce %.0f Mrays/s; with 10 M rays %.2f %.2f "
            "%.2f ms; differences %zu, %zu\n",
            path.c_str(), name, leaf, build_ms, n[0] * 1e-3 / best[0], n[1] * 1e-3 / best[1], n[2] * 1e-3 / best[2],
            build_ms + best[0] * 1e7 / n[0], build_ms + best[1] * 1e7 / n[1], build_ms + best[2] * 1e7 / n[2],
            differences(t0, n[0]), wrong_bounce);
        cuBQL::cuda::free(bvh);
    };
    for (const int leaf : {0, 1, 2, 4, 8}) {
        report("radix", leaf, [&](bvh3f& bvh, auto config) { cuBQL::cuda::radixBuilder(bvh, boxes, count, config); });
        report("rebin", leaf,
               [&](bvh3f& bvh, auto config) { cuBQL::cuda::rebinRadixBuilder(bvh, boxes, count, config); });
        report("median", leaf, [&](bvh3f& bvh, auto config) { cuBQL::gpuBuilder(bvh, boxes, count, config); });
        if (leaf <= 1)
            report("sah", leaf, [&](bvh3f& bvh, auto config) {
                config.enableSAH();
                cuBQL::gpuBuilder(bvh, boxes, count, config);
            });
    }
    for (const void* p :
         {(const void*)triangles, (const void*)rays, (const void*)boxes, (const void*)found, (const void*)found_any})
        check(cudaFree(const_cast<void*>(p)));
}

}  // namespace

int main(int argc, char** argv) try {
    for (int i = 1; i < argc; ++i) measure(argv[i]);
} catch (const std::exception& error) {
    std::fprintf(stderr, "cubql: error: %s\n", error.what());
    return 1;
}
