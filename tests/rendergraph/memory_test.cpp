// Memory sharing: never between resources whose uses the plan leaves unordered, and always when it pays.
#include <algorithm>
#include <cstdio>
#include <random>

#include "rendergraph/limits.hpp"
#include "rendergraph/memory_types.hpp"
#include "rendergraph/plan_cache.hpp"
#include "rendergraph/refine.hpp"
#include "rendergraph/verify.hpp"
#include "rendergraph/vulkan_names.hpp"
#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {
namespace {

bool bytes_meet(const Placement& a, const Placement& b) {
    return a.kind == PlacementKind::heap && b.kind == PlacementKind::heap && a.heap == b.heap &&
           a.offset_bytes < b.offset_bytes + b.size_bytes && b.offset_bytes < a.offset_bytes + a.size_bytes;
}

DeclaredGraph chain_of(std::uint32_t length) {
    GraphBuilder graph;
    Buffer previous = graph.create_buffer("buffer 0", {.size_bytes = 1024});
    graph.add_pass("pass 0", PassKind::compute).writes(previous, Access::storage_compute);
    for (std::uint32_t i = 1; i < length; ++i) {
        Buffer next = graph.create_buffer("buffer " + std::to_string(i), {.size_bytes = 1024});
        graph.add_pass("pass " + std::to_string(i), PassKind::compute)
            .reads(previous, Access::storage_compute)
            .writes(next, Access::storage_compute);
        previous = next;
    }
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    graph.add_pass("last", PassKind::compute)
        .reads(previous, Access::storage_compute)
        .writes(out, Access::storage_compute);
    return graph.finish();
}

TEST(Memory, EstimatesKnowEveryFormat) {
    const auto bytes_of = [](const ImageDesc& image) {
        GraphDesc graph;
        graph.resources.push_back({.image = image});
        return estimate_memory(graph).of_resource[0].size_bytes;
    };
    for (const VulkanName& format : format_names()) {
        EXPECT_NE(bytes_of({.format = static_cast<VkFormat>(format.value), .extent = {8, 8, 1}}), 0U) << format.name;
    }
    const VkExtent3D extent = {1024, 512, 1};
    const VkDeviceSize texels = VkDeviceSize{1024} * 512;
    EXPECT_EQ(bytes_of({.format = VK_FORMAT_R8_SNORM, .extent = extent}), texels);
    EXPECT_EQ(bytes_of({.format = VK_FORMAT_R5G6B5_UNORM_PACK16, .extent = extent}), texels * 2);
    EXPECT_EQ(bytes_of({.format = VK_FORMAT_R64G64B64A64_SFLOAT, .extent = extent}), texels * 32);
    EXPECT_EQ(bytes_of({.format = VK_FORMAT_BC1_RGB_UNORM_BLOCK, .extent = extent}), texels / 2);
    EXPECT_EQ(bytes_of({.format = VK_FORMAT_BC7_SRGB_BLOCK, .extent = extent, .layers = 3}), texels * 3);
    EXPECT_EQ(bytes_of({.format = VK_FORMAT_ASTC_8x8_UNORM_BLOCK, .extent = extent}), texels / 4);
    // 103 x 52 blocks of 10 x 10 texels, those at two edges in part.
    EXPECT_EQ(bytes_of({.format = VK_FORMAT_ASTC_10x10_UNORM_BLOCK, .extent = extent}), VkDeviceSize{21} * 4096);
    EXPECT_EQ(bytes_of({.format = VK_FORMAT_BC7_UNORM_BLOCK, .extent = {128, 128, 1}, .mips = 8}),
              VkDeviceSize{6} * 4096); // the last mips have a whole block each
    // More than fits into the number.
    EXPECT_GT(bytes_of({.format = VK_FORMAT_R32G32B32A32_SFLOAT, .extent = {~0U, ~0U, ~0U}, .mips = 32, .layers = ~0U}),
              most_bytes);
}

TEST(Memory, AChainNeedsTwoBuffersAtATime) {
    const DeclaredGraph declared = chain_of(8);
    const Plan plan = compiled(declared.desc, one_queue());
    EXPECT_EQ(plan.statistics.transient_bytes, 2048U);
    EXPECT_EQ(plan.statistics.transient_bound_bytes, 2048U);
    EXPECT_EQ(plan.statistics.transient_bytes_unaliased, 8192U);
    EXPECT_EQ(compiled(declared.desc, one_queue(), {.aliasing = false}).statistics.transient_bytes, 8192U);
}

TEST(Memory, TheFirstUseOfSharedBytesDependsOnTheLastUseBefore) {
    const DeclaredGraph declared = chain_of(4);
    const Plan plan = compiled(declared.desc, one_queue());
    std::uint32_t aliased = 0;
    for (const Dependency& d : plan.dependencies) {
        if (d.hazard == Hazard::aliased_memory) {
            ++aliased;
            EXPECT_NE(d.alias_of, none);
            EXPECT_NE(d.producer, none);
            EXPECT_EQ(d.old_layout, VK_IMAGE_LAYOUT_UNDEFINED);
        }
    }
    EXPECT_EQ(aliased, 2U); // buffers 2 and 3 take over the bytes of 0 and 1
}

TEST(Memory, UnorderedPassesOfTwoQueuesNeverShare) {
    // Both chains run at the same time for all that the plan says.
    GraphBuilder graph;
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    Buffer graphics = graph.create_buffer("graphics", {.size_bytes = 4096});
    Buffer compute = graph.create_buffer("compute", {.size_bytes = 4096});
    Buffer merged = graph.create_buffer("merged", {.size_bytes = 64});
    graph.add_pass("make graphics", PassKind::compute).writes(graphics, Access::storage_compute);
    graph.add_pass("make compute", PassKind::compute)
        .writes(compute, Access::storage_compute)
        .on_queue(QueueWish::async_compute);
    graph.add_pass("use compute", PassKind::compute)
        .reads(compute, Access::storage_compute)
        .writes(merged, Access::storage_compute)
        .on_queue(QueueWish::async_compute);
    graph.add_pass("use graphics", PassKind::compute)
        .reads(graphics, Access::storage_compute)
        .reads(merged, Access::storage_compute)
        .writes(out, Access::storage_compute);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, two_queues());
    EXPECT_FALSE(bytes_meet(plan.placements[graphics.resource], plan.placements[compute.resource]));
}

