// The queues of one frame, event by event.
// In: items in submission order with queue, duration and waits. Out: start and end of each. Invariant: an item starts
// at the first moment at which its queue is free and its waits are over. O((items + waits) x queues).
//
// Work is counted in 1/slowdown of a nanosecond alone, so that both speeds, alone and beside others, are whole numbers.
#include "rendergraph/queue_model.hpp"

#include <algorithm>
#include <limits>

namespace tyndall::rg::stages {
namespace {

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t unfinished = -1;
constexpr std::uint32_t idle = std::numeric_limits<std::uint32_t>::max();

struct Lane {
    std::uint32_t next = 0; ///< into the items sorted by queue
    std::uint32_t end = 0;
    std::uint32_t running = idle;
    std::int64_t remaining = 0;
};

/// When the waits of `item` are over, `never` if some producer has not ended yet.
std::int64_t waits_over(const QueueProgram& program, const QueueRun& run, std::uint32_t item, std::int64_t cross_ns) {
    std::int64_t over = 0;
    for (std::uint32_t i = program.first_wait[item]; i < program.first_wait[item + 1]; ++i) {
        const std::int64_t end = run.end_ns[program.producers[i]];
        if (end == unfinished) {
            return never;
        }
        over = std::max(over, end + cross_ns);
    }
    return over;
}

} // namespace

std::int64_t square_root(std::int64_t n) {
    std::int64_t root = 0;
    for (std::int64_t bit = std::int64_t{1} << 31; bit > 0; bit >>= 1) {
        const std::int64_t next = root + bit;
        root = next <= n / next ? next : root;
    }
    return root;
}
std::int64_t duration_within_limits(const Costs& costs, std::uint32_t pass) {
    return std::min(costs.duration_ns(pass), longest_ns);
}
std::int64_t cross_queue_within_limits(const Costs& costs) {
    return std::clamp<std::int64_t>(costs.cross_queue_ns, 0, longest_ns);
}
std::int64_t slowdown_within_limits(const Costs& costs) {
    return std::clamp(costs.slowdown_permille, permille, largest_slowdown_permille);
}

QueueRun run_queues(const QueueProgram& program, const Costs& costs) {
    const std::int64_t cross_ns = cross_queue_within_limits(costs);
    const std::int64_t slowdown = slowdown_within_limits(costs);
    const auto count = static_cast<std::uint32_t>(program.queue.size());
    QueueRun run;
    run.start_ns.assign(count, 0);
    run.end_ns.assign(count, unfinished);

    Scratch<Lane> lanes(program.queue_count);
    for (const std::uint32_t queue : program.queue) {
        ++lanes[queue].end;
    }
    for (std::uint32_t q = 1; q < lanes.size(); ++q) {
        lanes[q].next = lanes[q - 1].end;
        lanes[q].end += lanes[q].next;
    }
    Scratch<std::uint32_t> items(count);
    Scratch<std::uint32_t> fill(program.queue_count);
    std::transform(lanes.begin(), lanes.end(), fill.begin(), [](const Lane& lane) { return lane.next; });
    for (std::uint32_t item = 0; item < count; ++item) {
        items[fill[program.queue[item]]++] = item;
    }

    std::int64_t now = 0;
    for (;;) {
        std::int64_t event = never;
        std::uint32_t running = 0;
        for (Lane& lane : lanes) {
            if (lane.running == idle && lane.next < lane.end) {
                const std::uint32_t item = items[lane.next];
                const std::int64_t over = waits_over(program, run, item, cross_ns);
                if (over <= now) {
                    lane.running = item;
                    lane.remaining = program.duration_ns[item] * slowdown;
                    ++lane.next;
                    run.start_ns[item] = now;
                } else {
                    event = std::min(event, over);
                }
            }
            running += lane.running != idle ? 1 : 0;
        }
        const std::int64_t speed = running > 1 ? permille : slowdown;
        for (const Lane& lane : lanes) {
            if (lane.running != idle) {
                event = std::min(event, now + divided_up(lane.remaining, speed));
            }
        }
        if (event == never) {
            break;
        }
        for (Lane& lane : lanes) {
            if (lane.running != idle) {
                lane.remaining -= (event - now) * speed;
                if (lane.remaining <= 0) {
                    run.end_ns[lane.running] = event;
                    run.makespan_ns = event;
                    lane.running = idle;
                }
            }
        }
        now = event;
    }
    for (std::uint32_t item = 0; item < count; ++item) {
        if (run.end_ns[item] == unfinished) {
            run.start_ns[item] = run.makespan_ns;
            run.end_ns[item] = run.makespan_ns;
        }
    }
    return run;
}

} // namespace tyndall::rg::stages
