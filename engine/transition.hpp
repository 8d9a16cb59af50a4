// A layout transition outside a frame, where brevity counts for more than overlap.
#pragma once

#include "engine/device.hpp"

namespace tyndall::engine {

/// Everything before in the queue happens before everything after it, for this image.
void transition(const Device& device, VkCommandBuffer cmd, VkImage image, const VkImageSubresourceRange& range,
                VkImageLayout from, VkImageLayout to);

} // namespace tyndall::engine
