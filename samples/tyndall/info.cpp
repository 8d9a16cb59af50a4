// tyndall info: the machine's devices as a frame graph sees them.
#include <cstdio>

#include <nlohmann/json.hpp>

#include "engine/device_info.hpp"
#include "samples/tyndall/arguments.hpp"

namespace tyndall::samples {
namespace {

std::string queue_flags(VkQueueFlags flags) {
    std::string text;
    for (const auto& [bit, name] :
         {std::pair{VK_QUEUE_GRAPHICS_BIT, "graphics"}, std::pair{VK_QUEUE_COMPUTE_BIT, "compute"},
          std::pair{VK_QUEUE_TRANSFER_BIT, "transfer"}}) {
        if ((flags & static_cast<VkQueueFlags>(bit)) != 0) {
            text += (text.empty() ? "" : "+") + std::string(name);
        }
    }
    return text;
}

nlohmann::ordered_json to_json(const engine::DeviceInfo& device) {
    nlohmann::ordered_json queues = nlohmann::ordered_json::array();
    for (const engine::QueueFamilyInfo& family : device.queues) {
        queues.push_back({{"family", family.family},
                          {"count", family.count},
                          {"can", queue_flags(family.flags)},
                          {"timestamp_bits", family.timestamp_valid_bits}});
    }
    nlohmann::ordered_json heaps = nlohmann::ordered_json::array();
    for (const engine::MemoryHeapInfo& heap : device.heaps) {
        heaps.push_back({{"bytes", heap.size_bytes}, {"device_local", heap.device_local}});
    }
    return {{"index", device.index},
            {"name", device.name},
            {"driver", device.driver},
            {"api_version", engine::version_text(device.api_version)},
            {"type", engine::device_type_name(device.type)},
            {"usable", device.lacks.empty()},
            {"lacks", device.lacks},
            {"queues", queues},
            {"heaps", heaps},
            {"dual_source_blending", device.dual_source_blending},
            {"max_anisotropy", device.max_anisotropy}};
}

void print(const engine::DeviceInfo& device) {
    std::printf("%u: %s (%s)\n   driver   %s\n   Vulkan   %s\n", device.index, device.name.c_str(),
                std::string(engine::device_type_name(device.type)).c_str(), device.driver.c_str(),
                engine::version_text(device.api_version).c_str());
    for (const engine::QueueFamilyInfo& family : device.queues) {
        std::printf("   queues   family %u: %u x %s, %u timestamp bits\n", family.family, family.count,
                    queue_flags(family.flags).c_str(), family.timestamp_valid_bits);
    }
    for (const engine::MemoryHeapInfo& heap : device.heaps) {
        std::printf("   memory   %.1f GiB%s\n", static_cast<double>(heap.size_bytes) / (1024.0 * 1024.0 * 1024.0),
                    heap.device_local ? ", device local" : "");
    }
    if (device.lacks.empty()) {
        std::printf("   usable   yes\n");
    } else {
        std::printf("   usable   no, it lacks %s\n", device.lacks.c_str());
    }
}

} // namespace

int run_info(const InfoArguments& arguments) {
    const tl::expected<engine::VulkanInstance, engine::Error> instance =
        engine::VulkanInstance::create(engine::Validation::off);
    if (!instance) {
        std::fprintf(stderr, "tyndall: %s\n", instance.error().message.c_str());
        return exit_failed;
    }
    std::vector<engine::DeviceInfo> devices = engine::list_devices(*instance);
    if (!arguments.device.empty()) {
        const tl::expected<std::uint32_t, engine::Error> chosen = engine::choose_device(devices, arguments.device);
        if (!chosen) {
            std::fprintf(stderr, "tyndall: %s\n", chosen.error().message.c_str());
            return exit_bad_input;
        }
        devices = {devices[*chosen]};
    }
    if (devices.empty()) {
        std::fprintf(stderr,
                     "tyndall: There is no Vulkan device; on a machine without a GPU install mesa-vulkan-drivers\n");
        return exit_failed;
    }
    if (arguments.json) {
        nlohmann::ordered_json document = {{"devices", nlohmann::ordered_json::array()}};
        for (const engine::DeviceInfo& device : devices) {
            document["devices"].push_back(to_json(device));
        }
        std::printf("%s\n", document.dump(2).c_str());
        return exit_ok;
    }
    for (const engine::DeviceInfo& device : devices) {
        print(device);
    }
    return exit_ok;
}

} // namespace tyndall::samples
