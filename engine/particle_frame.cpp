#include "engine/particle_frame.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace tyndall::engine {
namespace {

/// A plane wave of turbulence: velocity `amplitude * direction * cos(wave_number . x + frequency t)`.
struct Wave {
    glm::dvec3 wave_number; ///< rad/m
    double frequency;       ///< rad/s
    glm::dvec3 direction;   ///< unit, across the wave number: the field has no divergence
    double amplitude;       ///< squares add up to 2, for a mean square velocity of 1
};

/// Wavelengths of 2.1, 1.0 and 0.58 m, periods of 4.8, 2.7 and 1.5 s.
const std::array<Wave, 3> waves{
    Wave{{2.1, 1.3, 1.7}, 1.3, glm::normalize(glm::dvec3{1.7, 0.0, -2.1}), std::sqrt(1.1)},
    Wave{{-3.7, 2.9, 4.1}, 2.3, glm::normalize(glm::dvec3{0.0, 4.1, -2.9}), std::sqrt(0.6)},
    Wave{{5.3, -7.1, 6.1}, 4.1, glm::normalize(glm::dvec3{7.1, 5.3, 0.0}), std::sqrt(0.3)},
};

/// How much of a billboard's alpha is noise.
constexpr float smoke_noise = 0.85F;

/// x mod n in [0, n), exact.
double positive_mod(double x, double n) {
    const double r = std::fmod(x, n);
    return r < 0.0 ? r + n : r;
}

float wave_phase(const Wave& wave, const glm::dvec3& position, double time_s) {
    constexpr double turn = 2.0 * std::numbers::pi;
    return static_cast<float>(std::fmod(glm::dot(wave.wave_number, position), turn) +
                              std::fmod(wave.frequency * time_s, turn));
}

/// The plane with normal and distance in `plane`, scaled so that distances are metres. A plane at infinity, where the
/// normal vanishes, cuts nothing off.
glm::vec4 normalized_plane(const glm::vec4& plane) {
    const float length = glm::length(glm::vec3(plane));
    return length > 0.0F ? plane / length : glm::vec4(0.0F, 0.0F, 0.0F, 1.0F);
}

/// The share of light that particles send on toward the eye: a filter sends none of its own.
glm::vec3 scattered_share(const ParticleEmitter& emitter) {
    return emitter.blend == Blend::multiply ? glm::vec3(0.0F) : emitter.albedo;
}

/// What particles take of the light from behind where they are opaque, and give of the fog before them; w: the mean.
glm::vec4 taken_share(const ParticleEmitter& emitter) {
    if (emitter.blend == Blend::multiply) {
        const glm::vec3 taken = glm::vec3(1.0F) - emitter.albedo;
        return {taken, (taken.r + taken.g + taken.b) / 3.0F};
    }
    return glm::vec4(emitter.blend == Blend::premultiplied ? 1.0F : 0.0F);
}

} // namespace

std::uint32_t particle_count(std::span<const ParticleEmitter> emitters) {
    std::uint32_t count = 0;
    for (const ParticleEmitter& emitter : emitters) {
        count += particle_slots(emitter);
    }
    return count;
}

std::uint32_t particle_key_count(std::uint32_t particles) {
    return std::bit_ceil(std::max(particles, 2U));
}

gpu::ParticleFrame make_particle_frame(const FrameView& view, const ParticleLight& light,
                                       std::span<const ParticleEmitter> emitters) {
    const glm::mat4 clip(view.clip_from_view);
    const auto row = [&](int i) { return glm::vec4(clip[0][i], clip[1][i], clip[2][i], clip[3][i]); };
    gpu::ParticleFrame frame{};
    frame.view_from_render = glm::mat4(view.view_from_render);
    frame.clip_from_view = clip;
    frame.frustum[0] = normalized_plane(row(3) + row(0));
    frame.frustum[1] = normalized_plane(row(3) - row(0));
    frame.frustum[2] = normalized_plane(row(3) + row(1));
    frame.frustum[3] = normalized_plane(row(3) - row(1));
    // d = (clip22 z + clip32) / (clip23 z + clip33) with z = -depth, solved for the depth.
    frame.depth = glm::vec4(clip[3][2], clip[3][3], clip[2][2], -clip[2][3]);
    const float near_m = (clip[3][2] - clip[3][3]) / (clip[2][2] - clip[2][3]);
    frame.near_size =
        glm::vec4(near_m, static_cast<float>(view.size.width), static_cast<float>(view.size.height), 0.0F);
    frame.ambient = glm::vec4(light.ambient_radiance, 0.0F);
    frame.sun_illuminance = glm::vec4(light.sun_illuminance_lux, 0.0F);
    const std::uint32_t particles = particle_count(emitters);
    frame.counts = glm::uvec4(static_cast<std::uint32_t>(emitters.size()), particles, particle_key_count(particles),
                              light.light_count);
    for (std::size_t i = 0; i < waves.size(); ++i) {
        const Wave& wave = waves[i];
        frame.wave_number[i] = glm::vec4(wave.wave_number, wave.frequency);
        frame.wave_speed[i] = glm::vec4(wave.direction, wave.amplitude / wave.frequency);
    }
    return frame;
}

std::vector<gpu::GpuEmitter> make_gpu_emitters(const FrameView& view, std::span<const ParticleEmitter> emitters) {
    std::vector<gpu::GpuEmitter> result;
    result.reserve(emitters.size());
    std::uint32_t first = 0;
    for (const ParticleEmitter& emitter : emitters) {
        const double births = view.time_s * emitter.rate_per_s;
        const double newest = std::floor(births);
        const std::uint32_t slots = particle_slots(emitter);
        gpu::GpuEmitter out{};
        out.origin_lifetime =
            glm::vec4(glm::vec3(emitter.position_m - view.origin_m), static_cast<float>(emitter.lifetime_s));
        out.box_start_radius = glm::vec4(emitter.box_half_extent_m, emitter.start_radius_m);
        out.velocity_end_radius = glm::vec4(emitter.velocity_m_s, emitter.end_radius_m);
        out.spread_opacity = glm::vec4(emitter.velocity_spread_m_s, emitter.opacity);
        out.albedo_noise =
            glm::vec4(scattered_share(emitter), emitter.kind == ParticleKind::smoke ? smoke_noise : 0.0F);
        out.taken = taken_share(emitter);
        out.forces = glm::vec4(emitter.buoyancy_m_s2, emitter.drag_per_s, emitter.turbulence_m_s,
                               static_cast<float>(1.0 / emitter.rate_per_s));
        for (int i = 0; i < 3; ++i) {
            out.wave_phase[i] = wave_phase(waves[static_cast<std::size_t>(i)], emitter.position_m, view.time_s);
        }
        out.wave_phase.w = static_cast<float>((births - newest) / emitter.rate_per_s);
        out.slots = glm::uvec4(first, slots, static_cast<std::uint32_t>(positive_mod(newest, 4294967296.0)),
                               static_cast<std::uint32_t>(positive_mod(newest, static_cast<double>(slots))));
        out.seed = glm::uvec4(emitter.seed, 0U, 0U, 0U);
        first += slots;
        result.push_back(out);
    }
    return result;
}

} // namespace tyndall::engine