TEST(Memory, GranularityKeepsBuffersAndImagesOnTheirOwnPages) {
    GraphBuilder graph;
    Buffer buffer = graph.create_buffer("buffer", {.size_bytes = 100});
    Image image = graph.create_image("image", {.format = VK_FORMAT_R8_UNORM, .extent = {10, 10, 1}});
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    graph.add_pass("make", PassKind::compute)
        .writes(buffer, Access::storage_compute)
        .writes(image, Access::storage_compute);
    graph.add_pass("use", PassKind::compute)
        .reads(buffer, Access::storage_compute)
        .reads(image, Access::sampled_compute)
        .writes(out, Access::storage_compute);
    const DeclaredGraph declared = graph.finish();
    MemoryRequirements memory;
    memory.of_resource = {{100, 4, 1}, {100, 4, 1}, {64, 4, 1}};
    memory.buffer_image_granularity = 1024;
    const tl::expected<Plan, Diagnostics> plan = compile(declared.desc, one_queue(), memory);
    ASSERT_TRUE(plan.has_value());
    EXPECT_NE(plan->placements[0].offset_bytes / 1024, plan->placements[1].offset_bytes / 1024);
}

TEST(Memory, ResourcesOfDifferentMemoryTypesLieInDifferentHeaps) {
    const DeclaredGraph declared = chain_of(2);
    MemoryRequirements memory;
    memory.of_resource = {{1024, 4, 1}, {1024, 4, 2}, {64, 4, 1}};
    const tl::expected<Plan, Diagnostics> plan = compile(declared.desc, one_queue(), memory);
    ASSERT_TRUE(plan.has_value());
    ASSERT_EQ(plan->heaps.size(), 2U);
    EXPECT_NE(plan->placements[0].heap, plan->placements[1].heap);
}

