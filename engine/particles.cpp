#include "engine/particles.hpp"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "spirv/particle_direct_s0_l0.h"
#include "spirv/particle_direct_s0_l1.h"
#include "spirv/particle_direct_s1_l0.h"
#include "spirv/particle_direct_s1_l1.h"
#include "spirv/particle_fragment.h"
#include "spirv/particle_scattering.h"

namespace tyndall::engine {
namespace {

constexpr VkShaderStageFlags vertex = VK_SHADER_STAGE_VERTEX_BIT;
constexpr VkShaderStageFlags fragment = VK_SHADER_STAGE_FRAGMENT_BIT;
constexpr VkDescriptorType storage_buffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
constexpr VkDescriptorType uniform_buffer = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
constexpr VkDescriptorType sampled_image = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;

// Numbered as in particle.vert, particle_light.glsl and particle.frag.
constexpr ParticleBinding common_bindings[] = {{0, storage_buffer, vertex | fragment},
                                               {1, storage_buffer, vertex},
                                               {2, storage_buffer, vertex},
                                               {3, sampled_image, fragment}};
constexpr ParticleBinding scattering_bindings[] = {
    {4, uniform_buffer, vertex}, {5, sampled_image, vertex}, {6, sampled_image, vertex}};
constexpr ParticleBinding sun_bindings[] = {{4, uniform_buffer, vertex}, {5, sampled_image, vertex}};
constexpr ParticleBinding light_bindings[] = {{6, storage_buffer, vertex}};

constexpr std::size_t direct_index(bool sun_shadow, bool lights) {
    return 2 * static_cast<std::size_t>(sun_shadow) + static_cast<std::size_t>(lights);
}

constexpr VkDeviceSize command_bytes = sizeof(VkDrawIndirectCommand);

/// Room for so many split depths; a buffer is never empty.
constexpr VkDeviceSize split_bytes(std::size_t count) {
    return std::bit_ceil(std::max<std::size_t>(count, 16)) * sizeof(float);
}

/// Host-written before the frame is submitted, which makes it visible.
constexpr rg::ImportDesc written_by_host{.read_only = true};

} // namespace

tl::expected<std::unique_ptr<ParticleSystem>, Error>
ParticleSystem::create(const ParticleDevice& device, std::vector<ParticleEmitter> emitters,
                       std::uint32_t frames_in_flight, VkFormat color_format, VkFormat depth_format) {
    if (emitters.empty()) {
        return tl::unexpected(Error{"A particle system needs at least one emitter."});
    }
    std::unique_ptr<ParticleSystem> self(new ParticleSystem(device, std::move(emitters)));
    auto passes = ParticlePasses::create(device);
    if (!passes) {
        return tl::unexpected(passes.error());
    }
    self->passes_ = std::move(*passes);
    auto made = self->make_billboards(color_format, depth_format)
                    .and_then([&] { return self->make_sampler(VK_FILTER_LINEAR, self->linear_); })
                    .and_then([&] { return self->make_sampler(VK_FILTER_NEAREST, self->nearest_); });
    if (!made) {
        return tl::unexpected(made.error());
    }
    const VkDeviceSize frame_bytes = sizeof(gpu::ParticleFrame) + self->emitters_.size() * sizeof(gpu::GpuEmitter);
    for (std::uint32_t i = 0; i < frames_in_flight; ++i) {
        auto frame = ParticleBuffer::create(device, frame_bytes);
        if (!frame) {
            return tl::unexpected(frame.error());
        }
        auto splits = ParticleBuffer::create(device, split_bytes(0));
        if (!splits) {
            return tl::unexpected(splits.error());
        }
        self->slots_.push_back({std::move(*frame), std::move(*splits)});
    }
    return self;
}

ParticleSystem::~ParticleSystem() {
    device_.vk->DestroySampler(device_.device, linear_, nullptr);
    device_.vk->DestroySampler(device_.device, nearest_, nullptr);
}

tl::expected<void, Error> ParticleSystem::make_billboards(VkFormat color_format, VkFormat depth_format) {
    const auto make = [&](ParticleProgram& program, std::span<const std::uint32_t> spirv,
                          const std::vector<ParticleBinding>& bindings) -> tl::expected<void, Error> {
        const auto made = programs_.billboards(spirv, particle_fragment, bindings, color_format, depth_format);
        if (!made) {
            return tl::unexpected(made.error());
        }
        program = *made;
        return {};
    };
    std::vector<ParticleBinding> bindings(std::begin(common_bindings), std::end(common_bindings));
    bindings.insert(bindings.end(), std::begin(scattering_bindings), std::end(scattering_bindings));
    if (auto made = make(scattering_program_, particle_scattering, bindings); !made) {
        return made;
    }
    const std::span<const std::uint32_t> direct[] = {particle_direct_s0_l0, particle_direct_s0_l1,
                                                     particle_direct_s1_l0, particle_direct_s1_l1};
    for (const bool sun_shadow : {false, true}) {
        for (const bool lights : {false, true}) {
            bindings.assign(std::begin(common_bindings), std::end(common_bindings));
            if (sun_shadow) {
                bindings.insert(bindings.end(), std::begin(sun_bindings), std::end(sun_bindings));
            }
            if (lights) {
                bindings.insert(bindings.end(), std::begin(light_bindings), std::end(light_bindings));
            }
            const std::size_t index = direct_index(sun_shadow, lights);
            if (auto made = make(direct_programs_[index], direct[index], bindings); !made) {
                return made;
            }
        }
    }
    return {};
}

tl::expected<void, Error> ParticleSystem::make_sampler(VkFilter filter, VkSampler& sampler) {
    const VkSamplerCreateInfo info{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                   .magFilter = filter,
                                   .minFilter = filter,
                                   .mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
                                   .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    const VkResult result = device_.vk->CreateSampler(device_.device, &info, nullptr, &sampler);
    if (result != VK_SUCCESS) {
        return tl::unexpected(Error{"The device refused a sampler of the particles (VkResult " +
                                    std::to_string(static_cast<int>(result)) + ")."});
    }
    return {};
}

tl::expected<void, Error> ParticleSystem::write_host_data(const ParticleView& view,
                                                          std::span<const float> split_depths_m, Slot& slot) {
    if (slot.splits.size_bytes() < split_depths_m.size_bytes()) {
        auto larger = ParticleBuffer::create(device_, split_bytes(split_depths_m.size()));
        if (!larger) {
            return tl::unexpected(larger.error());
        }
        slot.splits = std::move(*larger);
    }
    slot.splits.write(0, std::as_bytes(split_depths_m));
    const gpu::ParticleFrame frame = make_particle_frame(view, emitters_);
    slot.frame.write(0, std::as_bytes(std::span(&frame, 1)));
    const std::vector<gpu::GpuEmitter> emitters = make_gpu_emitters(view, emitters_);
    slot.frame.write(sizeof frame, std::as_bytes(std::span(emitters)));
    return {};
}

tl::expected<ParticleDraws, Error> ParticleSystem::declare(rg::GraphBuilder& graph, const ParticleView& view,
                                                           std::span<const float> split_depths_m,
                                                           std::uint32_t frame_slot) {
    Slot& slot = slots_[frame_slot];
    if (auto written = write_host_data(view, split_depths_m, slot); !written) {
        return tl::unexpected(written.error());
    }
    const auto split_count = static_cast<std::uint32_t>(split_depths_m.size());
    const std::uint32_t key_count = particle_key_count(count());
    ParticleDraws draws;
    draws.interval_count = split_count + 1;
    draws.frame = graph.import_buffer("particle emitters", {.size_bytes = slot.frame.size_bytes()}, written_by_host);
    const rg::Buffer splits =
        graph.import_buffer("particle split depths", {.size_bytes = slot.splits.size_bytes()}, written_by_host);
    draws.particles = graph.create_buffer("particles", {.size_bytes = count() * sizeof(gpu::GpuParticle)});
    draws.keys =
        graph.create_buffer("particle keys", {.size_bytes = VkDeviceSize{key_count} * 2 * sizeof(std::uint32_t)});
    draws.commands = graph.create_buffer("particle draws", {.size_bytes = draws.interval_count * command_bytes});
    passes_->declare_simulation(graph, draws.frame, draws.particles, draws.keys, key_count);
    passes_->declare_sort(graph, draws.keys, key_count);
    passes_->declare_split(graph, draws.keys, splits, draws.commands, key_count, split_count);
    draws.imports[0] = {.resource = draws.frame.resource, .buffer = slot.frame.buffer()};
    draws.imports[1] = {.resource = splits.resource, .buffer = slot.splits.buffer()};
    return draws;
}

void ParticleSystem::add_reads(rg::PassBuilder& pass, const ParticleDraws& draws,
                               const ParticleLighting& lighting) const {
    pass.reads(draws.frame, rg::Access::storage_graphics)
        .reads(draws.particles, rg::Access::storage_graphics)
        .reads(draws.keys, rg::Access::storage_graphics)
        .reads(draws.commands, rg::Access::indirect_argument)
        .reads(lighting.scene_depth, rg::Access::sampled_fragment);
    if (lighting.scattering) {
        pass.reads(lighting.scattering->parameters, rg::Access::uniform_graphics)
            .reads(lighting.scattering->accumulated, rg::Access::sampled_graphics)
            .reads(lighting.scattering->in_scattered, rg::Access::sampled_graphics);
        return;
    }
    if (lighting.sun_shadow) {
        pass.reads(lighting.sun_shadow->parameters, rg::Access::uniform_graphics)
            .reads(lighting.sun_shadow->cascades, rg::Access::sampled_graphics);
    }
    if (lighting.lights) {
        pass.reads(*lighting.lights, rg::Access::storage_graphics);
    }
}

void ParticleSystem::draw(rg::PassContext& ctx, const ParticleDraws& draws, const ParticleLighting& lighting,
                          std::uint32_t interval) const {
    std::array<rg::Binding, 7> bindings{};
    std::size_t bound = 0;
    const auto bind = [&](const rg::Binding& binding) { bindings[bound++] = binding; };
    bind(ctx.storage(0, draws.frame));
    bind(ctx.storage(1, draws.particles));
    bind(ctx.storage(2, draws.keys));
    bind(ctx.sampled(3, lighting.scene_depth, nearest_));
    ParticleProgram program = scattering_program_;
    if (lighting.scattering) {
        bind(ctx.uniform(4, lighting.scattering->parameters));
        bind(ctx.sampled(5, lighting.scattering->accumulated, linear_, {.type = VK_IMAGE_VIEW_TYPE_2D_ARRAY}));
        bind(ctx.sampled(6, lighting.scattering->in_scattered, linear_));
    } else {
        program = direct_programs_[direct_index(lighting.sun_shadow.has_value(), lighting.lights.has_value())];
        if (lighting.sun_shadow) {
            bind(ctx.uniform(4, lighting.sun_shadow->parameters));
            bind(ctx.sampled(5, lighting.sun_shadow->cascades, nearest_, {.type = VK_IMAGE_VIEW_TYPE_2D_ARRAY}));
        }
        if (lighting.lights) {
            bind(ctx.storage(6, *lighting.lights));
        }
    }
    ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_GRAPHICS, program.pipeline);
    ctx.push(VK_PIPELINE_BIND_POINT_GRAPHICS, program.layout, 0, std::span(bindings).first(bound));
    ctx.vk().CmdDrawIndirect(ctx.cmd(), ctx.buffer(draws.commands), interval * command_bytes, 1,
                             static_cast<std::uint32_t>(command_bytes));
}

} // namespace tyndall::engine
