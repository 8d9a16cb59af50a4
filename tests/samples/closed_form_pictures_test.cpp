// Pictures of scenes so simple that every pixel has a closed form, through the whole tool: glTF in, linear EXR out.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/samples/picture_fixture.hpp"

namespace tyndall::test {
namespace {

class PanesInFog : public ClosedFormPictures {
protected:
    /// Of the panes from the nearest on each third is blended in the same of the three ways.
    void expect_panes_in_fog(const Color& sigma, const std::string& extinction,
                             const std::array<std::string, 3>& ways = {"premultiplied", "premultiplied",
                                                                       "premultiplied"});
};

struct Pane {
    double depth_m;
    double alpha;
    Color color;
    std::string blend = "premultiplied";
};

/// Fog between the eye and each pane, each pane over what lies behind: exact for a homogeneous medium of extinction
/// sigma that scatters `source` toward the eye.
Color through_panes(const std::vector<Pane>& front_to_back, double stretch, const Color& sigma, const Color& source) {
    Color sum = {};
    Color passes = {1.0, 1.0, 1.0};
    for (const Pane& pane : front_to_back) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double transmittance = std::exp(-sigma[c] * pane.depth_m * stretch);
            const double seen = pane.color[c] * transmittance;
            const double fog = source[c] * (1.0 - transmittance);
            if (pane.blend == "additive") {
                sum[c] += passes[c] * pane.alpha * seen;
            } else if (pane.blend == "multiply") {
                const double filter = 1.0 - pane.alpha * (1.0 - pane.color[c]);
                sum[c] += passes[c] * (1.0 - filter) * fog;
                passes[c] *= filter;
            } else {
                sum[c] += passes[c] * pane.alpha * (seen + fog);
                passes[c] *= 1.0 - pane.alpha;
            }
        }
    }
    return sum;
}

// The engine sorts: whatever the order of submission, each pane lies over those behind it and has the fog of its depth.
void PanesInFog::expect_panes_in_fog(const Color& sigma, const std::string& extinction,
                                     const std::array<std::string, 3>& ways) {
    const double albedo = 0.9;
    const Color ambient = {0.5, 0.6, 0.8};
    const Color source = {albedo * ambient[0], albedo * ambient[1], albedo * ambient[2]};
    std::vector<Pane> panes;
    for (std::size_t i = 0; i < 8; ++i) {
        const double n = static_cast<double>(i);
        const double t = n / 8.0;
        panes.push_back({1.3 + 2.1 * n, 0.2 + 0.4 * t, {0.9 - 0.8 * t, 0.1 + 0.3 * t, 0.2 + 0.7 * t}, ways[i % 3]});
    }
    panes.push_back({21.0, 1.0, {0.7, 0.6, 0.4}}); // the wall
    write_text(folder_ / "fog.json", R"({"medium":{"homogeneous":{"extinction_per_m":)" + extinction +
                                         R"(,"albedo":[0.9,0.9,0.9]}},
        "ambient":{"radiance":[0.5,0.6,0.8]},"grid":{"width":160,"height":90,"slices":64,"range_m":40}})");
    const auto expected = [&](std::uint32_t x, std::uint32_t y) {
        return through_panes(panes, length(ray(x, y)), sigma, source);
    };
    const GltfFile empty = file_;
    std::vector<engine::Pixels<float>> images;
    for (const std::array<std::size_t, 9>& order :
         {std::array<std::size_t, 9>{0, 1, 2, 3, 4, 5, 6, 7, 8}, std::array<std::size_t, 9>{8, 7, 6, 5, 4, 3, 2, 1, 0},
          std::array<std::size_t, 9>{3, 8, 0, 6, 1, 7, 2, 5, 4}}) {
        file_ = empty;
        add_dark_light();
        for (const std::size_t i : order) {
            json material = unlit(panes[i].color, panes[i].alpha, panes[i].alpha < 1.0 ? "BLEND" : "OPAQUE");
            if (panes[i].blend != "premultiplied") {
                material["extras"]["blend"] = panes[i].blend;
            }
            add_rectangle(0.0, -panes[i].depth_m, 40.0, std::move(material));
        }
        images.push_back(render({"--fp32", "--fog", (folder_ / "fog.json").string()}));
    }
    const double fp32 = largest_error(images[0], expected);
    const double fp16 = largest_error(render({"--fog", (folder_ / "fog.json").string()}), expected);
    std::printf("8 panes in fog, largest relative error: fp32 %.1e, fp16 %.1e\n", fp32, fp16);
    EXPECT_LE(fp32, 2e-3);
    EXPECT_LE(fp16, 1e-2);
    EXPECT_EQ(images[1].values, images[0].values);
    EXPECT_EQ(images[2].values, images[0].values);
}

