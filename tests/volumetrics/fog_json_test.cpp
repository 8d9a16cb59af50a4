// Every mistake in a fog file is refused with one sentence that names the key.
#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "features/volumetrics/fog_json.hpp"

namespace tyndall::volumetrics {
namespace {

std::string refusal(std::string_view text) {
    const auto fog = parse_fog_json(text);
    return fog ? "accepted" : fog.error().message;
}

/// Of a refusal, up to its first comma.
std::string begin_of(const std::string& sentence) {
    return sentence.substr(0, sentence.find(','));
}

TEST(FogJson, EmptyObjectGivesDocumentedDefaults) {
    const auto fog = parse_fog_json("{}");
    ASSERT_TRUE(fog) << fog.error().message;
    EXPECT_TRUE(is_empty(fog->medium));
    EXPECT_EQ(fog->settings.grid.width, 160U);
    EXPECT_EQ(fog->settings.grid.height, 90U);
    EXPECT_EQ(fog->settings.grid.slices, 64U);
    EXPECT_EQ(fog->settings.grid.range_m, 64.0F);
    EXPECT_EQ(fog->settings.grid.shape_m, 16.0F);
    EXPECT_EQ(fog->settings.storage, StorageFormat::fp16);
    EXPECT_TRUE(fog->settings.temporal.enabled);
}

TEST(FogJson, ReadsEveryKey) {
    const auto fog = parse_fog_json(R"({
        "medium": {
            "homogeneous": {"extinction_per_m": 0.02, "albedo": [0.9, 0.8, 0.7], "emission_per_m": [3, 2, 1]},
            "height": {"extinction_per_m": 0.05, "albedo": [0.6, 0.5, 0.4], "base_height_m": -3, "falloff_per_m": 0.3,
                       "emission_per_m": [0, 4, 5]},
            "noise": {"amplitude": 0.6, "scale_m": 3, "wind_m_s": [0.5, 0, -0.25], "octaves": 3,
                      "gain": 0.75}},
        "phase": {"g": -0.4},
        "ambient": {"radiance": [1, 2, 3]},
        "grid": {"width": 40, "height": 23, "slices": 16, "range_m": 100, "shape_m": 0.01},
        "shadow": {"esm_exponent": [100, 200, 300, 400]},
        "temporal": {"enabled": false, "new_frame_weight": 0.1, "jitter": false},
        "storage": "fp32", "integrator": "exponential_quadratic", "error_estimate": true,
        "visibility": {"method": "n_taps", "taps": 7}, "light_path": "march", "light_path_steps": 5})");
    ASSERT_TRUE(fog) << fog.error().message;
    const Medium& m = fog->medium;
    EXPECT_EQ(m.homogeneous.extinction_per_m, 0.02F);
    EXPECT_EQ(m.homogeneous.albedo, glm::vec3(0.9F, 0.8F, 0.7F));
    EXPECT_EQ(m.homogeneous.emission_per_m, glm::vec3(3, 2, 1));
    EXPECT_EQ(m.height.emission_per_m, glm::vec3(0, 4, 5));
    EXPECT_EQ(m.height.extinction_per_m, 0.05F);
    EXPECT_EQ(m.height.albedo, glm::vec3(0.6F, 0.5F, 0.4F));
    EXPECT_EQ(m.height.base_height_m, -3.0F);
    EXPECT_EQ(m.height.falloff_per_m, 0.3F);
    EXPECT_EQ(m.noise.amplitude, 0.6F);
    EXPECT_EQ(m.noise.scale_m, 3.0F);
    EXPECT_EQ(m.noise.wind_m_s, glm::vec3(0.5F, 0.0F, -0.25F));
    EXPECT_EQ(m.noise.octaves, 3U);
    EXPECT_EQ(m.noise.gain, 0.75F);
    EXPECT_EQ(m.phase_g, -0.4F);
    EXPECT_EQ(m.ambient_radiance, glm::vec3(1, 2, 3));
    const Settings& s = fog->settings;
    EXPECT_EQ(s.grid.width, 40U);
    EXPECT_EQ(s.grid.height, 23U);
    EXPECT_EQ(s.grid.slices, 16U);
    EXPECT_EQ(s.grid.range_m, 100.0F);
    EXPECT_EQ(s.grid.shape_m, 0.01F);
    EXPECT_EQ(s.shadow.esm_exponent, (std::array{100.0F, 200.0F, 300.0F, 400.0F}));
    EXPECT_FALSE(s.temporal.enabled);
    EXPECT_EQ(s.temporal.new_frame_weight, 0.1F);
    EXPECT_FALSE(s.temporal.jitter);
    EXPECT_EQ(s.storage, StorageFormat::fp32);
    EXPECT_EQ(s.integrator, Integrator::exponential_quadratic);
    EXPECT_TRUE(s.error_estimate);
    EXPECT_EQ(s.visibility.method, SunVisibility::n_taps);
    EXPECT_EQ(s.visibility.taps, 7U);
    EXPECT_EQ(s.light_path, LightPath::march);
    EXPECT_EQ(s.light_path_steps, 5U);
}

TEST(FogJson, ReadsExtinctionOfEachChannel) {
    const auto fog = parse_fog_json(R"({"medium": {
        "homogeneous": {"extinction_per_m": [0.1, 0.4, 0]},
        "height": {"extinction_per_m": [0, 0, 0]},
        "volumes": [{"extinction_per_m": [2, 1, 0.5]}, {"extinction_per_m": 3}]}})");
    ASSERT_TRUE(fog) << fog.error().message;
    const Medium& m = fog->medium;
    EXPECT_EQ(m.homogeneous.extinction_per_m, 0.4F);
    EXPECT_EQ(m.homogeneous.extinction_color, glm::vec3(0.25F, 1.0F, 0.0F));
    EXPECT_EQ(m.height.extinction_per_m, 0.0F);
    EXPECT_EQ(m.volumes[0].extinction_per_m, 2.0F);
    EXPECT_EQ(m.volumes[0].extinction_color, glm::vec3(1.0F, 0.5F, 0.25F));
    EXPECT_EQ(m.volumes[1].extinction_color, glm::vec3(1.0F));
    EXPECT_TRUE(is_colored(m));
    EXPECT_EQ(refusal(R"({"medium": {"homogeneous": {"extinction_per_m": [1, 2]}}})"),
              "medium.homogeneous.extinction_per_m must be a number or an array of 3 numbers.");
    EXPECT_EQ(refusal(R"({"medium": {"height": {"extinction_per_m": [1, NaN, 2]}}})"),
              "medium.height.extinction_per_m[1] must be between 0 and 1e+06, not nan.");
    EXPECT_EQ(refusal(R"({"medium": {"volumes": [{"extinction_per_m": [1, 2, -3]}]}})"),
              "medium.volumes[0].extinction_per_m[2] must be between 0 and 1e+06, not -3.");
}

