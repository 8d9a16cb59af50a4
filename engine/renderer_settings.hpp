// What a host can choose of the picture.
#pragma once

#include <optional>
#include <string>

#include <glm/vec3.hpp>
#include <vulkan/vulkan_core.h>

#include "engine/cascades.hpp"
#include "engine/lights.hpp"
#include "engine/local_shadows.hpp"

namespace tyndall::engine {

/// Radiance from above and from below, cd/m^2, on every surface; what faces sideways gets the mean.
struct Ambient {
    glm::vec3 up{0.0F};
    glm::vec3 down{0.0F};
};

/// Radiance where there is no surface, cd/m^2: a gradient over the elevation of the ray.
struct Background {
    glm::vec3 zenith{0.0F};
    glm::vec3 horizon{0.0F};
    glm::vec3 ground{0.0F};

    [[nodiscard]] bool is_even() const { return zenith == horizon && horizon == ground; }
};

/// A clear sky in proportion to the sun; a faint grey without one.
[[nodiscard]] Ambient default_ambient(const std::optional<DirectionalLight>& sun);
[[nodiscard]] Background default_background(const std::optional<DirectionalLight>& sun);

struct ExposureSettings {
    std::optional<double> ev100;  ///< absent: from the mean of the image's log luminance
    double compensation_ev = 0.0; ///< of the automatic exposure; positive is brighter
};
/// What radiance is multiplied with before tone mapping, so that the brightest that a sensor of ISO 100 holds becomes
/// 1: 1 / (1.2 * 2^EV100) (Lagarde and de Rousiers, Moving Frostbite to Physically Based Rendering, 2014, 5.1).
[[nodiscard]] double exposure_from_ev100(double ev100);

struct RendererSettings {
    /// R16G16B16A16_SFLOAT, which ends at 65504 cd/m^2, or R32G32B32A32_SFLOAT.
    VkFormat color_format = VK_FORMAT_R16G16B16A16_SFLOAT;
    CascadeSettings cascades;
    bool cache_cascades = true; ///< what a cascade holds is kept until sun, scene or its texels change
    LightSettings lights;
    LocalShadowSettings local_shadows;    ///< their maps are kept until the light that a map serves changes
    std::optional<Ambient> ambient;       ///< absent: default_ambient
    std::optional<Background> background; ///< absent: default_background
    ExposureSettings exposure;
    float texture_anisotropy = 1.0F; ///< 1: none; clamped to what the device has
};

/// Something that a frame does without.
struct Omission {
    std::string what;
    std::string why;
};

} // namespace tyndall::engine
