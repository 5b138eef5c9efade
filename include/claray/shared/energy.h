// Layout of the tables that tell how much light rough surfaces scatter once (host/bsdf/energy_tables.hpp).
#ifndef CLARAY_SHARED_ENERGY_H
#define CLARAY_SHARED_ENERGY_H

/// A table: rows by roughness 0..1, in each as many values by cosine_place or loss_place in
/// kernels/bsdf/ggx.clh; then each row's average over the hemisphere; that
/// of losses over alpha^2, in proportion to which they roughly are.
#define CLARAY_ENERGY_SIZE 32
#define CLARAY_ENERGY_TABLE (CLARAY_ENERGY_SIZE * (CLARAY_ENERGY_SIZE + 1))

// All tables lie one behind the other: first the conductor's, what of light one reflection loses; then, where something
// has them, those of sheen and of anisotropy. Then come blocks.

/// What white sheen reflects, by its roughness from CLARAY_LEAST_SHEEN to 1 and by cosine_place; not clamped to 1.
#define CLARAY_SHEEN CLARAY_ENERGY_TABLE
/// Below this roughness fibres shine only where nothing is seen any more, and float32 does not resolve their lobe.
#define CLARAY_LEAST_SHEEN 0.07f

/// What of light one reflection by an anisotropic conductor loses: by the roots of alpha along the tangent and across
/// it, each in CLARAY_STRETCH_SIZE steps, by the square of the sine of the angle to the tangent (0, 1/2, 1), and by
/// loss_place with the alpha of that angle. Then the averages over the hemisphere.
#define CLARAY_STRETCH (2 * CLARAY_ENERGY_TABLE)
#define CLARAY_STRETCH_SIZE 20
#define CLARAY_STRETCH_ROW (3 * CLARAY_ENERGY_SIZE)
#define CLARAY_STRETCH_AVERAGES (CLARAY_STRETCH_SIZE * CLARAY_STRETCH_SIZE * CLARAY_STRETCH_ROW)
#define CLARAY_STRETCH_TABLE (CLARAY_STRETCH_AVERAGES + CLARAY_STRETCH_SIZE * CLARAY_STRETCH_SIZE)

/// The block of an index of refraction: what a dielectric does not reflect; what neither comes back nor goes through,
/// from outside and from inside; and the share of diffuse light from outside that a smooth interface lets through.
#define CLARAY_UNREFLECTED 0
#define CLARAY_LOST_OUTSIDE CLARAY_ENERGY_TABLE
#define CLARAY_LOST_INSIDE (2 * CLARAY_ENERGY_TABLE)
#define CLARAY_TRANSMITTANCE (3 * CLARAY_ENERGY_TABLE)
#define CLARAY_ENERGY_BLOCK (3 * CLARAY_ENERGY_TABLE + 1)

/// Behind the coat's block: what a metal under it is scaled by, by the coat's roughness, the metal's (fewer steps) and
/// cosine_place.
#define CLARAY_COAT_IOR 1.5f
#define CLARAY_METAL_SIZE 16
#define CLARAY_COAT_SCALES CLARAY_ENERGY_BLOCK
#define CLARAY_COAT_TABLE (CLARAY_ENERGY_SIZE * CLARAY_METAL_SIZE * CLARAY_ENERGY_SIZE)

#endif
