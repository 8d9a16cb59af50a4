// A configuration's pictures of a scene, their errors and their times.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "engine/device.hpp"
#include "engine/image_io.hpp"
#include "samples/precision/scene.hpp"
#include "samples/tyndall/arguments.hpp"
#include "samples/tyndall/frame_loop.hpp"
#include "samples/tyndall/precision_report.hpp"
#include "samples/tyndall/precision_truths.hpp"

namespace tyndall::samples {

/// Frames of a scene in one configuration. Errors are one sentence.
class PictureRun {
public:
    /// Has run a frame without fog and one with it: shaders are compiled and caches filled.
    [[nodiscard]] static tl::expected<PictureRun, std::string> create(const engine::Device& device,
                                                                      const PrecisionScene& scene, Size size,
                                                                      const PrecisionConfiguration& configuration);

    /// One more frame; `cut` starts from no history.
    [[nodiscard]] tl::expected<void, std::string> run(bool cut, bool read_radiance);

    [[nodiscard]] const engine::Pixels<float>& radiance() const { return loop_->radiance(); }
    [[nodiscard]] double fog_ms() const { return fog_ms_; }     ///< of passes that a frame has with fog only
    [[nodiscard]] double frame_ms() const { return frame_ms_; } ///< of all passes

private:
    PictureRun() = default;

    std::unique_ptr<FrameLoop> loop_;
    FrameWishes wishes_;
    std::set<std::string> without_fog_;
    double fog_ms_ = 0.0; ///< of the newest frame
    double frame_ms_ = 0.0;
};

/// A scene, its exact pictures, and what times are compared with.
struct Bench {
    const engine::Device& device;
    PrecisionScene scene;
    Size size;
    std::uint32_t frames = 8;
    std::vector<reference::Pixel> pixels;
    std::vector<TruthImage> truths;
    /// Where several configurations are compared: the scene's own, of which a frame follows each frame that is timed. A
    /// time is then the ratio of the two, times the yardstick's median, so that what else the machine does at the
    /// moment cancels.
    std::optional<PictureRun> yardstick;
    std::vector<double> yardstick_ms;
};

/// The rows of the first frame and of the last of `bench.frames`, or of more where the configuration averages more,
/// after a cut, one of each a truth.
struct Measurement {
    std::vector<PrecisionRow> rows;
    engine::Pixels<float> last; ///< radiance of the last frame
};
[[nodiscard]] tl::expected<Measurement, std::string> measure(Bench& bench, const PrecisionConfiguration& configuration);

/// Sets `fog_ms` of the rows from `relative_time`, where there is a yardstick.
void settle_times(const Bench& bench, std::vector<PrecisionRow>& rows);

} // namespace tyndall::samples
