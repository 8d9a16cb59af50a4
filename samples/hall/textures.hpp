#pragma once

#include "samples/hall/image.hpp"

namespace tyndall::hall {

/// Colour (sRGB), tangent-space normals (green upwards) and surface (occlusion, roughness, metallic) of one tiling
/// material.
struct SurfaceTextures {
    Image base_color;
    Image normal;
    Image surface;
};

/// Flagstones: one tile is 4 x 4 slabs, worn smoother toward their middles.
[[nodiscard]] SurfaceTextures make_floor_textures();
/// Ashlar masonry: one tile is 6 courses of blocks.
[[nodiscard]] SurfaceTextures make_masonry_textures();
/// Oak planks, the grain running along u.
[[nodiscard]] SurfaceTextures make_wood_textures();
/// A wrought lattice with rosettes, alpha 0 in its holes; tiles.
[[nodiscard]] Image make_grille_texture();
/// A leaded window over the unit square: pieces of coloured glass (alpha 0.82) between opaque cames.
[[nodiscard]] Image make_stained_glass_texture();
/// Diamonds of clear glass, each a little different (alpha 0.55 to 0.8), between opaque cames; tiles, to be tinted.
[[nodiscard]] Image make_quarry_glass_texture();
/// A woven hanging over the unit square: border, field and a sun emblem.
[[nodiscard]] Image make_banner_texture();

} // namespace tyndall::hall
