#include "rendergraph/verify_order.hpp"

#include <algorithm>

namespace tyndall::rg::checker {
namespace {

struct StageNumber {
    VkPipelineStageFlags2 mask;
    StageSet stages;
};
constexpr VkPipelineStageFlags2 before_rasterization =
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_TESSELLATION_CONTROL_SHADER_BIT |
    VK_PIPELINE_STAGE_2_TESSELLATION_EVALUATION_SHADER_BIT | VK_PIPELINE_STAGE_2_GEOMETRY_SHADER_BIT |
    VK_PIPELINE_STAGE_2_TASK_SHADER_BIT_EXT | VK_PIPELINE_STAGE_2_MESH_SHADER_BIT_EXT;
constexpr StageSet transfers = 0b1111U << 9U;
constexpr std::array stage_numbers = {
    StageNumber{VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, 1U << 0U},
    StageNumber{VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, 1U << 1U},
    StageNumber{VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT, 1U << 2U},
    StageNumber{VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT, 0b11U << 1U},
    StageNumber{before_rasterization, 1U << 3U},
    StageNumber{VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT, 1U << 3U},
    StageNumber{VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, 1U << 4U},
    StageNumber{VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT, 1U << 5U},
    StageNumber{VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT, 1U << 6U},
    StageNumber{VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, 1U << 7U},
    StageNumber{VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT, (1U << 8U) - 1},
    StageNumber{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, 1U << 8U},
    StageNumber{VK_PIPELINE_STAGE_2_COPY_BIT, 1U << 9U},
    StageNumber{VK_PIPELINE_STAGE_2_BLIT_BIT, 1U << 10U},
    StageNumber{VK_PIPELINE_STAGE_2_RESOLVE_BIT, 1U << 11U},
    StageNumber{VK_PIPELINE_STAGE_2_CLEAR_BIT, 1U << 12U},
    StageNumber{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, transfers},
    StageNumber{VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR, 1U << 13U},
    StageNumber{VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR, 1U << 14U},
    StageNumber{VK_PIPELINE_STAGE_2_HOST_BIT, host_stage},
    StageNumber{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, every_stage & ~host_stage},
};

constexpr StageSet all_others = 1U << 16U;

/// The stages of each bit of a mask.
constexpr std::array<StageSet, 64> stages_of_bit = [] {
    std::array<StageSet, 64> out = {};
    for (std::size_t bit = 0; bit < out.size(); ++bit) {
        for (const StageNumber& number : stage_numbers) {
            out[bit] |= (number.mask >> bit & 1U) != 0 ? number.stages : 0;
        }
        out[bit] = out[bit] != 0 ? out[bit] : all_others;
    }
    return out;
}();

StageSet numbered(VkPipelineStageFlags2 mask) {
    StageSet out = 0;
    for (; mask != 0; mask &= mask - 1) {
        out |= stages_of_bit[static_cast<std::size_t>(std::countr_zero(mask))];
    }
    return out;
}

void raise(std::uint32_t* to, const std::uint32_t* from, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        to[i] = std::max(to[i], from[i]);
    }
}

} // namespace

StageSet source_stages(VkPipelineStageFlags2 mask) {
    const bool bottom = (mask & VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT) != 0;
    mask &= ~(VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT | VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT);
    return numbered(bottom ? mask | all_commands : mask);
}

StageSet destination_stages(VkPipelineStageFlags2 mask) {
    const bool top = (mask & VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT) != 0;
    mask &= ~(VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT | VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT);
    return numbered(top ? mask | all_commands : mask);
}

bool covers(const std::uint32_t* clock, const Point& point) {
    const std::uint32_t* of_queue = clock + std::size_t{point.queue} * stage_count;
    bool all = true;
    bool any = false;
    for_each_stage(point.by_barrier ? point.stages | end_of_submission : point.stages, [&](std::uint32_t stage) {
        const bool reached = of_queue[stage] >= point.sequence;
        all = all && reached;
        any = any || reached;
    });
    return point.by_barrier ? any : all;
}

Order::Order(std::uint32_t queues)
    : queues_(queues), width_(std::size_t{queues + 1} * stage_count), sequence_(queues + 1, 0) {
    const std::size_t all = std::size_t{queues} * stage_count * width_;
    ordered_.assign(all, 0);
    available_.assign(all, 0);
    visible_.assign(all, 0);
}

void Order::source_scope(std::uint32_t queue, StageSet stages, SourceScope& out) const {
    out.ordered.assign(width_, 0);
    out.available.assign(width_, 0);
    for_each_stage(stages, [&](std::uint32_t stage) {
        raise(out.ordered.data(), ordered_.data() + row(queue, stage), width_);
        raise(out.available.data(), available_.data() + row(queue, stage), width_);
    });
    for_each_stage(stages, [&](std::uint32_t stage) { // submission order, up to the command before this one
        out.ordered[std::size_t{queue} * stage_count + stage] = sequence_[queue] - 1;
        if (host_comes_before(queue, stage)) {
            out.ordered[std::size_t{host_queue()} * stage_count + stage] = sequence_[host_queue()];
        }
    });
}

void Order::add_barrier(std::uint32_t queue, StageSet stages, const SourceScope& source) {
    for_each_stage(stages, [&](std::uint32_t stage) {
        raise(ordered_.data() + row(queue, stage), source.ordered.data(), width_);
        raise(available_.data() + row(queue, stage), source.available.data(), width_);
    });
}

Clock Order::signal(std::uint32_t queue) const {
    Clock out(width_, 0);
    for (std::uint32_t stage = 0; stage < stage_count; ++stage) {
        raise(out.data(), ordered_.data() + row(queue, stage), width_);
    }
    for (std::uint32_t stage = 0; stage < stage_count; ++stage) {
        out[std::size_t{queue} * stage_count + stage] = sequence_[queue];
        if (host_comes_before(queue, stage)) {
            out[std::size_t{host_queue()} * stage_count + stage] = sequence_[host_queue()];
        }
    }
    return out;
}

void Order::wait(std::uint32_t queue, StageSet stages, const Clock& signalled) {
    for_each_stage(stages, [&](std::uint32_t stage) {
        for (Clock* clock : {&ordered_, &available_, &visible_}) {
            raise(clock->data() + row(queue, stage), signalled.data(), width_);
        }
    });
}

void Order::join() {
    Clock now(width_, 0);
    for (std::uint32_t queue = 0; queue <= queues_; ++queue) {
        std::fill_n(now.data() + std::size_t{queue} * stage_count, stage_count, sequence_[queue]);
    }
    for (std::uint32_t queue = 0; queue < queues_; ++queue) {
        wait(queue, every_stage, now);
    }
}

bool Order::after(const Point& point, std::uint32_t queue, StageSet stages) const {
    bool all = true;
    for_each_stage(stages, [&](std::uint32_t stage) {
        const bool behind_the_barrier = point.by_barrier && point.queue == queue && (point.stages >> stage & 1U) != 0;
        all = all && (behind_the_barrier || covers(ordered_.data() + row(queue, stage), point));
    });
    return all;
}

bool Order::available(const Point& point, std::uint32_t queue, StageSet stage) const {
    bool all = true;
    for_each_stage(stage, [&](std::uint32_t s) { all = all && covers(available_.data() + row(queue, s), point); });
    return all;
}

bool Order::visible(const Point& point, std::uint32_t queue, StageSet stage) const {
    bool all = true;
    for_each_stage(stage, [&](std::uint32_t s) { all = all && covers(visible_.data() + row(queue, s), point); });
    return all;
}

} // namespace tyndall::rg::checker
