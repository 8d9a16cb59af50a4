// Nodes, cameras, lights, and what a scene gets that has none.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "tests/engine/gltf_fixture.hpp"

namespace tyndall::engine::test {
namespace {

Scene loaded(const GltfFile& file) {
    auto scene = file.load();
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? std::move(*scene) : Scene{};
}

void expect_near(const glm::dvec3& actual, const glm::dvec3& expected, double tolerance = 1e-9) {
    EXPECT_NEAR(glm::distance(actual, expected), 0.0, tolerance)
        << actual.x << " " << actual.y << " " << actual.z << " instead of " << expected.x << " " << expected.y << " "
        << expected.z;
}

glm::dvec3 apply(const glm::dmat4& transform, const glm::dvec3& point) {
    return glm::dvec3(transform * glm::dvec4(point, 1.0));
}

TEST(GltfScene, TransformsOfParentsApplyAfterThoseOfChildren) {
    GltfFile file;
    file.add_triangle();
    file.root["nodes"][0]["translation"] = {1, 0, 0};
    // 90 degrees about +Y turns +X to -Z; scale first, then rotation, then translation.
    const double half = std::sqrt(0.5);
    file.add("nodes",
             {{"children", {0}}, {"translation", {0, 5, 0}}, {"rotation", {0, half, 0, half}}, {"scale", {2, 2, 2}}});
    const Scene scene = loaded(file);
    ASSERT_EQ(scene.instances.size(), 1U);
    expect_near(apply(scene.instances[0].world_from_object, {0, 0, 0}), {0, 5, -2});
    expect_near(apply(scene.instances[0].world_from_object, {1, 0, 0}), {0, 5, -4});
    EXPECT_FALSE(scene.instances[0].mirrored);
    expect_near(scene.bounds.min, {0, 5, -4});
    expect_near(scene.bounds.max, {0, 7, -2});
}

TEST(GltfScene, MatricesAreColumnMajorAndMirroringIsFound) {
    GltfFile file;
    file.add_triangle();
    file.root["nodes"][0]["matrix"] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 4, 5, 1};
    const Scene scene = loaded(file);
    expect_near(apply(scene.instances.at(0).world_from_object, {1, 0, 0}), {2, 4, 5});
    EXPECT_TRUE(scene.instances[0].mirrored);
}

TEST(GltfScene, NodesThatShowOneMeshShareItsPrimitive) {
    GltfFile file;
    file.add_triangle();
    file.add("nodes", {{"mesh", 0}, {"translation", {10, 0, 0}}});
    const Scene scene = loaded(file);
    EXPECT_EQ(scene.primitives.size(), 1U);
    ASSERT_EQ(scene.instances.size(), 2U);
    EXPECT_EQ(scene.instances[1].primitive, 0U);
    expect_near(scene.bounds.max, {11, 1, 0});
}

TEST(GltfScene, OnlyTheChosenSceneIsShown) {
    GltfFile file;
    file.add_triangle();
    file.add("nodes", {{"mesh", 0}, {"translation", {10, 0, 0}}});
    file.root["scenes"] = json::parse(R"([{"nodes":[0]},{"nodes":[1]}])");
    EXPECT_EQ(loaded(file).bounds.min.x, 0.0) << "the first without 'scene'";
    file.root["scene"] = 1;
    EXPECT_EQ(loaded(file).bounds.min.x, 10.0);
}

TEST(GltfScene, ChainsOfNodesDeeperThanAnyStackLoad) {
    GltfFile file;
    file.add_triangle();
    json& nodes = file.root["nodes"];
    constexpr int depth = 50000;
    nodes[0]["translation"] = {1, 0, 0};
    for (int i = 1; i < depth; ++i) {
        nodes.push_back({{"children", {i - 1}}, {"translation", {1, 0, 0}}});
    }
    EXPECT_EQ(loaded(file).bounds.min.x, depth);
}

TEST(GltfScene, PerspectiveCameraIsPlacedAndFreedOfScale) {
    GltfFile file;
    file.add_triangle();
    file.add("cameras", {{"type", "perspective"},
                         {"name", "eye"},
                         {"perspective", {{"yfov", 0.5}, {"znear", 0.25}, {"zfar", 50}, {"aspectRatio", 1.5}}}});
    const double half = std::sqrt(0.5);
    file.add("nodes",
             {{"camera", 0}, {"translation", {1, 2, 3}}, {"rotation", {0, half, 0, half}}, {"scale", {3, 4, 5}}});
    const Scene scene = loaded(file);
    ASSERT_EQ(scene.cameras.size(), 1U);
    const Camera& camera = scene.cameras[0];
    EXPECT_EQ(camera.name, "eye");
    EXPECT_FALSE(camera.orthographic);
    EXPECT_EQ(camera.perspective.fov_y_rad, 0.5);
    EXPECT_EQ(camera.perspective.near_m, 0.25);
    EXPECT_EQ(camera.perspective.far_m, 50.0);
    EXPECT_EQ(camera.perspective.aspect, 1.5);
    expect_near(apply(camera.world_from_camera, {0, 0, -1}), {0, 2, 3});
    expect_near(apply(camera.world_from_camera, {0, 1, 0}), {1, 3, 3});
    EXPECT_FALSE(has_note(scene, "no camera"));
}

TEST(GltfScene, CameraWithoutFarPlaneIsInfinite) {
    GltfFile file;
    file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}});
    file.add("nodes", {{"camera", 0}, {"name", "from the node"}});
    const Scene scene = loaded(file);
    EXPECT_FALSE(scene.cameras.at(0).perspective.far_m);
    EXPECT_FALSE(scene.cameras.at(0).perspective.aspect);
    EXPECT_EQ(scene.cameras.at(0).name, "from the node");
}

