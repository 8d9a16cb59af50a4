// What passes were measured to last, as costs for the next compile.
#pragma once

#include <map>
#include <span>
#include <string>

#include "rendergraph/costs.hpp"
#include "rendergraph/executor.hpp"
#include "rendergraph/plan.hpp"

namespace tyndall::rg {

struct DurationSettings {
    /// Weight of a new sample against all before it; the first few count equally.
    std::int64_t weight_permille = 100;
    /// While plans overlap, a frame on one queue is asked for every so many frames, to measure passes alone; 0: never.
    /// Such a frame changes the plan twice, and with it memory: not while a picture is watched.
    std::uint32_t calibrate_every = 0;
    /// Slowdown, cost of a wait and thresholds, until the first two are measured.
    Costs defaults = {};
};

/// Exponentially weighted mean and variance of each pass, by name. Durations are of passes alone on the device: the
/// part of a pass that ran beside passes of other queues is divided by the slowdown. Where passes were also measured
/// alone, the slowdown itself is measured, and so is the cost of a wait between queues. After the conversion from
/// milliseconds everything is whole nanoseconds, so that the same timings give the same costs.
class Durations {
public:
    explicit Durations(DurationSettings settings = {});

    /// `timings` as Executor::timings() gives them, of a frame that ran `plan`. Each frame once. O(passes squared).
    void add_frame(const GraphDesc& graph, const Plan& plan, std::span<const PassTiming> timings);

    /// Costs of this graph's passes; those never measured are left unknown. O(passes log names).
    [[nodiscard]] Costs costs(const GraphDesc& graph) const;

    /// The next frame should be compiled with CompileOptions::async off.
    [[nodiscard]] bool calibration_due() const;

    /// Forgets everything, as after a change of resolution or device clocks.
    void clear();

private:
    struct Average {
        std::int64_t mean = 0;
        std::int64_t variance_us2 = 0; ///< of values in nanoseconds, in square microseconds
        std::int64_t samples = 0;
    };
    struct Pass {
        Average any;   ///< from all frames, freed of the slowdown
        Average alone; ///< from moments when nothing ran beside it
    };
    void add(Average& average, std::int64_t value) const;
    void add_waits(const Plan& plan, std::span<const std::int64_t> start_ns, std::span<const std::int64_t> end_ns);
    [[nodiscard]] std::int64_t slowdown_permille() const;

    DurationSettings settings_;
    std::map<std::string, Pass, std::less<>> passes_;
    Average slowdown_permille_;
    Average cross_queue_ns_;
    std::uint32_t overlapped_frames_ = 0; ///< since the last frame on one queue
};

} // namespace tyndall::rg
