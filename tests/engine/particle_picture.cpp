#include "tests/engine/particle_picture.hpp"

#include <cmath>

#include "features/volumetrics/airlight.hpp"
#include "features/volumetrics/parameters.hpp"
#include "shaders/common/local_shadow.h"

namespace tyndall::test {
namespace {

constexpr std::uint32_t slices = 8;

} // namespace

ParticleEmitter resting(const glm::dvec3& position_m, float radius_m, float opacity) {
    return {.name = "one",
            .kind = engine::ParticleKind::dust,
            .position_m = position_m,
            .rate_per_s = 0.1,
            .lifetime_s = 5.0,
            .start_radius_m = radius_m,
            .end_radius_m = radius_m,
            .opacity = opacity,
            .albedo = {0.5F, 0.75F, 1.0F}};
}

void ParticlesDrawTest::add_fog(rg::GraphBuilder& graph, const Fog& fog, const engine::FrameView& view,
                                const std::vector<gpu::GpuLight>& lamps, engine::ParticleSurroundings& surroundings) {
    const volumetrics::GridSettings grid{.width = 2, .height = 2, .slices = slices, .range_m = 40.0F, .shape_m = 10.0F};
    const double log_term = std::log1p(static_cast<double>(grid.range_m) / static_cast<double>(grid.shape_m));
    volumetrics::FrameInputs inputs;
    inputs.settings.grid = grid;
    inputs.camera.clip_from_view = view.clip_from_view;
    inputs.medium.homogeneous.extinction_per_m = fog.lamp_extinction_per_m;
    inputs.lights = lamps;
    volumetrics::AirlightChoice choice;
    for (std::uint32_t i = 0; i < lamps.size(); ++i) {
        choice.lights.push_back(i);
    }
    gpu::VolumetricParameters parameters = volumetrics::volumetric_parameters(inputs, std::nullopt);
    parameters.volume.scale.y = 1.0F;
    parameters.airlights = volumetrics::airlights(inputs, choice);
    engine::ScatteringVolumeImages images{
        .accumulated = graph.create_image(
            "accumulated", {.format = VK_FORMAT_R32G32B32A32_SFLOAT, .extent = {2, 2, 1}, .layers = slices + 1}),
        .in_scattered = graph.create_image(
            "in-scattered",
            {.format = VK_FORMAT_R32G32B32A32_SFLOAT, .extent = {2, 2, slices}, .type = VK_IMAGE_TYPE_3D}),
        .parameters = import(graph, "volume", std::span<const gpu::VolumetricParameters>(&parameters, 1)),
        .airlight_features = volumetrics::airlight_features(inputs, choice),
    };
    rg::PassBuilder pass = graph.add_pass("fog", rg::PassKind::transfer);
    pass.writes(images.accumulated, rg::Access::transfer_destination)
        .writes(images.in_scattered, rg::Access::transfer_destination)
        .executes([=](rg::PassContext& ctx) {
            for (std::uint32_t k = 0; k <= slices; ++k) {
                const double z = static_cast<double>(grid.shape_m) * std::expm1(log_term * k / slices);
                const double tau = fog.extinction_per_m * z;
                const auto radiance = static_cast<float>(fog.source * -std::expm1(-tau));
                const VkClearColorValue value{.float32 = {radiance, radiance, radiance, static_cast<float>(tau)}};
                const VkImageSubresourceRange layer{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, k, 1};
                ctx.vk().CmdClearColorImage(ctx.cmd(), ctx.image(images.accumulated), ctx.layout(images.accumulated),
                                            &value, 1, &layer);
            }
            const auto s = static_cast<float>(fog.in_scattered);
            const VkClearColorValue value{.float32 = {s, s, s, 1.0F}};
            const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
            ctx.vk().CmdClearColorImage(ctx.cmd(), ctx.image(images.in_scattered), ctx.layout(images.in_scattered),
                                        &value, 1, &all);
        });
    surroundings.scattering = images;
}

void ParticlesDrawTest::add_shadow(rg::GraphBuilder& graph, float depth, engine::ParticleSurroundings& surroundings) {
    engine::SunShadow shadow{};
    shadow.cascades =
        graph.create_image("cascades", {.format = VK_FORMAT_D32_SFLOAT, .extent = {4, 4, 1}, .layers = 4});
    // Sun from above: uv is xz over 40 m around the eye, depth runs downward from 20 m above it.
    glm::mat4 shadow_from_render(0.0F);
    shadow_from_render[0][0] = 1.0F / 40.0F;
    shadow_from_render[2][1] = 1.0F / 40.0F;
    shadow_from_render[1][2] = -1.0F / 40.0F;
    shadow_from_render[3] = glm::vec4(0.5F, 0.5F, 0.5F, 1.0F);
    shadow.values.shadow_from_render[0] = shadow_from_render;
    shadow.values.split_depth_m = glm::vec4(100.0F);
    shadow.values.direction_count = glm::vec4(0.0F, -1.0F, 0.0F, 1.0F);
    shadow.parameters = import(graph, "sun", std::span<const gpu::SunCascades>(&shadow.values, 1));
    for (std::uint32_t layer = 0; layer < 4; ++layer) {
        graph.add_pass("cascade " + std::to_string(layer), rg::PassKind::graphics)
            .writes(shadow.cascades, rg::Access::depth_attachment,
                    {.range = {.base_layer = layer, .layer_count = 1}, .clear = rg::clear_depth(depth)});
    }
    surroundings.sun_shadow = shadow;
}

void ParticlesDrawTest::add_local_shadow(rg::GraphBuilder& graph, const gpu::GpuLight& light, double caster_m,
                                         engine::ParticleSurroundings& surroundings) {
    const float near_m = 0.1F;
    const glm::vec3 at(light.position_range);
    const gpu::LocalShadow record{.row_x = {1.0F, 0.0F, 0.0F, -at.x},
                                  .row_y = {0.0F, 1.0F, 0.0F, -at.y},
                                  .row_z = {0.0F, 0.0F, 1.0F, -at.z},
                                  .lens = {0.5F, near_m, 0.0F, 1.0F},
                                  .texel = {0.5F, 4.0F, 0.25F, 0.0F}};
    engine::LocalShadows shadows;
    shadows.maps =
        graph.create_image("local shadow maps", {.format = VK_FORMAT_D32_SFLOAT, .extent = {4, 4, 1}, .layers = 6});
    shadows.records = import(graph, "local shadow records", std::span<const gpu::LocalShadow>(&record, 1));
    for (std::uint32_t layer = 0; layer < 6; ++layer) {
        graph.add_pass("local shadow map " + std::to_string(layer), rg::PassKind::graphics)
            .writes(shadows.maps, rg::Access::depth_attachment,
                    {.range = {.base_layer = layer, .layer_count = 1},
                     .clear = rg::clear_depth(near_m / static_cast<float>(caster_m))});
    }
    surroundings.local_shadows = shadows;
}

std::vector<glm::vec4> ParticlesDrawTest::draw(const std::vector<ParticleEmitter>& emitters, const Picture& picture) {
    constexpr VkFormat color_format = VK_FORMAT_R32G32B32A32_SFLOAT;
    constexpr VkFormat depth_format = VK_FORMAT_D32_SFLOAT;
    imports_.clear();
    auto system = engine::ParticleSystem::create(device(), VK_NULL_HANDLE, emitters, 2, color_format, depth_format);
    EXPECT_TRUE(system.has_value()) << (system ? "" : system.error().message);
    rg::GraphBuilder graph;
    engine::ParticleLight light = picture.light;
    light.light_count = static_cast<std::uint32_t>(picture.lights.size());
    const auto draws = system->declare(graph, picture.view, light, picture.split_depths_m);
    EXPECT_TRUE(draws.has_value());
    rg::Image depth = graph.create_image("depth", {.format = depth_format, .extent = {size_px, size_px, 1}});
    graph.add_pass("depth", rg::PassKind::graphics)
        .writes(depth, rg::Access::depth_attachment,
                {.clear = rg::clear_depth(static_cast<float>(0.05 / picture.surface_m))});
    rg::Image color = graph.create_image("color", {.format = color_format, .extent = {size_px, size_px, 1}});
    const glm::vec4 b(background);
    graph.add_pass("background", rg::PassKind::graphics)
        .writes(color, rg::Access::color_attachment, {.clear = rg::clear_color(b.r, b.g, b.b, b.a)});
    engine::ParticleSurroundings surroundings{.scene_depth = depth};
    if (picture.fog) {
        add_fog(graph, *picture.fog, picture.view, picture.lights, surroundings);
    }
    if (picture.shadow_depth) {
        add_shadow(graph, *picture.shadow_depth, surroundings);
    }
    if (picture.caster_m) {
        add_local_shadow(graph, picture.lights.front(), *picture.caster_m, surroundings);
    }
    if (!picture.lights.empty()) {
        surroundings.lights = engine::SceneLights{
            import(graph, "lights", std::span<const gpu::GpuLight>(picture.lights)), picture.lights};
    }
    rg::PassBuilder pass = graph.add_pass("transparents", rg::PassKind::graphics);
    pass.modifies(color, rg::Access::color_attachment).reads(depth, rg::Access::depth_attachment);
    EXPECT_TRUE(system->add_reads(pass, *draws, surroundings));
    const engine::ParticleSystem& particles = *system;
    pass.executes([&particles, surroundings, draws = *draws, intervals = picture.intervals](rg::PassContext& ctx) {
        for (const std::uint32_t interval : intervals) {
            particles.draw(ctx, draws, surroundings, interval);
        }
    });
    const engine::Buffer& memory = host_buffer(size_px * size_px * sizeof(glm::vec4));
    rg::Buffer pixels = graph.import_buffer("pixels", {.size_bytes = memory.size_bytes()}, read_by_host());
    graph.add_pass("read back", rg::PassKind::transfer)
        .reads(color, rg::Access::transfer_source)
        .writes(pixels, rg::Access::transfer_destination)
        .executes([color, pixels](rg::PassContext& ctx) {
            const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                            .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                            .imageExtent = {size_px, size_px, 1}};
            const VkCopyImageToBufferInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                                .srcImage = ctx.image(color),
                                                .srcImageLayout = ctx.layout(color),
                                                .dstBuffer = ctx.buffer(pixels),
                                                .regionCount = 1,
                                                .pRegions = &region};
            ctx.vk().CmdCopyImageToBuffer2(ctx.cmd(), &copy);
        });
    imports_.push_back({.resource = pixels.resource, .buffer = memory.handle()});
    imports_.insert(imports_.end(), draws->imports.begin(), draws->imports.end());
    run(graph.finish(), imports_);
    const std::span<glm::vec4> result = memory.mapped_as<glm::vec4>();
    return {result.begin(), result.end()};
}

glm::dvec4 over(const glm::dvec4& behind, const glm::dvec3& radiance, double alpha) {
    return {alpha * radiance + (1.0 - alpha) * glm::dvec3(behind), alpha + (1.0 - alpha) * behind.a};
}

void expect_near(const glm::dvec4& actual, const glm::dvec4& expected, double relative) {
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(actual[i], expected[i], relative * std::abs(expected[i])) << "channel " << i;
    }
}

} // namespace tyndall::test
