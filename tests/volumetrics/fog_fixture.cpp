#include "tests/volumetrics/fog_fixture.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include <glm/gtc/packing.hpp>

#include "tests/volumetrics/transfer_passes.hpp"

namespace tyndall::volumetrics::test {
namespace {

using rg::Access;
using rg::PassContext;
using rg::PassKind;
using tyndall::test::HostBuffer;

/// Depth images are attachments in a real frame, and the layout in which they are sampled wants that usage.
rg::ImageDesc depth_image(std::uint32_t width, std::uint32_t height, std::uint32_t layers) {
    return {.format = VK_FORMAT_D32_SFLOAT,
            .extent = {width, height, 1},
            .layers = layers,
            .extra_usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT};
}

void clear(rg::GraphBuilder& graph, rg::Image& image, const glm::vec4& value) {
    auto pass = graph.add_pass("poison history", PassKind::compute);
    pass.writes(image, Access::transfer_destination);
    pass.executes([=, target = image](PassContext& ctx) {
        VkClearColorValue color{};
        std::memcpy(color.float32, &value, sizeof color.float32);
        const VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
        ctx.vk().CmdClearColorImage(ctx.cmd(), ctx.image(target), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &color, 1,
                                    &range);
    });
}

std::vector<glm::vec4> texels(const HostBuffer& buffer, VkFormat format) {
    std::vector<glm::vec4> result;
    if (format == VK_FORMAT_R16G16B16A16_SFLOAT) {
        for (const std::uint64_t texel : buffer.as<std::uint64_t>()) {
            result.push_back(glm::unpackHalf4x16(texel));
        }
    } else {
        const auto all = buffer.as<glm::vec4>();
        result.assign(all.begin(), all.end());
    }
    return result;
}

} // namespace

glm::dmat4 test_projection() {
    glm::dmat4 p(0.0);
    p[0][0] = 1.0 / tan_x;
    p[1][1] = -1.0 / tan_y;
    p[3][2] = near_m;
    p[2][3] = -1.0;
    return p;
}

Scene plain_scene() {
    Scene scene;
    scene.inputs.settings.storage = StorageFormat::fp32;
    scene.inputs.settings.temporal = {.enabled = false, .jitter = false};
    scene.inputs.settings.airlight.max_lights = 0; // all light is in the froxels, which the tests look into
    scene.inputs.camera.clip_from_view = test_projection();
    scene.inputs.color_format = VK_FORMAT_R32G32B32A32_SFLOAT;
    scene.depth_m = [](std::uint32_t, std::uint32_t) { return std::numeric_limits<double>::infinity(); };
    scene.color = [](std::uint32_t, std::uint32_t) { return glm::vec4(0.0F); };
    return scene;
}

Scene sunlit_scene(float extent_m) {
    Scene scene = plain_scene();
    scene.inputs.settings.visibility.method = SunVisibility::prefiltered;
    scene.inputs.medium.homogeneous = {.extinction_per_m = 0.01F, .albedo = glm::vec3(1.0F)};
    scene.inputs.sun =
        Sun{.direction = {0.0F, -1.0F, 0.0F}, .illuminance_lux = glm::vec3(10.0F), .casts_shadows = true};
    glm::mat4 shadow(0.0F); // u along x, v along z, depth 0 at y = extent / 2 and 1 at -extent / 2
    shadow[0][0] = 1.0F / extent_m;
    shadow[2][1] = 1.0F / extent_m;
    shadow[1][2] = -1.0F / extent_m;
    shadow[3] = glm::vec4(0.5F, 0.5F, 0.5F, 1.0F);
    for (glm::mat4& cascade : scene.cascades.shadow_from_render) {
        cascade = shadow;
    }
    scene.cascades.split_depth_m = {16.0F, 32.0F, 48.0F, 64.0F};
    scene.cascades.depth_range_m = glm::vec4(extent_m);
    scene.cascades.direction_count = {0.0F, -1.0F, 0.0F, 4.0F};
    scene.cascade_depths.assign(std::size_t{4} * scene.cascade_size * scene.cascade_size, 1.0F);
    return scene;
}

PixelRay pixel_ray(const Scene& scene, std::uint32_t x, std::uint32_t y) {
    const glm::dvec3 at_one_metre(((x + 0.5) / scene.image.x * 2.0 - 1.0) * tan_x,
                                  (1.0 - (y + 0.5) / scene.image.y * 2.0) * tan_y, -1.0);
    return {glm::normalize(at_one_metre), glm::length(at_one_metre)};
}

void FogTest::SetUp() {
    GpuTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) {
        return;
    }
    const rg::ExecutorInfo info = executor_info();
    make_executor(info);
    auto made = Feature::create({.vk = &vk(),
                                 .device = info.device,
                                 .memory_properties = info.memory_properties,
                                 .frames_in_flight = info.frames_in_flight,
                                 .dual_source_blending = gpu().dual_source_blending,
                                 .check_bindings = info.check_bindings});
    ASSERT_TRUE(made) << made.error().message;
    feature_ = std::make_unique<Feature>(std::move(*made));
}

