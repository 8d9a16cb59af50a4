#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "engine/pipelines.hpp"

namespace tyndall::engine {
namespace {

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

/// Drivers trust their own caches, so a cache must carry this very device's header before it is handed over.
bool belongs_to(const Device& device, const std::vector<char>& data) {
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

} // namespace

tl::expected<PipelineCache, Error> PipelineCache::create(const Device& device, const std::filesystem::path& folder) {
    PipelineCache cache;
    cache.device_ = &device;
    const std::filesystem::path in = folder.empty() ? default_folder() : folder;
    std::vector<char> data;
    if (!in.empty()) {
        cache.file_ = in / ("pipelines-" + hexadecimal(device.properties().pipelineCacheUUID) + ".bin");
        std::ifstream file(cache.file_, std::ios::binary);
        data.assign(std::istreambuf_iterator<char>(file), {});
        if (!belongs_to(device, data)) {
            data.clear();
        }
    }
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
    std::size_t size = 0;
    device_->vk().GetPipelineCacheData(device_->handle(), cache_, &size, nullptr);
    std::vector<char> data(size);
    if (device_->vk().GetPipelineCacheData(device_->handle(), cache_, &size, data.data()) != VK_SUCCESS) {
        return false;
    }
    std::error_code error;
    std::filesystem::create_directories(file_.parent_path(), error);
    // Processes that end at the same time each rename a whole file into place.
    const std::filesystem::path beside = file_.string() + "." + std::to_string(getpid());
    {
        std::ofstream file(beside, std::ios::binary);
        if (!file.write(data.data(), static_cast<std::streamsize>(size))) {
            std::filesystem::remove(beside, error);
            return false;
        }
    }
    std::filesystem::rename(beside, file_, error);
    return !error;
}

} // namespace tyndall::engine
