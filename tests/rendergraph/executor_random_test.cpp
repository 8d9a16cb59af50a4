// Random frames on a driver: numbers against a CPU's, and every transition under the eyes of the validation layer.
#include <random>

#include "rendergraph/verify.hpp"
#include "tests/rendergraph/executor_fixture.hpp"
#include "tests/rendergraph/random_graph.hpp"

namespace tyndall::test {
namespace {

using namespace rg;

constexpr std::uint32_t numbers = 128;
constexpr std::uint32_t buffers = 6;

/// With and without poisoned transients: the same numbers, and no more validation errors.
class RandomFrames : public ExecutorTest, public testing::WithParamInterface<bool> {
protected:
    void SetUp() override {
        ExecutorTest::SetUp();
        ExecutorInfo info = executor_info();
        info.poison_transients = GetParam();
        make_executor(std::move(info));
    }

    /// Passes that compute on transient buffers, some on async compute, all of them read back at the end. Returns what
    /// must come out.
    std::vector<std::uint32_t> declare(GraphBuilder& graph, std::uint32_t seed) {
        std::mt19937 bits(seed);
        const auto below = [&bits](std::uint32_t limit) { return static_cast<std::uint32_t>(bits() % limit); };
        std::vector<Buffer> handles;
        std::vector<std::uint32_t> expected;
        for (std::uint32_t i = 0; i < buffers; ++i) {
            handles.push_back(graph.create_buffer("b" + std::to_string(i), {.size_bytes = numbers * 4}));
            expected.push_back(below(100));
            add_fill(graph, "fill " + std::to_string(i), handles.back(), expected.back());
        }
        const std::uint32_t passes = 4 + below(16);
        for (std::uint32_t pass = 0; pass < passes; ++pass) {
            const std::uint32_t from = below(buffers);
            const std::uint32_t to = (from + 1 + below(buffers - 1)) % buffers;
            const std::uint32_t scale = 1 + below(3);
            PassBuilder builder =
                add_affine(graph, "p" + std::to_string(pass), handles[from], handles[to], scale, pass, numbers);
            if (below(2) == 0) {
                builder.on_queue(QueueWish::async_compute);
            }
            expected[to] = expected[from] * scale + pass;
        }
        for (std::uint32_t i = 0; i < buffers; ++i) {
            Buffer out = import_read_back(graph, "out " + std::to_string(i), results_[i]);
            add_affine(graph, "copy " + std::to_string(i), handles[i], out, 1, 0, numbers);
        }
        return expected;
    }
    std::vector<HostBuffer> results_;
};

TEST_P(RandomFrames, GiveTheNumbersThatTheCpuGives) {
    for (std::uint32_t i = 0; i < buffers; ++i) {
        results_.push_back(read_back_buffer(numbers * 4));
    }
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        GraphBuilder graph;
        const std::vector<std::uint32_t> expected = declare(graph, seed);
        run_bound(graph.finish());
        for (std::uint32_t i = 0; i < buffers; ++i) {
            for (const std::uint32_t value : results_[i].as<std::uint32_t>()) {
                ASSERT_EQ(value, expected[i]) << "buffer " << i;
            }
        }
        const std::vector<std::string> errors = take_errors();
        ASSERT_TRUE(errors.empty()) << errors.front();
    }
}

TEST_P(RandomFrames, OfEveryTopologyFoldWithoutAValidationError) {
    constexpr VkImageUsageFlags any_image = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                            VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    std::vector<HostImage> images;
    std::vector<HostBuffer> host_buffers;
    for (std::uint32_t i = 0; i < 12; ++i) {
        images.push_back(host_image(rg::test::color_image(16, 16), any_image));
        host_buffers.push_back(read_back_buffer(512));
    }
    for (std::uint32_t seed = 0; seed < 120; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const DeclaredGraph declared = rg::test::random_frame(seed);
        const auto plan =
            rg::compile(declared.desc, rg::test::random_topology(seed), executor().memory_requirements(declared.desc));
        ASSERT_TRUE(plan.has_value()) << to_text(plan.error());
        std::vector<ImportBinding> imports;
        for (std::uint32_t resource = 0; resource < declared.desc.resources.size(); ++resource) {
            if (declared.desc.resources[resource].lifetime == ResourceLifetime::imported) {
                imports.push_back({.resource = resource,
                                   .image = images[imports.size()].image,
                                   .buffer = host_buffers[imports.size()].buffer});
            }
        }
        for (int frame = 0; frame < 3; ++frame) {
            const auto error = execute(declared, *plan, imports);
            ASSERT_FALSE(error.has_value()) << error->message;
        }
        const std::vector<std::string> errors = take_errors();
        ASSERT_TRUE(errors.empty()) << errors.front();
    }
}

INSTANTIATE_TEST_SUITE_P(, RandomFrames, testing::Bool(),
                         [](const auto& test) { return test.param ? "Poisoned" : "Plain"; });

} // namespace
} // namespace tyndall::test