TEST(Memory, RandomChainsStayOrderedAndNearTheLowerBound) {
    // Every pass reads up to two earlier buffers and writes a new one; sizes vary by a factor of 64.
    for (std::uint32_t seed = 1; seed <= 200; ++seed) {
        std::mt19937 random(seed);
        GraphBuilder graph;
        std::vector<Buffer> made;
        Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
        for (std::uint32_t i = 0; i < 24; ++i) {
            Buffer next = graph.create_buffer("buffer " + std::to_string(i), {.size_bytes = 256ULL << (random() % 7)});
            PassBuilder pass = graph.add_pass("pass " + std::to_string(i), PassKind::compute);
            for (std::uint32_t k = 0; k < 2 && !made.empty(); ++k) {
                const std::size_t back = random() % std::min<std::size_t>(6, made.size());
                pass.reads(made[made.size() - 1 - back], Access::storage_compute);
            }
            pass.writes(next, Access::storage_compute);
            if (random() % 3 == 0) {
                pass.on_queue(QueueWish::async_compute);
            }
            made.push_back(next);
        }
        PassBuilder last = graph.add_pass("last", PassKind::compute);
        last.reads(made.back(), Access::storage_compute).writes(out, Access::storage_compute);
        const DeclaredGraph declared = graph.finish();
        const Plan plan = compiled(declared.desc, one_queue());
        EXPECT_GE(plan.statistics.transient_bytes, plan.statistics.transient_bound_bytes) << "seed " << seed;
        EXPECT_LE(plan.statistics.transient_bytes, plan.statistics.transient_bound_bytes * 3 / 2) << "seed " << seed;

        // On one queue two resources may meet only if one's last use comes before the other's first.
        const auto uses = [&](std::uint32_t resource) {
            std::uint32_t first = none;
            std::uint32_t last_use = 0;
            for (std::uint32_t i = 0; i < plan.passes.size(); ++i) {
                const PassDesc& pass = declared.desc.passes[plan.passes[i].pass];
                for (std::uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
                    if (declared.desc.accesses[a].resource == resource) {
                        first = first == none ? i : first;
                        last_use = i;
                    }
                }
            }
            return std::pair{first, last_use};
        };
        for (std::uint32_t a = 0; a < plan.placements.size(); ++a) {
            for (std::uint32_t b = a + 1; b < plan.placements.size(); ++b) {
                if (bytes_meet(plan.placements[a], plan.placements[b])) {
                    const auto [first_a, last_a] = uses(a);
                    const auto [first_b, last_b] = uses(b);
                    EXPECT_TRUE(last_a < first_b || last_b < first_a) << "seed " << seed;
                }
            }
        }
    }
}

/// A frame whose transients vary in size by a factor of 1,000.
DeclaredGraph buffers_and_images(std::uint32_t seed, std::uint32_t passes) {
    std::mt19937 random(seed);
    GraphBuilder graph;
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    std::vector<Buffer> buffers;
    std::vector<Image> images;
    for (std::uint32_t i = 0; i < passes; ++i) {
        PassBuilder pass = graph.add_pass("pass " + std::to_string(i), PassKind::compute);
        for (std::uint32_t k = 0; k < 2; ++k) {
            const std::size_t back = random() % 5;
            if (random() % 2 == 0 && buffers.size() > back) {
                pass.reads(buffers[buffers.size() - 1 - back], Access::storage_compute);
            } else if (images.size() > back) {
                pass.reads(images[images.size() - 1 - back], Access::sampled_compute);
            }
        }
        const auto size = static_cast<std::uint32_t>((8U << (random() % 6)) + random() % 8);
        if (random() % 2 == 0) {
            buffers.push_back(
                graph.create_buffer("buffer " + std::to_string(i), {.size_bytes = VkDeviceSize{size} * size * 4}));
            pass.writes(buffers.back(), Access::storage_compute);
        } else {
            images.push_back(graph.create_image("image " + std::to_string(i),
                                                {.format = VK_FORMAT_R32_SFLOAT, .extent = {size, size, 1}}));
            pass.writes(images.back(), Access::storage_compute);
        }
        pass.has_side_effect("keeps it");
        if (random() % 4 == 0) {
            pass.on_queue(QueueWish::async_compute);
        }
    }
    graph.add_pass("last", PassKind::compute).writes(out, Access::storage_compute);
    return graph.finish();
}

