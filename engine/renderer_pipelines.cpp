#include "engine/renderer_pipelines.hpp"

#include <array>
#include <vector>

#include "engine/geometry_gpu.hpp"
#include "engine/materials_gpu.hpp"
#include "spirv/depth_local_m0.h"
#include "spirv/depth_local_m1.h"
#include "spirv/depth_mask_fragment.h"
#include "spirv/depth_shadow_m0.h"
#include "spirv/depth_shadow_m1.h"
#include "spirv/depth_view_m0.h"
#include "spirv/depth_view_m1.h"
#include "spirv/exposure_compute.h"
#include "spirv/filter_f0.h"
#include "spirv/filter_f1.h"
#include "spirv/forward_s0_l00.h"
#include "spirv/forward_s0_l10.h"
#include "spirv/forward_s0_l11.h"
#include "spirv/forward_s0_l20.h"
#include "spirv/forward_s0_l21.h"
#include "spirv/forward_s1_l00.h"
#include "spirv/forward_s1_l10.h"
#include "spirv/forward_s1_l11.h"
#include "spirv/forward_s1_l20.h"
#include "spirv/forward_s1_l21.h"
#include "spirv/forward_vertex.h"
#include "spirv/full_screen_far_vertex.h"
#include "spirv/luminance_compute.h"
#include "spirv/sky_fragment.h"
#include "spirv/tone_mapping_a0.h"
#include "spirv/tone_mapping_a1.h"
#include "spirv/transparent_fog_s0_l00.h"
#include "spirv/transparent_fog_s0_l10.h"
#include "spirv/transparent_fog_s0_l11.h"
#include "spirv/transparent_fog_s0_l20.h"
#include "spirv/transparent_fog_s0_l21.h"
#include "spirv/transparent_fog_s1_l00.h"
#include "spirv/transparent_fog_s1_l10.h"
#include "spirv/transparent_fog_s1_l11.h"
#include "spirv/transparent_fog_s1_l20.h"
#include "spirv/transparent_fog_s1_l21.h"
#include "spirv/transparent_s0_l00.h"
#include "spirv/transparent_s0_l10.h"
#include "spirv/transparent_s0_l11.h"
#include "spirv/transparent_s0_l20.h"
#include "spirv/transparent_s0_l21.h"
#include "spirv/transparent_s1_l00.h"
#include "spirv/transparent_s1_l10.h"
#include "spirv/transparent_s1_l11.h"
#include "spirv/transparent_s1_l20.h"
#include "spirv/transparent_s1_l21.h"

