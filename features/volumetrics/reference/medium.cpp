#include "features/volumetrics/reference/medium.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "features/volumetrics/reference/density_texels.hpp"
#include "features/volumetrics/reference/noise.hpp"
#include "features/volumetrics/reference/noise_volumes.hpp"
#include "features/volumetrics/reference/quadrature.hpp"

namespace tyndall::volumetrics::reference {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nothing_left = 45.0; ///< e^-45 = 3e-20
constexpr std::size_t most_crossings = 100000;

template <typename Fog>
glm::dvec3 extinction_of(const Fog& fog) {
    return static_cast<double>(fog.extinction_per_m) * glm::dvec3(fog.extinction_color);
}

} // namespace

double henyey_greenstein(double g, double cos_theta) {
    // The sum of two terms that are never negative: no cancellation near g = 1.
    const double denominator = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cos_theta);
    return (1.0 - g * g) / (4.0 * std::numbers::pi * denominator * std::sqrt(denominator));
}

double phase(const PhaseLobe& lobe, double cos_theta) {
    const double g = static_cast<double>(lobe.g);
    const double whole = 4.0 * std::numbers::pi;
    switch (lobe.function) {
    case PhaseFunction::rayleigh: return 0.75 * (1.0 + cos_theta * cos_theta) / whole;
    case PhaseFunction::henyey_greenstein: return henyey_greenstein(g, cos_theta);
    case PhaseFunction::schlick: {
        const double spread = (1.0 - g) + g * (1.0 - cos_theta);
        return (1.0 - g * g) / (whole * spread * spread);
    }
    case PhaseFunction::cornette_shanks:
        return 1.5 * (1.0 + cos_theta * cos_theta) / (2.0 + g * g) * henyey_greenstein(g, cos_theta);
    case PhaseFunction::isotropic: break;
    }
    return 1.0 / whole;
}

double phase(const Medium& medium, double cos_theta) {
    double sum = 0.0;
    double weights = 0.0;
    const PhaseLobes phase_function = phase_of(medium);
    for (const PhaseLobe& lobe : phase_function.all()) {
        sum += static_cast<double>(lobe.weight) * phase(lobe, cos_theta);
        weights += static_cast<double>(lobe.weight);
    }
    return sum / weights;
}

glm::dvec3 scattered_ambient(const Medium& medium, const glm::dvec3& direction) {
    const auto& [y, z, x] = medium.ambient_sh_1;
    const glm::dvec3 order_1 =
        std::sqrt(0.75 / std::numbers::pi) *
        (direction.y * glm::dvec3(y) + direction.z * glm::dvec3(z) + direction.x * glm::dvec3(x));
    if (order_1 == glm::dvec3(0.0)) {
        return glm::dvec3(medium.ambient_radiance);
    }
    const std::array<Interval, 2> halves{Interval{-1.0, 0.0}, Interval{0.0, 1.0}};
    const auto weighted = [&](double cosine) {
        return glm::dvec3(2.0 * std::numbers::pi * cosine * phase(medium, cosine));
    };
    const double mean_cosine = integrate(weighted, halves, {1e-9, 1e-9}).value.x;
    return glm::dvec3(medium.ambient_radiance) + mean_cosine * order_1;
}

double height_integral(double falloff_per_m, double from_m, double to_m, double length_m) {
    const double rise_m = std::abs(to_m - from_m);
    const double low_m = std::fmin(from_m, to_m);
    const double high_m = std::fmax(from_m, to_m);
    if (high_m <= 0.0) {
        return length_m;
    }
    const double below = low_m < 0.0 ? -low_m / rise_m : 0.0; // part of the way that lies below the base
    const double start_m = std::fmax(low_m, 0.0);
    const double x = falloff_per_m * (high_m - start_m);
    const double mean = x == 0.0 ? 1.0 : -std::expm1(-x) / x;
    return length_m * (below + (1.0 - below) * std::exp(-falloff_per_m * start_m) * mean);
}

Fog::Fog(const Medium& medium, double time_s) : medium_(&medium), time_s_(time_s) {
    std::copy_if(medium.volumes.begin(), medium.volumes.end(), std::back_inserter(volumes_), has_inside);
}

Coefficients Fog::changed(Coefficients before, const glm::dvec3& point) const {
    for (const LocalVolume& volume : volumes_) {
        before = blended(volume, before, point);
    }
    const double factor = noise_factor(point);
    return {factor * before.scattering, factor * before.extinction, factor * before.emission};
}

double Fog::end_of_volumes(const Ray& ray) const {
    double end_m = 0.0;
    for (const LocalVolume& volume : volumes_) {
        end_m = std::fmax(end_m, end_of_volume(volume, ray));
    }
    return end_m;
}

