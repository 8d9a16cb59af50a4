#include "samples/tyndall/frame_loop.hpp"

#include <algorithm>
#include <array>
#include <span>

#include <glm/gtc/packing.hpp>

#include "rendergraph/compile.hpp"
#include "rendergraph/verify.hpp"

namespace tyndall::samples {
namespace {

using Result = tl::expected<void, engine::Error>;

constexpr std::uint32_t frames_in_flight = 2;
/// Where measured durations decide: frames on one queue, and searches for a better plan.
constexpr std::uint32_t frames_between_calibrations = 32;
constexpr std::uint64_t frames_between_searches = 32;

const rg::ImportDesc read_by_host = {
    .has_final = true, .final_stages = VK_PIPELINE_STAGE_2_HOST_BIT, .final_access = VK_ACCESS_2_HOST_READ_BIT};

/// Logical queues: the device's own where it has async compute, else two that fold onto the one there is.
rg::QueueTopology topology_for(const rg::Executor& executor, bool two_queues) {
    rg::QueueTopology topology;
    const std::vector<rg::QueueInfo> real = executor.topology().queues;
    topology.queues = {real.front()};
    if (two_queues) {
        const auto compute = std::find_if(
            real.begin(), real.end(), [](const rg::QueueInfo& queue) { return queue.kind == rg::QueueKind::compute; });
        topology.queues.push_back(compute != real.end() ? *compute
                                                        : rg::QueueInfo{rg::QueueKind::compute, real.front().family});
    }
    return topology;
}

} // namespace

tl::expected<std::unique_ptr<FrameLoop>, engine::Error> FrameLoop::create(const engine::Device& device,
                                                                          engine::Scene scene, FrameLoopInfo info) {
    std::unique_ptr<FrameLoop> loop(new FrameLoop(device));
    if (Result made = loop->make(std::move(scene), std::move(info)); !made) {
        return tl::unexpected(made.error());
    }
    return loop;
}

Result FrameLoop::make(engine::Scene scene, FrameLoopInfo info) {
    profile_ = info.profile;
    auto cache = engine::PipelineCache::create(*device_);
    if (!cache) {
        return tl::unexpected(cache.error());
    }
    cache_.emplace(std::move(*cache));
    auto renderer =
        engine::Renderer::create(*device_, cache_->handle(), std::move(scene), info.renderer, frames_in_flight);
    if (!renderer) {
        return tl::unexpected(renderer.error());
    }
    renderer_ = std::move(*renderer);
    if (!info.emitters.empty()) {
        auto particles =
            engine::ParticleSystem::create(*device_, cache_->handle(), std::move(info.emitters), frames_in_flight,
                                           info.renderer.color_format, VK_FORMAT_D32_SFLOAT);
        if (!particles) {
            return tl::unexpected(particles.error());
        }
        particles_.emplace(std::move(*particles));
        renderer_->set_particles(&*particles_);
    }
    if (info.fog) {
        info.fog->settings.async_compute = info.two_queues && info.ask_for_async;
        auto glue = VolumetricsGlue::create(*device_, cache_->handle(), frames_in_flight, info.renderer.color_format,
                                            *info.fog, info.check_bindings);
        if (!glue) {
            return tl::unexpected(glue.error());
        }
        glue_.emplace(std::move(*glue));
        if (Result attached = glue_->attach(points_); !attached) {
            return attached;
        }
    }
    rg::ExecutorInfo executor_info = device_->executor_info(profile_);
    executor_info.frames_in_flight = frames_in_flight;
    executor_info.poison_transients = info.poison;
    executor_info.check_bindings = info.check_bindings;
    auto executor = rg::Executor::create(std::move(executor_info));
    if (!executor) {
        return tl::unexpected(engine::Error{executor.error().message});
    }
    executor_.emplace(std::move(*executor));
    topology_ = topology_for(*executor_, info.two_queues);
    if (info.two_queues && !info.ask_for_async && profile_) {
        durations_ = rg::Durations({.calibrate_every = frames_between_calibrations});
    }
    return {};
}

void FrameLoop::set_fog_enabled(bool enabled) {
    if (glue_) {
        glue_->set_enabled(enabled);
    }
}

Result FrameLoop::copy_to_host(rg::GraphBuilder& graph, const char* name, rg::Image image, engine::Buffer& buffer) {
    const rg::ImageDesc desc = *graph.describe(image);
    const VkDeviceSize bytes =
        VkDeviceSize{desc.extent.width} * desc.extent.height * rg::format_texel_bytes(desc.format);
    if (buffer.size_bytes() < bytes) {
        auto made =
            engine::Buffer::create(*device_, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, engine::MemoryUse::readback);
        if (!made) {
            return tl::unexpected(made.error());
        }
        buffer = std::move(*made);
    }
    rg::Buffer out = graph.import_buffer(std::string(name) + " for the host", {.size_bytes = bytes}, read_by_host);
    read_bindings_.push_back({.resource = out.resource, .buffer = buffer.handle()});
    graph.add_pass(std::string("read back ") + name, rg::PassKind::transfer)
        .reads(image, rg::Access::transfer_source)
        .writes(out, rg::Access::transfer_destination)
        .executes([=](rg::PassContext& ctx) {
            const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                            .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                            .imageExtent = desc.extent};
            const VkCopyImageToBufferInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                                .srcImage = ctx.image(image),
                                                .srcImageLayout = ctx.layout(image),
                                                .dstBuffer = ctx.buffer(out),
                                                .regionCount = 1,
                                                .pRegions = &region};
            ctx.vk().CmdCopyImageToBuffer2(ctx.cmd(), &copy);
        });
    return {};
}

