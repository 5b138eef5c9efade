// The names of what a render can be asked for.
#pragma once

#include "claray/image/cryptomatte.hpp"
#include "claray/renderer.hpp"
#include "names.hpp"

namespace claray::python {

inline constexpr Named<Sampler> samplers[] = {{Sampler::sobol, "sobol"}, {Sampler::independent, "independent"}};
inline constexpr Named<DenoiserKind> denoisers[] = {
    {DenoiserKind::automatic, "automatic"}, {DenoiserKind::claray, "claray"}, {DenoiserKind::oidn, "oidn"}};
inline constexpr Named<ToneMap> tone_maps[] = {{ToneMap::aces, "aces"}, {ToneMap::none, "none"}};
inline constexpr Named<Layout> layouts[] = {
    {Layout::automatic, "automatic"}, {Layout::binary, "binary"}, {Layout::wide, "wide"}};
inline constexpr Named<MatteKind> matte_kinds[] = {
    {MatteKind::object, "object"}, {MatteKind::material, "material"}, {MatteKind::asset, "asset"}};
inline constexpr Named<NormalPacking> normal_packings[] = {{NormalPacking::octahedral, "octahedral"},
                                                           {NormalPacking::spherical, "spherical"}};
inline constexpr Named<KernelStart> kernel_starts[] = {
    {KernelStart::own, "own"}, {KernelStart::generic, "generic"}, {KernelStart::quick, "quick"}};

}  // namespace claray::python
