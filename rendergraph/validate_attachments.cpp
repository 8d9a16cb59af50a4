// Whether the attachments of one pass can be rendered to together.
// In: the declared graph and a pass. Out: the mistakes, at the end of those known. O(accesses of the pass).
#include <algorithm>
#include <iterator>
#include <span>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {
namespace {

/// What is rendered to.
struct Target {
    std::uint32_t width;
    std::uint32_t height;
    std::uint32_t layers;
    std::uint32_t samples;
    friend bool operator==(const Target&, const Target&) = default;
};

std::uint32_t count_of(std::uint32_t base, std::uint32_t count, std::uint32_t all) {
    return count == all_remaining ? all - std::min(base, all) : count;
}

Target target_of(const AccessDesc& access, const ImageDesc& image) {
    const ImageRange& range = access.image_range;
    const auto side = [&](std::uint32_t texels) { return std::max(texels >> std::min(range.base_mip, 31U), 1U); };
    return {side(image.extent.width), side(image.extent.height),
            count_of(range.base_layer, range.layer_count, image.layers), static_cast<std::uint32_t>(image.samples)};
}

std::string text_of(const std::string& name, const Target& target) {
    return "'" + name + "' (" + std::to_string(target.width) + "x" + std::to_string(target.height) + ", " +
           std::to_string(target.layers) + " layers, " + std::to_string(target.samples) + " samples)";
}

/// Each resolve attachment takes the multisampled colour attachment of its own number.
template <typename Bad>
void validate_resolves(const GraphDesc& graph, const PassDesc& pass, const Bad& bad) {
    const auto accesses = std::span(graph.accesses).subspan(pass.first_access, pass.access_count);
    const auto is_source = [&](const AccessDesc& access) {
        return access.access == Access::color_attachment &&
               graph.resources[access.resource].image.samples != VK_SAMPLE_COUNT_1_BIT;
    };
    auto source = std::find_if(accesses.begin(), accesses.end(), is_source);
    for (const AccessDesc& access : accesses) {
        if (access.access != Access::resolve_attachment ||
            graph.resources[access.resource].kind != ResourceKind::image) {
            continue;
        }
        const ResourceDesc& target = graph.resources[access.resource];
        if (source == accesses.end()) {
            bad(access, nullptr,
                "'" + target.name +
                    "' as resolve_attachment, for which no color_attachment with several samples is left; declare "
                    "what is resolved into it");
            continue;
        }
        const ResourceDesc& resolved = graph.resources[source->resource];
        if (resolved.image.format != target.image.format) {
            bad(access, &*source,
                "'" + target.name + "' as resolve_attachment of '" + resolved.name +
                    "', which has another format; make them equal");
        }
        source = std::find_if(std::next(source), accesses.end(), is_source);
    }
}

} // namespace

void validate_attachments(const GraphDesc& graph, const PassDesc& pass, Diagnostics& errors) {
    const AccessDesc* first = nullptr;
    const AccessDesc* first_drawn = nullptr; // whose samples all that is drawn to shares
    const AccessDesc* depth = nullptr;
    bool any_resolves = false;
    const auto bad = [&](const AccessDesc& access, const AccessDesc* other, const std::string& what) {
        const ResourceDesc& resource = graph.resources[access.resource];
        errors.push_back({.code = DiagnosticCode::attachment_mismatch,
                          .pass = pass.name,
                          .resource = resource.name,
                          .message = "Pass '" + pass.name + "' renders to " + what,
                          .where = access.where,
                          .other_where = other != nullptr ? other->where : resource.where});
    };
    for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
        const AccessDesc& access = graph.accesses[i];
        const ResourceDesc& resource = graph.resources[access.resource];
        const bool resolves = access.access == Access::resolve_attachment;
        const bool is_depth = access.access == Access::depth_attachment;
        const bool attachment = resolves || is_depth || access.access == Access::color_attachment;
        if (!attachment || resource.kind != ResourceKind::image) {
            continue; // of a buffer it is an impossible access
        }
        const ImageDesc& image = resource.image;
        if (count_of(access.image_range.base_mip, access.image_range.mip_count, image.mips) > 1) {
            bad(access, nullptr, "several mips of '" + resource.name + "' at once; name one of them");
        }
        const Target target = target_of(access, image);
        if (resolves && target.samples != 1) {
            bad(access, nullptr,
                "'" + resource.name +
                    "' as resolve_attachment, which has several samples itself; "
                    "resolve into an image with one");
        }
        if (is_depth && depth != nullptr) {
            bad(access, depth,
                "two depth attachments, '" + graph.resources[depth->resource].name + "' and '" + resource.name +
                    "'; split the pass");
        }
        depth = is_depth && depth == nullptr ? &access : depth;
        any_resolves = any_resolves || resolves;
        first = first == nullptr ? &access : first;
        first_drawn = first_drawn == nullptr && !resolves ? &access : first_drawn;
        const AccessDesc& compared_with = resolves || first_drawn == &access ? *first : *first_drawn;
        const bool one_resolves = resolves || compared_with.access == Access::resolve_attachment;
        const Target other = target_of(compared_with, graph.resources[compared_with.resource].image);
        Target compared = target;
        compared.samples = one_resolves ? other.samples : target.samples;
        if (compared != other) {
            bad(access, &compared_with,
                text_of(graph.resources[compared_with.resource].name, other) + " and " +
                    text_of(resource.name, target) + "; make them equal");
        }
    }
    if (any_resolves) {
        validate_resolves(graph, pass, bad);
    }
}

} // namespace tyndall::rg::stages
