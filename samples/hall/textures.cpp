#include "samples/hall/textures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "samples/hall/noise.hpp"

namespace tyndall::hall {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

/// What a surface is at one texel.
struct Texel {
    glm::vec3 albedo{0.5F};
    float height = 0.0F; // in texel widths
    float occlusion = 1.0F;
    float roughness = 0.8F;
};

/// Evaluates `shade(uv)` on a tile and turns it into the three images; heights wrap around, so that normals tile too.
template <typename Shade>
SurfaceTextures bake(int size, const Shade& shade) {
    std::vector<Texel> texels;
    texels.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            texels.push_back(shade((glm::vec2{x, y} + 0.5F) / static_cast<float>(size)));
        }
    }
    const auto at = [&](int x, int y) -> const Texel& {
        const int wrapped_x = (x + size) % size;
        const int wrapped_y = (y + size) % size;
        return texels[static_cast<std::size_t>(wrapped_y) * static_cast<std::size_t>(size) +
                      static_cast<std::size_t>(wrapped_x)];
    };
    SurfaceTextures result{Image(size, size, 3), Image(size, size, 3), Image(size / 2, size / 2, 3)};
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const Texel& texel = at(x, y);
            result.base_color.set(x, y, glm::vec4{to_srgb(texel.albedo), 1.0F}, 4);
            const float along_u = 0.5F * (at(x + 1, y).height - at(x - 1, y).height);
            const float along_v = 0.5F * (at(x, y + 1).height - at(x, y - 1).height); // downwards in the image
            const glm::vec3 normal = glm::normalize(glm::vec3{-along_u, along_v, 1.0F});
            // 255/2 is no whole number: the flat normal is stored as 128, as glTF asks.
            result.normal.set(x, y, glm::vec4{normal * 0.5F + 0.5F + 0.001F, 1.0F}, 4);
            if (x % 2 == 0 && y % 2 == 0) {
                result.surface.set(x / 2, y / 2, {texel.occlusion, texel.roughness, 0.0F, 1.0F}, 4);
            }
        }
    }
    return result;
}

/// 0 on an edge of the unit cell, rising to 1 within `width`.
float inside_edge(glm::vec2 cell_uv, glm::vec2 width) {
    const glm::vec2 distance = glm::min(cell_uv, 1.0F - cell_uv) / width;
    return glm::smoothstep(0.0F, 1.0F, std::min(distance.x, distance.y));
}

Texel shade_floor(glm::vec2 uv) {
    constexpr int slabs = 4;
    const float ragged = 0.012F * (fractal_noise(uv, 16, 3, 11U) - 0.5F);
    const glm::vec2 scaled = (uv + ragged * 0.25F) * static_cast<float>(slabs);
    const glm::ivec2 cell = glm::ivec2(glm::floor(scaled)) & (slabs - 1);
    const glm::vec2 local = scaled - glm::floor(scaled);
    const float flat = inside_edge(local, glm::vec2{0.035F});
    const float tone = hash01(cell.x, cell.y, 3U);
    const float hue = hash01(cell.x, cell.y, 4U);
    const float grain = fractal_noise(uv, 24, 4, 5U);
    const float clouds = fractal_noise(uv, 5, 4, 6U);
    const bool dark = ((cell.x + cell.y) & 1) != 0;
    const glm::vec3 stone =
        glm::mix(glm::vec3{0.40F, 0.34F, 0.27F}, glm::vec3{0.33F, 0.31F, 0.29F}, hue) * (dark ? 0.62F : 1.0F);
    const float shade = 0.72F + 0.32F * tone + 0.30F * (grain - 0.5F) + 0.25F * (clouds - 0.5F);
    const float worn = glm::smoothstep(0.35F, 0.65F, clouds);
    return {.albedo = glm::mix(glm::vec3{0.07F, 0.06F, 0.05F}, stone * shade, 0.25F + 0.75F * flat),
            .height = 3.2F * flat + 1.6F * grain * (1.0F - 0.6F * worn) + 1.2F * (tone - 0.5F),
            .occlusion = 0.55F + 0.45F * flat,
            .roughness =
                glm::mix(0.92F, glm::mix(0.58F, 0.30F, worn) + 0.18F * (grain - 0.5F) + 0.1F * (tone - 0.5F), flat)};
}

