// What an executor owns and what it works on while it records one frame. Internal: the public face is executor.hpp.
//
// One frame: begin (wait for the slot, free what no frame uses any more), bind (a physical object for every resource),
// record (segments of command buffers), submit, finish (histories swap roles). Whole frames are ordered on the device:
// the first commands of a frame on each queue wait for all that earlier frames did there, by a full barrier, and for
// the last work of every other queue, by its timeline semaphore. So the plan need not look beyond its own frame.
#pragma once

#include <memory>
#include <optional>

#include "rendergraph/executor.hpp"

namespace tyndall::rg {

/// A queue of the device and its timeline; values only grow, over all frames.
struct RealQueue {
    DeviceQueue info;
    VkSemaphore timeline = VK_NULL_HANDLE;
    std::uint64_t submitted = 0;  ///< the value that the last submission signals
    std::uint32_t family_bit = 0; ///< bit of the first queue of the same family
};

struct CachedView {
    ImageRange range;
    VkImageViewType type = VK_IMAGE_VIEW_TYPE_2D;
    VkImageView view = VK_NULL_HANDLE;
};

/// An image or a buffer with the views made of it. `owned`: ours to destroy.
struct PhysicalObject {
    VkImage image = VK_NULL_HANDLE;
    VkBuffer buffer = VK_NULL_HANDLE;
    bool owned = true;
    bool concurrent = false;
    std::vector<CachedView> views;
};

/// All that decides what a graph-owned object is: equal keys, same object.
struct ObjectKey {
    ResourceKind kind = ResourceKind::image;
    ImageDesc image;
    VkDeviceSize size_bytes = 0;
    VkFlags usage = 0;
    std::uint32_t queues = 0; ///< families, as bits, that share it, or that own a history; 0: exclusive
};
[[nodiscard]] bool same_key(const ObjectKey& a, const ObjectKey& b);

/// Every transient of one plan, and the heaps that they share.
struct TransientSet {
    struct Entry {
        bool placed = false;
        ObjectKey key;
        std::uint32_t heap = none;
        VkDeviceSize offset_bytes = 0;
    };
    std::vector<Entry> entries;          ///< by resource
    std::vector<PhysicalObject> objects; ///< by resource
    std::vector<VkDeviceSize> heap_bytes;
    std::vector<std::uint32_t> type_bits; ///< by heap: memory types that suit all that lives there
    std::vector<VkDeviceMemory> memory;   ///< by heap
    std::uint64_t last_used = 0;          ///< frame
};

/// The two copies of a resource with a history: `current` is written this frame, the other one is the frame before's.
struct HistoryPair {
    std::string name; ///< of the resource that is written
    ObjectKey key;
    std::vector<PhysicalObject> copies;       ///< two
    std::array<VkImageLayout, 2> layout = {}; ///< between frames; UNDEFINED: not known, content worthless
    std::vector<VkDeviceMemory> memory;       ///< one, that holds both
    std::uint32_t current = 0;
    std::uint64_t written_in = 0;          ///< frame that gave the other copy its content
    std::uint64_t last_used = 0;           ///< frame
    std::uint32_t resource = none;         ///< this frame's index of the resource that is written
    std::uint32_t history_resource = none; ///< and of its history
};

/// Views of a host's image, kept until the host releases it or has not bound it for some frames.
struct ImportedObject {
    std::vector<PhysicalObject> objects; ///< one
    std::uint64_t last_used = 0;
};

/// Objects that wait for the frames that may still use them.
struct Garbage {
    std::uint64_t last_used = 0;
    std::vector<PhysicalObject> objects;
    std::vector<VkDeviceMemory> memory;
};

struct CommandPool {
    VkCommandPool pool = VK_NULL_HANDLE;
    std::vector<VkCommandBuffer> buffers;
    std::uint32_t used = 0;
};

struct TimedPass {
    std::uint32_t pass = none;
    std::uint32_t valid_bits = 0;
    std::string name; ///< for the report of a device loss: the graph may be gone by then
};

/// What a frame in flight holds on to.
struct FrameSlot {
    std::uint64_t frame = 0;           ///< 0: never used
    bool by_host = false;              ///< recorded into a command buffer of the host, who knows when it has finished
    std::vector<std::uint64_t> values; ///< by real queue: reached when the frame has finished
    std::vector<CommandPool> pools;    ///< by real queue
    VkQueryPool queries = VK_NULL_HANDLE;
    std::uint32_t query_capacity = 0;
    std::vector<TimedPass> timed; ///< queries 2 i and 2 i + 1 are the i-th's begin and end
    std::uint32_t timed_count = 0;
    std::string last_pass; ///< the last one in submission order
};

/// Consecutive batches on one real queue that need no semaphore between them: one command buffer.
struct Segment {
    std::uint32_t queue = 0; ///< real
    std::uint32_t first_batch = 0;
    std::uint32_t batch_count = 0; ///< 0: only prepares new histories
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    std::uint64_t value = 0;
    std::uint32_t first_wait = 0, wait_count = 0;     ///< into FrameWork::waits
    std::uint32_t first_signal = 0, signal_count = 0; ///< into FrameWork::signals
};

/// A part of a transient image that is filled with a pattern before a pass begins it.
struct PoisonedImage {
    std::uint32_t resource = none;
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED; ///< that the pass wants
    VkImageSubresourceRange range = {};
};

/// The frame that is being recorded. Kept between frames so that a steady frame allocates nothing.
struct FrameWork {
    const GraphDesc* graph = nullptr;
    const Plan* plan = nullptr;
    const PassCallbacks* callbacks = nullptr;
    std::uint64_t number = 0;
    std::uint32_t slot = 0;
    bool by_host = false;                       ///< recorded into a command buffer of the host
    std::vector<VkFlags> usage;                 ///< by resource
    std::vector<const ImportBinding*> bindings; ///< by resource
    std::vector<PhysicalObject*> objects;       ///< by resource, null where the plan uses none
    std::vector<std::uint32_t> real_of;         ///< by logical queue
    std::vector<std::uint32_t> logical_count;   ///< by real queue: how many logical ones fold onto it
    std::vector<std::uint32_t> batch_of_pass;
    std::vector<std::uint32_t> segment_of_batch;
    std::vector<bool> batch_signals; ///< a batch on another real queue waits for it
    std::vector<bool> queue_begun;   ///< by real queue: its first segment of the frame is recorded
    std::vector<Segment> segments;
    std::vector<VkSemaphoreSubmitInfo> waits;
    std::vector<VkSemaphoreSubmitInfo> signals;
    std::vector<VkCommandBufferSubmitInfo> command_buffers;
    std::vector<VkSubmitInfo2> submits;
    std::vector<VkMemoryBarrier2> memory_barriers;
    std::vector<VkImageMemoryBarrier2> image_barriers;
    std::vector<VkBufferMemoryBarrier2> buffer_barriers;
    std::vector<std::uint64_t> values;       ///< by real queue, of its newest segment
    std::vector<std::uint64_t> entry_values; ///< by real queue, before the frame's first pass
    std::vector<VkRenderingAttachmentInfo> color_attachments;
    std::vector<std::size_t> multisampled; ///< of color_attachments
    std::vector<PoisonedImage> poisoned_images;
    std::vector<std::uint32_t> poisoned_buffers; ///< accesses
    std::vector<VkWriteDescriptorSet> writes;
    std::optional<ExecuteError> error; ///< the first one; undeclared accesses are gathered in its message
};

/// What a pass declared to do to a resource.
struct DeclaredDirections {
    bool reads = false;
    bool writes = false;
};

/// By resource: what any pass of the graph needs, culled or not, so that requirements and objects speak of the same.
/// `poisoned`: and what ExecutorInfo::poison_transients needs.
void gather_usage(const GraphDesc& graph, bool poisoned, std::vector<VkFlags>& usage);

/// Whether a resource of this kind can be filled with a pattern, on a queue that can do it.
[[nodiscard]] bool can_poison(const ResourceDesc& desc);

/// `range` in numbers: mips and layers counted, aspects named.
[[nodiscard]] ImageRange resolved(const ImageRange& range, const ImageDesc& image);

[[nodiscard]] ExecuteError vulkan_error(VkResult result, std::string_view what);

class ExecutorState {
public:
    explicit ExecutorState(ExecutorInfo given) : info(std::move(given)) {}
    ~ExecutorState();
    ExecutorState(const ExecutorState&) = delete;
    ExecutorState& operator=(const ExecutorState&) = delete;

