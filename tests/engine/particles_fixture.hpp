// The engine's device and an executor on it. TYNDALL_TEST_MODE as in tests/gpu/gpu_fixture.hpp.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <span>

#include "engine/frame.hpp"
#include "engine/memory.hpp"
#include "tests/engine/device_fixture.hpp"
#include "tests/gpu/gpu_fixture.hpp"

namespace tyndall::test {

class ParticleFrameTest : public engine::DeviceTest {
protected:
    void SetUp() override;
    void TearDown() override;

    /// Compiles and executes one frame to its end; any error fails the test.
    void run(const rg::DeclaredGraph& graph, std::span<const rg::ImportBinding> imports);

    /// A mapped storage buffer; lives as long as the test.
    [[nodiscard]] engine::Buffer& host_buffer(VkDeviceSize size_bytes);
    template <typename T>
    [[nodiscard]] engine::Buffer& upload(std::span<const T> values) {
        engine::Buffer& buffer = host_buffer(std::max<std::size_t>(values.size_bytes(), 16));
        std::ranges::copy(std::as_bytes(values), buffer.mapped().begin());
        return buffer;
    }

private:
    void record_and_wait(const rg::DeclaredGraph& graph, const rg::Plan& plan,
                         std::span<const rg::ImportBinding> imports);

    std::optional<rg::Executor> executor_;
    std::deque<engine::Buffer> buffers_;
};

/// Looks along -Z of the world from `origin_m`, with tan(half angle) = `slope` up and sideways.
[[nodiscard]] engine::FrameView square_view(const glm::dvec3& origin_m, double time_s, double slope,
                                            std::uint32_t size);

} // namespace tyndall::test