TEST(FogJson, ShapeFollowsRangeUnlessGiven) {
    const auto fog = parse_fog_json(R"({"grid": {"range_m": 1000}})");
    ASSERT_TRUE(fog);
    EXPECT_EQ(fog->settings.grid.shape_m, 250.0F);
}

TEST(FogJson, UnknownKeysAreNamedByPath) {
    EXPECT_EQ(refusal(R"({"fog": {}})"),
              "fog is not a key here, where the keys are airlight, ambient, error_estimate, grid, integrator, "
              "light_path, light_path_steps, medium, phase, shadow, storage, temporal, visibility.");
    EXPECT_EQ(refusal(R"({"medium": {"height": {"fallof_per_m": 1}}})"),
              "medium.height.fallof_per_m is not a key here, where the keys are albedo, base_height_m, "
              "emission_per_m, extinction_per_m, falloff_per_m.");
}

TEST(FogJson, RepeatedKeysAreRefused) {
    EXPECT_EQ(refusal(R"({"phase": {"g": 0.1, "g": 0.2}})"), R"(The fog file gives the key "g" twice in one object.)");
}

TEST(FogJson, WrongTypesAreNamedByPath) {
    EXPECT_EQ(refusal("[]"), "The fog file must be an object.");
    EXPECT_EQ(refusal(R"({"medium": 3})"), "medium must be an object.");
    EXPECT_EQ(refusal(R"({"phase": {"g": "0.5"}})"), "phase.g must be a number.");
    EXPECT_EQ(refusal(R"({"ambient": {"radiance": [1, 2]}})"), "ambient.radiance must be an array of 3 numbers.");
    EXPECT_EQ(refusal(R"({"ambient": {"radiance": [1, null, 2]}})"), "ambient.radiance[1] must be a number.");
    EXPECT_EQ(refusal(R"({"grid": {"slices": 1.5}})"),
              "grid.slices must be a whole number between 8 and 512, not 1.5.");
    EXPECT_EQ(refusal(R"({"grid": {"width": -1}})"), "grid.width must be a whole number between 2 and 1024, not -1.");
    EXPECT_EQ(refusal(R"({"temporal": {"enabled": 1}})"), "temporal.enabled must be true or false.");
    EXPECT_EQ(refusal(R"({"storage": "fp64"})"), R"(storage must be "fp16" or "fp32".)");
    EXPECT_EQ(refusal(R"({"integrator": "simpson"})"),
              R"(integrator must be one of "euler", "half_slice", "exponential", "exponential_quadratic".)");
    EXPECT_EQ(refusal(R"({"shadow": {"esm_exponent": [1, 2]}})"),
              "shadow.esm_exponent must be one number, or an array of 4 for the cascades.");
}

