// What every read of a frame must find: the graph interpreted serially, version by version, without a plan. And the
// cells that stand for a resource's bytes.
#pragma once

#include <cstdint>
#include <vector>

#include "rendergraph/plan.hpp"
#include "tests/rendergraph/cpu_executor.hpp"

namespace tyndall::rg::test {

inline constexpr VkDeviceSize cell_bytes = 64;

/// The cells of a resource that an access or dependency covers: of a buffer its bytes, of an image equal shares for
/// each subresource. Ascending, without doubles.
[[nodiscard]] std::vector<std::uint32_t> cells_of(const ResourceDesc& resource, std::uint32_t cell_count,
                                                  const ImageRange& image, const BufferRange& buffer);
[[nodiscard]] std::uint32_t cell_count_of(const GraphDesc& graph, const MemoryRequirements& estimate,
                                          std::uint32_t resource);

/// What one write leaves in a cell. `old`: what it modifies, 0 where it replaces; `inputs`: Reference::inputs.
[[nodiscard]] std::uint64_t written_value(std::uint32_t access, std::uint32_t cell, std::uint64_t old,
                                          std::uint64_t inputs);
/// What an import or a history holds when the frame begins.
[[nodiscard]] std::uint64_t first_value(std::uint32_t resource, std::uint32_t cell);
/// Order does not matter in it, so that reads may come in any.
[[nodiscard]] std::uint64_t mixed(std::uint64_t value);

class Reference {
public:
    /// Of the plan it knows the forms that are kept, and nothing else.
    Reference(const GraphDesc& graph, const std::vector<VariantDecision>& forms, const MemoryRequirements& estimate,
              Values values);

    /// Content of the cell after the write that made `version`, or the last one before; also of culled passes.
    [[nodiscard]] std::uint64_t value(std::uint32_t resource, std::uint32_t cell, std::uint32_t version);
    /// What a pass' writes are mixed with.
    [[nodiscard]] std::uint64_t inputs(std::uint32_t pass);

private:
    const GraphDesc& graph_;
    const MemoryRequirements& estimate_;
    Values values_;
    std::vector<std::vector<std::vector<std::uint32_t>>> writers_; ///< accesses by resource and cell, by version
    std::vector<std::uint64_t> inputs_;                            ///< by pass
    std::vector<bool> known_;                                      ///< by pass
};

} // namespace tyndall::rg::test
