// Ground truth: radiance along rays through fog by adaptive quadrature, with a bound of its error.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "features/volumetrics/reference/quadrature.hpp"
#include "features/volumetrics/reference/scene.hpp"

namespace tyndall::volumetrics::reference {

/// A point on a Lambertian surface.
struct SurfacePoint {
    glm::dvec3 position{0.0};
    glm::dvec3 normal{0.0, 1.0, 0.0}; ///< unit, on the eye's side
    glm::dvec3 albedo{0.0};
    glm::dvec3 emission{0.0}; ///< cd/m^2
};

/// Radiance scattered and emitted toward the ray's origin by the medium on the way to `length_m`, which may be
/// infinite, unless homogeneous fog shines there without extinction. No surface may stand on that way.
[[nodiscard]] Estimate airlight(const Scene& scene, const Ray& ray, double length_m, const Tolerance& tolerance);

/// Part of the light that passes that way.
[[nodiscard]] Estimate transmittance(const Scene& scene, const Ray& ray, double length_m, const Tolerance& tolerance);

/// Radiance that leaves a surface.
[[nodiscard]] Estimate surface_radiance(const Scene& scene, const SurfacePoint& point, const Tolerance& tolerance);

[[nodiscard]] glm::dvec3 background_radiance(const Surroundings& surroundings, const glm::dvec3& direction);

/// What the eye sees along the ray: surface or background through the medium, and the medium itself.
[[nodiscard]] Estimate radiance(const Scene& scene, const Ray& ray, const Tolerance& tolerance);

/// The same where it is known what the ray hits; `surface` is null where it hits nothing.
[[nodiscard]] Estimate radiance(const Scene& scene, const Ray& ray, const SurfacePoint* surface,
                                const Tolerance& tolerance);

struct Pixel {
    std::uint32_t x = 0; ///< from the left
    std::uint32_t y = 0; ///< from the top
};

struct ImageSize {
    std::uint32_t width = 1;
    std::uint32_t height = 1;
};

/// Through the pixel's centre.
[[nodiscard]] Ray pixel_ray(const Camera& camera, ImageSize size, Pixel pixel);

[[nodiscard]] std::vector<Pixel> all_pixels(ImageSize size);

/// `count` different pixels, in the order of rows; the same for the same seed.
[[nodiscard]] std::vector<Pixel> random_pixels(ImageSize size, std::size_t count, std::uint64_t seed);

/// `radiance` of every pixel of `pixels`, in their order, on all of the machine's processors. `progress`, if any, is
/// called with the number of pixels done, from several threads, one at a time. `surfaces`, if any, are what the pixels
/// show instead of the scene's own colours and normals, one a pixel.
[[nodiscard]] std::vector<Estimate> render(const Scene& scene, const Camera& camera, ImageSize size,
                                           std::span<const Pixel> pixels, const Tolerance& tolerance,
                                           const std::function<void(std::size_t)>& progress = {},
                                           std::span<const std::optional<SurfacePoint>> surfaces = {});

} // namespace tyndall::volumetrics::reference
