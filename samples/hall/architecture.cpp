#include <numbers>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "samples/hall/arches.hpp"
#include "samples/hall/layout.hpp"

namespace tyndall::hall {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr int arch_steps = 10;
constexpr float wall_foot_m = -0.6F; // walls start below the floor, so that no seam lets light through

/// Inside of the window wall: its right is +z. The opening is splayed, wider inside than outside.
const WallPlane window_wall{{half_width_m, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}};
constexpr Opening window_outside{.half_width = window_half_width_m,
                                 .sill = window_sill_m,
                                 .spring = window_spring_m,
                                 .pointedness = window_pointedness};
constexpr Opening window_inside{.half_width = window_half_width_m + 0.25F,
                                .sill = window_sill_m - 0.2F,
                                .spring = window_spring_m,
                                .pointedness = window_pointedness};

Opening shifted(Opening opening, float center) {
    opening.center = center;
    return opening;
}

void add_shell(Scene& scene, const Materials& materials) {
    Mesh shell{.name = "shell", .parts = {}};
    add_box(shell.part(materials.floor), {-half_width_m - 0.3F, -0.5F, -half_length_m - 0.3F},
            {half_width_m + 0.3F, 0.0F, half_length_m + 0.3F});
    Geometry& walls = shell.part(materials.masonry);
    const float outer_x = half_width_m + wall_thickness_m;
    const float outer_z = half_length_m + wall_thickness_m;
    add_box(walls, {-outer_x, wall_foot_m, -outer_z}, {-half_width_m, roof_high_m, outer_z});
    add_box(walls, {-outer_x, wall_foot_m, -outer_z}, {outer_x, roof_high_m, -half_length_m});
    add_box(walls, {-outer_x, wall_foot_m, half_length_m}, {outer_x, roof_high_m, outer_z});
    add_box(walls, {half_width_m, aisle_ceiling_m, -outer_z}, {outer_x, roof_high_m, outer_z}); // above the windows
    add_box(walls, {-outer_x, roof_low_m, -outer_z}, {outer_x, roof_high_m, outer_z});
    for (int bay = 0; bay < bay_count; ++bay) {
        const float z = bay_center_m(bay);
        add_pierced_wall(walls, window_wall, {z - 0.5F * bay_m, z + 0.5F * bay_m, wall_foot_m, aisle_ceiling_m},
                         shifted(window_inside, z), shifted(window_outside, z), wall_thickness_m, arch_steps);
    }
    scene.place(scene.add_mesh(std::move(shell)), {0.0F, 0.0F, 0.0F});
}

/// Two lancets and a round light in stone bars, standing in the outer part of every window; drawn about z = 0.
void add_window_dressing(Scene& scene, const Materials& materials) {
    Mesh window{.name = "window_dressing", .parts = {}};
    Geometry& stone = window.part(materials.dressed_stone);
    constexpr float bar = 0.07F;
    const WallPlane bars{window_wall.at({0.0F, 0.0F}, 0.42F), window_wall.right};
    const float lancet = 0.5F * window_outside.half_width;
    for (const float side : {-1.0F, 1.0F}) {
        std::vector<glm::vec2> curve;
        for (const glm::vec2 point : arch_curve(lancet, 1.5F, 6)) {
            curve.push_back(point + glm::vec2{side * lancet, 5.0F});
        }
        add_moulding(stone, bars, curve, bar, 0.0F, 0.14F);
    }
    std::vector<glm::vec2> ring;
    for (int i = 0; i <= 16; ++i) {
        const float angle = 2.0F * pi * static_cast<float>(i) / 16.0F;
        ring.push_back(glm::vec2{0.0F, 6.22F} + 0.40F * glm::vec2{-std::cos(angle), std::sin(angle)});
    }
    add_moulding(stone, bars, ring, bar, 0.0F, 0.14F);
    const std::vector<glm::vec2> mullion{{0.0F, 1.9F}, {0.0F, 5.8F}};
    add_moulding(stone, bars, mullion, bar, 0.0F, 0.14F);
    const std::vector<glm::vec2> transom{{-1.2F, 3.6F}, {1.2F, 3.6F}};
    add_moulding(stone, bars, transom, 0.045F, -0.02F, 0.12F);

    std::vector<glm::vec2> hood; // the frame around the opening on the inside of the wall
    for (const glm::vec2 point :
         opening_outline({.half_width = 1.47F, .sill = 2.2F, .spring = 5.6F, .pointedness = 1.4F}, arch_steps)) {
        hood.push_back(point);
    }
    add_moulding(stone, window_wall, hood, 0.12F, 0.09F, 0.05F);
    add_box(stone, {6.78F, 1.68F, -1.75F}, {7.1F, 1.9F, 1.75F}, 0.03F);

    const std::size_t mesh = scene.add_mesh(std::move(window));
    for (int bay = 0; bay < bay_count; ++bay) {
        scene.place(mesh, {0.0F, 0.0F, bay_center_m(bay)});
    }
}

void add_pillars(Scene& scene, const Materials& materials) {
    Mesh pillar{.name = "pillar", .parts = {}};
    Geometry& stone = pillar.part(materials.dressed_stone);
    add_box(stone, {-0.62F, -0.05F, -0.62F}, {0.62F, 0.22F, 0.62F}, 0.04F);
    const std::vector<glm::vec2> base{{0.60F, 0.20F}, {0.60F, 0.46F}, {0.54F, 0.52F}};
    add_lathe(stone, base, {.segments = 8, .turn_uv_m = 4.4F, .faceted = true});
    const std::vector<glm::vec2> shaft{{0.56F, 0.50F}, {0.61F, 0.54F}, {0.61F, 0.62F}, {0.55F, 0.66F}, {0.47F, 0.68F},
                                       {0.46F, 0.72F}, {0.51F, 0.76F}, {0.51F, 0.82F}, {0.44F, 0.86F}, {0.40F, 0.92F},
                                       {0.39F, 4.28F}, {0.44F, 4.31F}, {0.44F, 4.36F}, {0.39F, 4.39F}, {0.40F, 4.54F},
                                       {0.46F, 4.72F}, {0.60F, 4.90F}};
    add_lathe(stone, shaft, {.segments = 24, .turn_uv_m = 2.2F});
    const std::vector<glm::vec2> colonnette{{0.13F, 0.84F}, {0.13F, 0.92F}, {0.10F, 0.97F}, {0.10F, 4.40F},
                                            {0.13F, 4.45F}, {0.15F, 4.66F}, {0.20F, 4.90F}};
    Geometry slim;
    add_lathe(slim, colonnette, {.segments = 8, .turn_uv_m = 1.1F});
    for (int i = 0; i < 4; ++i) {
        const float angle = 0.5F * pi * static_cast<float>(i);
        append(stone, slim, glm::translate(glm::mat4{1.0F}, {0.42F * std::cos(angle), 0.0F, 0.42F * std::sin(angle)}));
    }
    add_box(stone, {-0.64F, 4.88F, -0.64F}, {0.64F, 5.06F, 0.64F}, 0.05F);
    add_box(stone, {-0.58F, 5.05F, -0.58F}, {0.58F, capital_top_m + 0.02F, 0.58F}, 0.02F);
    const std::size_t mesh = scene.add_mesh(std::move(pillar));
    for (const float x : {-arcade_x_m, arcade_x_m}) {
        for (const float z : pillar_z_m) {
            scene.place(mesh, {x, 0.0F, z});
        }
        scene.place(mesh, {x, 0.0F, -half_length_m}); // half sunk in the end wall
    }
}

void add_arcades(Scene& scene, const Materials& materials) {
    Mesh arcade{.name = "arcade_bay", .parts = {}};
    const WallPlane aisle_side{{arcade_half_thickness_m, 0.0F, 0.0F}, {0.0F, 0.0F, -1.0F}};
    const WallPlane nave_side{{-arcade_half_thickness_m, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}};
    const Opening arch{.half_width = 2.05F, .sill = capital_top_m, .spring = capital_top_m, .pointedness = 1.2F};
    add_pierced_wall(arcade.part(materials.masonry), nave_side,
                     {-0.5F * bay_m, 0.5F * bay_m, capital_top_m, aisle_ceiling_m + 0.3F}, arch, arch,
                     2.0F * arcade_half_thickness_m, arch_steps);
    Geometry& trim = arcade.part(materials.dressed_stone);
    std::vector<glm::vec2> curve;
    for (const glm::vec2 point : arch_curve(2.17F, 1.2F, arch_steps)) {
        curve.push_back(point + glm::vec2{0.0F, capital_top_m});
    }
    for (const WallPlane& plane : {aisle_side, nave_side}) {
        add_moulding(trim, plane, curve, 0.12F, 0.08F, 0.04F);
    }
    // The string course from which the vault springs.
    add_box(trim, {-0.56F, aisle_ceiling_m - 0.22F, -0.5F * bay_m}, {-0.36F, aisle_ceiling_m, 0.5F * bay_m});
    const std::size_t mesh = scene.add_mesh(std::move(arcade));
    for (int bay = 0; bay < bay_count; ++bay) {
        scene.place(mesh, {arcade_x_m, 0.0F, bay_center_m(bay)});
        scene.place(mesh, {-arcade_x_m, 0.0F, bay_center_m(bay)}, pi);
    }
}

void add_vault(Scene& scene, const Materials& materials) {
    constexpr float half_span = arcade_x_m - arcade_half_thickness_m;
    constexpr float pointedness = 1.15F;
    Mesh vault{.name = "vault_bay", .parts = {}};
    const WallPlane cross_section{{0.0F, 0.0F, 0.5F * bay_m}, {1.0F, 0.0F, 0.0F}};
    std::vector<glm::vec2> shell;
    for (const glm::vec2 point : arch_curve(half_span + 0.2F, pointedness, arch_steps)) {
        shell.push_back(point + glm::vec2{0.0F, aisle_ceiling_m});
    }
    add_moulding(vault.part(materials.vault_stone), cross_section, shell, 0.2F, 0.0F, bay_m);
    std::vector<glm::vec2> rib;
    for (const glm::vec2 point : arch_curve(half_span - 0.08F, pointedness, arch_steps)) {
        rib.push_back(point + glm::vec2{0.0F, aisle_ceiling_m});
    }
    add_moulding(vault.part(materials.dressed_stone), cross_section, rib, 0.14F, 0.17F, 0.17F);
    Geometry& trim = vault.part(materials.dressed_stone);
    for (const float x : {-half_span, half_span}) { // corbels that carry the ribs
        add_box(trim, {x - 0.30F, aisle_ceiling_m - 0.30F, 0.5F * bay_m - 0.42F},
                {x + 0.30F, aisle_ceiling_m + 0.06F, 0.5F * bay_m + 0.22F}, 0.06F);
    }
    const float crown = aisle_ceiling_m + half_span * 1.14F;
    add_box(trim, {-0.12F, crown - 0.16F, -0.5F * bay_m}, {0.12F, crown + 0.1F, 0.5F * bay_m}, 0.03F);
    const std::size_t mesh = scene.add_mesh(std::move(vault));
    for (int bay = 0; bay < bay_count; ++bay) {
        scene.place(mesh, {0.0F, 0.0F, bay_center_m(bay)});
    }
}

/// Timber ceilings over the aisles, pilasters and plinths along the walls.
void add_aisles(Scene& scene, const Materials& materials) {
    Mesh aisle{.name = "aisle_bay", .parts = {}}; // the aisle at +x, about z = 0
    Geometry& wood = aisle.part(materials.wood);
    const float inner_x = arcade_x_m + arcade_half_thickness_m - 0.1F;
    add_box(wood, {inner_x, aisle_ceiling_m, -0.5F * bay_m},
            {half_width_m + 0.1F, aisle_ceiling_m + 0.4F, 0.5F * bay_m});
    for (int beam = 0; beam < 2; ++beam) {
        const float z = (static_cast<float>(beam) - 0.5F) * 0.5F * bay_m;
        add_box(wood, {inner_x, aisle_ceiling_m - 0.24F, z - 0.1F},
                {half_width_m + 0.1F, aisle_ceiling_m + 0.1F, z + 0.1F}, 0.02F);
    }
    Geometry& trim = aisle.part(materials.dressed_stone);
    add_box(trim, {6.72F, -0.1F, -2.82F}, {7.1F, aisle_ceiling_m - 0.3F, -2.18F}, 0.05F); // pilaster
    add_box(trim, {6.64F, -0.1F, -2.92F}, {7.1F, 0.5F, -2.08F}, 0.05F);
    add_box(trim, {6.60F, aisle_ceiling_m - 0.62F, -2.96F}, {7.1F, aisle_ceiling_m - 0.24F, -2.04F}, 0.06F);
    add_box(trim, {6.90F, -0.1F, -2.5F}, {7.1F, 0.42F, 2.5F}, 0.04F); // plinth
    const std::size_t mesh = scene.add_mesh(std::move(aisle));
    for (int bay = 0; bay < bay_count; ++bay) {
        scene.place(mesh, {0.0F, 0.0F, bay_center_m(bay)});
        scene.place(mesh, {0.0F, 0.0F, bay_center_m(bay)}, pi);
    }
}

/// Three bevelled steps, and the niche in the wall behind them.
void add_dais(Scene& scene, const Materials& materials) {
    Mesh dais{.name = "dais", .parts = {}};
    Geometry& trim = dais.part(materials.dressed_stone);
    for (int step = 0; step < 3; ++step) {
        const auto level = static_cast<float>(step);
        const float inset = 0.42F * level;
        add_box(trim, {-2.95F + 0.25F * level, -0.1F, -half_length_m - 0.1F},
                {2.95F - 0.25F * level, dais_height_m * (level + 1.0F) / 3.0F, dais_front_z_m - inset}, 0.035F);
    }
    const WallPlane end_wall{{0.0F, 0.0F, -half_length_m + 0.5F}, {1.0F, 0.0F, 0.0F}};
    const Opening niche{.half_width = 1.7F, .sill = 0.9F, .spring = 5.0F, .pointedness = 1.3F};
    add_pierced_wall(dais.part(materials.masonry), end_wall, {-3.3F, 3.3F, -0.1F, roof_low_m}, niche, niche, 0.6F,
                     arch_steps);
    std::vector<glm::vec2> curve =
        opening_outline({.half_width = 1.84F, .sill = 0.7F, .spring = 5.0F, .pointedness = 1.3F}, arch_steps);
    add_moulding(trim, end_wall, curve, 0.14F, 0.12F, 0.05F);
    // Altar block and the pedestal in the niche.
    add_box(trim, {-1.1F, dais_height_m - 0.05F, -15.5F}, {1.1F, 1.62F, -14.8F}, 0.04F);
    add_box(trim, {-1.25F, 1.60F, -15.62F}, {1.25F, 1.76F, -14.68F}, 0.05F);
    scene.place(scene.add_mesh(std::move(dais)), {0.0F, 0.0F, 0.0F});
}

} // namespace

void add_architecture(Scene& scene, const Materials& materials) {
    add_shell(scene, materials);
    add_window_dressing(scene, materials);
    add_pillars(scene, materials);
    add_arcades(scene, materials);
    add_vault(scene, materials);
    add_aisles(scene, materials);
    add_dais(scene, materials);
}

} // namespace tyndall::hall