    using Result = tl::expected<void, ExecuteError>;

    [[nodiscard]] Result initialise();

    // executor.cpp: a frame's course
    /// Into `host_cmd`, or submitted if that is null.
    [[nodiscard]] tl::expected<std::uint64_t, ExecuteError> execute(VkCommandBuffer host_cmd, const GraphDesc& graph,
                                                                    const Plan& plan, const PassCallbacks& callbacks,
                                                                    std::span<const ImportBinding> given);
    [[nodiscard]] Result begin_frame();
    [[nodiscard]] Result record_and_submit(VkCommandBuffer host_cmd);
    void finish_frame();
    [[nodiscard]] Result wait_for_values(std::span<const std::uint64_t> values) const;
    [[nodiscard]] FrameSlot& slot_of(std::uint64_t frame) { return slots[(frame - 1) % slots.size()]; }
    [[nodiscard]] bool finished(const FrameSlot& slot) const;

    // executor_memory.cpp: making objects
    [[nodiscard]] MemoryRequirement requirement_of(const ResourceDesc& desc, VkFlags usage) const;
    [[nodiscard]] ObjectKey key_of(std::uint32_t resource) const;
    [[nodiscard]] tl::expected<std::unique_ptr<TransientSet>, ExecuteError> create_transients();
    [[nodiscard]] tl::expected<std::unique_ptr<HistoryPair>, ExecuteError> create_history(const ObjectKey& key,
                                                                                          const std::string& name);
    [[nodiscard]] Result fill(TransientSet& set);
    [[nodiscard]] Result fill(HistoryPair& pair);
    [[nodiscard]] Result create_object(const ObjectKey& key, const std::string& name, PhysicalObject& object);
    [[nodiscard]] VkMemoryRequirements requirements_of(const PhysicalObject& object) const;
    [[nodiscard]] tl::expected<VkDeviceMemory, ExecuteError> allocate(VkDeviceSize size, std::uint32_t type_bits,
                                                                      bool addressed) const;
    [[nodiscard]] VkResult bind_memory(const PhysicalObject& object, VkDeviceMemory memory, VkDeviceSize offset) const;
    void set_name(VkObjectType type, std::uint64_t handle, const std::string& name) const;

