// Passes whose effect is known exactly, for tests of the executor.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/gpu/gpu_fixture.hpp"

namespace tyndall::test {

constexpr VkFormat rgba32f = VK_FORMAT_R32G32B32A32_SFLOAT;
using Texel = std::array<float, 4>;

[[nodiscard]] rg::ImageDesc image_of(std::uint32_t width, std::uint32_t height); ///< rgba32f

class ExecutorTest : public GpuTest {
protected:
    void SetUp() override;

    /// destination = source * scale + offset over `count` 32-bit numbers.
    rg::PassBuilder add_affine(rg::GraphBuilder& graph, std::string_view name, rg::Buffer source,
                               rg::Buffer& destination, std::uint32_t scale, std::uint32_t offset, std::uint32_t count);
    void add_fill(rg::GraphBuilder& graph, std::string_view name, rg::Buffer& buffer, std::uint32_t value);
    /// Texel (x, y) becomes (x, y, 0, 0) + base.
    void add_pattern(rg::GraphBuilder& graph, std::string_view name, rg::Image& image, VkExtent2D extent, Texel base);
    /// destination = source + increment; without the source where it is a history that is not valid.
    rg::PassBuilder add_accumulate(rg::GraphBuilder& graph, std::string_view name, rg::Image source,
                                   rg::Image& destination, VkExtent2D extent, float increment, bool is_history,
                                   const rg::ImageRange& source_range = {}, const rg::ImageUse& destination_use = {});
    /// target = 2 * source, drawn.
    void add_double(rg::GraphBuilder& graph, std::string_view name, rg::Image source, rg::Image& target);
    void add_copy(rg::GraphBuilder& graph, std::string_view name, rg::Image image, rg::Buffer& buffer,
                  VkExtent2D extent, std::uint32_t mip = 0, std::uint32_t layer = 0,
                  VkImageAspectFlags aspects = VK_IMAGE_ASPECT_COLOR_BIT);

    /// Imports a read-back buffer and adds its binding to `bindings_`.
    rg::Buffer import_read_back(rg::GraphBuilder& graph, std::string_view name, const HostBuffer& buffer);
    [[nodiscard]] HostBuffer read_back_buffer(VkDeviceSize bytes);
    /// Runs one frame with `bindings_`, which are then forgotten.
    void run_bound(const rg::DeclaredGraph& graph);

    TestPipeline affine_, pattern_, accumulate_, double_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    std::vector<rg::ImportBinding> bindings_;
};

} // namespace tyndall::test
