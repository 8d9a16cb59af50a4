// The integrators' orders of convergence in double precision, and the shader against the same sums.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

#include "features/volumetrics/parameters.hpp"
#include "features/volumetrics/pipelines.hpp"
#include "samples/precision/orders.hpp"
#include "tests/gpu/gpu_fixture.hpp"
#include "tests/volumetrics/transfer_passes.hpp"

namespace tyndall::volumetrics::test {
namespace {

using rg::Access;
using tyndall::test::HostBuffer;

using samples::integrate;
using samples::smooth_column;
using samples::TwinResult;
using samples::TwinSlice;

constexpr auto& schemes = samples::integrators;
constexpr auto& names = samples::integrator_names;

TEST(IntegratorOrder, IsThatOfTheSchemeOnEvenAndGrowingSlices) {
    const std::vector<samples::OrderRow> rows = samples::measured_orders();
    ASSERT_EQ(rows.size(), 16U);
    std::printf("%s", samples::to_table(rows).c_str());
    for (const samples::OrderRow& row : rows) {
        EXPECT_NEAR(row.order, row.expected, 0.15) << row.integrator << " " << row.density << " " << row.growth;
    }
}

TEST(IntegratorOrder, NoneFitsErrorsWhoseSlopesDoNotSettle) {
    EXPECT_NEAR(samples::fitted_order(std::vector{1.0, 0.25, 0.0625}), 2.0, 1e-12);
    EXPECT_EQ(samples::fitted_order(std::vector{1.0, 0.25, 0.03}), -1.0);
    EXPECT_NEAR(samples::fitted_order(std::vector{1.0, 0.5, 0.25, 1e-14, 1e-14}), 1.0, 1e-12);
}

TEST(IntegratorOrder, ErrorsAt64SlicesAreThoseOfTheTheory) {
    const double exact = samples::smooth_radiance(1.0);
    const double dense = samples::smooth_radiance(20.0);
    EXPECT_NEAR(samples::smooth_error(Integrator::euler, 64, 1.0, 1.0, exact), 2.3e-2, 0.1e-2);
    EXPECT_NEAR(samples::smooth_error(Integrator::half_slice, 64, 1.0, 1.0, exact), 9.8e-5, 0.5e-5);
    EXPECT_NEAR(samples::smooth_error(Integrator::exponential, 64, 1.0, 1.0, exact), 6.4e-6, 0.5e-6);
    EXPECT_NEAR(samples::smooth_error(Integrator::euler, 64, 1.0, 20.0, dense), 0.39, 0.01);
    EXPECT_NEAR(samples::smooth_error(Integrator::half_slice, 64, 1.0, 20.0, dense), 2.1e-2, 0.1e-2);
    EXPECT_NEAR(samples::smooth_error(Integrator::exponential, 64, 1.0, 20.0, dense), 8.7e-5, 0.5e-5);
    // The parabola through middles, where theory's goes through boundaries too: 6.5e-7 and 1e-5 instead of
    // 1e-10, 3.5e-7.
    EXPECT_LE(samples::smooth_error(Integrator::exponential_quadratic, 64, 1.0, 1.0, exact), 1e-6);
    EXPECT_LE(samples::smooth_error(Integrator::exponential_quadratic, 64, 1.0, 20.0, dense), 1.2e-5);
}

TEST(IntegratorOrder, TheParabolaStaysWithinTheSources) {
    // Emission-like edges: dense beside thin, bright beside dark, in every order of three.
    const double extinctions[] = {0.0, 1e-6, 0.5, 1.0, 3.0, 1e3};
    const double sources[] = {0.0, 1.0, 10.0};
    for (const double e0 : extinctions) {
        for (const double e1 : extinctions) {
            for (const double s0 : sources) {
                for (const double s1 : sources) {
                    std::vector<TwinSlice> slices;
                    for (int k = 0; k < 9; ++k) {
                        const bool other = k % 3 == 1;
                        const double e = other ? e1 : e0;
                        slices.push_back({e, e * (other ? s1 : s0), 1.0});
                    }
                    const double found = integrate(Integrator::exponential_quadratic, slices).radiance;
                    EXPECT_GE(found, 0.0);
                    EXPECT_LE(found, std::max(s0, s1) * (1.0 + 1e-12)) << e0 << " " << e1 << " " << s0 << " " << s1;
                }
            }
        }
    }
}

/// The accumulation pass alone, on volumes that are uploaded.
class IntegratorShader : public tyndall::test::GpuTest {
protected:
    struct Output {
        std::vector<glm::vec4> accumulated; ///< of the last boundary, a column each
        std::vector<glm::vec4> estimate;
    };
    static constexpr std::uint32_t width = 8;
    static constexpr std::uint32_t height = 2;

    void SetUp() override {
        GpuTest::SetUp();
        if (!IsSkipped() && !HasFatalFailure()) {
            make_executor(executor_info());
        }
    }

