// Fog, or its absence, inside a box or an ellipsoid.
#pragma once

#include <cstdint>
#include <memory>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "features/volumetrics/density_texels.hpp"

namespace tyndall::volumetrics {

enum class VolumeShape : std::uint8_t { box, ellipsoid };

/// What a volume does to the fog that is there before it, the volumes before it included. With w its weight:
enum class VolumeBlend : std::uint8_t {
    add,      ///< extinction + w e, scattering + w e albedo, emission + w emission_per_m
    subtract, ///< extinction - w e, at least 0; scattering and emission fall in proportion
    multiply, ///< all three times 1 + w (factor - 1)
    max,      ///< its own in the channels in which w e is the larger extinction
};

/// In the space where the shape reaches from -1 to 1 along each axis, at the point q, the weight is 0 outside, and
/// inside the product of min(1, (1 - |q_i|) / edge) over the axes of a box, min(1, (1 - |q|) / edge) for an ellipsoid.
struct LocalVolume {
    static constexpr std::uint32_t most = 16;
    static constexpr std::uint32_t most_grids = 4;

    VolumeShape shape = VolumeShape::box;
    VolumeBlend blend = VolumeBlend::add;
    glm::vec3 center_m{0.0F};                   ///< world, each in [-1e6, 1e6]
    glm::vec3 half_size_m{1.0F};                ///< along its own axes, each in [0, 1e6]; 0: it is empty
    glm::quat rotation{1.0F, 0.0F, 0.0F, 0.0F}; ///< from its axes to the world's, of unit length
    float edge = 0.0F;                          ///< [0, 1]; 0: hard
    float extinction_per_m = 0.0F;              ///< e of the channel that has most, [0, 1e6]; not of multiply
    glm::vec3 extinction_color{1.0F};           ///< e of each channel in parts of that, [0, 1]
    float factor = 1.0F;                        ///< of multiply, [0, 1e3]
    glm::vec3 albedo{1.0F};                     ///< each in [0, 1]; of add and max
    glm::vec3 emission_per_m{0.0F};             ///< cd/m^3, each in [0, 1e9]; of add and max
    /// By which the weight is multiplied, stretched over the shape from -1 to 1 along its own axes; null: none. At most
    /// `most_grids` different ones in all.
    std::shared_ptr<const DensityTexels> density;

    friend bool operator==(const LocalVolume&, const LocalVolume&) = default;
};

} // namespace tyndall::volumetrics
