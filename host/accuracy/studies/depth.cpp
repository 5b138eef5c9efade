// Study of depth buffers: the pixels in which a format cannot tell the nearest surface from another one.
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/accuracy/studies/depth.hpp"
#include "host/base/in_parallel.hpp"
#include "host/measure/rays.hpp"

namespace claray {
namespace {

enum class DepthKind { normalised, floating, reversed };

struct DepthFormat {
    const char* name;
    DepthKind kind;
    unsigned bits;
};

constexpr DepthFormat depth_formats[] = {{"8 bits", DepthKind::normalised, 8},
                                         {"16 bits", DepthKind::normalised, 16},
                                         {"24 bits", DepthKind::normalised, 24},
                                         {"float32", DepthKind::floating, 32},
                                         {"reversed float32", DepthKind::reversed, 32}};

/// What a format stores of a distance along the view; never larger for a nearer surface. Only the format rounds:
/// the depth itself is computed in float64.
double stored_depth(const DepthFormat& format, double z, double near, double far) {
    if (format.kind == DepthKind::reversed) return -double(float(near / (far - near) * (far / z - 1)));
    const double depth = far / (far - near) * (1 - near / z);
    if (format.kind == DepthKind::floating) return double(float(depth));
    return std::floor(depth * (std::ldexp(1.0, int(format.bits)) - 1) + 0.5);
}

/// Closer than float64 can tell in these computations: the same surface, such as triangles that share an edge.
bool is_behind(double z, double nearest) { return z > nearest * (1 + 1e-12); }

/// A pixel's centre on the plane at distance 1: its ray, and its axes to find the pixels that a triangle may cover.
struct PinholeImage {
    explicit PinholeImage(const CameraData& c, unsigned w, unsigned h)
        : width(w),
          height(h),
          right(c.right_x, c.right_y, c.right_z),
          up(c.up_x, c.up_y, c.up_z),
          forward(c.forward_x, c.forward_y, c.forward_z),
          eye(c.x, c.y, c.z) {}

