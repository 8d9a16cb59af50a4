// What the pixels of a scene with textures show: albedo, emission and normal as the engine draws them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "engine/device.hpp"
#include "engine/image_io.hpp"
#include "samples/precision/scene.hpp"
#include "samples/tyndall/arguments.hpp"

namespace tyndall::samples {

/// Of a colour image, in the order of `pixels`.
[[nodiscard]] std::vector<glm::dvec3> values_at(const engine::Pixels<float>& image,
                                                std::span<const reference::Pixel> pixels);

/// One a pixel; none where there is no surface. Nothing but ambient light tells them: where it is 1 everywhere a
/// Lambertian surface shows its albedo; where it is 1 from above and 0 from below a white one shows (1 + n.y) / 2, and
/// the other two of the normal's components once the world is turned to have their axis upward; where there is none,
/// its emission. The place is that of the nearest triangle on the pixel's ray. `scene` is of a file. The error is one
/// sentence.
[[nodiscard]] tl::expected<std::vector<std::optional<reference::SurfacePoint>>, std::string>
drawn_surfaces(const engine::Device& device, const PrecisionScene& scene, Size size,
               std::span<const reference::Pixel> pixels);

} // namespace tyndall::samples
