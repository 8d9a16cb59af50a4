// The physics of fog in double precision, written from its definitions; shares no arithmetic with the shaders.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "features/volumetrics/reference/geometry.hpp"
#include "features/volumetrics/reference/local_volume.hpp"
#include "features/volumetrics/settings.hpp"

namespace tyndall::volumetrics::reference {

/// Henyey and Greenstein 1941, per steradian. `cos_theta`: 1 is forward scattering; g in (-1, 1).
[[nodiscard]] double henyey_greenstein(double g, double cos_theta);

/// One lobe, whatever its weight.
[[nodiscard]] double phase(const PhaseLobe& lobe, double cos_theta);

/// The medium's phase function.
[[nodiscard]] double phase(const Medium& medium, double cos_theta);

/// What the medium scatters of its ambient light toward the origin of a ray of this unit direction, per unit of
/// scattering coefficient: the light from direction w is a + c (w.y s0 + w.z s1 + w.x s2), c = sqrt(3 / (4 pi)), of
/// which the sphere's integral against the phase function keeps the mean cosine's part of order 1 (Funk and Hecke).
[[nodiscard]] glm::dvec3 scattered_ambient(const Medium& medium, const glm::dvec3& direction);

/// Integral of e^(-falloff max(0, y)) along a straight way of `length_m` from height `from_m` to `to_m`, both above the
/// base of the fog. In metres.
[[nodiscard]] double height_integral(double falloff_per_m, double from_m, double to_m, double length_m);

/// The medium at one time.
class Fog {
public:
    Fog(const Medium& medium, double time_s);

    [[nodiscard]] const Medium& medium() const { return *medium_; }
    [[nodiscard]] Coefficients at(const glm::dvec3& point) const;

    [[nodiscard]] bool emits() const;

    /// Whether `closed_optical_depth` is the optical depth; else it is its mean over all noises, without local
    /// volumes and map.
    [[nodiscard]] bool is_closed() const {
        return medium_->noise.amplitude == 0.0F && volumes_.empty() && !medium_->map.texels;
    }

    /// Optical depth without noise and local volumes of the ray's first `length_m`; infinite where that is and the fog
    /// does not end.
    [[nodiscard]] glm::dvec3 closed_optical_depth(const Ray& ray, double length_m) const;

    /// From a point toward an endless light. Of media without end nothing counts: the illuminance is what arrives in
    /// them. Those are the homogeneous fog, and the height fog unless it thins out on the way.
    [[nodiscard]] glm::dvec3 closed_optical_depth_of_sky(const Ray& ray) const;
    /// Without the media without end in that direction; local volumes end.
    [[nodiscard]] Coefficients ending_at(const glm::dvec3& point, const glm::dvec3& direction) const;
    /// Where on such a way the last of it ends: 0 where there is none.
    [[nodiscard]] double end_of_ending(const Ray& ray) const;
    [[nodiscard]] bool ends_toward(const glm::dvec3& direction) const;

    /// Where the height fog has fallen to e^-45 of its base value, if the ray rises out of it; else infinity. Without
    /// homogeneous fog nothing is left beyond.
    [[nodiscard]] double top_of_height_fog(const Ray& ray) const;

    /// How far along the ray something is left of the medium: 0 of none.
    [[nodiscard]] double end_along(const Ray& ray) const;

    /// Appends the distances within `part` between which the mean density is smooth and changes by no more than a few
    /// orders of magnitude. Not sorted.
    void add_breaks(const Ray& ray, Interval part, std::vector<double>& breaks) const;
    /// And those at which a higher derivative of noise or textures jumps.
    void add_seams(const Ray& ray, Interval part, std::vector<double>& seams) const;

private:
    [[nodiscard]] double noise_factor(const glm::dvec3& point) const;
    [[nodiscard]] double height_profile(const glm::dvec3& point) const; ///< 1 at the base

    /// `before` with volumes and noise.
    [[nodiscard]] Coefficients changed(Coefficients before, const glm::dvec3& point) const;
    [[nodiscard]] double end_of_volumes(const Ray& ray) const;

    const Medium* medium_;
    std::vector<LocalVolume> volumes_; ///< those that are not empty
    double time_s_;
};

} // namespace tyndall::volumetrics::reference
