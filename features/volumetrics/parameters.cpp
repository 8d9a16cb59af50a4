#include "features/volumetrics/parameters.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "features/volumetrics/change.hpp"
#include "features/volumetrics/density_parameters.hpp"

namespace tyndall::volumetrics {
namespace {

/// s of the law that the shaders compute, m. The shaped law's formula loses digits where s is far beyond the range, and
/// is linear there anyway.
double effective_shape_m(const GridSettings& grid) {
    const double range_m = grid.range_m;
    const bool shaped = grid.law == DepthLawKind::shaped || grid.law == DepthLawKind::scene;
    const bool linear = !shaped || grid.shape_m > 100.0F * grid.range_m;
    return linear ? std::exp2(20.0) * range_m : static_cast<double>(grid.shape_m);
}

gpu::DepthLaw depth_law(const GridSettings& grid) {
    const double range_m = grid.range_m;
    const double shape_m = effective_shape_m(grid);
    const double log_ratio = std::log1p(range_m / shape_m);
    gpu::DepthLaw law{};
    law.range_shape = glm::vec4(range_m, shape_m, log_ratio, 1.0 / log_ratio);
    std::vector<double> ends{range_m};
    if (grid.law == DepthLawKind::curve) {
        ends.assign(grid.curve_m.begin(), grid.curve_m.end());
    }
    const auto count = static_cast<double>(ends.size());
    law.pieces = glm::vec4(count, 1.0 / count, 0.0, 0.0);
    law.first_0 = glm::vec4(2.0F);
    law.first_4 = glm::vec4(2.0F);
    double first = 0.0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const int part = static_cast<int>(i % 4);
        const double end = i + 1 < ends.size() ? std::log1p(ends[i] / shape_m) / log_ratio : 1.0;
        (i < 4 ? law.first_0 : law.first_4)[part] = static_cast<float>(first);
        (i < 4 ? law.step_0 : law.step_4)[part] = static_cast<float>(end - first);
        (i < 4 ? law.inverse_0 : law.inverse_4)[part] = static_cast<float>(1.0 / (end - first));
        first = end;
    }
    return law;
}

float fraction(double value) {
    return static_cast<float>(value - std::floor(value));
}

/// clip.w = w_depth * z + w_constant for view depth z.
struct ClipW {
    double depth;
    double constant;
};
ClipW clip_w(const glm::dmat4& p) {
    return {-p[2][3], p[3][3]};
}

/// Solves device depth d = (p32 - p22 z) / w for z, with the sign that makes the numerator positive in mid-range.
glm::vec4 depth_coefficients(const glm::dmat4& p) {
    const ClipW w = clip_w(p);
    glm::dvec4 c(p[3][2], w.constant, p[2][2], w.depth);
    if (c.x - 0.5 * c.y < 0.0) {
        c = -c;
    }
    return glm::vec4(c);
}

/// 0 or 1, whichever lies farther; `c` of depth_coefficients.
float far_device_depth(const glm::vec4& c) {
    const bool endless = c.z <= 0.0F; // at 0
    return endless || c.x * (c.z + c.w) > (c.x - c.y) * c.z ? 0.0F : 1.0F;
}

glm::vec4 temporal_parameters(const FrameInputs& frame, const std::optional<FrameMemory>& before,
                              float radiance_scale) {
    const float weight = frame.settings.temporal.new_frame_weight;
    glm::vec4 result(weight, std::ceil(1.0F / weight), 1.0F, 0.0F);
    if (before) {
        result.z = radiance_scale / before->volume.scale.x;
        result.w = change_everywhere(frame, *before);
    }
    return result;
}

/// Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences": powers of the reciprocal of 1.2207...
glm::vec4 jitter(const FrameInputs& frame, std::uint32_t frames_since_cut) {
    const double n = frames_since_cut;
    return {fraction(0.5 + n * 0.8191725133961645), fraction(0.5 + n * 0.6710436067037893),
            fraction(0.5 + n * 0.5497004779019703), frame.settings.temporal.jitter ? 1.0F : 0.0F};
}

/// Ambient light scattered toward the eye: each order of its spherical harmonics times the same order of the phase
/// function's Legendre series (Funk-Hecke), 1 and the mean cosine.
void write_phase(const Medium& medium, gpu::VolumetricParameters& u) {
    const PhaseLobes phase = phase_of(medium);
    float weights = 0.0F;
    for (const PhaseLobe& lobe : phase.all()) {
        weights += lobe.weight;
    }
    for (std::uint32_t i = 0; i < phase.count; ++i) {
        u.phase_asymmetry[static_cast<int>(i)] = phase.lobes[i].g;
        u.phase_weight[static_cast<int>(i)] = phase.lobes[i].weight / weights;
    }
    u.phase = glm::vec4(static_cast<float>(steepness(phase)), 0.0F, 0.0F, 0.0F);
    const auto order_1 = static_cast<float>(sh_1_constant * mean_cosine(phase));
    u.ambient = glm::vec4(medium.ambient_radiance, 0.0F);
    u.ambient_y = glm::vec4(order_1 * medium.ambient_sh_1[0], 0.0F);
    u.ambient_z = glm::vec4(order_1 * medium.ambient_sh_1[1], 0.0F);
    u.ambient_x = glm::vec4(order_1 * medium.ambient_sh_1[2], 0.0F);
}

/// The lobes in the form that shaders/common/far_field.h describes.
gpu::PhaseTerms phase_terms(const PhaseLobes& phase) {
    gpu::PhaseTerms terms{};
    terms.spread = glm::vec4(1.0F);
    float weights = 0.0F;
    for (const PhaseLobe& lobe : phase.all()) {
        weights += lobe.weight;
    }
    for (std::uint32_t index = 0; index < phase.count; ++index) {
        const auto i = static_cast<int>(index);
        const PhaseLobe& lobe = phase.lobes[index];
        const PhaseForm form = phase_form(lobe);
        terms.constant[i] = static_cast<float>(form.constant) * lobe.weight / weights;
        terms.squared[i] = static_cast<float>(form.squared) * lobe.weight / weights;
        terms.spread[i] = static_cast<float>(form.spread);
        (lobe.g >= 0.0F ? terms.forward : terms.backward)[i] = static_cast<float>(form.chord);
        terms.steep[i] = lobe.function == PhaseFunction::schlick ? 1.0F : 0.0F;
    }
    return terms;
}

/// As shaders/common/light_attenuation.glsl describes them.
glm::vec4 air_heights(const FrameInputs& frame) {
    return {heights_of_map(frame.medium) - frame.camera.origin_m.y, 0.0, 0.0};
}

/// From phase and ambient as `write_phase` left them, turned into view space.
gpu::FarField far_field(const FrameInputs& frame, const gpu::VolumetricParameters& u) {
    const Medium& medium = frame.medium;
    const glm::dmat3 view_from_render(frame.camera.view_from_render);
    gpu::FarField far{};
    const float mean = mean_of_map(medium);
    far.homogeneous = glm::vec4(medium.homogeneous.albedo, mean * medium.homogeneous.extinction_per_m);
    far.homogeneous_color = u.homogeneous_color;
    far.height_color = u.height_color;
    far.height = glm::vec4(medium.height.albedo, mean * medium.height.extinction_per_m);
    far.up = glm::vec4(view_from_render * glm::dvec3(0.0, 1.0, 0.0),
                       frame.camera.origin_m.y - static_cast<double>(medium.height.base_height_m));
    far.heights = air_heights(frame);
    far.sun_illuminance.w = medium.height.falloff_per_m;
    if (frame.sun) {
        const glm::dvec3 travel = glm::normalize(glm::dvec3(frame.sun->direction));
        far.sun_direction = glm::vec4(view_from_render * travel, weakens_light(medium, frame.settings) ? 1.0 : 0.0);
        far.sun_illuminance = glm::vec4(frame.sun->illuminance_lux, medium.height.falloff_per_m);
    }
    far.phase = phase_terms(phase_of(medium));
    far.ambient = u.ambient;
    const glm::mat3 turn(view_from_render);
    far.ambient_x = turn[0][0] * u.ambient_x + turn[1][0] * u.ambient_y + turn[2][0] * u.ambient_z;
    far.ambient_y = turn[0][1] * u.ambient_x + turn[1][1] * u.ambient_y + turn[2][1] * u.ambient_z;
    far.ambient_z = turn[0][2] * u.ambient_x + turn[1][2] * u.ambient_y + turn[2][2] * u.ambient_z;
    return far;
}

/// Of the march toward the sun: each step is so much longer than the one before, and no longer than so many noise cells
/// in the mean.
constexpr float light_step_growth = 1.3F;
constexpr float light_step_cells = 1.0F;

/// The volumes that are not empty; their number.
std::uint32_t write_volumes(const FrameInputs& frame, float density_scale, float emission_scale,
                            gpu::VolumetricParameters& u) {
    const auto grids = grids_of(frame.medium);
    std::uint32_t count = 0;
    for (const LocalVolume& volume : frame.medium.volumes) {
        const glm::dvec3 half_size_m(volume.half_size_m);
        if (half_size_m.x <= 0.0 || half_size_m.y <= 0.0 || half_size_m.z <= 0.0) {
            continue;
        }
        const glm::dmat3 axes = glm::mat3_cast(glm::normalize(glm::dquat(volume.rotation)));
        const glm::dvec3 from_center_m = frame.camera.origin_m - glm::dvec3(volume.center_m);
        gpu::GpuLocalVolume& out = u.volumes[count++];
        glm::vec4* rows[] = {&out.row_x, &out.row_y, &out.row_z};
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 row = axes[i] / half_size_m[i];
            *rows[i] = glm::vec4(row, glm::dot(row, from_center_m));
        }
        const bool multiplies = volume.blend == VolumeBlend::multiply;
        out.albedo_amount =
            glm::vec4(volume.albedo, multiplies ? volume.factor : volume.extinction_per_m * density_scale);
        out.color = glm::vec4(volume.extinction_color, 0.0F);
        out.emission = glm::vec4(volume.emission_per_m * emission_scale, volume.density ? volume.density->mean() : 1.0);
        if (volume.density) {
            const auto which = std::find(grids.begin(), grids.end(), volume.density) - grids.begin() + 1;
            out.grid = glm::vec4(volume.density->size(), which);
        }
        out.edge_shape_blend = glm::vec4(volume.edge > 0.0F ? 1.0F / volume.edge : 0.0F, volume.shape, volume.blend, 0);
    }
    return count;
}

