#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "samples/hall/layout.hpp"
#include "samples/hall/noise.hpp"

namespace tyndall::hall {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr glm::vec3 candle_color{1.0F, 0.60F, 0.26F};
constexpr glm::vec3 fire_color{1.0F, 0.46F, 0.14F};

/// Where a lantern hangs from the axis of its pillar.
constexpr float lantern_reach_m = 0.92F;
constexpr float lantern_height_m = 3.0F;

void add_flame(Geometry& geometry, glm::vec3 foot, float height_m, float radius_m) {
    const std::vector<glm::vec2> profile{{0.0F, 0.0F},
                                         {0.7F * radius_m, 0.10F * height_m},
                                         {radius_m, 0.30F * height_m},
                                         {0.62F * radius_m, 0.60F * height_m},
                                         {0.25F * radius_m, 0.84F * height_m},
                                         {0.0F, height_m}};
    Geometry flame;
    add_lathe(flame, profile, {.segments = 8});
    append(geometry, flame, glm::translate(glm::mat4{1.0F}, foot));
}

/// An iron bracket with a six-sided lantern; x points away from the pillar, y = 0 is the floor.
std::size_t add_lantern_mesh(Scene& scene, const Materials& materials) {
    Mesh mesh{.name = "lantern", .parts = {}};
    Geometry& iron = mesh.part(materials.iron);
    add_box(iron, {0.36F, lantern_height_m + 0.20F, -0.05F}, {0.53F, lantern_height_m + 0.70F, 0.05F}, 0.01F);
    add_bar(iron, {0.46F, lantern_height_m + 0.62F, 0.0F}, {lantern_reach_m + 0.06F, lantern_height_m + 0.62F, 0.0F},
            0.02F);
    add_bar(iron, {0.50F, lantern_height_m + 0.26F, 0.0F}, {0.82F, lantern_height_m + 0.60F, 0.0F}, 0.016F);
    add_bar(iron, {lantern_reach_m, lantern_height_m + 0.40F, 0.0F}, {lantern_reach_m, lantern_height_m + 0.62F, 0.0F},
            0.010F);
    Geometry cage;
    const std::vector<glm::vec2> cap{{0.20F, 0.19F}, {0.205F, 0.215F}, {0.12F, 0.31F},
                                     {0.05F, 0.35F}, {0.045F, 0.41F},  {0.0F, 0.43F}};
    const std::vector<glm::vec2> cap_below{{0.0F, 0.19F}, {0.20F, 0.19F}};
    const std::vector<glm::vec2> plate{
        {0.0F, -0.24F}, {0.05F, -0.24F}, {0.17F, -0.19F}, {0.17F, -0.16F}, {0.0F, -0.16F}};
    add_lathe(cage, cap, {.segments = 6, .faceted = true});
    add_lathe(cage, cap_below, {.segments = 6, .faceted = true});
    add_lathe(cage, plate, {.segments = 6, .faceted = true});
    for (int i = 0; i < 6; ++i) {
        const float angle = pi / 3.0F * static_cast<float>(i);
        const glm::vec3 around{std::cos(angle), 0.0F, -std::sin(angle)};
        add_bar(cage, around * 0.155F + glm::vec3{0.0F, -0.17F, 0.0F}, around * 0.175F + glm::vec3{0.0F, 0.20F, 0.0F},
                0.009F);
    }
    const glm::mat4 hung = glm::translate(glm::mat4{1.0F}, {lantern_reach_m, lantern_height_m, 0.0F});
    append(iron, cage, hung);
    Geometry glass;
    const std::vector<glm::vec2> panes{{0.145F, -0.16F}, {0.165F, 0.19F}};
    add_lathe(glass, panes, {.segments = 6, .faceted = true});
    append(mesh.part(materials.lantern_glass), glass, hung);
    add_flame(mesh.part(materials.flame), {lantern_reach_m, lantern_height_m - 0.12F, 0.0F}, 0.20F, 0.045F);
    return scene.add_mesh(std::move(mesh));
}

void add_lantern(Scene& scene, std::size_t mesh, glm::vec3 pillar, float turn_rad) {
    scene.place(mesh, pillar, turn_rad);
    const glm::vec3 away{std::cos(turn_rad), 0.0F, -std::sin(turn_rad)};
    scene.add_light({.name = "lantern_light",
                     .kind = LightKind::point,
                     .color = candle_color,
                     .intensity = 1100.0F,
                     .range_m = 6.0F},
                    pillar + away * lantern_reach_m + glm::vec3{0.0F, lantern_height_m, 0.0F});
}

/// A bowl of coals on three legs, y = 0 at its feet.
std::size_t add_brazier_mesh(Scene& scene, const Materials& materials) {
    Mesh mesh{.name = "brazier", .parts = {}};
    Geometry& bronze = mesh.part(materials.bronze);
    const std::vector<glm::vec2> bowl{{0.0F, 0.70F},  {0.16F, 0.71F}, {0.30F, 0.78F}, {0.40F, 0.92F},
                                      {0.43F, 1.02F}, {0.45F, 1.02F}, {0.46F, 1.04F}, {0.45F, 1.06F},
                                      {0.41F, 1.06F}, {0.38F, 0.96F}, {0.28F, 0.88F}, {0.0F, 0.86F}};
    add_lathe(bronze, bowl, {.segments = 24});
    Geometry& iron = mesh.part(materials.iron);
    for (int i = 0; i < 3; ++i) {
        const float angle = 2.0F * pi / 3.0F * static_cast<float>(i) + 0.4F;
        const glm::vec3 around{std::cos(angle), 0.0F, -std::sin(angle)};
        add_bar(iron, around * 0.46F, around * 0.24F + glm::vec3{0.0F, 0.80F, 0.0F}, 0.022F);
        add_bar(iron, around * 0.36F + glm::vec3{0.0F, 0.34F, 0.0F}, glm::vec3{0.0F, 0.34F, 0.0F}, 0.014F);
    }
    Geometry coal;
    const std::vector<glm::vec2> lump{
        {0.0F, -0.07F}, {0.055F, -0.04F}, {0.07F, 0.01F}, {0.04F, 0.055F}, {0.0F, 0.065F}};
    add_lathe(coal, lump, {.segments = 6, .faceted = true});
    Geometry& embers = mesh.part(materials.embers);
    Geometry& flames = mesh.part(materials.flame);
    for (int i = 0; i < 12; ++i) {
        const float radius = 0.33F * std::sqrt(hash01(i, 0, 61U));
        const float angle = 2.0F * pi * hash01(i, 1, 61U);
        const glm::vec3 at{radius * std::cos(angle), brazier_bowl_m - 0.03F - 0.16F * radius, radius * std::sin(angle)};
        const glm::mat4 pose = glm::rotate(glm::translate(glm::mat4{1.0F}, at), 6.0F * hash01(i, 2, 61U),
                                           glm::normalize(glm::vec3{1.0F, 2.0F * hash01(i, 3, 61U), 0.4F}));
        append(embers, coal, pose);
    }
    for (int i = 0; i < 6; ++i) {
        const float radius = 0.20F * std::sqrt(hash01(i, 0, 62U));
        const float angle = 2.0F * pi * hash01(i, 1, 62U);
        add_flame(flames, {radius * std::cos(angle), brazier_bowl_m, radius * std::sin(angle)},
                  0.40F - 1.0F * radius + 0.12F * hash01(i, 2, 62U), 0.05F + 0.02F * hash01(i, 3, 62U));
    }
    return scene.add_mesh(std::move(mesh));
}

/// A ring of candles on three chains from the vault; y = 0 is the ring.
std::size_t add_chandelier_mesh(Scene& scene, const Materials& materials) {
    Mesh mesh{.name = "chandelier", .parts = {}};
    Geometry& iron = mesh.part(materials.iron);
    const std::vector<glm::vec2> ring{
        {0.86F, -0.05F}, {0.92F, -0.05F}, {0.92F, 0.05F}, {0.86F, 0.05F}, {0.86F, -0.05F}};
    add_lathe(iron, ring, {.segments = 24});
    const glm::vec3 knot{0.0F, 1.5F, 0.0F};
    add_bar(iron, knot, {0.0F, 6.0F, 0.0F}, 0.012F);
    for (int i = 0; i < 3; ++i) {
        const float angle = 2.0F * pi / 3.0F * static_cast<float>(i);
        const glm::vec3 rim{0.89F * std::cos(angle), 0.04F, 0.89F * std::sin(angle)};
        add_bar(iron, rim, knot, 0.010F);
        add_bar(iron, rim, {0.0F, 0.04F, 0.0F}, 0.014F);
    }
    Geometry& wax = mesh.part(materials.lantern_glass);
    Geometry& cups = mesh.part(materials.bronze);
    const std::vector<glm::vec2> cup{{0.0F, 0.05F}, {0.07F, 0.06F}, {0.08F, 0.09F}, {0.0F, 0.09F}};
    const std::vector<glm::vec2> candle{{0.035F, 0.09F}, {0.035F, 0.26F}, {0.0F, 0.26F}};
    for (int i = 0; i < 8; ++i) {
        const float angle = 2.0F * pi / 8.0F * static_cast<float>(i) + 0.2F;
        const glm::vec3 at{0.89F * std::cos(angle), 0.0F, 0.89F * std::sin(angle)};
        const glm::mat4 pose = glm::translate(glm::mat4{1.0F}, at);
        Geometry holder;
        add_lathe(holder, cup, {.segments = 8});
        append(cups, holder, pose);
        Geometry stick;
        add_lathe(stick, candle, {.segments = 8});
        append(wax, stick, pose);
        add_flame(mesh.part(materials.flame), at + glm::vec3{0.0F, 0.27F, 0.0F}, 0.11F, 0.022F);
    }
    return scene.add_mesh(std::move(mesh));
}

} // namespace