TEST_F(PanesInFog, LieOverOneAnotherInAnyOrder) {
    expect_panes_in_fog({0.06, 0.06, 0.06}, "0.06");
}

TEST_F(PanesInFog, LieOverOneAnotherInColoredFog) {
    expect_panes_in_fog({0.12, 0.03, 0.0}, "[0.12,0.03,0]");
}

TEST_F(PanesInFog, AreAddedAndFilterInAnyOrder) {
    expect_panes_in_fog({0.06, 0.06, 0.06}, "0.06", {"multiply", "additive", "premultiplied"});
}

TEST_F(PanesInFog, AreAddedAndFilterInColoredFog) {
    expect_panes_in_fog({0.12, 0.03, 0.0}, "[0.12,0.03,0]", {"premultiplied", "multiply", "additive"});
}

/// A white Lambert wall without a layer above.
json lambert(const Color& albedo) {
    return {{"pbrMetallicRoughness",
             {{"baseColorFactor", {albedo[0], albedo[1], albedo[2], 1.0}},
              {"metallicFactor", 0.0},
              {"roughnessFactor", 1.0}}},
            {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0.0}}}}}};
}

/// Window and inverse square of KHR_lights_punctual.
double attenuation(double distance_m, double range_m) {
    const double x = distance_m / range_m;
    return std::clamp(1.0 - x * x * x * x, 0.0, 1.0) / (distance_m * distance_m);
}

TEST_F(ClosedFormPictures, LambertWallUnderAPointLight) {
    const Color albedo = {0.8, 0.5, 0.2};
    const std::array<double, 3> light = {0.7, -0.4, -3.0};
    add_rectangle(0.0, -5.0, 10.0, lambert(albedo));
    add_light({{"type", "point"}, {"intensity", 20.0}, {"color", {1.0, 0.5, 0.25}}, {"range", 9.0}},
              {{"translation", {light[0], light[1], light[2]}}});
    const auto expected = [&](std::uint32_t x, std::uint32_t y) {
        const std::array<double, 3> r = ray(x, y);
        const std::array<double, 3> to = {light[0] - 5.0 * r[0], light[1] - 5.0 * r[1], light[2] + 5.0};
        const double distance = length(to);
        const double irradiance = 20.0 * attenuation(distance, 9.0) * to[2] / distance;
        const double scale = irradiance / std::numbers::pi;
        return Color{albedo[0] * scale, albedo[1] * scale * 0.5, albedo[2] * scale * 0.25};
    };
    EXPECT_LE(largest_error(render({"--fp32"}), expected), 1e-4);
}

TEST_F(ClosedFormPictures, LambertWallUnderASpotLight) {
    const double inner = 0.3;
    const double outer = 0.55;
    add_rectangle(0.0, -5.0, 10.0, lambert({0.5, 0.5, 0.5}));
    add_light({{"type", "spot"},
               {"intensity", 30.0},
               {"range", 20.0},
               {"spot", {{"innerConeAngle", inner}, {"outerConeAngle", outer}}}},
              {{"translation", {0.5, 0.0, -1.0}}}); // shines along -z
    const engine::Pixels<float> image = render({"--fp32"});
    double largest = 0.0;
    std::size_t dark = 0;
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::array<double, 3> r = ray(x, y);
            const std::array<double, 3> to = {0.5 - 5.0 * r[0], -5.0 * r[1], 4.0};
            const double distance = length(to);
            const double cosine = to[2] / distance;
            const double cone = std::clamp((cosine - std::cos(outer)) / (std::cos(inner) - std::cos(outer)), 0.0, 1.0);
            const double expected = 30.0 * attenuation(distance, 20.0) * cone * cone * cosine * 0.5 / std::numbers::pi;
            const double got = image.values[(std::size_t{y} * width + x) * image.channels];
            if (cone == 0.0) {
                EXPECT_EQ(got, 0.0);
                ++dark;
            }
            largest = std::max(largest, std::abs(got - expected));
        }
    }
    EXPECT_GT(dark, 100U);
    EXPECT_LE(largest, 1e-4 * 0.5 * 30.0 / 16.0 / std::numbers::pi);
}

