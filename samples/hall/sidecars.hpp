#pragma once

#include <string>

namespace tyndall::hall {

/// The medium that fills the hall, as the tool reads it (`hall.fog.json`).
[[nodiscard]] std::string fog_json();

/// The particle emitters of the hall (`hall.particles.json`). glTF core knows none, so they stand in a file of their
/// own:
///
///   {"emitters": [ {...}, ... ]}, each with
///   name                   string, for messages
///   kind                   "smoke" (soft, thick, rises, grows) or "dust" (tiny, slow, bright in light)
///   position_m             [x, y, z] middle of the box in which particles are born, world space
///   box_half_extent_m      [x, y, z] half size of that box
///   rate_per_s             particles born per second; about rate_per_s * lifetime_s are alive at once
///   lifetime_s             seconds a particle lives; it fades in over the first tenth and out over the last half
///   velocity_m_s           [x, y, z] mean velocity at birth
///   velocity_spread_m_s    [x, y, z] half width of the uniform spread around it
///   buoyancy_m_s2          upward acceleration
///   drag_per_s             velocity falls by exp(-drag_per_s * t); 0 is none
///   turbulence_m_s         speed of the curling motion added to the velocity
///   start_radius_m, end_radius_m   radius of the billboard at birth and at the end of life, linear in age
///   opacity                alpha at the middle of a billboard when it is fully faded in
///   albedo                 [r, g, b] share of light that is scattered
[[nodiscard]] std::string particles_json();

} // namespace tyndall::hall
