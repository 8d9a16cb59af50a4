// Particles in double precision, from the description in docs/particles.md: velocities are integrated numerically, so
// that nothing but the constants is shared with the shader.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "engine/particles_json.hpp"

namespace tyndall::test {

struct ModelParticle {
    bool alive = false;
    std::int64_t birth = 0; ///< number
    double age_s = 0.0;
    glm::dvec3 position_m{0.0}; ///< world
    double radius_m = 0.0;
    double alpha = 0.0; ///< without the fade at the near plane
};

/// What occupies `slot` of [0, particle_slots(emitter)) at a time.
[[nodiscard]] ModelParticle model_particle(const engine::ParticleEmitter& emitter, std::uint32_t slot, double time_s);

/// The order of drawing as a number: farther is less. 0xffffffff is kept for what is not drawn.
[[nodiscard]] std::uint32_t model_depth_key(float depth_m);

} // namespace tyndall::test
