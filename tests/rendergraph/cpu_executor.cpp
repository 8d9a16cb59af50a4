#include "tests/rendergraph/cpu_executor.hpp"

#include <algorithm>
#include <atomic>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

#include "tests/rendergraph/cpu_reference.hpp"
#include "tests/rendergraph/recorded_commands.hpp"

namespace tyndall::rg::test {
namespace {

struct Gate;

/// What one thread does: one stage's share of an access or transition to one piece of a resource.
struct Task {
    std::uint32_t queue = 0;
    VkPipelineStageFlags2 stage = 0; ///< 0: a transition, which only what comes after its barrier comes after
    std::uint32_t resource = none;
    Part piece{};
    VkAccessFlags2 access = 0;
    bool writes = false;
    std::function<void()> work;
    std::vector<const Gate*> after;  ///< the gates that stand before its stage when it is issued
    const Gate* own = nullptr;       ///< of a transition: the barrier that it belongs to
    std::vector<const Task*> inputs; ///< reads of the same pass whose values it uses
    std::atomic<bool> done = false;
    [[nodiscard]] VkAccessFlags2 written() const { return stage != 0 ? access & writes_of_memory : 0; }
};

/// Something that stands between commands: one barrier's dependency, or a semaphore.
struct Gate {
    std::uint32_t signal = none; ///< the batch whose semaphore it is
    std::uint32_t resource = none;
    Part part{};
    VkAccessFlags2 src_access = 0, dst_access = 0;
    bool of_all_memory = false;      ///< bytes of other resources too
    std::vector<const Task*> before; ///< the source scope
    std::vector<const Gate*> gates;  ///< and what already stood before it
    std::vector<const Task*> acts;   ///< its transitions
};

void wait_for(const std::atomic<bool>& flag, std::memory_order order) {
    while (!flag.load(order)) {
        std::this_thread::yield();
    }
}

/// Everything that a task comes after, through any number of gates. Order alone is waited for without memory order;
/// reads, and writes that the gates on the way make available and visible to the task, are acquired.
class Arrival {
public:
    Arrival(const Task& task, const Plan& plan, const std::deque<std::atomic<bool>>& signals)
        : task_(task), plan_(plan), signals_(signals) {}

    void run() {
        for (const Gate* gate : task_.after) {
            const bool own = gate == task_.own;
            const bool sees = own || gate->signal != none ||
                              (gate->resource == task_.resource && gate->part.holds(task_.piece) &&
                               includes(gate->dst_access, task_.access));
            cross(*gate, {sees, 0, 0});
        }
        for (const Task* input : task_.inputs) {
            wait_for(input->done, std::memory_order_acquire);
        }
    }

private:
    struct Way {
        bool sees;                  ///< the gate nearest to the task gives it sight of its resource
        VkAccessFlags2 flushed;     ///< kinds of write to the task's resource made available on the way
        VkAccessFlags2 flushed_all; ///< to any resource
        friend bool operator==(const Way&, const Way&) = default;
    };

    void cross(const Gate& gate, Way way) {
        if (gate.signal != none) {
            wait_for(signals_[gate.signal], std::memory_order_acquire); // and all that it came after
            return;
        }
        if (gate.resource == task_.resource && gate.part.holds(task_.piece)) {
            way.flushed |= gate.src_access;
        }
        way.flushed_all |= gate.of_all_memory ? gate.src_access : VkAccessFlags2{0};
        const auto been = [&](const auto& visit) { return visit.first == &gate && visit.second == way; };
        if (std::any_of(visited_.begin(), visited_.end(), been)) {
            return;
        }
        visited_.emplace_back(&gate, way);
        for (const Task* task : gate.before) {
            arrive(*task, way);
        }
        for (const Task* task : gate.acts) {
            if (&gate != task_.own) {
                arrive(*task, way);
            }
        }
        for (const Gate* earlier : gate.gates) {
            cross(*earlier, way);
        }
    }

    void arrive(const Task& earlier, const Way& way) const {
        wait_for(earlier.done, std::memory_order_relaxed);
        const bool same = earlier.resource == task_.resource;
        const bool common =
            same ? earlier.piece.meets(task_.piece) : share_bytes(plan_, earlier.resource, task_.resource);
        const bool available = earlier.written() == 0 || includes(way.flushed_all, earlier.written()) ||
                               (same && includes(way.flushed, earlier.written()));
        const bool visible = !same || way.sees;
        if (common && (!earlier.writes || (available && visible))) {
            (void)earlier.done.load(std::memory_order_acquire);
        }
    }

