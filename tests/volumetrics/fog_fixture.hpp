// A synthetic scene in front of the real feature, graph, executor and shaders: depth and colour by pixel, cascades by
// texel, lights by hand; and everything that the passes made, read back.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "features/volumetrics/feature.hpp"
#include "features/volumetrics/parameters.hpp"
#include "shaders/common/lights.h"
#include "shaders/common/local_shadow.h"
#include "shaders/common/sun_shadow.h"
#include "tests/gpu/gpu_fixture.hpp"

namespace tyndall::volumetrics::test {

/// Tangents of half the view's angles, and the near plane, of the test camera (reverse-Z, infinite far).
inline constexpr double tan_x = 1.0;
inline constexpr double tan_y = 0.5625;
inline constexpr double near_m = 0.05;
[[nodiscard]] glm::dmat4 test_projection();

struct Scene {
    glm::uvec2 image{320, 180};
    FrameInputs inputs;
    std::function<double(std::uint32_t, std::uint32_t)> depth_m;  ///< view depth by pixel; infinity: sky
    std::function<glm::vec4(std::uint32_t, std::uint32_t)> color; ///< opaque colour by pixel
    std::vector<gpu::GpuLight> lights;
    std::uint32_t cascade_size = 64;
    std::vector<float> cascade_depths; ///< 4 layers of cascade_size^2; empty: no cascades are given
    gpu::SunCascades cascades{};
    std::uint32_t local_shadow_size = 0; ///< texels of a side of each local light's shadow map
    std::vector<float> local_depths;     ///< layer after layer; empty: none are given
    std::vector<gpu::LocalShadow> local_shadows;
    std::optional<glm::vec4> poison; ///< every froxel of the history that this frame leaves is set to it
};

/// A scene of the test camera at the world's origin: 160x90x64 froxels to 64 m, fp32, no jitter, no history; black, all
/// sky; no light is left out of the froxels.
[[nodiscard]] Scene plain_scene();

/// A scene in which all passes of the sun's shadow run, those of the exponential shadow map too. Cascades cover
/// `extent_m` around the camera, the sun above.
[[nodiscard]] Scene sunlit_scene(float extent_m);

/// The unit ray through a pixel's centre in view space, and the metres of it per metre of depth.
struct PixelRay {
    glm::dvec3 direction;
    double stretch;
};
[[nodiscard]] PixelRay pixel_ray(const Scene& scene, std::uint32_t x, std::uint32_t y);

/// What one frame left, x fastest, then y, then slice or layer.
struct Result {
    std::vector<glm::vec4> color;
    std::vector<glm::vec4> density;
    std::vector<glm::vec4> in_scattered;
    std::vector<glm::vec4> accumulated;
    std::vector<float> esm;
    std::vector<std::uint32_t> masks;
    std::array<std::vector<float>, 2> baked_noise; ///< shape and detail, where the frame has baked them
    std::vector<std::string> pass_names;
    std::vector<std::string> omissions;
};

class FogTest : public tyndall::test::GpuTest {
protected:
    void SetUp() override;
    void TearDown() override;

    /// Runs one frame; the next call continues its history.
    [[nodiscard]] Result render(const Scene& scene);
    /// The same of several views in one frame, in their order.
    [[nodiscard]] std::vector<Result> render_views(std::span<const Scene> scenes);
    [[nodiscard]] Feature& feature() { return *feature_; }

private:
    /// Where a view's frame is read back to.
    struct ReadBack {
        [[nodiscard]] Result collect() &&; ///< after the frame has run

        Result result;
        VkFormat format = VK_FORMAT_UNDEFINED;
        tyndall::test::HostBuffer color;
        tyndall::test::HostBuffer density;
        tyndall::test::HostBuffer in_scattered;
        tyndall::test::HostBuffer accumulated;
        tyndall::test::HostBuffer esm;
        tyndall::test::HostBuffer masks;
        std::array<tyndall::test::HostBuffer, 2> baked_noise;
    };
    [[nodiscard]] ReadBack declare_view(rg::GraphBuilder& graph, std::vector<rg::ImportBinding>& imports,
                                        const Scene& scene, std::uint32_t view);

    std::unique_ptr<Feature> feature_;
};

} // namespace tyndall::volumetrics::test
