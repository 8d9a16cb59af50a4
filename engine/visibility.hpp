// What is drawn in a frame, in which order: lists of instances for each pass. Pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/camera.hpp"
#include "engine/cascades.hpp"
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

/// Instances, opaque and mask, that may throw a shadow into the cascade, in the scene's order.
[[nodiscard]] std::vector<std::uint32_t> shadow_casters(const Scene& scene, const CascadesFit& fit,
                                                        std::uint32_t cascade);

/// Of all instances that cast shadows; empty when none does.
[[nodiscard]] Box caster_bounds(const Scene& scene);

} // namespace tyndall::engine
