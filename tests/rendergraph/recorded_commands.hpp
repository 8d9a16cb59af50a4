// What a plan has recorded, command by command: the common ground of the oracle that follows accesses and of the CPU
// executor. Written apart from the checker, which has its own reading.
#pragma once

#include <cstdint>
#include <vector>

#include "rendergraph/plan.hpp"

namespace tyndall::rg::test {

inline constexpr VkPipelineStageFlags2 all_commands = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
inline constexpr VkAccessFlags2 any_memory = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
inline constexpr VkAccessFlags2 writes_of_memory =
    VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_HOST_WRITE_BIT |
    VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR | VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;

/// ALL_COMMANDS with each stage that it stands for.
[[nodiscard]] VkPipelineStageFlags2 expanded(VkPipelineStageFlags2 mask);
/// `mask` names each kind of access in `wanted`.
[[nodiscard]] bool includes(VkAccessFlags2 mask, VkAccessFlags2 wanted);

/// Bytes, or mips x layers, of a resource.
struct Part {
    std::uint64_t a0, a1, b0, b1;
    [[nodiscard]] bool meets(const Part& o) const { return a0 < o.a1 && o.a0 < a1 && b0 < o.b1 && o.b0 < b1; }
    [[nodiscard]] bool holds(const Part& o) const { return a0 <= o.a0 && o.a1 <= a1 && b0 <= o.b0 && o.b1 <= b1; }
};
[[nodiscard]] Part part_of(const ResourceDesc& r, const ImageRange& image, const BufferRange& buffer);
/// The part cut at the borders of all accesses to its resource, so that each access covers a piece wholly or not at
/// all.
[[nodiscard]] std::vector<Part> pieces_of(const GraphDesc& graph, std::uint32_t resource, const Part& part);

/// Two resources lie in the same bytes of a heap.
[[nodiscard]] bool share_bytes(const Plan& plan, std::uint32_t a, std::uint32_t b);

/// Something that touches memory.
struct Touch {
    std::uint32_t pass = none;
    std::uint32_t resource = none;
    Part part{};
    VkPipelineStageFlags2 stages = 0; ///< for transitions: what comes after them
    VkAccessFlags2 access = 0;
    bool writes = false;
    std::uint32_t transition = none;   ///< the dependency that makes it
    std::uint32_t access_index = none; ///< into GraphDesc::accesses, of a pass
};
struct Recorded {
    std::uint32_t dependency = none;
    VkPipelineStageFlags2 src = 0, dst = 0;
    VkAccessFlags2 src_access = 0, dst_access = 0;
    bool acts = false; ///< changes layout or owner
};
enum class CommandKind : std::uint8_t { wait, barriers, touches, signal };
struct Command {
    CommandKind kind;
    std::uint32_t queue;
    std::uint32_t batch;
    std::uint32_t signaller = none;   ///< of a wait
    VkPipelineStageFlags2 stages = 0; ///< of a wait
    std::vector<Recorded> barriers = {};
    std::vector<Touch> touches = {};
};

/// In submission order, which is topological.
[[nodiscard]] std::vector<Command> recorded_commands(const GraphDesc& graph, const Plan& plan);
/// The write that changing layout or owner is.
[[nodiscard]] Touch transition_of(const GraphDesc& graph, const Plan& plan, const Recorded& recorded);

} // namespace tyndall::rg::test
