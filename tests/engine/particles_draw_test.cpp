// Billboards on a device: coverage, order, light and fog of single particles against closed forms.
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "engine/particles.hpp"
#include "features/volumetrics/airlight.hpp"
#include "features/volumetrics/parameters.hpp"
#include "shaders/common/lights.h"
#include "shaders/common/local_shadow.h"
#include "tests/engine/particles_fixture.hpp"

namespace tyndall::test {
namespace {

using engine::ParticleEmitter;

constexpr std::uint32_t size_px = 65; // odd: a pixel's centre lies on the axis of the view
constexpr std::uint32_t slices = 8;

/// A single resting particle, in the middle of its life at the time of `view`.
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

/// A homogeneous medium and the light in it, the same in every column.
struct Fog {
    double extinction_per_m = 0.1;
    double source = 3.0;                 ///< radiance of an infinitely deep medium
    double in_scattered = 2.0;           ///< light per unit of albedo
    float lamp_extinction_per_m = 1e-9F; ///< of the air that lamps shine in
};

struct Picture {
    engine::FrameView view = square_view({0.0, 0.0, 0.0}, 2.0, 0.5, size_px);
    engine::ParticleLight light{.ambient_radiance = {4.0F, 4.0F, 4.0F}};
    std::vector<float> split_depths_m = {};
    std::vector<std::uint32_t> intervals = {0}; ///< drawn, in this order
    double surface_m = 1e9;                     ///< view depth of the opaque scene
    std::optional<Fog> fog = {};
    std::optional<float> shadow_depth = {}; ///< what the only cascade holds
    std::vector<gpu::GpuLight> lights = {}; ///< with fog those that its volume leaves out
    std::optional<double> caster_m = {};    ///< from the first light, in all directions: it alone casts a shadow
};

constexpr glm::dvec4 background{10.0, 20.0, 30.0, 1.0};

class ParticlesDrawTest : public ParticleFrameTest {
protected:
    [[nodiscard]] std::vector<glm::vec4> draw(const std::vector<ParticleEmitter>& emitters, const Picture& picture);
    [[nodiscard]] glm::dvec4 center(const std::vector<ParticleEmitter>& emitters, const Picture& picture) {
        const std::vector<glm::vec4> pixels = draw(emitters, picture);
        return glm::dvec4(pixels[(size_px / 2) * size_px + size_px / 2]);
    }

private:
    void add_fog(rg::GraphBuilder& graph, const Fog& fog, const engine::FrameView& view,
                 const std::vector<gpu::GpuLight>& lamps, engine::ParticleSurroundings& surroundings);
    void add_shadow(rg::GraphBuilder& graph, float depth, engine::ParticleSurroundings& surroundings);
    void add_local_shadow(rg::GraphBuilder& graph, const gpu::GpuLight& light, double caster_m,
                          engine::ParticleSurroundings& surroundings);
    template <typename T>
    [[nodiscard]] rg::Buffer import(rg::GraphBuilder& graph, std::string_view name, std::span<const T> content) {
        const engine::Buffer& memory = upload(content);
        const rg::Buffer buffer = graph.import_buffer(name, {.size_bytes = memory.size_bytes()}, written_by_host());
        imports_.push_back({.resource = buffer.resource, .buffer = memory.handle()});
        return buffer;
    }

