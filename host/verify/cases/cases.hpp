// The cases: one function each, in the file of its family.
#pragma once

#include "host/verify/run.hpp"

namespace claray::verify {

// device.cpp
void arithmetic(Run& run);
void approximations(Run& run);
void float_atomics(Run& run);
void sort_order(Run& run);

// edges.cpp
void edges(Run& run);
void vertices(Run& run);
void fans(Run& run);
void closed_meshes(Run& run);
void integer_edges(Run& run);

// boxes.cpp
void boxes(Run& run);
void axis_rays(Run& run);

// triangles.cpp
/// Traces with both layouts and compares every hit with exact arithmetic.
void judge(Run& run, const Mesh& mesh, const std::vector<Ray>& rays, const std::string& what,
           std::size_t least_hits = 100);
void slivers(Run& run);
void rays_in_planes(Run& run);
void scales(Run& run);
void huge_coordinates(Run& run);
void far_origins(Run& run);
void close_surfaces(Run& run);
void duplicates(Run& run);
void ray_ends(Run& run);

// trees.cpp
void tiny_counts(Run& run);
void junk(Run& run);
void equal_codes(Run& run);
void stadium(Run& run);
void stack_depth(Run& run);
void rebuilds(Run& run);

// materials.cpp
void ggx_density(Run& run);
void ggx_energy(Run& run);
void furnaces(Run& run);
void fresnel(Run& run);
void bsdf_reciprocity(Run& run);
void bsdf_sampling(Run& run);
void shading_normals(Run& run);

// media.cpp
void nested_media(Run& run);

// harmonics.cpp
void spherical_harmonics(Run& run);

// images.cpp
void self_intersection(Run& run);
void nan_pixels(Run& run);
void accumulation(Run& run);
void srgb(Run& run);
void environment_poles(Run& run);
void height_fields(Run& run);
void alpha_coverage(Run& run);
void light_distance_zero(Run& run);
void shadow_terminator(Run& run);
void image_statistics(Run& run);

// gbuffer.cpp
void depth_to_position(Run& run);
void packed_normals(Run& run);

// waves.cpp
void wave_equation(Run& run);

// same_results.cpp
void tree_hashes(Run& run);
void hit_hashes(Run& run);
void image_hashes(Run& run);

}  // namespace claray::verify
