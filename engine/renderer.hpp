// Declares the frames of a scene on a graph: sun cascades, depth pre-pass, opaque surfaces, transparents and particles,
// exposure and tone mapping, with injection points between them at which features hook in.
//
//   auto renderer = *Renderer::create(device, cache.handle(), std::move(scene), settings, frames_in_flight);
//   rg::InjectionPoints points(Renderer::injection_points());
//   ...each frame, when the executor's slot is free:
//   rg::GraphBuilder graph;
//   rg::Blackboard blackboard;
//   renderer->declare(graph, blackboard, points, request);
//   ...compile, submit with renderer->bindings()
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "engine/cascades.hpp"
#include "engine/draw.hpp"
#include "engine/frame.hpp"
#include "engine/frame_data.hpp"
#include "engine/local_shadows.hpp"
#include "engine/particles.hpp"
#include "engine/renderer_pipelines.hpp"
#include "engine/renderer_settings.hpp"
#include "engine/scene.hpp"
#include "engine/scene_gpu.hpp"
#include "engine/visibility.hpp"
#include "rendergraph/blackboard.hpp"
#include "rendergraph/graph.hpp"
#include "rendergraph/injection.hpp"

namespace tyndall::engine {

/// One frame that is asked for.
struct FrameRequest {
    Camera camera;
    VkExtent2D size = {1280, 720};
    double time_s = 0.0;
    std::uint64_t frame_index = 0;
    std::uint32_t frame_slot = 0; ///< Executor::next_slot, after wait_for_slot
    bool cut = false;             ///< first frame, or the camera jumped
};

class Renderer {
public:
    using Declare = rg::InjectionPoints::Declare;

    /// `device` outlives the renderer. Uploads the scene and waits for it. Errors: out of memory, an image that is too
    /// large.
    [[nodiscard]] static tl::expected<std::unique_ptr<Renderer>, Error> create(const Device& device,
                                                                               VkPipelineCache cache, Scene scene,
                                                                               RendererSettings settings,
                                                                               std::uint32_t frames_in_flight);
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;
    ~Renderer(); ///< no frame that it declared is in flight, and the executor is gone or has released its imports

    /// In order: frame_begin, after_shadow_maps, after_depth, after_opaque, transparent, after_transparent, post,
    /// frame_end.
    [[nodiscard]] static std::vector<std::string> injection_points();

    /// Drawn among the transparents from the next frame on; outlives the renderer's frames. Null: none.
    void set_particles(ParticleSystem* particles) { particles_ = particles; }

    /// Declares a frame. What is on the blackboard, and from when on, is said in frame.hpp. `at_end` runs last, at
    /// frame_end: copies to the host, say. Sizes are at least 1 x 1. The error is the device's.
    [[nodiscard]] tl::expected<void, Error> declare(rg::GraphBuilder& graph, rg::Blackboard& blackboard,
                                                    const rg::InjectionPoints& points, const FrameRequest& request,
                                                    const Declare& at_end = {});

    /// What the executor is to bind for the frame declared last, particles included.
    [[nodiscard]] std::span<const rg::ImportBinding> bindings() const { return bindings_; }
    /// What the frame declared last does without.
    [[nodiscard]] std::span<const Omission> omissions() const { return omissions_; }
    /// About lights that are treated in a special way; a sentence each.
    [[nodiscard]] std::span<const std::string> notes() const { return lights_.notes; }

    /// A declared frame was not executed: nothing kept from it may be relied on.
    void forget_cached_frames();

    [[nodiscard]] const Scene& scene() const { return scene_; }
    [[nodiscard]] const RendererSettings& settings() const { return settings_; }
    [[nodiscard]] const LightRoles& lights() const { return lights_; }

private:
    /// An array of shadow maps that is kept.
    struct ShadowCache {
        DeviceImage image;
        std::uint32_t layers = 0;
        bool has_layout = false; ///< some frame has left it in its resting layout
    };
    /// What a local light's shadow map shows. Lights and casters never move.
    struct HeldMap {
        std::uint32_t light = 0; ///< index into LightRoles::local
        std::uint32_t side = 0;
        friend bool operator==(const HeldMap&, const HeldMap&) = default;
    };
    /// One map of a frame.
    struct LocalMap {
        std::uint32_t record = 0; ///< of Frame::local_shadows, and of the array of gpu::LocalShadow
        std::uint32_t side = 0;   ///< of the light's cube
        std::uint32_t layer = 0;
    };
    /// Handles and lists of the frame that is being declared.
    struct Frame {
        FrameView view;
        DrawLists lists;
        std::optional<CascadesFit> cascades;
        LocalShadowPlan local_shadows;
        GeometryImports geometry;
        rg::Buffer parameters;
        rg::Buffer instances;
        std::optional<ParticleDraws> particles;
        std::optional<Error> error; ///< of a callback
    };