Texel shade_masonry(glm::vec2 uv) {
    constexpr int courses = 6;
    const float ragged = 0.010F * (fractal_noise(uv, 24, 3, 21U) - 0.5F);
    const float row_position = (uv.y + ragged) * static_cast<float>(courses);
    const int row = static_cast<int>(std::floor(row_position)) % courses;
    const int blocks = 3; // with unequal joints below
    const float shift = (row % 2 == 0 ? 0.0F : 0.5F) + 0.22F * (hash01(row, 0, 22U) - 0.5F);
    const float column_position = (uv.x + ragged) * static_cast<float>(blocks) + shift;
    const int column = (static_cast<int>(std::floor(column_position)) + blocks) % blocks;
    const glm::vec2 local{column_position - std::floor(column_position), row_position - std::floor(row_position)};
    const float flat = inside_edge(local, {0.035F, 0.06F});
    const float tone = hash01(column, row, 23U);
    const float hue = hash01(column, row, 24U);
    const float grain = fractal_noise(uv, 32, 3, 25U);
    const float stains = fractal_noise(uv, 4, 4, 26U);
    const float pits = glm::smoothstep(0.70F, 0.78F, fractal_noise(uv, 40, 2, 27U));
    const glm::vec3 stone = glm::mix(glm::vec3{0.47F, 0.40F, 0.31F}, glm::vec3{0.40F, 0.37F, 0.33F}, hue);
    const float shade = 0.76F + 0.26F * tone + 0.30F * (grain - 0.5F) + 0.36F * (stains - 0.5F) - 0.20F * pits;
    return {.albedo = glm::mix(glm::vec3{0.22F, 0.19F, 0.16F}, stone * shade, 0.3F + 0.7F * flat),
            .height = 2.4F * flat + 1.8F * grain - 1.0F * pits + 0.6F * tone,
            .occlusion = 0.6F + 0.4F * flat,
            .roughness = 0.80F + 0.20F * (grain - 0.5F) + 0.08F * (1.0F - flat)};
}

Texel shade_wood(glm::vec2 uv) {
    constexpr int planks = 4;
    const float row_position = uv.y * static_cast<float>(planks);
    const int row = static_cast<int>(std::floor(row_position)) % planks;
    const glm::vec2 local{0.5F, row_position - std::floor(row_position)};
    const float flat = inside_edge(local, glm::vec2{0.04F});
    const float tone = hash01(row, 0, 31U);
    const float bend = fractal_noise(uv, 4, 3, 32U);
    const float rings = 0.5F + 0.5F * std::sin(2.0F * pi * (uv.y * 22.0F + 2.5F * bend));
    const float fibre = fractal_noise(uv, 48, 2, 33U);
    const glm::vec3 oak = glm::mix(glm::vec3{0.20F, 0.115F, 0.055F}, glm::vec3{0.105F, 0.06F, 0.03F}, rings * 0.8F);
    return {.albedo = oak * (0.7F + 0.5F * tone + 0.4F * (fibre - 0.5F)) * (0.35F + 0.65F * flat),
            .height = 3.0F * flat + 0.9F * rings + 0.8F * fibre,
            .occlusion = 0.6F + 0.4F * flat,
            .roughness = 0.62F + 0.2F * (fibre - 0.5F) + 0.12F * rings};
}

float segment_distance(glm::vec2 p, glm::vec2 a, glm::vec2 b) {
    const glm::vec2 along = b - a;
    const float t = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0F, 1.0F);
    return glm::distance(p, a + along * t);
}

