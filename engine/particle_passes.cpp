#include "engine/particle_passes.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "spirv/particle_merge_block.h"
#include "spirv/particle_simulation.h"
#include "spirv/particle_sort_block.h"
#include "spirv/particle_sort_exchange.h"
#include "spirv/particle_split.h"

namespace tyndall::engine {
namespace {

/// Lanes of a workgroup: every device has room for so many.
constexpr std::uint32_t simulation_group = 64;
constexpr std::uint32_t split_group = 64;
constexpr std::uint32_t exchange_group = 256;
/// Of the steps in shared memory: each lane has eight pairs of a full block, so that few lanes meet at a barrier.
constexpr std::uint32_t block_group = 128;

constexpr std::uint32_t groups_for(std::uint32_t items, std::uint32_t group) {
    return (items + group - 1) / group;
}

/// What a recorded pass binds; the pipelines themselves stay with ParticlePasses.
struct BoundProgram {
    VkPipelineLayout layout;
    VkPipeline pipeline;
    std::span<const rg::ReflectedBinding> bindings;
};

template <typename Program> // ParticlePasses::Program
BoundProgram bound(const Program& program) {
    return {program.layout.get(), program.pipeline.get(), program.pipeline.bindings()};
}

struct SortPush {
    std::uint32_t key_count = 0;
    std::uint32_t sequence = 0; ///< length of the runs that the merge makes
    std::uint32_t stride = 0;   ///< distance of the keys that an exchange compares
};
struct SplitPush {
    std::uint32_t key_count = 0;
    std::uint32_t split_count = 0;
};

template <typename Push>
void push_constants(rg::PassContext& ctx, const BoundProgram& program, const Push& push) {
    ctx.vk().CmdPushConstants(ctx.cmd(), program.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
}

void push_bindings(rg::PassContext& ctx, const BoundProgram& program, std::span<const rg::Binding> bindings) {
    ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, program.layout, 0, bindings, program.bindings);
}

void dispatch(rg::PassContext& ctx, const BoundProgram& program, std::uint32_t groups) {
    ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, program.pipeline);
    ctx.vk().CmdDispatch(ctx.cmd(), groups, 1, 1);
}

void declare_sort_step(rg::GraphBuilder& graph, std::string_view name, rg::Buffer& keys, const BoundProgram& program,
                       const SortPush& push, std::uint32_t groups) {
    rg::PassBuilder pass = graph.add_pass(name, rg::PassKind::compute);
    pass.modifies(keys, rg::Access::storage_compute);
    pass.executes([keys, program, push, groups](rg::PassContext& ctx) {
        const std::array bindings{ctx.storage(0, keys)};
        push_bindings(ctx, program, bindings);
        push_constants(ctx, program, push);
        dispatch(ctx, program, groups);
    });
}

} // namespace

struct ParticlePasses::Wanted {
    std::span<const std::uint32_t> spirv;
    std::uint32_t buffer_count = 0; ///< storage buffers, bindings 0 and up
    std::uint32_t push_bytes = 0;
    std::vector<SpecializationConstant> constants;
};