    const Task& task_;
    const Plan& plan_;
    const std::deque<std::atomic<bool>>& signals_;
    std::vector<std::pair<const Gate*, Way>> visited_;
};

class CpuExecutor {
public:
    CpuExecutor(const GraphDesc& graph, const Plan& plan, Values values)
        : graph_(graph), plan_(plan), values_(values), estimate_(estimate_memory(graph)),
          reference_(graph, plan.variants, estimate_, values), commands_(recorded_commands(graph, plan)),
          signals_(plan.batches.size()), sums_(graph.passes.size()) {}

    CpuRun run() {
        CpuRun result;
        for (std::uint32_t b = 0; b < plan_.batches.size(); ++b) {
            for (const BatchWait& wait : plan_.batches[b].waits) {
                if (wait.batch >= b || !plan_.batches[wait.batch].signals) {
                    return result;
                }
            }
        }
        result.started = true;
        lay_out_memory();
        std::vector<std::thread> queues;
        for (std::uint32_t queue = 0; queue < plan_.topology.queues.size(); ++queue) {
            queues.emplace_back([this, queue] { issue(queue); });
        }
        for (std::thread& queue : queues) {
            queue.join();
        }
        check_what_is_left();
        result.reads = reads_.load();
        result.mismatches = mismatches_.load();
        result.first_mismatch = first_mismatch_;
        return result;
    }

private:
    void lay_out_memory() {
        for (const Heap& heap : plan_.heaps) {
            heaps_.emplace_back(heap.size_bytes / cell_bytes + 1, 0);
        }
        for (std::uint32_t r = 0; r < graph_.resources.size(); ++r) {
            std::vector<std::uint64_t>& own = own_.emplace_back();
            const Placement& placement = plan_.placements[r];
            if (placement.kind != PlacementKind::heap) {
                own.resize(cell_count_of(graph_, estimate_, r));
                for (std::uint32_t cell = 0; cell < own.size(); ++cell) {
                    own[cell] = first_value(r, cell);
                }
            }
        }
        for (std::uint32_t r = 0; r < graph_.resources.size(); ++r) {
            const Placement& placement = plan_.placements[r];
            cells_.push_back(placement.kind == PlacementKind::heap
                                 ? heaps_[placement.heap].data() + placement.offset_bytes / cell_bytes
                                 : own_[r].data());
        }
    }

    /// One queue's commands, in order. Nothing here waits: every task waits for itself.
    void issue(std::uint32_t queue) {
        Stream stream{queue};
        for (const Command& command : commands_) {
            if (command.queue != queue) {
                continue;
            }
            switch (command.kind) {
            case CommandKind::wait: {
                Gate& gate = stream.gates.emplace_back();
                gate.signal = command.signaller;
                stream.open.emplace_back(command.stages, &gate);
                break;
            }
            case CommandKind::barriers: record_barriers(stream, command); break;
            case CommandKind::touches: issue_pass(stream, command); break;
            case CommandKind::signal: issue_signal(stream, command.batch); break;
            }
        }
        for (std::thread& thread : stream.threads) {
            thread.join();
        }
    }

    struct Stream {
        std::uint32_t queue;
        std::deque<Task> tasks = {};
        std::deque<Gate> gates = {};
        std::vector<std::pair<VkPipelineStageFlags2, const Gate*>> open = {}; ///< by the stages that they stand before
        std::vector<std::thread> threads = {};
    };

    static std::vector<const Gate*> gates_before(const Stream& stream, VkPipelineStageFlags2 stages) {
        std::vector<const Gate*> out;
        for (const auto& [before, gate] : stream.open) {
            if ((before & stages) != 0) {
                out.push_back(gate);
            }
        }
        return out;
    }

    void start(Stream& stream, Task& task) {
        stream.threads.emplace_back([this, &task] {
            Arrival(task, plan_, signals_).run();
            task.work();
            task.done.store(true, std::memory_order_release);
        });
    }