void FogTest::TearDown() {
    if (feature_) {
        EXPECT_TRUE(executor().wait_idle());
    }
    feature_.reset();
    GpuTest::TearDown();
}

Result FogTest::render(const Scene& scene) {
    return std::move(render_views(std::span(&scene, 1)).front());
}

std::vector<Result> FogTest::render_views(std::span<const Scene> scenes) {
    rg::GraphBuilder graph;
    std::vector<rg::ImportBinding> imports;
    EXPECT_TRUE(executor().wait_for_slot());
    std::vector<ReadBack> read_back;
    for (std::uint32_t view = 0; view < scenes.size(); ++view) {
        read_back.push_back(declare_view(graph, imports, scenes[view], view));
    }
    const rg::DeclaredGraph declared = graph.finish();
    run(declared, imports);
    std::vector<Result> results;
    for (ReadBack& view : read_back) {
        for (const rg::PassDesc& pass : declared.desc.passes) {
            view.result.pass_names.push_back(pass.name);
        }
        results.push_back(std::move(view).collect());
    }
    return results;
}

FogTest::ReadBack FogTest::declare_view(rg::GraphBuilder& graph, std::vector<rg::ImportBinding>& imports,
                                        const Scene& scene, std::uint32_t view) {
    const auto named = [&](const std::string& name) {
        return view == 0 ? name : name + ", view " + std::to_string(view);
    };
    const auto import_written = [&](const char* name, const HostBuffer& buffer) {
        const rg::Buffer handle =
            graph.import_buffer(named(name), {.size_bytes = buffer.size_bytes}, tyndall::test::written_by_host());
        imports.push_back({.resource = handle.resource, .buffer = buffer.buffer});
        return handle;
    };
    const auto import_read = [&](const std::string& name, VkDeviceSize size_bytes, HostBuffer& buffer) {
        buffer = host_buffer(size_bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
        const rg::Buffer handle =
            graph.import_buffer(named(name), {.size_bytes = size_bytes}, tyndall::test::read_by_host());
        imports.push_back({.resource = handle.resource, .buffer = buffer.buffer});
        return handle;
    };

    // Inputs.
    const std::size_t pixels = std::size_t{scene.image.x} * scene.image.y;
    const HostBuffer color_data = host_buffer(pixels * sizeof(glm::vec4), VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    const HostBuffer depth_data = host_buffer(pixels * sizeof(float), VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    for (std::uint32_t y = 0; y < scene.image.y; ++y) {
        for (std::uint32_t x = 0; x < scene.image.x; ++x) {
            color_data.as<glm::vec4>()[y * scene.image.x + x] = scene.color(x, y);
            depth_data.as<float>()[y * scene.image.x + x] = static_cast<float>(near_m / scene.depth_m(x, y));
        }
    }
    rg::Image color = graph.create_image(
        named("scene color"), {.format = VK_FORMAT_R32G32B32A32_SFLOAT, .extent = {scene.image.x, scene.image.y, 1}});
    rg::Image depth = graph.create_image(named("scene depth"), depth_image(scene.image.x, scene.image.y, 1));
    upload(graph, named("upload color"), import_written("color data", color_data), color);
    upload(graph, named("upload depth"), import_written("depth data", depth_data), depth);

    FrameInputs inputs = scene.inputs;
    inputs.lights = scene.lights;
    inputs.image_size = scene.image;
    inputs.frame_slot = executor().next_slot();
    inputs.view = view;
    FrameBeginResources begin;
    if (!scene.lights.empty()) {
        const HostBuffer data =
            host_buffer(scene.lights.size() * sizeof(gpu::GpuLight), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        std::memcpy(data.mapped, scene.lights.data(), scene.lights.size() * sizeof(gpu::GpuLight));
        begin.lights = import_written("lights", data);
    }
    ShadowResources shadow;
    if (!scene.cascade_depths.empty()) {
        const HostBuffer data =
            host_buffer(scene.cascade_depths.size() * sizeof(float), VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
        std::memcpy(data.mapped, scene.cascade_depths.data(), scene.cascade_depths.size() * sizeof(float));
        const HostBuffer parameters = host_buffer(sizeof(gpu::SunCascades), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
        std::memcpy(parameters.mapped, &scene.cascades, sizeof(gpu::SunCascades));
        shadow.cascades =
            graph.create_image(named("sun cascades"), depth_image(scene.cascade_size, scene.cascade_size, 4));
        upload(graph, named("upload cascades"), import_written("cascade data", data), shadow.cascades);
        shadow.parameters = import_written("cascade parameters", parameters);
    }
    if (!scene.local_depths.empty()) {
        const HostBuffer data =
            host_buffer(scene.local_depths.size() * sizeof(float), VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
        std::memcpy(data.mapped, scene.local_depths.data(), scene.local_depths.size() * sizeof(float));
        const HostBuffer records =
            host_buffer(scene.local_shadows.size() * sizeof(gpu::LocalShadow), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        std::memcpy(records.mapped, scene.local_shadows.data(), scene.local_shadows.size() * sizeof(gpu::LocalShadow));
        const std::uint32_t size = scene.local_shadow_size;
        const std::size_t layers = scene.local_depths.size() / (std::size_t{size} * size);
        shadow.local_maps =
            graph.create_image(named("local shadow maps"), depth_image(size, size, static_cast<std::uint32_t>(layers)));
        upload(graph, named("upload local shadow maps"), import_written("local shadow data", data), shadow.local_maps);
        shadow.local_records = import_written("local shadow records", records);
    }

    // The feature, as a host drives it.
    const auto check = [](const tl::expected<void, Error>& result) { EXPECT_TRUE(result) << result.error().message; };
    check(feature_->begin_frame(inputs));
    check(feature_->declare_frame_begin(graph, begin, view));
    check(feature_->declare_after_shadow_maps(graph, shadow, view));
    feature_->declare_after_opaque(graph, {.color = color, .depth = depth}, view);

    // Outputs.
    ReadBack out;
    const auto read_image = [&](const char* name, rg::Image image, HostBuffer& buffer) {
        const rg::ImageDesc desc = *graph.describe(image);
        const VkDeviceSize size_bytes = VkDeviceSize{desc.extent.width} * desc.extent.height * desc.extent.depth *
                                        desc.layers * rg::format_texel_bytes(desc.format);
        rg::Buffer target = import_read(name, size_bytes, buffer);
        download(graph, named(std::string("read ") + name), image, target);
    };
    read_image("color out", color, out.color);
    const VkFormat format =
        inputs.settings.storage == StorageFormat::fp16 ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_R32G32B32A32_SFLOAT;
    if (feature_->volume(view)) {
        read_image("density out", feature_->stages(view).density, out.density);
        read_image("accumulated out", feature_->volume(view)->accumulated, out.accumulated);
        rg::Image in_scattered = feature_->volume(view)->in_scattered;
        read_image("in-scattered out", in_scattered, out.in_scattered);
        if (scene.poison) {
            clear(graph, in_scattered, *scene.poison);
        }
    }
    if (feature_->stages(view).esm.valid()) {
        read_image("esm out", feature_->stages(view).esm, out.esm);
    }
    if (feature_->clusters(view)) {
        const rg::Buffer masks = feature_->clusters(view)->masks;
        rg::Buffer target = import_read("masks out", graph.describe(masks)->size_bytes, out.masks);
        download(graph, named("read masks"), masks, target);
    }
    for (std::size_t i = 0; i < out.baked_noise.size(); ++i) {
        if (const rg::Buffer texels = feature_->stages(view).baked_noise[i]; texels.valid()) {
            rg::Buffer target =
                import_read("noise out " + std::to_string(i), graph.describe(texels)->size_bytes, out.baked_noise[i]);
            download(graph, named("read noise " + std::to_string(i)), texels, target);
        }
    }
    const auto bindings = feature_->bindings(view);
    imports.insert(imports.end(), bindings.begin(), bindings.end());
    for (const Omission& omission : feature_->omissions(view)) {
        out.result.omissions.push_back(omission.what + ": " + omission.why);
    }

    out.format = format;
    return out;
}

Result FogTest::ReadBack::collect() && {
    result.color = texels(color, VK_FORMAT_R32G32B32A32_SFLOAT);
    if (accumulated.mapped != nullptr) {
        result.density = texels(density, format);
        result.in_scattered = texels(in_scattered, format);
        result.accumulated = texels(accumulated, format);
    }
    if (esm.mapped != nullptr) {
        result.esm.assign(esm.as<float>().begin(), esm.as<float>().end());
    }
    if (masks.mapped != nullptr) {
        result.masks.assign(masks.as<std::uint32_t>().begin(), masks.as<std::uint32_t>().end());
    }
    for (std::size_t i = 0; i < baked_noise.size(); ++i) {
        for (const std::uint32_t pair :
             baked_noise[i].mapped != nullptr ? baked_noise[i].as<std::uint32_t>() : std::span<std::uint32_t>()) {
            const glm::vec2 values = glm::unpackHalf2x16(pair);
            result.baked_noise[i].insert(result.baked_noise[i].end(), {values.x, values.y});
        }
    }
    return std::move(result);
}

} // namespace tyndall::volumetrics::test
