// Times of passes over many frames.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "rendergraph/executor.hpp"
#include "rendergraph/explain.hpp"

namespace tyndall::samples {

/// The upper of two middle ones; 0 of none.
[[nodiscard]] double median(std::vector<double> values);

/// Collects a frame's timestamps at a time; the same graph is expected in every frame.
class Timings {
public:
    void add_frame(const rg::GraphDesc& graph, std::span<const rg::PassTiming> passes);

    struct Row {
        std::string pass;
        std::uint32_t index = rg::none; ///< in the newest graph
        double median_ms = 0.0;
        std::vector<double> samples_ms;
    };
    /// By pass in order of first appearance, medians filled in.
    [[nodiscard]] std::vector<Row> rows() const;
    /// Sum over the passes of each frame, then the median over the frames.
    [[nodiscard]] double frame_median_ms() const;
    [[nodiscard]] std::size_t frame_count() const { return frames_ms_.size(); }

    [[nodiscard]] std::string table(const std::string& device) const;
    [[nodiscard]] std::string json(const std::string& device) const;

private:
    std::vector<Row> rows_;
    std::vector<double> frames_ms_;
};

} // namespace tyndall::samples
