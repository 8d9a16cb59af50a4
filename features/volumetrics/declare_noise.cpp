// The passes that make the noise volumes, in the first frame that needs them.
#include <array>
#include <string>

#include "features/volumetrics/dispatch.hpp"
#include "features/volumetrics/feature_state.hpp"

namespace tyndall::volumetrics {
namespace {

struct NoiseVolume {
    const char* name;
    std::uint32_t size; ///< texels of a side
};
constexpr std::array<NoiseVolume, 2> volumes{NoiseVolume{"noise shape", 128}, NoiseVolume{"noise detail", 32}};

} // namespace

tl::expected<void, Error> Feature::Shared::make_noise() {
    for (std::size_t i = 0; i < volumes.size(); ++i) {
        if (noise[i]) {
            continue;
        }
        const std::uint32_t size = volumes[i].size;
        auto image = PersistentImage::create(*info.vk, info.device, info.memory_properties, info.queue_families,
                                             VK_FORMAT_R16_SFLOAT, {size, size, size});
        auto program = pipelines.compute(noise_bake_shader(), row_group(size / 2), std::array{size, i == 1 ? 1U : 0U});
        if (!image || !program) {
            return tl::unexpected(image ? program.error() : image.error());
        }
        noise_bake[i] = *program;
        noise[i] = std::move(*image);
    }
    return {};
}

void Feature::State::declare_noise(rg::GraphBuilder& graph) {
    bool bakes = false;
    for (std::size_t i = 0; i < volumes.size(); ++i) {
        PersistentImage& image = *shared.noise[i];
        rg::Image& handle = frame->noise[i];
        handle = image.in_graph(graph, volumes[i].name, import_bindings);
        if (!image.wants_filling()) {
            continue;
        }
        bakes = true;
        const std::uint32_t size = volumes[i].size;
        const std::string name = volumes[i].name;
        rg::Buffer texels = graph.create_buffer(name + ", baked", {.size_bytes = VkDeviceSize{2} * size * size * size});
        auto bake = graph.add_pass(name + " bake", rg::PassKind::compute);
        bake.on_queue(wish()).writes(texels, rg::Access::storage_compute);
        bake.executes([=, dispatch = covering(shared.noise_bake[i], row_group(size / 2), size / 2, size, size)](
                          rg::PassContext& ctx) { run(ctx, dispatch, std::array{ctx.storage(0, texels)}); });
        frame->stages.baked_noise[i] = texels;
        handle = image.fill(graph, name + " copy", texels);
    }
    if (!bakes) {
        omit("noise bake", "an earlier frame has baked its volumes");
    }
}

} // namespace tyndall::volumetrics
