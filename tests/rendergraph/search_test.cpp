// Exact scheduling against brute force, and how near the lower bound larger frames come.
#include <algorithm>
#include <iostream>

#include "rendergraph/refine.hpp"
#include "rendergraph/search.hpp"
#include "rendergraph/simulate.hpp"
#include "rendergraph/verify.hpp"
#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/random_costs.hpp"
#include "tests/rendergraph/random_graph.hpp"

namespace tyndall::rg::test {
namespace {

using namespace stages;

/// A frame of `passes` passes that each read one or two of the last outputs; two of three may run on async compute.
/// Buffers, and images that some read sampled and others as storage, so that layouts change between readers.
DeclaredGraph chained_frame(std::uint32_t seed, std::uint32_t passes, std::uint32_t window) {
    std::mt19937 bits(seed);
    const auto below = [&bits](std::uint32_t limit) { return static_cast<std::uint32_t>(bits() % limit); };
    GraphBuilder graph;
    struct Output {
        Image image;
        Buffer buffer;
        bool read = false;
    };
    std::vector<Output> outputs;
    for (std::uint32_t p = 0; p < passes; ++p) {
        const std::string number = std::to_string(p);
        const bool last = p + 1 == passes;
        const bool graphics = below(3) == 0;
        PassBuilder pass = graph.add_pass("p" + number, graphics ? PassKind::graphics : PassKind::compute);
        const auto read = [&](Output& output) {
            output.read = true;
            if (output.buffer.valid()) {
                pass.reads(output.buffer, graphics ? Access::storage_fragment : Access::storage_compute);
            } else if (below(3) == 0) {
                pass.reads(output.image, graphics ? Access::storage_fragment : Access::storage_compute);
            } else {
                pass.reads(output.image, graphics ? Access::sampled_fragment : Access::sampled_compute);
            }
        };
        const auto count = static_cast<std::uint32_t>(outputs.size());
        const std::uint32_t reach = std::min(count, window);
        std::uint32_t earlier = none;
        for (std::uint32_t k = 0; k < 2 && reach > 0 && !last; ++k) {
            const std::uint32_t i = count - 1 - below(reach);
            if (i != earlier && below(6) < (k == 0 ? 5 : 3)) {
                read(outputs[i]);
            }
            earlier = i;
        }
        for (Output& output : outputs) {
            if (last && !output.read) {
                read(output);
            }
        }
        Output output;
        if (last) {
            Buffer result = graph.import_buffer("result", {.size_bytes = 256}, {.has_final = true});
            pass.writes(result, graphics ? Access::storage_fragment : Access::storage_compute);
        } else if (below(2) == 0) {
            output.buffer = graph.create_buffer("b" + number, {.size_bytes = 256U << below(6)});
            pass.writes(output.buffer, graphics ? Access::storage_fragment : Access::storage_compute);
        } else {
            output.image = graph.create_image("i" + number, color_image(16U << below(3), 16));
            pass.writes(output.image, graphics ? Access::color_attachment : Access::storage_compute);
        }
        outputs.push_back(output);
    }
    return graph.finish();
}

QueueTopology three_queues() {
    QueueTopology topology = two_queues();
    topology.queues.push_back({QueueKind::compute, 1, can_compute | can_transfer});
    return topology;
}

/// Everything that a frame's schedules are judged by.
struct Frame {
    Frame(const GraphDesc& desc, const QueueTopology& queues, const Costs& prices)
        : graph(desc), topology(queues), costs(prices), cells(cut_into_cells(graph)),
          order(order_passes(graph, follow_versions(graph, cells))),
          kept(cull(graph, follow_versions(graph, cells), order, true)),
          flow(follow_versions(graph, cells, &kept.pass)), choices(choose_queues(graph, topology, kept, true)),
          work(collect_work(flow, order, kept, choices, topology, costs)) {}

    [[nodiscard]] std::int64_t length_ns(const ItemSchedule& items) const {
        const Schedule scheduled = schedule(graph, topology, cells, flow, assignment_of(work, items, choices));
        return run_queues(program_of(scheduled, costs), costs).makespan_ns;
    }

    const GraphDesc& graph;
    QueueTopology topology;
    Costs costs;
    Cells cells;
    Order order;
    Kept kept;
    Flow flow;
    QueueChoices choices;
    Work work;
};

/// Every choice of queues with every order on each queue that the data flow allows; no bounds. An interleaving that
/// differs only in the order of two neighbours on different queues is visited once, unless `twins` are asked for.
class BruteForce {
public:
    explicit BruteForce(const Frame& frame, bool twins = false)
        : frame_(frame), twins_(twins), placed_(frame.work.pass.size(), false) {}

