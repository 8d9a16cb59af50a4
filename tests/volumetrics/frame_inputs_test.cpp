// What a host tells about a frame beside medium and settings: each mistake is refused with one sentence.
#include <cmath>
#include <functional>
#include <limits>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

class FrameInputsOf : public FogTest {
protected:
    /// Of a frame with two good lights, changed by `change`.
    std::string refusal(const std::function<void(FrameInputs&)>& change) {
        FrameInputs inputs = plain_scene().inputs;
        inputs.image_size = {4, 4};
        inputs.medium.homogeneous.extinction_per_m = 0.1F;
        inputs.lights.assign(2, gpu::GpuLight{.position_range = {0.0F, 0.0F, -5.0F, 10.0F},
                                              .intensity_type = {1.0F, 2.0F, 3.0F, 1.0F},
                                              .direction_radius = {0.0F, -1.0F, 0.0F, 0.0F},
                                              .cone = {2.0F, -1.0F, 0.0F, 0.0F}});
        change(inputs);
        const auto begun = feature().begin_frame(inputs);
        return begun ? "accepted" : begun.error().message;
    }
};

TEST_F(FrameInputsOf, LightsOutsideTheirDomainAreRefused) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const auto second = [&](const std::function<void(gpu::GpuLight&)>& change) {
        return refusal([&](FrameInputs& inputs) { change(inputs.lights[1]); });
    };
    EXPECT_EQ(second([](gpu::GpuLight&) {}), "accepted");
    const std::string place = "lights[1].position_range must have a finite position, and a range above 0.";
    EXPECT_EQ(second([](gpu::GpuLight& light) { light.position_range.y = nan; }), place);
    EXPECT_EQ(second([](gpu::GpuLight& light) { light.position_range.w = 0.0F; }), place);
    EXPECT_EQ(second([](gpu::GpuLight& light) { light.position_range.w = nan; }), place);
    EXPECT_EQ(second([](gpu::GpuLight& light) { light.position_range.x = infinity; }), place);
    EXPECT_EQ(second([](gpu::GpuLight& light) { light.position_range.w = infinity; }), "accepted");
    const std::string intensity = "lights[1].intensity_type must have intensities between 0 and 1e12.";
    EXPECT_EQ(second([](gpu::GpuLight& light) { light.intensity_type.y = -1.0F; }), intensity);
    EXPECT_EQ(second([](gpu::GpuLight& light) { light.intensity_type.z = nan; }), intensity);
    EXPECT_EQ(second([](gpu::GpuLight& light) { light.intensity_type.x = 2e12F; }), intensity);
    EXPECT_EQ(second([](gpu::GpuLight& light) { light.direction_radius.w = -0.1F; }),
              "lights[1].direction_radius must be finite, with a radius of 0 or more.");
    EXPECT_EQ(second([](gpu::GpuLight& light) { light.direction_radius.y = -2.0F; }),
              "lights[1].direction_radius must have a direction of unit length.");
    EXPECT_EQ(second([](gpu::GpuLight& light) { light.cone.x = infinity; }), "lights[1].cone must be finite.");
    EXPECT_EQ(second([](gpu::GpuLight& light) { // no spot: nothing asks for its direction
                  light.intensity_type.w = 0.0F;
                  light.direction_radius = glm::vec4(0.0F);
              }),
              "accepted");
}

TEST_F(FrameInputsOf, TimesAndSizesOutsideTheirDomainAreRefused) {
    const std::string time = "time_s must be between -1e10 and 1e10.";
    EXPECT_EQ(refusal([](FrameInputs& inputs) { inputs.time_s = 1e10; }), "accepted");
    EXPECT_EQ(refusal([](FrameInputs& inputs) { inputs.time_s = 1.1e10; }), time);
    EXPECT_EQ(refusal([](FrameInputs& inputs) { inputs.time_s = -1e307; }), time);
    EXPECT_EQ(refusal([](FrameInputs& inputs) { inputs.time_s = std::nan(""); }), time);
    EXPECT_EQ(refusal([](FrameInputs& inputs) { inputs.image_size.y = 0; }),
              "image_size must be at least 1 pixel in both directions.");
}

} // namespace
} // namespace tyndall::volumetrics::test
