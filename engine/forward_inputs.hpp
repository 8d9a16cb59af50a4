// What the forward shaders read besides geometry and material: the one place where set 0 of their variants is declared
// and bound.
#pragma once

#include <optional>

#include "engine/frame.hpp"
#include "engine/renderer_pipelines.hpp"
#include "rendergraph/blackboard.hpp"
#include "rendergraph/executor.hpp"

namespace tyndall::engine {

struct ForwardInputs {
    rg::Buffer parameters;
    rg::Buffer instances;
    std::optional<SunShadow> sun;
    std::optional<SceneLights> lights; ///< with at least one light
    std::optional<LocalShadows> local_shadows;
    std::optional<LightClusters> clusters;
    std::optional<ScatteringVolumeImages> scattering; ///< for transparents only
    std::optional<LightMarch> air;                    ///< weakens light on its way
    VkSampler linear_sampler = VK_NULL_HANDLE;
    VkSampler nearest_sampler = VK_NULL_HANDLE;

    /// From what is on the blackboard now.
    void find(rg::Blackboard& blackboard, bool transparent);
    [[nodiscard]] ForwardVariant variant(bool transparent) const;
    void declare(rg::PassBuilder& pass) const;
    void push(rg::PassContext& ctx, const Program& program) const;
};

} // namespace tyndall::engine
