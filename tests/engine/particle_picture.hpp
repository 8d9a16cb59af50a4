// A picture of single particles before an even background, in fog or without, and what it should hold.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "engine/particles.hpp"
#include "shaders/common/lights.h"
#include "tests/engine/particles_fixture.hpp"

namespace tyndall::test {

using engine::ParticleEmitter;

inline constexpr std::uint32_t size_px = 65; // odd: a pixel's centre lies on the axis of the view

/// A single resting particle, in the middle of its life at the time of Picture's view.
[[nodiscard]] ParticleEmitter resting(const glm::dvec3& position_m, float radius_m, float opacity);

/// A homogeneous medium and the light in it, the same in every column.
struct Fog {
    double extinction_per_m = 0.1;
    double source = 3.0;                 ///< radiance of an infinitely deep medium
    double in_scattered = 2.0;           ///< light per unit of albedo
    float lamp_extinction_per_m = 1e-9F; ///< of the air that lamps shine in
};

struct Picture {
    engine::FrameView view = square_view({0.0, 0.0, 0.0}, 2.0, 0.5, size_px);
    engine::ParticleLight light{.ambient_radiance = {4.0F, 4.0F, 4.0F}};
    std::vector<float> split_depths_m = {};
    std::vector<std::uint32_t> intervals = {0}; ///< drawn, in this order
    double surface_m = 1e9;                     ///< view depth of the opaque scene
    std::optional<Fog> fog = {};
    std::optional<float> shadow_depth = {}; ///< what the only cascade holds
    std::vector<gpu::GpuLight> lights = {}; ///< with fog those that its volume leaves out
    std::optional<double> caster_m = {};    ///< from the first light, in all directions: it alone casts a shadow
};

inline constexpr glm::dvec4 background{10.0, 20.0, 30.0, 1.0};

class ParticlesDrawTest : public ParticleFrameTest {
protected:
    [[nodiscard]] std::vector<glm::vec4> draw(const std::vector<ParticleEmitter>& emitters, const Picture& picture);
    [[nodiscard]] glm::dvec4 center(const std::vector<ParticleEmitter>& emitters, const Picture& picture) {
        const std::vector<glm::vec4> pixels = draw(emitters, picture);
        return glm::dvec4(pixels[(size_px / 2) * size_px + size_px / 2]);
    }

private:
    void add_fog(rg::GraphBuilder& graph, const Fog& fog, const engine::FrameView& view,
                 const std::vector<gpu::GpuLight>& lamps, engine::ParticleSurroundings& surroundings);
    void add_shadow(rg::GraphBuilder& graph, float depth, engine::ParticleSurroundings& surroundings);
    void add_local_shadow(rg::GraphBuilder& graph, const gpu::GpuLight& light, double caster_m,
                          engine::ParticleSurroundings& surroundings);
    template <typename T>
    [[nodiscard]] rg::Buffer import(rg::GraphBuilder& graph, std::string_view name, std::span<const T> content) {
        const engine::Buffer& memory = upload(content);
        const rg::Buffer buffer = graph.import_buffer(name, {.size_bytes = memory.size_bytes()}, written_by_host());
        imports_.push_back({.resource = buffer.resource, .buffer = memory.handle()});
        return buffer;
    }

    std::vector<rg::ImportBinding> imports_;
};

/// Premultiplied over what is behind: a particle of radiance C, seen through T and L, with alpha a.
[[nodiscard]] glm::dvec4 over(const glm::dvec4& behind, const glm::dvec3& radiance, double alpha);

void expect_near(const glm::dvec4& actual, const glm::dvec4& expected, double relative);

inline constexpr glm::dvec3 albedo{0.5, 0.75, 1.0}; ///< of a resting particle

} // namespace tyndall::test
