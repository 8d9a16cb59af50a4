// How the feature's compute passes run.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "features/volumetrics/pipelines.hpp"
#include "rendergraph/executor.hpp"

namespace tyndall::volumetrics {

/// A pipeline and the number of groups that cover its domain.
struct Dispatch {
    Program program;
    std::array<std::uint32_t, 3> groups{1, 1, 1};
};

inline Dispatch covering(const Program& program, const GroupShape& group, std::uint32_t x, std::uint32_t y,
                         std::uint32_t z) {
    return {program, {(x + group[0] - 1) / group[0], (y + group[1] - 1) / group[1], (z + group[2] - 1) / group[2]}};
}

inline void run(rg::PassContext& ctx, const Dispatch& dispatch, std::span<const rg::Binding> bindings) {
    ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, dispatch.program.pipeline);
    ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, dispatch.program.layout, 0, bindings, dispatch.program.bindings);
    ctx.vk().CmdDispatch(ctx.cmd(), dispatch.groups[0], dispatch.groups[1], dispatch.groups[2]);
}

} // namespace tyndall::volumetrics
