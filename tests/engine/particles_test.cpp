// Simulation, sort and split on a device.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "engine/particle_frame.hpp"
#include "engine/particle_passes.hpp"
#include "tests/engine/particle_model.hpp"
#include "tests/engine/particles_fixture.hpp"

namespace tyndall::test {
namespace {

using engine::ParticleEmitter;

constexpr std::uint32_t not_drawn = 0xffffffffU;

struct Key {
    std::uint32_t key;
    std::uint32_t slot;
    friend bool operator==(const Key&, const Key&) = default;
};
static_assert(sizeof(Key) == 8);

/// Smoke that rises under drag in turbulence, a slow fountain without drag, and dust: all terms of the motion, and
/// numbers of slots that are no powers of two.
std::vector<ParticleEmitter> three_emitters() {
    return {
        {.name = "smoke",
         .position_m = {3.0, 0.5, -8.0},
         .box_half_extent_m = {0.2F, 0.05F, 0.3F},
         .rate_per_s = 16.0,
         .lifetime_s = 7.0,
         .velocity_m_s = {0.04F, 0.75F, 0.02F},
         .velocity_spread_m_s = {0.12F, 0.15F, 0.12F},
         .buoyancy_m_s2 = 0.06F,
         .drag_per_s = 0.12F,
         .turbulence_m_s = 0.16F,
         .start_radius_m = 0.16F,
         .end_radius_m = 0.95F,
         .opacity = 0.2F,
         .seed = 0},
        {.name = "fountain",
         .position_m = {-2.0, 0.0, -11.0},
         .rate_per_s = 3.7,
         .lifetime_s = 2.0,
         .velocity_m_s = {0.0F, 6.0F, 0.0F},
         .velocity_spread_m_s = {1.0F, 1.0F, 1.0F},
         .buoyancy_m_s2 = -9.81F,
         .start_radius_m = 0.0F,
         .end_radius_m = 0.05F,
         .seed = 5},
        {.name = "dust",
         .kind = engine::ParticleKind::dust,
         .position_m = {0.0, 2.0, -9.0},
         .box_half_extent_m = {4.0F, 2.0F, 4.0F},
         .rate_per_s = 60.0,
         .lifetime_s = 14.0,
         .velocity_spread_m_s = {0.05F, 0.04F, 0.05F},
         .drag_per_s = 3.0F,
         .turbulence_m_s = 0.05F,
         .start_radius_m = 0.006F,
         .end_radius_m = 0.008F,
         .opacity = 0.5F,
         .seed = 2},
    };
}

/// Every emitter above is well inside.
engine::FrameView view_at(const glm::dvec3& origin_m, double time_s) {
    return square_view(origin_m, time_s, 2.0, 480);
}

struct Simulated {
    std::vector<gpu::GpuParticle> particles;
    std::vector<Key> keys;
};

class ParticlesTest : public ParticleFrameTest {
protected:
    void SetUp() override {
        ParticleFrameTest::SetUp();
        ASSERT_FALSE(HasFatalFailure());
        auto made = engine::ParticlePasses::create(device(), VK_NULL_HANDLE);
        ASSERT_TRUE(made.has_value()) << made.error().message;
        passes_.emplace(std::move(*made));
    }
    void TearDown() override {
        passes_.reset();
        ParticleFrameTest::TearDown();
    }

