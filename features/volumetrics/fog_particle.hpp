// Soft spheres of fog, many and moving: smoke, steam, dust that a program simulates.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <tl/expected.hpp>

#include "features/volumetrics/error.hpp"
#include "shaders/volumetrics/fog_particle.h"

namespace tyndall::volumetrics {

/// At a distance d from its centre, below the radius r, it adds (1 - (d / r)^2)^2 of its extinction to the fog, beyond
/// nothing: an optical depth of 16/15 r times the extinction along a diameter. It is grey.
struct FogParticle {
    static constexpr std::size_t most = TYNDALL_FOG_PARTICLE_COUNT;

    glm::vec3 position_m{0.0F};    ///< render space, each in [-1e7, 1e7]
    float radius_m = 1.0F;         ///< above 0, at most 1e6
    float extinction_per_m = 0.0F; ///< at the centre, [0, 1e6]; 0: it is left out
    glm::vec3 albedo{1.0F};        ///< part of the extinction that is scattered, each in [0, 1]
};

/// The first value outside its domain, or too many particles.
[[nodiscard]] tl::expected<void, Error> validate(std::span<const FogParticle> particles);

/// No less than their extinction anywhere, 1/m; 0 where there is none.
[[nodiscard]] float extinction_bound(std::span<const FogParticle> particles);

/// Those that have an extinction, which is multiplied by `density_scale`.
[[nodiscard]] std::vector<gpu::GpuFogParticle> gpu_fog_particles(std::span<const FogParticle> particles,
                                                                 float density_scale);

} // namespace tyndall::volumetrics