/// Nearest and second nearest of a jittered lattice of seeds over the unit square.
struct Cell {
    glm::ivec2 id{0};
    float edge = 0.0F; // distance to the boundary between the two, in lattice cells
};

Cell voronoi(glm::vec2 point, std::uint32_t seed) {
    const glm::ivec2 base = glm::ivec2(glm::floor(point));
    float nearest = 1.0e9F;
    float second = 1.0e9F;
    Cell cell;
    for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
            const glm::ivec2 id = base + glm::ivec2{dx, dy};
            const glm::vec2 jitter{hash01(id.x, id.y, seed), hash01(id.x, id.y, seed + 1U)};
            const float distance = glm::distance(point, glm::vec2(id) + 0.15F + 0.7F * jitter);
            if (distance < nearest) {
                second = nearest;
                nearest = distance;
                cell.id = id;
            } else {
                second = std::min(second, distance);
            }
        }
    }
    cell.edge = 0.5F * (second - nearest);
    return cell;
}

} // namespace

SurfaceTextures make_floor_textures() {
    return bake(512, shade_floor);
}

SurfaceTextures make_masonry_textures() {
    return bake(512, shade_masonry);
}

SurfaceTextures make_wood_textures() {
    return bake(256, shade_wood);
}

Image make_grille_texture() {
    constexpr int size = 256;
    Image image(size, size, 4);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const glm::vec2 p = (glm::vec2{x, y} + 0.5F) / static_cast<float>(size);
            const glm::vec2 c = p - 0.5F;
            // Square frame, diagonal lattice, a ring in the middle and one at the corners.
            float distance = std::min({p.x, 1.0F - p.x, p.y, 1.0F - p.y}) - 0.012F;
            distance = std::min(distance, std::abs(std::abs(c.x) + std::abs(c.y) - 0.5F) * 0.7071F - 0.012F);
            distance = std::min(distance, std::abs(glm::length(c) - 0.20F) - 0.022F);
            distance = std::min(distance, std::abs(glm::length(glm::abs(c) - 0.5F) - 0.17F) - 0.018F);
            distance = std::min(distance, segment_distance(glm::abs(c), {0.0F, 0.2F}, {0.0F, 0.5F}) - 0.016F);
            distance = std::min(distance, segment_distance(glm::abs(c), {0.2F, 0.0F}, {0.5F, 0.0F}) - 0.016F);
            distance = std::min(distance, glm::length(c) - 0.06F);
            const float alpha = 0.5F - distance * static_cast<float>(size) * 0.5F;
            const float rust = fractal_noise(p, 16, 3, 41U);
            const glm::vec3 iron = glm::mix(glm::vec3{0.030F, 0.028F, 0.027F}, glm::vec3{0.075F, 0.045F, 0.028F},
                                            glm::smoothstep(0.5F, 0.7F, rust));
            image.set(x, y, glm::vec4{to_srgb(iron), alpha}, 4);
        }
    }
    return image;
}

