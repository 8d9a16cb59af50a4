// The exact pictures that the precision study compares with, computed once and kept in files.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "samples/precision/scene.hpp"

namespace tyndall::samples {

/// Of the pixels asked for, in their order.
struct TruthImage {
    std::string physics; ///< what of it is computed
    std::vector<glm::dvec3> values;
    double relative_error = 0.0; ///< the reference's own, relative L2
    bool from_file = false;
};

/// What the picture is compared with first: all of physics.
inline constexpr const char* full_physics = "full";

/// All of physics, and what the pictures may not attempt left out of it. `folder`, if any, keeps the pictures under the
/// hash of the scene's name and file, the pixels, what they show, the tolerance and this very program, in which the
/// scenes are made and their pictures computed: nothing else decides what they are. `surfaces` as in reference::render.
/// `progress` is told the picture and the part done, 0 to 1. The error is one sentence.
[[nodiscard]] tl::expected<std::vector<TruthImage>, std::string>
exact_pictures(const PrecisionScene& scene, reference::ImageSize size, std::span<const reference::Pixel> pixels,
               std::span<const std::optional<reference::SurfacePoint>> surfaces, bool airlight_only,
               const std::optional<std::filesystem::path>& folder,
               const std::function<void(const std::string&, double)>& progress);

} // namespace tyndall::samples