    std::int64_t shortest_ns() {
        extend();
        return shortest_;
    }
    std::uint64_t visited = 0;

private:
    void extend() {
        const Work& work = frame_.work;
        if (sequence_.items.size() == work.pass.size()) {
            ++visited;
            shortest_ = std::min(shortest_, frame_.length_ns(merged(work, sequence_)));
            return;
        }
        for (std::uint32_t item = 0; item < work.pass.size(); ++item) {
            const auto begin = work.in.begin() + work.first_in[item];
            const auto end = work.in.begin() + work.first_in[item + 1];
            if (placed_[item] || std::any_of(begin, end, [&](std::uint32_t from) { return !placed_[from]; })) {
                continue;
            }
            for (std::uint32_t queue = 0; queue < work.queue_count; ++queue) {
                const bool twin = !twins_ && !sequence_.items.empty() && sequence_.queue.back() != queue &&
                                  item < sequence_.items.back() && std::find(begin, end, sequence_.items.back()) == end;
                if ((work.allowed[item] >> queue & 1U) == 0 || twin) {
                    continue;
                }
                placed_[item] = true;
                sequence_.items.push_back(item);
                sequence_.queue.push_back(queue);
                extend();
                sequence_.items.pop_back();
                sequence_.queue.pop_back();
                placed_[item] = false;
            }
        }
    }

    const Frame& frame_;
    bool twins_;
    std::vector<bool> placed_;
    ItemSchedule sequence_;
    std::int64_t shortest_ = std::numeric_limits<std::int64_t>::max();
};

TEST(ExactSchedule, NeighboursOnDifferentQueuesMayBeSwapped) {
    // What lets brute force and search leave out interleavings: they change nothing.
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        const DeclaredGraph declared = chained_frame(seed, 6, 4);
        const Frame frame(declared.desc, two_queues(), random_costs(seed, 6, true));
        BruteForce once(frame);
        BruteForce all(frame, true);
        EXPECT_EQ(once.shortest_ns(), all.shortest_ns()) << seed;
        EXPECT_LE(once.visited, all.visited);
    }
}

TEST(ExactSchedule, EqualsBruteForceOnEveryFrameOfUpToNinePasses) {
    const std::uint32_t seeds = random_graph_count(400);
    std::uint64_t visited = 0;
    std::uint64_t most = 0;
    std::uint32_t list_was_best = 0;
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        const std::uint32_t passes = 3 + seed % 7;
        const DeclaredGraph declared = chained_frame(seed, passes, 4);
        const QueueTopology topology = seed % 3 == 0 && passes < 8 ? three_queues() : two_queues();
        const Costs costs = random_costs(seed, passes, true);
        const Frame frame(declared.desc, topology, costs);
        BruteForce judge(frame);
        const std::int64_t shortest = judge.shortest_ns();
        EXPECT_LE(lower_bound_ns(frame.work, urgency_of(frame.work, costs), costs), shortest) << seed;
        visited += judge.visited;
        most = std::max(most, judge.visited);
        const auto refined =
            refine(declared.desc, topology, estimate_memory(declared.desc), {}, costs, nullptr, 10'000'000);
        ASSERT_TRUE(refined.has_value()) << seed;
        EXPECT_TRUE(refined->shortest) << seed;
        EXPECT_EQ(simulate(declared.desc, refined->plan, costs).makespan_ns, shortest) << seed;
        EXPECT_TRUE(verify(declared.desc, refined->plan).empty()) << seed;
        list_was_best += frame.length_ns(list_schedule(frame.work, urgency_of(frame.work, costs), costs)) == shortest;
    }
    std::cout << seeds << " frames, " << visited << " schedules by brute force (at most " << most
              << " of one frame); the list schedule was already best in " << list_was_best << "\n";
    EXPECT_LT(list_was_best, seeds); // else the search is not needed
}

