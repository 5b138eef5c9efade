// claray.h: primitives that are not triangles.
#include "claray/primitives/curves.hpp"
#include "host/capi/capi.hpp"

using namespace claray;
using namespace claray::capi;

struct claray_primitives {
    Primitives primitives;
};

namespace {

PrimitiveKind primitives_of(const claray_primitive_kind& given) {
    const std::string name = &required(given.name, "kind.name");
    if (given.source != nullptr) {
        if (given.floats == 0) throw Error(ErrorKind::usage, "kind.floats is 0", "give the floats of a primitive");
        return {name, given.source, given.floats};
    }
    for (const PrimitiveKind& kind : {sphere_kind(), disc_kind(), cylinder_kind()})
        if (kind.name == name) return kind;
    throw Error(ErrorKind::usage, "kind.name is '" + name + "' without a source",
                "use spheres, discs or cylinders, or give a source");
}

template <class Answer>
claray_status answer_rays(const claray_primitives* primitives, const claray_ray* rays, std::size_t count,
                          Answer* answers, const char* name,
                          void (*query)(const Primitives&, const Buffer<Ray>&, Buffer<Answer>&, const QueryOptions&)) {
    return guarded([&] {
        const Primitives& over = required(primitives, "primitives").primitives;
        if (count == 0) return;
        answer(over.device(), array(reinterpret_cast<const Ray*>(rays), count, "rays"), answers, count, name,
               [&](const Buffer<Ray>& given, Buffer<Answer>& found) { query(over, given, found, {}); });
    });
}

}  // namespace

claray_status claray_primitives_build(claray_device* device, const claray_primitive_kind* kind, const float* data,
                                      size_t count, claray_primitives** primitives) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const PrimitiveKind of = primitives_of(versioned(&required(kind, "kind"), "kind"));
        const std::span floats = array(data, of.floats * count, "data");
        hand_out(primitives, "primitives", [&] { return new claray_primitives{Primitives::build(on, of, floats)}; });
    });
}

claray_status claray_curves_build(claray_device* device, const float* points, size_t point_count,
                                  const uint32_t* segments, size_t segment_count, int bezier, int flat,
                                  claray_primitives** primitives) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const std::span controls = array(reinterpret_cast<const glm::vec4*>(points), point_count, "points");
        const std::span firsts = array(segments, segment_count, "segments");
        hand_out(primitives, "primitives", [&] {
            return new claray_primitives{build_curves(on, controls, firsts,
                                                      bezier != 0 ? CurveBasis::bezier : CurveBasis::bspline,
                                                      flat != 0 ? CurveShape::flat : CurveShape::round)};
        });
    });
}

claray_status claray_primitives_closest_hit(const claray_primitives* primitives, const claray_ray* rays, size_t count,
                                            claray_hit* hits) {
    return answer_rays<Hit>(primitives, rays, count, reinterpret_cast<Hit*>(hits), "hits", &closest_hit);
}

claray_status claray_primitives_any_hit(const claray_primitives* primitives, const claray_ray* rays, size_t count,
                                        uint8_t* occluded) {
    return answer_rays<std::uint8_t>(primitives, rays, count, occluded, "occluded", &any_hit);
}

void claray_primitives_release(claray_primitives* primitives) { delete primitives; }