    [[nodiscard]] Simulated simulate(const engine::FrameView& view, const std::vector<ParticleEmitter>& emitters) {
        const std::uint32_t count = engine::particle_count(emitters);
        const std::uint32_t key_count = engine::particle_key_count(count);
        const gpu::ParticleFrame frame = engine::make_particle_frame(view, {}, emitters);
        const std::vector<gpu::GpuEmitter> packed = engine::make_gpu_emitters(view, emitters);
        std::vector<std::byte> bytes(sizeof frame + packed.size() * sizeof packed[0]);
        std::memcpy(bytes.data(), &frame, sizeof frame);
        std::memcpy(bytes.data() + sizeof frame, packed.data(), packed.size() * sizeof packed[0]);
        engine::Buffer& input = upload(std::span<const std::byte>(bytes));
        engine::Buffer& particle_memory = host_buffer(count * sizeof(gpu::GpuParticle));
        engine::Buffer& key_memory = host_buffer(key_count * sizeof(Key));
        rg::GraphBuilder graph;
        const rg::Buffer in = graph.import_buffer("frame", {.size_bytes = input.size_bytes()}, written_by_host());
        rg::Buffer out = graph.import_buffer("particles", {.size_bytes = particle_memory.size_bytes()}, read_by_host());
        rg::Buffer keys = graph.import_buffer("keys", {.size_bytes = key_memory.size_bytes()}, read_by_host());
        passes_->declare_simulation(graph, in, out, keys, key_count);
        const rg::ImportBinding imports[] = {{.resource = in.resource, .buffer = input.handle()},
                                             {.resource = out.resource, .buffer = particle_memory.handle()},
                                             {.resource = keys.resource, .buffer = key_memory.handle()}};
        run(graph.finish(), imports);
        const auto particle_view = particle_memory.mapped_as<gpu::GpuParticle>();
        const auto key_view = key_memory.mapped_as<Key>();
        return {{particle_view.begin(), particle_view.end()}, {key_view.begin(), key_view.end()}};
    }

    [[nodiscard]] std::vector<Key> sort(const std::vector<Key>& unsorted) {
        engine::Buffer& memory = upload(std::span(unsorted));
        rg::ImportDesc import = read_by_host();
        rg::GraphBuilder graph;
        rg::Buffer keys = graph.import_buffer("keys", {.size_bytes = unsorted.size() * sizeof(Key)}, import);
        passes_->declare_sort(graph, keys, static_cast<std::uint32_t>(unsorted.size()));
        const rg::ImportBinding binding{.resource = keys.resource, .buffer = memory.handle()};
        run(graph.finish(), std::span(&binding, 1));
        const std::span<Key> result = memory.mapped_as<Key>().first(unsorted.size());
        return {result.begin(), result.end()};
    }

    [[nodiscard]] std::vector<VkDrawIndirectCommand> split(const std::vector<Key>& sorted,
                                                           const std::vector<float>& depths_m) {
        engine::Buffer& key_memory = upload(std::span(sorted));
        engine::Buffer& depth_memory = upload(std::span(depths_m));
        const std::size_t intervals = depths_m.size() + 1;
        engine::Buffer& draw_memory = host_buffer(intervals * sizeof(VkDrawIndirectCommand));
        rg::GraphBuilder graph;
        const rg::Buffer keys = graph.import_buffer("keys", {.size_bytes = key_memory.size_bytes()}, written_by_host());
        const rg::Buffer depths =
            graph.import_buffer("depths", {.size_bytes = depth_memory.size_bytes()}, written_by_host());
        rg::Buffer draws = graph.import_buffer("draws", {.size_bytes = draw_memory.size_bytes()}, read_by_host());
        passes_->declare_split(graph, keys, depths, draws, static_cast<std::uint32_t>(sorted.size()),
                               static_cast<std::uint32_t>(depths_m.size()));
        const rg::ImportBinding imports[] = {{.resource = keys.resource, .buffer = key_memory.handle()},
                                             {.resource = depths.resource, .buffer = depth_memory.handle()},
                                             {.resource = draws.resource, .buffer = draw_memory.handle()}};
        run(graph.finish(), imports);
        const auto result = draw_memory.mapped_as<VkDrawIndirectCommand>();
        return {result.begin(), result.end()};
    }