TEST(FogJson, ImpossibleValuesNameKeyAndRange) {
    EXPECT_EQ(refusal(R"({"medium": {"homogeneous": {"extinction_per_m": -1}}})"),
              "medium.homogeneous.extinction_per_m must be between 0 and 1e+06, not -1.");
    EXPECT_EQ(refusal(R"({"medium": {"homogeneous": {"emission_per_m": [0, -1, 0]}}})"),
              "medium.homogeneous.emission_per_m[1] must be between 0 and 1e+09, not -1.");
    EXPECT_EQ(refusal(R"({"medium": {"volumes": [{"emission_per_m": [0, 0, 2e9]}]}})"),
              "medium.volumes[0].emission_per_m[2] must be between 0 and 1e+09, not 2e+09.");
    EXPECT_EQ(refusal(R"({"phase": {"g": 2}})"), "phase.g must be between -0.999 and 0.999, not 2.");
    EXPECT_EQ(refusal(R"({"medium": {"height": {"albedo": [1, 1, 2]}}})"),
              "medium.height.albedo[2] must be between 0 and 1, not 2.");
    EXPECT_EQ(refusal(R"({"medium": {"noise": {"amplitude": 1.5}}})"),
              "medium.noise.amplitude must be between 0 and 1, not 1.5.");
    EXPECT_EQ(refusal(R"({"medium": {"noise": {"octaves": 9}}})"),
              "medium.noise.octaves must be between 1 and 8, not 9.");
    EXPECT_EQ(refusal(R"({"medium": {"noise": {"gain": -0.5}}})"),
              "medium.noise.gain must be between 0 and 1, not -0.5.");
    EXPECT_EQ(refusal(R"({"phase": {"g": 1}})"), "phase.g must be between -0.999 and 0.999, not 1.");
    EXPECT_EQ(refusal(R"({"grid": {"width": 0}})"), "grid.width must be between 2 and 1024, not 0.");
    EXPECT_EQ(refusal(R"({"grid": {"range_m": 0}})").substr(0, 12), "grid.range_m");
    EXPECT_EQ(refusal(R"({"grid": {"range_m": 10, "shape_m": 1e-4}})").substr(0, 12), "grid.shape_m");
    EXPECT_EQ(refusal(R"({"grid": {"law": "log"}})"),
              "grid.law must be one of \"shaped\", \"linear\", \"curve\", \"scene\".");
    EXPECT_EQ(refusal(R"({"grid": {"law": "curve"}})"),
              "The number of grid.curve_m's depths must be between 1 and 8, not 0.");
    EXPECT_EQ(refusal(R"({"grid": {"curve_m": []}})"),
              "The number of grid.curve_m's depths must be between 1 and 8, not 0.");
    EXPECT_EQ(refusal(R"({"grid": {"curve_m": [1, 2, 3, 4, 5, 6, 7, 8, 9]}})"),
              "The number of grid.curve_m's depths must be between 1 and 8, not 9.");
    EXPECT_EQ(refusal(R"({"grid": {"curve_m": [4, 2, 10]}})"),
              "grid.curve_m[1] must be between 4.00001 and 10, not 2.");
    EXPECT_EQ(refusal(R"({"grid": {"curve_m": [4, NaN, 10]}})").substr(0, 15), "grid.curve_m[1]");
    EXPECT_EQ(refusal(R"({"grid": {"curve_m": [4, 8], "range_m": 10}})"),
              "grid.curve_m[1] (the last, grid.range_m) must be between 10 and 10, not 8.");
    EXPECT_EQ(refusal(R"({"grid": {"curve_m": [4], "law": "linear"}})"),
              "grid.law must be \"curve\" where grid.curve_m is given.");
    EXPECT_EQ(refusal(R"({"shadow": {"esm_exponent": 0}})"), "shadow.esm_exponent must be between 1 and 1000, not 0.");
    EXPECT_EQ(refusal(R"({"airlight": {"max_lights": 33}})"), "airlight.max_lights must be between 0 and 32, not 33.");
    EXPECT_EQ(parse_fog_json(R"({"airlight": {"max_lights": 7}})")->settings.airlight.max_lights, 7U);
    EXPECT_EQ(refusal(R"({"visibility": {"taps": 0}})"), "visibility.taps must be between 1 and 64, not 0.");
    EXPECT_EQ(refusal(R"({"light_path_steps": 65})"), "light_path_steps must be between 1 and 64, not 65.");
    EXPECT_EQ(refusal(R"({"light_path": "marched"})"), R"(light_path must be one of "none", "closed_form", "march".)");
    EXPECT_EQ(refusal(R"({"temporal": {"new_frame_weight": 0}})"),
              "temporal.new_frame_weight must be between 0.001 and 1, not 0.");
}

