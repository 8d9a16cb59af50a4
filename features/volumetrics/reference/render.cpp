#include "features/volumetrics/reference/render.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <numbers>
#include <random>
#include <thread>
#include <utility>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "features/volumetrics/reference/light.hpp"
#include "features/volumetrics/reference/optical_depth.hpp"

namespace tyndall::volumetrics::reference {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// What an optical depth may be off, for the integral around it not to see it.
double inner(const Tolerance& tolerance) {
    return 0.1 * tolerance.relative;
}

/// One eye ray's way through the medium, and the integrals of what each source adds along it.
class Airlight {
public:
    Airlight(const Scene& scene, const Ray& ray, double length_m, const Tolerance& tolerance)
        : scene_(scene), ray_(ray), tolerance_(tolerance), fog_(scene.medium, scene.time_s),
          path_(fog_, ray, length_m, inner(tolerance)) {}

    [[nodiscard]] Estimate sum() {
        if (!(path_.end() > 0.0)) {
            return {};
        }
        if (has_inner_integrals()) {
            // A rough sum first tells which of them are worth the effort.
            const Tolerance wanted = std::exchange(tolerance_, {std::max(tolerance_.relative, 1e-2), 0.0});
            add_sources();
            scale_ = largest(sum_.value) / static_cast<double>(1 + scene_.lights.size());
            tolerance_ = wanted;
            sum_ = {};
        }
        add_sources();
        sum_.error += sum_.value * path_.error();
        return sum_;
    }

private:
    void add_sources() {
        add_emission();
        add_ambient();
        if (scene_.sun) {
            add_sun(*scene_.sun);
        }
        for (const Light& light : scene_.lights) {
            add_light(light);
        }
    }

    /// Whether each node asks for an integral along the light's way.
    [[nodiscard]] bool has_inner_integrals() const { return !fog_.is_closed() && scene_.attenuates_light; }

    /// Radiance gained per metre and per unit of in-scattered radiance, as the eye sees it.
    [[nodiscard]] glm::dvec3 seen(double distance_m) const {
        return fog_.at(point_at(ray_, distance_m)).scattering * glm::exp(-path_.optical_depth(distance_m));
    }

    /// Half of the error that the whole may have; of a dim source, as much as of the others.
    [[nodiscard]] Tolerance tolerance() const {
        const double relative = 0.5 * tolerance_.relative;
        const double others = std::max(scale_, largest(sum_.value) / static_cast<double>(1 + scene_.lights.size()));
        return {relative, std::max(tolerance_.absolute, relative * others), tolerance_.most_pieces};
    }

    /// The error wanted of a node's optical depth toward the light: what weighs little may be off more. The integrand
    /// would be `unweakened` without it, over a span of `span`. In all the integral is then off by no more than `inner`
    /// of itself and of the scale.
    [[nodiscard]] double wanted(const glm::dvec3& unweakened, double span) const {
        const double weight = largest(unweakened) * span;
        return std::min(0.5, inner(tolerance_) * std::max(1.0, weight > 0.0 ? scale_ / weight : 1.0));
    }

    /// Adds an integral with a light's way in it.
    void add_weakened(Estimate estimate) {
        if (has_inner_integrals()) {
            // e^0.5 bounds what the curvature of the exponential adds.
            estimate.error += 1.7 * inner(tolerance_) * (estimate.value + scale_);
        }
        sum_ += estimate;
    }

    void add_emission() {
        const auto integrand = [&](double t) {
            return fog_.at(point_at(ray_, t)).emission * glm::exp(-path_.optical_depth(t));
        };
        if (fog_.emits()) {
            sum_ += integral({Interval{0.0, path_.end()}}, {}, std::identity(), integrand);
        }
    }

    void add_ambient() {
        const glm::dvec3 ambient = scattered_ambient(scene_.medium, ray_.direction);
        if (largest(ambient) > 0.0) {
            const auto integrand = [&](double t) { return ambient * seen(t); };
            sum_ += integral({Interval{0.0, path_.end()}}, {}, std::identity(), integrand);
        }
    }

