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
        if (given.floats == 0) refuse("kind.floats is 0", "give the floats of a primitive");
        return {name, given.source, given.floats, given.capsules != 0};
    }
    if (name == "flat curves") return curve_kind(CurveShape::flat);
    for (const PrimitiveKind& kind : {sphere_kind(), disc_kind(), cylinder_kind(), curve_kind(CurveShape::round)})
        if (kind.name == name) return kind;
    refuse("kind.name is '" + name + "' without a source",
           "use spheres, discs, cylinders, curves or flat curves, or give a source");
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
    return claray_primitives_config_build(device, kind, nullptr, data, count, primitives);
}

claray_status claray_primitives_config_build(claray_device* device, const claray_primitive_kind* kind,
                                             const claray_bvh_config* config, const float* data, size_t count,
                                             claray_primitives** primitives) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const PrimitiveKind of = primitives_of(versioned(&required(kind, "kind"), "kind"));
        const std::span floats = array(data, of.floats * count, "data");
        hand_out(primitives, "primitives", [&] {
            return new claray_primitives{Primitives::build(on, of, Buffer<float>(on, floats), std::uint32_t(count),
                                                           config_of(config, {.builder = Builder::balanced}))};
        });
    });
}

claray_status claray_curve_data(const float* points, size_t point_count, const uint32_t* segments, size_t segment_count,
                                int bezier, float* data) {
    return guarded([&] {
        const std::span controls = array(reinterpret_cast<const glm::vec4*>(points), point_count, "points");
        const std::vector<float> floats = curve_data(controls, array(segments, segment_count, "segments"),
                                                     bezier != 0 ? CurveBasis::bezier : CurveBasis::bspline);
        if (!floats.empty()) std::copy(floats.begin(), floats.end(), &required(data, "data"));
    });
}

claray_status claray_primitives_move(claray_primitives* primitives, const float* data, size_t float_count,
                                     int rebuild) {
    return guarded([&] {
        Primitives& moved = required(primitives, "primitives").primitives;
        Buffer<float> floats = moved.data();
        if (data || float_count != 0) {
            if (float_count != floats.size())
                refuse("float_count is " + std::to_string(float_count) + ", and the data has " +
                       std::to_string(floats.size()) + " floats");
            floats.write(array(data, float_count, "data"));
        }
        rebuild != 0 ? moved.rebuild() : moved.refit();
    });
}

size_t claray_primitives_count(const claray_primitives* primitives) {
    return primitives ? primitives->primitives.count() : 0;
}
void* claray_primitives_buffer(const claray_primitives* primitives) {
    return primitives ? primitives->primitives.data().memory()() : nullptr;
}
claray_status claray_primitives_tree_create(const claray_primitives* primitives, claray_bvh** tree) {
    return guarded([&] {
        const Bvh& bvh = required(primitives, "primitives").primitives.bvh();
        hand_out(tree, "tree", [&] { return new claray_bvh{bvh}; });
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

claray_status claray_primitives_enqueue(const claray_primitives* primitives, claray_query_kind kind, void* rays,
                                        void* results, size_t count) {
    return guarded([&] {
        const Primitives& over = required(primitives, "primitives").primitives;
        const auto given = shared<Ray>(over.device(), rays, count, "rays");
        if (kind_of(kind) == QueryKind::any) {
            auto found = shared<std::uint8_t>(over.device(), results, count, "results");
            return any_hit(over, given, found);
        }
        auto found = shared<Hit>(over.device(), results, count, "results");
        closest_hit(over, given, found);
    });
}

void claray_primitives_release(claray_primitives* primitives) { delete primitives; }
