#include "features/volumetrics/reference/density_texels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tyndall::volumetrics::reference {

double density_at(const DensityTexels& texels, const glm::dvec3& place, bool repeats) {
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        std::size_t index = 0;
        std::size_t stride = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const auto size = static_cast<double>(texels.size()[axis]);
            const double at = place[axis] * size - 0.5;
            const double below = std::floor(at);
            const bool upper = (corner >> axis & 1) != 0;
            weight *= upper ? at - below : 1.0 - (at - below);
            double texel = upper ? below + 1.0 : below;
            texel = repeats ? texel - size * std::floor(texel / size) : std::clamp(texel, 0.0, size - 1.0);
            index += stride * static_cast<std::size_t>(texel);
            stride *= texels.size()[axis];
        }
        sum += weight * texels.values()[index] / 255.0;
    }
    return sum;
}

double map_density(const DensityMap& map, const glm::dvec3& point) {
    if (!map.texels) {
        return 1.0;
    }
    const auto fade_m = static_cast<double>(map.fade_m);
    const double rises = std::clamp((point.y - static_cast<double>(map.bottom_m)) / fade_m, 0.0, 1.0);
    const double falls = std::clamp((static_cast<double>(map.top_m) - point.y) / fade_m, 0.0, 1.0);
    const double x = (point.x - static_cast<double>(map.center_m.x)) / static_cast<double>(map.size_m.x) + 0.5;
    const double z = (point.z - static_cast<double>(map.center_m.y)) / static_cast<double>(map.size_m.y) + 0.5;
    return rises * falls * density_at(*map.texels, {x, z, 0.5}, map.edge == MapEdge::repeat);
}

} // namespace tyndall::volumetrics::reference