    // executor_objects.cpp: keeping them from frame to frame
    [[nodiscard]] Result bind_objects(std::span<const ImportBinding> given);
    [[nodiscard]] Result bind_imports(std::span<const ImportBinding> given);
    [[nodiscard]] Result bind_transients();
    [[nodiscard]] Result bind_histories();
    [[nodiscard]] bool matches(const TransientSet& set) const;
    [[nodiscard]] bool history_valid(std::uint32_t resource) const;
    /// Null, and an error of the frame, if the driver cannot make it.
    [[nodiscard]] VkImageView view_of(std::uint32_t resource, const ImageRange& range, VkImageViewType type);
    void release_import(VkImage image);
    void retire_unused();
    void retire(std::uint64_t last_used, std::vector<PhysicalObject> objects, std::vector<VkDeviceMemory> memory);
    void collect_garbage(std::uint64_t finished_frame);
    /// Frees what only finished frames used, after waiting for all: the last resort before out-of-memory.
    [[nodiscard]] bool make_room();
    void destroy(std::vector<PhysicalObject>& objects, std::vector<VkDeviceMemory>& memory) const;

    // executor_context.cpp: what a callback may ask for
    [[nodiscard]] const AccessDesc* declared_access(std::uint32_t pass, std::uint32_t resource, std::uint32_t version,
                                                    ResourceKind kind, VkFlags usage);
    [[nodiscard]] VkImageView declared_view(std::uint32_t pass, Image image, const ViewDesc& desc, VkFlags usage);
    /// Neither, where it did not declare the resource so.
    [[nodiscard]] DeclaredDirections declared_directions(std::uint32_t pass, std::uint32_t resource,
                                                         std::uint32_t version, VkFlags usage) const;
    /// Adds to the frame's error that `pass` used what it did not declare.
    void report_undeclared(std::uint32_t pass, const std::string& what);