glm::vec4 rendered_area(const FrameInputs& frame) {
    const glm::vec2 columns(frame.settings.grid.width, frame.settings.grid.height);
    const glm::vec2 allocated(allocated_columns(frame));
    // A little before the middle of the last column: samplers round coordinates, to a 256th of a texel or better.
    const glm::vec2 last = (columns - 0.5F - 1.0F / 128.0F) / allocated;
    return {columns / allocated, columns.x < allocated.x ? last.x : 1.0F, columns.y < allocated.y ? last.y : 1.0F};
}

/// Their number.
std::size_t write_changes(const FrameInputs& frame, const std::optional<FrameMemory>& before,
                          gpu::VolumetricParameters& u) {
    if (!before) {
        return 0;
    }
    const glm::dvec3 eye_before_m = before->camera.origin_m - frame.camera.origin_m;
    u.motion = glm::vec4(eye_before_m, is_perspective(frame.camera) ? glm::length(eye_before_m) : 0.0);
    std::size_t count = 0;
    for (const LightChange& change : light_changes(frame, *before)) {
        u.changed_lights[2 * count] = change.before;
        u.changed_lights[2 * count + 1] = change.now;
        ++count;
    }
    return count;
}

} // namespace

glm::vec4 air_of(const FrameInputs& frame) {
    const Medium& medium = frame.medium;
    const float mean = mean_of_map(medium);
    return weakens_light(medium, frame.settings)
               ? glm::vec4(mean * medium.homogeneous.extinction_per_m, mean * medium.height.extinction_per_m,
                           medium.height.falloff_per_m, medium.height.base_height_m)
               : glm::vec4(0.0F);
}

