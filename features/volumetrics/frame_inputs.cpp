#include "features/volumetrics/frame_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <glm/geometric.hpp>

namespace tyndall::volumetrics {
namespace {

constexpr float largest_intensity_cd = 1e12F;
constexpr double latest_s = 1e10;

bool is_finite(const glm::dmat4& m) {
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
            if (!std::isfinite(m[i][j])) {
                return false;
            }
        }
    }
    return true;
}

bool is_finite(const glm::vec4& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

/// What is wrong with the light; null: nothing.
const char* complaint(const gpu::GpuLight& light) {
    const glm::vec4& candela = light.intensity_type;
    const glm::vec4& place = light.position_range;
    if (!is_finite(glm::vec4(glm::vec3(place), 0.0F)) || !(place.w > 0.0F)) { // its range may be infinite
        return "position_range must have a finite position, and a range above 0.";
    }
    if (!is_finite(candela) || std::min({candela.x, candela.y, candela.z}) < 0.0F ||
        std::max({candela.x, candela.y, candela.z}) > largest_intensity_cd) {
        return "intensity_type must have intensities between 0 and 1e12.";
    }
    if (!is_finite(light.direction_radius) || light.direction_radius.w < 0.0F) {
        return "direction_radius must be finite, with a radius of 0 or more.";
    }
    const bool spot = candela.w > 0.5F;
    if (spot && !(std::abs(glm::length(glm::vec3(light.direction_radius)) - 1.0F) < 1e-3F)) {
        return "direction_radius must have a direction of unit length.";
    }
    return is_finite(light.cone) ? nullptr : "cone must be finite.";
}

} // namespace

tl::expected<void, Error> validate(const FrameInputs& inputs, std::uint32_t slots) {
    if (auto valid = validate(inputs.medium); !valid) {
        return valid;
    }
    if (auto valid = validate(inputs.settings); !valid) {
        return valid;
    }
    const glm::dmat4& p = inputs.camera.clip_from_view;
    if (!is_finite(p) || !is_finite(inputs.camera.view_from_render) || p[0][0] == 0.0 || p[1][1] == 0.0) {
        return tl::unexpected(Error{"camera must have finite matrices, and a projection that can be inverted."});
    }
    for (int i = 0; i < 3; ++i) {
        if (!std::isfinite(inputs.camera.origin_m[i])) {
            return tl::unexpected(Error{"camera.origin_m must be finite."});
        }
    }
    if (inputs.sun) {
        const glm::vec3& lux = inputs.sun->illuminance_lux;
        for (int i = 0; i < 3; ++i) {
            if (!std::isfinite(lux[i]) || lux[i] < 0.0F || lux[i] > 1e9F) {
                return tl::unexpected(Error{"sun.illuminance_lux must be between 0 and 1e9."});
            }
        }
        if (!(std::abs(glm::length(inputs.sun->direction) - 1.0F) < 1e-3F)) {
            return tl::unexpected(Error{"sun.direction must have unit length."});
        }
    }
    const glm::uvec2& columns = inputs.allocated_columns;
    const GridSettings& grid = inputs.settings.grid;
    if (columns != glm::uvec2(0) &&
        (columns.x < grid.width || columns.y < grid.height || columns.x > 1024 || columns.y > 1024)) {
        return tl::unexpected(Error{"allocated_columns must be between the grid's width and height and 1024."});
    }
    for (std::size_t i = 0; i < inputs.lights.size(); ++i) {
        if (const char* const what = complaint(inputs.lights[i])) {
            return tl::unexpected(Error{"lights[" + std::to_string(i) + "]." + what});
        }
    }
    if (auto valid = validate(inputs.fog_particles); !valid) {
        return valid;
    }
    if (inputs.image_size.x == 0 || inputs.image_size.y == 0) {
        return tl::unexpected(Error{"image_size must be at least 1 pixel in both directions."});
    }
    if (!(std::abs(inputs.time_s) <= latest_s)) {
        return tl::unexpected(Error{"time_s must be between -1e10 and 1e10."});
    }
    if (inputs.frame_slot >= slots) {
        return tl::unexpected(Error{"frame_slot must be less than the feature's frames_in_flight."});
    }
    return {};
}

} // namespace tyndall::volumetrics
