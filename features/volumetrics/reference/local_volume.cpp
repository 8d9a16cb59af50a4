#include "features/volumetrics/reference/local_volume.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vector_relational.hpp>

#include "features/volumetrics/reference/density_texels.hpp"

namespace tyndall::volumetrics::reference {
namespace {

/// A direction of the world in the space where the shape reaches from -1 to 1.
glm::dvec3 in_shape(const LocalVolume& volume, const glm::dvec3& direction) {
    return glm::conjugate(glm::normalize(glm::dquat(volume.rotation))) * direction / glm::dvec3(volume.half_size_m);
}

/// From 0 at the surface to 1 where the edge ends; `inside` is 1 less the distance from the centre, in that space.
double ramp(const LocalVolume& volume, double inside) {
    if (!(inside > 0.0)) {
        return 0.0;
    }
    return volume.edge > 0.0F ? std::fmin(1.0, inside / static_cast<double>(volume.edge)) : 1.0;
}

double weight(const LocalVolume& volume, const glm::dvec3& point) {
    const glm::dvec3 q = in_shape(volume, point - glm::dvec3(volume.center_m));
    if (volume.shape == VolumeShape::ellipsoid) {
        return ramp(volume, 1.0 - glm::length(q));
    }
    return ramp(volume, 1.0 - std::abs(q.x)) * ramp(volume, 1.0 - std::abs(q.y)) * ramp(volume, 1.0 - std::abs(q.z));
}

Coefficients scaled(const Coefficients& c, const glm::dvec3& factor) {
    return {factor * c.scattering, factor * c.extinction, factor * c.emission};
}

} // namespace

bool has_inside(const LocalVolume& volume) {
    return std::min({volume.half_size_m.x, volume.half_size_m.y, volume.half_size_m.z}) > 0.0F;
}

glm::dvec3 way_in_grid(const LocalVolume& volume, const glm::dvec3& direction) {
    return 0.5 * in_shape(volume, direction);
}

glm::dvec3 place_in_grid(const LocalVolume& volume, const glm::dvec3& point) {
    return 0.5 + way_in_grid(volume, point - glm::dvec3(volume.center_m));
}

Coefficients blended(const LocalVolume& volume, const Coefficients& before, const glm::dvec3& point) {
    double w = weight(volume, point);
    if (!(w > 0.0)) {
        return before;
    }
    if (volume.density) {
        w *= density_at(*volume.density, place_in_grid(volume, point), false);
    }
    const glm::dvec3 amount = w * static_cast<double>(volume.extinction_per_m) * glm::dvec3(volume.extinction_color);
    const Coefficients own{amount * glm::dvec3(volume.albedo), amount, w * glm::dvec3(volume.emission_per_m)};
    switch (volume.blend) {
    case VolumeBlend::subtract: {
        glm::dvec3 left(1.0);
        for (int c = 0; c < 3; ++c) {
            left[c] = amount[c] > 0.0 ? std::fmax(0.0, 1.0 - amount[c] / before.extinction[c]) : 1.0;
        }
        return scaled(before, left);
    }
    case VolumeBlend::multiply: return scaled(before, glm::dvec3(1.0 + w * (static_cast<double>(volume.factor) - 1.0)));
    case VolumeBlend::max: {
        const glm::dvec3 keeps(glm::lessThanEqual(amount, before.extinction));
        const Coefficients kept = scaled(before, keeps);
        const Coefficients taken = scaled(own, 1.0 - keeps);
        return {kept.scattering + taken.scattering, kept.extinction + taken.extinction, kept.emission + taken.emission};
    }
    case VolumeBlend::add: break;
    }
    return {before.scattering + own.scattering, before.extinction + own.extinction, before.emission + own.emission};
}

void add_volume_breaks(const LocalVolume& volume, const Ray& ray, Interval part, std::vector<double>& breaks) {
    const glm::dvec3 from = in_shape(volume, ray.origin - glm::dvec3(volume.center_m));
    const glm::dvec3 along = in_shape(volume, ray.direction);
    const auto add = [&](double distance_m) {
        if (distance_m > part.begin && distance_m < part.end) {
            breaks.push_back(distance_m);
        }
    };
    const double edge_end = 1.0 - static_cast<double>(volume.edge);
    if (volume.shape == VolumeShape::ellipsoid) {
        const double squared = glm::dot(along, along);
        const double nearest = -glm::dot(from, along) / squared;
        const glm::dvec3 offset = from + nearest * along;
        add(nearest);
        for (const double radius : {1.0, edge_end}) {
            const double reach = std::sqrt((radius * radius - glm::dot(offset, offset)) / squared);
            add(nearest - reach); // not a number where the ray passes by: not added
            add(nearest + reach);
        }
        return;
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (const double plane : {-1.0, -edge_end, 0.0, edge_end, 1.0}) {
            add((plane - from[axis]) / along[axis]); // infinite where it runs beside the plane: not added
        }
    }
}

double end_of_volume(const LocalVolume& volume, const Ray& ray) {
    const glm::dvec3 way = glm::dvec3(volume.center_m) - ray.origin;
    const double nearest = glm::dot(way, ray.direction);
    const glm::dvec3 offset = way - nearest * ray.direction;
    const glm::dvec3 half(volume.half_size_m);
    const double reach_squared = glm::dot(half, half) - glm::dot(offset, offset);
    return reach_squared > 0.0 ? std::fmax(0.0, nearest + std::sqrt(reach_squared)) : 0.0;
}

} // namespace tyndall::volumetrics::reference
