// The frame that compile, verify and recording are measured with: each pass reads 2 of the last 16 outputs and writes
// one, a quarter is free to run on async compute, a tenth has no consumer.
#pragma once

#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "rendergraph/costs.hpp"
#include "rendergraph/graph.hpp"
#include "rendergraph/plan.hpp"

namespace tyndall::rg::bench {

inline std::vector<std::string> names(const char* kind, std::size_t count) {
    std::vector<std::string> out;
    for (std::size_t i = 0; i < count; ++i) {
        out.push_back(kind + std::to_string(i));
    }
    return out;
}

struct RecordsNothing {
    void operator()(PassContext&, Image output) const { benchmark::DoNotOptimize(&output); }
};

/// `body` is what each pass but the last records, given its output.
template <typename Body = RecordsNothing>
DeclaredGraph generic_frame(const std::vector<std::string>& pass_names, const std::vector<std::string>& image_names,
                            Body body = {}) {
    std::minstd_rand random(1); // cheap, so that declaring is what is timed
    GraphBuilder graph;
    const auto count = static_cast<std::uint32_t>(pass_names.size());
    std::vector<Image> recent;
    for (std::uint32_t i = 0; i < count; ++i) {
        Image out =
            graph.create_image(image_names[i], {.format = VK_FORMAT_R16G16B16A16_SFLOAT, .extent = {256, 256, 1}});
        PassBuilder pass = graph.add_pass(pass_names[i], PassKind::compute);
        for (std::uint32_t k = 0; k < 2 && recent.size() > k; ++k) {
            const std::size_t back = (random() % (std::min<std::size_t>(recent.size(), 16) / 2 + 1)) * 2 + k;
            pass.reads(recent[recent.size() - 1 - std::min(back, recent.size() - 1 - k)], Access::sampled_compute);
        }
        pass.writes(out, Access::storage_compute).executes([out, body](PassContext& ctx) { body(ctx, out); });
        if (random() % 4 != 0) {
            pass.on_queue(QueueWish::graphics);
        }
        if (random() % 10 != 0) {
            recent.push_back(out); // the others feed nothing
        }
    }
    Buffer result = graph.import_buffer("result", {.size_bytes = 256}, {.has_final = true});
    PassBuilder last = graph.add_pass("last", PassKind::compute);
    for (std::size_t i = 0; i < 16 && i < recent.size(); ++i) {
        last.reads(recent[recent.size() - 1 - i], Access::sampled_compute);
    }
    last.writes(result, Access::storage_compute);
    return graph.finish();
}

/// Until the executor has made its objects and grown its lists.
inline constexpr std::uint32_t frames_to_settle = 10;

inline const QueueTopology two_queues = {{{QueueKind::graphics, 0, can_graphics | can_compute | can_transfer},
                                          {QueueKind::compute, 1, can_compute | can_transfer}}};

/// Every pass measured, between 20 and 220 us, so that the list schedule is made, and it overlaps.
inline Costs measured_costs(std::size_t passes) {
    std::minstd_rand random(1);
    Costs costs;
    for (std::size_t i = 0; i <= passes; ++i) {
        costs.of_pass.push_back(
            {.mean_ns = 20'000 + static_cast<std::int64_t>(random() % 200'000), .deviation_ns = 1'000});
    }
    return costs;
}

inline void report_per_pass(benchmark::State& state) {
    state.counters["per_pass"] =
        benchmark::Counter(static_cast<double>(state.range(0)),
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

} // namespace tyndall::rg::bench
