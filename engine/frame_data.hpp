// What the host writes for each frame: parameters of the view, places of instances, lights, cascades.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "engine/camera.hpp"
#include "engine/lights.hpp"
#include "engine/local_shadows.hpp"
#include "engine/memory.hpp"
#include "engine/renderer_settings.hpp"
#include "shaders/engine/renderer_interop.h"

namespace tyndall::engine {

/// What of a frame's look is not in the view.
struct FrameLook {
    Ambient ambient;
    Background background;
    float largest_radiance = 0.0F; ///< what the colour format can hold
    std::uint32_t local_light_count = 0;
    gpu::LightMedium medium{}; ///< that light comes through
};
[[nodiscard]] gpu::FrameParameters make_frame_parameters(const FrameView& view, const LightRoles& lights,
                                                         const FrameLook& look);

[[nodiscard]] gpu::GpuInstance make_gpu_instance(const Instance& instance, const glm::dvec3& origin_m);

/// Mapped buffers for each frame in flight. A slot is written only when no frame that used it is on the device.
class FrameData {
public:
    struct Slot {
        Buffer parameters;                        ///< gpu::FrameParameters
        Buffer instances;                         ///< gpu::GpuInstance, by Scene::instances
        Buffer lights;                            ///< gpu::GpuLight
        std::vector<gpu::GpuLight> light_records; ///< what `lights` holds
        Buffer sun;                               ///< gpu::SunCascades
        Buffer local_shadows;                     ///< gpu::LocalShadow
        std::optional<glm::dvec3> origin_m;       ///< render space that instances and lights are in
        std::vector<ShadowedLight> shadowed;      ///< as `lights` names their records
    };
    [[nodiscard]] static tl::expected<FrameData, Error> create(const Device& device, std::uint32_t frames_in_flight,
                                                               std::size_t instance_count, std::size_t light_count);

    void write_parameters(std::uint32_t slot, const gpu::FrameParameters& parameters);
    /// Written anew only when the origin has moved or other lights cast shadows.
    void write_places(std::uint32_t slot, const glm::dvec3& origin_m, const std::vector<Instance>& instances,
                      const std::vector<Light>& lights, const LightSettings& settings,
                      const std::vector<ShadowedLight>& shadowed);
    void write_local_shadows(std::uint32_t slot, std::span<const gpu::LocalShadow> records);
    void write_sun(std::uint32_t slot, const gpu::SunCascades& sun);

    [[nodiscard]] const Slot& slot(std::uint32_t index) const { return slots_[index]; }

private:
    std::vector<Slot> slots_;
};

} // namespace tyndall::engine