    Renderer(const Device& device, Scene scene, RendererSettings settings);
    [[nodiscard]] tl::expected<void, Error> make(VkPipelineCache cache, std::uint32_t frames_in_flight);

    // renderer.cpp: the frame's set-up.
    void begin_frame(rg::GraphBuilder& graph, rg::Blackboard& blackboard, const FrameRequest& request);
    void write_parameters(rg::Blackboard& blackboard);
    [[nodiscard]] rg::Buffer import(rg::GraphBuilder& graph, const char* name, const Buffer& buffer);
    void omit(std::string what, std::string why) { omissions_.push_back({std::move(what), std::move(why)}); }

    // renderer_shadows.cpp
    [[nodiscard]] tl::expected<void, Error> declare_shadows(rg::GraphBuilder& graph, rg::Blackboard& blackboard);
    [[nodiscard]] tl::expected<ShadowCache, Error> make_shadow_cache(std::uint32_t side, std::uint32_t layers) const;
    [[nodiscard]] rg::Image shadow_image(rg::GraphBuilder& graph, const char* name, std::optional<ShadowCache>& cache,
                                         std::uint32_t side, std::uint32_t layers, bool drawn);
    [[nodiscard]] bool is_held(std::uint32_t cascade) const;

    // renderer_local_shadows.cpp
    void plan_local_shadows();
    [[nodiscard]] tl::expected<void, Error> declare_local_shadows(rg::GraphBuilder& graph, rg::Blackboard& blackboard);
    [[nodiscard]] std::vector<LocalMap> stale_maps(); ///< that are to be drawn, which are held from then on
    [[nodiscard]] tl::expected<void, Error> declare_local_map(rg::GraphBuilder& graph, rg::Image& maps,
                                                              rg::Buffer records, const LocalMap& map);

    // renderer_surfaces.cpp
    [[nodiscard]] tl::expected<std::vector<Draw>, Error> depth_draws(DepthTarget target,
                                                                     std::span<const std::uint32_t> instances);
    [[nodiscard]] Draw instance_draw(std::uint32_t instance) const;
    [[nodiscard]] tl::expected<void, Error> declare_depth(rg::GraphBuilder& graph, rg::Blackboard& blackboard);
    [[nodiscard]] tl::expected<void, Error> declare_opaque(rg::GraphBuilder& graph, rg::Blackboard& blackboard);

    // renderer_transparents.cpp
    [[nodiscard]] tl::expected<void, Error> declare_particles(rg::GraphBuilder& graph, rg::Blackboard& blackboard);
    [[nodiscard]] tl::expected<void, Error> declare_transparents(rg::GraphBuilder& graph, rg::Blackboard& blackboard);

    // renderer_post.cpp
    [[nodiscard]] tl::expected<void, Error> declare_post(rg::GraphBuilder& graph, rg::Blackboard& blackboard);
    [[nodiscard]] tl::expected<rg::Buffer, Error> declare_exposure(rg::GraphBuilder& graph, rg::Image color);

    const Device* device_;
    Scene scene_;
    RendererSettings settings_;
    LightRoles lights_;
    Casters casters_;
    SceneGpu scene_gpu_;
    std::optional<RendererPipelines> pipelines_;
    FrameData frame_data_;
    DeviceSampler linear_sampler_;  ///< clamps
    DeviceSampler nearest_sampler_; ///< clamps
    std::optional<ShadowCache> cascade_cache_;
    std::array<std::optional<CascadesFit>, most_cascades> cascades_held_; ///< by layer of the cache
    std::optional<ShadowCache> local_shadow_cache_;
    std::vector<std::optional<HeldMap>> local_maps_held_; ///< by layer of the cache
    std::vector<ShadowedLight> shadowed_lights_;          ///< of the frame declared last
    ParticleSystem* particles_ = nullptr;

    Frame frame_;
    std::vector<rg::ImportBinding> bindings_;
    std::vector<Omission> omissions_;
};

} // namespace tyndall::engine