TEST(FogJson, ReadsPhaseLobesAndDirectedAmbient) {
    const auto fog = parse_fog_json(R"({
        "phase": {"lobes": [{"function": "cornette_shanks", "g": 0.8, "weight": 0.7},
                            {"function": "rayleigh", "weight": 0.3}]},
        "ambient": {"radiance": [1, 1, 2], "sh_1": [[1, 0, 2], [0, -1, 0], [0, 0, 1]]}})");
    ASSERT_TRUE(fog) << fog.error().message;
    const PhaseLobes& phase = fog->medium.phase_lobes;
    ASSERT_EQ(phase.count, 2U);
    EXPECT_EQ(phase.lobes[0].function, PhaseFunction::cornette_shanks);
    EXPECT_EQ(phase.lobes[0].g, 0.8F);
    EXPECT_EQ(phase.lobes[0].weight, 0.7F);
    EXPECT_EQ(phase.lobes[1].function, PhaseFunction::rayleigh);
    EXPECT_EQ(phase.lobes[1].weight, 0.3F);
    EXPECT_EQ(fog->medium.ambient_sh_1[0], glm::vec3(1, 0, 2));
    EXPECT_EQ(fog->medium.ambient_sh_1[1], glm::vec3(0, -1, 0));
    EXPECT_EQ(fog->medium.ambient_sh_1[2], glm::vec3(0, 0, 1));
}

TEST(FogJson, ReadsNoiseOfVolumes) {
    const auto fog = parse_fog_json(R"({"medium": {"noise": {"kind": "perlin_worley", "amplitude": 1, "scale_m": 20,
        "wind_m_s": [1, 0, 2], "coverage": 0.25, "detail": 0.75, "detail_scale_m": 3,
        "detail_wind_m_s": [0, 0, 4]}}})");
    ASSERT_TRUE(fog) << fog.error().message;
    const DensityNoise& noise = fog->medium.noise;
    EXPECT_EQ(noise.kind, NoiseKind::perlin_worley);
    EXPECT_EQ(noise.coverage, 0.25F);
    EXPECT_EQ(noise.detail, 0.75F);
    EXPECT_EQ(noise.detail_scale_m, 3.0F);
    EXPECT_EQ(noise.detail_wind_m_s, glm::vec3(0.0F, 0.0F, 4.0F));
    const auto plain =
        parse_fog_json(R"({"medium": {"noise": {"kind": "perlin_worley", "scale_m": 20, "wind_m_s": [1, 0, 2]}}})");
    ASSERT_TRUE(plain) << plain.error().message;
    EXPECT_EQ(plain->medium.noise.detail_scale_m, 5.0F);
    EXPECT_EQ(plain->medium.noise.detail_wind_m_s, glm::vec3(1.0F, 0.0F, 2.0F));
}

