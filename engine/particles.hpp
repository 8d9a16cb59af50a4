// GPU particles as lit, soft billboards. A particle's state is a pure function of emitter, number and time, so any time
// can be drawn; each frame simulates, sorts back to front and splits the particles into the intervals between the
// sorted transparent draws, so that smoke lies correctly before, between and behind panes of glass.
//
//   ParticleDraws draws = *particles.declare(graph, view, split_depths_m, slot);   // at frame_begin
//   particles.add_reads(transparent_pass, draws, lighting);
//   transparent_pass.executes([=, &particles](rg::PassContext& ctx) {
//       for (std::uint32_t i = 0; i < panes; ++i) { particles.draw(ctx, draws, lighting, i); draw_pane(ctx, i); }
//       particles.draw(ctx, draws, lighting, panes);
//   });
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "engine/error.hpp"
#include "engine/particle_buffer.hpp"
#include "engine/particle_frame.hpp"
#include "engine/particle_passes.hpp"
#include "engine/particles_json.hpp"
#include "rendergraph/executor.hpp"
#include "rendergraph/graph.hpp"

namespace tyndall::engine {

/// The particles of one frame on its graph.
struct ParticleDraws {
    rg::Buffer frame;                           ///< gpu::ParticleFrame and the emitters
    rg::Buffer particles;                       ///< gpu::GpuParticle[]
    rg::Buffer keys;                            ///< sorted
    rg::Buffer commands;                        ///< VkDrawIndirectCommand[interval_count]
    std::uint32_t interval_count = 1;           ///< one more than there are split depths
    std::array<rg::ImportBinding, 2> imports{}; ///< what the executor is to bind in this frame
};

/// Where particles take light and fog from. Without a scattering volume they are lit by sun, lights and ambient of the
/// ParticleView, and not fogged.
struct ParticleLighting {
    struct ScatteringVolume {
        rg::Image accumulated;  ///< see shaders/common/scattering_volume.glsl
        rg::Image in_scattered; ///< of the same
        rg::Buffer parameters;  ///< uniform, begins with a gpu::ScatteringVolume
    };
    struct SunShadow {
        rg::Image cascades;    ///< see shaders/common/sun_shadow.h
        rg::Buffer parameters; ///< uniform, a gpu::SunCascades
    };
    rg::Image scene_depth; ///< of the opaque scene, reverse-z, at the size of the colour target
    std::optional<ScatteringVolume> scattering;
    // Read only where there is no scattering volume:
    std::optional<SunShadow> sun_shadow; ///< absent: the sun reaches everything
    std::optional<rg::Buffer> lights;    ///< gpu::GpuLight[ParticleView::light_count]; absent: none
};

class ParticleSystem {
public:
    /// `emitters` is not empty. `frames_in_flight` as the executor has.
    [[nodiscard]] static tl::expected<std::unique_ptr<ParticleSystem>, Error>
    create(const ParticleDevice& device, std::vector<ParticleEmitter> emitters, std::uint32_t frames_in_flight,
           VkFormat color_format, VkFormat depth_format);
    ParticleSystem(const ParticleSystem&) = delete;
    ParticleSystem& operator=(const ParticleSystem&) = delete;
    ~ParticleSystem(); ///< no frame that it declared may be in flight

    /// Adds the passes "particle simulation", "particle sort" and "particle split". `split_depths_m` are the view
    /// depths of the sorted transparent draws, back to front. Writes the host's data of `frame_slot`
    /// (Executor::next_slot, after wait_for_slot). The error is the device's: out of memory.
    [[nodiscard]] tl::expected<ParticleDraws, Error> declare(rg::GraphBuilder& graph, const ParticleView& view,
                                                             std::span<const float> split_depths_m,
                                                             std::uint32_t frame_slot);

    /// Declares what `draw` reads. The pass itself declares its colour target and reads of the scene's depth as a
    /// depth attachment.
    void add_reads(rg::PassBuilder& pass, const ParticleDraws& draws, const ParticleLighting& lighting) const;

    /// Draws interval `interval` of [0, draws.interval_count): 0 lies behind the farthest split depth, the last one
    /// before the nearest. A particle at the very depth of a split is in the nearer interval. Binds its own pipeline
    /// and descriptors.
    void draw(rg::PassContext& ctx, const ParticleDraws& draws, const ParticleLighting& lighting,
              std::uint32_t interval) const;

    [[nodiscard]] std::uint32_t count() const { return particle_count(emitters_); }

private:
    struct Slot {
        ParticleBuffer frame;
        ParticleBuffer splits; ///< grows when a frame has more transparent draws
    };
    ParticleSystem(const ParticleDevice& device, std::vector<ParticleEmitter> emitters)
        : device_(device), emitters_(std::move(emitters)), programs_(device) {}
    [[nodiscard]] tl::expected<void, Error> make_billboards(VkFormat color_format, VkFormat depth_format);
    [[nodiscard]] tl::expected<void, Error> make_sampler(VkFilter filter, VkSampler& sampler);
    [[nodiscard]] tl::expected<void, Error> write_host_data(const ParticleView& view,
                                                            std::span<const float> split_depths_m, Slot& slot);

    ParticleDevice device_;
    std::vector<ParticleEmitter> emitters_;
    std::unique_ptr<ParticlePasses> passes_;
    ParticlePrograms programs_;
    ParticleProgram scattering_program_;
    std::array<ParticleProgram, 4> direct_programs_{}; ///< by 2 * sun shadow + lights
    VkSampler linear_ = VK_NULL_HANDLE;
    VkSampler nearest_ = VK_NULL_HANDLE;
    std::vector<Slot> slots_;
};

} // namespace tyndall::engine
