#include "features/volumetrics/fog_json_section.hpp"

namespace tyndall::volumetrics {

void read_medium(Section& root, Medium& medium, std::optional<Error>& error) {
    subsection(root, "medium", error, [&](Section& section) {
        subsection(section, "homogeneous", error, [&](Section& s) {
            s.read("extinction_per_m", medium.homogeneous.extinction_per_m);
            s.read("albedo", medium.homogeneous.albedo);
        });
        subsection(section, "height", error, [&](Section& s) {
            s.read("extinction_per_m", medium.height.extinction_per_m);
            s.read("albedo", medium.height.albedo);
            s.read("base_height_m", medium.height.base_height_m);
            s.read("falloff_per_m", medium.height.falloff_per_m);
        });
        subsection(section, "noise", error, [&](Section& s) {
            s.read("amplitude", medium.noise.amplitude);
            s.read("scale_m", medium.noise.scale_m);
            s.read("wind_m_s", medium.noise.wind_m_s);
        });
    });
    subsection(root, "phase", error, [&](Section& s) { s.read("g", medium.phase_g); });
    subsection(root, "ambient", error, [&](Section& s) { s.read("radiance", medium.ambient_radiance); });
}

} // namespace tyndall::volumetrics
