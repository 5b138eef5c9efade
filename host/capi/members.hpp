// Structs and enumerations of claray.h and those of C++: which members belong together, and copies in both directions.
#pragma once

#include <claray.h>

#include <filesystem>
#include <iterator>
#include <type_traits>

#include "claray/image/picture.hpp"
#include "claray/io.hpp"
#include "claray/renderer.hpp"
#include "claray/sensors.hpp"
#include "host/capi/capi.hpp"
#include "host/scene/members.hpp"

namespace claray::capi {

/// The values of C++ in the order of C's numbers.
template <class Enum>
struct Enumerators;
#define CLARAY_ENUM(name, ...)                      \
    template <>                                     \
    struct Enumerators<name> {                      \
        static constexpr const char* type = #name;  \
        static constexpr auto values = __VA_ARGS__; \
    };
#define CLARAY_ROW(name, NAME, note, codes, splits) , Builder::name
CLARAY_ENUM(claray_builder, std::array{Builder::automatic CLARAY_BUILDERS(CLARAY_ROW)})
#undef CLARAY_ROW
CLARAY_ENUM(claray_device_type, std::array{DeviceType::cpu, DeviceType::gpu, DeviceType::other})
CLARAY_ENUM(claray_layout, std::array{Layout::automatic, Layout::binary, Layout::wide})
CLARAY_ENUM(claray_coherence, std::array{Coherence::automatic, Coherence::coherent, Coherence::incoherent})
CLARAY_ENUM(claray_sampler, std::array{Sampler::sobol, Sampler::independent})
CLARAY_ENUM(claray_denoiser, std::array{DenoiserKind::automatic, DenoiserKind::claray, DenoiserKind::oidn})
CLARAY_ENUM(claray_tone_map, std::array{ToneMap::aces, ToneMap::none})
CLARAY_ENUM(claray_culling, std::array{Culling::by_file, Culling::back, Culling::none})
CLARAY_ENUM(claray_texel_format, std::array{TexelFormat::srgb8, TexelFormat::linear8, TexelFormat::float32})
CLARAY_ENUM(claray_wrap, std::array{Wrap::repeat, Wrap::mirror, Wrap::clamp})
CLARAY_ENUM(claray_texture_filter,
            std::array{Filter::trilinear, Filter::nearest, Filter::bilinear, Filter::nearest_level})
CLARAY_ENUM(claray_alpha_mode, std::array{AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend})
CLARAY_ENUM(claray_material_role,
            std::array{MaterialRole::surface, MaterialRole::holdout, MaterialRole::shadow_catcher})
CLARAY_ENUM(claray_stereo, std::array{Stereo::none, Stereo::side_by_side, Stereo::top_bottom})
CLARAY_ENUM(claray_alpha_test, std::array{AlphaTest::greater_equal, AlphaTest::greater, AlphaTest::less,
                                          AlphaTest::less_equal, AlphaTest::equal, AlphaTest::not_equal})
CLARAY_ENUM(claray_matte, std::array{MatteKind::object, MatteKind::material, MatteKind::asset})
CLARAY_ENUM(claray_normal_packing, std::array{NormalPacking::octahedral, NormalPacking::spherical})
CLARAY_ENUM(claray_lens_kind, std::array{LensKind::pinhole, LensKind::equidistant})
CLARAY_ENUM(claray_return_order, std::array{ReturnOrder::strongest, ReturnOrder::first, ReturnOrder::last})
CLARAY_ENUM(claray_kernel_start, std::array{KernelStart::own, KernelStart::generic, KernelStart::quick})
#undef CLARAY_ENUM

/// Throws ErrorKind::usage for a number that the enumeration does not have.
template <class Enum>
auto enumerator(const Enum& given, const std::string& name) {
    const int number = number_of(given);
    if (number < 0 || std::size_t(number) >= std::size(Enumerators<Enum>::values))
        refuse(name + " is " + std::to_string(number), std::string("use a ") + Enumerators<Enum>::type);
    return Enumerators<Enum>::values[std::size_t(number)];
}
template <class Enum, class Value>
Enum number_for(Value value) {
    const auto& values = Enumerators<Enum>::values;
    return Enum(std::find(std::begin(values), std::end(values), value) - std::begin(values));
}

// Kinds that have names in a list of rows.
inline std::span<const MaterialKindRow> rows_of(MaterialKind) { return material_kinds; }
inline std::span<const LightTraits> rows_of(LightKind) { return light_kinds; }
inline std::span<const ProjectionTraits> rows_of(Projection) { return projections; }
inline std::span<const PrimitiveKindName> rows_of(PrimitiveSet::Kind) { return primitive_kind_names; }

template <class Kind>
const char* name_of_kind(Kind kind) {
    for (const auto& row : rows_of(kind))
        if (row.kind == kind) return row.name;
    return "custom";
}
template <class Kind>
Kind kind_named(const std::string& given, const std::string& name) {
    std::string names;
    for (const auto& row : rows_of(Kind())) {
        if (given == row.name) return row.kind;
        names += std::string(names.empty() ? "" : ", ") + row.name;
    }
    if constexpr (std::is_same_v<Kind, MaterialKind>)
        if (given == "custom") return MaterialKind::custom;
    refuse(name + " is '" + given + "'", "use one of " + names);
}

struct Put;

/// From C++ to C. Texts stay where they are.
template <class C, class Cpp>
void put(C& to, const Cpp& from);
/// From C to C++. `name`: of the argument, for errors.
template <class C, class Cpp>
void take(const C& from, Cpp& to, const std::string& name);

// Calls visit(name, member of C, member of C++) for all pairs.
#define CLARAY_PAIR(member) visit(#member, c.member, cpp.member)

template <class C, IsOf<TextureUse> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(texture), CLARAY_PAIR(uv_set), CLARAY_PAIR(offset), CLARAY_PAIR(scale), CLARAY_PAIR(rotation);
}

