// Densities by texel, as a program has read them from a file: a map over the ground, or a grid in a local volume.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <tl/expected.hpp>

#include "features/volumetrics/error.hpp"
#include "features/volumetrics/range_check.hpp"

namespace tyndall::volumetrics {

/// Between the centres of its texels density is linear. A value v stands for v / 255.
class DensityTexels {
public:
    static constexpr std::uint32_t most = 2048; ///< texels along an axis; and at most 2^27 in all

    /// Refused where the number of values is not that of the size, or the size is none, or too large.
    [[nodiscard]] static tl::expected<std::shared_ptr<const DensityTexels>, Error>
    create(const glm::uvec3& size, std::vector<std::uint8_t> values);

    [[nodiscard]] const glm::uvec3& size() const { return size_; }
    [[nodiscard]] const std::vector<std::uint8_t>& values() const { return values_; } ///< x fastest, then y, then z
    [[nodiscard]] double mean() const { return mean_; }                               ///< in [0, 1]

private:
    DensityTexels(const glm::uvec3& size, std::vector<std::uint8_t> values);

    glm::uvec3 size_;
    std::vector<std::uint8_t> values_;
    double mean_ = 0.0;
};

enum class MapEdge : std::uint8_t {
    clamp, ///< outside of its rectangle its border goes on
    repeat,
};

/// Multiplies homogeneous and height fog, their emission too, by the map's value at (x, z), and by a profile over the
/// height: min(1, (y - bottom) / fade) min(1, (top - y) / fade), 0 outside.
struct DensityMap {
    std::shared_ptr<const DensityTexels> texels; ///< of depth 1, columns along +x, rows along +z; null: no map
    glm::vec2 center_m{0.0F};                    ///< x and z in the world, each in [-1e6, 1e6]
    glm::vec2 size_m{100.0F};                    ///< along x and z, each in [1e-2, 1e6]
    MapEdge edge = MapEdge::clamp;
    float bottom_m = -1e6F; ///< world height, [-1e6, 1e6]
    float top_m = 1e6F;     ///< world height, [bottom_m, 1e6]
    float fade_m = 1.0F;    ///< [1e-2, 1e6]
};

void check_map(const DensityMap& map, RangeCheck& check);

} // namespace tyndall::volumetrics