/// Bytes of the plan over its lower bound, sorted.
std::vector<double> ratios_to_the_bound(std::uint32_t frames, std::uint32_t passes, const QueueTopology& topology,
                                        Effort effort) {
    std::vector<double> ratios;
    for (std::uint32_t seed = 1; seed <= frames; ++seed) {
        const Plan plan = compiled(buffers_and_images(seed, passes).desc, topology, {.effort = effort});
        ratios.push_back(static_cast<double>(plan.statistics.transient_bytes) /
                         static_cast<double>(plan.statistics.transient_bound_bytes));
    }
    std::sort(ratios.begin(), ratios.end());
    return ratios;
}

TEST(Memory, ARefinedPackingStaysWhereItFits) {
    std::uint32_t smaller = 0;
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
        const DeclaredGraph declared = buffers_and_images(seed, 40);
        const MemoryRequirements memory = estimate_memory(declared.desc);
        PlanCache cache;
        const VkDeviceSize first = (*cache.compile(declared.desc, two_queues(), memory))->statistics.transient_bytes;
        auto refined = refine(declared.desc, two_queues(), memory, {}, {});
        ASSERT_TRUE(refined.has_value());
        const VkDeviceSize less = refined->plan.statistics.transient_bytes;
        smaller += less < first ? 1 : 0;
        Plan moved = refined->plan;
        cache.prefer(std::move(refined->plan));
        const auto next = cache.compile(declared.desc, two_queues(), memory);
        EXPECT_EQ((*next)->statistics.transient_bytes, less) << seed;
        EXPECT_TRUE(verify(declared.desc, **next).empty()) << seed;
        // Packings that are none: everything at the heap's begin, everything one byte off.
        for (const VkDeviceSize wrong : {VkDeviceSize{0}, VkDeviceSize{1}}) {
            for (Placement& placement : moved.placements) {
                placement.offset_bytes = wrong;
            }
            const auto plan = compile(declared.desc, two_queues(), memory, {}, {}, &moved);
            EXPECT_TRUE(verify(declared.desc, *plan).empty()) << seed;
        }
    }
    EXPECT_GT(smaller, 5U);
}

TEST(Memory, PlansOfBuffersAndImagesAreNearTheLowerBound) {
    for (const std::uint32_t passes : {12U, 40U, 150U, 400U}) {
        for (const auto& [effort, name, most] :
             {std::tuple{Effort::quick, "first plan", 1.2}, std::tuple{Effort::thorough, "refined", 1.1}}) {
            const std::vector<double> one = ratios_to_the_bound(300, passes, one_queue(), effort);
            const std::vector<double> two = ratios_to_the_bound(300, passes, two_queues(), effort);
            std::printf("%u passes, %s: transient bytes over the lower bound, median and 99th percentile: one queue "
                        "%.3f %.3f, two queues %.3f %.3f\n",
                        passes, name, one[150], one[297], two[150], two[297]);
            for (const std::vector<double>& ratios : {one, two}) {
                EXPECT_LE(ratios[150], 1.02);
                EXPECT_LE(ratios[297], most);
            }
        }
    }
}

/// Whether blocks of whole units fit below `height` units. Depth first over offsets.
bool fits(const std::vector<std::uint32_t>& units, const std::vector<std::vector<bool>>& excludes, std::uint32_t height,
          std::vector<std::uint32_t>& offset) {
    const std::size_t block = offset.size();
    if (block == units.size()) {
        return true;
    }
    for (std::uint32_t at = 0; at + units[block] <= height; ++at) {
        bool free = true;
        for (std::size_t other = 0; other < block; ++other) {
            free = free && (!excludes[block][other] || at + units[block] <= offset[other] ||
                            offset[other] + units[other] <= at);
        }
        offset.push_back(at);
        if (free && fits(units, excludes, height, offset)) {
            return true;
        }
        offset.pop_back();
    }
    return false;
}