TEST(FogJson, ImpossibleNoisesNameKeyAndRange) {
    const auto noise = [](const std::string& keys) {
        return refusal(R"({"medium": {"noise": {"kind": "perlin_worley", )" + keys + "}}}");
    };
    EXPECT_EQ(refusal(R"({"medium": {"noise": {"kind": "simplex"}}})"),
              "medium.noise.kind must be one of \"perlin\", \"perlin_worley\".");
    EXPECT_EQ(refusal(R"({"medium": {"noise": {"coverage": 0.5}}})"),
              "medium.noise.coverage is not a key here, where the keys are amplitude, gain, kind, octaves, scale_m, "
              "wind_m_s.");
    EXPECT_EQ(begin_of(noise(R"("octaves": 2)")), "medium.noise.octaves is not a key here");
    EXPECT_EQ(noise(R"("coverage": 0)"), "medium.noise.coverage must be between 0.01 and 1, not 0.");
    EXPECT_EQ(noise(R"("detail": 1)"), "medium.noise.detail must be between 0 and 0.95, not 1.");
    EXPECT_EQ(noise(R"("detail": NaN)"), "medium.noise.detail must be between 0 and 0.95, not nan.");
    EXPECT_EQ(noise(R"("detail_scale_m": 0)"), "medium.noise.detail_scale_m must be between 0.0001 and 1e+06, not 0.");
    EXPECT_EQ(noise(R"("detail_wind_m_s": [0, 0, 2000])"),
              "medium.noise.detail_wind_m_s[2] must be between -1000 and 1000, not 2000.");
}

TEST(FogJson, NamesPicturesOfDensities) {
    auto fog = parse_fog_json(R"({"medium": {
        "map": {"image": "ground.png", "center_m": [1, 2], "size_m": [30, 40], "edge": "repeat", "bottom_m": -1,
                "top_m": 5, "fade_m": 2},
        "volumes": [{}, {"density": {"image": "smoke.png", "slices": 3}}]}})");
    ASSERT_TRUE(fog) << fog.error().message;
    const DensityMap& map = fog->medium.map;
    EXPECT_EQ(map.center_m, glm::vec2(1.0F, 2.0F));
    EXPECT_EQ(map.size_m, glm::vec2(30.0F, 40.0F));
    EXPECT_EQ(map.edge, MapEdge::repeat);
    EXPECT_EQ(map.bottom_m, -1.0F);
    EXPECT_EQ(map.top_m, 5.0F);
    EXPECT_EQ(map.fade_m, 2.0F);
    ASSERT_EQ(fog->pictures.size(), 2U);
    EXPECT_EQ(fog->pictures[0].path, "ground.png");
    EXPECT_EQ(fog->pictures[0].key, "medium.map.image");
    EXPECT_EQ(fog->pictures[1].key, "medium.volumes[1].density.image");
    EXPECT_EQ(fog->pictures[1].volume, 1U);
    const auto set = [&](std::size_t picture, std::uint32_t width, std::uint32_t height) {
        const auto result =
            set_density(*fog, fog->pictures[picture], width, height, std::vector<std::uint8_t>(width * height, 51));
        return result ? "set" : result.error().message;
    };
    EXPECT_EQ(set(0, 4, 2), "set");
    EXPECT_EQ(set(1, 2, 7),
              "medium.volumes[1].density.image must have a height that is a multiple of its 3 slices, not 7.");
    EXPECT_EQ(set(1, 2, 6), "set");
    EXPECT_EQ(map.texels->size(), glm::uvec3(4, 2, 1));
    EXPECT_DOUBLE_EQ(map.texels->mean(), 0.2);
    EXPECT_EQ(fog->medium.volumes[1].density->size(), glm::uvec3(2, 2, 3));
}