    std::vector<rg::ImportBinding> imports_;
};

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

/// Premultiplied over the background: a particle of radiance C, seen through T and L, with alpha a.
glm::dvec4 over(const glm::dvec4& behind, const glm::dvec3& radiance, double alpha) {
    return {alpha * radiance + (1.0 - alpha) * glm::dvec3(behind), alpha + (1.0 - alpha) * behind.a};
}

void expect_near(const glm::dvec4& actual, const glm::dvec4& expected, double relative) {
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(actual[i], expected[i], relative * std::abs(expected[i])) << "channel " << i;
    }
}

const glm::dvec3 albedo{0.5, 0.75, 1.0};

TEST_F(ParticlesDrawTest, TheMiddleHasTheParticlesAlphaAndAmbientLight) {
    expect_near(center({resting({0, 0, -10}, 1.0F, 0.4F)}, {}), over(background, 4.0 * albedo, 0.4), 1e-5);
}

TEST_F(ParticlesDrawTest, CoverageFallsToTheRimAndIsRound) {
    const float radius_m = 2.0F;
    const std::vector<glm::vec4> pixels = draw({resting({0, 0, -10}, radius_m, 1.0F)}, {});
    // The view is 10 m wide at the particle.
    for (std::uint32_t y = 0; y < size_px; ++y) {
        for (std::uint32_t x = 0; x < size_px; ++x) {
            const double dx = (static_cast<double>(x) - 32.0) / size_px * 10.0 / 2.0;
            const double dy = (static_cast<double>(y) - 32.0) / size_px * 10.0 / 2.0;
            const double body = std::max(1.0 - dx * dx - dy * dy, 0.0);
            const double expected = background.r + (2.0 - background.r) * body * body;
            ASSERT_NEAR(static_cast<double>(pixels[y * size_px + x].r), expected, 2e-4) << x << ", " << y;
        }
    }
}

TEST_F(ParticlesDrawTest, SurfacesFadeAndHide) {
    const auto coverage = [&](double surface_m) {
        const glm::dvec4 pixel = center({resting({0, 0, -10}, 2.0F, 1.0F)}, {.surface_m = surface_m});
        return (background.r - pixel.r) / (background.r - 2.0);
    };
    EXPECT_NEAR(coverage(12.5), 1.0, 1e-5); // a radius and more behind it
    EXPECT_NEAR(coverage(11.0), 0.5, 1e-4);
    EXPECT_NEAR(coverage(10.2), 0.1, 1e-4);
    EXPECT_NEAR(coverage(9.9), 0.0, 1e-9);
    EXPECT_NEAR(coverage(5.0), 0.0, 1e-9);
}

TEST_F(ParticlesDrawTest, NearerParticlesCoverFartherOnesInAnyOrderOfEmitters) {
    ParticleEmitter far = resting({0, 0, -12}, 1.0F, 0.5F);
    ParticleEmitter near = resting({0, 0, -8}, 1.0F, 0.75F);
    near.albedo = {1.0F, 0.0F, 0.0F};
    const glm::dvec4 expected = over(over(background, 4.0 * albedo, 0.5), {4.0, 0.0, 0.0}, 0.75);
    expect_near(center({far, near}, {}), expected, 1e-5);
    expect_near(center({near, far}, {}), expected, 1e-5);
}

TEST_F(ParticlesDrawTest, AnIntervalHoldsWhatLiesBetweenItsPanes) {
    ParticleEmitter far = resting({0, 0, -12}, 1.0F, 0.5F);
    ParticleEmitter near = resting({0, 0, -8}, 1.0F, 0.75F);
    near.albedo = {1.0F, 0.0F, 0.0F};
    const auto drawn = [&](std::vector<std::uint32_t> intervals) {
        return center({near, far}, {.split_depths_m = {20.0F, 10.0F, 8.0F}, .intervals = std::move(intervals)});
    };
    expect_near(drawn({0}), background, 0.0);
    expect_near(drawn({1}), over(background, 4.0 * albedo, 0.5), 1e-5);
    expect_near(drawn({2}), background, 0.0);
    expect_near(drawn({3}), over(background, {4.0, 0.0, 0.0}, 0.75), 1e-5); // at the very depth of the last pane
    expect_near(drawn({0, 1, 2, 3}), over(over(background, 4.0 * albedo, 0.5), {4.0, 0.0, 0.0}, 0.75), 1e-5);
}

TEST_F(ParticlesDrawTest, FogAndLightOfTheVolumeAtTheParticlesOwnDepth) {
    const Fog fog;
    for (const double depth_m : {0.5, 2.0, 7.3, 20.0, 39.0}) {
        const double transmittance = std::exp(-fog.extinction_per_m * depth_m);
        const glm::dvec3 radiance =
            fog.in_scattered * albedo * transmittance + glm::dvec3(fog.source * (1.0 - transmittance));
        SCOPED_TRACE(depth_m);
        expect_near(center({resting({0, 0, -depth_m}, static_cast<float>(0.03 * depth_m), 0.6F)}, {.fog = fog}),
                    over(background, radiance, 0.6), 1e-4);
    }
}

gpu::GpuLight lamp_at(const glm::vec3& position, float range_m) {
    gpu::GpuLight light{};
    light.position_range = glm::vec4(position, range_m);
    light.intensity_type = glm::vec4(100.0F, 50.0F, 25.0F, 0.0F);
    light.cone = glm::vec4(0.0F, 1.0F, 0.0F, 0.0F);
    return light;
}

/// What the volume leaves out lights particles by itself, and shines in the air in front of them.
TEST_F(ParticlesDrawTest, LampsThatTheVolumeLeavesOut) {
    Picture picture{.fog = Fog{.extinction_per_m = 1e-9, .source = 0.0}};
    picture.lights = {lamp_at({3.0F, 0.0F, -10.0F}, 20.0F), lamp_at({0.0F, -4.0F, -10.0F}, 20.0F)};
    const auto irradiance = [](double d) { return (1.0 - std::pow(d / 20.0, 4.0)) / (d * d); };
    const glm::dvec3 light = glm::dvec3(100, 50, 25) * ((irradiance(3.0) + irradiance(4.0)) / (4.0 * std::numbers::pi));
    const ParticleEmitter particle = resting({0, 0, -10}, 0.3F, 0.6F);
    expect_near(center({particle}, picture), over(background, albedo * (light + 2.0), 0.6), 1e-2);

    // In the middle of a particle of this radius the mean of 1 / d^2 is 3 / radius^2.
    picture.lights = {lamp_at({0.0F, 0.0F, -10.0F}, 20.0F)};
    const ParticleEmitter large = resting({0, 0, -10}, 1.0F, 0.6F);
    const glm::dvec4 inside = center({large}, picture);
    EXPECT_GT(inside.r, 0.6 * 0.5 * 100.0 / (4.0 * std::numbers::pi) / (0.5 + 1.0 / 3.0) * 0.9);
    EXPECT_LT(inside.r, 0.4 * 10.0 + 0.6 * 0.5 * (2.0 + 100.0 / (4.0 * std::numbers::pi) * 3.0) * 1.1);

    // A black one in air so thin that light loses nothing: sigma / (4 pi h) times the angle under which the lamp sees
    // the way to it.
    picture.fog->lamp_extinction_per_m = 1e-5F;
    picture.lights = {lamp_at({3.0F, 0.0F, -6.0F}, 1e4F)};
    picture.lights[0].intensity_type *= 1e6F;
    picture.lights[0].intensity_type.w = 0.0F;
    ParticleEmitter black = particle;
    black.albedo = glm::vec3(0.0F);
    const double angle = std::atan(6.0 / 3.0) + std::atan(4.0 / 3.0);
    const glm::dvec3 glow = glm::dvec3(100, 50, 25) * (1e6 * 1e-5 / (4.0 * std::numbers::pi * 3.0) * angle);
    expect_near(center({black}, picture), over(background, glow, 0.6), 2e-2);
}

TEST_F(ParticlesDrawTest, SunReachesWhatItsCascadesLeaveLit) {
    const ParticleEmitter particle = resting({0, 0, -10}, 1.0F, 0.4F);
    Picture picture{.light = {.sun_illuminance_lux = {400.0F, 300.0F, 200.0F}}};
    const glm::dvec3 sunlit = albedo * glm::dvec3(400, 300, 200) / (4.0 * std::numbers::pi);
    expect_near(center({particle}, picture), over(background, sunlit, 0.4), 1e-5);
    picture.shadow_depth = 0.6F; // the particle lies at 0.5
    expect_near(center({particle}, picture), over(background, sunlit, 0.4), 1e-5);
    picture.shadow_depth = 0.4F;
    expect_near(center({particle}, picture), over(background, {0.0, 0.0, 0.0}, 0.4), 1e-5);
}

TEST_F(ParticlesDrawTest, LocalLightsAddUpAsFarAsTheirShadowMapsLeaveThem) {
    Picture picture;
    picture.shadow_depth = 1.0F;
    for (const float x : {3.0F, -4.0F}) {
        picture.lights.push_back(lamp_at({x, 0.0F, -10.0F}, 20.0F));
    }
    const auto irradiance = [](double d) { return (1.0 - std::pow(d / 20.0, 4.0)) / (d * d); };
    const glm::dvec3 light = glm::dvec3(100, 50, 25) * ((irradiance(3.0) + irradiance(4.0)) / (4.0 * std::numbers::pi));
    expect_near(center({resting({0, 0, -10}, 1.0F, 0.4F)}, picture), over(background, albedo * (light + 4.0), 0.4),
                1e-5);

    picture.lights.front().cone.z = 1.0F;
    picture.caster_m = 3.1; // behind the particle
    expect_near(center({resting({0, 0, -10}, 1.0F, 0.4F)}, picture), over(background, albedo * (light + 4.0), 0.4),
                1e-5);
    picture.caster_m = 2.9;
    const glm::dvec3 second = glm::dvec3(100, 50, 25) * (irradiance(4.0) / (4.0 * std::numbers::pi));
    for (const bool sun : {true, false}) {
        picture.shadow_depth = sun ? std::optional(1.0F) : std::nullopt;
        expect_near(center({resting({0, 0, -10}, 1.0F, 0.4F)}, picture), over(background, albedo * (second + 4.0), 0.4),
                    1e-5);
    }
}

TEST_F(ParticlesDrawTest, ParticlesBelowAPixelKeepTheirSumAndDoNotVanish) {
    // A pixel is 0.154 m wide at the particle; its radius is a fifth of that.
    const float radius_m = 0.03F;
    const double pixel_m = 10.0 / size_px;
    const double expected = std::numbers::pi / 3.0 * std::pow(static_cast<double>(radius_m) / pixel_m, 2.0);
    double sum = 0.0;
    double least = 1e9;
    constexpr int steps = 5;
    for (int i = 0; i < steps * steps; ++i) {
        const double x = pixel_m * (i % steps) / steps;
        const double y = pixel_m * (i / steps) / steps; // NOLINT(bugprone-integer-division)
        double covered = 0.0;
        for (const glm::vec4& pixel : draw({resting({x, y, -10}, radius_m, 1.0F)}, {})) {
            covered += (background.r - static_cast<double>(pixel.r)) / (background.r - 2.0);
        }
        sum += covered;
        least = std::min(least, covered);
    }
    EXPECT_NEAR(sum / (steps * steps), expected, 0.05 * expected);
    EXPECT_GT(least, 0.4 * expected);
}

TEST_F(ParticlesDrawTest, AFrameIsAFunctionOfItsTimeAlone) {
    ParticleEmitter smoke = resting({0, -1, -10}, 0.5F, 0.5F);
    smoke.kind = engine::ParticleKind::smoke;
    smoke.rate_per_s = 20.0;
    smoke.velocity_m_s = {0.0F, 0.5F, 0.0F};
    smoke.velocity_spread_m_s = {0.3F, 0.3F, 0.3F};
    smoke.turbulence_m_s = 0.2F;
    Picture picture;
    const auto at = [&](double time_s) {
        picture.view.time_s = time_s;
        return draw({smoke}, picture);
    };
    const std::vector<glm::vec4> first = at(3.0);
    const std::vector<glm::vec4> later = at(1e5);
    EXPECT_TRUE(at(3.0) == first);
    EXPECT_FALSE(later == first);
    const double covered = background.r - static_cast<double>(first[(size_px / 2) * size_px + size_px / 2].r);
    EXPECT_GT(covered, 1.0);
}

} // namespace
} // namespace tyndall::test