    /// Columns 1 m long, seen by an orthographic camera; `slice_of(x, k)` is what column x holds in slice k.
    Output accumulate(const Settings& settings,
                      const std::function<TwinSlice(std::uint32_t, std::uint32_t)>& slice_of) {
        const rg::ExecutorInfo info = executor_info();
        Pipelines pipelines(vk(), info.device, VK_NULL_HANDLE, info.check_bindings);
        const auto program =
            pipelines.compute(accumulation_shader(settings.storage, false, settings.error_estimate, false), {8, 1, 1},
                              std::array{static_cast<std::uint32_t>(settings.integrator)});
        EXPECT_TRUE(program) << program.error().message;
        EXPECT_FALSE(program->bindings.empty());

        FrameInputs inputs;
        inputs.settings = settings;
        inputs.medium.homogeneous.extinction_per_m = 1.0F; // of which coefficients are stored in parts
        const std::uint32_t slices = settings.grid.slices;
        const gpu::VolumetricParameters parameters = volumetric_parameters(inputs, std::nullopt);
        const std::size_t texels = std::size_t{width} * height;
        const HostBuffer uniform = host_buffer(sizeof parameters, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
        const HostBuffer density_data =
            host_buffer(texels * slices * sizeof(glm::vec4), VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
        const HostBuffer light_data =
            host_buffer(texels * slices * sizeof(glm::vec4), VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
        uniform.as<gpu::VolumetricParameters>()[0] = parameters;
        for (std::uint32_t k = 0; k < slices; ++k) {
            for (std::uint32_t i = 0; i < texels; ++i) {
                const TwinSlice slice = slice_of(i % width, k);
                const double scale = static_cast<double>(parameters.density_scale.x);
                const double light = slice.extinction_per_m > 0.0 ? slice.source_per_m / slice.extinction_per_m : 0.0;
                density_data.as<glm::vec4>()[k * texels + i] = glm::vec4(glm::dvec4(slice.extinction_per_m * scale));
                light_data.as<glm::vec4>()[k * texels + i] = glm::vec4(glm::dvec4(light));
            }
        }

        rg::GraphBuilder graph;
        std::vector<rg::ImportBinding> imports;
        const auto import_written = [&](const char* name, const HostBuffer& buffer) {
            const rg::Buffer handle =
                graph.import_buffer(name, {.size_bytes = buffer.size_bytes}, tyndall::test::written_by_host());
            imports.push_back({.resource = handle.resource, .buffer = buffer.buffer});
            return handle;
        };
        const VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT;
        const rg::ImageDesc volume{.format = format, .extent = {width, height, slices}, .type = VK_IMAGE_TYPE_3D};
        const rg::Buffer uniforms = import_written("parameters", uniform);
        rg::Image density = graph.create_image("density", volume);
        rg::Image light = graph.create_image("light", volume);
        upload(graph, "upload density", import_written("density data", density_data), density);
        upload(graph, "upload light", import_written("light data", light_data), light);
        rg::Image accumulated =
            graph.create_image("accumulated", {.format = format, .extent = {width, height, 1}, .layers = slices + 1});
        rg::Image estimate = graph.create_image("estimate", {.format = format, .extent = {width, height, 1}});
        auto pass = graph.add_pass("accumulation", rg::PassKind::compute);
        pass.reads(uniforms, Access::uniform_compute)
            .reads(density, Access::storage_compute)
            .reads(light, Access::storage_compute)
            .writes(accumulated, Access::storage_compute);
        if (settings.error_estimate) {
            pass.writes(estimate, Access::storage_compute);
        }
        pass.executes([=, program = *program, with_estimate = settings.error_estimate](rg::PassContext& ctx) {
            const rg::ViewDesc layers{.range = {}, .type = VK_IMAGE_VIEW_TYPE_2D_ARRAY};
            std::vector<rg::Binding> bindings{ctx.uniform(0, uniforms), ctx.storage(1, density), ctx.storage(2, light),
                                              ctx.storage(3, accumulated, layers)};
            if (with_estimate) {
                bindings.push_back(ctx.storage(4, estimate));
            }
            ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, program.pipeline);
            ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, program.layout, 0, bindings, program.bindings);
            ctx.vk().CmdDispatch(ctx.cmd(), 1, height, 1);
        });
        const auto read = [&](const char* name, rg::Image image, std::size_t count) {
            const HostBuffer buffer = host_buffer(count * sizeof(glm::vec4), VK_BUFFER_USAGE_TRANSFER_DST_BIT);
            rg::Buffer target =
                graph.import_buffer(name, {.size_bytes = buffer.size_bytes}, tyndall::test::read_by_host());
            imports.push_back({.resource = target.resource, .buffer = buffer.buffer});
            download(graph, std::string("read ") + name, image, target);
            return buffer;
        };
        const HostBuffer layers = read("layers", accumulated, texels * (slices + 1));
        const HostBuffer estimates = settings.error_estimate ? read("estimates", estimate, texels) : HostBuffer{};
        run(graph.finish(), imports);
        EXPECT_TRUE(executor().wait_idle());
        Output output;
        output.accumulated.assign(layers.as<glm::vec4>().end() - static_cast<std::ptrdiff_t>(texels),
                                  layers.as<glm::vec4>().end());
        if (settings.error_estimate) {
            output.estimate.assign(estimates.as<glm::vec4>().begin(), estimates.as<glm::vec4>().end());
        }
        return output;
    }

    /// Slices over 1 m, the last `growth` times as long as the first.
    static Settings settings_for(Integrator integrator, int count, double growth) {
        Settings settings;
        settings.storage = StorageFormat::fp32;
        settings.integrator = integrator;
        const double ratio = std::pow(growth, 1.0 / (count - 1)); // 1 + R / s = ratio^count
        settings.grid = {.width = width,
                         .height = height,
                         .slices = static_cast<std::uint32_t>(count),
                         .range_m = 1.0F,
                         .shape_m = static_cast<float>(
                             ratio == 1.0 ? 100.0 : std::min(100.0, 1.0 / (std::pow(ratio, count) - 1.0)))};
        return settings;
    }
};

TEST_F(IntegratorShader, FollowsItsTwinInDoublePrecision) {
    constexpr std::array densities{1.0, 20.0, 0.01, 100.0, 1e-6, 1e4, 3.0, 0.3};
    for (const double growth : {1.0, 4.0}) {
        for (std::size_t i = 0; i < schemes.size(); ++i) {
            double worst = 0.0;
            double worst_depth = 0.0;
            for (const int count : {8, 16, 64, 256, 512}) {
                std::vector<std::vector<TwinSlice>> columns;
                // An evenly sliced grid is the law at its largest shape: the slices of the twin are those of the law.
                const Settings settings = settings_for(schemes[i], count, growth);
                const double law_growth =
                    std::pow(1.0 + 1.0 / static_cast<double>(settings.grid.shape_m), (count - 1.0) / count);
                for (const double density : densities) {
                    columns.push_back(smooth_column(schemes[i], count, law_growth, density));
                }
                const Output found =
                    accumulate(settings, [&](std::uint32_t x, std::uint32_t k) { return columns[x][k]; });
                for (std::size_t x = 0; x < densities.size(); ++x) {
                    const TwinResult twin = integrate(schemes[i], columns[x]);
                    const double radiance = static_cast<double>(found.accumulated[x].r);
                    const double depth = static_cast<double>(found.accumulated[x].a);
                    // In dense fog half_slice leaves nothing, which no relative error measures.
                    const double scale =
                        std::max(twin.radiance, integrate(Integrator::exponential, columns[x]).radiance);
                    worst = std::max(worst, std::abs(radiance - twin.radiance) / scale);
                    worst_depth = std::max(worst_depth, std::abs(depth / twin.optical_depth - 1.0));
                }
            }
            std::printf("%-22s growth %g: radiance %.1e, optical depth %.1e of the twin's\n", names[i], growth, worst,
                        worst_depth);
            EXPECT_LE(worst, 1e-5) << names[i] << " growth " << growth;
            EXPECT_LE(worst_depth, 1e-5) << names[i];
        }
    }
}

TEST_F(IntegratorShader, EstimatesItsError) {
    const double exact = samples::smooth_radiance(1.0);
    for (std::size_t i = 0; i < schemes.size(); ++i) {
        Settings settings = settings_for(schemes[i], 64, 1.0);
        settings.error_estimate = true;
        const double law_growth = std::pow(1.0 + 1.0 / static_cast<double>(settings.grid.shape_m), 63.0 / 64.0);
        // The same samples for both schemes: means, which differ from samples at the middle by a second-order term.
        const std::vector<TwinSlice> slices = smooth_column(Integrator::exponential_quadratic, 64, law_growth, 1.0);
        const Output found = accumulate(settings, [&](std::uint32_t, std::uint32_t k) { return slices[k]; });
        const double error = std::abs(static_cast<double>(found.accumulated[0].r) - exact);
        const double estimate = static_cast<double>(found.estimate[0].r);
        std::printf("%-22s error %.2e, estimate %.2e\n", names[i], error, estimate);
        if (schemes[i] == Integrator::exponential_quadratic) {
            EXPECT_GE(estimate, error);
            EXPECT_LE(estimate, 1e-4);
        } else {
            EXPECT_NEAR(estimate / error, 1.0, 0.1) << names[i];
        }
    }
}

TEST_F(IntegratorShader, StaysFiniteAndBoundedAtEdges) {
    for (const Integrator scheme : schemes) {
        const Settings settings = settings_for(scheme, 64, 4.0);
        const Output found = accumulate(settings, [&](std::uint32_t x, std::uint32_t k) {
            // Slabs of every density beside nothing, bright beside dark.
            const double extinction = (k / 3) % 2 == 0 ? std::pow(10.0, 2.0 * x - 8.0) : 0.0;
            return TwinSlice{extinction, extinction * (k % 2 == 0 ? 2.0 : 0.5), 0.0};
        });
        for (std::uint32_t x = 0; x < width; ++x) {
            const glm::vec4& v = found.accumulated[x];
            EXPECT_TRUE(std::isfinite(v.r) && std::isfinite(v.a));
            EXPECT_GE(v.r, 0.0F);
            if (scheme >= Integrator::exponential) {
                EXPECT_LE(v.r, 2.0F * (1.0F + 1e-5F)) << x;
            }
        }
    }
}

} // namespace
} // namespace tyndall::volumetrics::test
