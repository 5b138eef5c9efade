#include "host/io/world/looks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/base/format.hpp"
#include "host/io/world/rough.hpp"

namespace claray {
namespace {

float share(float x) { return std::isfinite(x) ? std::clamp(x, 0.f, 1.f) : 0.f; }
/// claray's GGX has alpha = roughness^2.
float roughness_of_alpha(float alpha) { return std::sqrt(share(alpha)); }
glm::vec3 roughness_of_alphas(const glm::vec3& alpha) {
    return {roughness_of_alpha(alpha.x), roughness_of_alpha(alpha.y), roughness_of_alpha(alpha.z)};
}
float sound_ior(float ior) { return std::isfinite(ior) ? std::clamp(ior, 0.1f, 10.f) : 1.5f; }

/// The index of a single border that reflects as much of diffuse light as a pane with R' = 2 R / (1 + R).
float pane_ior(float ior) {
    constexpr int steps = 200;
    const auto reflected = [](double n, bool pane) {
        double sum = 0;
        for (int i = 0; i < steps; ++i) {
            const double cosine = (i + 0.5) / steps, r = conductor_reflectance(n, 0, cosine);
            sum += 2 * cosine * (pane ? 2 * r / (1 + r) : r) / steps;
        }
        return sum;
    };
    const double wanted = reflected(ior, true);
    double low = 1, high = 10;
    for (int i = 0; i < 40; ++i) {
        const double middle = (low + high) / 2;
        (reflected(middle, false) < wanted ? low : high) = middle;
    }
    return float(low);
}

constexpr double least_rough = 1e-3;  // alpha of facets that lose some light

Facets mean_facets(Paints& paints, const Alphas& alphas) {
    return {std::sqrt(double(share(paints.mean(alphas.u).x)) * double(share(paints.mean(alphas.v).x))),
            alphas.beckmann};
}

/// The same surface as parameters of a principled material.
Material as_principled(const Material& material) {
    Material m = material;
    if (m.kind == MaterialKind::principled) return m;
    const MaterialKind kind = m.kind;
    m.kind = MaterialKind::principled;
    if (kind == MaterialKind::lambert) m.specular_weight = 0.f, m.roughness = 1.f;
    if (kind == MaterialKind::metal || kind == MaterialKind::mirror) m.metallic = 1.f;
    if (kind == MaterialKind::mirror) m.roughness = 0.f;
    if (kind == MaterialKind::glass) m.transmission = 1.f;
    return m;
}

Paint paint_of_albedo(const Material& m) {
    Paint paint(m.albedo);
    paint.use = m.albedo_map;
    return paint;
}

}  // namespace

void set_albedo(Material& material, Paints& paints, const Paint& paint) {
    const Paint sound = paints.albedo(paint);
    material.albedo = sound.factor;
    material.albedo_map = sound.use;
}

void set_roughness(Material& material, Paints& paints, const Alphas& of_file) {
    Alphas alphas = of_file;
    if (alphas.beckmann) alphas.u.factor *= ggx_of_beckmann, alphas.v.factor *= ggx_of_beckmann;
    if (alphas.u.varies()) {
        const Paint roughness = paints.changed(alphas.u, "sqrt", roughness_of_alphas);
        material.metallic_roughness_map = paints.roughness_map(roughness);
        material.roughness = 1.f;
        material.kind = MaterialKind::principled;
        return;
    }
    const float u = share(alphas.u.factor.x), v = share(paints.mean(alphas.v).x);
    const float across = std::min(u, v), along = std::max(u, v);
    material.roughness = roughness_of_alpha(across);
    if (along - across < 1e-4f || across >= 1.f) return;
    if (material.kind == MaterialKind::metal) material.kind = MaterialKind::principled, material.metallic = 1.f;
    if (material.kind != MaterialKind::principled) {
        material.roughness = roughness_of_alpha(std::sqrt(along * across));
        return;
    }
    // KHR_materials_anisotropy: the wider alpha is mix(roughness^2, 1, anisotropy^2).
    material.anisotropy = std::sqrt((along - across) / (1.f - across));
    material.anisotropy_rotation = u >= v ? 0.f : std::numbers::pi_v<float> / 2;
}

Look grey_look() {
    Look look;
    look.material.albedo = glm::vec3(0.5f);
    return look;
}

Look diffuse_look(Paints& paints, const Paint& reflectance) {
    Look look;
    set_albedo(look.material, paints, reflectance);
    return look;
}

Look plastic_look(Paints& paints, const Paint& reflectance, float ior, const Alphas& alphas, bool tinted) {
    Look look;
    Material& m = look.material;
    m.kind = MaterialKind::principled;
    m.ior = sound_ior(ior);
    Paint base = paints.albedo(reflectance);
    const Facets facets = mean_facets(paints, alphas);
    if (tinted || facets.alpha >= least_rough) {
        const RoughBase below(m.ior, facets, tinted);
        base = paints.changed(
            base, printed("below %g %g %d %d", double(m.ior), facets.alpha, int(facets.beckmann), int(tinted)),
            [&](const glm::vec3& c) { return glm::vec3(below.albedo(c.x), below.albedo(c.y), below.albedo(c.z)); });
    }
    set_albedo(m, paints, base);
    set_roughness(m, paints, alphas);
    return look;
}

namespace {

/// A metal of claray reflects all light at grazing angles. The border of a dielectric on a black base does so times
/// a weight (KHR_materials_specular), and loses what facets scatter more than once.
Look tinted_metal(Paints& paints, const glm::vec3& color, const Alphas& alphas, const Paint& tint) {
    Look look;
    Material& m = look.material;
    m.kind = MaterialKind::principled;
    m.albedo = glm::vec3(0.f);
    glm::vec3 shade(1.f);
    if (tint.varies()) {
        m.specular_map = m.specular_weight_map = paints.strength_map(tint);
    } else {
        m.specular_weight = std::max({tint.factor.x, tint.factor.y, tint.factor.z});
        if (m.specular_weight > 0.f) shade = tint.factor / m.specular_weight;
    }
    if (const Facets facets = mean_facets(paints, alphas); facets.beckmann && facets.alpha >= least_rough) {
        const double kept = kept_by_facets(facets) / kept_by_facets(shown(facets));
        m.specular_weight = std::min(m.specular_weight * float(kept), 1.f);
    }
    const float root = (m.ior - 1) / (m.ior + 1);
    m.specular_tint = color * shade / (root * root);
    set_roughness(m, paints, alphas);
    m.metallic = 0.f;
    return look;
}

}  // namespace

Look metal_look(Paints& paints, const Paint& color, const Alphas& alphas, const Paint& tint) {
    if (tint.varies() || tint.factor != glm::vec3(1.f))
        return tinted_metal(paints, paints.mean(color), alphas, paints.albedo(tint));
    Look look;
    look.material.kind = MaterialKind::metal;
    look.material.metallic = 1.f;
    const Facets facets = mean_facets(paints, alphas);
    const double kept = facets.alpha < least_rough ? 1 : kept_by_facets(facets);
    const auto darkened = [kept](const glm::vec3& c) {
        return glm::vec3(darkened_metal(c.x, kept), darkened_metal(c.y, kept), darkened_metal(c.z, kept));
    };
    const Paint sound = paints.albedo(color);
    set_albedo(look.material, paints, kept < 1 ? paints.changed(sound, printed("metal %g", kept), darkened) : sound);
    set_roughness(look.material, paints, alphas);
    return look;
}

/// Its metal loses light as rough metals do, and its diffuse lobe is not dimmed by what the border reflects.
Look burley_look(Paints& paints, const Paint& base, float metallic, float ior, const Alphas& alphas) {
    Look look;
    Material& m = look.material;
    m.kind = MaterialKind::principled;
    m.metallic = share(metallic), m.ior = sound_ior(ior);
    const Facets facets{std::max(mean_facets(paints, alphas).alpha, least_rough), alphas.beckmann};
    const double kept = kept_by_facets(facets),
                 brighter = burley_diffuse(std::sqrt(facets.alpha)) / (1 - rough_border(m.ior, facets).reflected);
    const auto albedo = [&](float c) {
        return glm::mix(std::min(c * float(brighter), 1.f), darkened_metal(c, kept), m.metallic);
    };
    const Paint sound = paints.albedo(base);
    set_albedo(m, paints,
               paints.changed(sound, printed("burley %g %g %g", double(m.metallic), kept, brighter),
                              [&](const glm::vec3& c) { return glm::vec3(albedo(c.x), albedo(c.y), albedo(c.z)); }));
    set_roughness(m, paints, alphas);
    return look;
}

Look glass_look(Paints& paints, float ior, const Alphas& alphas, const Paint& tint) {
    Look look;
    Material& m = look.material;
    m.kind = MaterialKind::glass;
    m.ior = sound_ior(ior);
    const Facets facets = mean_facets(paints, alphas);
    Paint passed = paints.albedo(tint);
    if (facets.alpha >= least_rough) {
        const RoughBorder border = rough_border(m.ior, facets);
        const double reflected = facets.beckmann ? rough_border(m.ior, shown(facets)).reflected : border.reflected;
        passed.factor *= float(border.passed / (1 - reflected));
    }
    set_albedo(m, paints, passed);
    set_roughness(m, paints, alphas);
    if (m.kind == MaterialKind::principled) m.transmission = 1.f, m.metallic_roughness_map = {};  // metal would hide it
    return look;
}

Look pane_look(Paints& paints, float ior, const Paint& tint) {
    const float sound = sound_ior(ior);
    Look look = glass_look(paints, pane_ior(std::max(sound, 1 / sound)), {}, tint);
    look.material.thin_walled = true;
    look.material.roughness = 0.f;
    return look;
}

void set_opacity(Look& look, Paints& paints, const Paint& opacity) {
    const Paint sound = paints.albedo(opacity);
    if (!sound.varies() && sound.factor.x >= 1.f) return;
    look.material.alpha_mode = AlphaMode::blend;
    look.material.opacity = sound.factor.x;
    look.material.opacity_map = sound.use;
    if (!sound.varies() && sound.factor.x <= 0.f) look.invisible = true;
}

Look mixed_look(Paints& paints, const Look& a, const Look& b, const Paint& amount) {
    if (!amount.varies() && amount.factor.x <= 0.f) return a;
    if (!amount.varies() && amount.factor.x >= 1.f) return b;
    if (a.invisible || b.invisible) {
        Look look = a.invisible ? b : a;
        const Paint rest = paints.mixed(Paint(1.f), Paint(0.f), amount);
        set_opacity(look, paints, a.invisible ? amount : rest);
        look.invisible = false;
        return look;
    }
    const float t = share(paints.mean(amount).x);
    Look look = t < 0.5f ? a : b;
    const Material from = as_principled(a.material), to = as_principled(b.material);
    Material& m = look.material;
    const bool both_diffuse = a.material.kind == MaterialKind::lambert && b.material.kind == MaterialKind::lambert;
    if (!both_diffuse) {
        const auto mix = [t](float x, float y) { return x + t * (y - x); };
        m = as_principled(m);
        m.metallic = mix(from.metallic, to.metallic), m.transmission = mix(from.transmission, to.transmission);
        m.specular_weight = mix(from.specular_weight, to.specular_weight);
        m.ior = mix(from.ior, to.ior);
        const bool only_one_shines = (from.specular_weight > 0.f) != (to.specular_weight > 0.f);
        if (only_one_shines)
            m.roughness = from.specular_weight > 0.f ? from.roughness : to.roughness;
        else
            m.roughness = mix(from.roughness, to.roughness);
    }
    set_albedo(m, paints, paints.mixed(paint_of_albedo(from), paint_of_albedo(to), amount));
    look.both_sides = a.both_sides || b.both_sides;
    return look;
}

}  // namespace claray
