#include "engine/particles.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <utility>

#include "spirv/particle_direct_s0_l00.h"
#include "spirv/particle_direct_s0_l10.h"
#include "spirv/particle_direct_s0_l11.h"
#include "spirv/particle_direct_s1_l00.h"
#include "spirv/particle_direct_s1_l10.h"
#include "spirv/particle_direct_s1_l11.h"
#include "spirv/particle_fragment_t0.h"
#include "spirv/particle_fragment_t1.h"
#include "spirv/particle_scattering_p0.h"
#include "spirv/particle_scattering_p1.h"

namespace tyndall::engine {
namespace {

/// Of the programs without a scattering volume: no local lights, lights without shadows, lights with shadows.
constexpr std::size_t light_kinds = 3;
constexpr std::size_t scattering_index = 2 * light_kinds; // and 1 more with shadows of lights that it leaves out
constexpr VkDeviceSize command_bytes = sizeof(VkDrawIndirectCommand);

/// Host-written before the frame is submitted, which makes it visible.
constexpr rg::ImportDesc written_by_host{.read_only = true};

/// Room for so many split depths, so that the buffer seldom grows.
constexpr VkDeviceSize split_bytes(std::size_t count) {
    return std::bit_ceil(std::max<std::size_t>(count, 16)) * sizeof(float);
}

/// Numbered as in particle.vert, particle_light.glsl and particle.frag.
std::vector<VkDescriptorSetLayoutBinding> bindings_of(std::size_t index) {
    constexpr VkShaderStageFlags vertex = VK_SHADER_STAGE_VERTEX_BIT;
    constexpr VkShaderStageFlags fragment = VK_SHADER_STAGE_FRAGMENT_BIT;
    constexpr VkDescriptorType storage_buffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    constexpr VkDescriptorType uniform_buffer = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    constexpr VkDescriptorType sampled_image = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    std::vector<VkDescriptorSetLayoutBinding> bindings{{0, storage_buffer, 1, vertex | fragment, nullptr},
                                                       {1, storage_buffer, 1, vertex, nullptr},
                                                       {2, storage_buffer, 1, vertex, nullptr},
                                                       {3, sampled_image, 1, fragment, nullptr}};
    const bool scattering = index >= scattering_index;
    const bool sun_shadow = !scattering && index / light_kinds == 1;
    const bool lights = !scattering && index % light_kinds >= 1;
    const bool local_shadows = scattering ? index > scattering_index : index % light_kinds == 2;
    if (scattering || sun_shadow) {
        bindings.push_back({4, uniform_buffer, 1, vertex, nullptr});
        bindings.push_back({5, sampled_image, 1, vertex, nullptr});
    }
    if (scattering) {
        bindings.push_back({6, sampled_image, 1, vertex, nullptr});
    } else if (lights) {
        bindings.push_back({6, storage_buffer, 1, vertex, nullptr});
    }
    if (local_shadows) {
        bindings.push_back({7, sampled_image, 1, vertex, nullptr});
        bindings.push_back({8, storage_buffer, 1, vertex, nullptr});
    }
    return bindings;
}

bool has_lights(const ParticleSurroundings& surroundings) {
    return surroundings.lights && surroundings.lights->lights.valid();
}

/// With a volume only of lights that it leaves out: what it holds is in shadow already.
bool asks_local_shadows(const ParticleSurroundings& surroundings) {
    return surroundings.local_shadows && (!surroundings.scattering || surroundings.scattering->airlight_features != 0);
}

/// Its place in ParticleSystem::programs_.
std::size_t program_for(const ParticleSurroundings& surroundings) {
    const bool local_shadows = asks_local_shadows(surroundings);
    const std::size_t sun_shadow = surroundings.sun_shadow ? 1 : 0;
    const std::size_t lights = local_shadows ? 2 : has_lights(surroundings) ? 1 : 0;
    return surroundings.scattering ? scattering_index + (local_shadows ? 1 : 0) : light_kinds * sun_shadow + lights;
}

ParticleFog fog_of(const ParticleSurroundings& surroundings) {
    return surroundings.scattering
               ? ParticleFog{surroundings.scattering->airlight_features, surroundings.scattering->colored}
               : ParticleFog{};
}

} // namespace

tl::expected<ParticleSystem, Error> ParticleSystem::create(const Device& device, VkPipelineCache cache,
                                                           std::vector<ParticleEmitter> emitters,
                                                           std::uint32_t frames_in_flight, VkFormat color_format,
                                                           VkFormat depth_format) {
    if (emitters.empty()) {
        return tl::unexpected(Error{"A particle system needs at least one emitter."});
    }
    for (const ParticleEmitter& emitter : emitters) {
        const std::string owner = "The particle emitter \"" + emitter.name + "\"";
        if (auto fits = check_blend(owner, emitter.blend, device.info().dual_source_blending); !fits) {
            return tl::unexpected(fits.error());
        }
    }
    auto passes = ParticlePasses::create(device, cache);
    if (!passes) {
        return tl::unexpected(passes.error());
    }
    ParticleSystem self(device, cache, std::move(emitters), std::move(*passes), color_format, depth_format);
    const auto made = self.make_layouts().and_then([&] { return self.make_samplers(); }).and_then([&] {
        return self.make_slots(frames_in_flight);
    });
    if (!made) {
        return tl::unexpected(made.error());
    }
    return self;
}

tl::expected<void, Error> ParticleSystem::make_layouts() {
    for (std::size_t i = 0; i < programs_.size(); ++i) {
        auto set = create_set_layout(*device_, bindings_of(i), true);
        if (!set) {
            return tl::unexpected(set.error());
        }
        const VkDescriptorSetLayout handle = set->get();
        auto layout = create_pipeline_layout(*device_, std::span(&handle, 1));
        if (!layout) {
            return tl::unexpected(layout.error());
        }
        programs_[i].set = std::move(*set);
        programs_[i].layout = std::move(*layout);
    }
    return {};
}

tl::expected<void, Error> ParticleSystem::make_pipeline(std::size_t program, const ParticleFog& fog) {
    Program& wanted = programs_[program];
    if (wanted.pipelines.contains(fog)) {
        return {};
    }
    const std::span<const std::uint32_t> vertex[] = {
        particle_direct_s0_l00, particle_direct_s0_l10, particle_direct_s0_l11, particle_direct_s1_l00,
        particle_direct_s1_l10, particle_direct_s1_l11, particle_scattering_p0, particle_scattering_p1};
    const std::array<SpecializationConstant, 2> constants = {{{0, fog.airlight_features}, {1, fog.colored ? 1U : 0U}}};
    const bool two_sources =
        std::ranges::any_of(emitters_, [](const ParticleEmitter& emitter) { return emitter.blend == Blend::multiply; });
    const std::span<const std::uint32_t> fragment[] = {particle_fragment_t0, particle_fragment_t1};
    const VkPipelineColorBlendAttachmentState blend = laid_over(two_sources);
    auto pipeline = create_graphics_pipeline(*device_, cache_,
                                             {.layout = wanted.layout.get(),
                                              .vertex_spirv = vertex[program],
                                              .fragment_spirv = fragment[two_sources ? 1 : 0],
                                              .constants = constants,
                                              .color_formats = std::span(&color_format_, 1),
                                              .depth_format = depth_format_,
                                              .blends = std::span(&blend, 1),
                                              .depth_test = true,
                                              .depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL});
    if (!pipeline) {
        return tl::unexpected(pipeline.error());
    }
    wanted.pipelines.emplace(fog, std::move(*pipeline));
    return {};
}

tl::expected<void, Error> ParticleSystem::make_samplers() {
    for (const auto& [sampler, filter] :
         {std::pair(&linear_, VK_FILTER_LINEAR), std::pair(&nearest_, VK_FILTER_NEAREST)}) {
        auto made = create_sampler(*device_, {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                              .magFilter = filter,
                                              .minFilter = filter,
                                              .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                              .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                              .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE});
        if (!made) {
            return tl::unexpected(made.error());
        }
        *sampler = std::move(*made);
    }
    return {};
}

tl::expected<void, Error> ParticleSystem::make_slots(std::uint32_t count) {
    const VkDeviceSize frame_bytes = sizeof(gpu::ParticleFrame) + emitters_.size() * sizeof(gpu::GpuEmitter);
    for (std::uint32_t i = 0; i < count; ++i) {
        auto frame = Buffer::create(*device_, frame_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, MemoryUse::upload);
        if (!frame) {
            return tl::unexpected(frame.error());
        }
        auto splits = Buffer::create(*device_, split_bytes(0), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, MemoryUse::upload);
        if (!splits) {
            return tl::unexpected(splits.error());
        }
        slots_.push_back({std::move(*frame), std::move(*splits)});
    }
    return {};
}

tl::expected<void, Error> ParticleSystem::write_host_data(const FrameView& view, const ParticleLight& light,
                                                          std::span<const float> split_depths_m) {
    Slot& slot = slots_[view.frame_slot];
    if (slot.splits.size_bytes() < split_depths_m.size_bytes()) {
        auto larger = Buffer::create(*device_, split_bytes(split_depths_m.size()), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                     MemoryUse::upload);
        if (!larger) {
            return tl::unexpected(larger.error());
        }
        slot.splits = std::move(*larger);
    }
    std::copy(split_depths_m.begin(), split_depths_m.end(), slot.splits.mapped_as<float>().begin());
    const gpu::ParticleFrame frame = make_particle_frame(view, light, emitters_);
    const std::vector<gpu::GpuEmitter> emitters = make_gpu_emitters(view, emitters_);
    const std::span<std::byte> mapped = slot.frame.mapped();
    std::memcpy(mapped.data(), &frame, sizeof frame);
    std::memcpy(mapped.data() + sizeof frame, emitters.data(), emitters.size() * sizeof(gpu::GpuEmitter));
    return {};
}

tl::expected<ParticleDraws, Error> ParticleSystem::declare(rg::GraphBuilder& graph, const FrameView& view,
                                                           const ParticleLight& light,
                                                           std::span<const float> split_depths_m) {
    if (auto written = write_host_data(view, light, split_depths_m); !written) {
        return tl::unexpected(written.error());
    }
    const Slot& slot = slots_[view.frame_slot];
    const auto split_count = static_cast<std::uint32_t>(split_depths_m.size());
    const std::uint32_t key_count = particle_key_count(count());
    const VkDeviceSize key_bytes = VkDeviceSize{key_count} * 2 * sizeof(std::uint32_t);
    ParticleDraws draws;
    draws.interval_count = split_count + 1;
    draws.frame = graph.import_buffer("particle emitters", {.size_bytes = slot.frame.size_bytes()}, written_by_host);
    const rg::Buffer splits =
        graph.import_buffer("particle split depths", {.size_bytes = slot.splits.size_bytes()}, written_by_host);
    graph.share_between_queues(draws.frame);
    graph.share_between_queues(splits);
    draws.particles = graph.create_buffer("particles", {.size_bytes = count() * sizeof(gpu::GpuParticle)});
    draws.keys = graph.create_buffer("particle keys", {.size_bytes = key_bytes});
    draws.commands = graph.create_buffer("particle draws", {.size_bytes = draws.interval_count * command_bytes});
    passes_.declare_simulation(graph, draws.frame, draws.particles, draws.keys, key_count);
    passes_.declare_sort(graph, draws.keys, key_count);
    passes_.declare_split(graph, draws.keys, splits, draws.commands, key_count, split_count);
    draws.imports[0] = {.resource = draws.frame.resource, .buffer = slot.frame.handle()};
    draws.imports[1] = {.resource = splits.resource, .buffer = slot.splits.handle()};
    return draws;
}

tl::expected<void, Error> ParticleSystem::add_reads(rg::PassBuilder& pass, const ParticleDraws& draws,
                                                    const ParticleSurroundings& surroundings) {
    pass.reads(draws.frame, rg::Access::storage_graphics)
        .reads(draws.particles, rg::Access::storage_graphics)
        .reads(draws.keys, rg::Access::storage_graphics)
        .reads(draws.commands, rg::Access::indirect_argument)
        .reads(surroundings.scene_depth, rg::Access::sampled_fragment);
    if (surroundings.scattering) {
        pass.reads(surroundings.scattering->parameters, rg::Access::uniform_graphics)
            .reads(surroundings.scattering->accumulated, rg::Access::sampled_graphics)
            .reads(surroundings.scattering->in_scattered, rg::Access::sampled_graphics);
    } else {
        if (surroundings.sun_shadow) {
            pass.reads(surroundings.sun_shadow->parameters, rg::Access::uniform_graphics)
                .reads(surroundings.sun_shadow->cascades, rg::Access::sampled_graphics);
        }
        if (has_lights(surroundings)) {
            pass.reads(surroundings.lights->lights, rg::Access::storage_graphics);
        }
    }
    if (asks_local_shadows(surroundings)) {
        pass.reads(surroundings.local_shadows->maps, rg::Access::sampled_graphics)
            .reads(surroundings.local_shadows->records, rg::Access::storage_graphics);
    }
    return make_pipeline(program_for(surroundings), fog_of(surroundings));
}

void ParticleSystem::draw(rg::PassContext& ctx, const ParticleDraws& draws, const ParticleSurroundings& surroundings,
                          std::uint32_t interval) const {
    std::array<rg::Binding, 9> bindings{};
    std::size_t count = 0;
    const auto bind = [&](const rg::Binding& binding) { bindings[count++] = binding; };
    bind(ctx.storage(0, draws.frame));
    bind(ctx.storage(1, draws.particles));
    bind(ctx.storage(2, draws.keys));
    bind(ctx.sampled(3, surroundings.scene_depth, nearest_.get()));
    const rg::ViewDesc array_view{.type = VK_IMAGE_VIEW_TYPE_2D_ARRAY};
    if (surroundings.scattering) {
        bind(ctx.uniform(4, surroundings.scattering->parameters));
        bind(ctx.sampled(5, surroundings.scattering->accumulated, linear_.get(), array_view));
        bind(ctx.sampled(6, surroundings.scattering->in_scattered, linear_.get()));
    } else {
        if (surroundings.sun_shadow) {
            bind(ctx.uniform(4, surroundings.sun_shadow->parameters));
            bind(ctx.sampled(5, surroundings.sun_shadow->cascades, nearest_.get(), array_view));
        }
        if (has_lights(surroundings)) {
            bind(ctx.storage(6, surroundings.lights->lights));
        }
    }
    if (asks_local_shadows(surroundings)) {
        bind(ctx.sampled(7, surroundings.local_shadows->maps, nearest_.get(), array_view));
        bind(ctx.storage(8, surroundings.local_shadows->records));
    }
    const Program& program = programs_[program_for(surroundings)];
    const Pipeline& pipeline = program.pipelines.at(fog_of(surroundings));
    ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
    ctx.push(VK_PIPELINE_BIND_POINT_GRAPHICS, program.layout.get(), 0, std::span(bindings).first(count),
             pipeline.bindings());
    ctx.vk().CmdDrawIndirect(ctx.cmd(), ctx.buffer(draws.commands), interval * command_bytes, 1,
                             static_cast<std::uint32_t>(command_bytes));
}

} // namespace tyndall::engine
