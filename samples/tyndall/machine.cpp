#include "samples/tyndall/machine.hpp"

#include <fstream>
#include <thread>

namespace tyndall::samples {
namespace {

/// As Linux names the first one; empty where it does not.
std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) {
            return line.substr(colon + 2);
        }
    }
    return {};
}

} // namespace

std::string machine_text(const engine::DeviceInfo& device) {
    std::string text = device.name + ", " + device.driver;
    const std::string processor = device.type == VK_PHYSICAL_DEVICE_TYPE_CPU ? processor_name() : std::string();
    if (!processor.empty()) {
        text += ", on " + std::to_string(std::thread::hardware_concurrency()) + " x " + processor;
    }
    return text;
}

} // namespace tyndall::samples
