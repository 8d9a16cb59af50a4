// Renders frames without a window: several in flight, pictures copied to the host.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "engine/image_io.hpp"
#include "engine/memory.hpp"
#include "engine/renderer.hpp"
#include "rendergraph/compile.hpp"
#include "rendergraph/executor.hpp"

namespace tyndall::engine {

struct HeadlessSettings {
    std::uint32_t frames_in_flight = 2; ///< 1 to 4
    bool profile = false;               ///< timestamps per pass
    /// Compile for these logical queues, folded onto the device's; absent: the device's own.
    std::optional<rg::QueueTopology> topology;
    rg::CompileOptions compile;
};

/// What of a frame the host wants to see.
struct ReadBack {
    bool picture = false;  ///< tone mapped, sRGB, 8 bits
    bool radiance = false; ///< scene radiance after transparents, cd/m^2
};

/// A frame as it was declared and planned, for reports.
struct DeclaredFrame {
    rg::GraphDesc graph;
    rg::Plan plan;
    std::uint64_t number = 0; ///< what rg::Executor::submit returned
};

class Headless {
public:
    [[nodiscard]] static tl::expected<std::unique_ptr<Headless>, Error> create(const Device& device,
                                                                               HeadlessSettings settings);
    Headless(const Headless&) = delete;
    Headless& operator=(const Headless&) = delete;
    ~Headless();

    /// Waits until a slot is free, declares a frame, compiles and submits it. `request.frame_slot` is filled in here.
    /// `before_declare`, if given, is told the completed request before anything is declared: features write their
    /// host data then.
    [[nodiscard]] tl::expected<void, Error> submit(Renderer& renderer, const rg::InjectionPoints& points,
                                                   FrameRequest request, const ReadBack& read_back = {},
                                                   const std::function<void(const FrameRequest&)>& before_declare = {});

    /// Called with every plan before it runs; an error stops the frame. For checkers.
    void set_plan_check(std::function<tl::expected<void, Error>(const rg::GraphDesc&, const rg::Plan&)> check) {
        plan_check_ = std::move(check);
    }

    /// Waits for the frame submitted last and copies what it was asked to read back. RGBA.
    [[nodiscard]] tl::expected<Pixels<std::uint8_t>, Error> picture();
    [[nodiscard]] tl::expected<Pixels<float>, Error> radiance();

    [[nodiscard]] const DeclaredFrame& last() const { return last_; }
    [[nodiscard]] rg::Executor& executor() { return *executor_; }
    [[nodiscard]] tl::expected<void, Error> wait_idle();

private:
    /// A mapped buffer that a frame's image is copied to.
    struct HostCopy {
        Buffer buffer;
        VkFormat format = VK_FORMAT_UNDEFINED; ///< of the texels in it
        VkExtent2D size = {};
    };
    struct Slot {
        HostCopy picture;
        HostCopy radiance;
    };

    Headless(const Device& device, HeadlessSettings settings) : device_(&device), settings_(std::move(settings)) {}
    [[nodiscard]] tl::expected<rg::ImportBinding, Error> declare_copy(rg::GraphBuilder& graph, const char* name,
                                                                      rg::Image image, HostCopy& into) const;
    [[nodiscard]] tl::expected<std::span<const std::byte>, Error> wait_and_map(const HostCopy& copy, const char* what);

    const Device* device_;
    HeadlessSettings settings_;
    std::optional<rg::Executor> executor_;
    std::vector<Slot> slots_;
    std::uint32_t last_slot_ = 0;
    DeclaredFrame last_;
    std::function<tl::expected<void, Error>(const rg::GraphDesc&, const rg::Plan&)> plan_check_;
};

} // namespace tyndall::engine
