// The list of all BSDFs. It defines the kinds of materials, their effects and their names on the host, and the
// selection among BSDFs in kernels (kernels/bsdf/kinds.clh, docs/architecture.md).
#ifndef CLARAY_SHARED_LISTS_BSDFS_H
#define CLARAY_SHARED_LISTS_BSDFS_H

// Values of MaterialData::kind and bit numbers in the kernels' MATERIALS. They are macros because `#if
// USES(CLARAY_METAL)` reads them.
#define CLARAY_LAMBERT 0u
#define CLARAY_MIRROR 1u
#define CLARAY_GLASS 2u
#define CLARAY_METAL 3u
#define CLARAY_BLINN_PHONG 4u
#define CLARAY_PRINCIPLED 5u
#define CLARAY_COATED_METAL 6u
#define CLARAY_THIN_WALLS 7u
#define CLARAY_UNLIT 8u
#define CLARAY_CUSTOM 9u
#define CLARAY_OREN_NAYAR 10u

// A row is X(name, NAME, "name for users", transmits, lobes, rough):
//   name       MaterialKind::name, Effect::name, kernels/bsdf/name.clh with sample_name, eval_name and is_delta_name
//   NAME       the number is CLARAY_NAME
//   transmits  1: light passes through
//   lobes      1: random.z selects one of several lobes. May be a macro that name.clh defines, but not one that the
//              host defines: kernels with different values of a macro of this header cannot be joined
//              (host/compute/joint_program)
//   rough      1: reads the roughness and its map

/// Kinds that a material on the host can have. Unlit materials show their albedo and neither receive nor emit light
/// (KHR_materials_unlit).
#define CLARAY_MATERIAL_KINDS(X)                        \
    X(lambert, LAMBERT, "lambert", 0, 0, 0)             \
    X(mirror, MIRROR, "mirror", 0, 0, 0)                \
    X(glass, GLASS, "glass", 1, CLARAY_GLASS_LOBES, 1)  \
    X(metal, METAL, "metal", 0, 1, 1)                   \
    X(blinn_phong, BLINN_PHONG, "blinn-phong", 0, 1, 0) \
    X(principled, PRINCIPLED, "principled", 0, 1, 1)    \
    X(unlit, UNLIT, "unlit", 0, 0, 0)                   \
    X(oren_nayar, OREN_NAYAR, "oren-nayar", 0, 0, 1)

/// Kinds that only a hit can have: glass with Material::thin_walled, and the random variant of a principled material.
#define CLARAY_HIT_KINDS(X)                          \
    X(thin_walls, THIN_WALLS, "thin-walls", 1, 1, 1) \
    X(coated_metal, COATED_METAL, "coated-metal", 0, 1, 1)

/// The BSDFs that programs add (claray/scene.hpp).
#define CLARAY_CUSTOM_KINDS(X) X(custom, CUSTOM, "custom", 0, 1, 1)

#define CLARAY_BSDFS(X) CLARAY_MATERIAL_KINDS(X) CLARAY_HIT_KINDS(X) CLARAY_CUSTOM_KINDS(X)

/// Kinds that are shaded with the normal as it is, not bent to the viewer, on whom diffuse light does not depend.
#define CLARAY_IS_DIFFUSE(kind) ((kind) == CLARAY_LAMBERT || (kind) == CLARAY_OREN_NAYAR)

/// Kinds whose diffuse lobe place_diffuse samples.
#define CLARAY_HAS_DIFFUSE_LOBE(kind) \
    ((kind) == CLARAY_BLINN_PHONG || (kind) == CLARAY_PRINCIPLED || (kind) == CLARAY_OREN_NAYAR)

/// Parameters that only one BSDF reads. A row is X(name, "name in errors", default, check): Material::name and
/// MaterialData::name; `check` is the range that validation requires: `share` (0..1) or `sound` (not negative, finite).
#define CLARAY_BSDF_PARAMETERS(X) X(shininess, "shininess", 32.f, sound) /* blinn_phong: the highlight's exponent */

#endif