tl::expected<ParticlePasses::Program, Error> ParticlePasses::make_program(const Device& device, VkPipelineCache cache,
                                                                          const Wanted& wanted) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (std::uint32_t i = 0; i < wanted.buffer_count; ++i) {
        bindings.push_back({i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    }
    auto set = create_set_layout(device, bindings, true);
    if (!set) {
        return tl::unexpected(set.error());
    }
    const VkDescriptorSetLayout handle = set->get();
    auto layout = create_pipeline_layout(device, std::span(&handle, 1), wanted.push_bytes, VK_SHADER_STAGE_COMPUTE_BIT);
    if (!layout) {
        return tl::unexpected(layout.error());
    }
    auto pipeline = create_compute_pipeline(device, cache, layout->get(), wanted.spirv, wanted.constants);
    if (!pipeline) {
        return tl::unexpected(pipeline.error());
    }
    return Program{std::move(*set), std::move(*layout), std::move(*pipeline)};
}

tl::expected<ParticlePasses, Error> ParticlePasses::create(const Device& device, VkPipelineCache cache) {
    ParticlePasses passes;
    const std::pair<Program*, Wanted> programs[] = {
        {&passes.simulation_, {particle_simulation, 3, 0, {{0, simulation_group}}}},
        {&passes.sort_block_, {particle_sort_block, 1, sizeof(SortPush), {{0, block_group}, {1, largest_block}}}},
        {&passes.exchange_, {particle_sort_exchange, 1, sizeof(SortPush), {{0, exchange_group}}}},
        {&passes.merge_block_, {particle_merge_block, 1, sizeof(SortPush), {{0, block_group}, {1, largest_block}}}},
        {&passes.split_, {particle_split, 3, sizeof(SplitPush), {{0, split_group}}}},
    };
    for (const auto& [program, wanted] : programs) {
        auto made = make_program(device, cache, wanted);
        if (!made) {
            return tl::unexpected(made.error());
        }
        *program = std::move(*made);
    }
    return passes;
}

void ParticlePasses::declare_simulation(rg::GraphBuilder& graph, rg::Buffer frame, rg::Buffer& particles,
                                        rg::Buffer& keys, std::uint32_t key_count) const {
    rg::PassBuilder pass = graph.add_pass("particle simulation", rg::PassKind::compute);
    pass.reads(frame, rg::Access::storage_compute)
        .writes(particles, rg::Access::storage_compute)
        .writes(keys, rg::Access::storage_compute);
    pass.executes([frame, particles, keys, key_count, program = bound(simulation_)](rg::PassContext& ctx) {
        const std::array bindings{ctx.storage(0, frame), ctx.storage(1, particles), ctx.storage(2, keys)};
        push_bindings(ctx, program, bindings);
        dispatch(ctx, program, groups_for(key_count, simulation_group));
    });
}

void ParticlePasses::declare_sort(rg::GraphBuilder& graph, rg::Buffer& keys, std::uint32_t key_count) const {
    const std::uint32_t block = std::min(largest_block, key_count);
    const std::uint32_t blocks = key_count / block;
    declare_sort_step(graph, "particle sort", keys, bound(sort_block_), {key_count, 0, 0}, blocks);
    // Runs of twice the length each time, until one run holds all.
    for (std::uint32_t sequence = 2 * block; sequence <= key_count; sequence *= 2) {
        const std::string name = "particle merge " + std::to_string(sequence);
        for (std::uint32_t stride = sequence / 2; stride >= block; stride /= 2) {
            declare_sort_step(graph, name + " by " + std::to_string(stride), keys, bound(exchange_),
                              {key_count, sequence, stride}, groups_for(key_count / 2, exchange_group));
        }
        declare_sort_step(graph, name, keys, bound(merge_block_), {key_count, sequence, 0}, blocks);
    }
}

void ParticlePasses::declare_split(rg::GraphBuilder& graph, rg::Buffer keys, rg::Buffer splits, rg::Buffer& draws,
                                   std::uint32_t key_count, std::uint32_t split_count) const {
    rg::PassBuilder pass = graph.add_pass("particle split", rg::PassKind::compute);
    pass.reads(keys, rg::Access::storage_compute)
        .reads(splits, rg::Access::storage_compute)
        .writes(draws, rg::Access::storage_compute);
    pass.executes([keys, splits, draws, key_count, split_count, program = bound(split_)](rg::PassContext& ctx) {
        const std::array bindings{ctx.storage(0, keys), ctx.storage(1, splits), ctx.storage(2, draws)};
        push_bindings(ctx, program, bindings);
        push_constants(ctx, program, SplitPush{key_count, split_count});
        dispatch(ctx, program, groups_for(split_count + 1, split_group));
    });
}

} // namespace tyndall::engine
