#include "samples/tyndall/precision_orders.hpp"

#include <array>
#include <cstdio>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/file_io.hpp"
#include "samples/precision/orders.hpp"

namespace tyndall::samples {
namespace {

/// A line a row and number of slices.
std::string to_csv(std::span<const OrderRow> rows) {
    std::string text = "integrator,density,last_by_first,slices,relative_error,order,expected\n";
    std::array<char, 128> line{};
    for (const OrderRow& row : rows) {
        int slices = OrderRow::least_slices;
        for (const double error : row.errors) {
            std::snprintf(line.data(), line.size(), "%s,%g,%g,%d,%.6e,%.4f,%g\n", row.integrator, row.density,
                          row.growth, slices, error, row.order, row.expected);
            text += line.data();
            slices *= 2;
        }
    }
    return text;
}

std::string to_json(std::span<const OrderRow> rows) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const OrderRow& row : rows) {
        list.push_back({{"integrator", row.integrator},
                        {"density", row.density},
                        {"last_by_first", row.growth},
                        {"least_slices", OrderRow::least_slices},
                        {"relative_errors", row.errors},
                        {"order", row.order},
                        {"expected", row.expected}});
    }
    return nlohmann::ordered_json{{"rows", list}}.dump(2) + "\n";
}

} // namespace

int run_orders(const PrecisionArguments& arguments) {
    const std::vector<OrderRow> rows = measured_orders();
    if (arguments.folder) {
        for (const auto& [name, text] :
             {std::pair{"orders.csv", to_csv(rows)}, std::pair{"orders.json", to_json(rows)}}) {
            const auto written = engine::replace_file(*arguments.folder / name, std::as_bytes(std::span(text)));
            if (!written) {
                std::fprintf(stderr, "tyndall: %s\n", written.error().message.c_str());
                return exit_bad_input;
            }
        }
    }
    std::fputs((arguments.json ? to_json(rows) : to_table(rows)).c_str(), stdout);
    return exit_ok;
}

} // namespace tyndall::samples