double Fog::noise_factor(const glm::dvec3& point) const {
    const DensityNoise& noise = medium_->noise;
    if (noise.amplitude == 0.0F) {
        return 1.0;
    }
    const glm::dvec3 cells = (point - glm::dvec3(noise.wind_m_s) * time_s_) / static_cast<double>(noise.scale_m);
    if (noise.kind == NoiseKind::perlin_worley) {
        const glm::dvec3 detail_cells =
            (point - glm::dvec3(noise.detail_wind_m_s) * time_s_) / static_cast<double>(noise.detail_scale_m);
        const auto coverage = static_cast<double>(noise.coverage);
        const auto most = static_cast<double>(noise.detail);
        const double cover = std::fmax(0.0, 1.0 - (1.0 - NoiseVolume::shape().at(cells / 4.0)) / coverage);
        const double eroded = most * NoiseVolume::detail().at(detail_cells / 4.0);
        const double left = std::fmax(0.0, cover - eroded) / (1.0 - eroded);
        const double mean = coverage * (2.0 - most) / 4.0;
        return 1.0 - static_cast<double>(noise.amplitude) * (1.0 - left / mean);
    }
    return 1.0 + static_cast<double>(noise.amplitude) * octave_noise(cells, noise.octaves, noise.gain);
}

double Fog::height_profile(const glm::dvec3& point) const {
    const double above_m = std::fmax(0.0, point.y - static_cast<double>(medium_->height.base_height_m));
    return std::exp(-static_cast<double>(medium_->height.falloff_per_m) * above_m);
}

Coefficients Fog::at(const glm::dvec3& point) const {
    const HomogeneousFog& homogeneous = medium_->homogeneous;
    const HeightFog& height = medium_->height;
    const double kept = map_density(medium_->map, point);
    const double here = kept * height_profile(point);
    const glm::dvec3 even = kept * extinction_of(homogeneous);
    const glm::dvec3 low = here * extinction_of(height);
    const Coefficients everywhere{even * glm::dvec3(homogeneous.albedo) + low * glm::dvec3(height.albedo), even + low,
                                  kept * glm::dvec3(homogeneous.emission_per_m) +
                                      here * glm::dvec3(height.emission_per_m)};
    return changed(everywhere, point);
}

bool Fog::emits() const {
    const glm::vec3 none(0.0F);
    return medium_->homogeneous.emission_per_m != none || medium_->height.emission_per_m != none ||
           std::any_of(volumes_.begin(), volumes_.end(),
                       [&](const LocalVolume& volume) { return volume.emission_per_m != none; });
}

Coefficients Fog::ending_at(const glm::dvec3& point, const glm::dvec3& direction) const {
    const double profile = ends_toward(direction) ? map_density(medium_->map, point) * height_profile(point) : 0.0;
    const glm::dvec3 height = profile * extinction_of(medium_->height);
    return changed({.scattering = height * glm::dvec3(medium_->height.albedo), .extinction = height}, point);
}

glm::dvec3 Fog::closed_optical_depth(const Ray& ray, double length_m) const {
    const auto times = [](const glm::dvec3& extinction, double way_m) { // nothing over an endless way is nothing
        glm::dvec3 depth(0.0);
        for (int c = 0; c < 3; ++c) {
            depth[c] = extinction[c] > 0.0 ? extinction[c] * way_m : 0.0;
        }
        return depth;
    };
    const auto falloff = static_cast<double>(medium_->height.falloff_per_m);
    glm::dvec3 sum = times(extinction_of(medium_->homogeneous), length_m);
    const glm::dvec3 height = extinction_of(medium_->height);
    if (medium_->height.extinction_per_m > 0.0F) {
        const double from_m = ray.origin.y - static_cast<double>(medium_->height.base_height_m);
        if (length_m < infinity) {
            sum += times(height, height_integral(falloff, from_m, from_m + ray.direction.y * length_m, length_m));
        } else if (ends_toward(ray.direction)) {
            const double below_m = std::fmax(0.0, -from_m);
            const double above = std::exp(-falloff * std::fmax(0.0, from_m)) / falloff;
            sum += times(height, (below_m + above) / ray.direction.y);
        } else {
            sum += times(height, infinity);
        }
    }
    return sum;
}

glm::dvec3 Fog::closed_optical_depth_of_sky(const Ray& ray) const {
    if (!ends_toward(ray.direction)) {
        return glm::dvec3(0.0);
    }
    Medium ending = *medium_;
    ending.homogeneous.extinction_per_m = 0.0F;
    return Fog(ending, time_s_).closed_optical_depth(ray, infinity);
}

double Fog::end_of_ending(const Ray& ray) const {
    return std::fmax(ends_toward(ray.direction) ? top_of_height_fog(ray) : 0.0, end_of_volumes(ray));
}

