// One description of a scene, from which both the engine's and the reference's are made.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "engine/renderer_settings.hpp"
#include "engine/scene.hpp"
#include "features/volumetrics/fog_json.hpp"
#include "features/volumetrics/reference/render.hpp"

namespace tyndall::samples {

namespace reference = volumetrics::reference;

/// Lambertian, closed or not; quadrilaterals in the order of their corners, counter-clockwise from outside.
struct Surface {
    std::vector<std::array<glm::dvec3, 4>> quads; ///< flat
    glm::dvec3 albedo{0.5};
};
[[nodiscard]] Surface make_box(const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& albedo);
/// The inside of a box.
[[nodiscard]] Surface make_room(const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& albedo);

struct PrecisionScene {
    std::string name;
    std::string about; ///< a sentence
    std::vector<Surface> surfaces;
    volumetrics::Fog fog;
    double time_s = 0.0;
    reference::Camera camera;
    std::optional<reference::DirectionalLight> sun;
    std::vector<reference::DirectionalLight> fills; ///< without shadows, on surfaces only
    std::vector<reference::Light> lights;
    reference::Surroundings surroundings;
    std::size_t pixels = 0;  ///< that the reference computes, at random; 0: all
    double tolerance = 1e-7; ///< of the reference, relative, a pixel each

    /// Of a file: what is drawn instead of `surfaces`, with textures that only the engine reads; what a pixel shows of
    /// it is then taken from the engine (samples/tyndall/precision_surfaces.hpp).
    std::optional<engine::Scene> drawn;
    std::string identity; ///< a hash of the file's geometry and fog
};

/// What the truth may leave out, to tell which cause an error has.
struct Physics {
    bool light_paths = true;   ///< the medium weakens light on its way to particles and surfaces
    bool local_shadows = true; ///< of point and spot lights
};
[[nodiscard]] reference::Scene reference_scene(const PrecisionScene& scene, const Physics& physics);

[[nodiscard]] engine::Scene engine_scene(const PrecisionScene& scene);
/// Ambient light, background, 32-bit colour.
[[nodiscard]] engine::RendererSettings renderer_settings(const PrecisionScene& scene);

/// In the order in which they are reported.
[[nodiscard]] const std::vector<PrecisionScene>& precision_scenes();

} // namespace tyndall::samples