    // executor_bindings.cpp: what its shader does to it
    void check_bindings(std::uint32_t pass, std::uint32_t set, std::span<const Binding> pushed,
                        std::span<const ReflectedBinding> shader);
    /// `pushed`: null where nothing is pushed at the binding.
    void check_binding(std::uint32_t pass, const Binding* pushed, const ReflectedBinding& expected);

    // executor_record.cpp: commands
    [[nodiscard]] Result record_segments();
    void record_into(VkCommandBuffer cmd);
    [[nodiscard]] Result begin_segment(Segment& segment);
    void record_batch(VkCommandBuffer cmd, std::uint32_t index);
    void record_pass(VkCommandBuffer cmd, const PlannedPass& planned);
    [[nodiscard]] VkExtent2D begin_rendering(VkCommandBuffer cmd, const PlannedPass& planned);

    // executor_poison.cpp: garbage where nothing has been written
    void poison(VkCommandBuffer cmd, const PlannedPass& planned);
    [[nodiscard]] bool starts_image(const Dependency& dependency, QueueKind queue) const;
    [[nodiscard]] bool starts_bytes(const AccessDesc& access) const;

    // executor_submit.cpp: logical queues onto real ones, segments, semaphores
    void map_queues();
    void plan_segments();
    void plan_semaphores();
    [[nodiscard]] Result submit_segments();

    // executor_barriers.cpp: the plan's dependencies as barriers of the real queues
    void add_before_consumer(const Dependency& dependency);
    void add_at_batch_end(const Dependency& dependency);
    void add_exit(const Dependency& dependency);
    void add_history_preparations(std::uint32_t real_queue);
    [[nodiscard]] std::uint32_t preparing_queue(const HistoryPair& pair) const;
    void flush_barriers(VkCommandBuffer cmd);
    void whole_barrier(VkCommandBuffer cmd) const;

    // executor_timing.cpp
    [[nodiscard]] Result prepare_queries();
    [[nodiscard]] bool timed(std::uint32_t real_queue) const;
    void reset_queries(VkCommandBuffer cmd, std::uint32_t real_queue, std::uint32_t pass_count);
    void write_timestamp(VkCommandBuffer cmd, std::uint32_t query) const;
    [[nodiscard]] bool read_timings(const FrameSlot& slot);
    [[nodiscard]] std::vector<PassTiming> timings();
    /// Adds to a device loss the passes that began and did not end, or what was last submitted.
    [[nodiscard]] ExecuteError explained(ExecuteError error) const;

    ExecutorInfo info;
    DeviceTable vk = {};
    DeviceTable vk_of_lost_frame = {}; ///< what passes call after an error
    std::vector<RealQueue> queues;
    std::uint32_t all_families = 0; ///< family bits, 0 if there is only one
    std::vector<FrameSlot> slots;
    std::uint64_t frames = 0; ///< executed so far; the next one is frames + 1
    bool history_lost = false;
    std::vector<std::unique_ptr<TransientSet>> transients;
    std::vector<std::unique_ptr<HistoryPair>> histories;
    std::vector<std::unique_ptr<ImportedObject>> imports;
    std::vector<Garbage> garbage;
    FrameWork work;
    std::vector<PassTiming> newest_timings;
    std::uint64_t newest_timed_frame = 0;
    std::vector<std::uint64_t> query_results;
};

} // namespace tyndall::rg