template <class C, IsOf<Material> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(name), CLARAY_PAIR(kind), CLARAY_PAIR(albedo), CLARAY_PAIR(emission), CLARAY_PAIR(roughness),
        CLARAY_PAIR(ior), CLARAY_PAIR(metallic), CLARAY_PAIR(transmission), CLARAY_PAIR(thin_walled),
        CLARAY_PAIR(clearcoat), CLARAY_PAIR(clearcoat_roughness), CLARAY_PAIR(specular), CLARAY_PAIR(specular_weight),
        CLARAY_PAIR(specular_tint), CLARAY_PAIR(sheen), CLARAY_PAIR(sheen_roughness), CLARAY_PAIR(anisotropy),
        CLARAY_PAIR(anisotropy_rotation), CLARAY_PAIR(iridescence), CLARAY_PAIR(iridescence_ior),
        CLARAY_PAIR(film_thickness), CLARAY_PAIR(attenuation), CLARAY_PAIR(attenuation_distance), CLARAY_PAIR(opacity),
        CLARAY_PAIR(alpha_mode), CLARAY_PAIR(alpha_cutoff), CLARAY_PAIR(alpha_test), CLARAY_PAIR(cull_back),
        CLARAY_PAIR(role), CLARAY_PAIR(albedo_map), CLARAY_PAIR(emission_map), CLARAY_PAIR(metallic_roughness_map),
        CLARAY_PAIR(transmission_map), CLARAY_PAIR(clearcoat_map), CLARAY_PAIR(clearcoat_roughness_map),
        CLARAY_PAIR(clearcoat_normal_map), CLARAY_PAIR(clearcoat_normal_scale), CLARAY_PAIR(specular_map),
        CLARAY_PAIR(specular_weight_map), CLARAY_PAIR(shininess_map), CLARAY_PAIR(sheen_map),
        CLARAY_PAIR(sheen_roughness_map), CLARAY_PAIR(anisotropy_map), CLARAY_PAIR(iridescence_map),
        CLARAY_PAIR(film_thickness_map), CLARAY_PAIR(opacity_map), CLARAY_PAIR(normal_map), CLARAY_PAIR(normal_scale),
        CLARAY_PAIR(height_map), CLARAY_PAIR(height_scale), CLARAY_PAIR(light_map), CLARAY_PAIR(custom);
#define CLARAY_ROW(name, text, standard, check) CLARAY_PAIR(name);
    CLARAY_BSDF_PARAMETERS(CLARAY_ROW)
#undef CLARAY_ROW
}

template <class C, IsOf<Light> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(name), CLARAY_PAIR(kind), CLARAY_PAIR(position), CLARAY_PAIR(direction), CLARAY_PAIR(intensity),
        CLARAY_PAIR(inner_angle), CLARAY_PAIR(outer_angle), CLARAY_PAIR(range), CLARAY_PAIR(attenuation),
        CLARAY_PAIR(linear_range);
}

template <class C, IsOf<Sky> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
#define CLARAY_ROW(name, text) CLARAY_PAIR(name);
    CLARAY_SKY(CLARAY_ROW, CLARAY_ROW)
#undef CLARAY_ROW
}

