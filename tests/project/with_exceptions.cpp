// What libraries.sh must find: a throw, a polymorphic type with its type information, a global Vulkan function.
#include <stdexcept>

#include <vulkan/vulkan_core.h>

namespace tyndall::test {

struct Polymorphic {
    virtual ~Polymorphic();
};
Polymorphic::~Polymorphic() = default;

void wait_or_throw(VkDevice device);
void wait_or_throw(VkDevice device) {
    if (vkDeviceWaitIdle(device) != VK_SUCCESS) {
        throw std::runtime_error("the device is lost");
    }
}

} // namespace tyndall::test