    unsigned width, height;
    glm::dvec3 right, up, forward, eye;
};

struct PixelBox {
    unsigned x0, y0, x1, y1;  // x1 and y1 are not in it
};

/// Contains all pixels that the triangle covers, and maybe others.
PixelBox pixels_of_triangle(const PinholeImage& image, const glm::dvec3 (&corners)[3]) {
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
    unsigned behind = 0;
    for (const glm::dvec3& p : corners) {
        const double z = glm::dot(p, image.forward);
        if (!(z > 0)) {
            ++behind;
            continue;
        }
        const glm::dvec2 place(glm::dot(p, image.right) / glm::dot(image.right, image.right) / z,
                               -glm::dot(p, image.up) / glm::dot(image.up, image.up) / z);
        const glm::dvec2 pixel = (0.5 * place + 0.5) * glm::dvec2(image.width, image.height) - 0.5;
        low = glm::min(low, pixel), high = glm::max(high, pixel);
    }
    if (behind == 3) return {0, 0, 0, 0};
    if (behind > 0) return {0, 0, image.width, image.height};
    const auto limited = [](double value, unsigned most) { return unsigned(std::clamp(value, 0.0, double(most))); };
    return {limited(std::floor(low.x), image.width), limited(std::floor(low.y), image.height),
            limited(std::floor(high.x) + 2, image.width), limited(std::floor(high.y) + 2, image.height)};
}

/// The triangle at the pixels that it covers, by the signs of the volumes that its edges span with the ray (Olano and
/// Greer 1997, "Triangle scan conversion using 2D homogeneous coordinates"), on both sides. Only in the rows from
/// rows.x to before rows.y.
void rasterise(const PinholeImage& image, std::span<const Ray> rays, const glm::dvec3 (&corners)[3],
               std::uint32_t triangle, glm::uvec2 rows, std::vector<DepthFragment>& fragments) {
    const auto& [a, b, c] = corners;
    const glm::dvec3 edges[3] = {glm::cross(a, b), glm::cross(b, c), glm::cross(c, a)};
    const double volume = glm::dot(a, edges[1]);
    if (!std::isfinite(volume)) return;
    const PixelBox box = pixels_of_triangle(image, corners);
    for (unsigned y = std::max(box.y0, rows.x); y < std::min(box.y1, rows.y); ++y)
        for (unsigned x = box.x0; x < box.x1; ++x) {
            const std::uint32_t pixel = y * image.width + x;
            const glm::dvec3 ray(rays[pixel].dx, rays[pixel].dy, rays[pixel].dz);
            const double s = glm::dot(ray, edges[0]), t = glm::dot(ray, edges[1]), u = glm::dot(ray, edges[2]);
            if (!((s >= 0 && t >= 0 && u >= 0) || (s <= 0 && t <= 0 && u <= 0))) continue;
            const double distance = volume / (s + t + u);
            if (distance > 0 && std::isfinite(distance))
                fragments.push_back({pixel, triangle, distance * glm::dot(ray, image.forward)});
        }
}

/// What a format makes of an image.
struct DepthVerdict {
    std::size_t seen = 0, clipped = 0;  ///< pixels with a surface; those whose nearest is before the near plane
    std::size_t tied = 0, wrong = 0;    ///< pixels in which another surface may, or does, win
    double hidden = 0;                  ///< largest distance of such a surface behind the nearest, over the latter's
    std::vector<float> map;
};

/// The fragments of one pixel, in the order in which they are drawn.
void judge_pixel(const DepthFormat& format, std::span<const DepthFragment> fragments, double near, double far,
                 DepthVerdict& verdict) {
    double nearest = std::numeric_limits<double>::infinity();
    bool clips = false;
    for (const DepthFragment& f : fragments) {
        clips |= f.z < near;
        if (f.z >= near) nearest = std::min(nearest, f.z);
    }
    verdict.clipped += clips;
    if (std::isinf(nearest)) return;
    ++verdict.seen;
    const double stored = stored_depth(format, nearest, near, far);
    bool is_drawn = false, tied = false, wrong = false;
    for (const DepthFragment& f : fragments) {
        if (f.z < near || stored_depth(format, f.z, near, far) != stored) continue;
        const bool behind = is_behind(f.z, nearest);
        tied |= behind, wrong |= behind && !is_drawn, is_drawn = true;
        verdict.hidden = std::max(verdict.hidden, f.z / nearest - 1);
    }
    verdict.tied += tied, verdict.wrong += wrong;
    verdict.map[fragments[0].pixel] = wrong ? 1.f : tied ? 0.5f : 0.f;
}

DepthVerdict judge_format(const DepthFormat& format, std::span<const DepthFragment> fragments, double near, double far,
                          std::size_t pixels) {
    DepthVerdict verdict;
    verdict.map.resize(pixels);
    for (std::size_t i = 0, end; i < fragments.size(); i = end) {
        for (end = i; end < fragments.size() && fragments[end].pixel == fragments[i].pixel;) ++end;
        judge_pixel(format, fragments.subspan(i, end - i), near, far, verdict);
    }
    return verdict;
}

/// The fragments' nearest surfaces against claray's closest hits.
std::string compare_with_hits(const Device& device, std::span<const Mesh> meshes, std::span<const Ray> rays,
                              const glm::dvec3& forward, std::span<const DepthFragment> fragments) {
    std::vector<double> nearest(rays.size(), std::numeric_limits<double>::infinity());
    for (const DepthFragment& f : fragments) nearest[f.pixel] = std::min(nearest[f.pixel], f.z);
    const std::vector<Hit> hits = closest_hit(Bvh::build(device, meshes), rays);
    std::size_t same = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const double z = double(hits[i].t) * glm::dot(glm::dvec3(rays[i].dx, rays[i].dy, rays[i].dz), forward);
        same += hits[i].primitive == CLARAY_MISS ? std::isinf(nearest[i]) : std::abs(z / nearest[i] - 1) < 1e-6;
    }
    return printed("the nearest fragment is claray's closest hit in %zu of %zu pixels", same, rays.size());
}

constexpr double far_over_near[] = {1e2, 1e3, 1e4, 1e5};

StudyPoint point_of_format(const DepthFormat& format, double ratio, const DepthVerdict& verdict) {
    const auto percent = [&](std::size_t count) {
        return 100 * double(count) / double(std::max<std::size_t>(verdict.seen, 1));
    };
    const double bits = format.bits, tied = percent(verdict.tied);
    StudyPoint point;
    point.method = format.name, point.setting = printed("far/near %g", ratio), point.value = ratio, point.runs = 1;
    point.error = {tied, tied, tied}, point.seconds = {bits, bits, bits};
    point.facts = {{"wrong as drawn, %", percent(verdict.wrong)},
                   {"farthest mistaken, % behind", 100 * verdict.hidden},
                   {"clipped, %", percent(verdict.clipped)}};
    if (verdict.seen == 0) point.failure = "no surface behind the near plane";
    return point;
}

}  // namespace

