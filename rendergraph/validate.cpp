// Everything that can be said of single resources, passes and accesses, in the words of the one who declared them.
// In: the declared graph. Out: all mistakes together. Invariant: what passes can be cut into cells and scheduled.
// O(accesses + accesses of each pass squared).
#include <algorithm>
#include <bit>
#include <functional>
#include <string_view>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {
namespace {

std::string quoted(const std::string& name) {
    return "'" + name + "'";
}

std::string_view verb(Direction direction) {
    switch (direction) {
    case Direction::read: return "reads";
    case Direction::replace: return "writes";
    case Direction::modify: return "modifies";
    }
    return "";
}

/// Calls `f(item, first)` for every item that has the name of an earlier one, `first` being the first of that name.
/// A hash table with linear probing, at most half full. O(items).
template <typename T, typename F>
void for_each_repeated(const std::vector<T>& items, F&& f) {
    const std::size_t mask = std::bit_ceil(2 * items.size() + 1) - 1;
    Scratch<std::uint32_t> table(mask + 1, none);
    for (std::uint32_t i = 0; i < items.size(); ++i) {
        std::size_t at = std::hash<std::string_view>{}(items[i].name) & mask;
        while (table[at] != none && items[table[at]].name != items[i].name) {
            at = (at + 1) & mask;
        }
        if (table[at] == none) {
            table[at] = i;
        } else {
            f(items[i], items[table[at]]);
        }
    }
}

class Validator {
public:
    Validator(const GraphDesc& graph, const QueueTopology& topology) : graph_(graph), topology_(topology) {}

    Diagnostics run() {
        if (topology_.queues.empty() || topology_.queues[0].kind != QueueKind::graphics) {
            errors_.push_back(
                {.code = DiagnosticCode::no_queue, .message = "The queue topology must begin with a graphics queue"});
        }
        queues();
        names();
        for (const ResourceDesc& resource : graph_.resources) {
            description(resource);
        }
        for (const VariantDesc& variant : graph_.variants) {
            if (variant.forms.empty()) {
                errors_.push_back({.code = DiagnosticCode::bad_description,
                                   .message = "Variant " + quoted(variant.name) + " has no form; give it at least one",
                                   .where = variant.where,
                                   .other_where = variant.where});
            }
        }
        for (std::uint32_t i = 0; i < graph_.passes.size(); ++i) {
            pass(graph_.passes[i]);
        }
        imports();
        return std::move(errors_);
    }

private:
    /// A kind of queue promises what its passes are made of.
    void queues() {
        for (std::size_t i = 0; i < topology_.queues.size(); ++i) {
            const QueueInfo& queue = topology_.queues[i];
            const std::uint8_t promised = queue.kind == QueueKind::graphics  ? can_graphics | can_compute
                                          : queue.kind == QueueKind::compute ? can_compute
                                                                             : can_transfer;
            if ((queue.capabilities & promised) != promised) {
                errors_.push_back({.code = DiagnosticCode::no_queue,
                                   .message = "Queue " + std::to_string(i) + " is a " +
                                              std::string(name_of(queue.kind)) + " queue that cannot do " +
                                              (queue.kind == QueueKind::graphics ? "both graphics and compute"
                                                                                 : std::string(name_of(queue.kind))) +
                                              "; let it, or plan without it"});
            }
        }
    }

    /// Empty names, and names of two.
    void names() {
        const auto nameless = [&](const auto& items, const char* kind) {
            for (std::size_t i = 0; i < items.size(); ++i) {
                if (items[i].name.empty()) {
                    errors_.push_back(
                        {.code = DiagnosticCode::bad_description,
                         .message = std::string(kind) + " " + std::to_string(i) + " has an empty name; give it one",
                         .where = items[i].where,
                         .other_where = items[i].where});
                }
            }
        };
        nameless(graph_.resources, "Resource");
        nameless(graph_.passes, "Pass");
        nameless(graph_.variants, "Variant");
        for_each_repeated(graph_.variants, [&](const VariantDesc& variant, const VariantDesc& first) {
            errors_.push_back({.code = DiagnosticCode::duplicate_name,
                               .message = "Two variants are called " + quoted(variant.name) + "; rename one",
                               .where = variant.where,
                               .other_where = first.where});
        });
        for (const VariantDesc& variant : graph_.variants) {
            for (auto form = variant.forms.begin(); form != variant.forms.end(); ++form) {
                if (std::find(variant.forms.begin(), form, *form) != form) {
                    errors_.push_back({.code = DiagnosticCode::duplicate_name,
                                       .message = "Two forms of variant " + quoted(variant.name) + " are called " +
                                                  quoted(*form) + "; rename one",
                                       .where = variant.where,
                                       .other_where = variant.where});
                }
            }
        }
        for_each_repeated(graph_.resources, [&](const ResourceDesc& resource, const ResourceDesc& first) {
            errors_.push_back({.code = DiagnosticCode::duplicate_name,
                               .resource = resource.name,
                               .message = "Two resources are called " + quoted(resource.name) + "; rename one",
                               .where = resource.where,
                               .other_where = first.where});
        });
        for_each_repeated(graph_.passes, [&](const PassDesc& pass, const PassDesc& first) {
            errors_.push_back({.code = DiagnosticCode::duplicate_name,
                               .pass = pass.name,
                               .message = "Two passes are called " + quoted(pass.name) + "; rename one",
                               .where = pass.where,
                               .other_where = first.where});
        });
    }