TEST(FogJson, ImpossibleDensitiesNameKeyAndRange) {
    const auto map = [](const std::string& keys) { return refusal(R"({"medium": {"map": {)" + keys + "}}}"); };
    const std::string image = R"("image": "a.png", )";
    EXPECT_EQ(map(""), "medium.map.image must name a PNG file beside the fog file.");
    EXPECT_EQ(map(R"("image": 3)"), "medium.map.image must be a text that is not empty.");
    EXPECT_EQ(begin_of(map(image + R"("sise_m": [1, 1])")), "medium.map.sise_m is not a key here");
    EXPECT_EQ(map(image + R"("size_m": [1])"), "medium.map.size_m must be an array of 2 numbers.");
    EXPECT_EQ(map(image + R"("size_m": [1, 0])"), "medium.map.size_m[1] must be between 0.01 and 1e+06, not 0.");
    EXPECT_EQ(map(image + R"("center_m": [NaN, 0])"),
              "medium.map.center_m[0] must be between -1e+06 and 1e+06, not nan.");
    EXPECT_EQ(map(image + R"("bottom_m": 3, "top_m": 2)"),
              "medium.map.top_m (no less than bottom_m) must be between 3 and 1e+06, not 2.");
    EXPECT_EQ(map(image + R"("fade_m": 0)"), "medium.map.fade_m must be between 0.01 and 1e+06, not 0.");
    EXPECT_EQ(map(image + R"("edge": "mirror")"), "medium.map.edge must be one of \"clamp\", \"repeat\".");
    EXPECT_EQ(refusal(R"({"medium": {"volumes": [{"density": {"image": "a.png", "slices": 0}}]}})"),
              "medium.volumes[0].density.slices must be between 1 and 2048, not 0.");
}

TEST(FogJson, ReadsLocalVolumes) {
    const auto fog = parse_fog_json(R"({"medium": {"volumes": [
        {"shape": "box", "center_m": [1, 2, 3], "half_size_m": [4, 5, 6], "rotation": [0, 0.6, 0, 0.8], "edge": 0.25,
         "extinction_per_m": 0.5, "albedo": [0.1, 0.2, 0.3], "blend": "max"},
        {"shape": "sphere", "radius_m": 7, "blend": "subtract", "extinction_per_m": 2},
        {"shape": "ellipsoid", "blend": "multiply", "factor": 3}]}})");
    ASSERT_TRUE(fog) << fog.error().message;
    const auto& volumes = fog->medium.volumes;
    ASSERT_EQ(volumes.size(), 3U);
    EXPECT_EQ(volumes[0].shape, VolumeShape::box);
    EXPECT_EQ(volumes[0].center_m, glm::vec3(1, 2, 3));
    EXPECT_EQ(volumes[0].half_size_m, glm::vec3(4, 5, 6));
    EXPECT_EQ(volumes[0].rotation, glm::quat(0.8F, 0.0F, 0.6F, 0.0F));
    EXPECT_EQ(volumes[0].edge, 0.25F);
    EXPECT_EQ(volumes[0].extinction_per_m, 0.5F);
    EXPECT_EQ(volumes[0].albedo, glm::vec3(0.1F, 0.2F, 0.3F));
    EXPECT_EQ(volumes[0].blend, VolumeBlend::max);
    EXPECT_EQ(volumes[1].shape, VolumeShape::ellipsoid);
    EXPECT_EQ(volumes[1].half_size_m, glm::vec3(7.0F));
    EXPECT_EQ(volumes[1].blend, VolumeBlend::subtract);
    EXPECT_EQ(volumes[2].blend, VolumeBlend::multiply);
    EXPECT_EQ(volumes[2].factor, 3.0F);
}

