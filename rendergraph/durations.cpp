// Measured durations, frame after frame.
// In: timestamps of a frame and the plan that it ran. Out: mean and deviation of each pass alone.
#include "rendergraph/durations.hpp"

#include <algorithm>
#include <cmath>

#include "rendergraph/queue_model.hpp"

namespace tyndall::rg {
namespace {

using namespace stages;

constexpr std::int64_t unmeasured = -1;

std::int64_t nanoseconds(double milliseconds) {
    constexpr double ns_per_ms = 1e6;
    const double ns = milliseconds * ns_per_ms;
    return ns > 0.0 && ns < static_cast<double>(longest_ns) ? std::llround(ns) : (ns > 0.0 ? longest_ns : 0);
}

/// By place in the plan: how long passes of other queues ran during the pass, each moment counted once.
std::vector<std::int64_t> overlaps(const Plan& plan, std::span<const std::int64_t> start_ns,
                                   std::span<const std::int64_t> end_ns) {
    std::vector<std::uint32_t> by_start;
    for (std::uint32_t i = 0; i < plan.passes.size(); ++i) {
        if (start_ns[i] != unmeasured) {
            by_start.push_back(i);
        }
    }
    std::stable_sort(by_start.begin(), by_start.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return start_ns[a] < start_ns[b]; });
    std::vector<std::int64_t> overlap(plan.passes.size(), 0);
    for (const std::uint32_t i : by_start) {
        std::int64_t covered_to = start_ns[i];
        for (const std::uint32_t other : by_start) {
            if (start_ns[other] >= end_ns[i]) {
                break;
            }
            if (plan.passes[other].queue != plan.passes[i].queue && end_ns[other] > covered_to) {
                const std::int64_t from = std::max(covered_to, start_ns[other]);
                const std::int64_t to = std::min(end_ns[i], end_ns[other]);
                overlap[i] += std::max<std::int64_t>(to - from, 0);
                covered_to = std::max(covered_to, to);
            }
        }
    }
    return overlap;
}

} // namespace

Durations::Durations(DurationSettings settings) : settings_(std::move(settings)) {}

void Durations::add(Average& average, std::int64_t value) const {
    ++average.samples;
    const std::int64_t weight =
        std::clamp<std::int64_t>(std::max(settings_.weight_permille, permille / average.samples), 1, permille);
    const std::int64_t difference = value - average.mean;
    average.mean += difference * weight / permille;
    // West 1979, incremental variance with weights.
    constexpr std::int64_t ns_per_us = 1'000;
    const std::int64_t us = difference / ns_per_us;
    average.variance_us2 += us * us * weight / permille;
    average.variance_us2 -= average.variance_us2 * weight / permille;
}

std::int64_t Durations::slowdown_permille() const {
    Costs costs = settings_.defaults;
    costs.slowdown_permille = slowdown_permille_.samples > 0 ? slowdown_permille_.mean : costs.slowdown_permille;
    return slowdown_within_limits(costs);
}

void Durations::add_frame(const GraphDesc& graph, const Plan& plan, std::span<const PassTiming> timings) {
    std::vector<std::uint32_t> place_of(graph.passes.size(), none);
    for (std::uint32_t i = 0; i < plan.passes.size(); ++i) {
        place_of[plan.passes[i].pass] = i;
    }
    std::vector<std::int64_t> start_ns(plan.passes.size(), unmeasured);
    std::vector<std::int64_t> end_ns(plan.passes.size(), unmeasured);
    for (const PassTiming& timing : timings) {
        if (timing.pass < place_of.size() && place_of[timing.pass] != none) {
            start_ns[place_of[timing.pass]] = nanoseconds(timing.start_ms);
            end_ns[place_of[timing.pass]] = nanoseconds(timing.start_ms) + nanoseconds(timing.duration_ms);
        }
    }
    const std::vector<std::int64_t> overlap = overlaps(plan, start_ns, end_ns);
    bool any_overlap = false;
    for (std::uint32_t i = 0; i < plan.passes.size(); ++i) {
        const std::int64_t duration = end_ns[i] - start_ns[i];
        if (start_ns[i] == unmeasured || duration <= 0) {
            continue;
        }
        const std::string& name = graph.passes[plan.passes[i].pass].name;
        auto found = passes_.find(name);
        if (found == passes_.end()) {
            found = passes_.emplace(name, Pass{}).first;
        }
        Pass& pass = found->second;
        const std::int64_t alone_part = duration - overlap[i];
        if (overlap[i] == 0) {
            add(pass.alone, duration);
        } else {
            any_overlap = true;
            // What was not done alone was done in the shared part: their ratio is the slowdown.
            const std::int64_t shared_work = pass.alone.mean - alone_part;
            if (pass.alone.samples > 0 && 2 * overlap[i] > duration && shared_work > 0) {
                add(slowdown_permille_,
                    std::clamp(overlap[i] * permille / shared_work, permille, largest_slowdown_permille));
            }
        }
        add(pass.any, alone_part + overlap[i] * permille / slowdown_permille());
    }
    overlapped_frames_ = any_overlap ? overlapped_frames_ + 1 : 0;
    add_waits(plan, start_ns, end_ns);
}

void Durations::add_waits(const Plan& plan, std::span<const std::int64_t> start_ns,
                          std::span<const std::int64_t> end_ns) {
    std::vector<std::int64_t> queue_free(plan.topology.queues.size(), 0);
    for (const Batch& batch : plan.batches) {
        std::int64_t latest = unmeasured;
        for (const BatchWait& wait : batch.waits) {
            const Batch& producer = plan.batches[wait.batch];
            latest = std::max(latest, end_ns[producer.first_pass + producer.pass_count - 1]);
        }
        const std::int64_t begin = start_ns[batch.first_pass];
        // Only where the queue stood idle for the wait is the gap the wait's cost.
        if (latest != unmeasured && begin >= latest && queue_free[batch.queue] <= latest) {
            add(cross_queue_ns_, begin - latest);
        }
        queue_free[batch.queue] = std::max(queue_free[batch.queue], end_ns[batch.first_pass + batch.pass_count - 1]);
    }
}

Costs Durations::costs(const GraphDesc& graph) const {
    constexpr std::int64_t ns_per_us = 1'000;
    Costs costs = settings_.defaults;
    costs.of_pass.assign(graph.passes.size(), PassCost{});
    for (std::size_t i = 0; i < graph.passes.size(); ++i) {
        if (const auto found = passes_.find(graph.passes[i].name); found != passes_.end()) {
            costs.of_pass[i] = {found->second.any.mean, square_root(found->second.any.variance_us2) * ns_per_us};
        }
    }
    costs.slowdown_permille = slowdown_permille();
    costs.cross_queue_ns = cross_queue_ns_.samples > 0 ? cross_queue_ns_.mean : costs.cross_queue_ns;
    return costs;
}

bool Durations::calibration_due() const {
    return settings_.calibrate_every > 0 && overlapped_frames_ >= settings_.calibrate_every;
}

void Durations::clear() {
    passes_.clear();
    slowdown_permille_ = {};
    cross_queue_ns_ = {};
    overlapped_frames_ = 0;
}

} // namespace tyndall::rg
