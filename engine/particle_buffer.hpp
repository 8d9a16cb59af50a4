// Memory that the host writes each frame and particles read.
#pragma once

#include <cstddef>
#include <span>

#include <tl/expected.hpp>

#include "engine/error.hpp"
#include "engine/particle_programs.hpp"

namespace tyndall::engine {

/// A storage buffer in coherent host memory, mapped for good.
class ParticleBuffer {
public:
    [[nodiscard]] static tl::expected<ParticleBuffer, Error> create(const ParticleDevice& device,
                                                                    VkDeviceSize size_bytes);
    ParticleBuffer(ParticleBuffer&& other) noexcept;
    ParticleBuffer& operator=(ParticleBuffer&& other) noexcept;
    ~ParticleBuffer(); ///< no frame that reads it may be in flight

    /// `offset + bytes.size()` lies within the buffer.
    void write(VkDeviceSize offset_bytes, std::span<const std::byte> bytes);
    [[nodiscard]] VkBuffer buffer() const { return buffer_; }
    [[nodiscard]] VkDeviceSize size_bytes() const { return size_bytes_; }

private:
    explicit ParticleBuffer(const ParticleDevice& device) : device_(device) {}

    ParticleDevice device_;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    std::byte* mapped_ = nullptr;
    VkDeviceSize size_bytes_ = 0;
};

} // namespace tyndall::engine