glm::uvec2 allocated_columns(const FrameInputs& frame) {
    return glm::max(frame.allocated_columns, glm::uvec2(frame.settings.grid.width, frame.settings.grid.height));
}

gpu::ScatteringVolume scattering_volume(const GridSettings& grid, const Camera& camera, float radiance_scale) {
    // clip.x = p00 x + p20 (-z) + p30 = ndc w  with  ndc = 2 uv - 1, solved for x at view depth z; y alike.
    const glm::dmat4& p = camera.clip_from_view;
    const ClipW w = clip_w(p);
    gpu::ScatteringVolume volume{};
    for (int i = 0; i < 2; ++i) {
        const double inverse = 1.0 / p[i][i];
        volume.slope[i] = static_cast<float>(2.0 * w.depth * inverse);
        volume.slope[i + 2] = static_cast<float>((p[2][i] - w.depth) * inverse);
        volume.origin[i] = static_cast<float>(2.0 * w.constant * inverse);
        volume.origin[i + 2] = static_cast<float>((-p[3][i] - w.constant) * inverse);
    }
    volume.law = depth_law(grid);
    volume.grid = glm::vec4(grid.width, grid.height, grid.slices, 0.0F);
    // z at t = i / N is s (e^(i y) - 1).
    const double shape_m = effective_shape_m(grid);
    const double y = std::log1p(static_cast<double>(grid.range_m) / shape_m) / grid.slices;
    volume.slice = glm::vec4(shape_m * std::expm1(y), shape_m * std::expm1(0.5 * y), std::exp(y), std::exp(-y));
    volume.area = glm::vec4(1.0F);
    volume.scale = glm::vec4(radiance_scale, 1.0F / radiance_scale, std::expm1(y), 0.0F);
    return volume;
}