TEST(FogJson, ImpossibleVolumesNameKeyAndRange) {
    const auto of_volume = [](const std::string& text) {
        return refusal(R"({"medium": {"volumes": [{)" + text + "}]}}");
    };
    EXPECT_EQ(of_volume(R"("extinction_per_m": -1)"),
              "medium.volumes[0].extinction_per_m must be between 0 and 1e+06, not -1.");
    EXPECT_EQ(of_volume(R"("edge": 2)"), "medium.volumes[0].edge must be between 0 and 1, not 2.");
    EXPECT_EQ(of_volume(R"("half_size_m": [1, -1, 1])"),
              "medium.volumes[0].half_size_m[1] must be between 0 and 1e+06, not -1.");
    EXPECT_EQ(of_volume(R"("rotation": [0, 0, 0, 2])"),
              "The length of medium.volumes[0].rotation must be between 0.999 and 1.001, not 2.");
    EXPECT_EQ(begin_of(of_volume(R"("radius_m": 1)")), "medium.volumes[0].radius_m is not a key here");
    EXPECT_EQ(begin_of(of_volume(R"("factor": 1)")), "medium.volumes[0].factor is not a key here");
    EXPECT_EQ(of_volume(R"("shape": "cone")"),
              R"(medium.volumes[0].shape must be one of "box", "ellipsoid", "sphere".)");
    EXPECT_EQ(of_volume(R"("blend": "multiply", "factor": -1)"),
              "medium.volumes[0].factor must be between 0 and 1000, not -1.");
    EXPECT_EQ(refusal(R"({"medium": {"volumes": {}}})"), "medium.volumes must be an array of 1 to 16 objects.");
}

TEST(FogJson, ImpossiblePhasesAndAmbientsNameKeyAndRange) {
    EXPECT_EQ(refusal(R"({"phase": {"g": 2}})"), "phase.g must be between -0.999 and 0.999, not 2.");
    EXPECT_EQ(refusal(R"({"phase": {"lobes": [{"g": 2}]}})"),
              "phase.lobes[0].g must be between -0.999 and 0.999, not 2.");
    EXPECT_EQ(refusal(R"({"phase": {"lobes": [{}, {"weight": -1}]}})"),
              "phase.lobes[1].weight must be between 0 and 1, not -1.");
    EXPECT_EQ(refusal(R"({"phase": {"lobes": [{"weight": 0}]}})"),
              "The sum of phase.lobes' weights must be between 0.001 and 4, not 0.");
    EXPECT_EQ(refusal(R"({"phase": {"lobes": []}})"), "phase.lobes must be an array of 1 to 4 objects.");
    EXPECT_EQ(refusal(R"({"phase": {"lobes": [{}, {}, {}, {}, {}]}})"),
              "phase.lobes must be an array of 1 to 4 objects.");
    EXPECT_EQ(begin_of(refusal(R"({"phase": {"lobes": [{"asymmetry": 1}]}})")),
              "phase.lobes[0].asymmetry is not a key here");
    EXPECT_EQ(refusal(R"({"phase": {"lobes": [{"function": "mie"}]}})"),
              R"(phase.lobes[0].function must be one of "isotropic", "rayleigh", "henyey_greenstein", "schlick", )"
              R"("cornette_shanks".)");
    EXPECT_EQ(refusal(R"({"phase": {"g": 0.5, "lobes": [{}]}})"),
              "phase.lobes takes the place of phase.g, so that only one may be given.");
    EXPECT_EQ(refusal(R"({"ambient": {"sh_1": [[0, 0, 0], [0, 0, 0], [0, 1, 0]]}})").substr(0, 44),
              "The length of ambient.sh_1 in channel 1 (at ");
    EXPECT_EQ(refusal(R"({"ambient": {"sh_1": [1, 2, 3]}})"), "ambient.sh_1[0] must be an array of 3 numbers.");
}

TEST(FogJson, NumbersThatSinglePrecisionLacksAreRefused) {
    EXPECT_EQ(refusal(R"({"phase": {"g": 1e60}})"), "phase.g must be between -0.999 and 0.999, not inf.");
    EXPECT_EQ(refusal(R"({"grid": {"range_m": -1e300}})"), "grid.range_m must be between 0.01 and 1e+07, not -inf.");
}

TEST(FogJson, NumbersThatDoublePrecisionLacksAreRefusedWithKeyAndRange) {
    EXPECT_EQ(refusal(R"({"phase": {"g": 1e999}})"), "phase.g must be between -0.999 and 0.999, not inf.");
    EXPECT_EQ(refusal(R"({"medium":{"homogeneous":{"albedo":[1,-1E+400,0]}}})"),
              "medium.homogeneous.albedo[1] must be between 0 and 1, not -inf.");
    EXPECT_EQ(refusal(R"({"grid": {"range_m": 1)" + std::string(400, '0') + "}}"),
              "grid.range_m must be between 0.01 and 1e+07, not inf.");
    EXPECT_EQ(refusal(R"({"phase": {"g": 1e-999}})"), "accepted");
    EXPECT_EQ(refusal(R"({"phase": {"g": 0.)" + std::string(400, '0') + "1}}"), "accepted");
    EXPECT_EQ(refusal(R"({"1e999": 1})").substr(0, 25), "1e999 is not a key here, ");
    EXPECT_EQ(refusal(R"({"phase": {"g": 1e999.5}})").substr(0, 30), "The fog file is not valid JSON");
}

