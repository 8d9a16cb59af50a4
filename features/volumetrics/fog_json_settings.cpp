#include "features/volumetrics/fog_json_section.hpp"
#include "shaders/common/airlight.h"

namespace tyndall::volumetrics {

void read_settings(Section& root, Settings& settings, std::optional<Error>& error) {
    subsection(root, "grid", error, [&](Section& s) {
        s.read_whole("width", settings.grid.width, 2, 1024);
        s.read_whole("height", settings.grid.height, 2, 1024);
        s.read_whole("slices", settings.grid.slices, 8, 512);
        s.read("range_m", settings.grid.range_m);
        s.read_list("curve_m", settings.grid.curve_m);
        if (s.has("curve_m") && settings.grid.curve_m.empty()) {
            s.complain("The number of grid.curve_m's depths", "must be between 1 and 8, not 0");
        }
        if (!settings.grid.curve_m.empty()) {
            settings.grid.law = DepthLawKind::curve;
            settings.grid.range_m = s.find("range_m") != nullptr ? settings.grid.range_m : settings.grid.curve_m.back();
        }
        settings.grid.shape_m = 0.25F * settings.grid.range_m;
        s.read("law", settings.grid.law,
               {{"shaped", DepthLawKind::shaped},
                {"linear", DepthLawKind::linear},
                {"curve", DepthLawKind::curve},
                {"scene", DepthLawKind::scene}});
        if (!settings.grid.curve_m.empty() && settings.grid.law != DepthLawKind::curve) {
            s.complain("grid.law", "must be \"curve\" where grid.curve_m is given");
        }
        s.read("shape_m", settings.grid.shape_m);
    });
    subsection(root, "shadow", error,
               [&](Section& s) { s.read_per_cascade("esm_exponent", settings.shadow.esm_exponent); });
    subsection(root, "temporal", error, [&](Section& s) {
        s.read("enabled", settings.temporal.enabled);
        s.read("new_frame_weight", settings.temporal.new_frame_weight);
        s.read("jitter", settings.temporal.jitter);
    });
    root.read("storage", settings.storage);
    root.read("integrator", settings.integrator,
              {{"euler", Integrator::euler},
               {"half_slice", Integrator::half_slice},
               {"exponential", Integrator::exponential},
               {"exponential_quadratic", Integrator::exponential_quadratic}});
    root.read("error_estimate", settings.error_estimate);
    root.read("light_path", settings.light_path,
              {{"none", LightPath::none}, {"closed_form", LightPath::closed_form}, {"march", LightPath::march}});
    root.read_whole("light_path_steps", settings.light_path_steps, 1, 64);
    subsection(root, "airlight", error, [&](Section& s) {
        s.read_whole("max_lights", settings.airlight.max_lights, 0, TYNDALL_AIRLIGHT_COUNT);
    });
    subsection(root, "visibility", error, [&](Section& s) {
        s.read("method", settings.visibility.method,
               {{"one_tap", SunVisibility::one_tap},
                {"n_taps", SunVisibility::n_taps},
                {"prefiltered", SunVisibility::prefiltered},
                {"lit_fraction", SunVisibility::lit_fraction}});
        s.read_whole("taps", settings.visibility.taps, 1, 64);
    });
}

} // namespace tyndall::volumetrics
