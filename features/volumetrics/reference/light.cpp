#include "features/volumetrics/reference/light.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

namespace tyndall::volumetrics::reference {
namespace {

/// No source is smaller (the engine's limit, m).
constexpr double smallest_radius_m = 0.005;

double radius_of(const Light& light) {
    return std::max(light.radius_m, smallest_radius_m);
}

/// KHR_lights_punctual, "Inner and Outer Cone Angles": the cosine grows from 0 to 1 over at least a thousandth.
double cosine_span(const Cone& cone) {
    return std::max(0.001, std::cos(cone.inner_rad) - std::cos(cone.outer_rad));
}

/// Roots of a t^2 + 2 b t + c, ascending.
std::optional<std::pair<double, double>> roots(double a, double b, double c) {
    const double discriminant = b * b - a * c;
    if (a == 0.0 || !(discriminant >= 0.0)) {
        return std::nullopt;
    }
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    const double first = q / a;
    const double second = q == 0.0 ? first : c / q;
    return std::minmax(first, second);
}

std::optional<std::pair<double, double>> sphere(const Ray& ray, const glm::dvec3& centre, double radius_m) {
    // About the foot of the centre, where nothing cancels.
    const double foot = glm::dot(centre - ray.origin, ray.direction);
    const double height = glm::length(point_at(ray, foot) - centre);
    if (!(height < radius_m)) {
        return std::nullopt;
    }
    const double half = std::sqrt((radius_m - height) * (radius_m + height));
    return std::pair{foot - half, foot + half};
}

} // namespace

glm::dvec3 irradiance(const Light& light, const glm::dvec3& point) {
    const glm::dvec3 way = point - light.position;
    const double distance_m = glm::length(way);
    if (distance_m >= light.range_m) {
        return glm::dvec3(0.0);
    }
    const double near_m = std::max(distance_m, radius_of(light));
    double factor = (1.0 - std::pow(distance_m / light.range_m, 4.0)) / (near_m * near_m);
    if (light.cone && distance_m > 0.0) {
        const double cosine = glm::dot(way, light.cone->direction) / distance_m;
        const double ramp = (cosine - std::cos(light.cone->outer_rad)) / cosine_span(*light.cone);
        const double inside = std::clamp(ramp, 0.0, 1.0);
        factor *= inside * inside;
    }
    return factor * light.intensity_cd;
}

std::optional<Interval> within_range(const Light& light, const Ray& ray, Interval part) {
    if (!std::isfinite(light.range_m)) {
        return part;
    }
    const auto cut = sphere(ray, light.position, light.range_m);
    if (!cut) {
        return std::nullopt;
    }
    const Interval inside{std::max(part.begin, cut->first), std::min(part.end, cut->second)};
    return inside.begin < inside.end ? std::optional(inside) : std::nullopt;
}

void add_light_breaks(const Light& light, const Ray& ray, std::vector<double>& breaks) {
    const auto add = [&](const std::optional<std::pair<double, double>>& pair) {
        if (pair) {
            breaks.push_back(pair->first);
            breaks.push_back(pair->second);
        }
    };
    add(sphere(ray, light.position, radius_of(light)));
    if (!light.cone) {
        return;
    }
    const glm::dvec3 from = ray.origin - light.position;
    const double cos_outer = std::cos(light.cone->outer_rad);
    for (const double cosine : {cos_outer, cos_outer + cosine_span(*light.cone)}) {
        // (p . axis)^2 = cosine^2 p . p
        const double axis_direction = glm::dot(ray.direction, light.cone->direction);
        const double axis_from = glm::dot(from, light.cone->direction);
        const double squared = cosine * cosine;
        add(roots(axis_direction * axis_direction - squared,
                  axis_direction * axis_from - squared * glm::dot(ray.direction, from),
                  axis_from * axis_from - squared * glm::dot(from, from)));
    }
}

} // namespace tyndall::volumetrics::reference
