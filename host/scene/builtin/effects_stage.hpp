// Parts of the scenes about effects: a floor, a ball and a block, and computed images.
#pragma once

#include <functional>

#include "claray/scene.hpp"

namespace claray::scenes {

/// The materials of the stage's parts.
enum StageMaterial : std::uint32_t { floor_material, ball_material, block_material, stage_materials };

/// A floor of 6 x 6, a ball of radius 0.8 and a block, all diffuse, facetted and with texture coordinates; a camera; no
/// light.
[[nodiscard]] Scene empty_stage();
/// A ball with texture coordinates: its front seen as a disc.
[[nodiscard]] Mesh textured_ball(const glm::vec3& center, float radius, unsigned levels, std::uint32_t material);
/// The lower half of a sphere, whose front is the inside.
[[nodiscard]] Mesh open_bowl(const glm::vec3& center, float radius, std::uint32_t material);
/// The rectangle of add_rectangle with texture coordinates 0..1, the top left corner of an image at center - u + v.
[[nodiscard]] Mesh textured_rectangle(const glm::vec3& center, const glm::vec3& u, const glm::vec3& v,
                                      std::uint32_t material);

/// Primitives of all kinds, on the floor: a disc, twigs around its border, and spheres and a cylinder on it.
void add_nest(Scene& scene, const glm::vec3& place, float radius, std::uint32_t twigs, std::uint32_t eggs);

/// Colours at the vertices: red, green and blue by where they are in the mesh' box.
void paint(Mesh& mesh);

/// An image whose texels are `color(u, v)`, u and v in 0..1 from the top left.
[[nodiscard]] Texture computed_image(const char* name, unsigned width, unsigned height, TexelFormat format,
                                     const std::function<glm::vec3(double, double)>& color);
[[nodiscard]] Texture checks();               ///< a chessboard of 8 x 8 in two greys
[[nodiscard]] Texture ripples_as_normals();   ///< a normal map
[[nodiscard]] Texture noise_as_height();      ///< a height map
[[nodiscard]] Texture pool_of_light();        ///< a light map: bright in the middle
[[nodiscard]] Texture disc_opacity();         ///< 1 in a disc, 0 around it
[[nodiscard]] Texture evening_environment();  ///< latitude and longitude: a low sun in a sky above a dark ground

/// Adds the texture and returns its use.
TextureUse add_texture(Scene& scene, Texture texture, Filter filter = Filter::bilinear);

}  // namespace claray::scenes
