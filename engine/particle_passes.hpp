// The compute passes of particles on the graph: simulation, sort and split. Each can be declared by itself.
#pragma once

#include <cstdint>

#include "engine/device.hpp"
#include "engine/pipelines.hpp"
#include "rendergraph/executor.hpp"
#include "rendergraph/graph.hpp"

namespace tyndall::engine {

class ParticlePasses {
public:
    /// `device` outlives the passes.
    [[nodiscard]] static tl::expected<ParticlePasses, Error> create(const Device& device, VkPipelineCache cache);

    /// "particle simulation": `frame` (a gpu::ParticleFrame, then gpu::GpuEmitter[]) -> `particles`
    /// (gpu::GpuParticle[particle_count]) and `keys` (two words each, [key_count]): depth key and slot, the keys of
    /// what is not drawn being the largest.
    void declare_simulation(rg::GraphBuilder& graph, rg::Buffer frame, rg::Buffer& particles, rg::Buffer& keys,
                            std::uint32_t key_count) const;

    /// "particle sort", and a pass for each further step of the network when the keys are more than one block holds:
    /// sorts `keys` (x ascending, ties by y). `key_count` is a power of two, at least 2.
    void declare_sort(rg::GraphBuilder& graph, rg::Buffer& keys, std::uint32_t key_count) const;

    /// "particle split": sorted `keys` and `split_count` depths, `splits` (float[], back to front), -> `draws`
    /// (VkDrawIndirectCommand[split_count + 1]), one for the particles between each two of them.
    void declare_split(rg::GraphBuilder& graph, rg::Buffer keys, rg::Buffer splits, rg::Buffer& draws,
                       std::uint32_t key_count, std::uint32_t split_count) const;

    /// Keys that one workgroup sorts in shared memory: 16 KiB of it, what every device has.
    static constexpr std::uint32_t largest_block = 2048;

private:
    /// A pipeline and the layout for its push descriptors and constants.
    struct Program {
        DescriptorSetLayout set;
        PipelineLayout layout;
        Pipeline pipeline;
    };
    struct Wanted;
    ParticlePasses() = default;
    [[nodiscard]] static tl::expected<Program, Error> make_program(const Device& device, VkPipelineCache cache,
                                                                   const Wanted& wanted);

    Program simulation_;
    Program sort_block_;
    Program exchange_;
    Program merge_block_;
    Program split_;
};

} // namespace tyndall::engine
