#include "samples/precision/orders.hpp"

#include <cmath>
#include <cstddef>
#include <cstdio>

namespace tyndall::samples {
namespace {

using volumetrics::Integrator;

double extinction(double t, double density) {
    return density * (2.0 + 1.6 * std::sin(7.0 * t));
}
double source_function(double t) {
    return 1.0 + 0.5 * std::cos(5.0 * t);
}

} // namespace

double smooth_radiance(double density) {
    const int intervals = 400000; // Simpson's rule, with the closed form of optical depth
    const auto integrand = [&](double t) {
        const double tau = density * (2.0 * t + 1.6 / 7.0 * (1.0 - std::cos(7.0 * t)));
        return std::exp(-tau) * extinction(t, density) * source_function(t);
    };
    double sum = integrand(0.0) + integrand(1.0);
    for (int i = 1; i < intervals; ++i) {
        sum += (i % 2 == 0 ? 2.0 : 4.0) * integrand(static_cast<double>(i) / intervals);
    }
    return sum / intervals / 3.0;
}

std::vector<TwinSlice> smooth_column(Integrator integrator, int count, double growth, double density) {
    std::vector<TwinSlice> slices;
    const double ratio = std::pow(growth, 1.0 / (count - 1));
    double length = ratio == 1.0 ? 1.0 / count : (ratio - 1.0) / (std::pow(ratio, count) - 1.0);
    double near = 0.0;
    for (int k = 0; k < count; ++k) {
        const double middle = near + 0.5 * length;
        double mean = extinction(middle, density);
        if (integrator == Integrator::exponential_quadratic) {
            mean = (extinction(near, density) + 4.0 * mean + extinction(near + length, density)) / 6.0;
        }
        slices.push_back({mean, mean * source_function(middle), length});
        near += length;
        length *= ratio;
    }
    return slices;
}

double smooth_error(Integrator integrator, int count, double growth, double density, double exact) {
    return std::abs(integrate(integrator, smooth_column(integrator, count, growth, density)).radiance / exact - 1.0);
}

double fitted_order(std::span<const double> errors) {
    for (std::size_t i = errors.size() - 1; i >= 2; --i) {
        const double fine = std::log2(errors[i - 1] / errors[i]);
        const double coarse = std::log2(errors[i - 2] / errors[i - 1]);
        if (errors[i] > 1e-13 && std::abs(fine - coarse) <= 0.1) {
            return 0.5 * (fine + coarse);
        }
    }
    return -1.0;
}

std::vector<OrderRow> measured_orders() {
    std::vector<OrderRow> rows;
    for (const double density : {1.0, 20.0}) {
        const double exact = smooth_radiance(density);
        for (const double growth : {1.0, 4.0}) {
            for (std::size_t i = 0; i < integrators.size(); ++i) {
                OrderRow row{integrator_names[i], density, growth, {}, integrator_orders[i]};
                for (int count = OrderRow::least_slices; count <= 4096; count *= 2) {
                    row.errors.push_back(smooth_error(integrators[i], count, growth, density, exact));
                }
                row.order = fitted_order(row.errors);
                rows.push_back(std::move(row));
            }
        }
    }
    return rows;
}

std::string to_table(std::span<const OrderRow> rows) {
    std::array<char, 128> text{};
    std::snprintf(text.data(), text.size(), "%-22s %7s %11s  %s\n", "integrator", "density", "last/first",
                  "relative error at 16, 32, ..., 4,096 slices, and the order fitted");
    std::string table = text.data();
    for (const OrderRow& row : rows) {
        std::snprintf(text.data(), text.size(), "%-22s %7g %11g ", row.integrator, row.density, row.growth);
        table += text.data();
        for (const double error : row.errors) {
            std::snprintf(text.data(), text.size(), " %.1e", error);
            table += text.data();
        }
        std::snprintf(text.data(), text.size(), "  %.2f (%g)\n", row.order, row.expected);
        table += text.data();
    }
    return table;
}

} // namespace tyndall::samples