TEST(ExactSchedule, EqualLengthsGoToTheLowestPeakOfMemory) {
    // Two chains of two passes on graphics, declared step by step; fog beside them. Any order of the chains is as long,
    // but one after the other needs one big image at a time.
    GraphBuilder graph;
    Image first = graph.create_image("first", color_image(256, 256));
    Image second = graph.create_image("second", color_image(256, 256));
    Buffer of_first = graph.create_buffer("of first", {.size_bytes = 256});
    Buffer of_second = graph.create_buffer("of second", {.size_bytes = 256});
    Buffer fog = graph.create_buffer("fog", {.size_bytes = 256});
    Image output = graph.import_image("output", color_image(), left_for_host());
    graph.add_pass("draw first", PassKind::graphics).writes(first, Access::color_attachment);
    graph.add_pass("draw second", PassKind::graphics).writes(second, Access::color_attachment);
    graph.add_pass("use first", PassKind::graphics)
        .reads(first, Access::sampled_fragment)
        .writes(of_first, Access::storage_fragment);
    graph.add_pass("use second", PassKind::graphics)
        .reads(second, Access::sampled_fragment)
        .writes(of_second, Access::storage_fragment);
    graph.add_pass("fog", PassKind::compute).writes(fog, Access::storage_compute);
    graph.add_pass("apply", PassKind::graphics)
        .reads(of_first, Access::storage_fragment)
        .reads(of_second, Access::storage_fragment)
        .reads(fog, Access::storage_fragment)
        .writes(output, Access::color_attachment);
    const GraphDesc desc = graph.finish().desc;
    Costs costs;
    costs.of_pass.assign(desc.passes.size(), {.mean_ns = 1'000'000});
    const MemoryRequirements memory = estimate_memory(desc);
    const auto listed = compile(desc, two_queues(), memory, {}, costs);
    const auto refined = refine(desc, two_queues(), memory, {}, costs);
    const auto peak = [&](const Plan& plan) {
        VkDeviceSize most = 0;
        for (const MemorySample& sample : simulate(desc, plan, costs).memory) {
            most = std::max(most, sample.bytes);
        }
        return most;
    };
    const VkDeviceSize big = memory.of_resource[first.resource].size_bytes;
    EXPECT_EQ(simulate(desc, refined->plan, costs).makespan_ns, simulate(desc, *listed, costs).makespan_ns);
    EXPECT_GE(peak(*listed), 2 * big);
    EXPECT_LT(peak(refined->plan), 2 * big);
    // It stays as the previous plan.
    const auto next = compile(desc, two_queues(), memory, {}, costs, &refined->plan);
    EXPECT_EQ(to_text(desc, *next), to_text(desc, refined->plan));
}

/// Excess over the lower bound in permille, sorted.
std::int64_t median(std::vector<std::int64_t>& values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

TEST(LargeSchedules, MedianNearTheLowerBound) {
    const std::uint32_t seeds = random_graph_count(40);
    for (const std::int64_t slowdown : {1'000, 1'250, 1'500, 2'000}) {
        std::vector<std::int64_t> listed;
        std::vector<std::int64_t> refined;
        std::int64_t worst = 0;
        for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
            const std::uint32_t passes = 10 + seed % 60;
            const DeclaredGraph declared = chained_frame(seed, passes, 16);
            Costs costs = random_costs(seed, passes, true);
            costs.slowdown_permille = slowdown;
            const Frame frame(declared.desc, two_queues(), costs);
            const std::int64_t bound = lower_bound_ns(frame.work, urgency_of(frame.work, costs), costs);
            const auto excess = [&](const Plan& plan) {
                return (simulate(declared.desc, plan, costs).makespan_ns - bound) * 1'000 / bound;
            };
            const MemoryRequirements memory = estimate_memory(declared.desc);
            const auto first = compile(declared.desc, two_queues(), memory, {}, costs);
            const auto better = refine(declared.desc, two_queues(), memory, {}, costs, &*first, 20'000);
            listed.push_back(excess(*first));
            refined.push_back(excess(better->plan));
            ASSERT_LE(refined.back(), listed.back()) << seed;
            ASSERT_GE(refined.back(), 0) << seed;
            worst = std::max(worst, refined.back());
        }
        const std::int64_t of_list = median(listed);
        const std::int64_t of_refined = median(refined);
        std::cout << "slowdown " << slowdown << ": permille over the lower bound, median of " << seeds
                  << " frames of 10 to 69 passes: list " << of_list << ", refined " << of_refined << ", worst refined "
                  << worst << "\n";
        if (slowdown == 1'000) {
            EXPECT_LE(of_refined, 100);
        }
    }
}

} // namespace
} // namespace tyndall::rg::test