    void bad(const ResourceDesc& resource, DiagnosticCode code, const std::string& what) {
        errors_.push_back({.code = code,
                           .resource = resource.name,
                           .message = "Resource " + quoted(resource.name) + " " + what,
                           .where = resource.where,
                           .other_where = resource.where});
    }

    void description(const ResourceDesc& resource) {
        if (resource.kind == ResourceKind::buffer) {
            if (resource.buffer.size_bytes == 0) {
                bad(resource, DiagnosticCode::bad_description, "has a size of 0 bytes; give it at least one");
            }
            return;
        }
        const ImageDesc& image = resource.image;
        const VkExtent3D& extent = image.extent;
        if (image.format == VK_FORMAT_UNDEFINED) {
            bad(resource, DiagnosticCode::bad_description, "has no format; give it one");
        }
        if (extent.width == 0 || extent.height == 0 || extent.depth == 0 || image.mips == 0 || image.layers == 0) {
            bad(resource, DiagnosticCode::bad_description,
                "has an extent, mip count or layer count of 0; give it at least 1");
            return;
        }
        const auto longest =
            static_cast<std::uint32_t>(std::bit_width(std::max({extent.width, extent.height, extent.depth})));
        if (image.mips > longest) {
            bad(resource, DiagnosticCode::bad_description,
                "has " + std::to_string(image.mips) + " mips, but its extent allows " + std::to_string(longest));
        }
        if (image.samples != VK_SAMPLE_COUNT_1_BIT && (image.mips > 1 || image.type != VK_IMAGE_TYPE_2D)) {
            bad(resource, DiagnosticCode::bad_description,
                "has several samples, which only 2D images with one mip can have");
        }
        if (image.type == VK_IMAGE_TYPE_3D && image.layers > 1) {
            bad(resource, DiagnosticCode::bad_description, "is a 3D image with layers; use depth instead");
        }
        if (image.type != VK_IMAGE_TYPE_3D && extent.depth > 1) {
            bad(resource, DiagnosticCode::bad_description,
                "has depth but is no 3D image; set its type to VK_IMAGE_TYPE_3D");
        }
    }

    void at_access(const AccessDesc& access, DiagnosticCode code, const std::string& message) {
        const ResourceDesc& resource = graph_.resources[access.resource];
        errors_.push_back({.code = code,
                           .pass = graph_.passes[access.pass].name,
                           .resource = resource.name,
                           .message = message,
                           .where = access.where,
                           .other_where = resource.where});
    }

    std::string subject(const AccessDesc& access) const {
        return "Pass " + quoted(graph_.passes[access.pass].name) + " " + std::string(verb(access.direction)) + " " +
               quoted(graph_.resources[access.resource].name) + " as " + std::string(access_info(access.access).name);
    }

    void pass(const PassDesc& pass) {
        if (pass.access_count == 0 && !pass.has_side_effect) {
            errors_.push_back(
                {.code = DiagnosticCode::empty_pass,
                 .pass = pass.name,
                 .message = "Pass " + quoted(pass.name) +
                            " accesses nothing and has no side effect; declare what it does, or remove it",
                 .where = pass.where,
                 .other_where = pass.where});
        }
        if (pass.kind == PassKind::graphics && pass.wish != QueueWish::automatic && pass.wish != QueueWish::graphics) {
            queue_error(pass, "is a graphics pass but asks for another queue; let it be automatic");
        }
        if (pass.kind == PassKind::compute && pass.wish == QueueWish::transfer) {
            queue_error(pass, "is a compute pass but asks for the transfer queue, which cannot dispatch");
        }
        if (pass.variant != none &&
            (pass.variant >= graph_.variants.size() || pass.form >= graph_.variants[pass.variant].forms.size())) {
            errors_.push_back({.code = DiagnosticCode::bad_description,
                               .pass = pass.name,
                               .message = "Pass " + quoted(pass.name) +
                                          " belongs to a form that no variant has; declare the variant and its forms",
                               .where = pass.where,
                               .other_where = pass.where});
        }
        for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
            const AccessDesc& access = graph_.accesses[i];
            one_access(pass, access);
            for (std::uint32_t k = pass.first_access; k < i; ++k) {
                compare_accesses(graph_.accesses[k], access);
            }
        }
        validate_attachments(graph_, pass, errors_);
    }

