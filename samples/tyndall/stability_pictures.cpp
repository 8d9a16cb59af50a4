#include "samples/tyndall/stability_pictures.hpp"

#include <array>
#include <limits>
#include <utility>

#include "samples/tyndall/frame_loop.hpp"

namespace tyndall::samples {

tl::expected<std::vector<StabilityPicture>, std::string>
take_pictures(const engine::Device& device, const StabilityCase& test, std::span<const std::uint32_t> frames,
              const std::function<double(std::uint32_t)>& time_s) {
    engine::Scene scene = engine_scene(test.scene);
    engine::Perspective& view = scene.cameras.front().perspective;
    view.near_m = test.near_m;
    view.far_m = test.far_m;
    FrameWishes wishes;
    wishes.camera = scene.cameras.front();
    wishes.size = {stability_picture_size.width, stability_picture_size.height};
    FrameLoopInfo info;
    info.renderer = renderer_settings(test.scene);
    info.fog = test.scene.fog;
    auto loop = FrameLoop::create(device, std::move(scene), std::move(info));
    if (!loop) {
        return tl::unexpected(loop.error().message);
    }
    std::vector<StabilityPicture> pictures;
    for (std::uint32_t frame = 1; pictures.size() < frames.size(); ++frame) {
        const bool wanted = frame == frames[pictures.size()];
        StageImages stages(device);
        wishes.time_s = time_s(frame);
        wishes.read_radiance = wanted;
        wishes.stages = wanted ? &stages : nullptr;
        if (const auto run = (*loop)->run(wishes); !run) {
            return tl::unexpected(run.error().message);
        }
        if (wanted) {
            StabilityPicture picture;
            const engine::Pixels<float>& image = (*loop)->radiance();
            for (std::size_t i = 0; i + 2 < image.values.size(); i += 3) {
                picture.radiance.emplace_back(image.values[i], image.values[i + 1], image.values[i + 2]);
            }
            picture.stages = stages.values();
            pictures.push_back(std::move(picture));
        }
    }
    if (const auto waited = (*loop)->wait(); !waited) {
        return tl::unexpected(waited.error().message);
    }
    return pictures;
}

tl::expected<StabilityPicture, std::string> take_picture(const engine::Device& device, const StabilityCase& test) {
    auto pictures = take_pictures(device, test, std::array{1U}, [&](std::uint32_t) { return test.scene.time_s; });
    if (!pictures) {
        return tl::unexpected(pictures.error());
    }
    return std::move(pictures->front());
}

std::vector<glm::dvec3> exact_picture(const StabilityCase& test) {
    const std::vector<reference::Pixel> pixels = reference::all_pixels(stability_picture_size);
    const reference::Scene scene = reference_scene(test.scene, test.physics);
    std::vector<glm::dvec3> exact;
    if (test.closed_form) {
        for (const reference::Pixel& pixel : pixels) {
            const reference::Ray ray = reference::pixel_ray(test.scene.camera, stability_picture_size, pixel);
            const auto wall = scene.geometry.hit(ray);
            exact.push_back(test.closed_form(ray, wall ? wall->distance_m : std::numeric_limits<double>::infinity()));
        }
        return exact;
    }
    for (const reference::Estimate& estimate : reference::render(scene, test.scene.camera, stability_picture_size,
                                                                 pixels, {.relative = 1e-6, .absolute = 1e-30})) {
        exact.push_back(estimate.value);
    }
    return exact;
}

double storage_tolerance(const StabilityCase& test) {
    return test.scene.fog.settings.storage == volumetrics::StorageFormat::fp16 ? 2.0 / 1024.0 : 1e-5;
}

} // namespace tyndall::samples
