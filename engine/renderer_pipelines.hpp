// The renderer's pipelines, made when a frame first needs them.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <tl/expected.hpp>

#include "engine/pipelines.hpp"

namespace tyndall::engine {

inline constexpr VkFormat depth_format = VK_FORMAT_D32_SFLOAT;
inline constexpr VkFormat picture_format = VK_FORMAT_R8G8B8A8_UNORM;

enum class LocalLights : std::uint8_t { none, all, of_cluster };

/// What shaders/common/light_march.glsl is specialised to.
struct LightMarch {
    bool volumes = false;
    std::uint32_t octaves = 0;
    bool colored = false;

    friend auto operator<=>(const LightMarch&, const LightMarch&) = default;
};

/// What a forward shader binds and does, as in shaders/engine/forward.frag.
struct ForwardVariant {
    bool sun_shadow = false;
    LocalLights lights = LocalLights::none;
    bool local_shadow = false; ///< some of the lights, so there are some, cast shadows
    bool transparent = false;
    bool scattering = false;             ///< with `transparent` only
    std::optional<LightMarch> air;       ///< weakens light on its way
    std::uint32_t airlight_features = 0; ///< with `scattering` only; see shaders/common/airlight.h
    bool colored_scattering = false;     ///< with `scattering` only

    friend auto operator<=>(const ForwardVariant&, const ForwardVariant&) = default;
};

/// Where depth alone is drawn.
enum class DepthTarget : std::uint8_t { view, cascade, local };

/// A pipeline and the layout to bind for it.
struct Program {
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipeline pipeline = VK_NULL_HANDLE;
    /// Of the shaders of all pipelines of the layout, which draw with what is pushed once. More are added as pipelines
    /// are made, so it is looked at when a frame is recorded.
    const std::vector<rg::ReflectedBinding>* bindings = nullptr;
};

class RendererPipelines {
public:
    /// `materials`: the layout of set 1, which outlives this. `light_count`: point and spot lights of every frame.
    RendererPipelines(const Device& device, VkPipelineCache cache, VkDescriptorSetLayout materials,
                      VkFormat color_format, std::uint32_t light_count)
        : device_(&device), cache_(cache), materials_(materials), color_format_(color_format),
          unrolled_lights_(unrolled_lights(device, light_count)) {}

    // `features` as in materials_gpu.hpp.
    [[nodiscard]] tl::expected<Program, Error> depth(DepthTarget target, bool mask, std::uint32_t features);
    [[nodiscard]] tl::expected<Program, Error> forward(const ForwardVariant& variant, std::uint32_t features);
    [[nodiscard]] tl::expected<Program, Error> sky();
    [[nodiscard]] tl::expected<Program, Error> luminance_sums();
    [[nodiscard]] tl::expected<Program, Error> exposure();
    [[nodiscard]] tl::expected<Program, Error> tone_mapping(bool automatic);

    /// Push constants of luminance.comp and exposure.comp.
    struct LuminancePush {
        std::uint32_t grid_x, grid_y, step, partials;
    };
    struct ExposurePush {
        std::uint32_t partials;
        float key, fallback;
    };

private:
    enum class Kind : std::uint8_t {
        depth_view,
        depth_cascade,
        depth_local,
        forward,
        sky,
        luminance_sums,
        exposure,
        tone_mapping,
        tone_mapping_automatic
    };
    struct LayoutKey {
        Kind kind;
        ForwardVariant variant;
        friend auto operator<=>(const LayoutKey&, const LayoutKey&) = default;
    };
    struct PipelineKey {
        LayoutKey layout;
        bool mask;
        std::uint32_t features;
        friend auto operator<=>(const PipelineKey&, const PipelineKey&) = default;
    };
    struct Layout {
        DescriptorSetLayout set;
        PipelineLayout pipeline;
        std::vector<rg::ReflectedBinding> bindings; ///< Program::bindings
    };
    [[nodiscard]] static std::uint32_t unrolled_lights(const Device& device, std::uint32_t light_count);
    [[nodiscard]] tl::expected<Layout*, Error> layout(const LayoutKey& key);
    template <typename Make>
    [[nodiscard]] tl::expected<Program, Error> find_or_make(const PipelineKey& key, Make&& make);
    [[nodiscard]] tl::expected<Program, Error> compute(Kind kind, std::span<const std::uint32_t> spirv);

    const Device* device_;
    VkPipelineCache cache_;
    VkDescriptorSetLayout materials_;
    VkFormat color_format_;
    std::uint32_t unrolled_lights_; ///< see forward.frag
    std::map<LayoutKey, Layout> layouts_;
    std::map<PipelineKey, Pipeline> pipelines_;
};

} // namespace tyndall::engine