TEST(GltfScene, OrthographicCameraIsRead) {
    GltfFile file;
    file.add("cameras",
             {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 3}, {"znear", 0}, {"zfar", 9}}}});
    file.add("nodes", {{"camera", 0}});
    const std::optional<Orthographic> orthographic = loaded(file).cameras.at(0).orthographic;
    ASSERT_TRUE(orthographic);
    EXPECT_EQ(orthographic->half_width_m, 2.0);
    EXPECT_EQ(orthographic->half_height_m, 3.0);
    EXPECT_EQ(orthographic->near_m, 0.0);
    EXPECT_EQ(orthographic->far_m, 9.0);
}

/// A file with these lights, light i on node i.
GltfFile with_lights(const json& lights) {
    GltfFile file;
    file.root["extensionsRequired"] = {"KHR_lights_punctual"};
    file.root["extensions"]["KHR_lights_punctual"]["lights"] = lights;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        file.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
    }
    return file;
}

TEST(GltfScene, LightsOfAllTypesAreReadInTheirUnits) {
    GltfFile file = with_lights(
        {{{"type", "directional"}, {"intensity", 90000}, {"color", {1.0, 0.5, 0.25}}},
         {{"type", "point"}, {"intensity", 40}, {"range", 12}, {"name", "bulb"}},
         {{"type", "spot"}, {"intensity", 500}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}}});
    // -90 degrees about +X turns -Z, the way that lights shine, to -Y.
    const double half = std::sqrt(0.5);
    file.root["nodes"][0]["rotation"] = {-half, 0, 0, half};
    file.root["nodes"][1]["translation"] = {1, 2, 3};
    const Scene scene = loaded(file);
    ASSERT_EQ(scene.lights.size(), 3U);
    EXPECT_EQ(scene.lights[0].type, LightType::directional);
    EXPECT_EQ(scene.lights[0].intensity, glm::vec3(90000.0F, 45000.0F, 22500.0F));
    expect_near(scene.lights[0].direction, {0, -1, 0});
    EXPECT_EQ(scene.lights[1].type, LightType::point);
    EXPECT_EQ(scene.lights[1].name, "bulb");
    EXPECT_EQ(scene.lights[1].intensity, glm::vec3(40.0F));
    EXPECT_EQ(scene.lights[1].range_m, 12.0);
    expect_near(scene.lights[1].position, {1, 2, 3});
    EXPECT_EQ(scene.lights[2].type, LightType::spot);
    EXPECT_FALSE(scene.lights[2].range_m);
    EXPECT_EQ(scene.lights[2].inner_cone_rad, 0.2F);
    EXPECT_EQ(scene.lights[2].outer_cone_rad, 0.4F);
    EXPECT_FALSE(has_note(scene, "no light"));
}

TEST(GltfScene, ExtrasOfLightsSayWhichCastShadows) {
    const Scene scene = loaded(
        with_lights({{{"type", "point"}, {"extras", {{"shadow", true}, {"shadow_near_m", 0.4}}}},
                     {{"type", "spot"}, {"spot", json::object()}, {"extras", {{"shadow", false}, {"mood", "grim"}}}},
                     {{"type", "spot"}, {"spot", json::object()}},
                     {{"type", "spot"}, {"spot", json::object()}, {"extras", {{"shadow", 1}, {"shadow_near_m", 0}}}},
                     {{"type", "spot"}, {"spot", json::object()}, {"extras", {{"shadow", "yes"}}}}}));
    EXPECT_EQ(scene.lights.at(0).casts_shadow, true);
    EXPECT_EQ(scene.lights.at(0).shadow_near_m, 0.4);
    EXPECT_EQ(scene.lights.at(1).casts_shadow, false);
    for (std::size_t i = 2; i < 5; ++i) {
        EXPECT_FALSE(scene.lights.at(i).casts_shadow);
        EXPECT_FALSE(scene.lights.at(i).shadow_near_m);
    }
    EXPECT_TRUE(has_note(scene, "Light 3 has an extra 'shadow' that is neither true nor false, which is left out."));
    EXPECT_TRUE(has_note(scene, "Light 4 has an extra 'shadow' that is neither"));
    EXPECT_TRUE(has_note(scene, "Light 3 has an extra 'shadow_near_m' that is not between 0.001 and 1000"));
}

