// The course of a frame: begin, bind, record, submit, finish.
#include "rendergraph/executor.hpp"

#include <algorithm>

#include "rendergraph/executor_state.hpp"

namespace tyndall::rg {
namespace {

constexpr std::uint32_t most_frames_in_flight = 4;
constexpr std::size_t most_queues = 32; // sets of queues are 32-bit masks

std::string_view words_for(VkResult result) {
    switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY: return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY: return "out of device memory";
    case VK_ERROR_TOO_MANY_OBJECTS: return "too many objects";
    case VK_ERROR_DEVICE_LOST: return "the device was lost";
    case VK_ERROR_FORMAT_NOT_SUPPORTED: return "the format is not supported";
    default: return "the driver refused";
    }
}

} // namespace

ExecuteError vulkan_error(VkResult result, std::string_view what) {
    ExecuteError error{.result = result};
    const bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY ||
                        result == VK_ERROR_OUT_OF_POOL_MEMORY || result == VK_ERROR_TOO_MANY_OBJECTS;
    error.kind = memory                           ? ExecuteError::Kind::out_of_memory
                 : result == VK_ERROR_DEVICE_LOST ? ExecuteError::Kind::device_lost
                                                  : ExecuteError::Kind::vulkan;
    error.message = std::string(what) + ": " + std::string(words_for(result)) + " (VkResult " +
                    std::to_string(static_cast<int>(result)) + ")";
    return error;
}

// ---- life --------------------------------------------------------------------------------------------------------

