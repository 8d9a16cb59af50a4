// Pictures of the stability study's scenes, by the device and exact ones.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <tl/expected.hpp>

#include "engine/device.hpp"
#include "samples/stability/bounds.hpp"
#include "samples/stability/case.hpp"

namespace tyndall::samples {

/// Pixels of every picture of the study.
inline constexpr reference::ImageSize stability_picture_size{32, 18};

struct StabilityPicture {
    std::vector<glm::dvec3> radiance; ///< row by row
    std::vector<StageValues> stages;
};

/// Runs frames 1 to the last of `frames` (ascending), at `time_s` of each, and takes a picture of those named.
[[nodiscard]] tl::expected<std::vector<StabilityPicture>, std::string>
take_pictures(const engine::Device& device, const StabilityCase& test, std::span<const std::uint32_t> frames,
              const std::function<double(std::uint32_t)>& time_s);

/// The first frame, at the scene's time.
[[nodiscard]] tl::expected<StabilityPicture, std::string> take_picture(const engine::Device& device,
                                                                       const StabilityCase& test);

[[nodiscard]] std::vector<glm::dvec3> exact_picture(const StabilityCase& test);

/// What the scene's storage format rounds, in parts of a value: 2 units of the last place of fp16; of fp32 what the
/// slices of a column add up.
[[nodiscard]] double storage_tolerance(const StabilityCase& test);

} // namespace tyndall::samples
