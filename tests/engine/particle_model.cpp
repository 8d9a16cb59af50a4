#include "tests/engine/particle_model.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>

namespace tyndall::test {
namespace {

/// Four numbers in [0, 1): PCG-4D of Jarzynski and Olano 2020, the upper 24 bits.
std::array<double, 4> random_numbers(std::uint32_t birth, std::uint32_t seed, std::uint32_t set) {
    std::array<std::uint32_t, 4> v{birth, seed, set, 0};
    for (std::uint32_t& x : v) {
        x = x * 1664525U + 1013904223U;
    }
    for (int round = 0; round < 2; ++round) {
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
        if (round == 0) {
            for (std::uint32_t& x : v) {
                x ^= x >> 16U;
            }
        }
    }
    std::array<double, 4> out{};
    for (std::size_t i = 0; i < 4; ++i) {
        out[i] = static_cast<double>(v[i] >> 8U) / 16777216.0;
    }
    return out;
}

struct Wave {
    glm::dvec3 number;
    double frequency;
    glm::dvec3 direction;
    double amplitude;
};
const std::array<Wave, 3> waves{
    Wave{{2.1, 1.3, 1.7}, 1.3, glm::normalize(glm::dvec3{1.7, 0.0, -2.1}), std::sqrt(1.1)},
    Wave{{-3.7, 2.9, 4.1}, 2.3, glm::normalize(glm::dvec3{0.0, 4.1, -2.9}), std::sqrt(0.6)},
    Wave{{5.3, -7.1, 6.1}, 4.1, glm::normalize(glm::dvec3{7.1, 5.3, 0.0}), std::sqrt(0.3)},
};

double smooth(double x) {
    const double t = std::clamp(x, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

} // namespace

ModelParticle model_particle(const engine::ParticleEmitter& emitter, std::uint32_t slot, double time_s) {
    const auto slots = static_cast<std::int64_t>(engine::particle_slots(emitter));
    // The newest birth that owns the slot.
    auto birth = static_cast<std::int64_t>(std::floor(time_s * emitter.rate_per_s));
    while (((birth % slots) + slots) % slots != static_cast<std::int64_t>(slot)) {
        --birth;
    }
    ModelParticle out;
    out.birth = birth;
    out.age_s = time_s - static_cast<double>(birth) / emitter.rate_per_s;
    const double life = out.age_s / emitter.lifetime_s;
    out.alive = life < 1.0;

    const auto number = static_cast<std::uint32_t>(birth); // mod 2^32
    const std::array<double, 4> place = random_numbers(number, emitter.seed, 0);
    const std::array<double, 4> push = random_numbers(number, emitter.seed, 1);
    glm::dvec3 born = emitter.position_m;
    glm::dvec3 velocity(emitter.velocity_m_s);
    for (int i = 0; i < 3; ++i) {
        const auto index = static_cast<std::size_t>(i);
        born[i] += (2.0 * place[index] - 1.0) * static_cast<double>(emitter.box_half_extent_m[i]);
        velocity[i] += (2.0 * push[index] - 1.0) * static_cast<double>(emitter.velocity_spread_m_s[i]);
    }
    const double birth_s = time_s - out.age_s;
    const auto drag = static_cast<double>(emitter.drag_per_s);
    const auto velocity_at = [&](double age) {
        glm::dvec3 v = velocity * std::exp(-drag * age);
        v.y += static_cast<double>(emitter.buoyancy_m_s2) * (drag > 0.0 ? -std::expm1(-drag * age) / drag : age);
        for (const Wave& wave : waves) {
            const double phase = glm::dot(wave.number, born) + wave.frequency * (birth_s + age) + 0.5 * place[3];
            v += static_cast<double>(emitter.turbulence_m_s) * wave.amplitude * std::cos(phase) * wave.direction;
        }
        return v;
    };
    constexpr int steps = 400; // Simpson's rule; even
    const double step_s = out.age_s / steps;
    glm::dvec3 sum = velocity_at(0.0) + velocity_at(out.age_s);
    for (int i = 1; i < steps; ++i) {
        sum += (i % 2 == 1 ? 4.0 : 2.0) * velocity_at(i * step_s);
    }
    out.position_m = born + sum * (step_s / 3.0);
    const auto start = static_cast<double>(emitter.start_radius_m);
    const auto end = static_cast<double>(emitter.end_radius_m);
    out.radius_m = start + (end - start) * std::clamp(life, 0.0, 1.0);
    out.alpha =
        out.alive ? static_cast<double>(emitter.opacity) * smooth(life / 0.1) * (1.0 - smooth(2.0 * life - 1.0)) : 0.0;
    return out;
}

std::uint32_t model_depth_key(float depth_m) {
    const auto bits = std::bit_cast<std::uint32_t>(depth_m == 0.0F ? 0.0F : depth_m);
    const std::uint32_t ascending = (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
    return ~ascending;
}

} // namespace tyndall::test
