// Fogs outside the domain: of every key of the fog file that has a range (docs/fog.md), a value beyond it.
#include <limits>
#include <utility>

#include "samples/stability/case.hpp"

namespace tyndall::samples {
namespace {

using volumetrics::Fog;

using Refusals = std::vector<Refusal>;

template <typename Change>
void add(Refusals& all, std::string parameter, const Change& change) {
    Refusal refusal{std::move(parameter), {}};
    change(refusal.fog);
    all.push_back(std::move(refusal));
}

/// Both of fog that is everywhere and of height fog.
template <typename Member>
void add_fog(Refusals& all, const std::string& section, Member member) {
    const auto of = [&](const char* key) { return section + "." + key; };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const float extinction : {nan, -1.0F, 2e6F}) {
        add(all, of("extinction_per_m"), [&](Fog& f) { (f.medium.*member).extinction_per_m = extinction; });
    }
    add(all, of("extinction_color"), [&](Fog& f) { (f.medium.*member).extinction_color.r = 2.0F; });
    add(all, of("albedo"), [&](Fog& f) { (f.medium.*member).albedo.g = 1.5F; });
    add(all, of("emission_per_m"), [&](Fog& f) { (f.medium.*member).emission_per_m.b = 2e9F; });
}

void add_noise(Refusals& all) {
    const auto noise = [&](const char* key, auto change) { add(all, key, [&](Fog& f) { change(f.medium.noise); }); };
    using volumetrics::DensityNoise;
    noise("medium.noise.amplitude", [](DensityNoise& n) { n.amplitude = 2.0F; });
    noise("medium.noise.scale_m", [](DensityNoise& n) { n.scale_m = 0.0F; });
    noise("medium.noise.wind_m_s", [](DensityNoise& n) { n.wind_m_s.z = 2e3F; });
    noise("medium.noise.octaves", [](DensityNoise& n) { n.octaves = 0; });
    noise("medium.noise.gain", [](DensityNoise& n) { n.gain = -0.5F; });
    noise("medium.noise.coverage", [](DensityNoise& n) { n.coverage = 0.0F; });
    noise("medium.noise.detail", [](DensityNoise& n) { n.detail = 1.0F; });
    noise("medium.noise.detail_scale_m", [](DensityNoise& n) { n.detail_scale_m = 0.0F; });
    noise("medium.noise.detail_wind_m_s", [](DensityNoise& n) { n.detail_wind_m_s.x = -2e3F; });
}

void add_map(Refusals& all) {
    add(all, "medium.map.center_m", [](Fog& f) { f.medium.map.center_m.x = 2e6F; });
    add(all, "medium.map.size_m", [](Fog& f) { f.medium.map.size_m.y = 0.0F; });
    add(all, "medium.map.bottom_m", [](Fog& f) { f.medium.map.bottom_m = -2e6F; });
    add(all, "medium.map.top_m", [](Fog& f) { f.medium.map.top_m = -2e6F; });
    add(all, "medium.map.fade_m", [](Fog& f) { f.medium.map.fade_m = 0.0F; });
}

void add_volumes(Refusals& all) {
    using volumetrics::LocalVolume;
    const auto volume = [&](const char* key, const LocalVolume& wrong) {
        add(all, key, [&](Fog& f) { f.medium.volumes = {wrong}; });
    };
    add(all, "medium.volumes", [](Fog& f) { f.medium.volumes.resize(LocalVolume::most + 1); });
    volume("medium.volumes[0].center_m", {.center_m = glm::vec3(2e6F, 0.0F, 0.0F)});
    volume("medium.volumes[0].half_size_m", {.half_size_m = glm::vec3(-1.0F)});
    volume("medium.volumes[0].rotation", {.rotation = {2.0F, 0.0F, 0.0F, 0.0F}});
    volume("medium.volumes[0].edge", {.edge = 1.5F});
    volume("medium.volumes[0].extinction_per_m", {.extinction_per_m = 2e6F});
    volume("medium.volumes[0].extinction_color", {.extinction_color = glm::vec3(-1.0F)});
    volume("medium.volumes[0].albedo", {.albedo = glm::vec3(-0.1F)});
    volume("medium.volumes[0].emission_per_m", {.emission_per_m = glm::vec3(-1.0F)});
    volume("medium.volumes[0].factor", {.blend = volumetrics::VolumeBlend::multiply, .factor = 2e3F});
}

void add_phase_and_ambient(Refusals& all) {
    add(all, "phase.g", [](Fog& f) { f.medium.phase_g = 1.0F; });
    add(all, "phase.lobes[0].g", [](Fog& f) {
        f.medium.phase_lobes.count = 1;
        f.medium.phase_lobes.lobes[0].g = 1.0F;
    });
    for (const float weight : {-1.0F, 0.0F}) {
        add(all, weight < 0.0F ? "phase.lobes[0].weight" : "phase.lobes' weights", [&](Fog& f) {
            f.medium.phase_lobes.count = 1;
            f.medium.phase_lobes.lobes[0].weight = weight;
        });
    }
    add(all, "ambient.radiance", [](Fog& f) { f.medium.ambient_radiance.b = 1e10F; });
    add(all, "ambient.sh_1", [](Fog& f) { f.medium.ambient_sh_1[1].g = 1.0F; });
}

void add_settings(Refusals& all) {
    const auto setting = [&](const char* key, auto change) { add(all, key, [&](Fog& f) { change(f.settings); }); };
    using volumetrics::DepthLawKind;
    using volumetrics::Settings;
    setting("grid.width", [](Settings& s) { s.grid.width = 1; });
    setting("grid.height", [](Settings& s) { s.grid.height = 1025; });
    setting("grid.slices", [](Settings& s) { s.grid.slices = 4; });
    setting("grid.range_m", [](Settings& s) { s.grid.range_m = 1e8F; });
    setting("grid.shape_m", [](Settings& s) { s.grid.shape_m = 1e-3F; });
    setting("grid.curve_m", [](Settings& s) { s.grid.law = DepthLawKind::curve; });
    setting("grid.curve_m[1]", [](Settings& s) {
        s.grid.law = DepthLawKind::curve;
        s.grid.curve_m = {4.0F, 2.0F, s.grid.range_m};
    });
    setting("shadow.esm_exponent", [](Settings& s) { s.shadow.esm_exponent[2] = 2000.0F; });
    setting("shadow.esm_size", [](Settings& s) { s.shadow.esm_size = 8; });
    setting("temporal.new_frame_weight", [](Settings& s) { s.temporal.new_frame_weight = 0.0F; });
    setting("visibility.taps", [](Settings& s) { s.visibility.taps = 0; });
    setting("airlight.max_lights", [](Settings& s) { s.airlight.max_lights = 33; });
    setting("light_path_steps", [](Settings& s) { s.light_path_steps = 65; });
}

} // namespace

std::vector<Refusal> stability_refusals() {
    Refusals all;
    add_fog(all, "medium.homogeneous", &volumetrics::Medium::homogeneous);
    add_fog(all, "medium.height", &volumetrics::Medium::height);
    add(all, "medium.height.base_height_m", [](Fog& f) { f.medium.height.base_height_m = 2e6F; });
    add(all, "medium.height.falloff_per_m", [](Fog& f) { f.medium.height.falloff_per_m = -0.1F; });
    add_noise(all);
    add_map(all);
    add_volumes(all);
    add_phase_and_ambient(all);
    add_settings(all);
    return all;
}

} // namespace tyndall::samples
