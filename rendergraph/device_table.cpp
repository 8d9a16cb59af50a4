#include "rendergraph/device_table.hpp"

namespace tyndall::rg {
namespace {

/// Of a command, which is what takes a command buffer and returns nothing. One that is not loaded stays null.
template <typename... Arguments>
void silence(void(VKAPI_PTR*& function)(VkCommandBuffer, Arguments...)) {
    if (function != nullptr) {
        function = [](VkCommandBuffer, Arguments...) {};
    }
}
template <typename Function>
void silence(Function& /*no_command*/) {}

} // namespace

bool load_device_table(PFN_vkGetDeviceProcAddr get_device_proc_addr, VkDevice device, DeviceTable& table,
                       const char*& missing) {
    missing = nullptr;
#define TYNDALL_RG_LOAD(name) table.name = reinterpret_cast<PFN_vk##name>(get_device_proc_addr(device, "vk" #name));
#define TYNDALL_RG_REQUIRE(name)                                                                                       \
    TYNDALL_RG_LOAD(name)                                                                                              \
    if (table.name == nullptr && missing == nullptr) {                                                                 \
        missing = "vk" #name;                                                                                          \
    }
    TYNDALL_RG_REQUIRED_DEVICE_FUNCTIONS(TYNDALL_RG_REQUIRE)
    TYNDALL_RG_OPTIONAL_DEVICE_FUNCTIONS(TYNDALL_RG_LOAD)
#undef TYNDALL_RG_REQUIRE
#undef TYNDALL_RG_LOAD
    return missing == nullptr;
}

DeviceTable without_commands(DeviceTable table) {
#define TYNDALL_RG_SILENCE(name) silence(table.name);
    TYNDALL_RG_REQUIRED_DEVICE_FUNCTIONS(TYNDALL_RG_SILENCE)
    TYNDALL_RG_OPTIONAL_DEVICE_FUNCTIONS(TYNDALL_RG_SILENCE)
#undef TYNDALL_RG_SILENCE
    return table;
}

} // namespace tyndall::rg