std::vector<DepthFragment> rasterised(const Camera& camera, std::span<const Mesh> meshes, std::span<const Ray> rays,
                                      unsigned width, unsigned height) {
    const PinholeImage image(camera_data(camera, float(width) / float(height)), width, height);
    constexpr unsigned rows_of_band = 32;
    std::vector<std::vector<DepthFragment>> bands((height + rows_of_band - 1) / rows_of_band);
    in_parallel(bands.size(), [&](std::size_t band) {
        const unsigned first = unsigned(band) * rows_of_band;
        std::uint32_t triangle = 0;
        for (const Mesh& mesh : meshes)
            for (const glm::uvec3& t : mesh.triangles) {
                const glm::dvec3 corners[3] = {glm::dvec3(mesh.positions[t.x]) - image.eye,
                                               glm::dvec3(mesh.positions[t.y]) - image.eye,
                                               glm::dvec3(mesh.positions[t.z]) - image.eye};
                rasterise(image, rays, corners, triangle++, {first, first + rows_of_band}, bands[band]);
            }
        std::stable_sort(bands[band].begin(), bands[band].end(),
                         [](const DepthFragment& a, const DepthFragment& b) { return a.pixel < b.pixel; });
    });
    std::vector<DepthFragment> fragments;
    for (const std::vector<DepthFragment>& band : bands) fragments.insert(fragments.end(), band.begin(), band.end());
    return fragments;
}

Study study_depth(const Device& device, const Scene& scene, const StudyOptions& options,
                  const AccuracyProgress& progress, std::vector<ErrorMap>* maps) {
    Study study;
    study.name = "depth", study.title = "Depth buffers: the nearest surface that cannot be told from another";
    study.error = "pixels in which another surface ties with the nearest, %", study.cost = "bits per pixel";
    const unsigned width = options.config.width, height = options.config.height;
    const Camera camera = camera_of(scene, float(width) / float(height));
    if (camera.projection != Projection::perspective) {
        study.findings.emplace_back("only a perspective view has depths in unequal steps: there is nothing to compare");
        return study;
    }
    const std::vector<Mesh> meshes = measure::world_meshes(scene);
    const std::vector<Ray> rays = measure::primary_rays(camera, width, height, false);
    const std::vector<DepthFragment> fragments = rasterised(camera, meshes, rays, width, height);
    if (fragments.empty()) {
        study.findings.emplace_back("the camera sees no surface");
        return study;
    }
    const CameraData c = camera_data(camera, float(width) / float(height));
    study.findings.push_back(
        compare_with_hits(device, meshes, rays, {c.forward_x, c.forward_y, c.forward_z}, fragments));
    double far = 0;
    for (const DepthFragment& f : fragments) far = std::max(far, f.z);
    std::vector<DepthVerdict> verdicts(std::size(depth_formats) * std::size(far_over_near));
    in_parallel(verdicts.size(), [&](std::size_t i) {
        const double ratio = far_over_near[i % std::size(far_over_near)];
        verdicts[i] =
            judge_format(depth_formats[i / std::size(far_over_near)], fragments, far / ratio, far, rays.size());
    });
    for (const DepthFormat& format : depth_formats)
        for (const double ratio : far_over_near) {
            const DepthVerdict& verdict = verdicts[study.points.size()];
            study.points.push_back(point_of_format(format, ratio, verdict));
            std::string name = printed("depth-%s-%.0e", format.name, ratio);
            std::replace(name.begin(), name.end(), ' ', '-');
            if (maps) maps->push_back({name, verdict.map});
            if (progress) progress(double(study.points.size()) / double(verdicts.size()), name);
        }
    mark_front(study.points);
    return study;
}

}  // namespace claray
