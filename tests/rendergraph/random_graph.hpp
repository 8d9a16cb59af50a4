// Seeded random frames: mips, layers, buffers with byte ranges, imports, histories, queue wishes, dead ends.
#pragma once

#include <random>

#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {

/// The same seed gives the same frame everywhere (only the generator's raw bits are used).
inline DeclaredGraph random_frame(std::uint32_t seed) {
    std::mt19937 bits(seed);
    const auto below = [&bits](std::uint32_t limit) { return static_cast<std::uint32_t>(bits() % limit); };
    GraphBuilder graph;
    const VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;

    struct Slot {
        Image image;
        Buffer buffer;
        bool written = false; ///< every part has content
        bool writable = true;
    };
    std::vector<Slot> slots;
    const std::uint32_t resources = 3 + below(6);
    for (std::uint32_t i = 0; i < resources; ++i) {
        const std::string name = "r" + std::to_string(i);
        Slot slot;
        switch (below(5)) {
        case 0: slot.buffer = graph.create_buffer(name, {.size_bytes = 256ULL << below(4)}); break;
        case 1:
            slot.buffer = graph.import_buffer(name, {.size_bytes = 512},
                                              {.initial_stages = below(2) == 0 ? compute : 0,
                                               .initial_access = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                                               .has_final = true,
                                               .final_stages = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                               .final_access = VK_ACCESS_2_TRANSFER_READ_BIT});
            slot.written = true;
            break;
        case 2:
            slot.image = graph.create_image(
                name,
                {.format = VK_FORMAT_R32_SFLOAT, .extent = {16, 16, 1}, .mips = 1 + below(3), .layers = 1 + below(3)});
            break;
        case 3: slot.image = graph.create_image(name, color_image(16, 16)); break;
        default: slot.image = graph.import_image(name, color_image(16, 16), left_for_host()); break;
        }
        slots.push_back(slot);
    }
    if (below(2) == 0) {
        for (std::size_t i = 0; i < resources; ++i) {
            if (slots[i].image.valid() && graph.describe(slots[i].image)->mips == 1 && !slots[i].written) {
                // Only a transient can have a history; an import would be refused.
                if (graph.describe(slots[i].image)->format != VK_FORMAT_R32_SFLOAT) {
                    continue;
                }
                Slot previous;
                previous.image = graph.history_of(slots[i].image);
                previous.written = true;
                previous.writable = false;
                slots.push_back(previous);
                // It must be written for its history to mean anything.
                graph.add_pass("begin r" + std::to_string(i), PassKind::compute)
                    .writes(slots[i].image, Access::storage_compute)
                    .on_queue(below(2) == 0 ? QueueWish::async_compute : QueueWish::automatic);
                slots[i].written = true;
                break;
            }
        }
    }
    const std::uint32_t passes = 3 + below(12);
    for (std::uint32_t p = 0; p < passes; ++p) {
        const bool graphics = below(3) == 0;
        PassBuilder pass = graph.add_pass("p" + std::to_string(p), graphics ? PassKind::graphics : PassKind::compute);
        if (!graphics && below(2) == 0) {
            pass.on_queue(QueueWish::async_compute);
        }
        if (below(8) == 0) {
            pass.has_side_effect("random");
        }
        std::vector<std::uint32_t> used;
        const auto fresh = [&](std::uint32_t i) {
            const bool is = std::find(used.begin(), used.end(), i) == used.end();
            used.push_back(i);
            return is;
        };
        const std::uint32_t reads = below(3);
        for (std::uint32_t k = 0; k < reads; ++k) {
            const std::uint32_t i = below(static_cast<std::uint32_t>(slots.size()));
            if (!slots[i].written || !fresh(i)) {
                continue;
            }
            if (slots[i].buffer.valid()) {
                const VkDeviceSize half = graph.describe(slots[i].buffer)->size_bytes / 2;
                const BufferRange range = below(2) == 0 ? BufferRange{} : BufferRange{half * below(2), half};
                pass.reads(slots[i].buffer, graphics ? Access::storage_fragment : Access::storage_compute, range);
            } else {
                const ImageDesc desc = *graph.describe(slots[i].image);
                const ImageRange range =
                    below(2) == 0 ? ImageRange{} : ImageRange{below(desc.mips), 1, below(desc.layers), 1};
                pass.reads(slots[i].image, graphics ? Access::sampled_fragment : Access::sampled_compute, range);
            }
        }
        std::uint32_t writes = 0;
        for (std::uint32_t attempt = 0; attempt < 6 && writes < 1 + p % 2; ++attempt) {
            const std::uint32_t i = below(static_cast<std::uint32_t>(slots.size()));
            if (!slots[i].writable || !fresh(i)) {
                continue;
            }
            ++writes;
            if (slots[i].buffer.valid()) {
                const Access access = graphics ? Access::storage_fragment : Access::storage_compute;
                const VkDeviceSize half = graph.describe(slots[i].buffer)->size_bytes / 2;
                if (slots[i].written && below(2) == 0) {
                    pass.modifies(slots[i].buffer, access, below(2) == 0 ? BufferRange{} : BufferRange{half, half});
                } else {
                    pass.writes(slots[i].buffer, access);
                }
            } else {
                const ImageDesc desc = *graph.describe(slots[i].image);
                const bool attachment = graphics && desc.mips == 1 && desc.layers == 1;
                const Access access = attachment ? Access::color_attachment
                                      : graphics ? Access::storage_fragment
                                                 : Access::storage_compute;
                if (slots[i].written && below(2) == 0) {
                    pass.modifies(slots[i].image, access,
                                  attachment || below(2) == 0 ? ImageRange{}
                                                              : ImageRange{below(desc.mips), 1, below(desc.layers), 1});
                } else {
                    pass.writes(slots[i].image, access);
                }
            }
            slots[i].written = true;
        }
        if (writes == 0) {
            pass.has_side_effect("random");
        }
    }
    return graph.finish();
}

/// One to three queues, in one family or several.
inline QueueTopology random_topology(std::uint32_t seed) {
    switch (seed % 4) {
    case 0: return one_queue();
    case 1: return two_queues();
    case 2: return two_queues_one_family();
    default: {
        QueueTopology topology = two_queues();
        topology.queues.push_back({QueueKind::transfer, 2, can_transfer});
        return topology;
    }
    }
}

} // namespace tyndall::rg::test
