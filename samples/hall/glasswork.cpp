#include <numbers>
#include <utility>

#include "samples/hall/arches.hpp"
#include "samples/hall/layout.hpp"

namespace tyndall::hall {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr int arch_steps = 10;

/// Leaded glass over the whole opening of some windows, grilles in others; about z = 0.
void add_window_fillings(Scene& scene, const Materials& materials) {
    const WallPlane wall{{half_width_m, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}};
    const Opening opening{.half_width = window_half_width_m + 0.1F,
                          .sill = window_sill_m - 0.1F,
                          .spring = window_spring_m,
                          .pointedness = window_pointedness};
    Mesh leaded{.name = "leaded_window", .parts = {}};
    add_filling(leaded.part(materials.stained_glass), wall, opening, 0.50F, arch_steps, true);
    Mesh barred{.name = "barred_window", .parts = {}};
    add_filling(barred.part(materials.grille), wall, opening, 0.36F, arch_steps, false);
    const std::size_t leaded_mesh = scene.add_mesh(std::move(leaded));
    const std::size_t barred_mesh = scene.add_mesh(std::move(barred));
    for (const int bay : {1, 3, 4}) {
        scene.place(leaded_mesh, {0.0F, 0.0F, bay_center_m(bay)});
    }
    scene.place(barred_mesh, {0.0F, 0.0F, bay_center_m(5)});
}

/// A pane in an iron frame, 0.9 x 1.5 m about the origin, facing z, on two rods up to `rod_m` above its middle.
std::size_t add_pane_mesh(Scene& scene, const Materials& materials, std::size_t glass, const char* name, float rod_m) {
    Mesh mesh{.name = name, .parts = {}};
    constexpr float half_x = 0.45F;
    constexpr float half_y = 0.75F;
    constexpr float half_z = 0.006F;
    add_box(mesh.part(glass), {-half_x, -half_y, -half_z}, {half_x, half_y, half_z});
    Geometry& iron = mesh.part(materials.iron);
    for (const float x : {-half_x, half_x}) {
        add_bar(iron, {x, -half_y, 0.0F}, {x, half_y, 0.0F}, 0.018F);
        add_bar(iron, {x * 0.8F, half_y, 0.0F}, {x * 0.8F, rod_m, 0.0F}, 0.007F);
    }
    for (const float y : {-half_y, 0.0F, half_y}) {
        add_bar(iron, {-half_x, y, 0.0F}, {half_x, y, 0.0F}, 0.018F);
    }
    return scene.add_mesh(std::move(mesh));
}

/// A folding screen: three standing panes of different colours, about the origin on the floor.
std::size_t add_screen_mesh(Scene& scene, const Materials& materials) {
    Mesh mesh{.name = "glass_screen", .parts = {}};
    const float width = 0.8F;
    const float height = 1.9F;
    glm::vec3 hinge{-1.5F * width * 0.93F, 0.0F, 0.0F};
    for (std::size_t i = 0; i < 3; ++i) {
        const float angle = i == 1 ? -0.38F : 0.38F;
        const glm::vec3 along{std::cos(angle), 0.0F, -std::sin(angle)};
        const glm::vec3 facing{std::sin(angle), 0.0F, std::cos(angle)};
        const glm::vec3 end = hinge + along * width;
        const glm::vec3 low{0.0F, 0.12F, 0.0F};
        const glm::vec3 high{0.0F, height, 0.0F};
        add_quad(mesh.part(materials.panes[i == 1 ? 0 : i + 1]), {hinge + low, end + low, end + high, hinge + high},
                 facing);
        Geometry& iron = mesh.part(materials.iron);
        add_bar(iron, hinge, hinge + high, 0.022F);
        add_bar(iron, end, end + high, 0.022F);
        add_bar(iron, hinge + low, end + low, 0.018F);
        add_bar(iron, hinge + high, end + high, 0.018F);
        add_bar(iron, hinge + 0.65F * high, end + 0.65F * high, 0.012F);
        hinge = end;
    }
    return scene.add_mesh(std::move(mesh));
}

/// An iron screen between two pillars of the left row, 2.4 m high, about z = 0.
void add_grille_screens(Scene& scene, const Materials& materials) {
    Mesh mesh{.name = "grille_screen", .parts = {}};
    constexpr float half = 1.95F;
    add_quad(mesh.part(materials.grille),
             {glm::vec3{0.0F, 0.1F, half}, glm::vec3{0.0F, 0.1F, -half}, glm::vec3{0.0F, 2.3F, -half},
              glm::vec3{0.0F, 2.3F, half}},
             {1.0F, 0.0F, 0.0F});
    Geometry& iron = mesh.part(materials.iron);
    for (const float z : {-half, 0.0F, half}) {
        add_bar(iron, {0.0F, 0.0F, z}, {0.0F, 2.45F, z}, 0.03F);
    }
    for (const float y : {0.1F, 2.3F}) {
        add_bar(iron, {0.0F, y, -half}, {0.0F, y, half}, 0.025F);
    }
    const std::size_t screen = scene.add_mesh(std::move(mesh));
    scene.place(screen, {-arcade_x_m, 0.0F, bay_center_m(2)});
    scene.place(screen, {-arcade_x_m, 0.0F, bay_center_m(1)});
}

} // namespace

void add_glasswork(Scene& scene, const Materials& materials) {
    add_window_fillings(scene, materials);
    add_grille_screens(scene, materials);
    // In the shafts of three windows, turned so that each shows the camera its face.
    constexpr float pane_height_m = 3.1F;
    constexpr float rod_m = 8.6F;
    const std::array<const char*, 4> names{"amber_pane", "ruby_pane", "cobalt_pane", "emerald_pane"};
    const std::array<glm::vec3, 4> places{
        glm::vec3{2.5F, pane_height_m, -1.9F}, glm::vec3{-0.6F, pane_height_m + 0.5F, -2.4F},
        glm::vec3{1.7F, pane_height_m, 3.6F}, glm::vec3{1.2F, pane_height_m + 0.8F, -8.4F}};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::size_t pane = add_pane_mesh(scene, materials, materials.panes[i], names[i], rod_m);
        scene.place(pane, places[i], -0.25F + 0.22F * static_cast<float>(i));
    }
    const std::size_t screen = add_screen_mesh(scene, materials);
    scene.place(screen, {-1.5F, 0.0F, 1.2F}, 0.10F * pi);
}

} // namespace tyndall::hall