bool Fog::ends_toward(const glm::dvec3& direction) const {
    return direction.y > 0.0 && medium_->height.falloff_per_m > 0.0F;
}

double Fog::top_of_height_fog(const Ray& ray) const {
    if (!ends_toward(ray.direction)) {
        return infinity;
    }
    const double top_m = static_cast<double>(medium_->height.base_height_m) +
                         nothing_left / static_cast<double>(medium_->height.falloff_per_m);
    return std::fmax(0.0, (top_m - ray.origin.y) / ray.direction.y);
}

double Fog::end_along(const Ray& ray) const {
    const glm::vec3 none(0.0F);
    const Medium& medium = *medium_;
    if (medium.homogeneous.extinction_per_m > 0.0F || medium.homogeneous.emission_per_m != none) {
        return infinity;
    }
    const bool is_high = medium.height.extinction_per_m > 0.0F || medium.height.emission_per_m != none;
    return std::fmax(is_high ? top_of_height_fog(ray) : 0.0, end_of_volumes(ray));
}

void Fog::add_breaks(const Ray& ray, Interval part, std::vector<double>& breaks) const {
    const auto add = [&](double distance_m) {
        if (distance_m > part.begin && distance_m < part.end) {
            breaks.push_back(distance_m);
        }
    };
    if ((medium_->height.extinction_per_m > 0.0F || emits()) && ray.direction.y != 0.0) {
        for (const double depths : {0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, nothing_left}) {
            const double height_m = static_cast<double>(medium_->height.base_height_m) +
                                    depths / static_cast<double>(medium_->height.falloff_per_m);
            add((height_m - ray.origin.y) / ray.direction.y); // not a number without falloff: not added
        }
    }
    for (const LocalVolume& volume : volumes_) {
        add_volume_breaks(volume, ray, part, breaks);
    }
    const DensityMap& map = medium_->map;
    if (map.texels && ray.direction.y != 0.0) {
        for (const float height_m : {map.bottom_m, map.bottom_m + map.fade_m, map.top_m - map.fade_m, map.top_m}) {
            add((static_cast<double>(height_m) - ray.origin.y) / ray.direction.y);
        }
    }
}

void Fog::add_seams(const Ray& ray, Interval part, std::vector<double>& seams) const {
    const auto add_texels = [&](const DensityTexels& texels, const glm::dvec3& place, const glm::dvec3& way) {
        const glm::dvec3 size(texels.size());
        add_lattice_crossings(place * size - 0.5, way * size, part, most_crossings, seams);
    };
    for (const LocalVolume& volume : volumes_) {
        if (volume.density) {
            add_texels(*volume.density, place_in_grid(volume, ray.origin), way_in_grid(volume, ray.direction));
        }
    }
    if (const DensityMap& map = medium_->map; map.texels) {
        const glm::dvec3 size_m(map.size_m.x, map.size_m.y, 1.0);
        const glm::dvec3 from(ray.origin.x - static_cast<double>(map.center_m.x),
                              ray.origin.z - static_cast<double>(map.center_m.y), 0.0);
        add_texels(*map.texels, from / size_m + 0.5, glm::dvec3(ray.direction.x, ray.direction.z, 0.0) / size_m);
    }
    const DensityNoise& noise = medium_->noise;
    if (noise.amplitude > 0.0F && noise.kind == NoiseKind::perlin_worley) {
        // Between planes through the texels' centres the volumes are polynomials.
        const auto add = [&](const NoiseVolume& volume, double cell_m, const glm::vec3& wind_m_s) {
            const double texel_m = 4.0 * cell_m / volume.size();
            const glm::dvec3 origin = (ray.origin - glm::dvec3(wind_m_s) * time_s_) / texel_m - 0.5;
            add_lattice_crossings(origin, ray.direction / texel_m, part, most_crossings, seams);
        };
        add(NoiseVolume::shape(), static_cast<double>(noise.scale_m), noise.wind_m_s);
        add(NoiseVolume::detail(), static_cast<double>(noise.detail_scale_m), noise.detail_wind_m_s);
    } else if (noise.amplitude > 0.0F) {
        const auto scale_m = static_cast<double>(noise.scale_m);
        glm::dvec3 origin = (ray.origin - glm::dvec3(noise.wind_m_s) * time_s_) / scale_m;
        glm::dvec3 direction = ray.direction / scale_m;
        for (std::uint32_t octave = 0; octave < noise.octaves; ++octave) {
            add_lattice_crossings(origin, direction, part, most_crossings, seams);
            origin = next_octave(origin);
            direction *= 2.0;
        }
    }
}

} // namespace tyndall::volumetrics::reference
