// Cutting resources into the smallest parts that their accesses tell apart.
// In: ranges inside their resources. Out: cells per resource, a cell range per access. Invariant: two accesses touch a
// common byte exactly when their cell ranges intersect. O(accesses log accesses).
#include <algorithm>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {
namespace {

CellRange image_cells(const ResourceDesc& resource, const ImageRange& range) {
    CellRange cells;
    cells.first_mip = range.base_mip;
    cells.mip_count = range.mip_count == all_remaining ? resource.image.mips - range.base_mip : range.mip_count;
    cells.first_layer = range.base_layer;
    cells.layer_count =
        range.layer_count == all_remaining ? resource.image.layers - range.base_layer : range.layer_count;
    return cells;
}

VkDeviceSize end_of(const ResourceDesc& resource, const BufferRange& range) {
    return range.size == whole_buffer ? resource.buffer.size_bytes : range.offset + range.size;
}

} // namespace

Scratch<CellRange> as_rectangles(const ResourceCells& resource, std::span<const std::uint32_t> cells) {
    Scratch<CellRange> runs;
    for (const std::uint32_t cell : cells) {
        const std::uint32_t mip = cell / resource.layers;
        const std::uint32_t layer = cell % resource.layers;
        CellRange* last = runs.empty() ? nullptr : &runs.back();
        if (last != nullptr && last->first_mip == mip && last->first_layer + last->layer_count == layer) {
            ++last->layer_count;
        } else {
            runs.push_back({mip, 1, layer, 1});
        }
    }
    Scratch<CellRange> merged;
    for (const CellRange& run : runs) {
        const auto above = std::find_if(merged.begin(), merged.end(), [&](const CellRange& other) {
            return other.first_mip + other.mip_count == run.first_mip && other.first_layer == run.first_layer &&
                   other.layer_count == run.layer_count;
        });
        if (above != merged.end()) {
            ++above->mip_count;
        } else {
            merged.push_back(run);
        }
    }
    return merged;
}

Cells cut_into_cells(const GraphDesc& graph) {
    Cells cells;
    cells.of_resource.resize(graph.resources.size());
    cells.of_access.resize(graph.accesses.size());
    for (std::size_t i = 0; i < graph.resources.size(); ++i) {
        const ResourceDesc& resource = graph.resources[i];
        ResourceCells& out = cells.of_resource[i];
        out.mips = resource.kind == ResourceKind::image ? resource.image.mips : 1;
        out.layers = resource.kind == ResourceKind::image ? resource.image.layers : 1;
    }
    for (const AccessDesc& access : graph.accesses) {
        const ResourceDesc& resource = graph.resources[access.resource];
        ResourceCells& out = cells.of_resource[access.resource];
        if (resource.kind == ResourceKind::image) {
            const CellRange range = image_cells(resource, access.image_range);
            out.whole = out.whole && range.mip_count == out.mips && range.layer_count == out.layers;
        } else {
            const VkDeviceSize end = end_of(resource, access.buffer_range);
            out.whole = out.whole && access.buffer_range.offset == 0 && end == resource.buffer.size_bytes;
            out.boundaries.push_back(access.buffer_range.offset);
            out.boundaries.push_back(end);
        }
    }
    for (std::size_t i = 0; i < graph.resources.size(); ++i) {
        ResourceCells& out = cells.of_resource[i];
        if (graph.resources[i].kind == ResourceKind::buffer && !out.whole) {
            out.boundaries.push_back(0);
            out.boundaries.push_back(graph.resources[i].buffer.size_bytes);
            std::sort(out.boundaries.begin(), out.boundaries.end());
            out.boundaries.erase(std::unique(out.boundaries.begin(), out.boundaries.end()), out.boundaries.end());
            out.layers = static_cast<std::uint32_t>(out.boundaries.size() - 1);
        } else {
            out.boundaries.clear();
        }
    }
    for (std::size_t i = 0; i < graph.accesses.size(); ++i) {
        const AccessDesc& access = graph.accesses[i];
        const ResourceDesc& resource = graph.resources[access.resource];
        const ResourceCells& of = cells.of_resource[access.resource];
        if (resource.kind == ResourceKind::image) {
            cells.of_access[i] = image_cells(resource, access.image_range);
        } else if (!of.whole) {
            const auto at = [&](VkDeviceSize offset) {
                return static_cast<std::uint32_t>(std::lower_bound(of.boundaries.begin(), of.boundaries.end(), offset) -
                                                  of.boundaries.begin());
            };
            const std::uint32_t first = at(access.buffer_range.offset);
            const std::uint32_t last = at(end_of(resource, access.buffer_range));
            cells.of_access[i] = {.first_layer = first, .layer_count = last - first};
        }
    }
    return cells;
}

} // namespace tyndall::rg::stages
