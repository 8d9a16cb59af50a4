// The envelope of the fog: extreme values of each thing that a host can set, a picture each, and what is known of it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "samples/precision/scene.hpp"

namespace tyndall::samples {

struct StabilityCase {
    std::string name;      ///< of all cases that vary the same thing
    std::string parameter; ///< what is varied, and its value
    PrecisionScene scene;
    Physics physics; ///< of the exact picture
    /// Radiance along a ray of unit direction to the wall at `length_m`; absent: the reference computes it.
    std::function<glm::dvec3(const reference::Ray& ray, double length_m)> closed_form;
    double near_m = 0.1;         ///< of the camera
    std::optional<double> far_m; ///< absent: infinite
    /// Of the worst pixel's relative error; absent where froxels of this grid cannot hold the picture, and only what
    /// holds of every frame is asked.
    std::optional<double> bound;
    double floor = 1e-3;     ///< of the exact value in that error, in parts of the picture's mean
    double least_mean = 0.0; ///< that the picture's mean counts as: radiance in parts of which darkness is dark
    bool quick = false;      ///< among the few that --quick shows
};

/// All single pictures.
[[nodiscard]] std::vector<StabilityCase> stability_cases();

/// A black wall 32 m before the camera, even fog of albedo 1 between, on a grid of 40 x 23 x 16 froxels; no light.
[[nodiscard]] PrecisionScene fog_before_a_wall(float extinction_per_m);

/// That of point and spot lights.
[[nodiscard]] std::vector<StabilityCase> light_cases();

/// A fog outside the domain, and the parameter that the refusal must name.
struct Refusal {
    std::string parameter;
    volumetrics::Fog fog;
};
[[nodiscard]] std::vector<Refusal> stability_refusals();

/// A value as short as it can be written, its unit behind.
[[nodiscard]] std::string value_text(double value, const std::string& unit = {});

} // namespace tyndall::samples