    std::optional<engine::ParticlePasses> passes_;
};

TEST_F(ParticlesTest, SimulationAgreesWithTheDoublePrecisionModel) {
    const std::vector<ParticleEmitter> emitters = three_emitters();
    for (const double time_s : {0.0, 1.0, 1e4, -3.7}) {
        // Far from the world's origin the numbers must not get coarser.
        for (const double far_m : {0.0, 1e6}) {
            std::vector<ParticleEmitter> moved = emitters;
            for (ParticleEmitter& emitter : moved) {
                emitter.position_m.x += far_m;
            }
            const glm::dvec3 origin_m{far_m + 0.5, 1.0, 6.0};
            const Simulated result = simulate(view_at(origin_m, time_s), moved);
            std::size_t index = 0;
            std::size_t alive = 0;
            for (const ParticleEmitter& emitter : moved) {
                for (std::uint32_t slot = 0; slot < particle_slots(emitter); ++slot, ++index) {
                    const ModelParticle model = model_particle(emitter, slot, time_s);
                    const gpu::GpuParticle& particle = result.particles[index];
                    const glm::dvec3 expected = model.position_m - origin_m;
                    SCOPED_TRACE(emitter.name + " slot " + std::to_string(slot) + " at " + std::to_string(time_s));
                    ASSERT_EQ(result.keys[index].slot, index);
                    if (!model.alive) {
                        ASSERT_EQ(result.keys[index].key, not_drawn);
                        continue;
                    }
                    ++alive;
                    for (int axis = 0; axis < 3; ++axis) {
                        ASSERT_NEAR(static_cast<double>(particle.position_radius[axis]), expected[axis], 5e-5) << axis;
                    }
                    ASSERT_NEAR(static_cast<double>(particle.position_radius.w), model.radius_m, 1e-6);
                    ASSERT_NEAR(static_cast<double>(particle.albedo_alpha.w), model.alpha, 2e-5);
                    const std::uint32_t key = model_depth_key(-particle.position_radius.z);
                    ASSERT_EQ(result.keys[index].key, particle.albedo_alpha.w > 0.0F ? key : not_drawn);
                }
            }
            ASSERT_EQ(index, result.particles.size());
            EXPECT_GT(alive, index - 20); // at most a few slots are empty at any time
            for (; index < result.keys.size(); ++index) {
                ASSERT_EQ(result.keys[index], (Key{not_drawn, static_cast<std::uint32_t>(index)}));
            }
        }
    }
}

TEST_F(ParticlesTest, EverythingIsFiniteAtAnyTime) {
    for (const double time_s : {1e9, -1e9, 1e15, 1e300}) {
        const Simulated result = simulate(view_at({0.0, 1.0, 6.0}, time_s), three_emitters());
        for (const gpu::GpuParticle& particle : result.particles) {
            for (int i = 0; i < 4; ++i) {
                ASSERT_TRUE(std::isfinite(particle.position_radius[i])) << time_s;
                ASSERT_TRUE(std::isfinite(particle.albedo_alpha[i])) << time_s;
                ASSERT_TRUE(std::isfinite(particle.look[i])) << time_s;
            }
        }
    }
}

TEST_F(ParticlesTest, AParticleKeepsItsSlotAndMovesSmoothly) {
    const std::vector<ParticleEmitter> emitters = three_emitters();
    constexpr double step_s = 1e-3;
    constexpr double fastest_m_s = 25.0;
    const Simulated before = simulate(view_at({0.0, 1.0, 6.0}, 5.0), emitters);
    const Simulated after = simulate(view_at({0.0, 1.0, 6.0}, 5.0 + step_s), emitters);
    std::size_t jumps = 0;
    for (std::size_t i = 0; i < before.particles.size(); ++i) {
        const glm::vec3 moved = glm::vec3(after.particles[i].position_radius - before.particles[i].position_radius);
        jumps += static_cast<double>(glm::length(moved)) > fastest_m_s * step_s ? 1 : 0;
    }
    EXPECT_LE(jumps, 1U); // a birth, at most
}

TEST_F(ParticlesTest, WhatIsOutsideTheViewIsNotDrawn) {
    std::vector<ParticleEmitter> emitters = three_emitters();
    const auto drawn = [&](const glm::dvec3& origin_m) {
        const Simulated result = simulate(view_at(origin_m, 4.0), emitters);
        return std::count_if(result.keys.begin(), result.keys.end(),
                             [](const Key& key) { return key.key != not_drawn; });
    };
    EXPECT_GT(drawn({0.0, 1.0, 6.0}), 900);
    EXPECT_EQ(drawn({0.0, 1.0, -60.0}), 0); // behind the camera
    EXPECT_EQ(drawn({90.0, 1.0, 6.0}), 0);  // left of the view
    EXPECT_EQ(drawn({-90.0, 1.0, 6.0}), 0); // right
    EXPECT_EQ(drawn({0.0, -90.0, 6.0}), 0); // above
    EXPECT_EQ(drawn({0.0, 120.0, 6.0}), 0); // below
}

TEST_F(ParticlesTest, SortOrdersAndKeepsEveryKey) {
    std::mt19937 random(20240607);
    // One key block and several, and a network of fewer keys than lanes.
    for (const std::uint32_t count : {2U, 64U, 2048U, 4096U, 16384U}) {
        std::vector<Key> keys(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            // Few different depths, so that many are equal, and negative ones among them.
            const float depth = 0.25F * static_cast<float>(static_cast<int>(random() % 601U) - 300);
            keys[i] = {random() % 8 == 0 ? not_drawn : model_depth_key(depth), i};
        }
        std::shuffle(keys.begin(), keys.end(), random);
        std::vector<Key> expected = keys;
        std::sort(expected.begin(), expected.end(),
                  [](const Key& a, const Key& b) { return a.key < b.key || (a.key == b.key && a.slot < b.slot); });
        EXPECT_TRUE(sort(keys) == expected) << count << " keys";
    }
}

TEST_F(ParticlesTest, KeysOrderDepthsBackToFront) {
    const float infinity = std::numeric_limits<float>::infinity();
    const std::array<float, 9> far_to_near{infinity, 1e30F, 7.5F, 1e-30F, 0.0F, -1e-30F, -7.5F, -1e30F, -infinity};
    for (std::size_t i = 1; i < far_to_near.size(); ++i) {
        EXPECT_LT(model_depth_key(far_to_near[i - 1]), model_depth_key(far_to_near[i]));
    }
    EXPECT_EQ(model_depth_key(-0.0F), model_depth_key(0.0F));
    EXPECT_LT(model_depth_key(-infinity), not_drawn);
}

TEST_F(ParticlesTest, SplitCoversEveryDrawnParticleOnceBetweenItsDepths) {
    std::mt19937 random(7);
    const auto random_depth = [&] { return 0.5F * static_cast<float>(static_cast<int>(random() % 81U) - 20); };
    for (const std::size_t splits : {0U, 1U, 5U, 200U}) {
        std::vector<float> depths(512);
        std::generate(depths.begin(), depths.end(), random_depth);
        std::sort(depths.begin(), depths.end(), std::greater<>());
        const std::size_t drawn = 400;
        std::vector<Key> keys(512);
        for (std::uint32_t i = 0; i < keys.size(); ++i) {
            keys[i] = {i < drawn ? model_depth_key(depths[i]) : not_drawn, i};
        }
        std::vector<float> split_depths(splits);
        std::generate(split_depths.begin(), split_depths.end(), random_depth);
        std::sort(split_depths.begin(), split_depths.end(), std::greater<>());

        const std::vector<VkDrawIndirectCommand> draws = split(keys, split_depths);
        ASSERT_EQ(draws.size(), splits + 1);
        std::uint32_t next = 0;
        for (std::size_t i = 0; i < draws.size(); ++i) {
            ASSERT_EQ(draws[i].instanceCount, 1U);
            ASSERT_EQ(draws[i].firstInstance, 0U);
            ASSERT_EQ(draws[i].firstVertex, 6 * next);
            ASSERT_EQ(draws[i].vertexCount % 6, 0U);
            const std::uint32_t end = next + draws[i].vertexCount / 6;
            ASSERT_LE(end, drawn);
            for (; next < end; ++next) {
                if (i > 0) {
                    ASSERT_LE(depths[next], split_depths[i - 1]);
                }
                if (i < splits) {
                    ASSERT_GT(depths[next], split_depths[i]);
                }
            }
        }
        ASSERT_EQ(next, drawn);
    }
}

} // namespace
} // namespace tyndall::test
