#include "rendergraph/device_table.hpp"

namespace tyndall::rg {

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

} // namespace tyndall::rg