template <class C, IsOf<Camera> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(projection), CLARAY_PAIR(position), CLARAY_PAIR(target), CLARAY_PAIR(up), CLARAY_PAIR(vertical_fov),
        CLARAY_PAIR(aperture_radius), CLARAY_PAIR(focus_distance), CLARAY_PAIR(orthographic_height), CLARAY_PAIR(shift),
        CLARAY_PAIR(tilt), CLARAY_PAIR(stereo), CLARAY_PAIR(eye_distance);
}

template <class C, IsOf<Texture> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(name), CLARAY_PAIR(width), CLARAY_PAIR(height), CLARAY_PAIR(channels), CLARAY_PAIR(format),
        CLARAY_PAIR(wrap_u), CLARAY_PAIR(wrap_v), CLARAY_PAIR(filter);
}

template <class C, IsOf<LoadOptions> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(animation), CLARAY_PAIR(variant), CLARAY_PAIR(camera), CLARAY_PAIR(scene), CLARAY_PAIR(live);
}

template <class C, IsOf<LightGridConfig> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(voxels), CLARAY_PAIR(side), CLARAY_PAIR(coefficients), CLARAY_PAIR(levels), CLARAY_PAIR(gather),
        CLARAY_PAIR(rays), CLARAY_PAIR(updates);
}

template <class C, IsOf<RenderConfig> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(width), CLARAY_PAIR(height), CLARAY_PAIR(spp), CLARAY_PAIR(max_depth), CLARAY_PAIR(seed),
        CLARAY_PAIR(seconds), CLARAY_PAIR(noise), CLARAY_PAIR(error), CLARAY_PAIR(sample_clamp), CLARAY_PAIR(adaptive),
        CLARAY_PAIR(sampler), CLARAY_PAIR(report_seconds), CLARAY_PAIR(parts), CLARAY_PAIR(compiler),
        CLARAY_PAIR(checkpoint), CLARAY_PAIR(checkpoint_seconds), CLARAY_PAIR(resume), CLARAY_PAIR(alpha),
        CLARAY_PAIR(lobes);
}

template <class C, IsOf<LightMapConfig> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(width), CLARAY_PAIR(height), CLARAY_PAIR(spp), CLARAY_PAIR(max_depth), CLARAY_PAIR(seed),
        CLARAY_PAIR(sampler);
}

template <class C, IsOf<RenderProgress> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(spp), CLARAY_PAIR(seconds), CLARAY_PAIR(noise), CLARAY_PAIR(error), CLARAY_PAIR(error_bound),
        CLARAY_PAIR(error_of_fireflies), CLARAY_PAIR(cut_off), CLARAY_PAIR(spp_target), CLARAY_PAIR(error_spp),
        CLARAY_PAIR(own_kernels), CLARAY_PAIR(waits_for_kernels), CLARAY_PAIR(culled), CLARAY_PAIR(dropped_samples);
}

template <class C, IsOf<RayCount> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(rays), CLARAY_PAIR(milliseconds);
}

template <class C, IsOf<RenderStatistics> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(first_pixel_seconds), CLARAY_PAIR(first_pixel_processor_seconds), CLARAY_PAIR(start),
        CLARAY_PAIR(own_kernels_from), CLARAY_PAIR(own_kernels), CLARAY_PAIR(primitives),
        CLARAY_PAIR(build_milliseconds), CLARAY_PAIR(camera), CLARAY_PAIR(bounce), CLARAY_PAIR(shadow),
        CLARAY_PAIR(in_paths), CLARAY_PAIR(device_bytes), CLARAY_PAIR(most_device_bytes), CLARAY_PAIR(bytes_paged),
        CLARAY_PAIR(parts), CLARAY_PAIR(adapted), CLARAY_PAIR(guided), CLARAY_PAIR(longest_milliseconds),
        CLARAY_PAIR(longest_command), CLARAY_PAIR(dropped_samples), CLARAY_PAIR(measuring_seconds);
}

template <class C, IsOf<BvhStatistics> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(triangles), CLARAY_PAIR(culled), CLARAY_PAIR(references), CLARAY_PAIR(height), CLARAY_PAIR(sah_cost),
        CLARAY_PAIR(bytes);
}

template <class C, IsOf<BvhValidation> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(leaves_missing), CLARAY_PAIR(leaves_repeated), CLARAY_PAIR(boxes_not_containing),
        CLARAY_PAIR(links_broken);
}

template <class C, IsOf<InstanceStatistics> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(instances), CLARAY_PAIR(culled), CLARAY_PAIR(height), CLARAY_PAIR(widening), CLARAY_PAIR(sah_cost),
        CLARAY_PAIR(top_bytes), CLARAY_PAIR(bottom_bytes);
}

