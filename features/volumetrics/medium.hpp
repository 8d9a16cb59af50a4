// The medium that fills the scene. Every value has a documented domain, which `validate` holds; inside it every stored
// value is finite.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <tl/expected.hpp>

#include "features/volumetrics/density_noise.hpp"
#include "features/volumetrics/error.hpp"
#include "features/volumetrics/local_volume.hpp"
#include "features/volumetrics/phase.hpp"

namespace tyndall::volumetrics {

/// The same density everywhere.
struct HomogeneousFog {
    float extinction_per_m = 0.0F;    ///< of the channel that has most, [0, 1e6]
    glm::vec3 extinction_color{1.0F}; ///< each channel's in parts of that, [0, 1]; 1: the fog is grey
    glm::vec3 albedo{1.0F};           ///< part of the extinction that is scattered, each in [0, 1]
    glm::vec3 emission_per_m{0.0F};   ///< radiance gained per metre in every direction, cd/m^3, each in [0, 1e9]
};

/// Extinction at and below the base, falling off above it as e^(-falloff (y - base)), y up.
struct HeightFog {
    float extinction_per_m = 0.0F;    ///< at the base, of the channel that has most, [0, 1e6]
    glm::vec3 extinction_color{1.0F}; ///< each channel's in parts of that, [0, 1]
    glm::vec3 albedo{1.0F};           ///< each in [0, 1]
    glm::vec3 emission_per_m{0.0F};   ///< at the base, falls off as the extinction does, each in [0, 1e9]
    float base_height_m = 0.0F;       ///< world height, [-1e6, 1e6]
    float falloff_per_m = 0.1F;       ///< [0, 1e3]
};

/// sqrt(3 / (4 pi)): of the real spherical harmonics of order 1.
inline constexpr double sh_1_constant = 0.48860251190291992;

struct Medium {
    HomogeneousFog homogeneous;
    HeightFog height;
    DensityNoise noise;
    DensityMap map;                   ///< of homogeneous and height fog, before the volumes
    std::vector<LocalVolume> volumes; ///< blended in in this order, before the noise; at most LocalVolume::most
    float phase_g = 0.0F;             ///< Henyey-Greenstein asymmetry, [-0.999, 0.999]; > 0 scatters forward
    PhaseLobes phase_lobes;           ///< where there are any, they take the place of phase_g
    glm::vec3 ambient_radiance{0.0F}; ///< cd/m^2 from every direction, each in [0, 1e9]
    /// Coefficients of order 1 of the ambient radiance in the orthonormal real spherical harmonics of the world's axes,
    /// Y(1,-1) = c y, Y(1,0) = c z, Y(1,1) = c x with c = sqrt(3 / (4 pi)), of the direction from which the light
    /// comes; rgb each. Nowhere may radiance be negative: c times a channel's length is at most its ambient_radiance.
    std::array<glm::vec3, 3> ambient_sh_1{glm::vec3(0.0F), glm::vec3(0.0F), glm::vec3(0.0F)};
};

/// The phase function as lobes, phase_g being one of Henyey-Greenstein.
[[nodiscard]] PhaseLobes phase_of(const Medium& medium);

/// Euclidean length of ambient_sh_1 in each channel.
[[nodiscard]] glm::vec3 ambient_length(const Medium& medium);

/// Ambient light that fog scatters differs with the direction of view.
[[nodiscard]] bool is_directed(const Medium& medium);

/// The different density grids of the volumes that are not empty, in the order of their first volumes.
[[nodiscard]] std::vector<std::shared_ptr<const DensityTexels>> grids_of(const Medium& medium);

/// By how much the map weakens homogeneous and height fog in the mean, its profile left out; 1 where there is none.
[[nodiscard]] float mean_of_map(const Medium& medium);

/// World heights between which the map leaves fog, its profile made an edge at either end such that a vertical way
/// meets as much; 1e20 m off without a map.
[[nodiscard]] glm::dvec2 heights_of_map(const Medium& medium);

/// Some medium takes more of one channel than of another.
[[nodiscard]] bool is_colored(const Medium& medium);

/// No less than the extinction anywhere, noise left out, 1/m.
[[nodiscard]] float extinction_bound(const Medium& medium);

/// No less than the emission anywhere, noise left out, cd/m^3.
[[nodiscard]] float emission_bound(const Medium& medium);

/// No less than the emitted radiance that a ray of `length_m` gathers, noise left out, cd/m^2.
[[nodiscard]] double emitted_radiance_bound(const Medium& medium, double length_m);

/// Neither scatters, absorbs nor emits anywhere.
[[nodiscard]] bool is_empty(const Medium& medium);

/// The first value outside its domain, by its key in the fog file ("phase.g must be ...").
[[nodiscard]] tl::expected<void, Error> validate(const Medium& medium);

} // namespace tyndall::volumetrics
