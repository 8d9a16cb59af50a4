// What each subcommand is told.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "features/volumetrics/settings.hpp"

namespace tyndall::samples {

struct Size {
    std::uint32_t width = 1280;
    std::uint32_t height = 720;

    bool operator==(const Size&) const = default;
};
/// "1280x720"; each side 1 to 16384. The error is one sentence that names --size.
[[nodiscard]] tl::expected<Size, std::string> parse_size(std::string_view text);
/// Columns of froxels, "160x90"; each side within the domain of grid.width and grid.height. Names --grid.
[[nodiscard]] tl::expected<Size, std::string> parse_grid(std::string_view text);

enum class Queues : std::uint8_t {
    one,
    two,      ///< graphics and async compute, which the fog asks for; folded where the device has one
    measured, ///< the same queues, used where measured durations say that it pays
};

struct RenderArguments {
    std::filesystem::path scene;
    std::optional<std::filesystem::path> fog;       ///< absent: `<scene>.fog.json` beside the scene if there is one
    std::optional<std::filesystem::path> particles; ///< absent: `<scene>.particles.json` likewise
    bool no_fog = false;
    bool no_particles = false;
    std::uint32_t camera = 0;
    Size size;
    std::uint32_t frames = 16;
    double time_s = 4.0;           ///< of the first frame
    double frame_interval_s = 0.0; ///< between frames; 0: a still, accumulated over its frames
    std::optional<double> exposure_ev100;
    std::vector<std::filesystem::path> outputs; ///< .png and .exr
    std::optional<std::filesystem::path> explain_file;
    bool explain = false;
    std::optional<std::filesystem::path> timing_file;
    std::optional<std::filesystem::path> trace;        ///< predicted and measured timeline
    std::optional<std::filesystem::path> export_frame; ///< the frame as JSON, with the durations that were measured
    bool timing = false;
    std::optional<std::filesystem::path> stages_dir;
    std::string device;
    Queues queues = Queues::one; ///< that the plan is made for
    bool validate = false;
    bool poison = false; ///< transients hold garbage until they are written
    bool fp32 = false;   ///< scene colour in 32 bits, as --out *.exr does by itself
    bool json = false;
};

struct InfoArguments {
    std::string device;
    bool json = false;
};

struct ScheduleArguments {
    std::filesystem::path frame;
    std::optional<std::string> queues; ///< "graphics", "graphics,compute" or "graphics,compute:0,transfer"
    std::optional<std::filesystem::path> costs;
    std::optional<std::filesystem::path> plan; ///< explained and verified instead of one that is compiled
    std::vector<std::string> switches;
    std::vector<std::filesystem::path> outputs; ///< .txt, .json, .dot and .html
    std::optional<std::filesystem::path> trace;
    bool verify = false;
    bool json = false;
};
/// What --switch can name.
[[nodiscard]] std::vector<std::string> schedule_switches();

/// What of the fog is varied.
struct PrecisionConfiguration {
    volumetrics::Integrator integrator = volumetrics::Settings{}.integrator;
    volumetrics::SunVisibility visibility = volumetrics::Settings{}.visibility.method;
    Size grid{volumetrics::Settings{}.grid.width, volumetrics::Settings{}.grid.height}; ///< columns of froxels
    std::uint32_t slices = volumetrics::Settings{}.grid.slices;
    volumetrics::StorageFormat storage = volumetrics::Settings{}.storage;
    std::uint32_t cascade_texels = 2048; ///< of a side of the sun's shadow cascades
    std::uint32_t averaged_frames = 0; ///< jittered and averaged evenly before the last is judged; 0: as the scene asks

    bool operator==(const PrecisionConfiguration&) const = default;
};

/// Every combination of the lists is measured; of one that is empty, the ladder's values or, without a sweep, what the
/// scene itself asks for (samples/tyndall/precision_ladder.hpp).
struct PrecisionArguments {
    std::string scene = "all";                 ///< or "file": `file` only
    std::optional<std::filesystem::path> file; ///< a glTF scene beside the others
    Size size{320, 180};
    std::uint32_t frames = 8; ///< the first and the last of them are judged
    std::vector<volumetrics::Integrator> integrators;
    std::vector<volumetrics::SunVisibility> visibilities;
    std::vector<Size> grids;
    std::vector<std::uint32_t> slices;
    bool sweep = false;                          ///< measure every combination of the long ladder
    bool quick = false;                          ///< of the short ladder
    std::optional<double> error;                 ///< choose the cheapest within this relative L2 error
    std::optional<double> budget_ms;             ///< choose the most exact that takes no longer, fog's passes
    bool causes = false;                         ///< measure too what removing one cause of error at a time leaves
    bool orders = false;                         ///< print the integrators' orders of convergence, and nothing else
    bool airlight = false;                       ///< surfaces are black: the fog alone is judged
    std::optional<std::filesystem::path> folder; ///< for precision.csv and precision.json
    std::string device;
    bool json = false;
};
/// What --scene can name besides "all" and "file".
[[nodiscard]] std::vector<std::string> precision_scene_names();

struct StabilityArguments {
    std::string name = "all";
    bool quick = false;                          ///< the extremes of each case only
    std::optional<std::filesystem::path> folder; ///< for stability.csv and stability.json
    std::string device;
    bool json = false;
};
/// What --case can name besides "all".
[[nodiscard]] std::vector<std::string> stability_case_names();

/// Exit codes of every subcommand.
inline constexpr int exit_ok = 0;
inline constexpr int exit_failed = 1;    ///< the device or the machine failed
inline constexpr int exit_bad_input = 2; ///< what the user gave cannot be used

[[nodiscard]] int run_render(const RenderArguments& arguments);
[[nodiscard]] int run_schedule(const ScheduleArguments& arguments);
[[nodiscard]] int run_precision(const PrecisionArguments& arguments);
[[nodiscard]] int run_stability(const StabilityArguments& arguments);
[[nodiscard]] int run_info(const InfoArguments& arguments);

} // namespace tyndall::samples