template <class C, IsOf<Lens> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(kind), CLARAY_PAIR(fx), CLARAY_PAIR(fy), CLARAY_PAIR(cx), CLARAY_PAIR(cy), CLARAY_PAIR(distortion);
}

template <class C, IsOf<SensorConfig> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(rays), CLARAY_PAIR(returns), CLARAY_PAIR(order), CLARAY_PAIR(divergence), CLARAY_PAIR(nearest),
        CLARAY_PAIR(farthest), CLARAY_PAIR(range_resolution), CLARAY_PAIR(velocity_resolution),
        CLARAY_PAIR(range_noise), CLARAY_PAIR(velocity_noise), CLARAY_PAIR(intensity_noise), CLARAY_PAIR(dropout),
        CLARAY_PAIR(reference_range), CLARAY_PAIR(extinction), CLARAY_PAIR(least_intensity), CLARAY_PAIR(duration),
        CLARAY_PAIR(in_world), CLARAY_PAIR(seed);
}

template <class C, IsOf<DeviceInfo> Cpp, class Visit>
void visit_pairs(C&& c, Cpp& cpp, const Visit& visit) {
    CLARAY_PAIR(index), CLARAY_PAIR(platform), CLARAY_PAIR(name), CLARAY_PAIR(vendor), CLARAY_PAIR(driver),
        CLARAY_PAIR(version), CLARAY_PAIR(type), CLARAY_PAIR(compute_units), CLARAY_PAIR(memory),
        CLARAY_PAIR(max_allocation), CLARAY_PAIR(local_memory), CLARAY_PAIR(max_work_group), CLARAY_PAIR(fp64),
        CLARAY_PAIR(exact_divide);
}
#undef CLARAY_PAIR

/// Visitors of pairs.
struct Put {
    template <class C, class Cpp>
    void operator()(const char*, C& to, const Cpp& from) const {
        put(to, from);
    }
};
struct Take {
    const char* of;
    template <class C, class Cpp>
    void operator()(const char* member, const C& from, Cpp& to) const {
        take(from, to, std::string(of) + "." + member);
    }
};
/// Leaves members of C++ as they are where those of C are 0.
struct TakeGiven {
    const char* of;
    template <class C, class Cpp>
    void operator()(const char* member, const C& from, Cpp& to) const {
        static const C zero{};
        if (std::memcmp(&from, &zero, sizeof zero) != 0) take(from, to, std::string(of) + "." + member);
    }
};

template <class C, class Cpp>
void put(C& to, const Cpp& from) {
    if constexpr (std::is_enum_v<C>)
        to = number_for<C>(from);
    else if constexpr (std::is_arithmetic_v<C>)
        to = C(from);
    else if constexpr (std::is_same_v<C, const char*> && std::is_enum_v<Cpp>)
        to = name_of_kind(from);
    else if constexpr (std::is_same_v<C, const char*>)
        to = from.c_str();
    else if constexpr (std::is_array_v<C>)
        for (std::size_t i = 0; i < std::size(to); ++i) to[i] = from[int(i)];
    else
        visit_pairs(to, from, Put());
}

template <class C, class Cpp>
void take(const C& from, Cpp& to, const std::string& name) {
    if constexpr (std::is_enum_v<C>)
        to = enumerator(from, name);
    else if constexpr (std::is_arithmetic_v<C>)
        to = Cpp(from);
    else if constexpr (std::is_same_v<C, const char*> && std::is_enum_v<Cpp>)
        to = from ? kind_named<Cpp>(from, name) : to;
    else if constexpr (std::is_same_v<C, const char*>)
        to = from ? from : "";
    else if constexpr (std::is_array_v<C>)
        for (std::size_t i = 0; i < std::size(from); ++i) to[int(i)] = from[i];
    else
        visit_pairs(from, to, Take{name.c_str()});
}

/// A struct of C with the members of `from`.
template <class C, class Cpp>
C put_into(const Cpp& from) {
    C to{};
    visit_pairs(to, from, Put());
    return to;
}

/// 3 rows of 4 floats.
template <class Matrix>
void put_rows(float (&rows)[12], const Matrix& matrix) {
    for (int i = 0; i < 12; ++i) rows[i] = matrix[i % 4][i / 4];
}
template <class Matrix = glm::mat4, class Number>
Matrix matrix_of(const Number* rows) {
    Matrix matrix(1);
    for (int i = 0; i < 12; ++i) matrix[i % 4][i / 4] = rows[i];
    return matrix;
}

}  // namespace claray::capi
