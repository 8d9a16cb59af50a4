#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "samples/hall/geometry.hpp"
#include "samples/hall/image.hpp"

namespace tyndall::hall {

struct Texture {
    std::string file_name;
    Image image;
};

enum class AlphaMode { opaque, mask, blend };

/// A glTF metallic-roughness material; textures by index into `Scene::textures`.
struct Material {
    std::string name;
    glm::vec4 base_color{1.0F};
    float metallic = 0.0F;
    float roughness = 0.8F;
    std::optional<std::size_t> base_texture;
    std::optional<std::size_t> normal_texture;
    std::optional<std::size_t> surface_texture; // red: occlusion, green: roughness, blue: metallic
    std::optional<std::size_t> emissive_texture;
    glm::vec3 emissive_color{0.0F};
    float emissive_strength = 1.0F; // cd/m^2 where the colour is 1
    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5F;
    bool double_sided = false;
    float tile_size_m = 1.0F; // metres that texture coordinates run over one tile
};

struct Part {
    std::size_t material = 0;
    Geometry geometry;
};

struct Mesh {
    std::string name;
    std::deque<Part> parts; // a deque: references to its geometry stay good while it grows

    /// The geometry that has this material, made empty on first use.
    [[nodiscard]] Geometry& part(std::size_t material);
};

enum class LightKind { directional, point, spot };

struct Light {
    std::string name;
    LightKind kind = LightKind::point;
    glm::vec3 color{1.0F};
    float intensity = 1.0F; // lux for directional, candela otherwise
    float range_m = 0.0F;   // unused for directional
    float inner_cone_rad = 0.0F;
    float outer_cone_rad = 0.0F;
};

struct Camera {
    std::string name;
    float vertical_field_of_view_rad = 0.9F;
    float near_m = 0.1F;
    float far_m = 100.0F;
};

struct Node {
    std::string name;
    glm::vec3 translation{0.0F};
    glm::quat rotation{1.0F, 0.0F, 0.0F, 0.0F};
    float scale = 1.0F;
    std::optional<std::size_t> mesh;
    std::optional<std::size_t> light;
    std::optional<std::size_t> camera;
};

/// Everything that the writer puts into the glTF file. Order is the order in the file.
struct Scene {
    std::vector<Texture> textures;
    std::vector<Material> materials;
    std::vector<Mesh> meshes;
    std::vector<Light> lights;
    std::vector<Camera> cameras;
    std::vector<Node> nodes;

    std::size_t add_texture(std::string file_name, Image image);
    std::size_t add_material(Material material);
    std::size_t add_mesh(Mesh mesh);

    /// Places a mesh, turned about the y axis.
    void place(std::size_t mesh, glm::vec3 position, float turn_rad = 0.0F, float scale = 1.0F);
    /// Adds a light at a position, pointing along `direction` (ignored by point lights).
    void add_light(Light light, glm::vec3 position, glm::vec3 direction = {0.0F, -1.0F, 0.0F});
    /// Adds a camera at `eye` that looks at `target`, 16:9.
    void add_camera(Camera camera, glm::vec3 eye, glm::vec3 target);
};

} // namespace tyndall::hall
