// Volumetric light as passes on a frame graph that the feature is given. Once a frame, in this order:
//
//   feature.begin_frame(inputs);
//   feature.declare_frame_begin(graph, {.lights = lights});                // at the point frame_begin
//   feature.declare_after_shadow_maps(graph, {cascades, parameters});      // at after_shadow_maps
//   feature.declare_after_opaque(graph, {.color = color, .depth = depth}); // at after_opaque
//   executor.submit(..., feature.bindings());
//
// `color` becomes the fogged version.
// What a frame does not need is not declared, and `omissions` says why. Of several views in a frame each goes this way
// by itself, with its own history; the order of views does not matter.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "features/volumetrics/frame_inputs.hpp"
#include "features/volumetrics/light_path.hpp"
#include "rendergraph/device_table.hpp"
#include "rendergraph/executor.hpp"
#include "rendergraph/graph.hpp"

namespace tyndall::volumetrics {

/// The device must have VK_KHR_push_descriptor, dynamicRendering and synchronization2 enabled.
struct FeatureInfo {
    const rg::DeviceTable* vk = nullptr; ///< outlives the feature
    VkDevice device = VK_NULL_HANDLE;
    VkPipelineCache pipeline_cache = VK_NULL_HANDLE; ///< may be null
    VkPhysicalDeviceMemoryProperties memory_properties = {};
    std::uint32_t frames_in_flight = 2;
    bool dual_source_blending = false; ///< the feature dualSrcBlend is enabled: media of coloured extinction need it
    /// Every family whose queues a frame's passes may run on: the feature's own buffers are shared between them.
    std::vector<std::uint32_t> queue_families = {};
    bool check_bindings = false; ///< the executor's ExecutorInfo::check_bindings
};

/// FrameInputs::lights as a buffer; needed only when there are any.
struct FrameBeginResources {
    rg::Buffer lights;
};

/// The first two are needed only when the sun casts shadows, the others only when a local light does (its
/// GpuLight::cone.z); otherwise invalid handles.
struct ShadowResources {
    rg::Image cascades;    ///< depth array, a layer a cascade (4 at most), square, 0 at the light, 1 where it is empty
    rg::Buffer parameters; ///< gpu::SunCascades
    rg::Image local_maps = {};     ///< depth array, square: see shaders/common/local_shadow.h
    rg::Buffer local_records = {}; ///< gpu::LocalShadow, one for each light that casts shadows
};

struct OpaqueResources {
    rg::Image& color; ///< linear scene radiance, FrameInputs::color_format; modified
    rg::Image depth;  ///< device depth of the same size
};

/// Light clusters of the frame, for forward shading too: gpu::LightClusters and `uint masks[]`.
struct ClusterResources {
    rg::Buffer masks;
    rg::Buffer parameters;
};

/// For shaders/common/scattering_volume.glsl.
struct VolumeResources {
    rg::Image accumulated;  ///< 2D array of slices + 1 layers: radiance toward the eye, optical depth; as many with the
                            ///< optical depth of each channel, where extinction is coloured
    rg::Image in_scattered; ///< 3D: radiance per unit of scattering coefficient
    rg::Buffer parameters;  ///< begins with gpu::ScatteringVolume, then gpu::Airlights
    std::uint32_t airlight_features = 0; ///< see shaders/common/airlight.h
    bool colored = false;                ///< extinction is: the constant COLORED_EXTINCTION of the look-ups
};

/// Intermediate images, for looking at; invalid where their pass was left out.
struct StageResources {
    rg::Image density;  ///< 3D: scattering coefficient and extinction, 1/m times VolumetricParameters::density_scale.x;
                        ///< as many slices with the extinction of each channel, where it is coloured
    rg::Image emission; ///< 3D: radiance gained per metre, cd/m^3 times VolumetricParameters::emission_scale.x
    /// Two fp16 of a word, x fastest, then y, then z: shape and detail, in the frame that bakes them.
    std::array<rg::Buffer, 2> baked_noise;
    rg::Image esm; ///< 2D array: ln of the mean of e^(k z), blurred
    rg::Image
        error_estimate; ///< 2D, rgba32f, a column of froxels each: absolute error of the stored radiance at the range
};

/// A thing that the frame does without.
struct Omission {
    std::string what;
    std::string why;
};

class Feature {
public:
    static constexpr std::uint32_t most_views = 64;

    [[nodiscard]] static tl::expected<Feature, Error> create(const FeatureInfo& info);
    Feature(Feature&&) noexcept;
    Feature& operator=(Feature&&) noexcept;
    /// The host has waited for the frames in flight. An executor that goes on is told of each of `own_images` first
    /// (Executor::release_import).
    ~Feature();

    /// Validates, makes the pipelines that the view's frame needs, writes its uniforms into `frame_slot`. After an
    /// error the view has no fog in this frame: the declare functions do nothing.
    [[nodiscard]] tl::expected<void, Error> begin_frame(const FrameInputs& given);

    /// Clustering of fog particles, density injection and light clustering.
    [[nodiscard]] tl::expected<void, Error>
    declare_frame_begin(rg::GraphBuilder& graph, const FrameBeginResources& resources, std::uint32_t view = 0);
    /// ESM downsample, blur x, blur y, froxel lighting, accumulation.
    [[nodiscard]] tl::expected<void, Error>
    declare_after_shadow_maps(rg::GraphBuilder& graph, const ShadowResources& resources, std::uint32_t view = 0);
    /// Fog on opaque.
    void declare_after_opaque(rg::GraphBuilder& graph, const OpaqueResources& resources, std::uint32_t view = 0);

    /// What weakens the light of the host's surfaces; empty where nothing does. After begin_frame.
    [[nodiscard]] std::optional<LightWay> light_way(std::uint32_t view = 0) const;
    /// After declare_frame_begin.
    [[nodiscard]] const std::optional<ClusterResources>& clusters(std::uint32_t view = 0) const;
    /// These two after declare_after_shadow_maps.
    [[nodiscard]] const std::optional<VolumeResources>& volume(std::uint32_t view = 0) const;
    [[nodiscard]] const StageResources& stages(std::uint32_t view = 0) const;

    /// What the executor needs beside the host's own bindings, of each view of the frame.
    [[nodiscard]] std::span<const rg::ImportBinding> bindings(std::uint32_t view = 0) const;
    [[nodiscard]] std::span<const Omission> omissions(std::uint32_t view = 0) const;

    /// Those that live as long as the feature: densities that the medium names stay on the device.
    [[nodiscard]] std::vector<VkImage> own_images() const;

private:
    struct Shared;
    struct State;
    explicit Feature(std::unique_ptr<Shared> shared);
    [[nodiscard]] State* find_view(std::uint32_t view) const; ///< null where it has never begun a frame

    std::unique_ptr<Shared> shared_;
    std::vector<std::unique_ptr<State>> views_; ///< null for those between that have never begun a frame
};

} // namespace tyndall::volumetrics