    void add_sun(const DirectionalLight& sun) {
        const glm::dvec3 to_sun = -sun.direction;
        const glm::dvec3 scattered =
            sun.illuminance_lux * phase(scene_.medium, glm::dot(sun.direction, -ray_.direction));
        const auto integrand = [&](double t) {
            glm::dvec3 light = scattered * seen(t);
            if (scene_.attenuates_light) {
                const Ray way{point_at(ray_, t), to_sun};
                light *= glm::exp(-optical_depth_of_sky(fog_, way, wanted(light, path_.end())).value);
            }
            return light;
        };
        const Interval whole{0.0, path_.end()};
        const std::vector<Interval> lit =
            sun.casts_shadows ? scene_.geometry.lit_from_direction(ray_, whole, to_sun) : std::vector{whole};
        add_weakened(integral(lit, {}, std::identity(), integrand));
    }

    /// In the angle under which the light sees the ray (Kulla and Fajardo 2012, "equi-angular"): with t = h tan(phi),
    /// dt / d^2 is dphi / h, and nothing is left of the pole.
    void add_light(const Light& light) {
        const std::optional<Interval> reach = within_range(light, ray_, {0.0, path_.end()});
        if (!reach) {
            return;
        }
        const double foot = glm::dot(light.position - ray_.origin, ray_.direction);
        const double height =
            std::max(glm::length(light.position - point_at(ray_, foot)), std::max(light.radius_m, 1e-3));
        const auto angle = [&](double t) { return std::atan2(t - foot, height); };
        const double span = angle(reach->end) - angle(reach->begin);
        const auto integrand = [&](double phi) {
            const double offset = height * std::tan(phi);
            const glm::dvec3 point = point_at(ray_, foot + offset);
            const glm::dvec3 way = point - light.position;
            const double distance_m = glm::length(way);
            const double jacobian = height + offset * (offset / height);
            const double cosine = distance_m > 0.0 ? -glm::dot(way, ray_.direction) / distance_m : 0.0;
            glm::dvec3 lit = irradiance(light, point) * seen(foot + offset) * phase(scene_.medium, cosine);
            if (scene_.attenuates_light && distance_m > 0.0 && largest(lit) > 0.0) {
                const Ray from_light{light.position, way / distance_m};
                const double wanted_depth = wanted(lit * jacobian, span);
                lit *= glm::exp(-optical_depth(fog_, from_light, distance_m, wanted_depth).value);
            }
            return lit * jacobian;
        };
        std::vector<double> breaks{foot};
        add_light_breaks(light, ray_, breaks);
        const std::vector<Interval> lit =
            light.casts_shadows ? scene_.geometry.lit_from_point(ray_, *reach, light.position) : std::vector{*reach};
        add_weakened(integral(lit, std::move(breaks), angle, integrand));
    }

    /// Integral over all of `lit` at once, so that parts with little in them are not refined in vain. The integrand is
    /// a function of `variable` of the distance, smooth between `breaks` and the path's own.
    template <class Variable, class Integrand>
    [[nodiscard]] Estimate integral(const std::vector<Interval>& lit, std::vector<double> breaks,
                                    const Variable& variable, const Integrand& integrand) const {
        breaks.insert(breaks.end(), path_.breaks().begin(), path_.breaks().end());
        std::vector<Interval> parts;
        for (const Interval& part : lit) {
            append_cut(part, breaks, variable, parts);
        }
        std::vector<double> seams = path_.seams();
        std::transform(seams.begin(), seams.end(), seams.begin(), variable);
        return integrate(integrand, parts, tolerance(), seams);
    }

