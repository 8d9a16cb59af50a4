#include "samples/precision/integrator_twin.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tyndall::samples {
namespace {

using volumetrics::Integrator;

/// A middle on the axis of optical depth, measured from the near side of the slice that is integrated.
struct Node {
    double at;
    double source_function;
};

class Parabola {
public:
    explicit Parabola(const std::vector<TwinSlice>& slices) : slices_(slices) {
        depth_.push_back(0.0);
        for (const TwinSlice& slice : slices) {
            depth_.push_back(depth_.back() + slice.extinction_per_m * slice.length_m);
        }
    }

    /// Mean over slice k of the source per metre, weighted with the transmittance since its near side.
    [[nodiscard]] double mean_source(std::size_t k) const {
        const TwinSlice& here = slices_[k];
        const double x = depth_[k + 1] - depth_[k];
        if (x < 1e-12) {
            return here.source_per_m;
        }
        const std::size_t last = slices_.size() - 1;
        const Node a = node(k > 0 ? k - 1 : 2, k);
        const Node b = node(k, k);
        const Node c = node(k < last ? k + 1 : last - 2, k);
        // Moments of the weight e^-t over [0, x]; by parts, or where that cancels by Simpson's rule over fine
        // intervals.
        const double first = moment(1, x);
        const double second = moment(2, x);
        const double slope = (b.source_function - a.source_function) / (b.at - a.at);
        const double bend = ((c.source_function - b.source_function) / (c.at - b.at) - slope) / (c.at - a.at);
        const double mean =
            b.source_function + (first - b.at) * slope + (second - (a.at + b.at) * first + a.at * b.at) * bend;
        const auto [low, high] = std::minmax({a.source_function, b.source_function, c.source_function});
        return std::clamp(mean, low, high) * here.extinction_per_m;
    }

private:
    [[nodiscard]] static double moment(int power, double x) {
        const int intervals = 64;
        double sum = 0.0;
        double weight = 0.0;
        for (int i = 0; i <= intervals; ++i) {
            const double t = x * i / intervals;
            const double simpson = i == 0 || i == intervals ? 1.0 : (i % 2 == 0 ? 2.0 : 4.0);
            weight += simpson * std::exp(-t);
            sum += simpson * std::exp(-t) * std::pow(t, power);
        }
        if (x < 1.0) {
            return sum / weight;
        }
        const double b = x / std::expm1(x);
        return power == 1 ? 1.0 - b : 2.0 - (2.0 + x) * b;
    }

    [[nodiscard]] double middle(std::size_t k) const {
        const std::size_t last = slices_.size() - 1;
        const double here = slices_[k].extinction_per_m;
        const double before = k > 0 ? slices_[k - 1].extinction_per_m : 2.0 * here - slices_[1].extinction_per_m;
        const double after = k < last ? slices_[k + 1].extinction_per_m : 2.0 * here - slices_[k - 1].extinction_per_m;
        const double dt = slices_[k].length_m;
        const double ratio = slices_[1].length_m / slices_[0].length_m;
        const double to_before = 0.5 * (1.0 + 1.0 / ratio);
        const double to_after = 0.5 * (1.0 + ratio);
        const double change =
            ((here - before) * to_after / to_before + (after - here) * to_before / to_after) / (to_before + to_after);
        return depth_[k] + dt * (0.5 * here - 0.125 * std::clamp(change, -3.0 * here, 3.0 * here));
    }

    [[nodiscard]] Node node(std::size_t i, std::size_t k) const {
        const TwinSlice& here = slices_[k];
        const double ratio = slices_[i].extinction_per_m / here.extinction_per_m;
        const TwinSlice& used = ratio <= 4.0 && ratio >= 0.25 ? slices_[i] : here;
        return {middle(i) - depth_[k], used.source_per_m / used.extinction_per_m};
    }

    const std::vector<TwinSlice>& slices_;
    std::vector<double> depth_; ///< at the boundaries
};

} // namespace

TwinResult integrate(volumetrics::Integrator integrator, const std::vector<TwinSlice>& slices) {
    const Parabola parabola(slices);
    TwinResult sum;
    for (std::size_t k = 0; k < slices.size(); ++k) {
        const double x = slices[k].extinction_per_m * slices[k].length_m;
        const double transmittance = std::exp(-sum.optical_depth);
        const double exact = x > 0.0 ? -std::expm1(-x) / x : 1.0;
        double mean = slices[k].source_per_m;
        switch (integrator) {
        case Integrator::euler: break;
        case Integrator::half_slice: mean *= std::exp(-0.5 * x); break;
        case Integrator::exponential: mean *= exact; break;
        case Integrator::exponential_quadratic: mean = parabola.mean_source(k) * exact; break;
        }
        sum.radiance += transmittance * mean * slices[k].length_m;
        sum.optical_depth += x;
    }
    return sum;
}

} // namespace tyndall::samples