Result FrameLoop::declare_reads(rg::GraphBuilder& graph, rg::Blackboard& blackboard, const FrameWishes& wishes) {
    // The picture is read in every frame: without a reader the graph would rightly cull all of it.
    if (Result read = copy_to_host(graph, "picture", blackboard.find<engine::FrameOutput>()->picture, picture_buffer_);
        !read) {
        return read;
    }
    if (wishes.read_radiance) {
        if (Result read =
                copy_to_host(graph, "radiance", blackboard.find<engine::SceneImages>()->color, radiance_buffer_);
            !read) {
            return read;
        }
    }
    if (wishes.stages != nullptr && glue_) {
        const engine::SceneLights* lights = blackboard.find<engine::SceneLights>();
        const auto light_count = static_cast<std::uint32_t>(lights->records.size());
        if (Result declared = wishes.stages->declare(graph, glue_->feature(), glue_->fog().settings, light_count);
            !declared) {
            return declared;
        }
        add_imports(blackboard, wishes.stages->bindings());
    }
    return {};
}

/// The plan of this frame. A better one is looked for while the frame runs and taken over by the next, so that the same
/// frames get the same plans however fast the search was.
Result FrameLoop::make_plan() {
    if (refining_.valid()) {
        if (auto refined = refining_.get()) {
            plans_.prefer(std::move(refined->plan));
        }
    }
    const rg::MemoryRequirements memory = executor_->memory_requirements(declared_.desc);
    const rg::Costs costs = durations_.costs(declared_.desc);
    const auto failed = [](const rg::Diagnostics& mistakes) {
        return tl::unexpected(engine::Error{"The frame does not compile: " + rg::to_text(mistakes)});
    };
    const std::uint64_t compiled = plans_.compiled();
    const rg::Plan* before = plan_;
    if (durations_.calibration_due()) {
        auto alone = rg::compile(declared_.desc, topology_, memory, {.async = false}, costs);
        if (!alone) {
            return failed(alone.error());
        }
        calibration_plan_ = std::move(*alone);
        plan_ = &calibration_plan_;
    } else {
        auto plan = plans_.compile(declared_.desc, topology_, memory, {}, costs);
        if (!plan) {
            return failed(plan.error());
        }
        plan_ = *plan;
        const bool made = plans_.compiled() != compiled;
        if (!made && plan_ == before) {
            return {};
        }
        if (made && (plan_->passes_hash != refined_hash_ || frame_index_ - refined_frame_ >= frames_between_searches)) {
            refined_hash_ = plan_->passes_hash;
            refined_frame_ = frame_index_;
            refining_ = std::async(std::launch::async,
                                   [graph = declared_.desc, queues = topology_, memory, costs, before = *plan_] {
                                       return rg::refine(graph, queues, memory, {}, costs, &before);
                                   });
        }
    }
    return prove_plan();
}