    void queue_error(const PassDesc& pass, const std::string& what) {
        errors_.push_back({.code = DiagnosticCode::queue_cannot,
                           .pass = pass.name,
                           .message = "Pass " + quoted(pass.name) + " " + what,
                           .where = pass.where,
                           .other_where = pass.where});
    }

    void one_access(const PassDesc& pass, const AccessDesc& access) {
        const ResourceDesc& resource = graph_.resources[access.resource];
        const AccessInfo& info = access_info(access.access);
        const bool is_image = resource.kind == ResourceKind::image;
        const bool depth = is_image && is_depth_or_stencil(resource.image.format);
        const bool fits = is_image ? (depth ? info.depth_layout : info.color_layout) != VK_IMAGE_LAYOUT_UNDEFINED
                                   : info.buffer_usage != 0;
        if (!fits) {
            at_access(access, DiagnosticCode::access_not_possible,
                      subject(access) + ", which " +
                          (!is_image ? "a buffer"
                           : depth   ? "a depth image"
                                     : "a colour image") +
                          " cannot be; choose another access");
        }
        if (is_write(access.direction) && info.write_mask == 0 && access.access != Access::present) {
            at_access(access, DiagnosticCode::access_not_possible,
                      subject(access) + ", which can only be read; use a storage, attachment or transfer access");
        }
        if (access.direction != Direction::replace && info.read_mask == 0 && access.access != Access::present &&
            access.access != Access::transfer_destination && access.access != Access::resolve_attachment) {
            at_access(access, DiagnosticCode::access_not_possible, subject(access) + ", which cannot be read");
        }
        if (access.direction == Direction::read &&
            (access.access == Access::transfer_destination || access.access == Access::resolve_attachment)) {
            at_access(access, DiagnosticCode::access_not_possible, subject(access) + ", which can only be written");
        }
        const std::uint8_t can = pass.kind == PassKind::graphics   ? can_graphics | can_compute | can_transfer
                                 : pass.kind == PassKind::compute  ? can_compute | can_transfer
                                 : pass.kind == PassKind::transfer ? can_transfer
                                                                   : can_host;
        if ((info.needs & can) == 0) {
            at_access(access, DiagnosticCode::queue_cannot,
                      subject(access) + ", which a " + std::string(name_of(pass.kind)) + " pass cannot do");
        }
        if (access.clears && access.access != Access::color_attachment && access.access != Access::depth_attachment) {
            at_access(access, DiagnosticCode::access_not_possible,
                      subject(access) + " and asks for a clear; only attachments are cleared when loaded");
        }
        if (resource.lifetime == ResourceLifetime::history && is_write(access.direction)) {
            at_access(access, DiagnosticCode::history_misuse,
                      subject(access) + ", but last frame's content is read-only");
        }
        range(access, resource);
    }

    void range(const AccessDesc& access, const ResourceDesc& resource) {
        if (resource.kind == ResourceKind::buffer) {
            const VkDeviceSize size = resource.buffer.size_bytes;
            const BufferRange& r = access.buffer_range;
            const bool inside = r.offset < size && r.size != 0 && (r.size == whole_buffer || r.size <= size - r.offset);
            if (!inside) {
                at_access(access, DiagnosticCode::range_outside,
                          subject(access) + " at bytes that its " + std::to_string(size) + " bytes do not have");
            }
            return;
        }
        const ImageRange& r = access.image_range;
        const auto outside = [](std::uint32_t base, std::uint32_t count, std::uint32_t limit) {
            return base >= limit || count == 0 || (count != all_remaining && count > limit - base);
        };
        if (outside(r.base_mip, r.mip_count, resource.image.mips)) {
            at_access(access, DiagnosticCode::range_outside,
                      subject(access) + " at mips that it does not have; it has " +
                          std::to_string(resource.image.mips));
        }
        if (outside(r.base_layer, r.layer_count, resource.image.layers)) {
            at_access(access, DiagnosticCode::range_outside,
                      subject(access) + " at layers that it does not have; it has " +
                          std::to_string(resource.image.layers));
        }
        if ((r.aspects & ~format_aspects(resource.image.format)) != 0) {
            at_access(access, DiagnosticCode::range_outside, subject(access) + " with an aspect that its format lacks");
        }
    }

