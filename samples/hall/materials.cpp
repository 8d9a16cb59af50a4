#include "samples/hall/materials.hpp"

#include <string>
#include <utility>

#include "samples/hall/textures.hpp"

namespace tyndall::hall {
namespace {

struct SurfaceIds {
    std::size_t base = 0;
    std::size_t normal = 0;
    std::size_t surface = 0;
};

SurfaceIds add_surface(Scene& scene, const std::string& name, SurfaceTextures textures) {
    return {scene.add_texture(name + "_base.png", std::move(textures.base_color)),
            scene.add_texture(name + "_normal.png", std::move(textures.normal)),
            scene.add_texture(name + "_surface.png", std::move(textures.surface))};
}

Material textured(std::string name, const SurfaceIds& ids, glm::vec3 tint, float tile_size_m) {
    return {.name = std::move(name),
            .base_color = glm::vec4{tint, 1.0F},
            .roughness = 1.0F,
            .base_texture = ids.base,
            .normal_texture = ids.normal,
            .surface_texture = ids.surface,
            .tile_size_m = tile_size_m};
}

void add_stone(Scene& scene, Materials& ids) {
    const SurfaceIds floor = add_surface(scene, "floor", make_floor_textures());
    const SurfaceIds masonry = add_surface(scene, "masonry", make_masonry_textures());
    ids.floor = scene.add_material(textured("floor", floor, glm::vec3{1.0F}, 4.0F));
    ids.masonry = scene.add_material(textured("masonry", masonry, {0.92F, 0.90F, 0.88F}, 3.0F));
    ids.dressed_stone = scene.add_material(textured("dressed_stone", masonry, {1.0F, 0.97F, 0.92F}, 2.2F));
    ids.vault_stone = scene.add_material(textured("vault_stone", masonry, {0.95F, 0.93F, 0.90F}, 3.6F));
}

void add_metal_and_wood(Scene& scene, Materials& ids) {
    const SurfaceIds wood = add_surface(scene, "wood", make_wood_textures());
    ids.wood = scene.add_material(textured("wood", wood, glm::vec3{1.0F}, 1.0F));
    ids.iron = scene.add_material(
        {.name = "iron", .base_color = {0.05F, 0.047F, 0.045F, 1.0F}, .metallic = 0.6F, .roughness = 0.55F});
    ids.bronze = scene.add_material(
        {.name = "bronze", .base_color = {0.55F, 0.33F, 0.14F, 1.0F}, .metallic = 1.0F, .roughness = 0.38F});
    ids.clay = scene.add_material({.name = "clay", .base_color = {0.36F, 0.15F, 0.08F, 1.0F}, .roughness = 0.7F});
    ids.banner = scene.add_material({.name = "banner",
                                     .roughness = 0.95F,
                                     .base_texture = scene.add_texture("banner.png", make_banner_texture()),
                                     .double_sided = true});
    ids.grille = scene.add_material({.name = "grille",
                                     .metallic = 0.3F,
                                     .roughness = 0.6F,
                                     .base_texture = scene.add_texture("grille.png", make_grille_texture()),
                                     .alpha_mode = AlphaMode::mask,
                                     .double_sided = true,
                                     .tile_size_m = 0.55F});
}

void add_light_and_glass(Scene& scene, Materials& ids) {
    ids.flame = scene.add_material({.name = "flame",
                                    .base_color = {0.0F, 0.0F, 0.0F, 1.0F},
                                    .emissive_color = {1.0F, 0.52F, 0.16F},
                                    .emissive_strength = 3500.0F});
    ids.embers = scene.add_material({.name = "embers",
                                     .base_color = {0.02F, 0.02F, 0.02F, 1.0F},
                                     .emissive_color = {1.0F, 0.27F, 0.04F},
                                     .emissive_strength = 1500.0F});
    const std::size_t quarries = scene.add_texture("quarry_glass.png", make_quarry_glass_texture());
    const auto tinted = [&](const char* name, glm::vec3 color, float glow) {
        return scene.add_material({.name = name,
                                   .base_color = glm::vec4{color, 1.0F},
                                   .roughness = 0.15F,
                                   .base_texture = quarries,
                                   .emissive_texture = quarries, // daylight that the glass lets through
                                   .emissive_color = color,
                                   .emissive_strength = glow,
                                   .alpha_mode = AlphaMode::blend,
                                   .double_sided = true,
                                   .tile_size_m = 0.6F});
    };
    ids.panes = {
        tinted("amber_glass", {0.98F, 0.50F, 0.05F}, 90.0F), tinted("ruby_glass", {0.85F, 0.05F, 0.04F}, 110.0F),
        tinted("cobalt_glass", {0.06F, 0.18F, 0.90F}, 150.0F), tinted("emerald_glass", {0.03F, 0.55F, 0.25F}, 100.0F)};
    ids.lantern_glass = scene.add_material({.name = "lantern_glass",
                                            .base_color = {1.0F, 0.62F, 0.26F, 0.30F},
                                            .roughness = 0.12F,
                                            .emissive_color = {1.0F, 0.52F, 0.18F},
                                            .emissive_strength = 500.0F,
                                            .alpha_mode = AlphaMode::blend,
                                            .double_sided = true});
    const std::size_t window = scene.add_texture("stained_glass.png", make_stained_glass_texture());
    ids.stained_glass = scene.add_material({.name = "stained_glass",
                                            .roughness = 0.2F,
                                            .base_texture = window,
                                            .emissive_texture = window, // daylight that the glass lets through
                                            .emissive_color = glm::vec3{1.0F},
                                            .emissive_strength = 260.0F,
                                            .alpha_mode = AlphaMode::blend,
                                            .double_sided = true});
}

} // namespace

Materials add_materials(Scene& scene) {
    Materials ids;
    add_stone(scene, ids);
    add_metal_and_wood(scene, ids);
    add_light_and_glass(scene, ids);
    return ids;
}

} // namespace tyndall::hall
