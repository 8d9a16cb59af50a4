#include "samples/tyndall/precision_causes.hpp"

#include <algorithm>
#include <array>

namespace tyndall::samples {
namespace {

/// A cause of error, and the configuration with far less of it.
struct Cause {
    const char* name;
    void (*remove)(PrecisionConfiguration& configuration);
};
constexpr std::array causes{
    Cause{"none removed", [](PrecisionConfiguration&) {}},
    Cause{"4 times the slices", [](PrecisionConfiguration& c) { c.slices = std::min(512U, 4 * c.slices); }},
    Cause{"4 times the columns",
          [](PrecisionConfiguration& c) {
              c.grid = {std::min(1024U, 2 * c.grid.width), std::min(1024U, 2 * c.grid.height)};
          }},
    Cause{"exact lit fraction",
          [](PrecisionConfiguration& c) { c.visibility = volumetrics::SunVisibility::lit_fraction; }},
    Cause{"16 times the shadow map", [](PrecisionConfiguration& c) { c.cascade_texels *= 4; }},
    Cause{"64 frames averaged", [](PrecisionConfiguration& c) { c.averaged_frames = 64; }},
    Cause{"fp32 storage", [](PrecisionConfiguration& c) { c.storage = volumetrics::StorageFormat::fp32; }},
    Cause{"quadratic integrator",
          [](PrecisionConfiguration& c) { c.integrator = volumetrics::Integrator::exponential_quadratic; }}};

CauseRow to_row(const std::string& cause, const std::string& physics, std::span<const PrecisionRow> rows) {
    CauseRow made{.scene = rows.front().scene, .cause = cause, .physics = physics};
    for (const PrecisionRow& row : rows) {
        if (row.physics == physics) {
            (row.frame == 1 ? made.first : made.last) = row.error;
        }
    }
    made.fog_ms = rows.front().clocked_ms;
    made.frame_ms = rows.front().frame_ms;
    return made;
}

} // namespace

tl::expected<std::vector<CauseRow>, std::string> list_causes(Bench& bench, const PrecisionConfiguration& configuration,
                                                             const std::function<void(const std::string&)>& progress) {
    std::vector<CauseRow> rows;
    for (const Cause& cause : causes) {
        PrecisionConfiguration better = configuration;
        cause.remove(better);
        progress(cause.name);
        const auto measured = measure(bench, better);
        if (!measured) {
            return tl::unexpected(measured.error());
        }
        rows.push_back(to_row(cause.name, full_physics, measured->rows));
        if (&cause == &causes.front()) {
            for (const TruthImage& truth : bench.truths) {
                if (truth.physics != full_physics) {
                    rows.push_back(to_row(truth.physics, truth.physics, measured->rows));
                }
            }
        }
    }
    return rows;
}

} // namespace tyndall::samples
