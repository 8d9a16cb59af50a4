// What a scene gets that brings no camera or no light of its own.
#pragma once

#include "engine/scene.hpp"

namespace tyndall::engine {

/// Sees all of `bounds` from the front, right and above (a three-quarter view) in images that are at least as wide as
/// high. With empty bounds it stands at (0, 0, 5) and looks along -Z.
[[nodiscard]] Camera make_framing_camera(const Box& bounds);

/// Clear afternoon light from behind the left shoulder of `camera`, 40 degrees above the horizon, 20,000 lux.
[[nodiscard]] Light make_sun(const Camera& camera);

/// Adds a framing camera and a sun where the scene has none, with a note each.
void complete_scene(Scene& scene);

} // namespace tyndall::engine
