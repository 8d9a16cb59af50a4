// Particles of every way of blending, against closed forms.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "tests/engine/particle_picture.hpp"

namespace tyndall::test {
namespace {

/// A particle of light S per unit of albedo, seen through fog of transmittance T and in-scattered light L.
glm::dvec4 blended(const glm::dvec4& behind, const ParticleEmitter& particle, const glm::dvec3& light,
                   double transmittance, double fog) {
    const auto a = static_cast<double>(particle.opacity);
    const glm::dvec3 color(particle.albedo);
    if (particle.blend == engine::Blend::premultiplied) {
        return over(behind, color * light * transmittance + fog, a);
    }
    if (particle.blend == engine::Blend::additive) {
        return behind + glm::dvec4(a * color * light * transmittance, 0.0);
    }
    const glm::dvec3 passes = 1.0 - a * (1.0 - color);
    return {passes * glm::dvec3(behind) + (1.0 - passes) * fog, 1.0};
}

// Two of each kind, one over another in an order in which none commutes with its neighbours.
TEST_F(ParticlesDrawTest, EveryWayOfBlendingHasTheFogOfItsDepthInAnyOrderOfEmitters) {
    using engine::Blend;
    constexpr std::array ways = {Blend::multiply,      Blend::premultiplied, Blend::additive,
                                 Blend::premultiplied, Blend::multiply,      Blend::additive};
    std::vector<ParticleEmitter> far_to_near;
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const double depth_m = 20.0 - 3.0 * static_cast<double>(i);
        ParticleEmitter& emitter = far_to_near.emplace_back(
            resting({0, 0, -depth_m}, static_cast<float>(0.03 * depth_m), 0.4F + 0.1F * static_cast<float>(i)));
        emitter.blend = ways[i];
        emitter.albedo = {0.25F, 0.5F + 0.05F * static_cast<float>(i), 0.9F};
    }
    const Fog fog;
    for (const bool foggy : {true, false}) {
        SCOPED_TRACE(foggy ? "fog" : "clear air");
        const Picture picture{.fog = foggy ? std::optional(fog) : std::nullopt};
        glm::dvec4 expected = background;
        for (const ParticleEmitter& particle : far_to_near) {
            const double passes = foggy ? std::exp(fog.extinction_per_m * particle.position_m.z) : 1.0;
            expected = blended(expected, particle, glm::dvec3(foggy ? fog.in_scattered : 4.0), passes,
                               fog.source * (1.0 - passes));
        }
        expect_near(center(far_to_near, picture), expected, 1e-4);
        expect_near(center({far_to_near.rbegin(), far_to_near.rend()}, picture), expected, 1e-4);
        std::vector<ParticleEmitter> mixed = far_to_near;
        std::swap(mixed[0], mixed[3]);
        std::swap(mixed[1], mixed[5]);
        expect_near(center(mixed, picture), expected, 1e-4);
    }
}

// No filter is among them: one source is enough, as on a device that has no other.
TEST_F(ParticlesDrawTest, AddedParticlesNeedOneSource) {
    ParticleEmitter added = resting({0, 0, -8}, 0.3F, 0.5F);
    added.blend = engine::Blend::additive;
    const ParticleEmitter smoke = resting({0, 0, -12}, 0.3F, 0.25F);
    const Fog fog;
    glm::dvec4 expected = background;
    for (const ParticleEmitter& particle : {smoke, added}) {
        const double passes = std::exp(fog.extinction_per_m * particle.position_m.z);
        expected = blended(expected, particle, glm::dvec3(fog.in_scattered), passes, fog.source * (1.0 - passes));
    }
    expect_near(center({added, smoke}, {.fog = fog}), expected, 1e-4);
}

} // namespace
} // namespace tyndall::test