// The tool's own ambient light is what a wall in shadow shows; the sun's share is what is left.
TEST_F(ClosedFormPictures, LambertWallUnderTheSun) {
    double lit = 0.0;
    double ambient = 0.0;
    for (const double tilt_rad : {0.0, 1.0}) {
        for (const bool shadowed : {false, true}) {
            SCOPED_TRACE(std::to_string(tilt_rad) + (shadowed ? " shadowed" : ""));
            const GltfFile empty = file_;
            add_rectangle(0.0, -5.0, 10.0, lambert({0.5, 0.5, 0.5}));
            if (shadowed) { // behind the camera, between wall and sun
                add_rectangle(0.0, 2.0, 40.0, lambert({0.5, 0.5, 0.5}));
            }
            add_light({{"type", "directional"}, {"intensity", 1000.0}},
                      {{"rotation", {-std::sin(0.5 * tilt_rad), 0.0, 0.0, std::cos(0.5 * tilt_rad)}}});
            const engine::Pixels<float> image = render({"--fp32"});
            file_ = empty;
            const double middle = image.values[(std::size_t{height} / 2 * width + width / 2) * image.channels];
            (shadowed ? ambient : lit) = middle;
        }
        EXPECT_NEAR((lit - ambient) / (0.5 * 1000.0 * std::cos(tilt_rad) / std::numbers::pi), 1.0, 1e-4);
    }
}

/// Integral of 0.1 e^(-0.3 max(0, y + 1)) over a length, between two heights.
double height_optical_depth(double from_y, double to_y, double length_m) {
    const double low = std::max(std::min(from_y, to_y) + 1.0, 0.0);
    const double high = std::max(std::max(from_y, to_y) + 1.0, 0.0);
    const double above = high > low ? (std::exp(-0.3 * low) - std::exp(-0.3 * high)) / 0.3 : 0.0;
    const double below = std::abs(to_y - from_y) - (high - low);
    return 0.1 * length_m * (above + below) / std::abs(to_y - from_y);
}