    void record_barriers(Stream& stream, const Command& command) {
        std::vector<std::pair<VkPipelineStageFlags2, const Gate*>> opened;
        const std::size_t tasks_before = stream.tasks.size();
        for (const Recorded& recorded : command.barriers) {
            const Dependency& d = plan_.dependencies[recorded.dependency];
            Gate& gate = stream.gates.emplace_back();
            gate.resource = d.resource;
            gate.part = part_of(graph_.resources[d.resource], d.image_range, d.buffer_range);
            gate.src_access = recorded.src_access;
            gate.dst_access = recorded.dst_access;
            gate.of_all_memory = d.hazard == Hazard::aliased_memory;
            const VkPipelineStageFlags2 src = expanded(recorded.src);
            gate.gates = gates_before(stream, src);
            for (std::size_t i = 0; i < tasks_before; ++i) {
                if ((stream.tasks[i].stage & src) != 0) {
                    gate.before.push_back(&stream.tasks[i]);
                }
            }
            std::vector<Task*> acts;
            if (recorded.acts) {
                for (const Part& piece : pieces_of(graph_, d.resource, gate.part)) {
                    acts.push_back(&add_transition(stream, d, piece, gate));
                    gate.acts.push_back(acts.back());
                }
            }
            for (Task* act : acts) {
                start(stream, *act);
            }
            opened.emplace_back(expanded(recorded.dst), &gate);
        }
        stream.open.insert(stream.open.end(), opened.begin(), opened.end());
    }

    Task& add_transition(Stream& stream, const Dependency& d, const Part& piece, const Gate& gate) {
        Task& task = stream.tasks.emplace_back();
        task.queue = stream.queue;
        task.resource = d.resource;
        task.piece = piece;
        task.writes = true;
        task.own = &gate;
        task.after = {&gate};
        const bool discards = d.old_layout == VK_IMAGE_LAYOUT_UNDEFINED && d.new_layout != d.old_layout;
        task.work = [this, resource = d.resource, cells = cells_in(d.resource, piece), discards] {
            for (const std::uint32_t cell : cells) {
                cells_[resource][cell] = discards ? mixed(cell) : cells_[resource][cell] ^ no_change_;
            }
        };
        return task;
    }

    [[nodiscard]] std::vector<std::uint32_t> cells_in(std::uint32_t resource, const Part& piece) const {
        const ImageRange image{static_cast<std::uint32_t>(piece.a0), static_cast<std::uint32_t>(piece.a1 - piece.a0),
                               static_cast<std::uint32_t>(piece.b0), static_cast<std::uint32_t>(piece.b1 - piece.b0)};
        return cells_of(graph_.resources[resource], cell_count_of(graph_, estimate_, resource), image,
                        {piece.a0, piece.a1 - piece.a0});
    }

    /// Accesses first declared as reads come first, so that writes can take their values in.
    void issue_pass(Stream& stream, const Command& command) {
        const std::size_t first = stream.tasks.size();
        for (const bool writes : {false, true}) {
            std::vector<const Task*> inputs;
            for (std::size_t i = first; values_ == Values::from_reads && writes && i < stream.tasks.size(); ++i) {
                inputs.push_back(&stream.tasks[i]);
            }
            for (const Touch& touch : command.touches) {
                if (touch.writes == writes) {
                    add_access(stream, touch, inputs);
                }
            }
        }
        for (std::size_t i = first; i < stream.tasks.size(); ++i) {
            start(stream, stream.tasks[i]);
        }
    }

    void add_access(Stream& stream, const Touch& touch, const std::vector<const Task*>& inputs) {
        std::vector<VkPipelineStageFlags2> stages;
        for (VkPipelineStageFlags2 left = touch.stages; left != 0; left &= left - 1) {
            stages.push_back(left & ~(left - 1));
        }
        const AccessDesc& access = graph_.accesses[touch.access_index];
        for (const Part& piece : pieces_of(graph_, touch.resource, touch.part)) {
            const std::vector<std::uint32_t> cells = cells_in(touch.resource, piece);
            for (std::size_t s = 0; s < stages.size(); ++s) {
                Task& task = stream.tasks.emplace_back();
                task.queue = stream.queue;
                task.stage = stages[s];
                task.resource = touch.resource;
                task.piece = piece;
                task.access = touch.access;
                task.writes = touch.writes;
                task.after = gates_before(stream, stages[s]);
                task.inputs = inputs;
                std::vector<Cell> share; // each stage has its cells
                for (std::size_t i = s; i < cells.size(); i += stages.size()) {
                    const std::uint32_t named = access.version - (is_write(access.direction) ? 1 : 0);
                    share.push_back({cells[i], is_read(access.direction)
                                                   ? reference_value(touch.resource, cells[i], named)
                                                   : std::uint64_t{0}});
                }
                task.work = [this, index = touch.access_index, share = std::move(share)] { touch_cells(index, share); };
            }
        }
    }

