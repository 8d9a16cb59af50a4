// Runs a plan on a device. It is handed everything, creates no instance and calls no global Vulkan symbol.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "rendergraph/device_table.hpp"
#include "rendergraph/graph.hpp"
#include "rendergraph/plan.hpp"
#include "rendergraph/shader_bindings.hpp"

namespace tyndall::rg {

/// What went wrong on the device: ordinary return values, never an abort.
struct ExecuteError {
    enum class Kind : std::uint8_t {
        out_of_memory,
        device_lost,
        missing_function,
        missing_binding,
        undeclared_access, ///< a callback asked its PassContext for what its pass did not declare, or its shader does
                           ///< it
        unsuitable_queue,
        vulkan
    };
    Kind kind = Kind::vulkan;
    VkResult result = VK_SUCCESS;
    std::string message = {}; ///< one sentence; after a device loss it names the last passes that began and did not end
};

/// A real queue of the device. Logical queues of a plan are folded onto these by kind.
struct DeviceQueue {
    QueueKind kind = QueueKind::graphics;
    VkQueue queue = VK_NULL_HANDLE;
    std::uint32_t family = 0;
    std::uint32_t timestamp_valid_bits = 0; ///< 0: the queue cannot write timestamps
};

/// Device memory by the host; a plain vkAllocateMemory is used when `allocate` is empty.
struct MemoryCallbacks {
    std::function<VkResult(const VkMemoryAllocateInfo&, VkDeviceMemory&)> allocate;
    std::function<void(VkDeviceMemory)> free;
};

struct ExecutorInfo {
    PFN_vkGetDeviceProcAddr get_device_proc_addr = nullptr;
    VkDevice device = VK_NULL_HANDLE;
    VkPhysicalDeviceMemoryProperties memory_properties = {};
    VkDeviceSize buffer_image_granularity = 1;
    float timestamp_period_ns = 1.0F;
    std::vector<DeviceQueue> queues; ///< the first is the graphics queue
    MemoryCallbacks memory;
    std::uint32_t frames_in_flight = 2;        ///< 1 to 4
    bool profile = false;                      ///< timestamps per pass
    bool timestamps_need_full_barrier = false; ///< a full barrier after each timestamp (Mesa's lavapipe charges work to
                                               ///< the wrong interval without it)
    bool debug_labels = false;                 ///< VK_EXT_debug_utils is enabled on the instance
    /// Debug switch: transients and what a frame writes of its histories are filled with a pattern, NaN where there is
    /// one, before their first write, so that reading what nobody wrote shows. What a queue cannot clear is left out.
    /// Times of passes then hold the fills, and full barriers stand around them.
    bool poison_transients = false;
    /// Debug switch, always on in debug builds: what a pass pushes is compared with what the shader given to
    /// PassContext::push binds, and a difference is an undeclared access.
    bool check_bindings = false;
};

/// The physical objects of one import for one frame.
struct ImportBinding {
    std::uint32_t resource = none; ///< index of the handle
    VkImage image = VK_NULL_HANDLE;
    VkBuffer buffer = VK_NULL_HANDLE;
    VkSemaphore wait_semaphore = VK_NULL_HANDLE;   ///< when ImportDesc::waits_semaphore
    std::uint64_t wait_value = 0;                  ///< timeline value, 0 for a binary semaphore
    VkSemaphore signal_semaphore = VK_NULL_HANDLE; ///< when ImportDesc::signals_semaphore
    std::uint64_t signal_value = 0;
};

/// Time of one pass, from timestamps.
struct PassTiming {
    std::uint32_t pass = none;
    double start_ms = 0.0; ///< since the frame's first timestamp
    double duration_ms = 0.0;
};

/// A descriptor that a pass binds: see PassContext::push.
struct Binding {
    std::uint32_t binding = 0;
    VkDescriptorType type = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    VkDescriptorImageInfo image = {};
    VkDescriptorBufferInfo buffer = {};
    std::uint32_t resource = none; ///< whose it is, by the handle that was given; none: not of the graph
    std::uint32_t version = 0;
};

/// Which part and shape of an image a view shows. Defaults: all mips and layers that the pass declared, natural type.
struct ViewDesc {
    ImageRange range = {};
    VkImageViewType type = VK_IMAGE_VIEW_TYPE_MAX_ENUM; ///< MAX_ENUM: 2D, 2D_ARRAY or 3D after the image
    friend bool operator==(const ViewDesc&, const ViewDesc&) = default;
};

class ExecutorState;

/// What a pass sees while it records. It gives only what the pass declared; anything else is a null handle and an error
/// of the frame. From then on the frame is lost: the commands of vk() do nothing, so that what was refused does not
/// reach the driver, and the passes that follow are still asked, so that all mistakes are told together.
class PassContext {
public:
    [[nodiscard]] VkCommandBuffer cmd() const { return cmd_; }
    [[nodiscard]] const DeviceTable& vk() const; ///< to be asked for each command
    /// Index in [0, frames_in_flight) of per-frame host data that no earlier frame still reads.
    [[nodiscard]] std::uint32_t frame_slot() const { return frame_slot_; }
    /// Of the attachments of a graphics pass, which has begun rendering with viewport and scissor set when it is
    /// called.
    [[nodiscard]] VkExtent2D render_extent() const { return render_extent_; }
    [[nodiscard]] std::string_view pass_name() const;

