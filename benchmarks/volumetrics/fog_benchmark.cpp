// GPU time of each volumetric pass at 1280x720 with 160x90x64 froxels: timestamps of whole frames, the median of each
// pass as a counter in milliseconds. The light comes from a sun with four cascades and from 16 local lights.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <glm/gtc/matrix_transform.hpp>

#include "engine/device.hpp"
#include "features/volumetrics/feature.hpp"
#include "rendergraph/compile.hpp"
#include "shaders/common/lights.h"
#include "shaders/common/sun_shadow.h"

namespace tyndall {
namespace {

constexpr VkExtent3D image_extent{1280, 720, 1};
constexpr std::uint32_t cascade_size = 1024;

/// A mapped buffer that lives as long as the benchmark.
struct MappedBuffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize size_bytes = 0;
};

class FogBench {
public:
    explicit FogBench(const engine::Device& device)
        : device_(&device), executor_(std::move(*rg::Executor::create(device.executor_info(true)))),
          feature_(std::move(*volumetrics::Feature::create({.vk = &device.vk(),
                                                            .device = device.handle(),
                                                            .memory_properties = device.memory_properties(),
                                                            .frames_in_flight = 2}))) {
        light_records_ = make_lights();
        lights_ = upload(light_records_.data(), light_records_.size() * sizeof(gpu::GpuLight),
                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        const gpu::SunCascades cascades = make_cascades();
        cascades_ = upload(&cascades, sizeof cascades, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
    }
    FogBench(const FogBench&) = delete;
    FogBench& operator=(const FogBench&) = delete;
    ~FogBench() {
        device_->wait_idle();
        for (const MappedBuffer& buffer : {lights_, cascades_}) {
            device_->vk().DestroyBuffer(device_->handle(), buffer.buffer, nullptr);
            device_->vk().FreeMemory(device_->handle(), buffer.memory, nullptr);
        }
    }

    /// Runs one frame to its end; false with a message on failure.
    [[nodiscard]] bool frame(const volumetrics::FrameInputs& settings, std::string& why) {
        rg::GraphBuilder graph;
        std::vector<rg::ImportBinding> imports;
        volumetrics::FrameInputs inputs = settings;
        if (!inputs.lights.empty()) {
            inputs.lights = light_records_;
        }
        if (!executor_.wait_for_slot()) {
            why = "the device was lost";
            return false;
        }
        inputs.frame_slot = executor_.next_slot();
        // Moves slowly, so that history is reprojected and not only fetched.
        inputs.camera.origin_m.x = 0.01 * static_cast<double>(frames_++);

        const rg::Buffer lights = import(graph, imports, "lights", lights_);
        const rg::Buffer cascade_parameters = import(graph, imports, "cascade parameters", cascades_);
        rg::Image cascades = cleared_depth(graph, "sun cascades", {cascade_size, cascade_size, 1}, 4, 1.0F);
        rg::Image depth = cleared_depth(graph, "scene depth", image_extent, 1, 0.1F / 30.0F);
        rg::Image color =
            graph.create_image("scene color", {.format = VK_FORMAT_R16G16B16A16_SFLOAT, .extent = image_extent});
        graph.add_pass("clear color", rg::PassKind::graphics)
            .writes(color, rg::Access::color_attachment, {.clear = rg::clear_color(0.1F, 0.2F, 0.3F, 1.0F)})
            .executes([](rg::PassContext&) {});

        auto declared = feature_.begin_frame(inputs);
        declared = declared ? feature_.declare_frame_begin(graph, {.lights = lights}) : declared;
        declared =
            declared
                ? feature_.declare_after_shadow_maps(graph, {.cascades = cascades, .parameters = cascade_parameters})
                : declared;
        if (!declared) {
            why = declared.error().message;
            return false;
        }
        feature_.declare_after_opaque(graph, {.color = color, .depth = depth});
        graph.add_pass("use color", rg::PassKind::compute)
            .reads(color, rg::Access::sampled_compute)
            .has_side_effect("keeps the frame alive")
            .executes([](rg::PassContext&) {});
        const auto bindings = feature_.bindings();
        imports.insert(imports.end(), bindings.begin(), bindings.end());
        return run(graph.finish(), imports, why);
    }

    /// Milliseconds of each pass in the newest frame.
    [[nodiscard]] const std::map<std::string, double>& times_ms() const { return times_ms_; }

private:
    [[nodiscard]] bool run(const rg::DeclaredGraph& graph, const std::vector<rg::ImportBinding>& imports,
                           std::string& why) {
        const auto plan = rg::compile(graph.desc, executor_.topology(), executor_.memory_requirements(graph.desc));
        if (!plan) {
            why = rg::to_text(plan.error());
            return false;
        }
        const auto submitted = executor_.submit(graph.desc, *plan, graph.callbacks, imports);
        if (!submitted || !executor_.wait(*submitted)) {
            why = submitted ? "the device was lost" : submitted.error().message;
            return false;
        }
        times_ms_.clear();
        for (const rg::PassTiming& timing : executor_.timings()) {
            times_ms_[graph.desc.passes[timing.pass].name] = timing.duration_ms;
        }
        return true;
    }

    [[nodiscard]] static rg::Buffer import(rg::GraphBuilder& graph, std::vector<rg::ImportBinding>& imports,
                                           const char* name, const MappedBuffer& buffer) {
        const rg::Buffer handle = graph.import_buffer(name, {.size_bytes = buffer.size_bytes}, {.read_only = true});
        imports.push_back({.resource = handle.resource, .buffer = buffer.buffer});
        return handle;
    }

    [[nodiscard]] static rg::Image cleared_depth(rg::GraphBuilder& graph, const std::string& name, VkExtent3D extent,
                                                 std::uint32_t layers, float value) {
        rg::Image image =
            graph.create_image(name, {.format = VK_FORMAT_D32_SFLOAT, .extent = extent, .layers = layers});
        graph.add_pass("clear " + name, rg::PassKind::graphics)
            .writes(image, rg::Access::depth_attachment, {.clear = rg::clear_depth(value)})
            .executes([](rg::PassContext&) {});
        return image;
    }

    [[nodiscard]] MappedBuffer upload(const void* data, VkDeviceSize size_bytes, VkBufferUsageFlags usage) {
        const rg::DeviceTable& vk = device_->vk();
        MappedBuffer result{.size_bytes = size_bytes};
        const VkBufferCreateInfo info{
            .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size_bytes, .usage = usage};
        vk.CreateBuffer(device_->handle(), &info, nullptr, &result.buffer);
        VkMemoryRequirements needs{};
        vk.GetBufferMemoryRequirements(device_->handle(), result.buffer, &needs);
        std::uint32_t type = 0;
        const VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        while ((needs.memoryTypeBits >> type & 1U) == 0 ||
               (device_->memory_properties().memoryTypes[type].propertyFlags & wanted) != wanted) {
            ++type;
        }
        const VkMemoryAllocateInfo allocate{
            .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = type};
        vk.AllocateMemory(device_->handle(), &allocate, nullptr, &result.memory);
        vk.BindBufferMemory(device_->handle(), result.buffer, result.memory, 0);
        void* mapped = nullptr;
        vk.MapMemory(device_->handle(), result.memory, 0, VK_WHOLE_SIZE, 0, &mapped);
        std::memcpy(mapped, data, size_bytes);
        return result;
    }

    /// 16 point lights of 8 m range, spread over the view.
    [[nodiscard]] static std::vector<gpu::GpuLight> make_lights() {
        std::vector<gpu::GpuLight> lights;
        for (int i = 0; i < 16; ++i) {
            const float depth_m = 4.0F + 2.5F * static_cast<float>(i);
            const float side = 0.5F * depth_m * static_cast<float>(i % 3 - 1);
            lights.push_back({.position_range = {side, 1.0F, -depth_m, 8.0F},
                              .intensity_type = {100.0F, 80.0F, 60.0F, 0.0F},
                              .direction_radius = {0.0F, -1.0F, 0.0F, 0.05F},
                              .cone = {0.0F, 1.0F, 0.0F, 0.0F}});
        }
        return lights;
    }

    [[nodiscard]] static gpu::SunCascades make_cascades() {
        gpu::SunCascades cascades{};
        for (int i = 0; i < 4; ++i) {
            const float extent_m = 16.0F * std::exp2(static_cast<float>(i));
            glm::mat4 shadow(0.0F);
            shadow[0][0] = 1.0F / extent_m;
            shadow[2][1] = 1.0F / extent_m;
            shadow[1][2] = -1.0F / 140.0F;
            shadow[3] = {0.5F, 0.5F, 0.5F, 1.0F};
            cascades.shadow_from_render[i] = shadow;
            cascades.split_depth_m[i] = 8.0F * std::exp2(static_cast<float>(i));
        }
        cascades.direction_count = {0.0F, -1.0F, 0.0F, 4.0F};
        return cascades;
    }

    const engine::Device* device_;
    rg::Executor executor_;
    volumetrics::Feature feature_;
    MappedBuffer lights_;
    MappedBuffer cascades_;
    std::vector<gpu::GpuLight> light_records_;
    std::uint64_t frames_ = 0;
    std::map<std::string, double> times_ms_;
};

/// Everything that the feature has: height fog with noise and wind, sun, lights, history.
volumetrics::FrameInputs full_frame(bool with_lights) {
    volumetrics::FrameInputs inputs;
    inputs.medium.height = {.extinction_per_m = 0.03F, .falloff_per_m = 0.2F};
    inputs.medium.noise = {.amplitude = 0.5F, .scale_m = 2.0F, .wind_m_s = {1.0F, 0.0F, 0.0F}};
    inputs.medium.phase_g = 0.4F;
    inputs.medium.ambient_radiance = glm::vec3(0.1F);
    inputs.sun = volumetrics::Sun{.illuminance_lux = glm::vec3(50.0F), .casts_shadows = true};
    inputs.lights.resize(with_lights ? 1 : 0); // stands for those of FogBench
    glm::dmat4 p(0.0);
    p[0][0] = 1.0;
    p[1][1] = -16.0 / 9.0;
    p[3][2] = 0.1;
    p[2][3] = -1.0;
    inputs.camera.clip_from_view = p;
    return inputs;
}

void run_frames(benchmark::State& state, FogBench& bench, volumetrics::FrameInputs inputs) {
    std::map<std::string, std::vector<double>> samples;
    std::string why;
    for (int i = 0; i < 3; ++i) { // shaders are compiled at their first dispatch
        if (!bench.frame(inputs, why)) {
            state.SkipWithError(why.c_str());
            return;
        }
    }
    for (auto _ : state) {
        inputs.time_s += 1.0 / 60.0;
        if (!bench.frame(inputs, why)) {
            state.SkipWithError(why.c_str());
            return;
        }
        double total_ms = 0.0;
        for (const auto& [pass, ms] : bench.times_ms()) {
            const bool ours = pass.find("clear") == std::string::npos && pass != "use color";
            total_ms += ours ? ms : 0.0;
            if (ours) {
                samples[pass].push_back(ms);
            }
        }
        samples["all fog passes"].push_back(total_ms);
        state.SetIterationTime(total_ms * 1e-3);
    }
    for (auto& [pass, ms] : samples) {
        std::nth_element(ms.begin(), ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2), ms.end());
        state.counters[pass + " ms"] = ms[ms.size() / 2];
    }
}

} // namespace
} // namespace tyndall