TEST(Memory, PackingsOfUpToSevenBlocksAreOptimal) {
    constexpr VkDeviceSize unit = 256;
    std::mt19937 random(5);
    std::uint32_t above_the_largest_block = 0;
    for (int round = 0; round < 300; ++round) {
        const std::size_t count = 2 + random() % 6;
        std::vector<stages::Block> blocks(count);
        std::vector<std::uint32_t> units(count);
        for (std::size_t i = 0; i < count; ++i) {
            units[i] = 1 + random() % 4;
            blocks[i] = {.size_bytes = units[i] * unit, .alignment = unit, .first_slot = static_cast<std::uint32_t>(i)};
        }
        std::vector<std::vector<bool>> excludes(count, std::vector<bool>(count, false));
        stages::Conflicts conflicts{{0}, {}};
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                excludes[i][k] = excludes[k][i] = random() % 2 == 0;
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            for (std::uint32_t k = 0; k < count; ++k) {
                if (excludes[i][k]) {
                    conflicts.with.push_back(k);
                }
            }
            conflicts.first.push_back(static_cast<std::uint32_t>(conflicts.with.size()));
        }
        std::uint32_t least = *std::max_element(units.begin(), units.end());
        const std::uint32_t largest_block = least;
        for (std::vector<std::uint32_t> offset; !fits(units, excludes, least, offset); offset.clear()) {
            ++least;
        }
        above_the_largest_block += least > largest_block ? 1 : 0;
        EXPECT_EQ(stages::pack(blocks, conflicts, 1, 0, Effort::thorough).total_bytes, least * unit)
            << "round " << round;
    }
    EXPECT_GT(above_the_largest_block, 100U);
}

TEST(Memory, HundredsOfBlocksKeepApartWhatConflicts) {
    std::minstd_rand engine(6);
    const auto random = [&] { return static_cast<std::uint32_t>(engine()); };
    for (int round = 0; round < 40; ++round) {
        const std::uint32_t count = 100 + random() % 300;
        const std::uint32_t reach = 1 + random() % 60; // how far apart two may be that conflict
        std::vector<stages::Block> blocks(count);
        std::vector<std::vector<std::uint32_t>> with(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            blocks[i] = {.heap = random() % 4 == 0 ? 1U : 0U,
                         .size_bytes = (1 + random() % 9) * VkDeviceSize{4096},
                         .alignment = VkDeviceSize{4096} << random() % 3,
                         .first_slot = i,
                         .last_slot = i + random() % reach};
            for (std::uint32_t k = i - std::min(i, reach); k < i; ++k) {
                if (blocks[k].heap == blocks[i].heap && random() % 3 != 0) {
                    with[i].push_back(k);
                    with[k].push_back(i);
                }
            }
        }
        stages::Conflicts conflicts{{0}, {}};
        for (const std::vector<std::uint32_t>& row : with) {
            conflicts.with.insert(conflicts.with.end(), row.begin(), row.end());
            conflicts.first.push_back(static_cast<std::uint32_t>(conflicts.with.size()));
        }
        for (const Effort effort : {Effort::quick, Effort::thorough}) {
            const stages::Packing packing = stages::pack(blocks, conflicts, 2, 0, effort);
            VkDeviceSize end[2] = {0, 0};
            for (std::uint32_t i = 0; i < count; ++i) {
                const VkDeviceSize begin = packing.offset_bytes[i];
                ASSERT_EQ(begin % blocks[i].alignment, 0U);
                end[blocks[i].heap] = std::max(end[blocks[i].heap], begin + blocks[i].size_bytes);
                for (const std::uint32_t other : with[i]) {
                    ASSERT_TRUE(packing.offset_bytes[other] + blocks[other].size_bytes <= begin ||
                                begin + blocks[i].size_bytes <= packing.offset_bytes[other])
                        << "round " << round << ", blocks " << i << " and " << other;
                }
            }
            EXPECT_EQ(packing.heap_bytes[0], end[0]);
            EXPECT_EQ(packing.heap_bytes[1], end[1]);
            EXPECT_EQ(packing.total_bytes, end[0] + end[1]);
            EXPECT_GE(packing.total_bytes, packing.bound_bytes);
        }
    }
}

} // namespace
} // namespace tyndall::rg::test
