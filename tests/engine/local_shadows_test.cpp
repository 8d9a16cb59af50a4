// Which local lights get shadow maps, and where those look. No device.
#include <cmath>

#include <gtest/gtest.h>

#include "engine/local_shadows.hpp"

namespace tyndall::engine {
namespace {

Light spot(const glm::dvec3& position, float candela = 100.0F) {
    Light light;
    light.type = LightType::spot;
    light.intensity = glm::vec3(candela);
    light.position = position;
    light.direction = {0.0, -1.0, 0.0};
    light.range_m = 10.0;
    light.outer_cone_rad = 0.5F;
    return light;
}

Light point(const glm::dvec3& position) {
    Light light = spot(position);
    light.type = LightType::point;
    return light;
}

const Box floor{{-50.0, -1.0, -50.0}, {50.0, 0.0, 50.0}};

LocalShadowPlan plan(const std::vector<Light>& lights, const LocalShadowSettings& settings = {},
                     const std::vector<ShadowedLight>& before = {}, const glm::dvec3& eye_m = glm::dvec3(0.0)) {
    return plan_local_shadows(lights, std::span(&floor, 1), eye_m, settings, {}, before);
}

TEST(LocalShadows, SpotsCastByDefaultAndPointsWhereAsked) {
    std::vector<Light> lights{point({0, 3, 0}), spot({0, 3, 0})};
    EXPECT_EQ(plan(lights).lights, (std::vector<ShadowedLight>{{1, 0, 1}}));
    EXPECT_EQ(plan(lights, {.points = true}).lights, (std::vector<ShadowedLight>{{0, 0, 6}, {1, 6, 1}}));
    lights[0].casts_shadow = true;
    lights[1].casts_shadow = false;
    EXPECT_EQ(plan(lights).lights, (std::vector<ShadowedLight>{{0, 0, 6}}));
    lights[0].casts_shadow = false;
    EXPECT_TRUE(plan(lights, {.points = true}).lights.empty());
    EXPECT_EQ(plan(lights, {.points = true}).why_none, "no point or spot light is to cast any");
    EXPECT_EQ(plan({}).why_none, "the scene has no point or spot light");
}

TEST(LocalShadows, WideSpotsNeedACube) {
    Light wide = spot({0, 3, 0});
    wide.outer_cone_rad = 1.2F;
    EXPECT_EQ(plan({wide}).map_count, 6U);
}

TEST(LocalShadows, WhatLightsNoCasterGetsNoMap) {
    Light up = spot({0, 3, 0});
    up.direction = {0.0, 1.0, 0.0};
    const LocalShadowPlan none = plan({up, spot({0, 30, 0})});
    EXPECT_TRUE(none.lights.empty());
    EXPECT_EQ(none.why_none, "no caster stands in the light of one");
    ASSERT_EQ(none.without.size(), 2U);
    EXPECT_EQ(none.without[1], "local light 1: it shines on nothing that casts a shadow");
}

TEST(LocalShadows, GoToTheBrightestAtTheEyeAndStayForAWhile) {
    const std::vector<Light> lights{spot({9, 3, 0}), spot({0, 3, 0}), spot({30, 3, 0}, 2000.0F), spot({60, 3, 0})};
    const LocalShadowSettings two{.most_maps = 2}; // light 3 shines beside the floor
    const LocalShadowPlan first = plan(lights, two);
    EXPECT_EQ(first.lights, (std::vector<ShadowedLight>{{1, 0, 1}, {2, 1, 1}}));
    ASSERT_EQ(first.without.size(), 2U);
    EXPECT_EQ(first.without[1],
              "local light 0: the 2 maps that there may be went to lights that are brighter at the eye");
    EXPECT_EQ(first.most_maps, 2U);
    // Light 0 is a little nearer here, and not by so much that it were a quarter brighter.
    const glm::dvec3 between(4.6, 0.0, 0.0);
    const std::vector<ShadowedLight> fresh = plan({lights[0], lights[1]}, {.most_maps = 1}, {}, between).lights;
    EXPECT_EQ(fresh, (std::vector<ShadowedLight>{{0, 0, 1}}));
    EXPECT_EQ(plan({lights[0], lights[1]}, {.most_maps = 1}, {{1, 0, 1}}, between).lights,
              (std::vector<ShadowedLight>{{1, 0, 1}}));
    EXPECT_EQ(plan({lights[0], lights[1]}, {.most_maps = 1}, {{1, 0, 1}}, {7.0, 0.0, 0.0}).lights,
              (std::vector<ShadowedLight>{{0, 0, 1}}));
    EXPECT_TRUE(plan(lights, {.most_maps = 0}).lights.empty());
    EXPECT_EQ(plan(lights, {.most_maps = 0}).why_none, "the settings allow too few maps");
}

/// uv and near / z as the header of the record describes them.
glm::dvec3 place(const gpu::LocalShadow& shadow, std::uint32_t side, const glm::dvec3& p) {
    const glm::dvec4 at(p, 1.0);
    const glm::dvec3 c(glm::dot(glm::dvec4(shadow.row_x), at), glm::dot(glm::dvec4(shadow.row_y), at),
                       glm::dot(glm::dvec4(shadow.row_z), at));
    const int axis = shadow.lens.w > 0.5F ? static_cast<int>(side / 2) : 2;
    const double z = side % 2 == 1 ? -c[axis] : c[axis];
    const double scale = static_cast<double>(shadow.lens.x);
    return {0.5 + scale * c[(axis + 1) % 3] / z, 0.5 + scale * c[(axis + 2) % 3] / z,
            static_cast<double>(shadow.lens.y) / z};
}

TEST(LocalShadows, MapsHoldTheConeWithABorder) {
    Light light = spot({2, 5, -1});
    light.direction = glm::normalize(glm::dvec3(0.3, -0.8, 0.5));
    const glm::dvec3 origin_m(10.0, 20.0, 30.0);
    const LocalShadowSettings settings{.resolution = 512};
    const gpu::LocalShadow shadow = make_local_shadow(light, {0, 3, 1}, origin_m, settings);
    EXPECT_EQ(shadow.lens.z, 3.0F);
    EXPECT_EQ(shadow.lens.w, 0.0F);
    EXPECT_NEAR(shadow.texel.x, 2.0 * std::tan(0.5) / 508.0, 1e-6);
    const glm::dvec3 x = glm::normalize(glm::cross(light.direction, glm::dvec3(0.0, 1.0, 0.0)));
    double farthest = 0.0;
    for (int i = 0; i < 64; ++i) {
        const double turn = 0.1 * i;
        const glm::dvec3 across = std::cos(turn) * x + std::sin(turn) * glm::cross(x, light.direction);
        const glm::dvec3 rim = light.position + 4.0 * (light.direction + std::tan(0.5) * across) - origin_m;
        const glm::dvec3 uv = place(shadow, 0, rim);
        EXPECT_NEAR(uv.z, settings.spot_near_m / 4.0, 1e-6);
        farthest = std::max({farthest, std::abs(uv.x - 0.5), std::abs(uv.y - 0.5)});
    }
    EXPECT_NEAR(farthest, 0.5 - 2.0 / 512.0, 1e-3);
    EXPECT_LE(farthest, 0.5 - 2.0 / 512.0 + 1e-6);
}

// Whatever a map can see of a box is not culled; what stands elsewhere is.
TEST(LocalShadows, CastersAreCulledByTheMapsFrustumAndTheRange) {
    Light tilted = spot({0, 0, 0});
    tilted.direction = glm::normalize(glm::dvec3(0.5, -0.4, -0.8));
    for (const Light& light : {tilted, point({0, 0, 0})}) {
        std::size_t kept = 0;
        std::size_t needed = 0;
        const std::uint32_t count = shadow_map_count(light);
        const gpu::LocalShadow shadow = make_local_shadow(light, {0, 0, count}, glm::dvec3(0.0), {});
        for (int i = 0; i < 4000; ++i) {
            const glm::dvec3 p(8.0 * std::sin(1.7 * i), 8.0 * std::sin(2.3 * i + 1.0), 8.0 * std::sin(3.1 * i + 2.0));
            const Box box{p - 0.2, p + 0.2};
            for (std::uint32_t side = 0; side < count; ++side) {
                const glm::dvec3 uv = place(shadow, side, p);
                const bool seen = uv.z > 0.0 && uv.x > 0.0 && uv.x < 1.0 && uv.y > 0.0 && uv.y < 1.0 &&
                                  glm::length(p) < *light.range_m;
                const bool casts = may_cast_into(light, side, *light.range_m, box);
                EXPECT_TRUE(casts || !seen);
                kept += casts ? 1U : 0U;
                needed += seen ? 1U : 0U;
            }
        }
        EXPECT_GT(needed, 100U);
        EXPECT_LT(static_cast<double>(kept), 1.5 * static_cast<double>(needed));
    }
}

} // namespace
} // namespace tyndall::engine
