// Optical depth between points, and as a function of the distance along the eye's ray.
#pragma once

#include <vector>

#include "features/volumetrics/reference/medium.hpp"
#include "features/volumetrics/reference/quadrature.hpp"

namespace tyndall::volumetrics::reference {

/// Of the ray's first `length_m`, finite, to the absolute error `wanted`, which is that of a transmittance relative to
/// itself.
[[nodiscard]] Estimate optical_depth(const Fog& fog, const Ray& ray, double length_m, double wanted);

/// From the ray's origin to an endless light in its direction (Fog::closed_optical_depth_of_sky).
[[nodiscard]] Estimate optical_depth_of_sky(const Fog& fog, const Ray& ray, double wanted);

/// Optical depth from the eye as a function of the distance. Without a closed form the extinction is expanded in
/// Legendre polynomials on pieces short enough, and the expansion integrated.
class EyePath {
public:
    /// `length_m` may be infinite.
    EyePath(const Fog& fog, const Ray& ray, double length_m, double wanted);

    /// The way ends where nothing that lies beyond can be seen, before `length_m` if need be: there either e^-45 of the
    /// light is left, or e^-45 of the fog.
    [[nodiscard]] double end() const { return end_m_; }
    [[nodiscard]] glm::dvec3 optical_depth(double distance_m) const;
    [[nodiscard]] double error() const { return error_; } ///< of an optical depth, absolute

    /// Ascending: where the mean density is not smooth, and where its optical depth doubles; where the noise is not.
    [[nodiscard]] const std::vector<double>& breaks() const { return breaks_; }
    [[nodiscard]] const std::vector<double>& seams() const { return seams_; }

private:
    static constexpr std::size_t terms = 16;
    struct Piece {
        double begin = 0.0;
        double end = 0.0;
        glm::dvec3 before{0.0}; ///< optical depth at `begin`
        std::array<glm::dvec3, terms> coefficients{};
    };
    void follow(double begin, double end, double wanted);
    void expand(double begin, double end, double wanted, int halvings);

    Fog fog_;
    Ray ray_;
    double end_m_ = 0.0;
    double error_ = 0.0;
    std::vector<double> breaks_;
    std::vector<double> seams_;
    std::vector<Piece> pieces_; ///< empty where there is a closed form
};

} // namespace tyndall::volumetrics::reference