    const Scene& scene_;
    const Ray& ray_;
    Tolerance tolerance_;
    Fog fog_;
    EyePath path_;
    Estimate sum_;
    double scale_ = 0.0; ///< roughly, a source's share of the sum; 0 where it is not needed
};

/// Where rays from a surface start: off it, as single precision needs.
glm::dvec3 lifted(const SurfacePoint& point) {
    const glm::dvec3 p = glm::abs(point.position);
    return point.position + point.normal * (2e-6 * std::max(1.0, largest(p)));
}

/// Irradiance of the surface from direction `to_light` where `normal_irradiance` arrives in empty space.
Estimate received(const SurfacePoint& point, const glm::dvec3& to_light, const glm::dvec3& normal_irradiance,
                  const Estimate& depth) {
    const glm::dvec3 arrives = normal_irradiance * glm::dot(point.normal, to_light) * glm::exp(-depth.value);
    return {arrives, arrives * depth.error};
}

bool faces(const SurfacePoint& point, const glm::dvec3& to_light) {
    return glm::dot(point.normal, to_light) > 0.0;
}

Estimate from_sun(const Scene& scene, const Fog& fog, const DirectionalLight& sun, const SurfacePoint& point,
                  const Tolerance& tolerance) {
    const Ray ray{lifted(point), -sun.direction};
    if (!faces(point, ray.direction) || (sun.casts_shadows && scene.geometry.is_blocked(ray, infinity))) {
        return {};
    }
    const Estimate depth = scene.attenuates_light
                               ? optical_depth_of_sky(fog, {point.position, ray.direction}, inner(tolerance))
                               : Estimate{};
    return received(point, ray.direction, sun.illuminance_lux, depth);
}

Estimate from_light(const Scene& scene, const Fog& fog, const Light& light, const SurfacePoint& point,
                    const Tolerance& tolerance) {
    const glm::dvec3 way = light.position - point.position;
    const double distance_m = glm::length(way);
    const glm::dvec3 arrives = irradiance(light, point.position);
    if (!(distance_m > 0.0) || !(largest(arrives) > 0.0) || !faces(point, way)) {
        return {};
    }
    const glm::dvec3 to_light = way / distance_m;
    const glm::dvec3 start = lifted(point);
    const double rest_m = glm::length(light.position - start);
    if (light.casts_shadows &&
        scene.geometry.is_blocked({start, (light.position - start) / rest_m}, rest_m * (1.0 - 1e-6))) {
        return {};
    }
    const Estimate depth = scene.attenuates_light
                               ? optical_depth(fog, {point.position, to_light}, distance_m, inner(tolerance))
                               : Estimate{};
    return received(point, to_light, arrives, depth);
}

} // namespace

Estimate airlight(const Scene& scene, const Ray& ray, double length_m, const Tolerance& tolerance) {
    return Airlight(scene, ray, length_m, tolerance).sum();
}

Estimate transmittance(const Scene& scene, const Ray& ray, double length_m, const Tolerance& tolerance) {
    const Fog fog(scene.medium, scene.time_s);
    if (fog.is_closed()) {
        return {glm::exp(-fog.closed_optical_depth(ray, length_m)), glm::dvec3(0.0)};
    }
    const EyePath path(fog, ray, length_m, inner(tolerance));
    const glm::dvec3 passed = glm::exp(-path.optical_depth(path.end()));
    return {passed, passed * path.error()};
}

Estimate surface_radiance(const Scene& scene, const SurfacePoint& point, const Tolerance& tolerance) {
    const Fog fog(scene.medium, scene.time_s);
    const Surroundings& around = scene.surroundings;
    const glm::dvec3 ambient = glm::mix(around.ambient_down, around.ambient_up, 0.5 + 0.5 * point.normal.y);
    Estimate irradiance{std::numbers::pi * ambient, glm::dvec3(0.0)};
    if (scene.sun) {
        irradiance += from_sun(scene, fog, *scene.sun, point, tolerance);
    }
    for (const DirectionalLight& fill : scene.fills) {
        if (faces(point, -fill.direction)) {
            irradiance += received(point, -fill.direction, fill.illuminance_lux, {});
        }
    }
    for (const Light& light : scene.lights) {
        irradiance += from_light(scene, fog, light, point, tolerance);
    }
    const glm::dvec3 reflected = point.albedo / std::numbers::pi;
    return {point.emission + reflected * irradiance.value, reflected * irradiance.error};
}

glm::dvec3 background_radiance(const Surroundings& surroundings, const glm::dvec3& direction) {
    const double height = std::clamp(direction.y, 0.0, 1.0);
    const glm::dvec3 sky = glm::mix(surroundings.horizon, surroundings.zenith, 1.0 - std::pow(1.0 - height, 3.0));
    return glm::mix(sky, surroundings.ground, std::clamp(-8.0 * direction.y, 0.0, 1.0));
}