// Fog that scatters nothing: what is left of a wall's light is what the way to it leaves.
TEST_F(ClosedFormPictures, LightIsWeakenedOnItsWayToAWall) {
    const auto fog = [&](const char* light_path) {
        const std::filesystem::path path = folder_ / (std::string(light_path) + ".json");
        write_text(path, R"({"medium":{"homogeneous":{"extinction_per_m":0.05,"albedo":[0,0,0]},
            "height":{"extinction_per_m":0.1,"falloff_per_m":0.3,"base_height_m":-1,"albedo":[0,0,0]}},
            "temporal":{"enabled":false},"light_path":")" +
                             std::string(light_path) + "\"}");
        return render({"--fp32", "--fog", path.string()});
    };
    const auto largest_difference = [&](const engine::Pixels<float>& dark, auto&& optical_depth) {
        const engine::Pixels<float> weakened = fog("closed_form");
        const engine::Pixels<float> all = fog("none");
        double largest = 0.0;
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                const std::size_t i = (std::size_t{y} * width + x) * all.channels;
                const auto light = [&](const engine::Pixels<float>& image) {
                    return static_cast<double>(image.values[i]) -
                           (dark.values.empty() ? 0.0 : static_cast<double>(dark.values[i]));
                };
                const std::array<double, 3> r = ray(x, y);
                const double expected = std::exp(-optical_depth(std::array{5.0 * r[0], 5.0 * r[1], -5.0}));
                largest = std::max(largest, std::abs(light(weakened) / light(all) / expected - 1.0));
            }
        }
        return largest;
    };
    add_rectangle(0.0, -5.0, 10.0, lambert({0.5, 0.5, 0.5}));
    const GltfFile wall = file_;
    add_light({{"type", "point"}, {"intensity", 20.0}, {"range", 90.0}}, {{"translation", {0.7, 2.0, -1.0}}});
    EXPECT_LE(largest_difference({},
                                 [](const std::array<double, 3>& p) {
                                     const double distance = length({0.7 - p[0], 2.0 - p[1], -1.0 - p[2]});
                                     return 0.05 * distance + height_optical_depth(p[1], 2.0, distance);
                                 }),
              1e-4);
    file_ = wall;
    const double tilt_rad = 0.7;
    const json sun = {{"type", "directional"}, {"intensity", 1000.0}};
    const json turned = {{"rotation", {-std::sin(0.5 * tilt_rad), 0.0, 0.0, std::cos(0.5 * tilt_rad)}}};
    add_rectangle(0.0, 2.0, 40.0, lambert({0.5, 0.5, 0.5})); // keeps the sun away
    add_light(sun, turned);
    const engine::Pixels<float> shadow = fog("none");
    file_ = wall;
    add_light(sun, turned);
    EXPECT_LE(largest_difference(shadow,
                                 [&](const std::array<double, 3>& p) {
                                     const double length_m = 1e3;
                                     return height_optical_depth(p[1], p[1] + length_m * std::sin(tilt_rad), length_m);
                                 }),
              1e-4);
}

/// Metres of a straight way from p along the unit direction d, `length_m` long, in a ball and in a box along the axes.
double way_in_ball(const std::array<double, 3>& p, const std::array<double, 3>& d, double length_m) {
    const std::array<double, 3> to = {0.3 - p[0], 1.0 - p[1], -3.0 - p[2]};
    const double nearest = to[0] * d[0] + to[1] * d[1] + to[2] * d[2];
    const double squared = 0.64 - (to[0] * to[0] + to[1] * to[1] + to[2] * to[2] - nearest * nearest);
    const double half = std::sqrt(std::max(squared, 0.0));
    return std::max(std::min(nearest + half, length_m) - std::max(nearest - half, 0.0), 0.0);
}
double way_in_box(const std::array<double, 3>& p, const std::array<double, 3>& d, double length_m) {
    constexpr std::array<double, 3> low = {-1.5, -0.4, -4.5};
    constexpr std::array<double, 3> high = {-0.5, 0.4, -3.9};
    double enter = 0.0;
    double leave = length_m;
    for (std::size_t i = 0; i < 3; ++i) {
        const double a = (low[i] - p[i]) / d[i];
        const double b = (high[i] - p[i]) / d[i];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return std::max(leave - enter, 0.0);
}

// A ball of fog and a box of fog throw shadows on a wall, of a lamp and of the sun, each as dark as the way in it is
// long.
TEST_F(ClosedFormPictures, LocalVolumesThrowShadowsOnAWall) {
    const auto fog = [&](const char* light_path) {
        const std::filesystem::path path = folder_ / (std::string(light_path) + ".json");
        write_text(path, R"({"medium":{"volumes":[
            {"shape":"sphere","center_m":[0.3,1,-3],"radius_m":0.8,"extinction_per_m":0.6,"albedo":[0,0,0]},
            {"center_m":[-1,0,-4.2],"half_size_m":[0.5,0.4,0.3],"extinction_per_m":0.9,"albedo":[0,0,0]}]},
            "temporal":{"enabled":false},"light_path":")" +
                             std::string(light_path) + "\"}");
        return render({"--fp32", "--fog", path.string()});
    };
    add_rectangle(0.0, -5.0, 10.0, lambert({0.5, 0.5, 0.5}));
    const GltfFile wall = file_;
    const double tilt_rad = 0.7;
    for (const bool sun : {false, true}) {
        file_ = wall;
        const json turned = {{"rotation", {-std::sin(0.5 * tilt_rad), 0.0, 0.0, std::cos(0.5 * tilt_rad)}}};
        add_light(sun ? json{{"type", "directional"}, {"intensity", 1000.0}}
                      : json{{"type", "point"}, {"intensity", 20.0}, {"range", 90.0}},
                  sun ? turned : json{{"translation", {0.7, 2.0, -1.0}}});
        const GltfFile lit = file_;
        engine::Pixels<float> ambient;
        if (sun) {
            add_rectangle(0.0, 2.0, 40.0, lambert({0.5, 0.5, 0.5})); // keeps the sun away
            ambient = fog("none");
            file_ = lit;
        }
        const engine::Pixels<float> all = fog("none");
        const engine::Pixels<float> weakened = fog("march");
        double largest = 0.0;
        double darkest = 1.0;
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                const std::size_t i = (std::size_t{y} * width + x) * all.channels;
                const double rest = ambient.values.empty() ? 0.0 : static_cast<double>(ambient.values[i]);
                const std::array<double, 3> r = ray(x, y);
                const std::array<double, 3> p = {5.0 * r[0], 5.0 * r[1], -5.0};
                const std::array<double, 3> to_lamp = {0.7 - p[0], 2.0 - p[1], -1.0 - p[2]};
                const double length_m = sun ? 1e3 : length(to_lamp);
                const std::array<double, 3> way =
                    sun ? std::array{1e-9, std::sin(tilt_rad), std::cos(tilt_rad)}
                        : std::array{to_lamp[0] / length_m, to_lamp[1] / length_m, to_lamp[2] / length_m};
                const double passes =
                    std::exp(-0.6 * way_in_ball(p, way, length_m) - 0.9 * way_in_box(p, way, length_m));
                const double found =
                    (static_cast<double>(weakened.values[i]) - rest) / (static_cast<double>(all.values[i]) - rest);
                largest = std::max(largest, std::abs(found / passes - 1.0));
                darkest = std::min(darkest, passes);
            }
        }
        std::printf("%s: down to %.2f of the light, off by %.1e\n", sun ? "sun" : "lamp", darkest, largest);
        EXPECT_LE(darkest, 0.6);
        EXPECT_LE(largest, 1e-3);
    }
}

