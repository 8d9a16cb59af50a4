#include "features/volumetrics/medium.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "features/volumetrics/range_check.hpp"

namespace tyndall::volumetrics {
namespace {

void check_lobes(const PhaseLobes& phase, RangeCheck& check) {
    check.in_range("The number of phase.lobes", phase.count, 0.0, PhaseLobes::most);
    if (phase.count == 0 || phase.count > PhaseLobes::most) {
        return;
    }
    double weights = 0.0;
    for (std::uint32_t i = 0; i < phase.count; ++i) {
        const std::string key = "phase.lobes[" + std::to_string(i) + "].";
        check.in_range(key + "g", phase.lobes[i].g, -0.999F, 0.999F);
        check.in_range(key + "weight", phase.lobes[i].weight, 0.0, 1.0);
        weights += static_cast<double>(phase.lobes[i].weight);
    }
    check.in_range("The sum of phase.lobes' weights", weights, 1e-3, PhaseLobes::most);
}

/// Radiance is nowhere negative; a part in a million of grace for what was rounded in the file.
void check_ambient(const Medium& medium, RangeCheck& check) {
    const glm::vec3 length = ambient_length(medium);
    for (int channel = 0; channel < 3; ++channel) {
        const double radiance = static_cast<double>(medium.ambient_radiance[channel]);
        check.in_range("The length of ambient.sh_1 in channel " + std::to_string(channel) +
                           " (at most ambient.radiance / 0.488603)",
                       length[channel], 0.0, radiance / sh_1_constant * 1.000001);
    }
}

void check_volumes(const Medium& medium, RangeCheck& check) {
    check.in_range("The number of medium.volumes", static_cast<double>(medium.volumes.size()), 0.0, LocalVolume::most);
    for (std::size_t i = 0; i < medium.volumes.size(); ++i) {
        const LocalVolume& volume = medium.volumes[i];
        const std::string key = "medium.volumes[" + std::to_string(i) + "].";
        check.in_range(key + "center_m", volume.center_m, -1e6, 1e6);
        check.in_range(key + "half_size_m", volume.half_size_m, 0.0, 1e6);
        check.in_range("The length of " + key + "rotation", glm::length(volume.rotation), 0.999, 1.001);
        check.in_range(key + "edge", volume.edge, 0.0, 1.0);
        check.in_range(key + "extinction_per_m", volume.extinction_per_m, 0.0, 1e6);
        check.in_range(key + "extinction_color", volume.extinction_color, 0.0, 1.0);
        check.in_range(key + "factor", volume.factor, 0.0, 1e3);
        check.in_range(key + "albedo", volume.albedo, 0.0, 1.0);
        check.in_range(key + "emission_per_m", volume.emission_per_m, 0.0, 1e9);
    }
    check.in_range("The number of different densities of medium.volumes", static_cast<double>(grids_of(medium).size()),
                   0.0, LocalVolume::most_grids);
    check.in_range("The extinction that medium.volumes can add up to", extinction_bound(medium), 0.0, 1e9);
    check.in_range("The emission that medium.volumes can add up to", emission_bound(medium), 0.0, 1e12);
}

bool has_inside(const LocalVolume& volume) {
    return volume.half_size_m.x > 0.0F && volume.half_size_m.y > 0.0F && volume.half_size_m.z > 0.0F;
}

float largest(const glm::vec3& v) {
    return std::max({v.x, v.y, v.z});
}

} // namespace

PhaseLobes phase_of(const Medium& medium) {
    if (medium.phase_lobes.count > 0) {
        return medium.phase_lobes;
    }
    PhaseLobes one{.count = 1};
    one.lobes[0] = {.function = PhaseFunction::henyey_greenstein, .g = medium.phase_g};
    return one;
}

glm::vec3 ambient_length(const Medium& medium) {
    glm::vec3 squares(0.0F);
    for (const glm::vec3& coefficient : medium.ambient_sh_1) {
        squares += coefficient * coefficient;
    }
    return {std::sqrt(squares.x), std::sqrt(squares.y), std::sqrt(squares.z)};
}

bool is_directed(const Medium& medium) {
    const glm::vec3 none(0.0F);
    const auto& sh = medium.ambient_sh_1;
    return mean_cosine(phase_of(medium)) != 0.0 && (sh[0] != none || sh[1] != none || sh[2] != none);
}

std::vector<std::shared_ptr<const DensityTexels>> grids_of(const Medium& medium) {
    std::vector<std::shared_ptr<const DensityTexels>> grids;
    for (const LocalVolume& volume : medium.volumes) {
        if (volume.density && has_inside(volume) &&
            std::find(grids.begin(), grids.end(), volume.density) == grids.end()) {
            grids.push_back(volume.density);
        }
    }
    return grids;
}

float mean_of_map(const Medium& medium) {
    return medium.map.texels ? static_cast<float>(medium.map.texels->mean()) : 1.0F;
}

glm::dvec2 heights_of_map(const Medium& medium) {
    if (!medium.map.texels) {
        return {-1e20, 1e20};
    }
    const auto bottom_m = static_cast<double>(medium.map.bottom_m);
    const auto top_m = static_cast<double>(medium.map.top_m);
    const auto fade_m = static_cast<double>(medium.map.fade_m);
    const double high_m = top_m - bottom_m;
    // Integral of min(1, y / fade) min(1, (high - y) / fade): the two may overlap, and each may be all that there is.
    double column_m = high_m - fade_m;
    if (high_m < fade_m) {
        column_m = high_m * high_m * high_m / (6.0 * fade_m * fade_m);
    } else if (high_m < 2.0 * fade_m) {
        const double alone_m = high_m - fade_m;
        const auto overlap = [&](double y) { return y * y * (0.5 * high_m - y / 3.0) / (fade_m * fade_m); };
        column_m = alone_m * alone_m / fade_m + overlap(fade_m) - overlap(alone_m);
    }
    const double middle_m = 0.5 * (bottom_m + top_m);
    return {middle_m - 0.5 * column_m, middle_m + 0.5 * column_m};
}

bool is_colored(const Medium& medium) {
    const auto differs = [](const auto& fog) {
        return fog.extinction_per_m > 0.0F && fog.extinction_color != glm::vec3(1.0F);
    };
    return differs(medium.homogeneous) || differs(medium.height) ||
           std::any_of(medium.volumes.begin(), medium.volumes.end(), [&](const LocalVolume& volume) {
               return has_inside(volume) && volume.blend != VolumeBlend::multiply && differs(volume);
           });
}

float extinction_bound(const Medium& medium) {
    float bound = medium.homogeneous.extinction_per_m + medium.height.extinction_per_m;
    for (const LocalVolume& volume : medium.volumes) {
        if (!has_inside(volume)) {
            continue;
        }
        switch (volume.blend) {
        case VolumeBlend::add: bound += volume.extinction_per_m; break;
        case VolumeBlend::max: bound = std::max(bound, volume.extinction_per_m); break;
        case VolumeBlend::multiply: bound *= std::max(volume.factor, 1.0F); break;
        case VolumeBlend::subtract: break;
        }
    }
    return bound;
}

float emission_bound(const Medium& medium) {
    float bound = largest(medium.homogeneous.emission_per_m) + largest(medium.height.emission_per_m);
    for (const LocalVolume& volume : medium.volumes) {
        if (!has_inside(volume)) {
            continue;
        }
        switch (volume.blend) {
        case VolumeBlend::add:
        case VolumeBlend::max: bound += largest(volume.emission_per_m); break;
        case VolumeBlend::multiply: bound *= std::max(volume.factor, 1.0F); break;
        case VolumeBlend::subtract: break;
        }
    }
    return bound;
}

double emitted_radiance_bound(const Medium& medium, double length_m) {
    // Of a medium of emission e and extinction s, at most e times the way through it, and at most e / s: what subtracts
    // or multiplies leaves that quotient as it is.
    double bound = 0.0;
    double factor = 1.0;
    const auto add = [&](const glm::vec3& emission_per_m, const glm::vec3& extinction_per_m, double way_m) {
        double brightest = 0.0;
        for (int c = 0; c < 3; ++c) {
            const auto emission = static_cast<double>(emission_per_m[c]);
            const double unweakened = emission * way_m;
            const auto extinction = static_cast<double>(extinction_per_m[c]);
            brightest = std::max(brightest, unweakened * extinction > emission ? emission / extinction : unweakened);
        }
        bound += brightest;
    };
    for (const LocalVolume& volume : medium.volumes) {
        if (!has_inside(volume)) {
            continue;
        }
        if (volume.blend == VolumeBlend::multiply) {
            factor *= std::max(1.0, static_cast<double>(volume.factor));
        } else if (volume.blend != VolumeBlend::subtract) {
            const double way_m = std::min(length_m, 2.0 * static_cast<double>(glm::length(volume.half_size_m)));
            add(volume.emission_per_m, volume.extinction_per_m * volume.extinction_color, way_m);
        }
    }
    add(medium.homogeneous.emission_per_m, medium.homogeneous.extinction_per_m * medium.homogeneous.extinction_color,
        length_m);
    add(medium.height.emission_per_m, glm::vec3(0.0F), length_m);
    return bound * factor;
}

bool is_empty(const Medium& medium) {
    return extinction_bound(medium) <= 0.0F && emission_bound(medium) <= 0.0F;
}

tl::expected<void, Error> validate(const Medium& medium) {
    RangeCheck check;
    check.in_range("medium.homogeneous.extinction_per_m", medium.homogeneous.extinction_per_m, 0.0, 1e6);
    check.in_range("medium.homogeneous.extinction_color", medium.homogeneous.extinction_color, 0.0, 1.0);
    check.in_range("medium.homogeneous.albedo", medium.homogeneous.albedo, 0.0, 1.0);
    check.in_range("medium.homogeneous.emission_per_m", medium.homogeneous.emission_per_m, 0.0, 1e9);
    check.in_range("medium.height.extinction_per_m", medium.height.extinction_per_m, 0.0, 1e6);
    check.in_range("medium.height.extinction_color", medium.height.extinction_color, 0.0, 1.0);
    check.in_range("medium.height.albedo", medium.height.albedo, 0.0, 1.0);
    check.in_range("medium.height.emission_per_m", medium.height.emission_per_m, 0.0, 1e9);
    check.in_range("medium.height.base_height_m", medium.height.base_height_m, -1e6, 1e6);
    check.in_range("medium.height.falloff_per_m", medium.height.falloff_per_m, 0.0, 1e3);
    check_noise(medium.noise, check);
    check_map(medium.map, check);
    check.in_range("phase.g", medium.phase_g, -0.999F, 0.999F);
    check.in_range("ambient.radiance", medium.ambient_radiance, 0.0, 1e9);
    check_lobes(medium.phase_lobes, check);
    check_volumes(medium, check);
    check_ambient(medium, check);
    return check.result();
}

} // namespace tyndall::volumetrics