gpu::LightClusters light_clusters(const GridSettings& grid, std::uint32_t light_count, const gpu::DepthLaw& law) {
    const glm::uvec3 froxels(grid.width, grid.height, grid.slices);
    const glm::uvec3 counts = (froxels + cluster_block - 1U) / cluster_block;
    return {.grid = glm::uvec4(froxels, light_count),
            .block = glm::uvec4(cluster_block, (light_count + 31U) / 32U),
            .counts = glm::uvec4(counts, 0),
            .law = law};
}

FrameMemory memory_of(const FrameInputs& frame, const gpu::VolumetricParameters& parameters) {
    return {.camera = frame.camera,
            .medium = frame.medium,
            .image_size = frame.image_size,
            .sun = frame.sun,
            .lights = frame.lights,
            .air = air_of(frame),
            .march = light_march(frame.medium, frame.settings),
            .volume = parameters.volume,
            .storage = frame.settings.storage,
            .frames_since_cut = parameters.frame.x};
}

bool starts_cold(const FrameInputs& frame, const std::optional<FrameMemory>& before) {
    if (!before || frame.cut || before->storage != frame.settings.storage || before->image_size != frame.image_size) {
        return true;
    }
    // The same bits in every member but the radiance scale, which rescales history exactly.
    gpu::ScatteringVolume now = scattering_volume(frame.settings.grid, frame.camera, 1.0F);
    now.area = rendered_area(frame);
    now.scale.x = before->volume.scale.x;
    now.scale.y = before->volume.scale.y;
    now.beyond = before->volume.beyond; // holds no froxel
    using Words = std::array<std::uint32_t, sizeof now / 4>;
    return std::bit_cast<Words>(now) != std::bit_cast<Words>(before->volume);
}

bool camera_stands(const FrameInputs& frame, const std::optional<FrameMemory>& before) {
    return before && before->camera.view_from_render == frame.camera.view_from_render &&
           before->camera.origin_m == frame.camera.origin_m;
}

bool is_perspective(const Camera& camera) {
    return camera.clip_from_view[2][3] != 0.0;
}