Image make_stained_glass_texture() {
    constexpr int width = 128;
    constexpr int height = 384;
    constexpr std::array<glm::vec3, 6> palette{glm::vec3{0.85F, 0.10F, 0.06F}, glm::vec3{0.95F, 0.55F, 0.06F},
                                               glm::vec3{0.07F, 0.22F, 0.80F}, glm::vec3{0.06F, 0.50F, 0.42F},
                                               glm::vec3{0.45F, 0.10F, 0.60F}, glm::vec3{0.90F, 0.80F, 0.45F}};
    Image image(width, height, 4);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const glm::vec2 p = (glm::vec2{x, y} + 0.5F) / static_cast<float>(width); // v runs to 3
            const glm::vec2 mirrored{std::abs(p.x - 0.5F), p.y};                      // the design is symmetric
            const Cell cell = voronoi(mirrored * 7.0F, 51U);
            // A row of medallions over a field of small pieces.
            const float medallion = std::abs(p.y - 0.75F - std::round(p.y - 0.75F));
            const float ring = glm::length(glm::vec2{mirrored.x, medallion});
            const bool inside = ring < 0.30F;
            const auto pick = static_cast<std::size_t>(hash01(cell.id.x, cell.id.y, 53U) * (inside ? 2.0F : 3.0F) +
                                                       (inside ? 0.0F : 2.0F));
            glm::vec3 color = palette[std::min(pick, palette.size() - 1)];
            if (ring < 0.13F) {
                color = palette[5];
            }
            color *= 0.65F + 0.5F * hash01(cell.id.x, cell.id.y, 54U);
            const float border = std::min(0.5F - mirrored.x, std::min(p.y, 3.0F - p.y));
            if (border < 0.07F) {
                color =
                    glm::mix(palette[0], palette[2], hash01(0, static_cast<int>(p.y * 6.0F), 55U) > 0.5F ? 1.0F : 0.0F);
            }
            float lead = std::min(cell.edge / 7.0F, std::abs(ring - 0.30F));
            lead = std::min({lead, std::abs(ring - 0.13F), std::abs(border - 0.07F), border});
            const bool came = lead < 0.010F;
            image.set(x, y, came ? glm::vec4{0.03F, 0.03F, 0.03F, 1.0F} : glm::vec4{to_srgb(color), 0.82F});
        }
    }
    return image;
}

Image make_quarry_glass_texture() {
    constexpr int size = 128;
    constexpr int quarries = 4;
    Image image(size, size, 4);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const glm::vec2 p = (glm::vec2{x, y} + 0.5F) * (static_cast<float>(quarries) / static_cast<float>(size));
            const glm::vec2 skewed{p.x + p.y, p.x - p.y};
            const glm::ivec2 cell = glm::ivec2(glm::floor(skewed));
            const glm::vec2 local = skewed - glm::vec2(cell);
            const glm::vec2 edge = glm::min(local, 1.0F - local);
            // The skewed lattice repeats after `quarries` steps along x and along y.
            const int column = (cell.x + cell.y) & (2 * quarries - 1);
            const int row = (cell.x - cell.y) & (2 * quarries - 1);
            const float tone = hash01(column, row, 71U);
            const bool came = std::min(edge.x, edge.y) < 0.055F;
            image.set(x, y,
                      came ? glm::vec4{0.10F, 0.10F, 0.10F, 1.0F}
                           : glm::vec4{to_srgb(glm::vec3{0.45F + 0.55F * tone}), 0.55F + 0.25F * tone});
        }
    }
    return image;
}

Image make_banner_texture() {
    constexpr int width = 192;
    constexpr int height = 384;
    Image image(width, height, 3);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const glm::vec2 p = (glm::vec2{x, y} + 0.5F) / static_cast<float>(width); // v runs to 2
            const float border = std::min(std::min(p.x, 1.0F - p.x), std::min(p.y, 2.0F - p.y));
            const glm::vec2 c = p - glm::vec2{0.5F, 0.8F};
            const float radius = glm::length(c);
            const float angle = std::atan2(c.y, c.x);
            const float rays = 0.20F + 0.09F * std::pow(std::abs(std::cos(angle * 6.0F)), 2.0F);
            const bool gold =
                (border > 0.05F && border < 0.085F) || radius < 0.14F || (radius > 0.165F && radius < rays);
            const float weave = (((x + y) % 4) < 2 ? 0.93F : 1.07F);
            const glm::vec3 cloth = gold ? glm::vec3{0.62F, 0.40F, 0.10F} : glm::vec3{0.30F, 0.022F, 0.026F};
            image.set(x, y, glm::vec4{to_srgb(cloth * weave), 1.0F}, 4);
        }
    }
    return image;
}

} // namespace tyndall::hall
