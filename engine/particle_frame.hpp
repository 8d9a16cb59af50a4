// What the GPU is told of particles in a frame: emitters seen from the camera at one time. Pure functions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/frame.hpp"
#include "engine/particles_json.hpp"
#include "shaders/engine/particle_interop.h"

namespace tyndall::engine {

/// What lights particles where there is no scattering volume.
struct ParticleLight {
    glm::vec3 ambient_radiance{0.0F};    ///< cd/m^2, from every direction
    glm::vec3 sun_illuminance_lux{0.0F}; ///< zero: no sun
    std::uint32_t light_count = 0;       ///< entries of the light buffer
};

/// Particles of all emitters: the sum of their slots.
[[nodiscard]] std::uint32_t particle_count(std::span<const ParticleEmitter> emitters);

/// Sort keys for so many particles: the next power of two, at least 2.
[[nodiscard]] std::uint32_t particle_key_count(std::uint32_t particles);

/// `view.time_s` is finite; any.
[[nodiscard]] gpu::ParticleFrame make_particle_frame(const FrameView& view, const ParticleLight& light,
                                                     std::span<const ParticleEmitter> emitters);

/// One entry an emitter, in the same order. Time and positions are taken relative in double precision, so that neither
/// late times nor places far from the world's origin cost accuracy.
[[nodiscard]] std::vector<gpu::GpuEmitter> make_gpu_emitters(const FrameView& view,
                                                             std::span<const ParticleEmitter> emitters);

} // namespace tyndall::engine
