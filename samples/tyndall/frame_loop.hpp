// A scene, a renderer, an executor and what hooks into their frames: one object that makes pictures.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "engine/device.hpp"
#include "engine/image_io.hpp"
#include "engine/memory.hpp"
#include "engine/particles.hpp"
#include "engine/pipelines.hpp"
#include "engine/renderer.hpp"
#include "rendergraph/durations.hpp"
#include "rendergraph/executor.hpp"
#include "rendergraph/plan_cache.hpp"
#include "rendergraph/refine.hpp"
#include "samples/tyndall/stage_images.hpp"
#include "samples/tyndall/volumetrics_glue.hpp"

namespace tyndall::samples {

struct FrameLoopInfo {
    engine::RendererSettings renderer;
    std::optional<volumetrics::Fog> fog;
    std::vector<engine::ParticleEmitter> emitters;
    bool two_queues = false; ///< plan for graphics and async compute
    bool ask_for_async =
        true; ///< of two: the fog asks for async compute; else measured durations decide (with profile)
    bool profile = false;
    bool poison = false;         ///< rg::ExecutorInfo::poison_transients
    bool check_bindings = false; ///< rg::ExecutorInfo::check_bindings
};

/// What one frame is to leave behind.
struct FrameWishes {
    engine::Camera camera;
    VkExtent2D size = {1280, 720};
    double time_s = 0.0;
    bool cut = false;
    bool read_picture = false;  ///< 8-bit, tone mapped
    bool read_radiance = false; ///< scene colour as floats
    StageImages* stages = nullptr;
};

class FrameLoop {
public:
    [[nodiscard]] static tl::expected<std::unique_ptr<FrameLoop>, engine::Error>
    create(const engine::Device& device, engine::Scene scene, FrameLoopInfo info);

    /// Declares, compiles and submits a frame; with profile or something to read, waits for it.
    [[nodiscard]] tl::expected<void, engine::Error> run(const FrameWishes& wishes);
    [[nodiscard]] tl::expected<void, engine::Error> wait();

    /// Fog from the next frame on or not.
    void set_fog_enabled(bool enabled);

    // Of the newest frame.
    [[nodiscard]] const engine::Pixels<std::uint8_t>& picture() const { return picture_; }
    [[nodiscard]] const engine::Pixels<float>& radiance() const { return radiance_; }
    [[nodiscard]] const rg::GraphDesc& graph() const { return declared_.desc; }
    [[nodiscard]] const rg::Plan& plan() const { return *plan_; }
    [[nodiscard]] const std::vector<rg::PassTiming>& timings() const { return timings_; }
    /// "left out: what, because why", a line each, by renderer and fog.
    [[nodiscard]] std::string omissions() const;
    [[nodiscard]] const engine::Renderer& renderer() const { return *renderer_; }

private:
    explicit FrameLoop(const engine::Device& device) : device_(&device) {}
    [[nodiscard]] tl::expected<void, engine::Error> make(engine::Scene scene, FrameLoopInfo info);
    [[nodiscard]] tl::expected<void, engine::Error> declare_reads(rg::GraphBuilder& graph, rg::Blackboard& blackboard,
                                                                  const FrameWishes& wishes);
    [[nodiscard]] tl::expected<void, engine::Error> copy_to_host(rg::GraphBuilder& graph, const char* name,
                                                                 rg::Image image, engine::Buffer& buffer);
    void take_images(const FrameWishes& wishes);
    [[nodiscard]] tl::expected<void, engine::Error> make_plan();
    [[nodiscard]] tl::expected<void, engine::Error> prove_plan();

    const engine::Device* device_;
    std::optional<engine::PipelineCache> cache_;
    std::unique_ptr<engine::Renderer> renderer_;
    std::optional<engine::ParticleSystem> particles_;
    std::optional<VolumetricsGlue> glue_;
    rg::InjectionPoints points_{engine::Renderer::injection_points()};
    rg::QueueTopology topology_;
    bool profile_ = false;
    engine::Buffer picture_buffer_;
    engine::Buffer radiance_buffer_;
    std::vector<rg::ImportBinding> read_bindings_;
    rg::DeclaredGraph declared_;
    rg::PlanCache plans_;
    const rg::Plan* plan_ = nullptr; ///< of the newest frame
    std::future<tl::expected<rg::Refined, rg::Diagnostics>> refining_;
    std::uint64_t refined_hash_ = 0;  ///< Plan::passes_hash when the last search began
    std::uint64_t refined_frame_ = 0; ///< and the frame
    rg::Plan calibration_plan_;
    rg::GraphDesc proved_graph_; ///< of the last plan that was proved
    rg::Plan proved_plan_;       ///< empty before the first
    rg::Durations durations_;
    std::uint64_t frame_index_ = 0;
    std::uint64_t submitted_ = 0;
    std::vector<rg::PassTiming> timings_;
    engine::Pixels<std::uint8_t> picture_;
    engine::Pixels<float> radiance_;
    std::optional<rg::Executor> executor_; ///< last: waits for the frames in flight before anything else goes
};

} // namespace tyndall::samples
