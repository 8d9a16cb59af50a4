// A scene as plain data on the CPU: what a file described, ready to upload. Metres, +Y up, right-handed, angles in
// radians, colours linear (Rec. 709 primaries), light in lux and candela. Every index in a Scene is valid and every
// number finite: whoever makes a Scene checks, whoever draws it need not.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/blend.hpp"

namespace tyndall::engine {

/// Axis-aligned, in world space. Empty until the first `grow`.
struct Box {
    glm::dvec3 min{std::numeric_limits<double>::infinity()};
    glm::dvec3 max{-std::numeric_limits<double>::infinity()};

    [[nodiscard]] bool empty() const { return min.x > max.x; }
    [[nodiscard]] glm::dvec3 center() const { return 0.5 * (min + max); }
    [[nodiscard]] glm::dvec3 extent() const { return max - min; }
    void grow(const glm::dvec3& point) {
        min = glm::min(min, point);
        max = glm::max(max, point);
    }
    void grow(const Box& box) {
        min = glm::min(min, box.min);
        max = glm::max(max, box.max);
    }
};

struct Sphere {
    glm::dvec3 center{0.0};
    double radius_m = 0.0;
};

/// Triangles in object space. All vertex arrays have the same length; what the file lacked holds neutral values (uv
/// zero, colour white) or was made (flat normals; tangents for normal maps, else any unit vector across the normal).
struct Primitive {
    std::string name;
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  ///< unit
    std::vector<glm::vec4> tangents; ///< unit xyz; w: +1 or -1, bitangent = w * cross(normal, tangent)
    std::vector<glm::vec2> uv0;
    std::vector<glm::vec2> uv1;
    std::vector<glm::vec4> colors;      ///< linear, multiplies the material's base colour
    std::vector<std::uint32_t> indices; ///< three a triangle, counter-clockwise seen from the front
    std::uint32_t material = 0;
};

/// 8 bits a channel, straight alpha, rows from the top: pixel (x, y) starts at 4 * (y * width + x).
struct Image {
    std::string name;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::uint8_t> rgba;
};

enum class Wrap : std::uint8_t { repeat, mirrored_repeat, clamp_to_edge };
enum class Filter : std::uint8_t { nearest, linear };

struct Sampler {
    Filter magnify = Filter::linear;
    Filter minify = Filter::linear;
    Filter between_levels = Filter::linear;
    bool has_levels = true; ///< false: only level 0 is ever sampled
    Wrap wrap_u = Wrap::repeat;
    Wrap wrap_v = Wrap::repeat;

    bool operator==(const Sampler&) const = default;
};

/// An image and how to read it. One image may serve two textures, one as colour (sRGB) and one as data.
struct Texture {
    std::uint32_t image = 0;
    Sampler sampler;
    bool srgb =
        false; ///< decided by the use: base colour, emission and specular colour are sRGB, the rest is linear data

    bool operator==(const Texture&) const = default;
};

/// A material's use of a texture. Coordinates: uv' = uv_transform * vec3(uv, 1), with uv of set `uv_set`
/// (KHR_texture_transform: translation * rotation * scale, row-wise here as two rows of three).
struct TextureUse {
    std::uint32_t texture = 0;
    std::uint32_t uv_set = 0; ///< 0 or 1
    glm::vec3 uv_row_u{1.0F, 0.0F, 0.0F};
    glm::vec3 uv_row_v{0.0F, 1.0F, 0.0F};

    [[nodiscard]] glm::vec2 apply(const glm::vec2& uv) const {
        const glm::vec3 homogeneous(uv, 1.0F);
        return {glm::dot(uv_row_u, homogeneous), glm::dot(uv_row_v, homogeneous)};
    }
};

enum class AlphaMode : std::uint8_t { opaque, mask, blend };

/// glTF 2.0 metallic-roughness, with KHR_materials_unlit, _specular and _emissive_strength. Each texture multiplies its
/// factor.
struct Material {
    std::string name;
    glm::vec4 base_color_factor{1.0F};
    std::optional<TextureUse> base_color; ///< rgb colour, a coverage
    float metallic_factor = 1.0F;
    float roughness_factor = 1.0F;
    std::optional<TextureUse> metallic_roughness; ///< g roughness, b metallic
    float normal_scale = 1.0F;
    std::optional<TextureUse> normal;
    float occlusion_strength = 1.0F;
    std::optional<TextureUse> occlusion; ///< r: 1 + strength * (r - 1) scales ambient light
    glm::vec3 emissive{0.0F};            ///< radiance, cd/m^2: factor * strength
    std::optional<TextureUse> emission;  ///< rgb
    float specular_factor = 1.0F;
    std::optional<TextureUse> specular; ///< a
    glm::vec3 specular_color_factor{1.0F};
    std::optional<TextureUse> specular_color; ///< rgb
    AlphaMode alpha_mode = AlphaMode::opaque;
    Blend blend = Blend::premultiplied; ///< with AlphaMode::blend; a filter passes its base colour
    float alpha_cutoff = 0.5F;          ///< mask: what has less alpha is not there
    bool double_sided = false;
    bool unlit = false; ///< base colour is the radiance
};

/// A primitive placed in the world.
struct Instance {
    std::uint32_t primitive = 0;
    glm::dmat4 world_from_object{1.0};
    bool mirrored = false; ///< the transform's determinant is negative: front faces turn clockwise
    Box box;               ///< of the vertices that its triangles use, in world space
    Sphere sphere;         ///< around the same vertices
};

struct Perspective {
    double fov_y_rad = 0.785398163397448;
    std::optional<double> aspect; ///< width / height; absent: the image's own
    double near_m = 0.1;
    std::optional<double> far_m; ///< absent: infinite
};

struct Orthographic {
    double half_width_m = 1.0;
    double half_height_m = 1.0;
    double near_m = 0.0;
    double far_m = 100.0;
};

/// Looks along its own -Z with +Y up.
struct Camera {
    std::string name;
    glm::dmat4 world_from_camera{1.0}; ///< rigid: rotation and translation only
    Perspective perspective;
    std::optional<Orthographic> orthographic; ///< present: used instead of `perspective`
};

enum class LightType : std::uint8_t { directional, point, spot };

/// KHR_lights_punctual.
struct Light {
    std::string name;
    LightType type = LightType::point;
    glm::vec3 intensity{1.0F};            ///< linear colour * (directional: lux; point and spot: candela)
    glm::dvec3 position{0.0};             ///< world; point and spot
    glm::dvec3 direction{0.0, 0.0, -1.0}; ///< unit, world, the way that light travels; directional and spot
    std::optional<double> range_m;        ///< influence ends there; absent: infinite
    float inner_cone_rad = 0.0F;          ///< spot: half angle within which it is brightest
    float outer_cone_rad = 0.785398163F;  ///< spot: half angle beyond which it is dark, above inner_cone_rad
    std::optional<bool> casts_shadow;     ///< point and spot; absent: as the renderer's settings say
    std::optional<double> shadow_near_m;  ///< what is nearer to the light casts none, > 0; absent: as they say
};

struct Scene {
    std::vector<Primitive> primitives;
    std::vector<Material> materials; ///< never empty
    std::vector<Image> images;
    std::vector<Texture> textures;
    std::vector<Instance> instances;
    std::vector<Camera> cameras;    ///< never empty
    std::vector<Light> lights;      ///< never empty
    Box bounds;                     ///< of all instances; empty when there are none
    std::vector<std::string> notes; ///< one sentence each: what was left out, made up or changed
};

} // namespace tyndall::engine