TEST(FogJson, WholeNumbersAreRefusedWithTheRangeThatValidateHas) {
    const std::array<std::pair<std::string, std::string>, 7> keys{
        {{"grid.width", R"({"grid": {"width": #}})"},
         {"grid.height", R"({"grid": {"height": #}})"},
         {"grid.slices", R"({"grid": {"slices": #}})"},
         {"medium.noise.octaves", R"({"medium": {"noise": {"octaves": #}}})"},
         {"light_path_steps", R"({"light_path_steps": #})"},
         {"airlight.max_lights", R"({"airlight": {"max_lights": #}})"},
         {"visibility.taps", R"({"visibility": {"taps": #}})"}}};
    for (const auto& [key, text] : keys) {
        const auto with = [&, &key = key, &text = text](const std::string& value) {
            std::string given = text;
            const std::string sentence = refusal(given.replace(given.find('#'), 1, value));
            EXPECT_EQ(sentence.substr(0, key.size()), key);
            return sentence.substr(std::min(sentence.size(), key.size()));
        };
        const std::string wide = with("4000000000");
        const std::string range = wide.substr(0, wide.find(", not")); // of `validate`
        const std::string whole = " must be a whole number" + range.substr(std::string(" must be").size());
        EXPECT_EQ(with("-5"), whole + ", not -5.");
        EXPECT_EQ(with("1.5"), whole + ", not 1.5.");
        EXPECT_EQ(with("99999999999999999999"), whole + ", not 1e+20.");
        EXPECT_EQ(with("1e999"), whole + ".");
        EXPECT_EQ(with("\"8\""), whole + ".");
    }
    EXPECT_EQ(parse_fog_json(R"({"grid": {"slices": 16.0}})")->settings.grid.slices, 16U);
    EXPECT_EQ(refusal(R"({"medium": {"volumes": [{"density": {"image": "a.png", "slices": -1}}]}})"),
              "medium.volumes[0].density.slices must be a whole number between 1 and 2048, not -1.");
}

TEST(FogJson, WhatIsNoFiniteNumberIsRefusedWithKeyAndRange) {
    EXPECT_EQ(refusal(R"({"phase": {"g": NaN}})"), "phase.g must be between -0.999 and 0.999, not nan.");
    EXPECT_EQ(refusal(R"({"medium": {"homogeneous": {"extinction_per_m": Infinity}}})"),
              "medium.homogeneous.extinction_per_m must be between 0 and 1e+06, not inf.");
    EXPECT_EQ(refusal(R"({"medium": {"noise": {"wind_m_s": [0, -Infinity, 0]}}})"),
              "medium.noise.wind_m_s[1] must be between -1000 and 1000, not -inf.");
    EXPECT_EQ(refusal(R"({"grid": {"width": NaN}})"), "grid.width must be a whole number between 2 and 1024.");
    EXPECT_EQ(begin_of(refusal(R"({"\"NaN": 1})")), "\"NaN is not a key here");
}

TEST(FogJson, BrokenTextSaysWhere) {
    EXPECT_EQ(refusal(""), "The fog file is not valid JSON near byte 1.");
    EXPECT_EQ(refusal("{\"phase\": "), "The fog file is not valid JSON near byte 11.");
    EXPECT_EQ(refusal("{} {}").substr(0, 30), "The fog file is not valid JSON");
}

TEST(FogJson, DeepNestingIsNoCrash) {
    const std::string text = R"({"medium": )" + std::string(100000, '[') + std::string(100000, ']') + "}";
    EXPECT_EQ(refusal(text), "medium must be an object.");
}

} // namespace
} // namespace tyndall::volumetrics
