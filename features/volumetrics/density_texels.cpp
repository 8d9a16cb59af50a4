#include "features/volumetrics/density_texels.hpp"

#include <numeric>
#include <string>
#include <utility>

namespace tyndall::volumetrics {

DensityTexels::DensityTexels(const glm::uvec3& size, std::vector<std::uint8_t> values)
    : size_(size), values_(std::move(values)) {
    const std::uint64_t sum = std::accumulate(values_.begin(), values_.end(), std::uint64_t{0});
    mean_ = static_cast<double>(sum) / 255.0 / static_cast<double>(values_.size());
}

tl::expected<std::shared_ptr<const DensityTexels>, Error> DensityTexels::create(const glm::uvec3& size,
                                                                                std::vector<std::uint8_t> values) {
    const auto number = [](std::uint64_t n) { return std::to_string(n); };
    for (int i = 0; i < 3; ++i) {
        if (size[i] == 0 || size[i] > most) {
            return tl::unexpected(Error{"densities must have between 1 and " + number(most) +
                                        " texels along an axis, not " + number(size[i]) + "."});
        }
    }
    const std::uint64_t count = std::uint64_t{size.x} * size.y * size.z;
    if (count > std::uint64_t{1} << 27U || values.size() != count) {
        return tl::unexpected(Error{"densities must have at most 2^27 texels and a value each, not " + number(count) +
                                    " and " + number(values.size()) + "."});
    }
    return std::shared_ptr<const DensityTexels>(new DensityTexels(size, std::move(values)));
}

void check_map(const DensityMap& map, RangeCheck& check) {
    check.in_range("medium.map.center_m[0]", map.center_m.x, -1e6, 1e6);
    check.in_range("medium.map.center_m[1]", map.center_m.y, -1e6, 1e6);
    check.in_range("medium.map.size_m[0]", map.size_m.x, 1e-2F, 1e6);
    check.in_range("medium.map.size_m[1]", map.size_m.y, 1e-2F, 1e6);
    check.in_range("medium.map.bottom_m", map.bottom_m, -1e6, 1e6);
    check.in_range("medium.map.top_m (no less than bottom_m)", map.top_m, map.bottom_m, 1e6);
    check.in_range("medium.map.fade_m", map.fade_m, 1e-2F, 1e6);
    check.in_range("The depth of medium.map.texels", map.texels ? map.texels->size().z : 1.0, 1.0, 1.0);
}

} // namespace tyndall::volumetrics
