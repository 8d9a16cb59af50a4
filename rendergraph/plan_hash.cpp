#include "rendergraph/plan_hash.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>

namespace tyndall::rg {
namespace {

__extension__ using Wide = unsigned __int128;

std::uint64_t multiply_and_fold(std::uint64_t a, std::uint64_t b) {
    const Wide product = Wide{a} * b;
    return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64U);
}

constexpr std::uint64_t pair(std::uint32_t low, std::uint32_t high) {
    return low | std::uint64_t{high} << 32U;
}

/// Two independent lanes, each of which takes in every word.
class Hasher {
public:
    void add(std::uint64_t a, std::uint64_t b) {
        low_ = multiply_and_fold(a ^ secret[0], b ^ low_);
        high_ = multiply_and_fold(b ^ secret[1], a ^ high_);
    }
    /// The length goes in too, so that neighbouring texts cannot trade characters.
    void add(std::string_view text) {
        std::uint64_t words[2] = {text.size(), 0};
        std::size_t at = std::min<std::size_t>(text.size(), sizeof(std::uint64_t));
        copy(words[1], text, 0, at);
        add(words[0], words[1]);
        for (; at < text.size(); at += sizeof(words)) {
            words[0] = words[1] = 0;
            copy(words[0], text, at, 8);
            copy(words[1], text, at + 8, 8);
            add(words[0], words[1]);
        }
    }
    [[nodiscard]] PlanHash result() const {
        return {multiply_and_fold(low_ ^ secret[2], high_ ^ secret[3]),
                multiply_and_fold(high_ ^ secret[0], low_ ^ secret[1])};
    }

private:
    static void copy(std::uint64_t& word, std::string_view text, std::size_t at, std::size_t count) {
        if (at < text.size()) {
            std::memcpy(&word, text.data() + at, std::min(count, text.size() - at));
        }
    }
    static constexpr std::uint64_t secret[4] = {0xa0761d6478bd642f, 0xe7037ed1a0b428db, 0x8ebc6af09c88c6e3,
                                                0x589965cc75374cc3}; // wyhash's
    std::uint64_t low_ = secret[2];
    std::uint64_t high_ = secret[3];
};

// Each struct is taken apart by structured bindings, so that a new member does not compile until it is dealt with here.

void add(Hasher& hash, const ImageRange& range) {
    const auto& [base_mip, mip_count, base_layer, layer_count, aspects] = range;
    hash.add(pair(base_mip, mip_count), pair(base_layer, layer_count));
    hash.add(aspects, 0);
}

void add(Hasher& hash, const ResourceDesc& resource) {
    const auto& [name, kind, lifetime, concurrent, has_history, image, buffer, import, history_of, where] = resource;
    hash.add(name);
    const std::uint32_t bits = static_cast<std::uint32_t>(kind) | static_cast<std::uint32_t>(lifetime) << 8U |
                               static_cast<std::uint32_t>(concurrent) << 16U |
                               static_cast<std::uint32_t>(has_history) << 24U;
    hash.add(pair(import, history_of), bits);
    if (kind == ResourceKind::buffer) {
        const auto& [size_bytes, extra_usage] = buffer;
        hash.add(size_bytes, extra_usage);
        return;
    }
    const auto& [format, extent, mips, layers, type, samples, flags, extra_usage] = image;
    hash.add(pair(static_cast<std::uint32_t>(format), extent.width), pair(extent.height, extent.depth));
    hash.add(pair(mips, layers), pair(static_cast<std::uint32_t>(type), static_cast<std::uint32_t>(samples)));
    hash.add(flags, extra_usage);
}

void add(Hasher& hash, const PassDesc& pass) {
    const auto& [name, kind, wish, forbidden_queues, variant, form, has_side_effect, side_effect, first_access,
                 access_count, point, where] = pass;
    hash.add(name);
    const std::uint32_t bits = static_cast<std::uint32_t>(kind) | static_cast<std::uint32_t>(wish) << 8U |
                               static_cast<std::uint32_t>(forbidden_queues) << 16U |
                               static_cast<std::uint32_t>(has_side_effect) << 24U;
    hash.add(pair(bits, point), pair(variant, form));
    hash.add(first_access, access_count);
    if (has_side_effect) {
        hash.add(side_effect);
    }
}

void add(Hasher& hash, const AccessDesc& access, bool of_image) {
    const auto& [pass, resource, version, kind, direction, clears, clear, image_range, buffer_range, where] = access;
    const bool whole = of_image ? image_range == ImageRange{} : buffer_range == BufferRange{}; // as most are
    const std::uint32_t bits = static_cast<std::uint32_t>(kind) | static_cast<std::uint32_t>(direction) << 16U |
                               static_cast<std::uint32_t>(clears) << 24U | static_cast<std::uint32_t>(whole) << 25U;
    hash.add(pair(pass, resource), pair(version, bits));
    if (clears) {
        hash.add(pair(clear.color.uint32[0], clear.color.uint32[1]),
                 pair(clear.color.uint32[2], clear.color.uint32[3]));
    }
    if (whole) {
        return;
    }
    if (of_image) {
        add(hash, image_range);
    } else {
        hash.add(buffer_range.offset, buffer_range.size);
    }
}

void add(Hasher& hash, const ImportDesc& import) {
    const auto& [initial_layout, initial_stages, initial_access, initial_family, waits_semaphore, has_final,
                 final_layout, final_stages, final_access, final_family, signals_semaphore, read_only] = import;
    hash.add(initial_stages, initial_access);
    hash.add(final_stages, final_access);
    hash.add(pair(static_cast<std::uint32_t>(initial_layout), static_cast<std::uint32_t>(final_layout)),
             pair(initial_family, final_family));
    hash.add(
        (waits_semaphore ? 1U : 0U) | (has_final ? 2U : 0U) | (signals_semaphore ? 4U : 0U) | (read_only ? 8U : 0U), 0);
}

void add(Hasher& hash, const VariantDesc& variant) {
    const auto& [name, forms, where] = variant;
    hash.add(name);
    hash.add(forms.size(), 0);
    for (const std::string& form : forms) {
        hash.add(form);
    }
}

void add(Hasher& hash, const GraphDesc& graph) {
    const auto& [resources, passes, accesses, imports, points, variants, declaration_errors] = graph;
    hash.add(pair(static_cast<std::uint32_t>(resources.size()), static_cast<std::uint32_t>(passes.size())),
             pair(static_cast<std::uint32_t>(accesses.size()), static_cast<std::uint32_t>(imports.size())));
    hash.add(points.size(), variants.size());
    for (const ResourceDesc& resource : resources) {
        add(hash, resource);
    }
    for (const PassDesc& pass : passes) {
        add(hash, pass);
    }
    for (const AccessDesc& access : accesses) {
        add(hash, access, resources[access.resource].kind == ResourceKind::image);
    }
    for (const ImportDesc& import : imports) {
        add(hash, import);
    }
    for (const std::string& point : points) {
        hash.add(point);
    }
    for (const VariantDesc& variant : variants) {
        add(hash, variant);
    }
}

void add(Hasher& hash, const QueueTopology& topology) {
    hash.add(topology.queues.size(), 0);
    for (const auto& [kind, family, capabilities] : topology.queues) {
        hash.add(family, pair(static_cast<std::uint32_t>(kind), capabilities));
    }
}

void add(Hasher& hash, const MemoryRequirements& memory) {
    const auto& [of_resource, buffer_image_granularity] = memory;
    hash.add(of_resource.size(), buffer_image_granularity);
    for (const auto& [size_bytes, alignment, memory_type_bits] : of_resource) {
        hash.add(size_bytes, pair(memory_type_bits, static_cast<std::uint32_t>(std::countr_zero(alignment))));
    }
}

void add(Hasher& hash, const CompileOptions& options) {
    const auto& [culling, aliasing, async, reordering, full_barriers, effort] = options;
    hash.add((culling ? 1U : 0U) | (aliasing ? 2U : 0U) | (async ? 4U : 0U) | (reordering ? 8U : 0U) |
                 (full_barriers ? 16U : 0U),
             static_cast<std::uint32_t>(effort));
}

void add(Hasher& hash, const Costs& costs) {
    const auto& [of_pass, unknown_pass_ns, cross_queue_ns, slowdown_permille, threshold_ns, threshold_permille] = costs;
    const auto word = [](std::int64_t value) { return static_cast<std::uint64_t>(value); };
    hash.add(of_pass.size(), word(unknown_pass_ns));
    hash.add(word(cross_queue_ns), word(slowdown_permille));
    hash.add(word(threshold_ns), word(threshold_permille));
    for (const auto& [mean_ns, deviation_ns] : of_pass) {
        hash.add(word(mean_ns), word(deviation_ns));
    }
}

} // namespace

PlanHash hash_of_inputs(const GraphDesc& graph, const QueueTopology& topology, const MemoryRequirements& memory,
                        const CompileOptions& options, const Costs& costs) {
    Hasher hash;
    add(hash, graph);
    add(hash, topology);
    add(hash, memory);
    add(hash, options);
    add(hash, costs);
    return hash.result();
}

} // namespace tyndall::rg
