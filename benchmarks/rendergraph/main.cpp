// Runs the benchmarks and, after them, prints how each family's time grows with the number of passes.
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace {

struct Sample {
    double passes = 0.0;
    double time = 0.0; ///< of the whole, processor time
};

/// The exponent e of time = c passes^e, least squares of the logarithms.
double exponent(const std::vector<Sample>& samples) {
    const auto count = static_cast<double>(samples.size());
    double mean_x = 0.0;
    double mean_y = 0.0;
    for (const Sample& sample : samples) {
        mean_x += std::log(sample.passes) / count;
        mean_y += std::log(sample.time) / count;
    }
    double xy = 0.0;
    double xx = 0.0;
    for (const Sample& sample : samples) {
        const double x = std::log(sample.passes) - mean_x;
        xy += x * (std::log(sample.time) - mean_y);
        xx += x * x;
    }
    return xy / xx;
}

class GrowthReporter : public benchmark::ConsoleReporter {
public:
    void ReportRuns(const std::vector<Run>& runs) override {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& run : runs) {
            const bool of_passes = run.counters.find("per_pass") != run.counters.end();
            if (run.run_type == Run::RT_Iteration && !run.error_occurred && of_passes) {
                families_[run.run_name.function_name].push_back(
                    {std::stod(run.run_name.args), run.GetAdjustedCPUTime()});
            }
        }
    }
    void Finalize() override {
        ConsoleReporter::Finalize();
        for (const auto& [name, samples] : families_) {
            if (samples.size() > 2) {
                std::printf("%-32s grows with the passes to the power of %.3f\n", name.c_str(), exponent(samples));
            }
        }
    }

private:
    std::map<std::string, std::vector<Sample>> families_;
};

} // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
        return 1;
    }
    GrowthReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    benchmark::Shutdown();
    return 0;
}