Estimate radiance(const Scene& scene, const Ray& ray, const SurfacePoint* surface, const Tolerance& tolerance) {
    const double length_m = surface ? glm::length(surface->position - ray.origin) : infinity;
    const Estimate behind = surface ? surface_radiance(scene, *surface, tolerance)
                                    : Estimate{background_radiance(scene.surroundings, ray.direction), glm::dvec3(0.0)};
    const Estimate passed = transmittance(scene, ray, length_m, tolerance);
    Estimate sum = airlight(scene, ray, length_m, tolerance);
    sum.value += passed.value * behind.value;
    sum.error += passed.value * behind.error + passed.error * behind.value;
    return sum;
}

Estimate radiance(const Scene& scene, const Ray& ray, const Tolerance& tolerance) {
    const std::optional<Hit> hit = scene.geometry.hit(ray);
    if (!hit) {
        return radiance(scene, ray, nullptr, tolerance);
    }
    const Triangle& triangle = scene.geometry.triangles()[hit->triangle];
    const SurfacePoint surface{point_at(ray, hit->distance_m), hit->normal, triangle.albedo, triangle.emission};
    return radiance(scene, ray, &surface, tolerance);
}

Ray pixel_ray(const Camera& camera, ImageSize size, Pixel pixel) {
    const double aspect = static_cast<double>(size.width) / size.height;
    const double x = ((pixel.x + 0.5) / size.width * 2.0 - 1.0) * aspect;
    const double y = 1.0 - (pixel.y + 0.5) / size.height * 2.0;
    const glm::dmat4& m = camera.world_from_camera;
    if (camera.orthographic_half_height_m) {
        const double half_m = *camera.orthographic_half_height_m;
        return {glm::dvec3(m * glm::dvec4(x * half_m, y * half_m, 0.0, 1.0)), -glm::normalize(glm::dvec3(m[2]))};
    }
    const double slope = std::tan(0.5 * camera.fov_y_rad);
    return {glm::dvec3(m[3]), glm::normalize(glm::dvec3(m * glm::dvec4(x * slope, y * slope, -1.0, 0.0)))};
}

std::vector<Pixel> all_pixels(ImageSize size) {
    std::vector<Pixel> pixels;
    pixels.reserve(std::size_t{size.width} * size.height);
    for (std::uint32_t y = 0; y < size.height; ++y) {
        for (std::uint32_t x = 0; x < size.width; ++x) {
            pixels.push_back({x, y});
        }
    }
    return pixels;
}

std::vector<Pixel> random_pixels(ImageSize size, std::size_t count, std::uint64_t seed) {
    const std::vector<Pixel> all = all_pixels(size);
    std::vector<Pixel> chosen;
    std::mt19937_64 random(seed);
    // Knuth's algorithm S: each of what is left is taken with the probability that still fills the choice.
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (random() % (all.size() - i) < std::min(count, all.size()) - chosen.size()) {
            chosen.push_back(all[i]);
        }
    }
    return chosen;
}

std::vector<Estimate> render(const Scene& scene, const Camera& camera, ImageSize size, std::span<const Pixel> pixels,
                             const Tolerance& tolerance, const std::function<void(std::size_t)>& progress,
                             std::span<const std::optional<SurfacePoint>> surfaces) {
    std::vector<Estimate> image(pixels.size());
    std::atomic<std::size_t> next = 0;
    std::mutex reporting;
    std::size_t done = 0;
    const auto work = [&] {
        for (std::size_t i = next++; i < pixels.size(); i = next++) {
            const Ray ray = pixel_ray(camera, size, pixels[i]);
            image[i] = surfaces.empty() ? radiance(scene, ray, tolerance)
                                        : radiance(scene, ray, surfaces[i] ? &*surfaces[i] : nullptr, tolerance);
            if (progress) {
                const std::lock_guard lock(reporting);
                progress(++done);
            }
        }
    };
    std::vector<std::thread> workers;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) {
        workers.emplace_back(work);
    }
    work();
    for (std::thread& worker : workers) {
        worker.join();
    }
    return image;
}

} // namespace tyndall::volumetrics::reference
