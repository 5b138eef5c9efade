#include "host/verify/run.hpp"

#include "host/verify/kernels_run.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/format.hpp"
#include "host/compute/memory.hpp"
#include "host/measure/measure.hpp"

namespace claray::verify {

void with_guards(const Device& device, const std::function<void()>& task) {
    const GuardedMemory memory(device);
    task();
    device.finish();
    if (memory.overruns() != 0)
        throw Error(ErrorKind::device,
                    "kernels wrote beyond the ends of " + std::to_string(memory.overruns()) + " buffers");
}

void Run::side_by_side(std::size_t count, const std::function<void(const Device&, std::size_t)>& piece) const {
    claray::side_by_side(device_, more_, options_.threads, count, [&](const Device& on, std::size_t i) {
        const KernelsRun kernels(on, options_.kernels, result_.kernels);
        with_guards(on, [&] { piece(on, i); });
    });
}

void Run::check(const std::string& what, std::uint64_t tried, double worst, double bar, const std::string& unit,
                bool known) {
    result_.checks.push_back({what, tried, worst, bar, unit, false, known});
}
void Run::check_time(const std::string& what, std::uint64_t tried, const std::function<void()>& task,
                     const std::function<void()>& other, double bar) {
    const auto timings = measure::measure_rounds(device_, 21, {task, other});
    const double ratio = timings[0].milliseconds() / timings[1].milliseconds();
    result_.checks.push_back({what, tried, ratio, bar, "times as long", true});
}
void Run::fact(const std::string& name, const std::string& value) { result_.facts.emplace_back(name, value); }
void Run::failure(const std::string& what) { result_.failures.push_back(what); }
void Run::picture(VerifyPicture picture) { result_.pictures.push_back(std::move(picture)); }

std::vector<Form> build_forms(const Device& device) {
    std::vector<Form> forms = {{"", {}}};
    if (device.info().type != DeviceType::gpu)
        forms.push_back({", as on GPUs",
                         {{"bvh/serial", "RANGES_PER_UNIT", 0},
                          {"bvh/sbvh", "LARGE_GROUP", 256},
                          {"bvh/sbvh", "MEDIUM_GROUP", 128},
                          {"sort/radix_sort", "ONESWEEP", 1}}});
    return forms;
}

std::string text_of(const Ray& r) {
    return printed("origin %a %a %a direction %a %a %a tmin %a tmax %a", double(r.ox), double(r.oy), double(r.oz),
                   double(r.dx), double(r.dy), double(r.dz), double(r.tmin), double(r.tmax));
}

VerifyPicture picture_along(const Ray& ray, const Mesh& mesh, std::uint32_t wrong, const std::string& title) {
    const glm::dvec3 origin(ray.ox, ray.oy, ray.oz), d = glm::normalize(glm::dvec3(ray.dx, ray.dy, ray.dz));
    const glm::dvec3 side =
        glm::normalize(glm::cross(d, std::abs(d.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const glm::dvec3 up = glm::cross(side, d);
    struct Seen {
        double distance, size;
        std::uint32_t triangle;
        glm::dvec2 corners[3];
    };
    std::vector<Seen> all;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        Seen seen{1e300, 0, i, {}};
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 p = glm::dvec3(mesh.positions[mesh.triangles[i][k]]) - origin;
            seen.corners[k] = {glm::dot(p, side), glm::dot(p, up)};
            seen.distance = std::min(seen.distance, glm::length(seen.corners[k]));
        }
        for (int k = 0; k < 3; ++k)
            seen.size = std::max(seen.size, glm::length(seen.corners[k] - seen.corners[(k + 1) % 3]));
        if (std::isfinite(seen.size) && std::isfinite(seen.distance)) all.push_back(seen);
    }
    const std::size_t shown = std::min<std::size_t>(all.size(), 48);
    std::partial_sort(all.begin(), all.begin() + std::ptrdiff_t(shown), all.end(),
                      [](const Seen& a, const Seen& b) { return a.distance < b.distance; });
    double scale = 0;
    for (std::size_t i = 0; i < std::min<std::size_t>(shown, 6); ++i) scale = std::max(scale, all[i].size);
    VerifyPicture picture{title, {}};
    for (std::size_t i = shown; i-- > 0;) {
        VerifyPicture::Shape shape{{}, all[i].triangle == wrong, all[i].triangle == wrong ? 0xf2b8a0u : 0x8090a0u};
        for (const glm::dvec2& c : all[i].corners)
            for (const double x : {c.x, c.y}) shape.points.push_back(float(0.5 + 0.4 * x / std::max(scale, 1e-300)));
        picture.shapes.push_back(std::move(shape));
    }
    picture.shapes.push_back({{0.5f, 0.5f}, true, 0xc00000u});
    return picture;
}

VerifyPicture picture_of_curves(std::vector<Curve> curves, const std::string& title) {
    double lo[2] = {1e300, 1e300}, hi[2] = {-1e300, -1e300};
    for (const Curve& c : curves)
        for (std::size_t i = 0; i < c.x.size(); ++i) {
            if (!std::isfinite(c.y[i])) continue;
            lo[0] = std::min(lo[0], c.x[i]), hi[0] = std::max(hi[0], c.x[i]);
            lo[1] = std::min(lo[1], c.y[i]), hi[1] = std::max(hi[1], c.y[i]);
        }
    VerifyPicture picture{title, {}};
    for (const Curve& c : curves) {
        VerifyPicture::Shape shape{{}, false, c.color};
        for (std::size_t i = 0; i < c.x.size(); ++i) {
            if (!std::isfinite(c.y[i])) continue;
            shape.points.push_back(float(0.05 + 0.9 * (c.x[i] - lo[0]) / std::max(hi[0] - lo[0], 1e-300)));
            shape.points.push_back(float(0.05 + 0.9 * (c.y[i] - lo[1]) / std::max(hi[1] - lo[1], 1e-300)));
        }
        picture.shapes.push_back(std::move(shape));
    }
    return picture;
}

}  // namespace claray::verify
