// A lamp in fog before and behind panes of glass, through the whole tool.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/samples/picture_fixture.hpp"

namespace tyndall::test {
namespace {

/// Light of a lamp of 1 cd at `light` that isotropic fog of extinction sigma scatters toward the origin on the first
/// length_m of a unit ray, by the midpoint rule in the angle under which the lamp sees the ray.
double lamp_airlight(const std::array<double, 3>& light, const std::array<double, 3>& direction, double length_m,
                     double sigma, double range_m) {
    const double nearest_m = light[0] * direction[0] + light[1] * direction[1] + light[2] * direction[2];
    const double h = length({light[0] - nearest_m * direction[0], light[1] - nearest_m * direction[1],
                             light[2] - nearest_m * direction[2]});
    const double begin = std::atan2(-nearest_m, h);
    const double end = std::atan2(length_m - nearest_m, h);
    const int nodes = 1000;
    double sum = 0.0;
    for (int i = 0; i < nodes; ++i) {
        const double angle = begin + (end - begin) * (i + 0.5) / nodes;
        const double distance = h / std::cos(angle);
        const double from_eye = nearest_m + h * std::tan(angle);
        const double window = std::clamp(1.0 - std::pow(distance / range_m, 4.0), 0.0, 1.0);
        sum += window * std::exp(-sigma * (distance + from_eye));
    }
    return sum * (end - begin) / nodes * sigma / (4.0 * std::numbers::pi * h);
}

class AirlightPictures : public ClosedFormPictures {};

// Each pane has the glow in front of it, and of the lamp behind it only what lies in front.
TEST_F(AirlightPictures, TransparentPanesBeforeAndBehindALamp) {
    const std::array<double, 3> lamp = {0.31, 0.17, -5.0};
    const std::array<double, 4> depths_m = {2.0, 4.9, 7.0, 12.0};
    for (const double depth_m : depths_m) {
        add_rectangle(0.0, -depth_m, 40.0, unlit({0.0, 0.0, 0.0}, 0.5, depth_m < 12.0 ? "BLEND" : "OPAQUE"));
    }
    add_light({{"type", "point"}, {"intensity", 1000.0}, {"range", 20.0}},
              {{"translation", {lamp[0], lamp[1], lamp[2]}}});
    write_text(folder_ / "fog.json", R"({"medium":{"homogeneous":{"extinction_per_m":0.06}},
        "grid":{"range_m":40},"temporal":{"enabled":false}})");
    const engine::Pixels<float> image = render({"--fp32", "--fog", (folder_ / "fog.json").string()});
    double largest = 0.0;
    for (std::uint32_t y = 0; y < height; y += 3) {
        for (std::uint32_t x = 0; x < width; x += 5) {
            const std::array<double, 3> r = ray(x, y);
            const double stretch = length(r);
            double expected = 0.0;
            double passes = 1.0;
            for (const double depth_m : depths_m) {
                const double alpha = depth_m < 12.0 ? 0.5 : 1.0;
                expected += passes * alpha * 1000.0 *
                            lamp_airlight(lamp, {r[0] / stretch, r[1] / stretch, r[2] / stretch}, depth_m * stretch,
                                          0.06, 20.0);
                passes *= 1.0 - alpha;
            }
            const double got = image.values[(std::size_t{y} * width + x) * image.channels];
            largest = std::max(largest, std::abs(got / expected - 1.0));
        }
    }
    std::printf("panes before and behind a lamp: at most %.1e off\n", largest);
    EXPECT_LE(largest, 1e-2);
}

} // namespace
} // namespace tyndall::test
