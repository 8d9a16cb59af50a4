#include "features/volumetrics/fog_particle.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace tyndall::volumetrics {
namespace {

/// False of what is not a number, too.
bool in_range(const glm::vec3& v, float low, float high) {
    return v.x >= low && v.x <= high && v.y >= low && v.y <= high && v.z >= low && v.z <= high;
}

/// What is wrong with the particle; null: nothing.
const char* complaint(const FogParticle& particle) {
    if (!in_range(particle.position_m, -1e7F, 1e7F)) {
        return "position_m must be between -1e7 and 1e7.";
    }
    if (!(std::isnormal(particle.radius_m) && particle.radius_m > 0.0F && particle.radius_m <= 1e6F)) {
        return "radius_m must be above 0 and at most 1e6.";
    }
    if (!(particle.extinction_per_m >= 0.0F && particle.extinction_per_m <= 1e6F)) {
        return "extinction_per_m must be between 0 and 1e6.";
    }
    return in_range(particle.albedo, 0.0F, 1.0F) ? nullptr : "albedo must be between 0 and 1.";
}

} // namespace

tl::expected<void, Error> validate(std::span<const FogParticle> particles) {
    if (particles.size() > FogParticle::most) {
        return tl::unexpected(
            Error{"fog_particles must be at most 4096, not " + std::to_string(particles.size()) + "."});
    }
    for (std::size_t i = 0; i < particles.size(); ++i) {
        if (const char* const what = complaint(particles[i])) {
            return tl::unexpected(Error{"fog_particles[" + std::to_string(i) + "]." + what});
        }
    }
    if (extinction_bound(particles) > 1e9F) {
        return tl::unexpected(Error{"fog_particles must add up to an extinction of at most 1e9."});
    }
    return {};
}

float extinction_bound(std::span<const FogParticle> particles) {
    double sum = 0.0;
    for (const FogParticle& particle : particles) {
        sum += static_cast<double>(particle.extinction_per_m);
    }
    return static_cast<float>(sum);
}

std::vector<gpu::GpuFogParticle> gpu_fog_particles(std::span<const FogParticle> particles, float density_scale) {
    std::vector<gpu::GpuFogParticle> made;
    for (const FogParticle& particle : particles) {
        if (particle.extinction_per_m > 0.0F) {
            made.push_back({.position_radius = glm::vec4(particle.position_m, particle.radius_m),
                            .albedo_amount = glm::vec4(particle.albedo, particle.extinction_per_m * density_scale)});
        }
    }
    return made;
}

} // namespace tyndall::volumetrics