TEST(GltfScene, ImpossibleLightsAreBroughtBackWithANote) {
    const Scene scene =
        loaded(with_lights({{{"type", "point"}, {"intensity", -1}},
                            {{"type", "spot"}, {"spot", {{"innerConeAngle", 2}, {"outerConeAngle", 9}}}}}));
    EXPECT_EQ(scene.lights.at(0).intensity, glm::vec3(0.0F));
    EXPECT_TRUE(has_note(scene, "Light 0 has an intensity outside of its range"));
    EXPECT_NEAR(scene.lights.at(1).outer_cone_rad, std::numbers::pi / 2, 1e-6);
    EXPECT_LT(scene.lights.at(1).inner_cone_rad, scene.lights.at(1).outer_cone_rad);
}

TEST(GltfScene, SceneWithoutCameraIsFramedWhole) {
    for (const double scale : {1e-3, 1.0, 1e4}) {
        GltfFile file;
        file.add_triangle();
        file.root["nodes"][0]["scale"] = {scale, scale, scale};
        file.root["nodes"][0]["translation"] = {7, 8, 9};
        const Scene scene = loaded(file);
        ASSERT_EQ(scene.cameras.size(), 1U);
        EXPECT_TRUE(has_note(scene, "The scene has no camera"));
        const Camera& camera = scene.cameras[0];
        const glm::dmat4 camera_from_world = glm::inverse(camera.world_from_camera);
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 pick(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
            const glm::dvec3 view = apply(camera_from_world, glm::mix(scene.bounds.min, scene.bounds.max, pick));
            const double slope = std::tan(0.5 * camera.perspective.fov_y_rad);
            EXPECT_GT(-view.z, camera.perspective.near_m) << scale;
            EXPECT_LT(std::abs(view.y), slope * -view.z) << scale;
            EXPECT_LT(std::abs(view.x), slope * -view.z) << scale;
        }
    }
}

TEST(GltfScene, SceneWithoutLightGetsASunFromAboveOnTheSideThatTheCameraSees) {
    GltfFile file;
    file.add_triangle();
    const Scene scene = loaded(file);
    ASSERT_EQ(scene.lights.size(), 1U);
    EXPECT_TRUE(has_note(scene, "The scene has no light"));
    EXPECT_EQ(scene.lights[0].type, LightType::directional);
    EXPECT_NEAR(glm::length(scene.lights[0].direction), 1.0, 1e-12);
    EXPECT_LT(scene.lights[0].direction.y, -0.5);
    const glm::dvec3 forward = -glm::dvec3(scene.cameras[0].world_from_camera[2]);
    EXPECT_GT(glm::dot(scene.lights[0].direction, forward), 0.5);
}

TEST(GltfScene, EmptySceneLoadsAndSaysSo) {
    const Scene scene = loaded(GltfFile{});
    EXPECT_TRUE(scene.bounds.empty());
    EXPECT_TRUE(has_note(scene, "The scene shows no triangle."));
    EXPECT_EQ(scene.cameras.size(), 1U);
    EXPECT_EQ(scene.materials.size(), 1U);
}

TEST(GltfScene, AnimationsSkinsAndMorphTargetsAreNoted) {
    GltfFile file;
    file.add_triangle();
    file.root["animations"] = json::parse(R"([{"channels":[],"samplers":[]}])");
    file.root["skins"] = json::parse(R"([{"joints":[0]}])");
    file.root["nodes"][0]["skin"] = 0;
    file.root["meshes"][0]["primitives"][0]["targets"] = json::parse(R"([{"POSITION":0}])");
    const Scene scene = loaded(file);
    EXPECT_EQ(scene.instances.size(), 1U);
    EXPECT_TRUE(has_note(scene, "Animations are left out"));
    EXPECT_TRUE(has_note(scene, "Skins are left out"));
    EXPECT_TRUE(has_note(scene, "Morph targets are left out"));
}

TEST(GltfScene, ProgressGrowsToOne) {
    GltfFile file;
    file.add_triangle();
    const TemporaryFolder folder;
    std::vector<double> fractions;
    ASSERT_TRUE(load_gltf(folder.write("test.gltf", file.text()),
                          [&](std::string_view, double fraction) { fractions.push_back(fraction); }));
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    EXPECT_EQ(fractions.front(), 0.0);
    EXPECT_EQ(fractions.back(), 1.0);
}

} // namespace
} // namespace tyndall::engine::test
