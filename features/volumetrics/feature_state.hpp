// What a Feature holds, shared by feature.cpp (life, frame set-up) and declare.cpp (passes).
#pragma once

#include <array>
#include <span>

#include "features/volumetrics/airlight.hpp"
#include "features/volumetrics/density_image.hpp"
#include "features/volumetrics/feature.hpp"
#include "features/volumetrics/host_buffers.hpp"
#include "features/volumetrics/parameters.hpp"
#include "features/volumetrics/persistent_image.hpp"
#include "features/volumetrics/pipelines.hpp"

namespace tyndall::volumetrics {

/// One frame between begin_frame and declare_after_opaque.
struct FrameState {
    FrameInputs inputs; ///< its lights as the froxels see them
    gpu::VolumetricParameters parameters{};
    gpu::LightClusters cluster_parameters{};
    std::vector<gpu::GpuFogParticle> particles; ///< of fog
    gpu::LightClusters particle_clusters{};
    bool cold = true;
    bool camera_stands = false; ///< since the frame before
    bool sun_shadow = false;
    bool depth_curve = false; ///< the depth law is one
    bool emission = false;    ///< the medium emits somewhere
    bool colored = false;     ///< its extinction differs between the channels
    LocalLights lights = LocalLights::none;
    bool local_shadow = false;                     ///< some local light casts one
    bool froxel_shadow = false;                    ///< one that is in the froxels does
    bool airlight_shadow = false;                  ///< one that each pixel integrates does
    LocalLights froxel_lights = LocalLights::none; ///< without those that each pixel integrates
    std::uint32_t airlight_features = 0;           ///< see shaders/common/airlight.h
    Program density_injection;
    Program light_clustering;
    Program particle_clustering;
    Program fog_on_opaque;

    std::array<rg::Image, 2> noise; ///< shape and detail, where the noise is made of them
    rg::Image density_map;
    std::array<rg::Image, LocalVolume::most_grids> grids;
    rg::Buffer parameter_buffer;
    rg::Buffer particle_buffer; ///< invalid where there is none, as the next two
    rg::Buffer particle_masks;
    rg::Buffer particle_cluster_parameters;
    rg::Buffer light_buffer;
    rg::Buffer compact_lights; ///< its first lights, for binding as uniforms
    ShadowResources shadow;
    std::optional<ClusterResources> clusters;
    std::optional<VolumeResources> volume;
    rg::Image shadow_map; ///< the ESM or the cascades, as the settings' visibility wants
    StageResources stages;
};

/// What all views use.
struct Feature::Shared {
    explicit Shared(const FeatureInfo& given)
        : info(given), pipelines(*given.vk, given.device, given.pipeline_cache, given.check_bindings) {}
    Shared(const Shared&) = delete;
    Shared& operator=(const Shared&) = delete;
    ~Shared();

    FeatureInfo info;
    /// The noise volumes and what bakes them; nothing where they are there already.
    [[nodiscard]] tl::expected<void, Error> make_noise();
    [[nodiscard]] tl::expected<void, Error> make_density(const std::shared_ptr<const DensityTexels>& texels);
    [[nodiscard]] std::size_t density_of(const std::shared_ptr<const DensityTexels>& texels) const; ///< its index

    VkSampler linear = VK_NULL_HANDLE;    ///< clamps to the edge
    VkSampler nearest = VK_NULL_HANDLE;   ///< clamps to the edge
    VkSampler repeating = VK_NULL_HANDLE; ///< linear
    Pipelines pipelines;
    std::array<std::unique_ptr<PersistentImage>, 2> noise; ///< shape and detail; null until they are needed
    std::array<Program, 2> noise_bake;
    std::vector<std::unique_ptr<DensityImage>> densities; ///< of all texels that the host has ever given
};

/// One view.
struct Feature::State {
    State(Shared& all, std::uint32_t view_index, std::unique_ptr<HostBuffers> buffers)
        : view(view_index), shared(all), linear(all.linear), nearest(all.nearest), pipelines(all.pipelines),
          host_buffers(std::move(buffers)) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    /// Creates the frame's pipelines that are known before anything is declared.
    [[nodiscard]] tl::expected<void, Error> prepare_programs();
    void tell(const AirlightChoice& airlight, std::size_t light_count);
    void write_parameters() {
        host_buffers->write(frame->inputs.frame_slot, std::as_bytes(std::span(&frame->parameters, 1)));
    }
    void omit(std::string what, std::string why) { omissions.push_back({std::move(what), std::move(why)}); }

    // Passes, in order; declare.cpp.
    void declare_noise(rg::GraphBuilder& graph); ///< declare_noise.cpp
    [[nodiscard]] tl::expected<void, Error> make_textures();
    void declare_textures(rg::GraphBuilder& graph); ///< declare_textures.cpp
    [[nodiscard]] tl::expected<void, Error> make_particle_buffers();
    void declare_particles(rg::GraphBuilder& graph); ///< declare_particles.cpp
    void declare_density(rg::GraphBuilder& graph);
    void declare_clustering(rg::GraphBuilder& graph);
    [[nodiscard]] tl::expected<void, Error> declare_esm(rg::GraphBuilder& graph, const ShadowResources& shadow);
    [[nodiscard]] tl::expected<void, Error> declare_lighting(rg::GraphBuilder& graph, const ShadowResources& shadow);
    [[nodiscard]] tl::expected<void, Error> declare_accumulation(rg::GraphBuilder& graph);
    void declare_fog(rg::GraphBuilder& graph, const OpaqueResources& resources);
    [[nodiscard]] rg::QueueWish wish() const;

    /// Of a resource or a pass of this view: the executor knows a history by its name.
    [[nodiscard]] std::string named(const char* name) const {
        return view == 0 ? name : std::string(name) + ", view " + std::to_string(view);
    }

    std::uint32_t view;
    Shared& shared;
    VkSampler linear;
    VkSampler nearest;
    Pipelines& pipelines;
    std::unique_ptr<HostBuffers> host_buffers; ///< gpu::VolumetricParameters, clusters of lights
    std::unique_ptr<HostBuffers>
        particle_buffers; ///< gpu::GpuFogParticle and their clusters; null until they are needed

    std::optional<FrameState> frame;   ///< empty where there is no fog
    std::optional<FrameMemory> before; ///< the last frame that had fog
    std::vector<rg::ImportBinding> import_bindings;
    std::vector<Omission> omissions;
};

[[nodiscard]] inline bool is_clustered(LocalLights lights) {
    return lights >= LocalLights::clustered;
}

/// Long rows run best on processors that vectorise along x: a multiple of 8, at most 128 (the smallest limit that
/// Vulkan allows), splitting `width` evenly.
[[nodiscard]] GroupShape row_group(std::uint32_t width, std::uint32_t longest = 128);

} // namespace tyndall::volumetrics