TEST_F(ClosedFormPictures, MaskCutsAtItsCutoffAndBackFacesAreCulled) {
    add_dark_light();
    add_rectangle(0.0, -8.0, 20.0, unlit({0.1, 0.2, 0.3}, 1.0, "OPAQUE"));
    json below = unlit({0.9, 0.9, 0.9}, 0.59, "MASK");
    below["alphaCutoff"] = 0.6;
    json above = unlit({0.8, 0.7, 0.6}, 0.61, "MASK");
    above["alphaCutoff"] = 0.6;
    add_rectangle(-1.0, -5.0, 0.9, below);
    add_rectangle(1.0, -5.0, 0.9, above);
    json back = unlit({0.9, 0.1, 0.9}, 1.0, "OPAQUE");
    add_rectangle(0.0, -3.0, 1.0, back); // turned away below: seen from behind it is not there
    file_.root["nodes"].back()["rotation"] = {0.0, 1.0, 0.0, 0.0};
    file_.root["nodes"].back()["translation"] = {0.0, 0.0, -6.0};
    const auto red = [](const engine::Pixels<float>& image, double x) { // at depth 5
        const double slope = std::tan(0.5 * vertical_fov_rad) * width / height;
        const auto column = static_cast<std::size_t>((x / 5.0 / slope * 0.5 + 0.5) * width);
        return image.values[(std::size_t{height} / 2 * width + column) * image.channels];
    };
    const engine::Pixels<float> single = render({"--fp32"});
    EXPECT_FLOAT_EQ(red(single, -1.0), 0.1F);
    EXPECT_FLOAT_EQ(red(single, 1.0), 0.8F);
    file_.root["materials"].back()["doubleSided"] = true;
    const engine::Pixels<float> both = render({"--fp32"});
    EXPECT_FLOAT_EQ(red(both, -1.0), 0.9F);
    EXPECT_FLOAT_EQ(both.values[(std::size_t{height} / 2 * width + width * 9 / 20) * both.channels + 1], 0.1F);
}

} // namespace
} // namespace tyndall::test
