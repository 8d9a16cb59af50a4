#include "features/volumetrics/light_path.hpp"

#include <algorithm>

namespace tyndall::volumetrics {
namespace {

bool has_inside(const LocalVolume& volume) {
    return std::min({volume.half_size_m.x, volume.half_size_m.y, volume.half_size_m.z}) > 0.0F;
}

/// One step finds their optical depth on any way: sums do not depend on where the way is cut.
bool is_exact_in_one_step(const LocalVolume& volume) {
    return !has_inside(volume) || (volume.blend == VolumeBlend::add && volume.edge == 0.0F);
}

} // namespace

bool weakens_light(const Medium& medium, const Settings& settings) {
    const bool everywhere = medium.homogeneous.extinction_per_m > 0.0F || medium.height.extinction_per_m > 0.0F;
    switch (settings.light_path) {
    case LightPath::none: return false;
    case LightPath::closed_form: return everywhere;
    case LightPath::march: break;
    }
    return everywhere || extinction_bound(medium) > 0.0F;
}

LightMarch light_march(const Medium& medium, const Settings& settings) {
    LightMarch march;
    if (settings.light_path != LightPath::march || !weakens_light(medium, settings)) {
        return march;
    }
    march.volumes = std::any_of(medium.volumes.begin(), medium.volumes.end(), has_inside);
    march.octaves = medium.noise.amplitude > 0.0F && !is_baked(medium.noise) ? medium.noise.octaves : 0;
    const bool one =
        march.octaves == 0 && std::all_of(medium.volumes.begin(), medium.volumes.end(), is_exact_in_one_step);
    march.steps = one ? 1 : settings.light_path_steps;
    return march;
}

} // namespace tyndall::volumetrics