void add_lamps(Scene& scene, const Materials& materials) {
    const std::size_t lantern = add_lantern_mesh(scene, materials);
    for (std::size_t i = 0; i + 1 < pillar_z_m.size(); ++i) {
        // The left row lights the nave; the right row, which the sun passes, alternates between nave and aisle.
        add_lantern(scene, lantern, {-arcade_x_m, 0.0F, pillar_z_m[i]}, 0.0F);
        add_lantern(scene, lantern, {arcade_x_m, 0.0F, pillar_z_m[i]}, i % 2 == 0 ? pi : 0.5F * pi);
    }
    const std::size_t chandelier = add_chandelier_mesh(scene, materials);
    for (const float z : {-7.0F, 2.0F}) {
        const glm::vec3 at{0.0F, 6.2F, z};
        scene.place(chandelier, at);
        scene.add_light({.name = "chandelier_light",
                         .kind = LightKind::point,
                         .color = candle_color,
                         .intensity = 1200.0F,
                         .range_m = 8.0F},
                        at + glm::vec3{0.0F, 0.3F, 0.0F});
    }
    const std::size_t brazier = add_brazier_mesh(scene, materials);
    for (const glm::vec3 position : brazier_positions_m) {
        scene.place(brazier, position, 0.7F * position.x);
        scene.add_light({.name = "brazier_light",
                         .kind = LightKind::point,
                         .color = fire_color,
                         .intensity = 1300.0F,
                         .range_m = 7.0F},
                        position + glm::vec3{0.0F, brazier_bowl_m + 0.35F, 0.0F});
    }
}

} // namespace tyndall::hall
