#pragma once

#include <array>
#include <cstddef>

#include "samples/hall/scene.hpp"

namespace tyndall::hall {

/// Indices of the materials of the hall in `Scene::materials`.
struct Materials {
    std::size_t floor = 0;
    std::size_t masonry = 0;
    std::size_t dressed_stone = 0; // pillars, arches, steps: finer and lighter than the walls
    std::size_t vault_stone = 0;
    std::size_t wood = 0;
    std::size_t iron = 0;
    std::size_t bronze = 0;
    std::size_t clay = 0;
    std::size_t banner = 0;
    std::size_t grille = 0;
    std::size_t flame = 0;
    std::size_t embers = 0;
    std::size_t lantern_glass = 0;
    std::size_t stained_glass = 0;
    std::array<std::size_t, 4> panes{}; // amber, ruby, cobalt, emerald
};

/// Makes the textures and materials of the hall in `scene`.
[[nodiscard]] Materials add_materials(Scene& scene);

} // namespace tyndall::hall