gpu::VolumetricParameters volumetric_parameters(const FrameInputs& frame, const std::optional<FrameMemory>& before) {
    const Medium& medium = frame.medium;
    const float radiance_scale = radiance_scale_for(frame, before);
    // The densest at a quarter of fp16's largest, noise of octaves at most doubling it; the thinnest 1e11 times below.
    const float largest = 32768.0F / std::max(2.0F, static_cast<float>(noise_bound(medium.noise)));
    const float density_scale =
        largest / std::max(extinction_bound(medium) + extinction_bound(frame.fog_particles), 1e-20F);
    const float emission_scale = largest / std::max(emission_bound(medium), 1e-20F);
    const glm::dmat3 render_from_view = glm::transpose(glm::dmat3(frame.camera.view_from_render));

    gpu::VolumetricParameters u{};
    u.volume = scattering_volume(frame.settings.grid, frame.camera, radiance_scale);
    u.volume.area = rendered_area(frame);
    u.render_from_view = glm::mat4(glm::dmat4(render_from_view));
    const glm::dvec4 slope(u.volume.slope);
    const glm::dvec4 origin(u.volume.origin);
    u.ray_u = glm::vec4(render_from_view * glm::dvec3(slope.x, 0.0, 0.0), 0.0);
    u.ray_v = glm::vec4(render_from_view * glm::dvec3(0.0, slope.y, 0.0), 0.0);
    u.ray_0 = glm::vec4(render_from_view * glm::dvec3(slope.z, slope.w, -1.0), 0.0);
    u.eye_u = glm::vec4(render_from_view * glm::dvec3(origin.x, 0.0, 0.0), 0.0);
    u.eye_v = glm::vec4(render_from_view * glm::dvec3(0.0, origin.y, 0.0), 0.0);
    u.eye_0 = glm::vec4(render_from_view * glm::dvec3(origin.z, origin.w, 0.0), 0.0);
    u.previous_view_from_view = glm::mat4(1.0F);
    if (before) {
        glm::dmat4 moved(render_from_view);
        moved[3] = glm::dvec4(frame.camera.origin_m - before->camera.origin_m, 1.0);
        u.previous_view_from_view = glm::mat4(before->camera.view_from_render * moved);
    }
    u.homogeneous = glm::vec4(medium.homogeneous.albedo, medium.homogeneous.extinction_per_m * density_scale);
    u.height = glm::vec4(medium.height.albedo, medium.height.extinction_per_m * density_scale);
    u.homogeneous_color = glm::vec4(medium.homogeneous.extinction_color, 0.0F);
    u.height_color = glm::vec4(medium.height.extinction_color, 0.0F);
    u.homogeneous_emission = glm::vec4(medium.homogeneous.emission_per_m * emission_scale, 0.0F);
    u.height_emission = glm::vec4(medium.height.emission_per_m * emission_scale, 0.0F);
    u.height_law = glm::vec4(static_cast<double>(medium.height.base_height_m) - frame.camera.origin_m.y,
                             medium.height.falloff_per_m, 0.0, 0.0);
    u.air = air_of(frame);
    u.air.w = static_cast<float>(frame.camera.origin_m.y - static_cast<double>(u.air.w));
    u.air_heights = air_heights(frame);
    write_noise(frame, u);
    write_map(frame, u);
    u.density_scale = glm::vec4(density_scale, 1.0F / density_scale, 0.0F, 0.0F);
    u.emission_scale = glm::vec4(emission_scale, density_scale / emission_scale * radiance_scale, 0.0F, 0.0F);
    write_phase(medium, u);
    u.volume.beyond = far_field(frame, u);
    u.temporal = temporal_parameters(frame, before, radiance_scale);
    const std::uint32_t frames_since_cut = before ? before->frames_since_cut + 1 : 0;
    u.jitter = jitter(frame, frames_since_cut);
    if (frame.sun) {
        u.sun_direction = glm::vec4(glm::normalize(frame.sun->direction), 0.0F);
        u.sun_illuminance = glm::vec4(frame.sun->illuminance_lux, 0.0F);
    }
    for (int i = 0; i < 4; ++i) {
        u.esm_exponents[i] = frame.settings.shadow.esm_exponent[static_cast<std::size_t>(i)];
    }
    u.depth = depth_coefficients(frame.camera.clip_from_view);
    u.sky.x = far_device_depth(u.depth);
    u.frame = glm::uvec4(frames_since_cut, frame.lights.size(), write_volumes(frame, density_scale, emission_scale, u),
                         write_changes(frame, before, u));
    u.march = glm::vec4(u.frame.z, light_march(medium, frame.settings).steps, light_step_growth, light_step_cells);
    return u;
}

} // namespace tyndall::volumetrics
