#include "engine/renderer_settings.hpp"

#include <cmath>
#include <numbers>

namespace tyndall::engine {
namespace {

/// Radiance of a white surface that faces the sun.
glm::vec3 white_in_sun(const DirectionalLight& sun) {
    return sun.illuminance_lux * std::numbers::inv_pi_v<float>;
}

} // namespace

Ambient default_ambient(const std::optional<DirectionalLight>& sun) {
    if (!sun) {
        return {};
    }
    const glm::vec3 white = white_in_sun(*sun);
    return {white * glm::vec3(0.055F, 0.07F, 0.095F), white * glm::vec3(0.03F, 0.027F, 0.024F)};
}

Background default_background(const std::optional<DirectionalLight>& sun) {
    if (!sun) {
        return {glm::vec3(0.01F), glm::vec3(0.01F), glm::vec3(0.01F)};
    }
    const float white = luminance(white_in_sun(*sun));
    return {white * glm::vec3(0.04F, 0.07F, 0.13F), white * glm::vec3(0.13F, 0.15F, 0.18F),
            white * glm::vec3(0.05F, 0.048F, 0.045F)};
}

double exposure_from_ev100(double ev100) {
    return 1.0 / (1.2 * std::exp2(ev100));
}

} // namespace tyndall::engine
