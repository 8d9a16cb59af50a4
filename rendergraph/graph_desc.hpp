// The declared frame as plain data: what GraphBuilder makes and every stage reads.
#pragma once

#include <cstdint>
#include <limits>
#include <source_location>
#include <string>
#include <vector>

#include <vulkan/vulkan_core.h>

#include "rendergraph/access.hpp"
#include "rendergraph/diagnostic.hpp"

namespace tyndall::rg {

inline constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
inline constexpr std::uint32_t all_remaining = std::numeric_limits<std::uint32_t>::max();
inline constexpr VkDeviceSize whole_buffer = std::numeric_limits<VkDeviceSize>::max();

enum class PassKind : std::uint8_t { graphics, compute, transfer, host };
enum class QueueKind : std::uint8_t { graphics, compute, transfer };

[[nodiscard]] std::string_view name_of(PassKind kind);
[[nodiscard]] std::string_view name_of(QueueKind kind);

/// Where a pass may run. `automatic` leaves it to the scheduler.
enum class QueueWish : std::uint8_t {
    automatic,
    graphics,      ///< forced onto the graphics queue
    async_compute, ///< asked for: runs on async compute where the topology has such a queue, else on graphics
    transfer,      ///< likewise for a transfer queue
};

struct ImageRange {
    std::uint32_t base_mip = 0;
    std::uint32_t mip_count = all_remaining;
    std::uint32_t base_layer = 0;
    std::uint32_t layer_count = all_remaining;
    VkImageAspectFlags aspects = 0; ///< 0: all that the format has
    friend bool operator==(const ImageRange&, const ImageRange&) = default;
};
struct BufferRange {
    VkDeviceSize offset = 0;
    VkDeviceSize size = whole_buffer;
    friend bool operator==(const BufferRange&, const BufferRange&) = default;
};

struct ImageDesc {
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent3D extent = {1, 1, 1};
    std::uint32_t mips = 1;
    std::uint32_t layers = 1;
    VkImageType type = VK_IMAGE_TYPE_2D;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
    VkImageCreateFlags flags = 0;
    VkImageUsageFlags extra_usage = 0; ///< beyond what the accesses imply
};
struct BufferDesc {
    VkDeviceSize size_bytes = 0;
    VkBufferUsageFlags extra_usage = 0;
};

enum class ResourceKind : std::uint8_t { image, buffer };
enum class ResourceLifetime : std::uint8_t {
    transient, ///< the graph owns the memory; content lives within the frame
    imported,  ///< the host owns it
    history,   ///< what the frame before left in `history_of`; read only
};

/// What the host says of an imported resource on the way in, and wants on the way out.
struct ImportDesc {
    // On the way in. Stages and access mask of the last use, where it was submitted to the topology's first queue and
    // nothing else orders it: they become the source of a barrier, which reaches that queue only, so that all passes
    // that use the import stay there. 0 where a semaphore or a fence covers it, and where the last use was in a frame
    // of the same executor, which orders whole frames. The use by another queue needs a semaphore. Of the host stage
    // every queue knows.
    VkImageLayout initial_layout = VK_IMAGE_LAYOUT_UNDEFINED; ///< UNDEFINED: the content may be lost
    VkPipelineStageFlags2 initial_stages = 0;
    VkAccessFlags2 initial_access = 0;
    std::uint32_t initial_family = VK_QUEUE_FAMILY_IGNORED; ///< owner on the way in; IGNORED: whoever uses it first
    bool waits_semaphore = false;                           ///< the host binds a semaphore that the first use waits for
    // On the way out. Stages and access mask of the next use are the destination of a barrier, where it will be
    // submitted to the first queue and nothing else orders it; likewise the passes stay there. 0 where the host waits
    // for a fence or a semaphore, and where the next use is in a frame of the same executor.
    bool has_final = false; ///< the frame must leave it in `final_*`; makes its last writer a root
    VkImageLayout final_layout = VK_IMAGE_LAYOUT_UNDEFINED;
    VkPipelineStageFlags2 final_stages = 0;
    VkAccessFlags2 final_access = 0;
    std::uint32_t final_family = VK_QUEUE_FAMILY_IGNORED;
    bool signals_semaphore = false; ///< the host binds a semaphore that is signalled after the last use
    bool read_only = false;         ///< the frame never writes it; needs no final access
};

struct ResourceDesc {
    std::string name = {};
    ResourceKind kind = ResourceKind::image;
    ResourceLifetime lifetime = ResourceLifetime::transient;
    bool concurrent = false;  ///< the host asks for VK_SHARING_MODE_CONCURRENT
    bool has_history = false; ///< another resource of this graph is this one's history
    ImageDesc image = {};
    BufferDesc buffer = {};
    std::uint32_t import = none;     ///< index into GraphDesc::imports
    std::uint32_t history_of = none; ///< resource whose previous content this is
    std::source_location where = {};
};

/// One access of one pass to one range of one resource.
struct AccessDesc {
    std::uint32_t pass = none;
    std::uint32_t resource = none;
    std::uint32_t version = 0; ///< the version read; for writes the version made
    Access access = Access::sampled_compute;
    Direction direction = Direction::read;
    bool clears = false; ///< an attachment that is cleared when it is loaded
    VkClearValue clear = {};
    ImageRange image_range = {};
    BufferRange buffer_range = {};
    std::source_location where = {};
};

/// A part of the frame that is declared in alternative forms, of which the compiler keeps one by predicted time.
struct VariantDesc {
    std::string name = {};
    std::vector<std::string> forms = {};
    std::source_location where = {};
};

/// The bit of a kind of queue in PassDesc::forbidden_queues.
[[nodiscard]] constexpr std::uint8_t queue_bit(QueueKind kind) {
    return static_cast<std::uint8_t>(1U << static_cast<std::uint8_t>(kind));
}

struct PassDesc {
    std::string name = {};
    PassKind kind = PassKind::graphics;
    QueueWish wish = QueueWish::automatic;
    std::uint8_t forbidden_queues = 0; ///< queue_bit of each kind where an automatic pass must not run
    std::uint32_t variant = none;      ///< index into GraphDesc::variants
    std::uint32_t form = 0;            ///< index into VariantDesc::forms
    bool has_side_effect = false;
    std::string side_effect = {}; ///< what it is, in words, for reports
    std::uint32_t first_access = 0;
    std::uint32_t access_count = 0;
    std::uint32_t point = none; ///< index into GraphDesc::points
    std::source_location where = {};
};

struct GraphDesc {
    std::vector<ResourceDesc> resources;
    std::vector<PassDesc> passes;
    std::vector<AccessDesc> accesses; ///< grouped by pass, in order of declaration
    std::vector<ImportDesc> imports;
    std::vector<std::string> points; ///< injection points, in the host's order
    std::vector<VariantDesc> variants = {};
    Diagnostics declaration_errors = {}; ///< what the builder already saw; compile reports them with its own
};

} // namespace tyndall::rg