/// Every new plan, in every build: the proof takes a fraction of a millisecond. First the frames after which it comes,
/// whose histories and memory it takes over.
Result FrameLoop::prove_plan() {
    const rg::PlannedFrame before{&proved_graph_, &proved_plan_};
    const rg::PlannedFrame now{&declared_.desc, plan_};
    const std::array<rg::PlannedFrame, 5> frames = {before, before, now, now, now};
    const std::size_t skipped = proved_plan_.passes.empty() ? 2 : 0;
    if (const std::vector<rg::Violation> violations = rg::verify_sequence(std::span(frames).subspan(skipped));
        !violations.empty()) {
        return tl::unexpected(engine::Error{"The plan is not free of races: " + violations.front().message});
    }
    proved_graph_ = declared_.desc;
    proved_plan_ = *plan_;
    return {};
}

Result FrameLoop::run(const FrameWishes& wishes) {
    if (auto ready = executor_->wait_for_slot(); !ready) {
        return tl::unexpected(engine::Error{ready.error().message});
    }
    rg::GraphBuilder graph;
    rg::Blackboard blackboard;
    read_bindings_.clear();
    Result reads;
    const engine::FrameRequest request{.camera = wishes.camera,
                                       .size = wishes.size,
                                       .time_s = wishes.time_s,
                                       .frame_index = frame_index_,
                                       .frame_slot = executor_->next_slot(),
                                       .cut = wishes.cut || frame_index_ == 0};
    Result declared =
        renderer_->declare(graph, blackboard, points_, request,
                           [&](rg::GraphBuilder& g, rg::Blackboard& b) { reads = declare_reads(g, b, wishes); });
    if (!declared) {
        return declared;
    }
    if (!reads) {
        return reads;
    }
    if (glue_ && glue_->error()) {
        return tl::unexpected(*glue_->error());
    }
    declared_ = graph.finish();
    if (Result planned = make_plan(); !planned) {
        return planned;
    }
    std::vector<rg::ImportBinding> bindings(renderer_->bindings().begin(), renderer_->bindings().end());
    bindings.insert(bindings.end(), read_bindings_.begin(), read_bindings_.end());
    if (const engine::FeatureImports* imports = blackboard.find<engine::FeatureImports>()) {
        bindings.insert(bindings.end(), imports->bindings.begin(), imports->bindings.end());
    }
    auto submitted = executor_->submit(declared_.desc, *plan_, declared_.callbacks, bindings);
    if (!submitted) {
        renderer_->forget_cached_frames();
        return tl::unexpected(engine::Error{submitted.error().message});
    }
    submitted_ = *submitted;
    ++frame_index_;
    if (profile_ || wishes.read_picture || wishes.read_radiance || wishes.stages != nullptr) {
        if (Result waited = wait(); !waited) {
            return waited;
        }
        timings_ = executor_->timings();
        durations_.add_frame(declared_.desc, *plan_, timings_);
        take_images(wishes);
    }
    return {};
}

Result FrameLoop::wait() {
    if (auto waited = executor_->wait(submitted_); !waited) {
        return tl::unexpected(engine::Error{waited.error().message});
    }
    return {};
}

void FrameLoop::take_images(const FrameWishes& wishes) {
    const std::size_t pixels = std::size_t{wishes.size.width} * wishes.size.height;
    if (wishes.read_picture) {
        picture_ = {wishes.size.width, wishes.size.height, 3, {}};
        picture_.values.reserve(pixels * 3);
        const auto rgba = picture_buffer_.mapped_as<std::uint8_t>();
        for (std::size_t i = 0; i < pixels; ++i) {
            picture_.values.insert(picture_.values.end(), {rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]});
        }
    }
    if (wishes.read_radiance) {
        radiance_ = {wishes.size.width, wishes.size.height, 3, {}};
        radiance_.values.reserve(pixels * 3);
        const bool half = renderer_->settings().color_format == VK_FORMAT_R16G16B16A16_SFLOAT;
        for (std::size_t i = 0; i < pixels; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                radiance_.values.push_back(
                    half ? glm::unpackHalf1x16(radiance_buffer_.mapped_as<std::uint16_t>()[4 * i + c])
                         : radiance_buffer_.mapped_as<float>()[4 * i + c]);
            }
        }
    }
}

std::string FrameLoop::omissions() const {
    std::string text;
    for (const engine::Omission& omission : renderer_->omissions()) {
        text += "left out: " + omission.what + ", " + omission.why + "\n";
    }
    if (glue_) {
        for (const volumetrics::Omission& omission : glue_->feature().omissions()) {
            text += "left out: " + omission.what + ", " + omission.why + "\n";
        }
    }
    return text;
}

} // namespace tyndall::samples
