#include "tests/rendergraph/cpu_reference.hpp"

#include <algorithm>

namespace tyndall::rg::test {

std::uint64_t mixed(std::uint64_t value) { // the finaliser of SplitMix64 (Steele, Lea, Flood 2014)
    value += 0x9e3779b97f4a7c15U;
    value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9U;
    value = (value ^ (value >> 27U)) * 0x94d049bb133111ebU;
    return value ^ (value >> 31U);
}

std::uint64_t written_value(std::uint32_t access, std::uint32_t cell, std::uint64_t old, std::uint64_t inputs) {
    return mixed((std::uint64_t{access} << 32U | cell) ^ mixed(old) ^ mixed(inputs));
}
std::uint64_t first_value(std::uint32_t resource, std::uint32_t cell) {
    return mixed(~(std::uint64_t{resource} << 32U | cell));
}

std::uint32_t cell_count_of(const GraphDesc& graph, const MemoryRequirements& estimate, std::uint32_t resource) {
    const VkDeviceSize bytes = graph.resources[resource].kind == ResourceKind::buffer
                                   ? graph.resources[resource].buffer.size_bytes
                                   : estimate.of_resource[resource].size_bytes;
    return static_cast<std::uint32_t>((bytes + cell_bytes - 1) / cell_bytes);
}

std::vector<std::uint32_t> cells_of(const ResourceDesc& resource, std::uint32_t cell_count, const ImageRange& image,
                                    const BufferRange& buffer) {
    std::vector<std::uint32_t> cells;
    const auto add = [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t cell = begin; cell < end; ++cell) {
            cells.push_back(static_cast<std::uint32_t>(cell));
        }
    };
    if (resource.kind == ResourceKind::buffer) {
        const VkDeviceSize end = buffer.size == whole_buffer ? resource.buffer.size_bytes : buffer.offset + buffer.size;
        add(buffer.offset / cell_bytes, (end + cell_bytes - 1) / cell_bytes);
        return cells;
    }
    const std::uint64_t parts = std::uint64_t{resource.image.mips} * resource.image.layers;
    const std::uint32_t mips =
        image.mip_count == all_remaining ? resource.image.mips - image.base_mip : image.mip_count;
    const std::uint32_t layers =
        image.layer_count == all_remaining ? resource.image.layers - image.base_layer : image.layer_count;
    for (std::uint32_t mip = image.base_mip; mip < image.base_mip + mips; ++mip) {
        for (std::uint32_t layer = image.base_layer; layer < image.base_layer + layers; ++layer) {
            const std::uint64_t part = std::uint64_t{mip} * resource.image.layers + layer;
            add(part * cell_count / parts, (part + 1) * cell_count / parts);
        }
    }
    return cells;
}

Reference::Reference(const GraphDesc& graph, const std::vector<VariantDecision>& forms,
                     const MemoryRequirements& estimate, Values values)
    : graph_(graph), estimate_(estimate), values_(values), inputs_(graph.passes.size(), 0),
      known_(graph.passes.size(), false) {
    for (std::uint32_t r = 0; r < graph.resources.size(); ++r) {
        writers_.emplace_back(cell_count_of(graph, estimate, r));
    }
    std::vector<std::uint32_t> writes;
    for (std::uint32_t i = 0; i < graph.accesses.size(); ++i) {
        const PassDesc& pass = graph.passes[graph.accesses[i].pass];
        const bool exists = pass.variant == none || forms[pass.variant].form == pass.form;
        if (exists && is_write(graph.accesses[i].direction)) {
            writes.push_back(i);
        }
    }
    std::stable_sort(writes.begin(), writes.end(), [&](std::uint32_t a, std::uint32_t b) {
        return graph.accesses[a].version < graph.accesses[b].version;
    });
    for (const std::uint32_t i : writes) {
        const AccessDesc& a = graph.accesses[i];
        std::vector<std::vector<std::uint32_t>>& of = writers_[a.resource];
        for (const std::uint32_t cell : cells_of(graph.resources[a.resource], static_cast<std::uint32_t>(of.size()),
                                                 a.image_range, a.buffer_range)) {
            of[cell].push_back(i);
        }
    }
}

std::uint64_t Reference::value(std::uint32_t resource, std::uint32_t cell, std::uint32_t version) {
    const std::vector<std::uint32_t>& writers = writers_[resource][cell];
    for (auto it = writers.rbegin(); it != writers.rend(); ++it) {
        const AccessDesc& a = graph_.accesses[*it];
        if (a.version <= version) {
            const std::uint64_t old =
                a.direction == Direction::modify ? value(resource, cell, a.version - 1) : std::uint64_t{0};
            return written_value(*it, cell, old, inputs(a.pass));
        }
    }
    return first_value(resource, cell);
}

std::uint64_t Reference::inputs(std::uint32_t pass) {
    if (values_ == Values::own || known_[pass]) {
        return inputs_[pass];
    }
    known_[pass] = true;
    const PassDesc& desc = graph_.passes[pass];
    std::uint64_t sum = 0;
    for (std::uint32_t i = desc.first_access; i < desc.first_access + desc.access_count; ++i) {
        const AccessDesc& a = graph_.accesses[i];
        if (a.direction != Direction::read) {
            continue;
        }
        for (const std::uint32_t cell :
             cells_of(graph_.resources[a.resource], cell_count_of(graph_, estimate_, a.resource), a.image_range,
                      a.buffer_range)) {
            sum += mixed(value(a.resource, cell, a.version));
        }
    }
    return inputs_[pass] = sum;
}

} // namespace tyndall::rg::test