    [[nodiscard]] VkImage image(Image image);
    [[nodiscard]] VkBuffer buffer(Buffer buffer);
    [[nodiscard]] VkImageView view(Image image, const ViewDesc& desc = {});
    /// The layout that the image has during this pass.
    [[nodiscard]] VkImageLayout layout(Image image);
    /// False on the first frame, after a change of the resource, and when the host said that history is lost.
    [[nodiscard]] bool history_valid(Image image);
    [[nodiscard]] bool history_valid(Buffer buffer);

    // Bindings, by what the pass declared.
    [[nodiscard]] Binding sampled(std::uint32_t binding, Image image, VkSampler sampler, const ViewDesc& desc = {});
    [[nodiscard]] Binding storage(std::uint32_t binding, Image image, const ViewDesc& desc = {});
    [[nodiscard]] Binding storage(std::uint32_t binding, Buffer buffer);
    [[nodiscard]] Binding uniform(std::uint32_t binding, Buffer buffer, VkDeviceSize offset = 0,
                                  VkDeviceSize size = VK_WHOLE_SIZE);
    /// vkCmdPushDescriptorSetKHR of `bindings` into set `set` of `layout` (VK_KHR_push_descriptor). `shader`: what the
    /// shaders that will see them bind, for ExecutorInfo::check_bindings. It fails the frame where they use a binding
    /// of `set` that is not among `bindings`, or as another type of descriptor; and where they may write what the pass
    /// declares as only read, or read what it declares as only written.
    void push(VkPipelineBindPoint point, VkPipelineLayout layout, std::uint32_t set, std::span<const Binding> bindings,
              std::span<const ReflectedBinding> shader = {});

private:
    friend class ExecutorState;
    ExecutorState* state_ = nullptr;
    VkCommandBuffer cmd_ = VK_NULL_HANDLE;
    std::uint32_t frame_slot_ = 0;
    std::uint32_t pass_ = none;
    VkExtent2D render_extent_ = {};
};

class Executor {
public:
    [[nodiscard]] static tl::expected<Executor, ExecuteError> create(ExecutorInfo info);
    Executor(Executor&&) noexcept;
    Executor& operator=(Executor&&) noexcept;
    ~Executor(); ///< waits for its queues, so they must not be in use by another thread

    /// The driver's own requirements for every transient and history resource, as compile wants them.
    [[nodiscard]] MemoryRequirements memory_requirements(const GraphDesc& graph) const;

    /// The device's queues as logical queues: the topology on which a plan overlaps for real.
    [[nodiscard]] QueueTopology topology() const;

    /// Waits until the frame slot is free, records and submits the plan. Returns the frame's number, from 1. Recording
    /// is on the calling thread, one callback after another, so callbacks need no locks (docs/measurements.md: why).
    [[nodiscard]] tl::expected<std::uint64_t, ExecuteError> submit(const GraphDesc& graph, const Plan& plan,
                                                                   const PassCallbacks& callbacks,
                                                                   std::span<const ImportBinding> imports);

    /// Records the whole plan, every queue folded into one, into a command buffer that the host submits. The host calls
    /// this only when the frame that used the same slot (frames_in_flight ago) has finished.
    [[nodiscard]] tl::expected<std::uint64_t, ExecuteError> record(VkCommandBuffer cmd, const GraphDesc& graph,
                                                                   const Plan& plan, const PassCallbacks& callbacks,
                                                                   std::span<const ImportBinding> imports);

    /// Blocks until `frame` (as returned by submit) has finished on the device.
    [[nodiscard]] tl::expected<void, ExecuteError> wait(std::uint64_t frame);
    [[nodiscard]] tl::expected<void, ExecuteError> wait_idle();

    /// The slot in [0, frames_in_flight) that the next frame will use: free for host writes after wait_for_slot.
    [[nodiscard]] std::uint32_t next_slot() const;
    [[nodiscard]] tl::expected<void, ExecuteError> wait_for_slot();

    /// Timestamps of the newest finished frame, in submission order; empty unless ExecutorInfo::profile. That a frame
    /// of `record` has finished is known when its slot comes round again.
    [[nodiscard]] std::vector<PassTiming> timings();

    /// After a camera cut: history_valid is false in the next frame.
    void invalidate_history();

    /// To be called before an imported image is destroyed: views of it are kept from frame to frame until then.
    void release_import(VkImage image);

private:
    explicit Executor(std::unique_ptr<ExecutorState> state);
    std::unique_ptr<ExecutorState> state_;
};

} // namespace tyndall::rg
