// What is ordered after what: vector clocks by queue and pipeline stage, as barriers and semaphores make them grow.
// Internal to the checker.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "rendergraph/verify_types.hpp"

namespace tyndall::rg::checker {

/// Pipeline stages as small numbers, each a bit. Stages that the access table never uses share one.
using StageSet = std::uint32_t;
inline constexpr std::uint32_t stage_count = 18;
inline constexpr StageSet end_of_submission = 1U << 17U; ///< what only a semaphore's signal comes after
inline constexpr std::uint32_t host_stage_number = 15;
inline constexpr StageSet host_stage = 1U << host_stage_number;
inline constexpr StageSet every_stage = (1U << 17U) - 1;
[[nodiscard]] StageSet source_stages(VkPipelineStageFlags2 mask);
[[nodiscard]] StageSet destination_stages(VkPipelineStageFlags2 mask);

/// Something that happened on a queue.
struct Point {
    std::uint32_t queue = 0;
    std::uint32_t sequence = 0;
    StageSet stages = 0;
    /// false: work in all of `stages`, over when each is. true: a barrier's transition or availability operation, which
    /// whatever comes after the barrier in any of `stages` comes after.
    bool by_barrier = false;
};

/// For each queue and stage there, the last command that has finished in that stage.
using Clock = std::vector<std::uint32_t>;
[[nodiscard]] bool covers(const std::uint32_t* clock, const Point& point);

/// What a barrier's source scope holds.
struct SourceScope {
    Clock ordered;
    Clock available; ///< of those, what a semaphore made available
};

/// O(stages of a barrier x queues x stages) an operation, whatever the number of commands.
class Order {
public:
    /// One more queue than the plan has: what the host did before the frame.
    explicit Order(std::uint32_t queues);

    [[nodiscard]] std::uint32_t host_queue() const { return queues_; }
    /// The number of the next command on a queue.
    std::uint32_t begin_command(std::uint32_t queue) { return ++sequence_[queue]; }

    void source_scope(std::uint32_t queue, StageSet stages, SourceScope& out) const;
    /// Later commands of the queue in `stages` come after `source`. All of one barrier command are added after all of
    /// them were read.
    void add_barrier(std::uint32_t queue, StageSet stages, const SourceScope& source);
    /// All that a semaphore signalled now on the queue comes after.
    [[nodiscard]] Clock signal(std::uint32_t queue) const;
    void wait(std::uint32_t queue, StageSet stages, const Clock& signalled);
    /// Every queue comes after, and sees, all that happened so far.
    void join();

    /// Commands of `queue` in each of `stages` come after the point.
    [[nodiscard]] bool after(const Point& point, std::uint32_t queue, StageSet stages) const;
    /// A semaphore made what was written at the point available before such commands.
    [[nodiscard]] bool available(const Point& point, std::uint32_t queue, StageSet stage) const;
    /// A semaphore made it visible to all accesses of that stage.
    [[nodiscard]] bool visible(const Point& point, std::uint32_t queue, StageSet stage) const;

private:
    /// What the host did on the device it submitted to the first queue; what it did itself all queues come after.
    [[nodiscard]] static bool host_comes_before(std::uint32_t queue, std::uint32_t stage) {
        return queue == 0 || stage == host_stage_number;
    }
    [[nodiscard]] std::size_t row(std::uint32_t queue, std::uint32_t stage) const {
        return (std::size_t{queue} * stage_count + stage) * width_;
    }
    std::uint32_t queues_;
    std::size_t width_; ///< of a clock
    std::vector<std::uint32_t> sequence_;
    // A clock for each queue and stage.
    Clock ordered_;
    Clock available_; ///< through at least one semaphore
    Clock visible_;   ///< by a semaphore that this very queue and stage waited for
};

/// Calls `f(number)` for each stage of the set.
template <typename F>
void for_each_stage(StageSet stages, F&& f) {
    for (; stages != 0; stages &= stages - 1) {
        f(static_cast<std::uint32_t>(std::countr_zero(stages)));
    }
}

} // namespace tyndall::rg::checker
