// What the GPU is told of particles in a frame: emitters seen from the camera at one time. Pure functions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <vulkan/vulkan_core.h>

#include "engine/particles_json.hpp"
#include "shaders/engine/particle_interop.h"

namespace tyndall::engine {

/// A view of a frame. Render space has world axes, metres and its origin at `origin_m`.
struct ParticleView {
    glm::mat4 view_from_render{1.0F}; ///< rigid; view space looks along -Z, +Y up
    glm::mat4 clip_from_view{1.0F};   ///< y down, reverse z, perspective or orthographic
    glm::dvec3 origin_m{0.0};
    double time_s = 0.0; ///< finite; any
    VkExtent2D extent{};
    // Used where there is no scattering volume:
    glm::vec3 ambient_radiance{0.0F};
    glm::vec3 sun_illuminance_lux{0.0F}; ///< 0: no sun
    std::uint32_t light_count = 0;
};

/// Particles of all emitters: the sum of their slots.
[[nodiscard]] std::uint32_t particle_count(std::span<const ParticleEmitter> emitters);

/// Sort keys for so many particles: the next power of two, at least 2.
[[nodiscard]] std::uint32_t particle_key_count(std::uint32_t particles);

[[nodiscard]] gpu::ParticleFrame make_particle_frame(const ParticleView& view,
                                                     std::span<const ParticleEmitter> emitters);

/// One entry an emitter, in the same order. Time and positions are taken relative in double precision, so that neither
/// late times nor places far from the world's origin cost accuracy.
[[nodiscard]] std::vector<gpu::GpuEmitter> make_gpu_emitters(const ParticleView& view,
                                                             std::span<const ParticleEmitter> emitters);

} // namespace tyndall::engine
