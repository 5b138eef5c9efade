// What of materials and lights can be changed: the command line of the view and the page are made from these lists.
#pragma once

#include "claray/scene.hpp"

namespace claray::view {

/// A colour or three coordinates of a `Thing`.
template <class Thing>
struct TripleRow {
    const char* name;
    glm::vec3 Thing::*member;
    bool color;  ///< not a place or a direction
    float most;  ///< of a slider; the command takes what `validate` takes
};
/// A number of a `Thing`.
template <class Thing>
struct NumberRow {
    const char* name;
    float Thing::*member;
    float least, most;  ///< of a slider; the command takes what `validate` takes
};

inline constexpr TripleRow<Material> material_triples[] = {
    {"albedo", &Material::albedo, true, 1},     {"emission", &Material::emission, true, 100},
    {"specular", &Material::specular, true, 1}, {"specular_tint", &Material::specular_tint, true, 1},
    {"sheen", &Material::sheen, true, 1},       {"attenuation", &Material::attenuation, true, 1}};
inline constexpr NumberRow<Material> material_numbers[] = {
    {"roughness", &Material::roughness, 0, 1},
    {"metallic", &Material::metallic, 0, 1},
    {"ior", &Material::ior, 1, 3},
    {"transmission", &Material::transmission, 0, 1},
    {"clearcoat", &Material::clearcoat, 0, 1},
    {"clearcoat_roughness", &Material::clearcoat_roughness, 0, 1},
    {"specular_weight", &Material::specular_weight, 0, 1},
    {"sheen_roughness", &Material::sheen_roughness, 0, 1},
    {"anisotropy", &Material::anisotropy, 0, 1},
    {"iridescence", &Material::iridescence, 0, 1},
    {"opacity", &Material::opacity, 0, 1},
    {"shininess", &Material::shininess, 1, 1000}};

inline constexpr TripleRow<Light> light_triples[] = {{"intensity", &Light::intensity, true, 1000},
                                                     {"position", &Light::position, false, 0},
                                                     {"direction", &Light::direction, false, 0}};
inline constexpr NumberRow<Light> light_numbers[] = {{"inner_angle", &Light::inner_angle, 0, 1.57f},
                                                     {"outer_angle", &Light::outer_angle, 0, 1.57f},
                                                     {"range", &Light::range, 0, 100}};

/// Sets the value of this name to the numbers, of which single ones take the first. Returns whether there is one.
template <class Thing, std::size_t triples, std::size_t numbers>
[[nodiscard]] bool set_value(Thing& thing, const TripleRow<Thing> (&of_three)[triples],
                             const NumberRow<Thing> (&of_one)[numbers], const std::string& name,
                             const glm::vec3& value) {
    for (const TripleRow<Thing>& row : of_three)
        if (name == row.name) return thing.*row.member = value, true;
    for (const NumberRow<Thing>& row : of_one)
        if (name == row.name) return thing.*row.member = value.x, true;
    return false;
}

/// The names, for a message: "a, b or c".
template <class Thing, std::size_t triples, std::size_t numbers>
[[nodiscard]] std::string names_of_values(const TripleRow<Thing> (&of_three)[triples],
                                          const NumberRow<Thing> (&of_one)[numbers]) {
    std::string text;
    for (const TripleRow<Thing>& row : of_three) text += row.name + std::string(", ");
    for (const NumberRow<Thing>& row : of_one)
        text += (&row == &of_one[numbers - 1] ? "or " : "") + std::string(row.name) +
                (&row == &of_one[numbers - 1] ? "" : ", ");
    return text;
}

}  // namespace claray::view
