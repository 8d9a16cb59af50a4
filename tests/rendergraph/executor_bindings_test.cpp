// What a pass pushes is compared with what its shader binds.
#include "tests/rendergraph/executor_fixture.hpp"

namespace tyndall::test {
namespace {

using namespace rg;

class ExecutorBindingsTest : public ExecutorTest {
protected:
    /// What the frame says in which a pass named "odd" declares by `declare` and records by `bind`, which returns what
    /// it pushes for `pipeline`. The frame has two storage buffers, `a_` and `b_`, and an image.
    template <typename Declare, typename Bind>
    std::string reported(const TestPipeline& pipeline, Declare&& declare, Bind&& bind) {
        GraphBuilder graph;
        a_ = graph.create_buffer("a", {.size_bytes = 256});
        b_ = graph.create_buffer("b", {.size_bytes = 256});
        image_ = graph.create_image("image", image_of(8, 8));
        add_fill(graph, "fill a", a_, 1);
        add_fill(graph, "fill b", b_, 2);
        add_pattern(graph, "pattern", image_, {8, 8}, {});
        PassBuilder pass = graph.add_pass("odd", PassKind::compute);
        declare(pass);
        pass.has_side_effect("is looked at").executes([&](PassContext& ctx) {
            ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.pipeline);
            ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.layout, 0, bind(ctx), pipeline.bindings);
            if (lost_) { // validation must not see a dispatch without bindings
                ctx.vk().CmdDispatch(ctx.cmd(), 1, 1, 1);
            }
        });
        const DeclaredGraph declared = graph.finish();
        const auto error = execute(declared, compile(declared.desc), {});
        if (!error) {
            return "";
        }
        EXPECT_EQ(error->kind, ExecuteError::Kind::undeclared_access);
        return error->message;
    }

    Buffer a_, b_;
    Image image_;
    bool lost_ = true; ///< the frame, by the push
};

TEST_F(ExecutorBindingsTest, ABindingThatNobodyPushes) {
    EXPECT_EQ(reported(
                  affine_, [&](PassBuilder& pass) { pass.reads(a_, Access::storage_compute); },
                  [&](PassContext& ctx) { return std::array{ctx.storage(0, a_)}; }),
              "Pass 'odd' uses a storage buffer at binding 1 of set 0 in its shader, but pushes none");
}

TEST_F(ExecutorBindingsTest, ADescriptorOfAnotherType) {
    EXPECT_EQ(
        reported(
            accumulate_,
            [&](PassBuilder& pass) { pass.reads(a_, Access::storage_compute).writes(image_, Access::storage_compute); },
            [&](PassContext& ctx) {
                return std::array{ctx.storage(0, a_), ctx.storage(1, image_)};
            }),
        "Pass 'odd' uses 'a' at binding 0 of set 0 as a storage buffer, but its shader has a combined image "
        "sampler there");
}

TEST_F(ExecutorBindingsTest, AShaderThatMayWriteWhatIsOnlyRead) {
    EXPECT_EQ(
        reported(
            affine_,
            [&](PassBuilder& pass) { pass.reads(a_, Access::storage_compute).reads(b_, Access::storage_compute); },
            [&](PassContext& ctx) {
                return std::array{ctx.storage(0, a_), ctx.storage(1, b_)};
            }),
        "Pass 'odd' uses 'b' at binding 1 of set 0 in a shader that may write it, but declared that it only "
        "reads it");
    EXPECT_EQ(reported(
                  pattern_, [&](PassBuilder& pass) { pass.reads(image_, Access::storage_compute); },
                  [&](PassContext& ctx) { return std::array{ctx.storage(0, image_)}; }),
              "Pass 'odd' uses 'image' at binding 0 of set 0 in a shader that may write it, but declared that it only "
              "reads it");
}

TEST_F(ExecutorBindingsTest, AShaderThatMayReadWhatIsOnlyWritten) {
    EXPECT_EQ(
        reported(
            affine_,
            [&](PassBuilder& pass) { pass.writes(a_, Access::storage_compute).writes(b_, Access::storage_compute); },
            [&](PassContext& ctx) {
                return std::array{ctx.storage(0, a_), ctx.storage(1, b_)};
            }),
        "Pass 'odd' uses 'a' at binding 0 of set 0 in a shader that may read it, but declared that it only "
        "writes it");
}

TEST_F(ExecutorBindingsTest, WhatIsModifiedMayBeReadAndWritten) {
    lost_ = false;
    EXPECT_EQ(reported(
                  affine_, [&](PassBuilder& pass) { pass.modifies(a_, Access::storage_compute); },
                  [&](PassContext& ctx) {
                      return std::array{ctx.storage(0, a_), ctx.storage(1, a_)};
                  }),
              "");
}

TEST_F(ExecutorBindingsTest, AreComparedOnlyWhenAskedForOrInADebugBuild) {
    ExecutorInfo info = executor_info();
    info.check_bindings = false;
    lost_ = checks_bindings(false);
    make_executor(std::move(info));
    const std::string said = reported(
        affine_, [&](PassBuilder& pass) { pass.reads(a_, Access::storage_compute); },
        [&](PassContext& ctx) { return std::array{ctx.storage(0, a_)}; });
    EXPECT_EQ(said.empty(), !lost_);
    EXPECT_TRUE(checks_bindings(true));
}

} // namespace
} // namespace tyndall::test
