// Particle emitters described by a JSON file beside a scene; the schema is in docs/particles.md.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>
#include <tl/expected.hpp>

#include "engine/blend.hpp"
#include "engine/error.hpp"

namespace tyndall::engine {

enum class ParticleKind : std::uint8_t {
    smoke, ///< its billboards are broken up by noise
    dust,  ///< plain soft discs
};

/// A source of particles, in world space. Particles are born at a constant rate and have always been: at any time about
/// rate_per_s * lifetime_s of them are alive.
struct ParticleEmitter {
    std::string name;
    ParticleKind kind = ParticleKind::smoke;
    glm::dvec3 position_m{0.0};          ///< middle of the box in which particles are born
    glm::vec3 box_half_extent_m{0.0F};   ///< >= 0
    double rate_per_s = 1.0;             ///< > 0
    double lifetime_s = 1.0;             ///< > 0
    glm::vec3 velocity_m_s{0.0F};        ///< mean velocity at birth
    glm::vec3 velocity_spread_m_s{0.0F}; ///< half width of the uniform spread around it, >= 0
    float buoyancy_m_s2 = 0.0F;          ///< upward acceleration
    float drag_per_s = 0.0F;             ///< velocity falls by exp(-drag_per_s * age), >= 0
    float turbulence_m_s = 0.0F;         ///< speed (root mean square) of the curling motion added, >= 0
    float start_radius_m = 0.1F;         ///< of the billboard at birth, >= 0
    float end_radius_m = 0.1F;           ///< at the end of life, linear in between, >= 0; one of the two > 0
    float opacity = 1.0F;                ///< alpha at the middle of a billboard that is fully faded in, 0 to 1
    glm::vec3 albedo{1.0F};              ///< share of light that is scattered, 0 to 1; of a filter, that passes
    Blend blend = Blend::premultiplied;
    std::uint32_t seed = 0; ///< emitters with the same seed and rate make the same random choices
};

/// The most particles that all emitters of a file may have at once: 36 sorting passes.
inline constexpr std::uint32_t largest_particle_count = 1U << 18U;

/// Places that an emitter's living particles take: floor(rate_per_s * lifetime_s) + 1.
[[nodiscard]] std::uint32_t particle_slots(const ParticleEmitter& emitter);

/// Parses and validates. Refused, in a sentence that names the key by its path (`emitters[0].opacity`): unknown,
/// missing or repeated keys, values of the wrong type or outside their domain, text that is not JSON.
[[nodiscard]] tl::expected<std::vector<ParticleEmitter>, Error> parse_particles_json(std::string_view text);

} // namespace tyndall::engine
