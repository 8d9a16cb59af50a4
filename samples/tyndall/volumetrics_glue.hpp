// Where the engine and the volumetric feature meet: the feature's passes at the engine's injection points, each side's
// structs turned into the other's. A host with an engine of its own writes this file for it.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "engine/device.hpp"
#include "engine/frame.hpp"
#include "features/volumetrics/feature.hpp"
#include "features/volumetrics/fog_json.hpp"
#include "rendergraph/injection.hpp"

namespace tyndall::samples {

class VolumetricsGlue {
public:
    [[nodiscard]] static tl::expected<VolumetricsGlue, engine::Error>
    create(const engine::Device& device, VkPipelineCache cache, std::uint32_t frames_in_flight, VkFormat color_format,
           volumetrics::Fog fog, bool check_bindings);

    /// Registers at frame_begin, after_shadow_maps and after_opaque. `this` must stay where it is from then on.
    [[nodiscard]] tl::expected<void, engine::Error> attach(rg::InjectionPoints& points);

    void set_enabled(bool enabled) { enabled_ = enabled; }
    [[nodiscard]] const volumetrics::Feature& feature() const { return *feature_; }
    [[nodiscard]] const volumetrics::Fog& fog() const { return fog_; }
    /// What went wrong while the last frame was declared.
    [[nodiscard]] const std::optional<engine::Error>& error() const { return error_; }

private:
    VolumetricsGlue() = default;
    void frame_begin(rg::GraphBuilder& graph, rg::Blackboard& blackboard);
    void after_shadow_maps(rg::GraphBuilder& graph, rg::Blackboard& blackboard);
    void after_opaque(rg::GraphBuilder& graph, rg::Blackboard& blackboard);
    void keep_error(const tl::expected<void, volumetrics::Error>& result);

    std::optional<volumetrics::Feature> feature_;
    volumetrics::Fog fog_;
    VkFormat color_format_ = VK_FORMAT_UNDEFINED; ///< of the scene colour
    bool enabled_ = true;
    std::optional<engine::Error> error_;
};

/// Adds to what a feature's passes need bound.
void add_imports(rg::Blackboard& blackboard, std::span<const rg::ImportBinding> bindings);

} // namespace tyndall::samples
