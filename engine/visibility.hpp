// What is drawn in a frame, in which order: lists of instances for each pass. Pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/camera.hpp"
#include "engine/scene.hpp"

namespace tyndall::engine {

/// Indices into Scene::instances.
struct DrawLists {
    std::vector<std::uint32_t> surfaces;     ///< opaque and mask, in view, front to back
    std::vector<std::uint32_t> transparents; ///< blend, in view, back to front; ties in the scene's order
    std::vector<float> transparent_depths_m; ///< view depth of the centres, in the same order
    std::optional<DepthSpan> depth_m;        ///< of all of these; empty where nothing is in view
};
[[nodiscard]] DrawLists visible_instances(const Scene& scene, const FrameView& view);

/// What casts shadows.
struct Casters {
    std::vector<std::uint32_t> instances; ///< opaque and mask, in the scene's order
    std::vector<Box> boxes;               ///< theirs, in the same order
    Box bounds;                           ///< of all; empty where there is none

    /// The instances for whose box `wanted` holds.
    template <typename Wanted>
    [[nodiscard]] std::vector<std::uint32_t> where(Wanted&& wanted) const {
        std::vector<std::uint32_t> found;
        for (std::size_t i = 0; i < instances.size(); ++i) {
            if (wanted(boxes[i])) {
                found.push_back(instances[i]);
            }
        }
        return found;
    }
};
[[nodiscard]] Casters shadow_casters(const Scene& scene);

} // namespace tyndall::engine
