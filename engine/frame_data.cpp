#include "engine/frame_data.hpp"

#include <algorithm>
#include <cmath>

namespace tyndall::engine {
namespace {

glm::vec4 with_w(const glm::vec3& v, float w) {
    return {v, w};
}

/// Columns are the cross products of the columns of `m`: its inverse transpose times its determinant, defined for every
/// matrix, brought to a magnitude that single precision holds.
glm::dmat3 cofactors(const glm::dmat3& m) {
    const glm::dmat3 c(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    double largest = 0.0;
    for (int column = 0; column < 3; ++column) {
        const glm::dvec3 a = glm::abs(c[column]);
        largest = std::max({largest, a.x, a.y, a.z});
    }
    return largest > 0.0 ? c / largest : glm::dmat3(1.0);
}

} // namespace

gpu::FrameParameters make_frame_parameters(const FrameView& view, const LightRoles& lights, const FrameLook& look) {
    gpu::FrameParameters out{};
    out.clip_from_render = glm::mat4(view.clip_from_view * view.view_from_render);
    const glm::dmat4& v = view.view_from_render;
    out.depth_row = glm::vec4(-v[0][2], -v[1][2], -v[2][2], -v[3][2]);
    const glm::vec3 forward(out.depth_row);
    out.to_eye = is_perspective(view) ? glm::vec4(0.0F, 0.0F, 0.0F, 1.0F) : glm::vec4(-forward, 0.0F);
    const ViewRays rays = view_rays(view);
    out.ray_origin = with_w(glm::vec3(rays.origin), look.largest_radiance);
    out.ray_u = with_w(glm::vec3(rays.u), 0.0F);
    out.ray_v = with_w(glm::vec3(rays.v), 0.0F);
    const glm::vec2 size(static_cast<float>(view.size.width), static_cast<float>(view.size.height));
    out.size = glm::vec4(size, 1.0F / size);
    out.ambient_up = with_w(look.ambient.up, static_cast<float>(lights.fills.size()));
    out.ambient_down = with_w(look.ambient.down, static_cast<float>(look.local_light_count));
    out.sky_zenith = with_w(look.background.zenith, 0.0F);
    out.sky_horizon = with_w(look.background.horizon, 0.0F);
    out.sky_ground = with_w(look.background.ground, 0.0F);
    const DirectionalLight sun = lights.sun.value_or(DirectionalLight{});
    out.sun_direction = with_w(glm::vec3(sun.direction), 0.0F);
    out.sun_illuminance = with_w(sun.illuminance_lux, 0.0F);
    out.medium = look.medium;
    for (std::size_t i = 0; i < lights.fills.size(); ++i) {
        out.fill_direction[i] = with_w(glm::vec3(lights.fills[i].direction), 0.0F);
        out.fill_illuminance[i] = with_w(lights.fills[i].illuminance_lux, 0.0F);
    }
    return out;
}

gpu::GpuInstance make_gpu_instance(const Instance& instance, const glm::dvec3& origin_m) {
    glm::dmat4 m = instance.world_from_object;
    m[3] -= glm::dvec4(origin_m, 0.0);
    const glm::dmat3 normals = cofactors(glm::dmat3(m)) * (instance.mirrored ? -1.0 : 1.0);
    gpu::GpuInstance out{};
    for (int row = 0; row < 3; ++row) {
        out.render_from_object[row] = glm::vec4(m[0][row], m[1][row], m[2][row], m[3][row]);
        out.normal_from_object[row] = glm::vec4(normals[0][row], normals[1][row], normals[2][row], 0.0);
    }
    out.normal_from_object[0].w = instance.mirrored ? -1.0F : 1.0F;
    return out;
}

tl::expected<FrameData, Error> FrameData::create(const Device& device, std::uint32_t frames_in_flight,
                                                 std::size_t instance_count, std::size_t light_count) {
    FrameData data;
    for (std::uint32_t i = 0; i < frames_in_flight; ++i) {
        Slot& slot = data.slots_.emplace_back();
        struct Want {
            Buffer* buffer;
            std::size_t size_bytes;
            VkBufferUsageFlags usage;
        };
        const Want wanted[] = {
            {&slot.parameters, sizeof(gpu::FrameParameters), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT},
            {&slot.instances, std::max<std::size_t>(instance_count, 1) * sizeof(gpu::GpuInstance),
             VK_BUFFER_USAGE_STORAGE_BUFFER_BIT},
            {&slot.lights, std::max<std::size_t>(light_count, 1) * sizeof(gpu::GpuLight),
             VK_BUFFER_USAGE_STORAGE_BUFFER_BIT},
            {&slot.sun, sizeof(gpu::SunCascades), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT},
            {&slot.local_shadows, std::max<std::size_t>(light_count, 1) * sizeof(gpu::LocalShadow),
             VK_BUFFER_USAGE_STORAGE_BUFFER_BIT},
        };
        for (const Want& want : wanted) {
            auto made = Buffer::create(device, want.size_bytes, want.usage, MemoryUse::upload);
            if (!made) {
                return tl::unexpected(made.error());
            }
            *want.buffer = std::move(*made);
        }
    }
    return data;
}

void FrameData::write_parameters(std::uint32_t slot, const gpu::FrameParameters& parameters) {
    slots_[slot].parameters.mapped_as<gpu::FrameParameters>().front() = parameters;
}

void FrameData::write_places(std::uint32_t slot, const glm::dvec3& origin_m, const std::vector<Instance>& instances,
                             const std::vector<Light>& lights, const LightSettings& settings,
                             const std::vector<ShadowedLight>& shadowed) {
    Slot& into = slots_[slot];
    if (into.origin_m == origin_m && into.shadowed == shadowed) {
        return;
    }
    into.origin_m = origin_m;
    into.shadowed = shadowed;
    const std::span<gpu::GpuInstance> places = into.instances.mapped_as<gpu::GpuInstance>();
    for (std::size_t i = 0; i < instances.size(); ++i) {
        places[i] = make_gpu_instance(instances[i], origin_m);
    }
    into.light_records.clear();
    for (const Light& light : lights) {
        into.light_records.push_back(make_gpu_light(light, origin_m, settings));
    }
    for (std::size_t record = 0; record < shadowed.size(); ++record) {
        into.light_records[shadowed[record].light].cone.z = static_cast<float>(record + 1);
    }
    std::copy(into.light_records.begin(), into.light_records.end(), into.lights.mapped_as<gpu::GpuLight>().begin());
}

void FrameData::write_local_shadows(std::uint32_t slot, std::span<const gpu::LocalShadow> records) {
    std::copy(records.begin(), records.end(), slots_[slot].local_shadows.mapped_as<gpu::LocalShadow>().begin());
}

void FrameData::write_sun(std::uint32_t slot, const gpu::SunCascades& sun) {
    slots_[slot].sun.mapped_as<gpu::SunCascades>().front() = sun;
}

} // namespace tyndall::engine
