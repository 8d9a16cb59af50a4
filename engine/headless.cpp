#include "engine/headless.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include <glm/gtc/packing.hpp>

namespace tyndall::engine {
namespace {

constexpr rg::ImportDesc read_by_host{
    .has_final = true, .final_stages = VK_PIPELINE_STAGE_2_HOST_BIT, .final_access = VK_ACCESS_2_HOST_READ_BIT};

Error from(const rg::ExecuteError& error) {
    return {error.message};
}

} // namespace

tl::expected<std::unique_ptr<Headless>, Error> Headless::create(const Device& device, HeadlessSettings settings) {
    std::unique_ptr<Headless> headless(new Headless(device, std::move(settings)));
    rg::ExecutorInfo info = device.executor_info(headless->settings_.profile);
    info.frames_in_flight = headless->settings_.frames_in_flight;
    auto executor = rg::Executor::create(std::move(info));
    if (!executor) {
        return tl::unexpected(from(executor.error()));
    }
    headless->executor_.emplace(std::move(*executor));
    headless->slots_.resize(headless->settings_.frames_in_flight);
    return headless;
}

Headless::~Headless() = default;

tl::expected<rg::ImportBinding, Error> Headless::declare_copy(rg::GraphBuilder& graph, const char* name,
                                                              rg::Image image, HostCopy& into) const {
    const rg::ImageDesc* desc = graph.describe(image);
    const VkDeviceSize size_bytes =
        VkDeviceSize{desc->extent.width} * desc->extent.height * rg::format_texel_bytes(desc->format);
    into.format = desc->format;
    into.size = {desc->extent.width, desc->extent.height};
    if (into.buffer.size_bytes() < size_bytes) {
        auto made = Buffer::create(*device_, size_bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::readback);
        if (!made) {
            return tl::unexpected(made.error());
        }
        into.buffer = std::move(*made);
    }
    rg::Buffer target = graph.import_buffer(name, {.size_bytes = into.buffer.size_bytes()}, read_by_host);
    rg::PassBuilder pass = graph.add_pass(std::string("copy of ") + name, rg::PassKind::transfer);
    pass.reads(image, rg::Access::transfer_source).writes(target, rg::Access::transfer_destination);
    pass.executes([=, extent = desc->extent](rg::PassContext& ctx) {
        const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                        .imageExtent = extent};
        const VkCopyImageToBufferInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                            .srcImage = ctx.image(image),
                                            .srcImageLayout = ctx.layout(image),
                                            .dstBuffer = ctx.buffer(target),
                                            .regionCount = 1,
                                            .pRegions = &region};
        ctx.vk().CmdCopyImageToBuffer2(ctx.cmd(), &copy);
    });
    return rg::ImportBinding{.resource = target.resource, .buffer = into.buffer.handle()};
}

tl::expected<void, Error> Headless::submit(Renderer& renderer, const rg::InjectionPoints& points, FrameRequest request,
                                           const ReadBack& read_back,
                                           const std::function<void(const FrameRequest&)>& before_declare) {
    if (auto waited = executor_->wait_for_slot(); !waited) {
        return tl::unexpected(from(waited.error()));
    }
    request.frame_slot = executor_->next_slot();
    if (before_declare) {
        before_declare(request);
    }
    Slot& slot = slots_[request.frame_slot];
    slot.picture.format = slot.radiance.format = VK_FORMAT_UNDEFINED;
    std::vector<rg::ImportBinding> copies;
    std::optional<Error> failure;
    const auto copy = [&](rg::GraphBuilder& graph, const char* name, rg::Image image, HostCopy& into) {
        const auto binding = declare_copy(graph, name, image, into);
        if (binding) {
            copies.push_back(*binding);
        } else {
            failure = binding.error();
        }
    };
    rg::GraphBuilder graph;
    rg::Blackboard blackboard;
    const auto declared =
        renderer.declare(graph, blackboard, points, request, [&](rg::GraphBuilder& g, rg::Blackboard& b) {
            if (read_back.picture) {
                copy(g, "picture on the host", b.find<FrameOutput>()->picture, slot.picture);
            }
            if (read_back.radiance) {
                copy(g, "radiance on the host", b.find<SceneImages>()->color, slot.radiance);
            }
        });
    if (!declared && !failure) {
        failure = declared.error();
    }
    rg::DeclaredGraph frame = graph.finish();
    if (!failure) {
        auto plan = rg::compile(frame.desc, settings_.topology.value_or(executor_->topology()),
                                executor_->memory_requirements(frame.desc), settings_.compile);
        if (!plan) {
            failure = Error{"The frame's graph is not valid: " + rg::to_text(plan.error())};
        } else {
            last_.plan = std::move(*plan);
        }
    }
    if (!failure && plan_check_) {
        if (auto checked = plan_check_(frame.desc, last_.plan); !checked) {
            failure = checked.error();
        }
    }
    if (!failure) {
        const std::span<const rg::ImportBinding> bindings = renderer.bindings();
        copies.insert(copies.end(), bindings.begin(), bindings.end());
        const auto number = executor_->submit(frame.desc, last_.plan, frame.callbacks, copies);
        if (!number) {
            failure = from(number.error());
        } else {
            last_.number = *number;
        }
    }
    last_slot_ = request.frame_slot;
    last_.graph = std::move(frame.desc);
    if (failure) {
        renderer.forget_cached_frames();
        return tl::unexpected(*failure);
    }
    return {};
}

tl::expected<std::span<const std::byte>, Error> Headless::wait_and_map(const HostCopy& copy, const char* what) {
    if (copy.format == VK_FORMAT_UNDEFINED) {
        return tl::unexpected(Error{std::string("The last frame was not asked to read back its ") + what + "."});
    }
    if (auto waited = executor_->wait(last_.number); !waited) {
        return tl::unexpected(from(waited.error()));
    }
    return copy.buffer.mapped();
}

tl::expected<Pixels<std::uint8_t>, Error> Headless::picture() {
    const HostCopy& copy = slots_[last_slot_].picture;
    const auto bytes = wait_and_map(copy, "picture");
    if (!bytes) {
        return tl::unexpected(bytes.error());
    }
    Pixels<std::uint8_t> out{.width = copy.size.width, .height = copy.size.height, .channels = 4};
    out.values.resize(std::size_t{4} * out.width * out.height);
    std::memcpy(out.values.data(), bytes->data(), out.values.size());
    return out;
}

tl::expected<Pixels<float>, Error> Headless::radiance() {
    const HostCopy& copy = slots_[last_slot_].radiance;
    const auto bytes = wait_and_map(copy, "radiance");
    if (!bytes) {
        return tl::unexpected(bytes.error());
    }
    Pixels<float> out{.width = copy.size.width, .height = copy.size.height, .channels = 4};
    out.values.resize(std::size_t{4} * out.width * out.height);
    if (copy.format == VK_FORMAT_R32G32B32A32_SFLOAT) {
        std::memcpy(out.values.data(), bytes->data(), out.values.size() * sizeof(float));
        return out;
    }
    const std::span<const std::uint16_t> halves = copy.buffer.mapped_as<std::uint16_t>();
    for (std::size_t i = 0; i < out.values.size(); ++i) {
        out.values[i] = glm::unpackHalf1x16(halves[i]);
    }
    return out;
}

tl::expected<void, Error> Headless::wait_idle() {
    if (auto waited = executor_->wait_idle(); !waited) {
        return tl::unexpected(from(waited.error()));
    }
    return {};
}

} // namespace tyndall::engine
