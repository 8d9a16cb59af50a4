// GPU particles as lit, soft billboards. A particle's state is a pure function of emitter, number and time, so any time
// can be drawn; each frame simulates, sorts back to front and splits the particles into the intervals between the
// sorted transparent draws, so that smoke lies correctly before, between and behind panes of glass.
//
//   ParticleDraws draws = *particles.declare(graph, view, light, split_depths_m); // at frame_begin
//   particles.add_reads(transparent_pass, draws, surroundings);
//   transparent_pass.executes([=, &particles](rg::PassContext& ctx) {
//       for (std::uint32_t i = 0; i < panes; ++i) { particles.draw(ctx, draws, surroundings, i); draw_pane(ctx, i); }
//       particles.draw(ctx, draws, surroundings, panes);
//   });
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "engine/error.hpp"
#include "engine/frame.hpp"
#include "engine/memory.hpp"
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

/// Where particles take light and fog from, and what hides them. Without a scattering volume they are lit by sun,
/// lights and ambient of ParticleLight, and not fogged.
struct ParticleSurroundings {
    rg::Image scene_depth; ///< of the opaque scene, reverse-z, at the size of the colour target
    std::optional<ScatteringVolumeImages> scattering;
    // Read only where there is no scattering volume:
    std::optional<SunShadow> sun_shadow; ///< absent: the sun reaches everything
    std::optional<SceneLights> lights;   ///< absent or without a valid buffer: none
    // Read in that case, and with a scattering volume of the lights that it leaves out:
    std::optional<LocalShadows> local_shadows; ///< absent: lights reach everything
};

/// What the pipelines that read a scattering volume are specialised to, as ScatteringVolumeImages has it.
struct ParticleFog {
    std::uint32_t airlight_features = 0;
    bool colored = false;

    friend auto operator<=>(const ParticleFog&, const ParticleFog&) = default;
};

class ParticleSystem {
public:
    /// `emitters` is not empty. `frames_in_flight` as the executor has. `device` outlives the system.
    [[nodiscard]] static tl::expected<ParticleSystem, Error> create(const Device& device, VkPipelineCache cache,
                                                                    std::vector<ParticleEmitter> emitters,
                                                                    std::uint32_t frames_in_flight,
                                                                    VkFormat color_format, VkFormat depth_format);

    /// Adds the passes "particle simulation", "particle sort" and "particle split". `split_depths_m` are the view
    /// depths of the sorted transparent draws, back to front. Writes the host's data of `view.frame_slot`, which no
    /// frame in flight may read any more. The error is the device's: out of memory.
    [[nodiscard]] tl::expected<ParticleDraws, Error> declare(rg::GraphBuilder& graph, const FrameView& view,
                                                             const ParticleLight& light,
                                                             std::span<const float> split_depths_m);

    /// Declares what `draw` reads, and makes the pipeline that it binds. The pass itself declares its colour target and
    /// reads of the scene's depth as a depth attachment. The error is the device's.
    [[nodiscard]] tl::expected<void, Error> add_reads(rg::PassBuilder& pass, const ParticleDraws& draws,
                                                      const ParticleSurroundings& surroundings);

    /// Draws interval `interval` of [0, draws.interval_count): 0 lies behind the farthest split depth, the last one
    /// before the nearest. A particle at the very depth of a split is in the nearer interval. Binds its own pipeline
    /// and descriptors.
    void draw(rg::PassContext& ctx, const ParticleDraws& draws, const ParticleSurroundings& surroundings,
              std::uint32_t interval) const;

    [[nodiscard]] std::uint32_t count() const { return particle_count(emitters_); }

private:
    struct Program {
        DescriptorSetLayout set;
        PipelineLayout layout;
        std::map<ParticleFog, Pipeline> pipelines;
    };
    struct Slot {
        Buffer frame;
        Buffer splits; ///< grows when a frame has more transparent draws
    };
    ParticleSystem(const Device& device, VkPipelineCache cache, std::vector<ParticleEmitter> emitters,
                   ParticlePasses passes, VkFormat color, VkFormat depth)
        : device_(&device), cache_(cache), emitters_(std::move(emitters)), passes_(std::move(passes)),
          color_format_(color), depth_format_(depth) {}
    [[nodiscard]] tl::expected<void, Error> make_layouts();
    [[nodiscard]] tl::expected<void, Error> make_pipeline(std::size_t program, const ParticleFog& fog);
    [[nodiscard]] tl::expected<void, Error> make_samplers();
    [[nodiscard]] tl::expected<void, Error> make_slots(std::uint32_t count);
    [[nodiscard]] tl::expected<void, Error> write_host_data(const FrameView& view, const ParticleLight& light,
                                                            std::span<const float> split_depths_m);

    const Device* device_;
    VkPipelineCache cache_;
    std::vector<ParticleEmitter> emitters_;
    ParticlePasses passes_;
    VkFormat color_format_;
    VkFormat depth_format_;
    std::array<Program, 8> programs_; ///< by 3 * sun shadow + kind of lights (none, without shadows, with them); the
                                      ///< last two with a scattering volume
    DeviceSampler linear_;
    DeviceSampler nearest_;
    std::vector<Slot> slots_; ///< by frame slot
};

} // namespace tyndall::engine
