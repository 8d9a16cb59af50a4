#include <array>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "engine/file_io.hpp"
#include "engine/pipelines.hpp"

namespace tyndall::engine {
namespace {

/// Ahead of the driver's data: drivers trust what they are given, so that a file cut short or changed must not reach
/// one.
struct Seal {
    std::array<char, 8> magic = {'t', 'y', 'n', 'd', 'p', 'c', '0', '1'};
    std::uint64_t size_bytes = 0;
    std::uint64_t checksum = 0;
};

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
std::uint64_t checksum(std::span<const std::byte> data) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    for (const std::byte byte : data) {
        hash = (hash ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001b3ULL;
    }
    return hash;
}

std::filesystem::path default_folder() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0') {
        return std::filesystem::path(cache) / "tyndall";
    }
    if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
        return std::filesystem::path(home) / ".cache" / "tyndall";
    }
    return {};
}

std::string hexadecimal(const std::uint8_t (&bytes)[VK_UUID_SIZE]) {
    constexpr const char* digits = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : bytes) {
        text += digits[byte >> 4U];
        text += digits[byte & 15U];
    }
    return text;
}

/// Whether the driver's data carries this very device's header (VkPipelineCacheHeaderVersionOne).
bool belongs_to(const Device& device, std::span<const std::byte> data) {
    VkPipelineCacheHeaderVersionOne header;
    if (data.size() < sizeof(header)) {
        return false;
    }
    std::memcpy(&header, data.data(), sizeof(header));
    const VkPhysicalDeviceProperties& mine = device.properties();
    return header.headerVersion == VK_PIPELINE_CACHE_HEADER_VERSION_ONE && header.vendorID == mine.vendorID &&
           header.deviceID == mine.deviceID &&
           std::memcmp(header.pipelineCacheUUID, mine.pipelineCacheUUID, VK_UUID_SIZE) == 0;
}

/// The driver's data in the content of a file; empty when it is broken or of another device.
std::span<const std::byte> unsealed(const Device& device, std::span<const std::byte> content) {
    Seal seal;
    const Seal expected;
    if (content.size() < sizeof(seal)) {
        return {};
    }
    std::memcpy(&seal, content.data(), sizeof(seal));
    const std::span<const std::byte> data = content.subspan(sizeof(seal));
    const bool whole =
        seal.magic == expected.magic && seal.size_bytes == data.size() && seal.checksum == checksum(data);
    return whole && belongs_to(device, data) ? data : std::span<const std::byte>{};
}

} // namespace

tl::expected<PipelineCache, Error> PipelineCache::create(const Device& device, const std::filesystem::path& folder) {
    PipelineCache cache;
    cache.device_ = &device;
    const std::filesystem::path in = folder.empty() ? default_folder() : folder;
    std::vector<std::byte> content;
    if (!in.empty()) {
        cache.file_ = in / ("pipelines-" + hexadecimal(device.properties().pipelineCacheUUID) + ".bin");
        content = read_file(cache.file_).value_or(std::vector<std::byte>{});
    }
    const std::span<const std::byte> data = unsealed(device, content);
    const VkPipelineCacheCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
                                         .initialDataSize = data.size(),
                                         .pInitialData = data.data()};
    if (device.vk().CreatePipelineCache(device.handle(), &info, nullptr, &cache.cache_) != VK_SUCCESS) {
        return tl::unexpected(Error{"No pipeline cache could be made"});
    }
    cache.loaded_bytes_ = data.size();
    return cache;
}

PipelineCache::PipelineCache(PipelineCache&& other) noexcept
    : device_(other.device_), cache_(std::exchange(other.cache_, VK_NULL_HANDLE)), file_(std::move(other.file_)),
      loaded_bytes_(other.loaded_bytes_) {}

PipelineCache::~PipelineCache() {
    if (cache_ != VK_NULL_HANDLE) {
        save();
        device_->vk().DestroyPipelineCache(device_->handle(), cache_, nullptr);
    }
}

bool PipelineCache::save() const {
    if (file_.empty()) {
        return false;
    }
    const rg::DeviceTable& vk = device_->vk();
    std::size_t size = 0;
    if (vk.GetPipelineCacheData(device_->handle(), cache_, &size, nullptr) != VK_SUCCESS) {
        return false;
    }
    std::vector<std::byte> content(sizeof(Seal) + size);
    if (vk.GetPipelineCacheData(device_->handle(), cache_, &size, content.data() + sizeof(Seal)) != VK_SUCCESS) {
        return false;
    }
    content.resize(sizeof(Seal) + size);
    const Seal seal{.size_bytes = size, .checksum = checksum(std::span(content).subspan(sizeof(Seal)))};
    std::memcpy(content.data(), &seal, sizeof(seal));
    std::error_code ignored; // replace_file tells whether the folder is there
    std::filesystem::create_directories(file_.parent_path(), ignored);
    return replace_file(file_, content).has_value();
}

} // namespace tyndall::engine
