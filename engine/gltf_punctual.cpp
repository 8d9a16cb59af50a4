#include "engine/gltf_punctual.hpp"

#include <algorithm>
#include <cmath>

#include <glm/gtc/constants.hpp>

#include "engine/gltf_value.hpp"

namespace tyndall::engine {
namespace {

/// The sun's disk seen from its surface has some 2e9 lux; beyond, products leave the range of 32-bit floats.
constexpr double intensity_limit = 1e12;
/// Least width of the soft edge of a spot's cone: keeps 1 / (cos inner - cos outer) finite.
constexpr double least_cone_edge_rad = 1e-3;
/// Between them the quotient of near distance and distance keeps its digits.
constexpr double least_shadow_near_m = 1e-3;
constexpr double most_shadow_near_m = 1e3;

glm::dvec3 unit_or(const glm::dvec3& vector, const glm::dvec3& fallback) {
    const double length = glm::length(vector);
    return length > 0.0 && std::isfinite(length) ? vector / length : fallback;
}

bool is_positive(double value) {
    return value > 0.0 && std::isfinite(value);
}

std::optional<std::string> fill_perspective(const tinygltf::PerspectiveCamera& source, Perspective& perspective) {
    if (!is_positive(source.yfov) || source.yfov >= glm::pi<double>()) {
        return "has a yfov that is not between 0 and pi";
    }
    if (!is_positive(source.znear)) {
        return "has a znear that is not positive";
    }
    if (source.zfar != 0.0 && !(source.zfar > source.znear)) {
        return "has a zfar that is not beyond its znear";
    }
    if (source.aspectRatio < 0.0) {
        return "has a negative aspectRatio";
    }
    perspective.fov_y_rad = source.yfov;
    perspective.near_m = source.znear;
    if (source.zfar != 0.0) {
        perspective.far_m = source.zfar;
    }
    if (source.aspectRatio != 0.0) {
        perspective.aspect = source.aspectRatio;
    }
    return std::nullopt;
}

std::optional<std::string> fill_orthographic(const tinygltf::OrthographicCamera& source, Orthographic& orthographic) {
    if (source.xmag == 0.0 || source.ymag == 0.0) {
        return "has an xmag or ymag of zero";
    }
    if (source.znear < 0.0 || !(source.zfar > source.znear)) {
        return "needs 0 <= znear < zfar";
    }
    orthographic = {std::abs(source.xmag), std::abs(source.ymag), source.znear, source.zfar};
    return std::nullopt;
}

std::optional<LightType> to_light_type(const std::string& name) {
    if (name == "directional") {
        return LightType::directional;
    }
    if (name == "point") {
        return LightType::point;
    }
    return name == "spot" ? std::optional(LightType::spot) : std::nullopt;
}

/// "shadow": whether it casts one; "shadow_near_m": what is nearer than this casts none.
void read_light_extras(const tinygltf::Value& extras, const std::string& label, Light& light,
                       std::vector<std::string>& notes) {
    if (const tinygltf::Value* shadow = find_member(&extras, "shadow")) {
        if (shadow->IsBool()) {
            light.casts_shadow = shadow->Get<bool>();
        } else {
            add_note(notes, label + " has an extra 'shadow' that is neither true nor false, which is left out.");
        }
    }
    if (const tinygltf::Value* near = find_member(&extras, "shadow_near_m")) {
        const double near_m = number_or(near, 0.0);
        if (near_m >= least_shadow_near_m && near_m <= most_shadow_near_m) {
            light.shadow_near_m = near_m;
        } else {
            add_note(notes,
                     label + " has an extra 'shadow_near_m' that is not between 0.001 and 1000, which is left out.");
        }
    }
}

} // namespace

glm::dmat4 rigid(const glm::dmat4& transform) {
    const glm::dvec3 backward = unit_or(glm::dvec3(transform[2]), glm::dvec3(0.0, 0.0, 1.0));
    const glm::dvec3 spare_right = std::abs(backward.x) < 0.9 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 given_up = unit_or(glm::dvec3(transform[1]), glm::cross(backward, spare_right));
    glm::dvec3 right = glm::cross(given_up, backward);
    if (!(glm::length(right) > 1e-9)) {
        right = spare_right - backward * glm::dot(spare_right, backward);
    }
    right = glm::normalize(right);
    return {glm::dvec4(right, 0.0), glm::dvec4(glm::cross(backward, right), 0.0), glm::dvec4(backward, 0.0),
            transform[3]};
}

tl::expected<Camera, Error> read_gltf_camera(const GltfDocument& document, int index,
                                             const glm::dmat4& world_from_node) {
    if (!gltf_index_ok(index, document.model.cameras.size())) {
        return tl::unexpected(Error{"there is no camera " + std::to_string(index)});
    }
    const tinygltf::Camera& source = document.model.cameras[static_cast<std::size_t>(index)];
    Camera camera;
    camera.name = source.name;
    camera.world_from_camera = rigid(world_from_node);
    const bool perspective = source.type == "perspective";
    const auto wrong = perspective ? fill_perspective(source.perspective, camera.perspective)
                                   : fill_orthographic(source.orthographic, camera.orthographic.emplace());
    if (wrong) {
        return tl::unexpected(Error{gltf_label("camera", static_cast<std::size_t>(index), source.name) + " " + *wrong});
    }
    return camera;
}

tl::expected<std::optional<Light>, Error> read_gltf_light(const GltfDocument& document, std::size_t node,
                                                          const glm::dmat4& world_from_node,
                                                          std::vector<std::string>& notes) {
    const auto* extension = find_extension(document.model.nodes[node].extensions, "KHR_lights_punctual");
    if (extension == nullptr) {
        return std::nullopt;
    }
    const int index = integer_or(find_member(extension, "light"), -1);
    if (!gltf_index_ok(index, document.model.lights.size())) {
        return tl::unexpected(Error{"there is no light " + std::to_string(index)});
    }
    const tinygltf::Light& source = document.model.lights[static_cast<std::size_t>(index)];
    const std::string label = gltf_label("light", static_cast<std::size_t>(index), source.name);
    const auto type = to_light_type(source.type);
    if (!type) {
        return tl::unexpected(
            Error{label + " has the type '" + source.type + "', allowed are directional, point and spot"});
    }
    const auto clamped = [&](double value, double low, double high, const char* what) {
        const double result = std::clamp(value, low, high);
        if (result != value) {
            add_note(notes, label + " has " + what + " outside of its range, which is clamped.");
        }
        return result;
    };

    Light light;
    light.name = source.name;
    light.type = *type;
    const double intensity = clamped(source.intensity, 0.0, intensity_limit, "an intensity");
    for (int i = 0; i < 3 && source.color.size() == 3; ++i) {
        light.intensity[i] =
            static_cast<float>(clamped(source.color[static_cast<std::size_t>(i)], 0.0, 1.0, "a colour"));
    }
    light.intensity *= static_cast<float>(intensity);
    light.position = glm::dvec3(world_from_node[3]);
    light.direction = -glm::dvec3(rigid(world_from_node)[2]);
    if (is_positive(source.range)) {
        light.range_m = source.range;
    }
    if (*type == LightType::spot) {
        const double outer =
            clamped(source.spot.outerConeAngle, least_cone_edge_rad, glm::half_pi<double>(), "an outer cone angle");
        const double inner =
            clamped(source.spot.innerConeAngle, 0.0, outer - least_cone_edge_rad, "an inner cone angle");
        light.outer_cone_rad = static_cast<float>(outer);
        light.inner_cone_rad = static_cast<float>(inner);
    }
    read_light_extras(source.extras, label, light, notes);
    return light;
}

} // namespace tyndall::engine