int main(int argc, char** argv) {
    using namespace tyndall;
    benchmark::Initialize(&argc, argv);
    auto instance = engine::VulkanInstance::create(engine::Validation::off);
    if (!instance) {
        std::fprintf(stderr, "%s\n", instance.error().message.c_str());
        return 1;
    }
    auto device = engine::Device::create(*instance);
    if (!device) {
        std::fprintf(stderr, "%s\n", device.error().message.c_str());
        return 1;
    }
    benchmark::AddCustomContext("device", device->properties().deviceName);
    FogBench bench(*device);
    const auto add = [&](const char* name, const volumetrics::FrameInputs& inputs) {
        benchmark::RegisterBenchmark(name,
                                     [&bench, inputs](benchmark::State& state) { run_frames(state, bench, inputs); })
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond)
            ->Iterations(30);
    };
    add("fog/fp16/16_lights", full_frame(true));
    add("fog/fp16/sun_only", full_frame(false));
    volumetrics::FrameInputs fp32 = full_frame(true);
    fp32.settings.storage = volumetrics::StorageFormat::fp32;
    add("fog/fp32/16_lights", fp32);
    volumetrics::FrameInputs all_lights = full_frame(true);
    all_lights.settings.clusters = false;
    add("fog/fp16/16_lights_without_clusters", all_lights);
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
