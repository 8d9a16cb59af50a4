#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "samples/hall/layout.hpp"

namespace tyndall::hall {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

std::size_t add_bench_mesh(Scene& scene, const Materials& materials) {
    Mesh mesh{.name = "bench", .parts = {}};
    Geometry& wood = mesh.part(materials.wood);
    add_box(wood, {-1.05F, 0.40F, -0.22F}, {1.05F, 0.46F, 0.24F}, 0.012F);
    add_box(wood, {-1.05F, 0.62F, 0.20F}, {1.05F, 0.92F, 0.25F}, 0.012F);
    add_box(wood, {-1.05F, 0.50F, 0.20F}, {1.05F, 0.58F, 0.24F});
    for (const float x : {-1.04F, 1.04F}) {
        add_box(wood, {x - 0.035F, 0.0F, -0.24F}, {x + 0.035F, 0.42F, 0.27F});
        add_box(wood, {x - 0.035F, 0.40F, 0.18F}, {x + 0.035F, 1.0F, 0.27F});
    }
    return scene.add_mesh(std::move(mesh));
}

std::size_t add_crate_mesh(Scene& scene, const Materials& materials) {
    Mesh mesh{.name = "crate", .parts = {}};
    Geometry& wood = mesh.part(materials.wood);
    constexpr float half = 0.42F;
    constexpr float rail = 0.07F;
    add_box(wood, {-half + 0.02F, 0.02F, -half + 0.02F}, {half - 0.02F, 2.0F * half - 0.02F, half - 0.02F});
    for (const float x : {-1.0F, 1.0F}) {
        for (const float z : {-1.0F, 1.0F}) {
            const glm::vec3 corner{x * (half - 0.5F * rail), half, z * (half - 0.5F * rail)};
            const glm::vec3 size{0.5F * rail, half, 0.5F * rail};
            add_box(wood, corner - size, corner + size, 0.008F);
        }
        for (const float y : {0.5F * rail, 2.0F * half - 0.5F * rail}) {
            add_box(wood, {x * (half - 0.5F * rail) - 0.5F * rail, y - 0.5F * rail, -half + rail},
                    {x * (half - 0.5F * rail) + 0.5F * rail, y + 0.5F * rail, half - rail});
            add_box(wood, {-half + rail, y - 0.5F * rail, x * (half - 0.5F * rail) - 0.5F * rail},
                    {half - rail, y + 0.5F * rail, x * (half - 0.5F * rail) + 0.5F * rail});
        }
    }
    return scene.add_mesh(std::move(mesh));
}

std::size_t add_barrel_mesh(Scene& scene, const Materials& materials) {
    Mesh mesh{.name = "barrel", .parts = {}};
    const std::vector<glm::vec2> staves{{0.30F, 0.0F},   {0.35F, 0.15F}, {0.385F, 0.34F}, {0.39F, 0.48F},
                                        {0.385F, 0.62F}, {0.35F, 0.81F}, {0.30F, 0.96F},  {0.27F, 0.96F},
                                        {0.27F, 0.92F},  {0.0F, 0.92F}};
    add_lathe(mesh.part(materials.wood), staves, {.segments = 16, .turn_uv_m = 2.0F});
    Geometry& iron = mesh.part(materials.iron);
    for (const float y : {0.13F, 0.30F, 0.62F, 0.79F}) {
        const float radius = y > 0.2F && y < 0.7F ? 0.389F : 0.353F;
        const std::vector<glm::vec2> hoop{
            {radius - 0.02F, y}, {radius, y}, {radius, y + 0.045F}, {radius - 0.02F, y + 0.045F}};
        add_lathe(iron, hoop, {.segments = 16});
    }
    return scene.add_mesh(std::move(mesh));
}

std::size_t add_urn_mesh(Scene& scene, const Materials& materials, std::size_t material, const char* name) {
    Mesh mesh{.name = name, .parts = {}};
    add_box(mesh.part(materials.dressed_stone), {-0.26F, 0.0F, -0.26F}, {0.26F, 0.10F, 0.26F}, 0.02F);
    const std::vector<glm::vec2> urn{{0.19F, 0.10F}, {0.20F, 0.13F}, {0.17F, 0.16F}, {0.11F, 0.20F},  {0.10F, 0.25F},
                                     {0.16F, 0.32F}, {0.26F, 0.46F}, {0.32F, 0.62F}, {0.335F, 0.76F}, {0.30F, 0.90F},
                                     {0.21F, 1.02F}, {0.16F, 1.10F}, {0.15F, 1.18F}, {0.20F, 1.25F},  {0.21F, 1.27F},
                                     {0.19F, 1.28F}, {0.13F, 1.20F}, {0.12F, 1.08F}, {0.0F, 1.0F}};
    add_lathe(mesh.part(material), urn, {.segments = 20});
    return scene.add_mesh(std::move(mesh));
}

/// A hanging of cloth with folds, 1 x 2.2 m, its top at y = 0, facing +x; with the pole that carries it.
std::size_t add_banner_mesh(Scene& scene, const Materials& materials) {
    Mesh mesh{.name = "banner", .parts = {}};
    Geometry& cloth = mesh.part(materials.banner);
    constexpr int columns = 16;
    constexpr int rows = 3;
    for (int row = 0; row <= rows; ++row) {
        for (int column = 0; column <= columns; ++column) {
            const glm::vec2 uv{static_cast<float>(column) / columns, static_cast<float>(row) / rows};
            const float depth = 0.02F + 0.05F * uv.y;
            const float phase = 4.0F * pi * uv.x + 1.2F * uv.y;
            const float slope = depth * 4.0F * pi * std::cos(phase); // d(offset)/d(across), 1 m wide
            cloth.vertices.push_back({.position = {0.09F + depth * std::sin(phase), -2.2F * uv.y, 0.5F - uv.x},
                                      .normal = glm::normalize(glm::vec3{1.0F, 0.0F, slope}),
                                      .uv = uv});
        }
    }
    for (std::uint32_t row = 0; row < rows; ++row) {
        for (std::uint32_t column = 0; column < columns; ++column) {
            const std::uint32_t a = row * (columns + 1) + column;
            join_quad(cloth, a, a + 1, a + columns + 2, a + columns + 1);
        }
    }
    add_bar(mesh.part(materials.iron), {0.09F, 0.0F, -0.6F}, {0.09F, 0.0F, 0.6F}, 0.02F);
    return scene.add_mesh(std::move(mesh));
}

void place_benches(Scene& scene, const Materials& materials) {
    const std::size_t bench = add_bench_mesh(scene, materials);
    for (int row = 0; row < 3; ++row) {
        const float z = -9.0F + 1.7F * static_cast<float>(row);
        scene.place(bench, {-1.85F, 0.0F, z});
        scene.place(bench, {1.85F, 0.0F, z}, row == 2 ? 0.05F : 0.0F);
    }
    scene.place(bench, {-6.3F, 0.0F, 2.0F}, -0.5F * pi);
    scene.place(bench, {-6.3F, 0.0F, -3.0F}, -0.5F * pi);
}

void place_stores(Scene& scene, const Materials& materials) {
    const std::size_t crate = add_crate_mesh(scene, materials);
    const std::size_t barrel = add_barrel_mesh(scene, materials);
    scene.place(crate, {5.9F, 0.0F, 3.3F}, 0.20F);
    scene.place(crate, {5.0F, 0.0F, 2.9F}, -0.35F);
    scene.place(crate, {5.6F, 0.84F, 3.1F}, 0.62F, 0.8F);
    scene.place(barrel, {4.6F, 0.0F, 4.3F});
    scene.place(barrel, {5.6F, 0.0F, -1.9F}, 0.8F);
    scene.place(crate, {-5.2F, 0.0F, 8.6F}, 0.3F);
    scene.place(barrel, {-4.3F, 0.0F, 9.1F}, 1.4F);
    scene.place(barrel, {-5.0F, 0.0F, -8.6F}, 2.0F);

    const std::size_t clay_urn = add_urn_mesh(scene, materials, materials.clay, "clay_urn");
    const std::size_t bronze_urn = add_urn_mesh(scene, materials, materials.bronze, "bronze_urn");
    scene.place(clay_urn, {-3.0F, 0.0F, 5.0F}, 0.2F, 1.1F);
    scene.place(clay_urn, {2.5F, 0.0F, 6.9F}, 0.6F);
    scene.place(clay_urn, {2.6F, 0.0F, 6.1F}, 0.1F, 0.62F);
    scene.place(bronze_urn, {-2.6F, 0.0F, -10.7F});
    scene.place(bronze_urn, {2.6F, 0.0F, -10.7F});
    scene.place(bronze_urn, {0.0F, 1.76F, -15.15F}, 0.0F, 0.55F);
    scene.place(bronze_urn, {0.0F, 0.66F, -16.9F}, 0.0F, 2.2F);
}

} // namespace

void add_furniture(Scene& scene, const Materials& materials) {
    place_benches(scene, materials);
    place_stores(scene, materials);
    const std::size_t banner = add_banner_mesh(scene, materials);
    for (const float z : pillar_z_m) {
        scene.place(banner, {-arcade_x_m + arcade_half_thickness_m, 7.85F, z});
        scene.place(banner, {arcade_x_m - arcade_half_thickness_m, 7.85F, z}, pi);
    }
    for (int bay = 1; bay < bay_count; bay += 2) {
        scene.place(banner, {-half_width_m, 5.6F, bay_center_m(bay)}, 0.0F, 1.5F);
    }
}

} // namespace tyndall::hall
