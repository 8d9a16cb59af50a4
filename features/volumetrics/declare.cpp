// The passes of the feature, as declared on the graph. Callbacks capture handles and plain data by value.
#include <algorithm>
#include <array>
#include <optional>

#include "features/volumetrics/dispatch.hpp"
#include "features/volumetrics/feature_state.hpp"
#include "features/volumetrics/light_path.hpp"
#include "shaders/common/lights.h"

namespace tyndall::volumetrics {
namespace {

using rg::Access;
using rg::Binding;
using rg::PassContext;
using rg::PassKind;

VkFormat volume_format(const Settings& settings) {
    return settings.storage == StorageFormat::fp16 ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_R32G32B32A32_SFLOAT;
}

/// An image of the grid's columns.
rg::ImageDesc columns_image(const FrameInputs& inputs) {
    const glm::uvec2 columns = allocated_columns(inputs);
    return {.format = volume_format(inputs.settings), .extent = {columns.x, columns.y, 1}};
}

/// `halves` 2: as many slices for what each channel has of its own.
rg::ImageDesc froxel_image(const FrameInputs& inputs, std::uint32_t halves = 1) {
    rg::ImageDesc desc = columns_image(inputs);
    desc.extent.depth = inputs.settings.grid.slices * halves;
    desc.type = VK_IMAGE_TYPE_3D;
    return desc;
}

/// The specialization constant `light_changes` of froxel_lighting.comp: some processors run loops of no iteration once.
std::uint32_t light_change_kind(const gpu::VolumetricParameters& u) {
    const bool anything = u.temporal.w > 0.0F || u.phase.x * u.motion.w > 0.0F;
    return u.frame.w > 0 ? 2 : anything ? 1 : 0;
}

constexpr rg::ViewDesc array_view{.range = {}, .type = VK_IMAGE_VIEW_TYPE_2D_ARRAY};
constexpr rg::ViewDesc depth_array_view{.range = {.aspects = VK_IMAGE_ASPECT_DEPTH_BIT},
                                        .type = VK_IMAGE_VIEW_TYPE_2D_ARRAY};
constexpr rg::ViewDesc depth_view{.range = {.aspects = VK_IMAGE_ASPECT_DEPTH_BIT}, .type = VK_IMAGE_VIEW_TYPE_2D};

} // namespace

void Feature::State::declare_density(rg::GraphBuilder& graph) {
    const Settings& settings = frame->inputs.settings;
    rg::Image density = graph.create_image(named("fog density"), froxel_image(frame->inputs, frame->colored ? 2 : 1));
    const Dispatch dispatch = covering(frame->density_injection, row_group(settings.grid.width), settings.grid.width,
                                       settings.grid.height, settings.grid.slices);
    auto pass = graph.add_pass(named("density injection"), PassKind::compute);
    pass.on_queue(wish())
        .reads(frame->parameter_buffer, Access::uniform_compute)
        .writes(density, Access::storage_compute);
    rg::Image emitted;
    if (frame->emission) {
        emitted = graph.create_image(named("fog emission"), froxel_image(frame->inputs));
        pass.writes(emitted, Access::storage_compute);
        frame->stages.emission = emitted;
    }
    struct Texture {
        rg::Image image;
        VkSampler sampler;
    };
    const bool map_repeats = frame->inputs.medium.map.edge == MapEdge::repeat;
    std::array<Texture, 7> textures{{{frame->noise[0], shared.repeating},
                                     {frame->noise[1], shared.repeating},
                                     {frame->density_map, map_repeats ? shared.repeating : linear},
                                     {frame->grids[0], linear},
                                     {frame->grids[1], linear},
                                     {frame->grids[2], linear},
                                     {frame->grids[3], linear}}};
    Texture any{};
    for (const Texture& texture : textures) {
        if (texture.image.valid()) {
            pass.reads(texture.image, Access::sampled_compute);
            any = texture;
        }
    }
    for (Texture& texture : textures) { // every declared binding must be written
        texture = texture.image.valid() ? texture : any;
    }
    const rg::Buffer particles = frame->particle_buffer;
    if (particles.valid()) {
        pass.reads(particles, Access::storage_compute)
            .reads(frame->particle_masks, Access::storage_compute)
            .reads(frame->particle_cluster_parameters, Access::uniform_compute);
    }
    pass.executes([=, parameters = frame->parameter_buffer, masks = frame->particle_masks,
                   clusters = frame->particle_cluster_parameters](PassContext& ctx) {
        std::array<Binding, 6 + textures.size()> bindings{ctx.uniform(0, parameters), ctx.storage(1, density)};
        std::size_t count = 2;
        if (emitted.valid()) {
            bindings[count++] = ctx.storage(2, emitted);
        }
        for (std::uint32_t i = 0; i < textures.size() && any.image.valid(); ++i) {
            bindings[count++] = ctx.sampled(3 + i, textures[i].image, textures[i].sampler);
        }
        if (particles.valid()) {
            bindings[count++] = ctx.storage(10, particles);
            bindings[count++] = ctx.storage(11, masks);
            bindings[count++] = ctx.uniform(12, clusters);
        }
        run(ctx, dispatch, std::span(bindings).first(count));
    });
    frame->stages.density = density;
}

void Feature::State::declare_clustering(rg::GraphBuilder& graph) {
    const gpu::LightClusters& c = frame->cluster_parameters;
    const std::uint32_t words_of_slab = c.counts.x * c.counts.y * c.block.w;
    const HostBuffers::Slot& slot = host_buffers->slot(frame->inputs.frame_slot);
    const rg::Buffer parameters = graph.import_buffer(named("light cluster parameters"),
                                                      {.size_bytes = sizeof(gpu::LightClusters)}, {.read_only = true});
    graph.share_between_queues(parameters);
    import_bindings.push_back({.resource = parameters.resource, .buffer = slot.clusters});
    rg::Buffer masks =
        graph.create_buffer(named("light cluster masks"), {.size_bytes = VkDeviceSize{words_of_slab} * c.counts.z * 4});
    const std::uint32_t compact_count = std::min<std::uint32_t>(c.grid.w, TYNDALL_COMPACT_LIGHT_COUNT);
    rg::Buffer compact = graph.create_buffer(named("compact lights"),
                                             {.size_bytes = sizeof(gpu::GpuLight) * TYNDALL_COMPACT_LIGHT_COUNT});
    const Dispatch dispatch =
        covering(frame->light_clustering, {64, 1, 1}, std::max(words_of_slab, compact_count), c.counts.z, 1);
    auto pass = graph.add_pass(named("light clustering"), PassKind::compute);
    pass.on_queue(wish())
        .reads(frame->parameter_buffer, Access::uniform_compute)
        .reads(parameters, Access::uniform_compute)
        .reads(frame->light_buffer, Access::storage_compute)
        .writes(masks, Access::storage_compute)
        .writes(compact, Access::storage_compute);
    pass.executes([=, volume = frame->parameter_buffer, lights = frame->light_buffer](PassContext& ctx) {
        run(ctx, dispatch,
            std::array{ctx.uniform(0, volume), ctx.uniform(1, parameters), ctx.storage(2, lights),
                       ctx.storage(3, masks), ctx.storage(4, compact)});
    });
    frame->clusters = ClusterResources{masks, parameters};
    frame->compact_lights = compact;
}

tl::expected<void, Error> Feature::State::declare_esm(rg::GraphBuilder& graph, const ShadowResources& shadow) {
    const std::optional<rg::ImageDesc> cascades = graph.describe(shadow.cascades);
    if (!cascades || !shadow.parameters.valid()) {
        return tl::unexpected(
            Error{"The sun casts shadows, so declare_after_shadow_maps needs cascades and parameters."});
    }
    if (cascades->extent.width != cascades->extent.height || cascades->extent.width < 32 || cascades->layers > 4) {
        return tl::unexpected(Error{"The sun's cascades must be square, at least 32 texels wide, and at most 4."});
    }
    const std::uint32_t source_size = cascades->extent.width;
    std::uint32_t size = frame->inputs.settings.shadow.esm_size;
    while (size * 2 > source_size) {
        size /= 2;
    }
    const auto texels = static_cast<float>(size);
    const auto source_texels = static_cast<float>(source_size);
    frame->parameters.esm_size = glm::vec4(texels, 1.0F / texels, source_texels, 1.0F / source_texels);
    write_parameters();
    if (frame->inputs.settings.visibility.method != SunVisibility::prefiltered) {
        omit("ESM downsample and blur", "fog looks the sun up in the cascades themselves");
        frame->shadow_map = shadow.cascades;
        return {};
    }

    const GroupShape group = row_group(size);
    const auto downsample = pipelines.compute(esm_downsample_shader(), group);
    const auto blur_x = pipelines.compute(esm_blur_shader(), group, std::array{0U});
    const auto blur_y = pipelines.compute(esm_blur_shader(), group, std::array{1U});
    for (const auto* program : {&downsample, &blur_x, &blur_y}) {
        if (!*program) {
            return tl::unexpected(program->error());
        }
    }
    const rg::ImageDesc esm_desc{.format = VK_FORMAT_R32_SFLOAT, .extent = {size, size, 1}, .layers = cascades->layers};
    const std::uint32_t layers = cascades->layers;
    rg::Image esm = graph.create_image(named("sun ESM"), esm_desc);
    auto down = graph.add_pass(named("ESM downsample"), PassKind::compute);
    down.on_queue(wish())
        .reads(frame->parameter_buffer, Access::uniform_compute)
        .reads(shadow.cascades, Access::sampled_compute)
        .writes(esm, Access::storage_compute);
    down.executes([=, dispatch = covering(*downsample, group, size, size, layers), parameters = frame->parameter_buffer,
                   depth = shadow.cascades, sampler = nearest](PassContext& ctx) {
        run(ctx, dispatch,
            std::array{ctx.uniform(0, parameters), ctx.sampled(1, depth, sampler, depth_array_view),
                       ctx.storage(2, esm, array_view)});
    });

    const auto blur = [&](const char* pass_name, const char* image_name, const Program& program, rg::Image source) {
        rg::Image blurred = graph.create_image(named(image_name), esm_desc);
        auto pass = graph.add_pass(named(pass_name), PassKind::compute);
        pass.on_queue(wish()).reads(source, Access::storage_compute).writes(blurred, Access::storage_compute);
        pass.executes([=, dispatch = covering(program, group, size, size, layers)](PassContext& ctx) {
            run(ctx, dispatch, std::array{ctx.storage(0, source, array_view), ctx.storage(1, blurred, array_view)});
        });
        return blurred;
    };
    const rg::Image across = blur("ESM blur x", "sun ESM, blurred in x", *blur_x, esm);
    frame->stages.esm = blur("ESM blur y", "sun ESM, blurred", *blur_y, across);
    frame->shadow_map = frame->stages.esm;
    return {};
}

tl::expected<void, Error> Feature::State::declare_lighting(rg::GraphBuilder& graph, const ShadowResources& shadow) {
    const FrameInputs& inputs = frame->inputs;
    const LightingVariant variant{.storage = inputs.settings.storage,
                                  .sun_shadow = frame->sun_shadow,
                                  .lights = frame->froxel_lights,
                                  .local_shadow = frame->froxel_shadow,
                                  .history = inputs.settings.temporal.enabled};
    const GridSettings& grid = inputs.settings.grid;
    const VisibilitySettings& visibility = inputs.settings.visibility;
    const GroupShape group = row_group(grid.width);
    // What the constants do not name keeps its value, so that a frame without them shares its pipeline.
    const PhaseLobes phase = phase_of(inputs.medium);
    const LightMarch march = light_march(inputs.medium, inputs.settings);
    const std::array<std::uint32_t, 16> constants{
        inputs.sun && inputs.sun->illuminance_lux != glm::vec3(0.0F),
        variant.sun_shadow ? graph.describe(frame->shadow_map)->layers : 0,
        is_perspective(inputs.camera),
        variant.history && frame->camera_stands,
        static_cast<std::uint32_t>(visibility.method),
        visibility.method == SunVisibility::n_taps ? visibility.taps : 1,
        phase.count,
        packed_functions(phase),
        is_directed(inputs.medium),
        frame->depth_curve,
        variant.history ? light_change_kind(frame->parameters) : 0U,
        weakens_light(inputs.medium, inputs.settings),
        march.volumes,
        march.octaves,
        frame->colored,
        variant.lights != LocalLights::none && frame->airlight_features != 0,
    };
    const auto program = pipelines.compute(froxel_lighting_shader(variant), group, constants);
    if (!program) {
        return tl::unexpected(program.error());
    }

    rg::Image in_scattered = graph.create_image(named("in-scattered radiance"), froxel_image(inputs));
    rg::Image history;
    auto pass = graph.add_pass(named("froxel lighting"), PassKind::compute);
    pass.on_queue(wish()).reads(frame->parameter_buffer, Access::uniform_compute);
    if (variant.history) {
        history = graph.history_of(in_scattered);
        pass.reads(history, Access::sampled_compute);
    }
    if (variant.sun_shadow) {
        pass.reads(frame->shadow_map, Access::sampled_compute).reads(shadow.parameters, Access::uniform_compute);
    }
    const bool compact = variant.lights == LocalLights::clustered_compact;
    const rg::Buffer light_buffer = compact ? frame->compact_lights : frame->light_buffer;
    if (variant.lights != LocalLights::none) {
        pass.reads(light_buffer, compact ? Access::uniform_compute : Access::storage_compute);
    }
    if (is_clustered(variant.lights)) {
        pass.reads(frame->clusters->parameters, Access::uniform_compute)
            .reads(frame->clusters->masks, Access::storage_compute);
    }
    if (variant.local_shadow) {
        pass.reads(shadow.local_maps, Access::sampled_compute).reads(shadow.local_records, Access::storage_compute);
    }
    pass.writes(in_scattered, Access::storage_compute);
    pass.executes([=, dispatch = covering(*program, group, grid.width, grid.height, grid.slices),
                   parameters = frame->parameter_buffer, shadow_map = frame->shadow_map,
                   clusters = frame->clusters.value_or(ClusterResources{}), cold = frame->cold, linear_sampler = linear,
                   nearest_sampler = nearest](PassContext& ctx) {
        std::array<Binding, 10> bindings{};
        std::size_t count = 0;
        bindings[count++] = ctx.uniform(0, parameters);
        bindings[count++] = ctx.storage(1, in_scattered);
        if (variant.sun_shadow) {
            bindings[count++] =
                ctx.sampled(2, shadow_map, nearest_sampler,
                            visibility.method == SunVisibility::prefiltered ? array_view : depth_array_view);
            bindings[count++] = ctx.uniform(3, shadow.parameters);
        }
        if (variant.lights != LocalLights::none) {
            bindings[count++] = compact ? ctx.uniform(4, light_buffer) : ctx.storage(4, light_buffer);
        }
        if (is_clustered(variant.lights)) {
            bindings[count++] = ctx.uniform(5, clusters.parameters);
            bindings[count++] = ctx.storage(6, clusters.masks);
        }
        if (variant.history) {
            bindings[count++] = ctx.sampled(7, history, linear_sampler);
            const std::uint32_t valid = !cold && ctx.history_valid(history) ? 1 : 0;
            ctx.vk().CmdPushConstants(ctx.cmd(), dispatch.program.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, 4, &valid);
        }
        if (variant.local_shadow) {
            bindings[count++] = ctx.sampled(8, shadow.local_maps, nearest_sampler, depth_array_view);
            bindings[count++] = ctx.storage(9, shadow.local_records);
        }
        run(ctx, dispatch, std::span(bindings).first(count));
    });
    frame->volume = VolumeResources{.in_scattered = in_scattered,
                                    .parameters = frame->parameter_buffer,
                                    .airlight_features = frame->airlight_features,
                                    .colored = frame->colored};
    return {};
}

tl::expected<void, Error> Feature::State::declare_accumulation(rg::GraphBuilder& graph) {
    const Settings& settings = frame->inputs.settings;
    const GridSettings& grid = settings.grid;
    const GroupShape group = row_group(grid.width, 32); // few columns: small groups keep all cores busy
    const auto program = pipelines.compute(
        accumulation_shader(settings.storage, frame->colored, settings.error_estimate, frame->emission), group,
        std::array{static_cast<std::uint32_t>(settings.integrator), std::uint32_t{frame->depth_curve}});
    if (!program) {
        frame->volume.reset();
        return tl::unexpected(program.error());
    }
    rg::ImageDesc boundaries = columns_image(frame->inputs);
    boundaries.layers = (grid.slices + 1) * (frame->colored ? 2 : 1);
    rg::Image accumulated = graph.create_image(named("accumulated fog"), boundaries);
    auto pass = graph.add_pass(named("fog accumulation"), PassKind::compute);
    pass.on_queue(wish())
        .reads(frame->parameter_buffer, Access::uniform_compute)
        .reads(frame->stages.density, Access::storage_compute)
        .reads(frame->volume->in_scattered, Access::storage_compute)
        .writes(accumulated, Access::storage_compute);
    const rg::Image emitted = frame->stages.emission;
    if (emitted.valid()) {
        pass.reads(emitted, Access::storage_compute);
    }
    rg::Image estimate;
    if (settings.error_estimate) {
        estimate = graph.create_image(named("fog error estimate"), {.format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                                                    .extent = {grid.width, grid.height, 1}});
        pass.writes(estimate, Access::storage_compute);
        frame->stages.error_estimate = estimate;
    }
    pass.executes([=, dispatch = covering(*program, group, grid.width, grid.height, 1),
                   parameters = frame->parameter_buffer, density = frame->stages.density,
                   in_scattered = frame->volume->in_scattered](PassContext& ctx) {
        std::array<Binding, 6> bindings{ctx.uniform(0, parameters), ctx.storage(1, density),
                                        ctx.storage(2, in_scattered), ctx.storage(3, accumulated, array_view)};
        std::size_t count = 4;
        if (estimate.valid()) {
            bindings[count++] = ctx.storage(4, estimate);
        }
        if (emitted.valid()) {
            bindings[count++] = ctx.storage(5, emitted);
        }
        run(ctx, dispatch, std::span(bindings).first(count));
    });
    frame->volume->accumulated = accumulated;
    return {};
}

void Feature::State::declare_fog(rg::GraphBuilder& graph, const OpaqueResources& resources) {
    auto pass = graph.add_pass(named("fog on opaque"), PassKind::graphics);
    pass.reads(frame->parameter_buffer, Access::uniform_graphics)
        .reads(resources.depth, Access::sampled_fragment)
        .reads(frame->volume->accumulated, Access::sampled_fragment)
        .modifies(resources.color, Access::color_attachment);
    if (frame->airlight_shadow) {
        pass.reads(frame->shadow.local_maps, Access::sampled_fragment)
            .reads(frame->shadow.local_records, Access::storage_graphics);
    }
    pass.executes([program = frame->fog_on_opaque, parameters = frame->parameter_buffer, depth = resources.depth,
                   accumulated = frame->volume->accumulated, shadow = frame->shadow,
                   local_shadow = frame->airlight_shadow, linear_sampler = linear,
                   nearest_sampler = nearest](PassContext& ctx) {
        ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_GRAPHICS, program.pipeline);
        std::array<Binding, 5> bindings{ctx.uniform(0, parameters), ctx.sampled(1, depth, nearest_sampler, depth_view),
                                        ctx.sampled(2, accumulated, linear_sampler, array_view)};
        if (local_shadow) {
            bindings[3] = ctx.sampled(3, shadow.local_maps, nearest_sampler, depth_array_view);
            bindings[4] = ctx.storage(4, shadow.local_records);
        }
        ctx.push(VK_PIPELINE_BIND_POINT_GRAPHICS, program.layout, 0, std::span(bindings).first(local_shadow ? 5 : 3),
                 program.bindings);
        ctx.vk().CmdDraw(ctx.cmd(), 3, 1, 0, 0);
    });
}

} // namespace tyndall::volumetrics
