// Where the sun's cascades lie: properties over many cameras.
#include "engine/cascades.hpp"

#include <cmath>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "engine/camera.hpp"
#include "tests/random_geometry.hpp"

namespace tyndall::engine {
namespace {

Camera looking(const glm::dvec3& eye, const glm::dvec3& along) {
    const glm::dvec3 up = std::abs(along.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
    Camera camera;
    camera.world_from_camera = glm::inverse(glm::lookAt(eye, eye + along, up));
    return camera;
}

constexpr VkExtent2D size = {1280, 720};

Box box_around(const glm::dvec3& center, double half) {
    Box box;
    box.grow(center - half);
    box.grow(center + half);
    return box;
}

glm::dvec3 in_shadow_space(const CascadesFit& fit, std::uint32_t cascade, const glm::dvec3& world) {
    return glm::dvec3(shadow_from_render(fit, cascade, glm::dvec3(0.0)) * glm::dvec4(world, 1.0));
}

std::array<glm::dvec3, 8> corners(const Box& box) {
    std::array<glm::dvec3, 8> out;
    for (int i = 0; i < 8; ++i) {
        out[static_cast<std::size_t>(i)] = {(i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                                            (i & 4) != 0 ? box.max.z : box.min.z};
    }
    return out;
}

TEST(Cascades, HoldEveryPointOfTheirSliceWithRoomForTheFilter) {
    test::RandomGeometry dice(7);
    for (int round = 0; round < 300; ++round) {
        Camera camera = looking(dice.point(200.0), dice.direction());
        camera.perspective.fov_y_rad = dice.in(0.1, 2.2);
        if (round % 5 == 0) {
            camera.orthographic = Orthographic{dice.in(1.0, 30.0), dice.in(1.0, 30.0), 0.0, 80.0};
        }
        const FrameView view = make_view(camera, size);
        const Box casters = box_around(dice.point(50.0), dice.in(0.5, 60.0));
        const CascadesFit fit = fit_cascades(view, casters, dice.direction(), {});
        const ViewRays rays = view_rays(view);
        const glm::dmat4 render_from_view = glm::inverse(view.view_from_render);
        for (std::uint32_t i = 0; i < fit.count; ++i) {
            for (const double depth_m : {fit.cascades[i].start_depth_m, fit.cascades[i].end_depth_m}) {
                for (int corner = 0; corner < 4; ++corner) {
                    const glm::dvec2 uv(corner & 1, corner >> 1);
                    glm::dvec3 point = depth_m * (rays.origin + uv.x * rays.u + uv.y * rays.v);
                    if (camera.orthographic) {
                        const double half_y = camera.orthographic->half_height_m;
                        const glm::dvec2 xy = (2.0 * uv - 1.0) * glm::dvec2(half_y * 16.0 / 9.0, half_y);
                        point = glm::dvec3(render_from_view * glm::dvec4(xy, -depth_m, 1.0));
                    }
                    const glm::dvec3 p = in_shadow_space(fit, i, view.origin_m + point);
                    const double margin = 3.0 / fit.resolution;
                    EXPECT_GE(std::min(p.x, p.y), margin - 1e-9) << "round " << round << " cascade " << i;
                    EXPECT_LE(std::max(p.x, p.y), 1.0 - margin + 1e-9) << "round " << round << " cascade " << i;
                }
            }
        }
    }
}

TEST(Cascades, PointsOfTheWorldKeepTheirPlaceInTheTexelWhateverTheCameraDoes) {
    test::RandomGeometry dice(7);
    const Box casters = box_around({3.0, 2.0, -4.0}, 20.0);
    const glm::dvec3 sun = glm::normalize(glm::dvec3(-0.5, -0.7, 0.3));
    const glm::dvec3 landmark(1.234, 0.5, -2.718);
    const CascadesFit first =
        fit_cascades(make_view(looking({0.0, 2.0, 5.0}, {0.0, 0.0, -1.0}), size), casters, sun, {});
    for (int round = 0; round < 300; ++round) {
        const glm::dvec3 eye = glm::dvec3(0.0, 2.0, 5.0) + dice.point(0.7);
        const CascadesFit fit = fit_cascades(make_view(looking(eye, dice.direction()), size), casters, sun, {});
        for (std::uint32_t i = 0; i < fit.count; ++i) {
            ASSERT_EQ(fit.cascades[i].texel_m, first.cascades[i].texel_m) << "the size changed";
            const glm::dvec3 moved = (in_shadow_space(fit, i, landmark) - in_shadow_space(first, i, landmark)) *
                                     static_cast<double>(fit.resolution);
            EXPECT_NEAR(moved.x, std::round(moved.x), 1e-6);
            EXPECT_NEAR(moved.y, std::round(moved.y), 1e-6);
            EXPECT_EQ(moved.z, 0.0) << "depth moved";
        }
    }
}

TEST(Cascades, StayWhereTheyAreForMovementsWithinATexel) {
    const Box casters = box_around({0.0, 0.0, 0.0}, 10.0);
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0.3, -1.0, 0.2));
    const FrameView view = make_view(looking({0.11, 1.7, 12.03}, {0.0, 0.0, -1.0}), size);
    const CascadesFit fit = fit_cascades(view, casters, sun, {});
    int same = 0;
    int all = 0;
    for (int step = 1; step <= 20; ++step) {
        FrameView moved = view;
        moved.origin_m.x += 0.02 * step * fit.cascades[0].texel_m;
        const CascadesFit other = fit_cascades(moved, casters, sun, {});
        for (std::uint32_t i = 0; i < fit.count; ++i, ++all) {
            const glm::dvec2 apart = (other.cascades[i].center_m - fit.cascades[i].center_m) / fit.cascades[i].texel_m;
            EXPECT_LE(std::max(std::abs(apart.x), std::abs(apart.y)), 1.0 + 1e-9);
            same += same_texels(fit, other, i) ? 1 : 0;
        }
    }
    EXPECT_GE(same, all / 2); // nearly all movements stay within a texel: the image is drawn again for the others only
}

TEST(Cascades, DepthSpansAllCasters) {
    test::RandomGeometry dice(7);
    for (int round = 0; round < 300; ++round) {
        Box casters = box_around(dice.point(1000.0), dice.in(1e-3, 300.0));
        if (round % 3 == 0) {
            casters.max.y = casters.min.y; // flat
        }
        const FrameView view = make_view(looking(dice.point(100.0), dice.direction()), size);
        const CascadesFit fit = fit_cascades(view, casters, dice.direction(), {});
        for (const glm::dvec3& corner : corners(casters)) {
            const double z = in_shadow_space(fit, 0, corner).z;
            EXPECT_GT(z, 0.0);
            EXPECT_LT(z, 1.0);
        }
    }
}

TEST(Cascades, SlicesFollowEachOtherUpToTheRange) {
    const FrameView view = make_view(looking({0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}), size);
    const CascadesFit fit = fit_cascades(view, box_around({}, 5.0), {0.0, -1.0, 0.0}, {.count = 3, .range_m = 40.0});
    EXPECT_EQ(fit.count, 3U);
    EXPECT_EQ(fit.cascades[0].start_depth_m, 0.0);
    EXPECT_EQ(fit.cascades[0].end_depth_m, fit.cascades[1].start_depth_m);
    EXPECT_EQ(fit.cascades[1].end_depth_m, fit.cascades[2].start_depth_m);
    EXPECT_NEAR(fit.cascades[2].end_depth_m, 40.0, 1e-9);
    const gpu::SunCascades gpu = make_sun_cascades(fit, view.origin_m, glm::vec3(1.0F));
    EXPECT_EQ(gpu.direction_count.w, 3.0F);
    EXPECT_FLOAT_EQ(gpu.split_depth_m[3], 40.0F); // the unused one repeats the last
    EXPECT_FLOAT_EQ(gpu.direction_count.y, -1.0F);
}

TEST(Cascades, NoCasterIsLeftOutThatShadowsTheSlice) {
    test::RandomGeometry dice(7);
    int left_out = 0;
    for (int round = 0; round < 400; ++round) {
        const FrameView view = make_view(looking(dice.point(20.0), dice.direction()), size);
        const Box casters = box_around({}, 60.0);
        const CascadesFit fit = fit_cascades(view, casters, dice.direction(), {});
        const Box caster = box_around(dice.point(55.0), dice.in(0.1, 5.0));
        for (std::uint32_t i = 0; i < fit.count; ++i) {
            if (may_cast_into(fit, i, caster)) {
                continue;
            }
            ++left_out;
            for (int sample = 0; sample < 30; ++sample) {
                const glm::dvec3 t(dice.in(0.0, 1.0), dice.in(0.0, 1.0), dice.in(0.0, 1.0));
                const glm::dvec3 point = caster.min + t * caster.extent();
                const glm::dvec3 p = in_shadow_space(fit, i, point);
                const bool across = std::min(p.x, p.y) < 0.0 || std::max(p.x, p.y) > 1.0;
                const bool behind = (fit.light_from_world * point).z > fit.cascades[i].farthest_m;
                EXPECT_TRUE(across || behind);
            }
        }
    }
    EXPECT_GT(left_out, 100); // it does leave casters out
}

TEST(Cascades, ExtremeViewsStayFinite) {
    for (const double fov_deg : {0.1, 45.0, 170.0}) {
        for (const double scale : {1e-3, 1.0, 1e6}) {
            Camera camera = looking({0.0, 0.0, 3.0 * scale}, {0.0, 0.0, -1.0});
            camera.perspective.fov_y_rad = glm::radians(fov_deg);
            camera.perspective.near_m = 0.01 * scale;
            const CascadesFit fit = fit_cascades(make_view(camera, size), box_around({}, scale), {0.0, -1.0, 0.0}, {});
            const gpu::SunCascades gpu = make_sun_cascades(fit, {}, glm::vec3(1.0F));
            for (int i = 0; i < 4; ++i) {
                EXPECT_TRUE(std::isfinite(gpu.split_depth_m[i]) && gpu.split_depth_m[i] > 0.0F);
                EXPECT_TRUE(std::isfinite(gpu.texel_m[i]) && gpu.texel_m[i] > 0.0F);
                for (int column = 0; column < 4; ++column) {
                    for (int row = 0; row < 4; ++row) {
                        EXPECT_TRUE(std::isfinite(gpu.shadow_from_render[i][column][row]));
                    }
                }
            }
        }
    }
}

TEST(Camera, DepthIsReversedAndTheFarPlaneIsFound) {
    Camera camera = looking({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});
    camera.perspective.near_m = 0.5;
    EXPECT_EQ(far_depth_m(make_view(camera, size)), std::numeric_limits<double>::infinity());
    camera.perspective.far_m = 80.0;
    const FrameView view = make_view(camera, size);
    EXPECT_NEAR(far_depth_m(view), 80.0, 1e-9);
    const auto device_depth = [&](double depth_m) {
        const glm::dvec4 clip = view.clip_from_view * glm::dvec4(0.0, 0.0, -depth_m, 1.0);
        return clip.z / clip.w;
    };
    EXPECT_NEAR(device_depth(0.5), 1.0, 1e-12);
    EXPECT_NEAR(device_depth(80.0), 0.0, 1e-12);
    EXPECT_NEAR(device_depth(10.0), 0.5 * (80.0 - 10.0) / (79.5 * 10.0), 1e-12);
}

TEST(Camera, RaysPassThroughThePixelsThatPointsFallOn) {
    test::RandomGeometry dice(7);
    const FrameView view = make_view(looking({5.0, 1.0, 2.0}, glm::normalize(glm::dvec3(1.0, -0.4, 0.2))), size);
    const ViewRays rays = view_rays(view);
    for (int round = 0; round < 100; ++round) {
        const glm::dvec2 uv(dice.in(0.0, 1.0), dice.in(0.0, 1.0));
        const double depth_m = dice.in(0.2, 100.0);
        const glm::dvec3 p = depth_m * (rays.origin + uv.x * rays.u + uv.y * rays.v);
        const glm::dvec4 clip = view.clip_from_view * view.view_from_render * glm::dvec4(p, 1.0);
        EXPECT_NEAR(clip.x / clip.w * 0.5 + 0.5, uv.x, 1e-9);
        EXPECT_NEAR(clip.y / clip.w * 0.5 + 0.5, uv.y, 1e-9); // framebuffer y runs down, and so does v
        EXPECT_NEAR(view_depth_m(view, view.origin_m + p), depth_m, 1e-9);
    }
    // Up in the world is up in the image.
    const glm::dvec4 above =
        view.clip_from_view * view.view_from_render * glm::dvec4(glm::normalize(glm::dvec3(1.0, -0.3, 0.2)), 1.0);
    EXPECT_LT(above.y, 0.0);
}

} // namespace
} // namespace tyndall::engine