namespace tyndall::engine {
namespace {

using Spirv = std::span<const std::uint32_t>;

Spirv forward_spirv(const ForwardVariant& variant) {
    // By kind of local lights: without shadows as LocalLights counts them, then the last two with shadows.
    const std::array<std::array<std::array<Spirv, 5>, 2>, 3> shaders = {{
        {{{forward_s0_l00, forward_s0_l10, forward_s0_l20, forward_s0_l11, forward_s0_l21},
          {forward_s1_l00, forward_s1_l10, forward_s1_l20, forward_s1_l11, forward_s1_l21}}},
        {{{transparent_s0_l00, transparent_s0_l10, transparent_s0_l20, transparent_s0_l11, transparent_s0_l21},
          {transparent_s1_l00, transparent_s1_l10, transparent_s1_l20, transparent_s1_l11, transparent_s1_l21}}},
        {{{transparent_fog_s0_l00, transparent_fog_s0_l10, transparent_fog_s0_l20, transparent_fog_s0_l11,
           transparent_fog_s0_l21},
          {transparent_fog_s1_l00, transparent_fog_s1_l10, transparent_fog_s1_l20, transparent_fog_s1_l11,
           transparent_fog_s1_l21}}},
    }};
    const std::size_t surface = !variant.transparent ? 0 : variant.scattering ? 2 : 1;
    const std::size_t kind = static_cast<std::size_t>(variant.lights) + (variant.local_shadow ? 2 : 0);
    return shaders[surface][variant.sun_shadow ? 1 : 0][kind];
}

/// What no light concerns leaves most of a variant's bindings alone.
Spirv filter_spirv(const ForwardVariant& variant) {
    return variant.scattering ? Spirv(filter_f1) : Spirv(filter_f0);
}

constexpr VkDescriptorType uniform = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
constexpr VkDescriptorType storage = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
constexpr VkDescriptorType sampled = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
constexpr VkShaderStageFlags vertex = VK_SHADER_STAGE_VERTEX_BIT;
constexpr VkShaderStageFlags fragment = VK_SHADER_STAGE_FRAGMENT_BIT;
constexpr VkShaderStageFlags compute_stage = VK_SHADER_STAGE_COMPUTE_BIT;

using Bindings = std::vector<VkDescriptorSetLayoutBinding>;

void add(Bindings& bindings, std::uint32_t binding, VkDescriptorType type, VkShaderStageFlags stages) {
    bindings.push_back({binding, type, 1, stages, nullptr});
}

Bindings forward_bindings(const ForwardVariant& variant) {
    Bindings bindings;
    add(bindings, 0, uniform, vertex | fragment);
    add(bindings, 1, storage, vertex);
    if (variant.sun_shadow) {
        add(bindings, 2, uniform, fragment);
        add(bindings, 3, sampled, fragment);
    }
    if (variant.lights != LocalLights::none) {
        add(bindings, 4, storage, fragment);
    }
    if (variant.lights == LocalLights::of_cluster) {
        add(bindings, 5, uniform, fragment);
        add(bindings, 6, storage, fragment);
    }
    if (variant.scattering) {
        add(bindings, 7, uniform, fragment);
        add(bindings, 8, sampled, fragment);
    }
    if (variant.local_shadow) {
        add(bindings, 9, sampled, fragment);
        add(bindings, 10, storage, fragment);
    }
    return bindings;
}

/// Depth passes of mask materials read these features only; others would make pipelines that are the same.
constexpr std::uint32_t mask_features = feature_base_color_texture | feature_uv_transform;

} // namespace

std::uint32_t RendererPipelines::unrolled_lights(const Device& device, std::uint32_t light_count) {
    constexpr std::uint32_t most = 32; // bits of a word of a cluster's mask
    // Lavapipe jumps over masked-out code in Mesa 25.0.7 and does not in 22.3.6: the sample's frame was 34 % shorter
    // with unrolled lights on the former and 17 % longer on the latter.
    return device.is_lavapipe() && device.info().mesa_major > 22 && light_count <= most ? light_count : 0;
}

tl::expected<RendererPipelines::Layout*, Error> RendererPipelines::layout(const LayoutKey& key) {
    if (const auto found = layouts_.find(key); found != layouts_.end()) {
        return &found->second;
    }
    Bindings bindings;
    bool has_materials = false;
    std::uint32_t push_bytes = 0;
    VkShaderStageFlags push_stages = 0;
    switch (key.kind) {
    case Kind::depth_view:
    case Kind::depth_cascade:
    case Kind::depth_local:
        add(bindings, 0, key.kind == Kind::depth_local ? storage : uniform, vertex);
        add(bindings, 1, storage, vertex);
        has_materials = true;
        if (key.kind != Kind::depth_view) {
            push_bytes = (key.kind == Kind::depth_local ? 2 : 1) * sizeof(std::uint32_t);
            push_stages = vertex;
        }
        break;
    case Kind::forward:
        bindings = forward_bindings(key.variant);
        has_materials = true;
        break;
    case Kind::sky: add(bindings, 0, uniform, fragment); break;
    case Kind::luminance_sums:
        add(bindings, 0, sampled, compute_stage);
        add(bindings, 1, storage, compute_stage);
        push_bytes = sizeof(LuminancePush);
        push_stages = compute_stage;
        break;
    case Kind::exposure:
        add(bindings, 0, storage, compute_stage);
        add(bindings, 1, storage, compute_stage);
        push_bytes = sizeof(ExposurePush);
        push_stages = compute_stage;
        break;
    case Kind::tone_mapping:
        add(bindings, 0, sampled, fragment);
        push_bytes = sizeof(float);
        push_stages = fragment;
        break;
    case Kind::tone_mapping_automatic:
        add(bindings, 0, sampled, fragment);
        add(bindings, 1, storage, fragment);
        break;
    }
    auto set = create_set_layout(*device_, bindings, true);
    if (!set) {
        return tl::unexpected(set.error());
    }
    const std::array<VkDescriptorSetLayout, 2> sets = {set->get(), materials_};
    auto pipeline =
        create_pipeline_layout(*device_, std::span(sets).first(has_materials ? 2 : 1), push_bytes, push_stages);
    if (!pipeline) {
        return tl::unexpected(pipeline.error());
    }
    return &layouts_.emplace(key, Layout{std::move(*set), std::move(*pipeline), {}}).first->second;
}

template <typename Make>
tl::expected<Program, Error> RendererPipelines::find_or_make(const PipelineKey& key, Make&& make) {
    const auto shared = layout(key.layout);
    if (!shared) {
        return tl::unexpected(shared.error());
    }
    Layout& of = **shared;
    auto found = pipelines_.find(key);
    if (found == pipelines_.end()) {
        tl::expected<Pipeline, Error> made = make(of.pipeline.get());
        if (!made) {
            return tl::unexpected(made.error());
        }
        rg::merge_bindings(of.bindings, made->bindings());
        found = pipelines_.emplace(key, std::move(*made)).first;
    }
    return Program{of.pipeline.get(), found->second.get(), &of.bindings};
}

tl::expected<Program, Error> RendererPipelines::depth(DepthTarget target, bool mask, std::uint32_t features) {
    struct Of {
        Kind kind;
        Spirv plain;
        Spirv masked;
    };
    const std::array<Of, 3> targets = {{{Kind::depth_view, depth_view_m0, depth_view_m1},
                                        {Kind::depth_cascade, depth_shadow_m0, depth_shadow_m1},
                                        {Kind::depth_local, depth_local_m0, depth_local_m1}}};
    const Of& of = targets[static_cast<std::size_t>(target)];
    const std::uint32_t used = mask ? features & mask_features : 0U;
    return find_or_make({{of.kind, {}}, mask, used}, [&](VkPipelineLayout pipeline_layout) {
        const SpecializationConstant constant{0, used};
        return create_graphics_pipeline(
            *device_, cache_,
            {.layout = pipeline_layout,
             .vertex_spirv = mask ? of.masked : of.plain,
             .fragment_spirv = mask ? Spirv(depth_mask_fragment) : Spirv(),
             .constants = {&constant, 1},
             .vertex_bindings = vertex_bindings(mask),
             .vertex_attributes = vertex_attributes(mask),
             .depth_format = depth_format,
             .depth_test = true,
             .depth_write = true,
             .depth_compare = target == DepthTarget::cascade ? VK_COMPARE_OP_LESS : VK_COMPARE_OP_GREATER,
             .dynamic_culling = true});
    });
}

tl::expected<Program, Error> RendererPipelines::forward(const ForwardVariant& variant, std::uint32_t features) {
    return find_or_make({{Kind::forward, variant}, false, features}, [&](VkPipelineLayout pipeline_layout) {
        const LightMarch march = variant.air.value_or(LightMarch{});
        const std::array<SpecializationConstant, 7> constants = {{{0, features},
                                                                  {1, unrolled_lights_},
                                                                  {2, variant.air ? 1U : 0U},
                                                                  {3, march.volumes ? 1U : 0U},
                                                                  {4, march.octaves},
                                                                  {5, variant.airlight_features},
                                                                  {6, march.colored || variant.colored_scattering}}};
        const bool filter = (features & feature_filter) != 0;
        const VkPipelineColorBlendAttachmentState blend = laid_over(filter);
        using Blends = std::span<const VkPipelineColorBlendAttachmentState>;
        return create_graphics_pipeline(
            *device_, cache_,
            {.layout = pipeline_layout,
             .vertex_spirv = forward_vertex,
             .fragment_spirv = filter ? filter_spirv(variant) : forward_spirv(variant),
             .constants = constants,
             .vertex_bindings = vertex_bindings(true),
             .vertex_attributes = vertex_attributes(true),
             .color_formats = {&color_format_, 1},
             .depth_format = depth_format,
             .blends = variant.transparent ? Blends(&blend, 1) : Blends(),
             .depth_test = true,
             .depth_write = false,
             // Opaque surfaces are those that the depth pre-pass left, to the bit.
             .depth_compare = variant.transparent ? VK_COMPARE_OP_GREATER_OR_EQUAL : VK_COMPARE_OP_EQUAL,
             .dynamic_culling = true});
    });
}

tl::expected<Program, Error> RendererPipelines::sky() {
    return find_or_make({{Kind::sky, {}}, false, 0}, [&](VkPipelineLayout pipeline_layout) {
        return create_graphics_pipeline(*device_, cache_,
                                        {.layout = pipeline_layout,
                                         .vertex_spirv = full_screen_far_vertex,
                                         .fragment_spirv = sky_fragment,
                                         .color_formats = {&color_format_, 1},
                                         .depth_format = depth_format,
                                         .depth_test = true,
                                         .depth_compare = VK_COMPARE_OP_EQUAL});
    });
}

tl::expected<Program, Error> RendererPipelines::compute(Kind kind, std::span<const std::uint32_t> spirv) {
    return find_or_make({{kind, {}}, false, 0}, [&](VkPipelineLayout pipeline_layout) {
        return create_compute_pipeline(*device_, cache_, pipeline_layout, spirv);
    });
}

tl::expected<Program, Error> RendererPipelines::luminance_sums() {
    return compute(Kind::luminance_sums, luminance_compute);
}

tl::expected<Program, Error> RendererPipelines::exposure() {
    return compute(Kind::exposure, exposure_compute);
}

tl::expected<Program, Error> RendererPipelines::tone_mapping(bool automatic) {
    const Kind kind = automatic ? Kind::tone_mapping_automatic : Kind::tone_mapping;
    return find_or_make({{kind, {}}, false, 0}, [&](VkPipelineLayout pipeline_layout) {
        return create_graphics_pipeline(*device_, cache_,
                                        {.layout = pipeline_layout,
                                         .vertex_spirv = full_screen_far_vertex,
                                         .fragment_spirv = automatic ? Spirv(tone_mapping_a1) : Spirv(tone_mapping_a0),
                                         .color_formats = {&picture_format, 1}});
    });
}

} // namespace tyndall::engine
