#include "samples/tyndall/precision_ladder.hpp"

#include <algorithm>
#include <cstdint>

namespace tyndall::samples {
namespace {

using volumetrics::Integrator;
using volumetrics::SunVisibility;

/// Steps of factors of two, so that slopes can be read from them.
struct Ladder {
    std::vector<Integrator> integrators;
    std::vector<SunVisibility> visibilities;
    std::vector<Size> grids;
    std::vector<std::uint32_t> slices;
};

Ladder long_ladder() {
    return {.integrators = {Integrator::euler, Integrator::half_slice, Integrator::exponential,
                            Integrator::exponential_quadratic},
            .visibilities = {SunVisibility::one_tap, SunVisibility::n_taps, SunVisibility::prefiltered,
                             SunVisibility::lit_fraction},
            .grids = {{40, 23}, {80, 45}, {160, 90}, {320, 180}},
            .slices = {16, 32, 64, 128, 256}};
}

Ladder short_ladder() {
    return {.integrators = {Integrator::half_slice, Integrator::exponential, Integrator::exponential_quadratic},
            .visibilities = {SunVisibility::one_tap, SunVisibility::prefiltered, SunVisibility::lit_fraction},
            .grids = {{40, 23}, {160, 90}},
            .slices = {16, 64}};
}

std::uint64_t froxels(const PrecisionConfiguration& configuration) {
    return std::uint64_t{configuration.grid.width} * configuration.grid.height * configuration.slices;
}

template <class T>
std::vector<T> first_given(const std::vector<T>& given, const std::vector<T>& otherwise) {
    return given.empty() ? otherwise : given;
}

} // namespace

PrecisionConfiguration own_configuration(const PrecisionScene& scene) {
    const volumetrics::Settings& settings = scene.fog.settings;
    return {.integrator = settings.integrator,
            .visibility = settings.visibility.method,
            .grid = {settings.grid.width, settings.grid.height},
            .slices = settings.grid.slices,
            .storage = settings.storage};
}

volumetrics::Fog configured_fog(const PrecisionScene& scene, const PrecisionConfiguration& configuration) {
    volumetrics::Fog fog = scene.fog;
    fog.settings.integrator = configuration.integrator;
    fog.settings.visibility.method = configuration.visibility;
    fog.settings.grid.width = configuration.grid.width;
    fog.settings.grid.height = configuration.grid.height;
    fog.settings.grid.slices = configuration.slices;
    fog.settings.storage = configuration.storage;
    if (configuration.averaged_frames > 0) {
        fog.settings.temporal = {.enabled = true,
                                 .new_frame_weight = 1.0F / static_cast<float>(configuration.averaged_frames),
                                 .jitter = true};
    }
    return fog;
}

bool is_sweep(const PrecisionArguments& arguments) {
    const bool lists = !arguments.integrators.empty() || !arguments.visibilities.empty() || !arguments.grids.empty() ||
                       !arguments.slices.empty();
    return arguments.sweep || arguments.quick || ((arguments.error || arguments.budget_ms) && !lists);
}

std::vector<PrecisionConfiguration> configurations(const PrecisionArguments& arguments, const PrecisionScene& scene) {
    const PrecisionConfiguration own = own_configuration(scene);
    const bool sweep = is_sweep(arguments);
    Ladder ladder{{own.integrator}, {own.visibility}, {own.grid}, {own.slices}};
    if (sweep) {
        ladder = arguments.sweep && !arguments.quick ? long_ladder() : short_ladder();
    }
    ladder.integrators = first_given(arguments.integrators, ladder.integrators);
    ladder.visibilities = first_given(arguments.visibilities, ladder.visibilities);
    ladder.grids = first_given(arguments.grids, ladder.grids);
    ladder.slices = first_given(arguments.slices, ladder.slices);
    if (!scene.sun) {
        ladder.visibilities = {own.visibility};
    }
    std::vector<PrecisionConfiguration> all;
    if (sweep) {
        all.push_back(own);
    }
    const bool bounded = sweep && arguments.grids.empty() && arguments.slices.empty();
    const std::uint64_t most = 4 * froxels(PrecisionConfiguration{});
    for (const Integrator integrator : ladder.integrators) {
        for (const SunVisibility visibility : ladder.visibilities) {
            for (const Size& grid : ladder.grids) {
                for (const std::uint32_t slices : ladder.slices) {
                    PrecisionConfiguration one = own;
                    one.integrator = integrator;
                    one.visibility = visibility;
                    one.grid = grid;
                    one.slices = slices;
                    if (!(bounded && froxels(one) > most) && std::find(all.begin(), all.end(), one) == all.end()) {
                        all.push_back(one);
                    }
                }
            }
        }
    }
    return all;
}

} // namespace tyndall::samples
