// The tileable noises that the feature bakes into volumes, in double precision.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "shaders/volumetrics/noise_quantiles.h"

namespace tyndall::volumetrics::reference {

/// Gradient noise as `gradient_noise`, with lattice points taken modulo `cells` and `seed` combined with the word h by
/// exclusive or before it is mixed: of period 1. `p` in periods.
[[nodiscard]] double tiled_gradient_noise(const glm::dvec3& p, std::uint32_t cells, std::uint32_t seed);

/// max(0, 1 - d), d the distance in cells to the nearest of the points of which each cell has one: Worley, "A Cellular
/// Texture Basis Function" (1996), inverted. A cell's point lies at (g + 1/2) / 1024 of it, g the three groups of ten
/// bits of the word that gradient noise makes of the cell. Of period 1; `p` in periods.
[[nodiscard]] double tiled_worley_noise(const glm::dvec3& p, std::uint32_t cells, std::uint32_t seed);

/// W + (1 - W) (1 + P) / 2: Perlin noise P of 4, 8 and 16 cells in the proportions 4 : 2 : 1, seeds 1, 2 and 3, on top
/// of Worley noise W of as many in the proportions 5 : 2 : 1, seeds 4, 5 and 6 (Schneider and Vos, "The Real-time
/// Volumetric Cloudscapes of Horizon: Zero Dawn", 2015). Not made uniform.
[[nodiscard]] double raw_noise_shape(const glm::dvec3& p);
/// Worley noise of 4 and 8 cells in the proportions 2 : 1, seeds 7 and 8. Not made uniform.
[[nodiscard]] double raw_noise_detail(const glm::dvec3& p);

using Quantiles = std::array<double, TYNDALL_NOISE_QUANTILE_COUNT>;

/// A cube of texels that repeats in every direction, between whose centres it is trilinear.
class NoiseVolume {
public:
    /// Of the raw noise at the texels' centres, made uniform on [0, 1] by the polyline through its quantiles.
    static const NoiseVolume& shape();  ///< 128 texels a side
    static const NoiseVolume& detail(); ///< 32

    [[nodiscard]] std::uint32_t size() const { return size_; }
    /// Any whole coordinates: they wrap.
    [[nodiscard]] double texel(std::int64_t x, std::int64_t y, std::int64_t z) const;
    [[nodiscard]] double at(const glm::dvec3& p) const; ///< `p` in periods

private:
    using Raw = double (*)(const glm::dvec3&);
    static constexpr float not_made = -1.0F;
    NoiseVolume(std::uint32_t size, Raw raw, const Quantiles& quantiles);

    std::uint32_t size_;
    Raw raw_;
    const Quantiles* quantiles_;
    mutable std::vector<std::atomic<float>> texels_; ///< made when they are first asked for
};

} // namespace tyndall::volumetrics::reference
