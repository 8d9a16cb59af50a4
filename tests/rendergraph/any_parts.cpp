#include "tests/rendergraph/any_parts.hpp"

namespace tyndall::rg::test {
namespace {

std::uint32_t any_family(Bits& bits, const QueueTopology& topology) {
    return topology.queues[bits.below(static_cast<std::uint32_t>(topology.queues.size()))].family;
}

/// What a queue that may be the first to use an import can name as the host's last use.
VkPipelineStageFlags2 host_stages(Bits& bits, const QueueTopology& topology) {
    return topology.queues.size() == 1
               ? bits.one_of({VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT})
               : bits.one_of({VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT});
}

} // namespace

QueueTopology any_topology(Bits& bits) {
    QueueTopology topology;
    constexpr std::uint8_t all = can_graphics | can_compute | can_transfer;
    topology.queues = {{QueueKind::graphics, 0, all}};
    const std::uint32_t shape = bits.below(6);
    if (shape == 1 || shape >= 3) {
        const std::uint32_t family = bits.below(3) == 0 ? 0 : 1;
        const std::uint8_t can = family == 0 ? all : std::uint8_t{can_compute | can_transfer};
        topology.queues.push_back({QueueKind::compute, family, can});
    }
    if (shape >= 2 && shape != 4) {
        topology.queues.push_back({QueueKind::transfer, 2, can_transfer});
    }
    return topology;
}

ImageDesc any_image(Bits& bits) {
    ImageDesc desc{.format = bits.one_of({VK_FORMAT_R32_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM,
                                          VK_FORMAT_D32_SFLOAT, VK_FORMAT_D32_SFLOAT_S8_UINT}),
                   .extent = {16, 16, 1}};
    switch (bits.below(4)) {
    case 0: desc.mips = 1 + bits.below(4); break;
    case 1: desc.layers = 1 + bits.below(4); break;
    case 2:
        desc.mips = 1 + bits.below(3);
        desc.layers = 1 + bits.below(3);
        break;
    default:
        if (!is_depth_or_stencil(desc.format)) {
            desc.extent = {32, 16, 1 + bits.below(8)};
            desc.type = VK_IMAGE_TYPE_3D;
        }
    }
    return desc;
}

ImportDesc any_import(Bits& bits, const QueueTopology& topology, bool image) {
    ImportDesc import;
    const bool writes_before = bits.below(2) == 0;
    import.waits_semaphore = bits.below(3) == 0;
    if (!import.waits_semaphore && bits.below(3) != 0) {
        import.initial_stages = host_stages(bits, topology);
        import.initial_access = writes_before ? VK_ACCESS_2_MEMORY_WRITE_BIT : VK_ACCESS_2_MEMORY_READ_BIT;
    }
    if (image && bits.below(3) != 0) {
        import.initial_layout = bits.one_of({VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                             VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR});
    }
    const bool has_content = !image || import.initial_layout != VK_IMAGE_LAYOUT_UNDEFINED;
    if (has_content && bits.below(3) == 0) {
        import.initial_family = any_family(bits, topology);
    }
    import.read_only = has_content && bits.below(4) == 0;
    import.has_final = !import.read_only;
    if (import.has_final || bits.below(2) == 0) {
        import.has_final = true;
        import.final_layout = !image
                                  ? VK_IMAGE_LAYOUT_UNDEFINED
                                  : bits.one_of({VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                                 VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
        import.signals_semaphore = bits.below(3) == 0;
        import.final_stages =
            bits.one_of({VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                         VK_PIPELINE_STAGE_2_HOST_BIT, VkPipelineStageFlags2{0}});
        switch (import.final_stages) {
        case VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT:
            import.final_access = bits.one_of({VK_ACCESS_2_TRANSFER_READ_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT});
            break;
        case VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT: import.final_access = VK_ACCESS_2_SHADER_STORAGE_READ_BIT; break;
        case VK_PIPELINE_STAGE_2_HOST_BIT: import.final_access = VK_ACCESS_2_HOST_READ_BIT; break;
        default: break;
        }
        if (bits.below(4) == 0) {
            import.final_family = any_family(bits, topology);
        }
    }
    return import;
}

PassKind any_kind(Bits& bits) {
    switch (bits.below(10)) {
    case 0: return PassKind::transfer;
    case 1: return bits.below(3) == 0 ? PassKind::host : PassKind::transfer;
    case 2:
    case 3:
    case 4: return PassKind::graphics;
    default: return PassKind::compute;
    }
}

QueueWish any_wish(Bits& bits, PassKind kind) {
    switch (kind) {
    case PassKind::graphics: return bits.one_of({QueueWish::automatic, QueueWish::graphics});
    case PassKind::compute:
        return bits.one_of(
            {QueueWish::automatic, QueueWish::graphics, QueueWish::async_compute, QueueWish::async_compute});
    case PassKind::transfer:
        return bits.one_of({QueueWish::automatic, QueueWish::async_compute, QueueWish::transfer, QueueWish::transfer});
    case PassKind::host: break;
    }
    return QueueWish::automatic;
}

} // namespace tyndall::rg::test