    struct Cell {
        std::uint32_t index;
        std::uint64_t expected;
    };

    [[nodiscard]] std::uint64_t reference_value(std::uint32_t resource, std::uint32_t cell, std::uint32_t version) {
        const std::scoped_lock lock(reference_mutex_); // between issuing threads; no task takes it
        return reference_.value(resource, cell, version);
    }

    void touch_cells(std::uint32_t index, const std::vector<Cell>& share) {
        const AccessDesc& access = graph_.accesses[index];
        std::atomic<std::uint64_t>& sum = sums_[access.pass];
        std::uint64_t* memory = cells_[access.resource];
        const std::uint64_t inputs = values_ == Values::from_reads ? sum.load(std::memory_order_relaxed) : 0;
        for (const Cell& cell : share) {
            const std::uint64_t old = is_read(access.direction) ? memory[cell.index] : std::uint64_t{0};
            if (is_read(access.direction)) {
                compare(old, cell.expected, access);
            }
            if (is_write(access.direction)) {
                memory[cell.index] = written_value(index, cell.index, old, inputs);
            } else {
                sum.fetch_add(mixed(old), std::memory_order_relaxed);
            }
        }
    }

    void compare(std::uint64_t found, std::uint64_t expected, const AccessDesc& access) {
        reads_.fetch_add(1, std::memory_order_relaxed);
        if (found != expected && mismatches_.fetch_add(1, std::memory_order_relaxed) == 0) {
            first_mismatch_ = graph_.passes[access.pass].name + " reads another content of " +
                              graph_.resources[access.resource].name + " than the graph says";
        }
    }

    /// Signalled once all is done that was issued to the queue so far.
    void issue_signal(Stream& stream, std::uint32_t batch) {
        std::vector<const Task*> tasks;
        for (const Task& task : stream.tasks) {
            tasks.push_back(&task);
        }
        stream.threads.emplace_back(
            [this, batch, tasks = std::move(tasks), gates = gates_before(stream, ~VkPipelineStageFlags2{0})] {
                for (const Task* task : tasks) {
                    wait_for(task->done, std::memory_order_acquire);
                }
                for (const Gate* gate : gates) {
                    if (gate->signal != none) {
                        wait_for(signals_[gate->signal], std::memory_order_acquire);
                    }
                }
                signals_[batch].store(true, std::memory_order_release);
            });
    }

    /// What the passes of the plan wrote for others; what only another form would have written may be anything.
    void check_what_is_left() {
        std::vector<bool> kept(graph_.passes.size(), false);
        for (const PlannedPass& planned : plan_.passes) {
            kept[planned.pass] = true;
        }
        for (std::uint32_t r = 0; r < graph_.resources.size(); ++r) {
            const ResourceDesc& desc = graph_.resources[r];
            const bool leaves = desc.has_history || (desc.import != none && graph_.imports[desc.import].has_final);
            for (const AccessDesc& access : graph_.accesses) {
                if (!leaves || access.resource != r || !is_write(access.direction) || !kept[access.pass]) {
                    continue;
                }
                for (const std::uint32_t cell :
                     cells_of(desc, cell_count_of(graph_, estimate_, r), access.image_range, access.buffer_range)) {
                    compare(cells_[r][cell], reference_.value(r, cell, none), access);
                }
            }
        }
    }

    const GraphDesc& graph_;
    const Plan& plan_;
    Values values_;
    MemoryRequirements estimate_;
    Reference reference_;
    std::mutex reference_mutex_;
    std::vector<Command> commands_;
    std::deque<std::atomic<bool>> signals_; ///< by batch
    std::vector<std::vector<std::uint64_t>> heaps_;
    std::vector<std::vector<std::uint64_t>> own_; ///< by resource: imports and histories
    std::vector<std::uint64_t*> cells_;           ///< by resource
    volatile std::uint64_t no_change_ = 0;        ///< so that a transition's stores are not optimised away
    std::deque<std::atomic<std::uint64_t>> sums_; ///< by pass: of what it read
    std::atomic<std::uint32_t> reads_ = 0;
    std::atomic<std::uint32_t> mismatches_ = 0;
    std::string first_mismatch_;
};

} // namespace

CpuRun run_on_cpu(const GraphDesc& graph, const Plan& plan, Values values) {
    return CpuExecutor(graph, plan, values).run();
}

} // namespace tyndall::rg::test
