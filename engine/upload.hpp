// Filling device memory before the first frame: staged copies, and levels of textures by repeated halving.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/memory.hpp"

namespace tyndall::engine {

/// Gathers copies and runs them together. Not for use within a frame.
class Uploader {
public:
    [[nodiscard]] static tl::expected<Uploader, Error> create(const Device& device);
    Uploader(Uploader&& other) noexcept;
    Uploader& operator=(Uploader&&) = delete;
    Uploader(const Uploader&) = delete;
    Uploader& operator=(const Uploader&) = delete;
    ~Uploader();

    // What is returned has its content after finish(), and must not be dropped before.

    /// A device-local buffer with this content; `usage` beside TRANSFER_DST.
    [[nodiscard]] tl::expected<Buffer, Error> buffer(std::span<const std::byte> content, VkBufferUsageFlags usage);

    /// A sampled 2D image of one layer from tightly packed texels of level 0, the other levels by a box filter in
    /// linear light (sRGB formats are converted by the blit). Left in SHADER_READ_ONLY_OPTIMAL. Fails when the size of
    /// `texels` is not that of the extent, or the device cannot filter the format.
    [[nodiscard]] tl::expected<DeviceImage, Error> texture(std::span<const std::byte> texels, VkFormat format,
                                                           VkExtent2D extent, bool levels);

    /// Runs what was gathered and waits for it; frees the staging memory.
    [[nodiscard]] tl::expected<void, Error> finish();

private:
    Uploader() = default;
    [[nodiscard]] tl::expected<VkCommandBuffer, Error> recording();
    [[nodiscard]] tl::expected<Buffer*, Error> stage(std::span<const std::byte> content);

    const Device* device_ = nullptr;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer cmd_ = VK_NULL_HANDLE; ///< null: nothing gathered yet
    std::vector<Buffer> staging_;
    VkDeviceSize staged_bytes_ = 0;
};

} // namespace tyndall::engine
