// Random points and directions for tests, the same in every run.
#pragma once

#include <cstdint>
#include <random>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace tyndall::test {

class RandomGeometry {
public:
    explicit RandomGeometry(std::uint32_t seed) : engine_(seed) {}
    [[nodiscard]] double in(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    /// In the cube from -reach to reach.
    [[nodiscard]] glm::dvec3 point(double reach) { return {in(-reach, reach), in(-reach, reach), in(-reach, reach)}; }
    /// A unit vector, all directions alike.
    [[nodiscard]] glm::dvec3 direction() {
        for (;;) {
            const glm::dvec3 p = point(1.0);
            const double length = glm::length(p);
            if (length > 0.1 && length < 1.0) {
                return p / length;
            }
        }
    }

private:
    std::mt19937 engine_;
};

} // namespace tyndall::test