ExecutorState::Result ExecutorState::initialise() {
    using Kind = ExecuteError::Kind;
    if (info.get_device_proc_addr == nullptr || info.device == VK_NULL_HANDLE) {
        return tl::unexpected(
            ExecuteError{.kind = Kind::missing_function, .message = "No device or no vkGetDeviceProcAddr was given"});
    }
    const bool fitting_queues =
        !info.queues.empty() && info.queues.size() <= most_queues && info.queues.front().kind == QueueKind::graphics;
    if (!fitting_queues) {
        return tl::unexpected(ExecuteError{.kind = Kind::unsuitable_queue,
                                           .message = "The first queue given must be a graphics queue, and at most 32 "
                                                      "queues can be given"});
    }
    const char* missing = nullptr;
    if (!load_device_table(info.get_device_proc_addr, info.device, vk, missing)) {
        return tl::unexpected(ExecuteError{.kind = Kind::missing_function,
                                           .message = "The device has no " + std::string(missing) +
                                                      "; Vulkan 1.3 and VK_KHR_push_descriptor must be enabled on it"});
    }
    vk_of_lost_frame = without_commands(vk);
    info.frames_in_flight = std::clamp(info.frames_in_flight, 1U, most_frames_in_flight);
    for (const DeviceQueue& given : info.queues) {
        const auto same = std::find_if(queues.begin(), queues.end(),
                                       [&](const RealQueue& other) { return other.info.family == given.family; });
        const std::uint32_t bit = same != queues.end() ? same->family_bit : 1U << queues.size();
        queues.push_back({.info = given, .family_bit = bit});
        all_families |= bit;
    }
    if (all_families == 1U) {
        all_families = 0;
    }
    for (RealQueue& queue : queues) {
        const VkSemaphoreTypeCreateInfo timeline{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                                 .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
        const VkSemaphoreCreateInfo create{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &timeline};
        if (const VkResult made = vk.CreateSemaphore(info.device, &create, nullptr, &queue.timeline); made < 0) {
            return tl::unexpected(vulkan_error(made, "A timeline semaphore could not be created"));
        }
    }
    slots.resize(info.frames_in_flight);
    for (FrameSlot& slot : slots) {
        slot.values.assign(queues.size(), 0);
        slot.pools.resize(queues.size());
        for (std::size_t queue = 0; queue < queues.size(); ++queue) {
            const VkCommandPoolCreateInfo create{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                                 .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                                 .queueFamilyIndex = queues[queue].info.family};
            const VkResult made = vk.CreateCommandPool(info.device, &create, nullptr, &slot.pools[queue].pool);
            if (made < 0) {
                return tl::unexpected(vulkan_error(made, "A command pool could not be created"));
            }
        }
    }
    return {};
}

ExecutorState::~ExecutorState() {
    if (vk.DestroyDevice == nullptr) {
        return; // the table was never loaded: nothing was made
    }
    // Not just the timelines: a driver may still tidy up a submission after it has signalled the last value, and the
    // timelines are about to go. A lost device has finished too.
    for (const RealQueue& queue : queues) {
        static_cast<void>(vk.QueueWaitIdle(queue.info.queue));
    }
    for (const auto& set : transients) {
        destroy(set->objects, set->memory);
    }
    for (const auto& pair : histories) {
        destroy(pair->copies, pair->memory);
    }
    std::vector<VkDeviceMemory> no_memory;
    for (const auto& import : imports) {
        destroy(import->objects, no_memory);
    }
    collect_garbage(frames);
    for (const FrameSlot& slot : slots) {
        vk.DestroyQueryPool(info.device, slot.queries, nullptr);
        for (const CommandPool& pool : slot.pools) {
            vk.DestroyCommandPool(info.device, pool.pool, nullptr);
        }
    }
    for (const RealQueue& queue : queues) {
        vk.DestroySemaphore(info.device, queue.timeline, nullptr);
    }
}

// ---- one frame ---------------------------------------------------------------------------------------------------

tl::expected<std::uint64_t, ExecuteError> ExecutorState::execute(VkCommandBuffer host_cmd, const GraphDesc& graph,
                                                                 const Plan& plan, const PassCallbacks& callbacks,
                                                                 std::span<const ImportBinding> given) {
    work.graph = &graph;
    work.plan = &plan;
    work.callbacks = &callbacks;
    work.number = frames + 1;
    work.slot = static_cast<std::uint32_t>(frames % slots.size());
    work.by_host = host_cmd != VK_NULL_HANDLE;
    work.error.reset();
    work.memory_barriers.clear();
    work.image_barriers.clear();
    work.buffer_barriers.clear();
    if (Result begun = begin_frame(); !begun) {
        return tl::unexpected(explained(std::move(begun.error())));
    }
    gather_usage(graph, info.poison_transients, work.usage);
    map_queues();
    if (Result bound = bind_objects(given); !bound) {
        return tl::unexpected(explained(std::move(bound.error())));
    }
    if (Result done = record_and_submit(host_cmd); !done) {
        return tl::unexpected(explained(std::move(done.error())));
    }
    finish_frame();
    return work.number;
}

ExecutorState::Result ExecutorState::begin_frame() {
    FrameSlot& slot = slots[work.slot];
    if (Result waited = wait_for_values(slot.values); !waited) {
        return waited;
    }
    if (slot.frame > newest_timed_frame) {
        static_cast<void>(read_timings(slot)); // profiling lost for one frame is no error
    }
    const std::uint64_t in_flight = slots.size();
    collect_garbage(work.number > in_flight ? work.number - in_flight : 0);
    retire_unused();
    for (CommandPool& pool : slot.pools) {
        if (pool.used == 0) {
            continue;
        }
        pool.used = 0;
        if (const VkResult result = vk.ResetCommandPool(info.device, pool.pool, 0); result < 0) {
            return tl::unexpected(vulkan_error(result, "A command pool could not be reset"));
        }
    }
    return {};
}

ExecutorState::Result ExecutorState::record_and_submit(VkCommandBuffer host_cmd) {
    if (Result prepared = prepare_queries(); !prepared) {
        return prepared;
    }
    const Plan& plan = *work.plan;
    work.batch_of_pass.assign(work.graph->passes.size(), none);
    for (const PlannedPass& planned : plan.passes) {
        work.batch_of_pass[planned.pass] = planned.batch;
    }
    if (work.by_host) {
        record_into(host_cmd);
    } else {
        plan_segments();
        plan_semaphores();
        if (Result recorded = record_segments(); !recorded) {
            return recorded;
        }
    }
    if (work.error) {
        return tl::unexpected(*work.error);
    }
    return work.by_host ? Result{} : submit_segments();
}

void ExecutorState::finish_frame() {
    frames = work.number;
    history_lost = false;
    FrameSlot& slot = slots[work.slot];
    slot.frame = work.number;
    slot.by_host = work.by_host;
    std::transform(queues.begin(), queues.end(), slot.values.begin(),
                   [](const RealQueue& queue) { return queue.submitted; });
    if (!work.plan->passes.empty()) {
        slot.last_pass.assign(work.graph->passes[work.plan->passes.back().pass].name);
    }
    for (const auto& pair : histories) {
        if (pair->resource == none) {
            continue;
        }
        const bool written =
            std::any_of(work.graph->accesses.begin(), work.graph->accesses.end(), [&](const AccessDesc& access) {
                return access.resource == pair->resource && is_write(access.direction) &&
                       work.batch_of_pass[access.pass] != none;
            });
        pair->layout[pair->current] =
            written ? work.plan->placements[pair->resource].resting_layout : VK_IMAGE_LAYOUT_UNDEFINED;
        pair->layout[1 - pair->current] = VK_IMAGE_LAYOUT_UNDEFINED; // wherever its last reader left it
        pair->written_in = written ? work.number : 0;
        pair->current = 1 - pair->current;
        pair->resource = none;
    }
}

ExecutorState::Result ExecutorState::wait_for_values(std::span<const std::uint64_t> values) const {
    std::array<VkSemaphore, most_queues> semaphores = {};
    std::array<std::uint64_t, most_queues> wanted = {};
    std::uint32_t count = 0;
    for (std::size_t queue = 0; queue < values.size(); ++queue) {
        if (values[queue] > 0) {
            semaphores[count] = queues[queue].timeline;
            wanted[count++] = values[queue];
        }
    }
    if (count == 0) {
        return {};
    }
    const VkSemaphoreWaitInfo wait{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                   .semaphoreCount = count,
                                   .pSemaphores = semaphores.data(),
                                   .pValues = wanted.data()};
    if (const VkResult result = vk.WaitSemaphores(info.device, &wait, ~std::uint64_t{0}); result < 0) {
        return tl::unexpected(vulkan_error(result, "Waiting for a frame failed"));
    }
    return {};
}

bool ExecutorState::finished(const FrameSlot& slot) const {
    if (slot.by_host) {
        return false; // known only when the slot comes round again
    }
    for (std::size_t queue = 0; queue < queues.size(); ++queue) {
        std::uint64_t reached = 0;
        if (vk.GetSemaphoreCounterValue(info.device, queues[queue].timeline, &reached) < 0 ||
            reached < slot.values[queue]) {
            return false;
        }
    }
    return true;
}

// ---- the public face ---------------------------------------------------------------------------------------------

Executor::Executor(std::unique_ptr<ExecutorState> state) : state_(std::move(state)) {}
Executor::Executor(Executor&&) noexcept = default;
Executor& Executor::operator=(Executor&&) noexcept = default;
Executor::~Executor() = default;

tl::expected<Executor, ExecuteError> Executor::create(ExecutorInfo info) {
    info.check_bindings = checks_bindings(info.check_bindings);
    auto state = std::make_unique<ExecutorState>(std::move(info));
    if (ExecutorState::Result ready = state->initialise(); !ready) {
        return tl::unexpected(std::move(ready.error()));
    }
    return Executor(std::move(state));
}

MemoryRequirements Executor::memory_requirements(const GraphDesc& graph) const {
    std::vector<VkFlags> usage;
    gather_usage(graph, state_->info.poison_transients, usage);
    MemoryRequirements out;
    out.buffer_image_granularity = state_->info.buffer_image_granularity;
    for (std::uint32_t resource = 0; resource < graph.resources.size(); ++resource) {
        out.of_resource.push_back(state_->requirement_of(graph.resources[resource], usage[resource]));
    }
    return out;
}

QueueTopology Executor::topology() const {
    QueueTopology out{.queues = {}};
    for (const RealQueue& queue : state_->queues) {
        const std::uint8_t capabilities = queue.info.kind == QueueKind::graphics
                                              ? can_graphics | can_compute | can_transfer
                                          : queue.info.kind == QueueKind::compute ? can_compute | can_transfer
                                                                                  : can_transfer;
        out.queues.push_back({queue.info.kind, queue.info.family, capabilities});
    }
    return out;
}

tl::expected<std::uint64_t, ExecuteError> Executor::submit(const GraphDesc& graph, const Plan& plan,
                                                           const PassCallbacks& callbacks,
                                                           std::span<const ImportBinding> imports) {
    return state_->execute(VK_NULL_HANDLE, graph, plan, callbacks, imports);
}

tl::expected<std::uint64_t, ExecuteError> Executor::record(VkCommandBuffer cmd, const GraphDesc& graph,
                                                           const Plan& plan, const PassCallbacks& callbacks,
                                                           std::span<const ImportBinding> imports) {
    return state_->execute(cmd, graph, plan, callbacks, imports);
}

tl::expected<void, ExecuteError> Executor::wait(std::uint64_t frame) {
    const bool known = frame > 0 && state_->slot_of(frame).frame == frame;
    if (!known) {
        return {}; // its slot has been used again, so it has finished
    }
    ExecutorState::Result waited = state_->wait_for_values(state_->slot_of(frame).values);
    if (!waited) {
        return tl::unexpected(state_->explained(std::move(waited.error())));
    }
    return waited;
}

tl::expected<void, ExecuteError> Executor::wait_idle() {
    return wait(state_->frames);
}

std::uint32_t Executor::next_slot() const {
    return static_cast<std::uint32_t>(state_->frames % state_->slots.size());
}

tl::expected<void, ExecuteError> Executor::wait_for_slot() {
    return wait(state_->slots[next_slot()].frame);
}

std::vector<PassTiming> Executor::timings() {
    return state_->timings();
}

void Executor::invalidate_history() {
    state_->history_lost = true;
}

void Executor::release_import(VkImage image) {
    state_->release_import(image);
}

} // namespace tyndall::rg
