// Layout of the tables of the light that rough surfaces scatter once (host/bsdf/energy_tables.hpp).
#ifndef CLARAY_SHARED_ENERGY_H
#define CLARAY_SHARED_ENERGY_H

/// A table has rows by roughness 0..1. Each row has the same number of values, indexed by cosine_place or loss_place in
/// kernels/bsdf/ggx.clh. The average of each row over the hemisphere follows the rows. Averages of losses are divided
/// by alpha^2, since losses are roughly proportional to it.
#define CLARAY_ENERGY_SIZE 32
#define CLARAY_ENERGY_TABLE (CLARAY_ENERGY_SIZE * (CLARAY_ENERGY_SIZE + 1))

// All tables are stored consecutively. The first is the conductor's: the share of light that one reflection loses. Then
// follow, if a material needs them, the tables of sheen and of anisotropy, then the blocks.

/// Reflectance of white sheen, by the root of its roughness from CLARAY_LEAST_SHEEN (0) to 1 and by cosine_place: as
/// published, which exceeds 1, and with the bound of eval_sheen.
#define CLARAY_SHEEN CLARAY_ENERGY_TABLE
#define CLARAY_BOUNDED_SHEEN (2 * CLARAY_ENERGY_TABLE)
/// Below this roughness, sheen is visible only at angles where surfaces are almost invisible, and float32 does not
/// resolve its lobe.
#define CLARAY_LEAST_SHEEN 0.07f

/// A lobe is scaled by what a layer above it lets pass for both directions. A spread table holds what the lobe then
/// lacks of the light that the layer lets pass: by the layer's roughness, the base's roughness (fewer steps) and
/// cosine_place. The averages over the hemisphere follow, by both roughnesses. Entries of a dielectric's interface are
/// of index CLARAY_COAT_IOR, divided by Fresnel's rise from normal incidence to grazing angles.
#define CLARAY_METAL_SIZE 16
#define CLARAY_COAT_TABLE (CLARAY_ENERGY_SIZE * CLARAY_METAL_SIZE * CLARAY_ENERGY_SIZE)
#define CLARAY_SPREAD_TABLE (CLARAY_COAT_TABLE + CLARAY_ENERGY_SIZE * CLARAY_METAL_SIZE)

/// Below white sheen, for the smaller of both transmittances: of a metal that absorbs nothing, and of an interface.
#define CLARAY_SHEEN_OVER_METAL (3 * CLARAY_ENERGY_TABLE)
#define CLARAY_SHEEN_OVER_INTERFACE (CLARAY_SHEEN_OVER_METAL + CLARAY_SPREAD_TABLE)

/// What a coat of index CLARAY_COAT_IOR lets pass of the light that sheen below it scatters: by the roughness of the
/// sheen and that of the coat.
#define CLARAY_COAT_OVER_SHEEN (CLARAY_SHEEN_OVER_INTERFACE + CLARAY_SPREAD_TABLE)

/// Share of light that one reflection by an anisotropic conductor loses. Indices: the square roots of alpha along the
/// tangent and across it, each in CLARAY_STRETCH_SIZE steps. Then the square of the sine of the angle to the tangent
/// (0, 1/2, 1), and loss_place with the alpha of that angle. The averages over the hemisphere follow.
#define CLARAY_STRETCH (CLARAY_COAT_OVER_SHEEN + CLARAY_ENERGY_SIZE * CLARAY_ENERGY_SIZE)
#define CLARAY_STRETCH_SIZE 20
#define CLARAY_STRETCH_ROW (3 * CLARAY_ENERGY_SIZE)
#define CLARAY_STRETCH_AVERAGES (CLARAY_STRETCH_SIZE * CLARAY_STRETCH_SIZE * CLARAY_STRETCH_ROW)
#define CLARAY_STRETCH_TABLE (CLARAY_STRETCH_AVERAGES + CLARAY_STRETCH_SIZE * CLARAY_STRETCH_SIZE)

/// The cosines to the facets that reflect: shares of what an isotropic conductor reflects once, by roughness,
/// cosine_place, and the cosines (k / 7)^2. Sums of shares times values there are means over the facets.
/// Their averages over the hemisphere follow, by roughness.
#define CLARAY_FACETS (CLARAY_STRETCH + CLARAY_STRETCH_TABLE)
#define CLARAY_FACET_COSINES 8
#define CLARAY_FACET_AVERAGES (CLARAY_ENERGY_SIZE * CLARAY_ENERGY_SIZE * CLARAY_FACET_COSINES)
#define CLARAY_FACET_TABLE (CLARAY_FACET_AVERAGES + CLARAY_ENERGY_SIZE * CLARAY_FACET_COSINES)

/// The curve of Fresnel's equations of a larger index falls before it rises: KHR_materials_specular takes the curve of
/// this index then.
#define CLARAY_MOST_CURVE_IOR 3.0f

/// Tables of one index of refraction. The share of light that a dielectric does not reflect. The share that is neither
/// reflected nor transmitted, from outside and from inside. The share of diffuse light from outside that a smooth
/// interface transmits.
#define CLARAY_UNREFLECTED 0
#define CLARAY_LOST_OUTSIDE CLARAY_ENERGY_TABLE
#define CLARAY_LOST_INSIDE (2 * CLARAY_ENERGY_TABLE)
#define CLARAY_TRANSMITTANCE (3 * CLARAY_ENERGY_TABLE)
#define CLARAY_ENERGY_BLOCK (3 * CLARAY_ENERGY_TABLE + 1)

/// After the coat's block: the scale of a metal under the coat, by the coat's roughness, the metal's roughness (fewer
/// steps) and cosine_place. Then the spread table of an interface under it.
#define CLARAY_COAT_IOR 1.5f
#define CLARAY_COAT_SCALES CLARAY_ENERGY_BLOCK
#define CLARAY_COAT_SPREAD (CLARAY_COAT_SCALES + CLARAY_COAT_TABLE)

/// After the block of an anisotropic dielectric and the room of a coat's tables. The share of light that it does not
/// reflect, in the form of CLARAY_STRETCH, but by cosine_place.
#define CLARAY_STRETCHED_UNREFLECTED (CLARAY_COAT_SPREAD + CLARAY_SPREAD_TABLE)

/// After the room of all these, for rough glass with another reflectance than Fresnel's, seen from outside and from
/// inside. It is the gain in transmission over reflection, scattered once, at facets of the outer cosines (k / 7)^2. In
/// the form of CLARAY_FACETS, but by loss_place, and averages are divided by alpha^2.
#define CLARAY_GLASS_FACETS (CLARAY_STRETCHED_UNREFLECTED + CLARAY_STRETCH_TABLE)

#endif