    static bool ranges_meet(const AccessDesc& a, const AccessDesc& b, ResourceKind kind) {
        const auto meet = [](std::uint64_t base_a, std::uint64_t count_a, std::uint64_t all_a, std::uint64_t base_b,
                             std::uint64_t count_b) {
            const std::uint64_t end_a = count_a == all_a ? ~0ULL : base_a + count_a;
            const std::uint64_t end_b = count_b == all_a ? ~0ULL : base_b + count_b;
            return base_a < end_b && base_b < end_a;
        };
        if (kind == ResourceKind::buffer) {
            return meet(a.buffer_range.offset, a.buffer_range.size, whole_buffer, b.buffer_range.offset,
                        b.buffer_range.size);
        }
        return meet(a.image_range.base_mip, a.image_range.mip_count, all_remaining, b.image_range.base_mip,
                    b.image_range.mip_count) &&
               meet(a.image_range.base_layer, a.image_range.layer_count, all_remaining, b.image_range.base_layer,
                    b.image_range.layer_count);
    }

    /// Two accesses of one pass to common bytes must agree on a layout, and must not race within the pass.
    void compare_accesses(const AccessDesc& a, const AccessDesc& b) {
        if (a.resource != b.resource || !ranges_meet(a, b, graph_.resources[a.resource].kind)) {
            return;
        }
        const ResourceDesc& resource = graph_.resources[a.resource];
        const VkFormat format = resource.kind == ResourceKind::image ? resource.image.format : VK_FORMAT_UNDEFINED;
        const bool layouts_differ =
            access_scope(a.access, a.direction, format).layout != access_scope(b.access, b.direction, format).layout;
        const bool two_writes = is_write(a.direction) && is_write(b.direction);
        if (layouts_differ || two_writes) {
            errors_.push_back(
                {.code = DiagnosticCode::conflicting_access,
                 .pass = graph_.passes[b.pass].name,
                 .resource = resource.name,
                 .message = subject(b) + " and also " + std::string(verb(a.direction)) + " it as " +
                            std::string(access_info(a.access).name) +
                            (two_writes ? "; write it once in a pass, or split the pass"
                                        : "; no image layout allows both, so split the pass or the ranges"),
                 .where = b.where,
                 .other_where = a.where});
        }
    }

    void imports() {
        Scratch<const AccessDesc*> writer(graph_.resources.size(), nullptr);
        for (const AccessDesc& access : graph_.accesses) {
            if (is_write(access.direction) && writer[access.resource] == nullptr) {
                writer[access.resource] = &access;
            }
        }
        for (std::size_t i = 0; i < graph_.resources.size(); ++i) {
            const ResourceDesc& resource = graph_.resources[i];
            if (resource.has_history && writer[i] == nullptr) {
                bad(resource, DiagnosticCode::history_misuse, "has a history, but no pass writes it");
            }
            if (resource.import == none) {
                continue;
            }
            const ImportDesc& import = graph_.imports[resource.import];
            if (writer[i] != nullptr && import.read_only) {
                at_access(*writer[i], DiagnosticCode::import_incomplete,
                          subject(*writer[i]) + ", but it was imported as read-only; import it with a final access");
            } else if (writer[i] != nullptr && !import.has_final) {
                bad(resource, DiagnosticCode::import_incomplete,
                    "is imported and written, but its import does not say how the host uses it afterwards; give "
                    "it a final use");
            }
            if (import.has_final && resource.kind == ResourceKind::image &&
                import.final_layout == VK_IMAGE_LAYOUT_UNDEFINED) {
                bad(resource, DiagnosticCode::import_incomplete,
                    "is imported with a final access but no final layout; give it the one that the host wants");
            }
            if (import.read_only && resource.kind == ResourceKind::image &&
                import.initial_layout == VK_IMAGE_LAYOUT_UNDEFINED) {
                bad(resource, DiagnosticCode::import_incomplete,
                    "is imported as read-only but without an initial layout, so that it holds nothing to read");
            }
        }
    }

    const GraphDesc& graph_;
    const QueueTopology& topology_;
    Diagnostics errors_;
};

} // namespace

Diagnostics validate(const GraphDesc& graph, const QueueTopology& topology) {
    return Validator(graph, topology).run();
}

} // namespace tyndall::rg::stages
