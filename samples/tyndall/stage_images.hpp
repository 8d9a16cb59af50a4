// Pictures of the volumetric passes' intermediates: copied out at the frame's end, tiled, and written as PNG.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "engine/memory.hpp"
#include "features/volumetrics/feature.hpp"
#include "rendergraph/graph.hpp"
#include "samples/stability/bounds.hpp"

namespace tyndall::samples {

class StageImages {
public:
    explicit StageImages(const engine::Device& device) : device_(&device) {}

    /// Declares a copy of each intermediate that the frame has. Call once in the frame to be captured, when all are
    /// made.
    [[nodiscard]] tl::expected<void, engine::Error> declare(rg::GraphBuilder& graph,
                                                            const volumetrics::Feature& feature,
                                                            const volumetrics::Settings& settings,
                                                            std::uint32_t light_count);
    [[nodiscard]] const std::vector<rg::ImportBinding>& bindings() const { return bindings_; }

    /// After that frame has finished: one PNG a stage, slices from near to far in reading order. Returns the files.
    [[nodiscard]] tl::expected<std::vector<std::filesystem::path>, engine::Error>
    write(const std::filesystem::path& folder) const;

    /// Likewise: what the images hold, cluster masks left out.
    [[nodiscard]] std::vector<StageValues> values() const;

private:
    enum class Kind : std::uint8_t { esm, density, radiance, accumulated, clusters };
    struct Capture {
        std::string name;
        Kind kind = Kind::radiance;
        rg::ImageDesc image;
        std::uint32_t slices = 1;
        engine::Buffer buffer;
        std::uint32_t width = 1;
        std::uint32_t height = 1;
        std::uint32_t words = 1; ///< clusters: of a mask
        float esm_exponent = 1.0F;
        bool colored = false; ///< the second half of the slices holds what each channel has of its own
    };
    /// Where the picture lands: memory of the capture, imported into the graph.
    [[nodiscard]] tl::expected<rg::Buffer, engine::Error> host_buffer(rg::GraphBuilder& graph, Capture& capture,
                                                                      VkDeviceSize bytes);
    [[nodiscard]] tl::expected<void, engine::Error> capture_image(rg::GraphBuilder& graph, Capture capture,
                                                                  rg::Image image);
    [[nodiscard]] tl::expected<void, engine::Error> capture_masks(rg::GraphBuilder& graph, Capture capture,
                                                                  rg::Buffer masks);

    const engine::Device* device_;
    std::vector<Capture> captures_;
    std::vector<rg::ImportBinding> bindings_;
};

} // namespace tyndall::samples
