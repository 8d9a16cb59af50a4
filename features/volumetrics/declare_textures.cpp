// The map over the ground and the grids of local volumes, given by the host, as images of the frame.
#include <algorithm>
#include <string>

#include "features/volumetrics/feature_state.hpp"

namespace tyndall::volumetrics {

std::size_t Feature::Shared::density_of(const std::shared_ptr<const DensityTexels>& texels) const {
    const auto known =
        std::find_if(densities.begin(), densities.end(), [&](const auto& image) { return image->texels() == texels; });
    return static_cast<std::size_t>(known - densities.begin());
}

tl::expected<void, Error> Feature::Shared::make_density(const std::shared_ptr<const DensityTexels>& texels) {
    if (!texels || density_of(texels) < densities.size()) {
        return {};
    }
    auto made = DensityImage::create(*info.vk, info.device, info.memory_properties, info.queue_families, texels);
    if (!made) {
        return tl::unexpected(made.error());
    }
    densities.push_back(std::move(*made));
    return {};
}

tl::expected<void, Error> Feature::State::make_textures() {
    for (const auto& texels : grids_of(frame->inputs.medium)) {
        if (auto made = shared.make_density(texels); !made) {
            return made;
        }
    }
    return shared.make_density(frame->inputs.medium.map.texels);
}

void Feature::State::declare_textures(rg::GraphBuilder& graph) {
    const Medium& medium = frame->inputs.medium;
    const auto declare = [&](const std::shared_ptr<const DensityTexels>& texels) {
        const std::size_t index = shared.density_of(texels);
        return shared.densities[index]->in_graph(graph, "densities " + std::to_string(index), import_bindings);
    };
    if (medium.map.texels) {
        frame->density_map = declare(medium.map.texels);
    } else {
        omit("density map", "there is none");
    }
    const auto grids = grids_of(medium);
    std::transform(grids.begin(), grids.end(), frame->grids.begin(), declare);
    if (grids.empty()) {
        omit("density grids", "no local volume has one");
    }
}

} // namespace tyndall::volumetrics
