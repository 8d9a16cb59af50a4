// Particles of fog: their buffers, and the pass that finds which froxels they reach.
#include "features/volumetrics/dispatch.hpp"
#include "features/volumetrics/feature_state.hpp"

namespace tyndall::volumetrics {

tl::expected<void, Error> Feature::State::make_particle_buffers() {
    if (particle_buffers) {
        return {};
    }
    const FeatureInfo& info = shared.info;
    auto made = HostBuffers::create(
        *info.vk, info.device, info.memory_properties, info.frames_in_flight, info.queue_families,
        {.size_bytes = sizeof(gpu::GpuFogParticle) * FogParticle::most, .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
    if (!made) {
        return tl::unexpected(made.error());
    }
    particle_buffers = std::move(*made);
    return {};
}

void Feature::State::declare_particles(rg::GraphBuilder& graph) {
    if (frame->particles.empty()) {
        omit("fog particles", "there is none");
        return;
    }
    const gpu::LightClusters& c = frame->particle_clusters;
    const std::uint32_t words_of_slab = c.counts.x * c.counts.y * c.block.w;
    const HostBuffers::Slot& slot = particle_buffers->slot(frame->inputs.frame_slot);
    const auto import_written = [&](const char* name, VkDeviceSize size_bytes, VkBuffer buffer) {
        const rg::Buffer handle = graph.import_buffer(named(name), {.size_bytes = size_bytes}, {.read_only = true});
        graph.share_between_queues(handle);
        import_bindings.push_back({.resource = handle.resource, .buffer = buffer});
        return handle;
    };
    const rg::Buffer particles =
        import_written("fog particles", sizeof(gpu::GpuFogParticle) * FogParticle::most, slot.data);
    const rg::Buffer parameters =
        import_written("fog particle cluster parameters", sizeof(gpu::LightClusters), slot.clusters);
    rg::Buffer masks = graph.create_buffer(named("fog particle cluster masks"),
                                           {.size_bytes = VkDeviceSize{words_of_slab} * c.counts.z * 4});
    auto pass = graph.add_pass(named("fog particle clustering"), rg::PassKind::compute);
    pass.on_queue(wish())
        .reads(frame->parameter_buffer, rg::Access::uniform_compute)
        .reads(parameters, rg::Access::uniform_compute)
        .reads(particles, rg::Access::storage_compute)
        .writes(masks, rg::Access::storage_compute);
    pass.executes([=, dispatch = covering(frame->particle_clustering, {64, 1, 1}, words_of_slab, c.counts.z, 1),
                   volume = frame->parameter_buffer](rg::PassContext& ctx) {
        run(ctx, dispatch,
            std::array{ctx.uniform(0, volume), ctx.uniform(1, parameters), ctx.storage(2, particles),
                       ctx.storage(3, masks)});
    });
    frame->particle_buffer = particles;
    frame->particle_masks = masks;
    frame->particle_cluster_parameters = parameters;
}

} // namespace tyndall::volumetrics
