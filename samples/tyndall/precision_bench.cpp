#include "samples/tyndall/precision_bench.hpp"

#include <algorithm>

#include "samples/precision/metrics.hpp"
#include "samples/tyndall/precision_ladder.hpp"
#include "samples/tyndall/precision_surfaces.hpp"
#include "samples/tyndall/timing.hpp"

namespace tyndall::samples {
namespace {

template <typename T>
using Expected = tl::expected<T, std::string>;

} // namespace

Expected<PictureRun> PictureRun::create(const engine::Device& device, const PrecisionScene& scene, Size size,
                                        const PrecisionConfiguration& configuration) {
    FrameLoopInfo info;
    info.renderer = renderer_settings(scene);
    info.renderer.cascades.resolution = configuration.cascade_texels;
    info.renderer.local_shadows.resolution = configuration.cascade_texels;
    info.fog = configured_fog(scene, configuration);
    info.profile = true;
    if (const auto valid = volumetrics::validate(info.fog->settings); !valid) {
        return tl::unexpected(valid.error().message);
    }
    engine::Scene drawn = engine_scene(scene);
    PictureRun made;
    made.wishes_.camera = drawn.cameras.front();
    made.wishes_.size = {size.width, size.height};
    made.wishes_.time_s = scene.time_s;
    auto loop = FrameLoop::create(device, std::move(drawn), std::move(info));
    if (!loop) {
        return tl::unexpected(loop.error().message);
    }
    made.loop_ = std::move(*loop);
    made.loop_->set_fog_enabled(false);
    if (const auto run = made.run(true, false); !run) {
        return tl::unexpected(run.error());
    }
    for (const rg::PassTiming& timing : made.loop_->timings()) {
        made.without_fog_.insert(made.loop_->graph().passes[timing.pass].name);
    }
    made.loop_->set_fog_enabled(true);
    if (const auto run = made.run(true, false); !run) {
        return tl::unexpected(run.error());
    }
    return made;
}

Expected<void> PictureRun::run(bool cut, bool read_radiance) {
    wishes_.cut = cut;
    wishes_.read_radiance = read_radiance;
    if (const auto run = loop_->run(wishes_); !run) {
        return tl::unexpected(run.error().message);
    }
    fog_ms_ = 0.0;
    frame_ms_ = 0.0;
    for (const rg::PassTiming& timing : loop_->timings()) {
        frame_ms_ += timing.duration_ms;
        fog_ms_ += without_fog_.contains(loop_->graph().passes[timing.pass].name) ? 0.0 : timing.duration_ms;
    }
    return {};
}

Expected<Measurement> measure(Bench& bench, const PrecisionConfiguration& configuration) {
    Expected<PictureRun> run = PictureRun::create(bench.device, bench.scene, bench.size, configuration);
    if (!run) {
        return tl::unexpected(run.error());
    }
    Measurement made;
    std::vector<double> fog_ms;
    std::vector<double> frame_ms;
    std::vector<double> ratios;
    const std::uint32_t frames = std::max(bench.frames, configuration.averaged_frames);
    for (std::uint32_t frame = 1; frame <= frames; ++frame) {
        const bool judged = frame == 1 || frame == frames;
        if (const auto done = run->run(frame == 1, judged); !done) {
            return tl::unexpected(done.error());
        }
        fog_ms.push_back(run->fog_ms());
        frame_ms.push_back(run->frame_ms());
        if (bench.yardstick) {
            if (const auto done = bench.yardstick->run(false, false); !done) {
                return tl::unexpected(done.error());
            }
            bench.yardstick_ms.push_back(bench.yardstick->fog_ms());
            ratios.push_back(fog_ms.back() / bench.yardstick_ms.back());
        }
        if (judged) {
            made.last = run->radiance();
            const std::vector<glm::dvec3> found = values_at(made.last, bench.pixels);
            for (const TruthImage& image : bench.truths) {
                made.rows.push_back({.scene = bench.scene.name,
                                     .configuration = configuration,
                                     .frame = frame,
                                     .physics = image.physics,
                                     .error = compare_images(found, image.values),
                                     .reference_error = image.relative_error,
                                     .is_own = configuration == own_configuration(bench.scene)});
            }
        }
    }
    for (PrecisionRow& row : made.rows) {
        row.clocked_ms = median(fog_ms);
        row.fog_ms = row.clocked_ms;
        row.frame_ms = median(frame_ms);
        row.relative_time = ratios.empty() ? 1.0 : median(ratios);
    }
    return made;
}

void settle_times(const Bench& bench, std::vector<PrecisionRow>& rows) {
    if (bench.yardstick_ms.empty()) {
        return;
    }
    const double yardstick_ms = median(bench.yardstick_ms);
    for (PrecisionRow& row : rows) {
        row.fog_ms = row.relative_time * yardstick_ms;
    }
}

} // namespace tyndall::samples
