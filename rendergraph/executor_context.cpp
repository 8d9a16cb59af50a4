// What a callback may ask for: the resources that its pass declared, in the ranges and layouts that it declared.
#include <algorithm>

#include "rendergraph/executor_state.hpp"

namespace tyndall::rg {
namespace {

VkImageViewType natural_type(const ImageDesc& image) {
    switch (image.type) {
    case VK_IMAGE_TYPE_1D: return image.layers > 1 ? VK_IMAGE_VIEW_TYPE_1D_ARRAY : VK_IMAGE_VIEW_TYPE_1D;
    case VK_IMAGE_TYPE_3D: return VK_IMAGE_VIEW_TYPE_3D;
    default: return image.layers > 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D;
    }
}

/// The accesses of `pass` to `resource`, those to `version` alone if there are any, that allow `usage` (0: any use).
class Declared {
public:
    Declared(const GraphDesc& graph, std::uint32_t pass, std::uint32_t resource, std::uint32_t version, VkFlags usage)
        : graph_(graph), pass_(graph.passes[pass]), resource_(resource), usage_(usage) {
        version_ = version;
        if (first() == nullptr) {
            any_version_ = true;
        }
    }

    template <typename F>
    void for_each(F&& f) const {
        for (std::uint32_t i = pass_.first_access; i < pass_.first_access + pass_.access_count; ++i) {
            const AccessDesc& access = graph_.accesses[i];
            const AccessInfo& row = access_info(access.access);
            const VkFlags allows =
                graph_.resources[access.resource].kind == ResourceKind::image ? row.image_usage : row.buffer_usage;
            if (access.resource == resource_ && (any_version_ || access.version == version_) &&
                (allows & usage_) == usage_) {
                f(access);
            }
        }
    }
    [[nodiscard]] const AccessDesc* first() const {
        const AccessDesc* found = nullptr;
        for_each([&](const AccessDesc& access) { found = found == nullptr ? &access : found; });
        return found;
    }

private:
    const GraphDesc& graph_;
    const PassDesc& pass_;
    std::uint32_t resource_;
    std::uint32_t version_ = 0;
    VkFlags usage_;
    bool any_version_ = false;
};

ImageRange range_of(const Declared& declared, const ImageDesc& image) {
    std::optional<ImageRange> all;
    declared.for_each([&](const AccessDesc& access) {
        const ImageRange range = resolved(access.image_range, image);
        if (!all) {
            all = range;
            return;
        }
        const std::uint32_t mip_end = std::max(all->base_mip + all->mip_count, range.base_mip + range.mip_count);
        const std::uint32_t layer_end =
            std::max(all->base_layer + all->layer_count, range.base_layer + range.layer_count);
        all->base_mip = std::min(all->base_mip, range.base_mip);
        all->base_layer = std::min(all->base_layer, range.base_layer);
        all->mip_count = mip_end - all->base_mip;
        all->layer_count = layer_end - all->base_layer;
        all->aspects |= range.aspects;
    });
    return all.value_or(ImageRange{});
}

bool inside(const ImageRange& inner, const ImageRange& outer) {
    return inner.base_mip >= outer.base_mip && inner.base_mip + inner.mip_count <= outer.base_mip + outer.mip_count &&
           inner.base_layer >= outer.base_layer &&
           inner.base_layer + inner.layer_count <= outer.base_layer + outer.layer_count;
}

VkImageLayout layout_of(const AccessDesc& access, VkFormat format) {
    return access_scope(access.access, access.direction, format).layout;
}

template <typename Handle>
Binding binding_of(const Handle& handle, std::uint32_t binding, VkDescriptorType type) {
    Binding out{.binding = binding, .type = type};
    out.resource = handle.resource;
    out.version = handle.version;
    return out;
}

} // namespace

ImageRange resolved(const ImageRange& range, const ImageDesc& image) {
    ImageRange out = range;
    if (out.mip_count == all_remaining) {
        out.mip_count = image.mips - out.base_mip;
    }
    if (out.layer_count == all_remaining) {
        out.layer_count = image.layers - out.base_layer;
    }
    if (out.aspects == 0) {
        out.aspects = format_aspects(image.format);
    }
    return out;
}

void ExecutorState::report_undeclared(std::uint32_t pass, const std::string& what) {
    const std::string sentence = "Pass '" + work.graph->passes[pass].name + "' uses " + what;
    if (!work.error) {
        work.error = ExecuteError{.kind = ExecuteError::Kind::undeclared_access, .message = sentence};
    } else if (work.error->kind == ExecuteError::Kind::undeclared_access &&
               work.error->message.find(sentence) == std::string::npos) {
        work.error->message += "; " + sentence;
    }
}

const AccessDesc* ExecutorState::declared_access(std::uint32_t pass, std::uint32_t resource, std::uint32_t version,
                                                 ResourceKind kind, VkFlags usage) {
    const GraphDesc& graph = *work.graph;
    if (resource >= graph.resources.size() || graph.resources[resource].kind != kind) {
        report_undeclared(pass, "a handle that is not of this graph");
        return nullptr;
    }
    const AccessDesc* access = Declared(graph, pass, resource, version, usage).first();
    if (access == nullptr || work.objects[resource] == nullptr) {
        report_undeclared(pass,
                          "'" + graph.resources[resource].name +
                              (usage == 0 ? "', which it did not declare" : "' in a way that it did not declare"));
        return nullptr;
    }
    return access;
}

DeclaredDirections ExecutorState::declared_directions(std::uint32_t pass, std::uint32_t resource, std::uint32_t version,
                                                      VkFlags usage) const {
    DeclaredDirections out;
    Declared(*work.graph, pass, resource, version, usage).for_each([&](const AccessDesc& access) {
        out.reads |= is_read(access.direction);
        out.writes |= is_write(access.direction);
    });
    return out;
}

VkImageView ExecutorState::declared_view(std::uint32_t pass, Image image, const ViewDesc& desc, VkFlags usage) {
    if (declared_access(pass, image.resource, image.version, ResourceKind::image, usage) == nullptr) {
        return VK_NULL_HANDLE;
    }
    const ResourceDesc& resource = work.graph->resources[image.resource];
    const ImageRange declared =
        range_of(Declared(*work.graph, pass, image.resource, image.version, usage), resource.image);
    ImageRange range = desc.range == ImageRange{} ? declared : resolved(desc.range, resource.image);
    if (!inside(range, declared)) {
        report_undeclared(pass, "mips or layers of '" + resource.name + "' that it did not declare");
        return VK_NULL_HANDLE;
    }
    constexpr VkImageAspectFlags both = VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
    if (range.aspects == both && (usage & VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT) == 0) {
        range.aspects = VK_IMAGE_ASPECT_DEPTH_BIT; // a shader sees one aspect at a time
    }
    return view_of(image.resource, range,
                   desc.type == VK_IMAGE_VIEW_TYPE_MAX_ENUM ? natural_type(resource.image) : desc.type);
}

std::string_view PassContext::pass_name() const {
    return state_->work.graph->passes[pass_].name;
}

const DeviceTable& PassContext::vk() const {
    return state_->work.error ? state_->vk_of_lost_frame : state_->vk;
}

VkImage PassContext::image(Image image) {
    const AccessDesc* access = state_->declared_access(pass_, image.resource, image.version, ResourceKind::image, 0);
    return access == nullptr ? VK_NULL_HANDLE : state_->work.objects[image.resource]->image;
}

VkBuffer PassContext::buffer(Buffer buffer) {
    const AccessDesc* access = state_->declared_access(pass_, buffer.resource, buffer.version, ResourceKind::buffer, 0);
    return access == nullptr ? VK_NULL_HANDLE : state_->work.objects[buffer.resource]->buffer;
}

VkImageView PassContext::view(Image image, const ViewDesc& desc) {
    return state_->declared_view(pass_, image, desc, 0);
}

VkImageLayout PassContext::layout(Image image) {
    const AccessDesc* access = state_->declared_access(pass_, image.resource, image.version, ResourceKind::image, 0);
    return access == nullptr ? VK_IMAGE_LAYOUT_UNDEFINED
                             : layout_of(*access, state_->work.graph->resources[image.resource].image.format);
}

bool PassContext::history_valid(Image image) {
    return state_->declared_access(pass_, image.resource, image.version, ResourceKind::image, 0) != nullptr &&
           state_->history_valid(image.resource);
}

bool PassContext::history_valid(Buffer buffer) {
    return state_->declared_access(pass_, buffer.resource, buffer.version, ResourceKind::buffer, 0) != nullptr &&
           state_->history_valid(buffer.resource);
}

Binding PassContext::sampled(std::uint32_t binding, Image image, VkSampler sampler, const ViewDesc& desc) {
    constexpr VkFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT;
    Binding out = binding_of(image, binding, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER);
    const AccessDesc* access =
        state_->declared_access(pass_, image.resource, image.version, ResourceKind::image, usage);
    if (access != nullptr) {
        const VkFormat format = state_->work.graph->resources[image.resource].image.format;
        out.image = {sampler, state_->declared_view(pass_, image, desc, usage), layout_of(*access, format)};
    }
    return out;
}

Binding PassContext::storage(std::uint32_t binding, Image image, const ViewDesc& desc) {
    Binding out = binding_of(image, binding, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE);
    out.image = {VK_NULL_HANDLE, state_->declared_view(pass_, image, desc, VK_IMAGE_USAGE_STORAGE_BIT),
                 VK_IMAGE_LAYOUT_GENERAL};
    return out;
}

Binding PassContext::storage(std::uint32_t binding, Buffer buffer) {
    Binding out = binding_of(buffer, binding, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
    const AccessDesc* access = state_->declared_access(pass_, buffer.resource, buffer.version, ResourceKind::buffer,
                                                       VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    if (access != nullptr) {
        out.buffer = {state_->work.objects[buffer.resource]->buffer, access->buffer_range.offset,
                      access->buffer_range.size};
    }
    return out;
}

Binding PassContext::uniform(std::uint32_t binding, Buffer buffer, VkDeviceSize offset, VkDeviceSize size) {
    Binding out = binding_of(buffer, binding, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER);
    const AccessDesc* access = state_->declared_access(pass_, buffer.resource, buffer.version, ResourceKind::buffer,
                                                       VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
    if (access == nullptr) {
        return out;
    }
    const ResourceDesc& resource = state_->work.graph->resources[buffer.resource];
    const auto end_of = [&](VkDeviceSize from, VkDeviceSize bytes) {
        return bytes == VK_WHOLE_SIZE ? resource.buffer.size_bytes : from + bytes;
    };
    const BufferRange& declared = access->buffer_range;
    const VkDeviceSize begin = std::max(offset, offset == 0 ? declared.offset : 0);
    const VkDeviceSize end = size == VK_WHOLE_SIZE ? end_of(declared.offset, declared.size) : begin + size;
    if (begin < declared.offset || end > end_of(declared.offset, declared.size) || begin >= end) {
        state_->report_undeclared(pass_, "bytes of '" + resource.name + "' that it did not declare");
        return out;
    }
    out.buffer = {state_->work.objects[buffer.resource]->buffer, begin, end - begin};
    return out;
}

void PassContext::push(VkPipelineBindPoint point, VkPipelineLayout layout, std::uint32_t set,
                       std::span<const Binding> bindings, std::span<const ReflectedBinding> shader) {
    if (state_->info.check_bindings) {
        state_->check_bindings(pass_, set, bindings, shader);
    }
    std::vector<VkWriteDescriptorSet>& writes = state_->work.writes;
    writes.clear();
    for (const Binding& binding : bindings) {
        writes.push_back({.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                          .dstBinding = binding.binding,
                          .descriptorCount = 1,
                          .descriptorType = binding.type,
                          .pImageInfo = &binding.image,
                          .pBufferInfo = &binding.buffer});
    }
    vk().CmdPushDescriptorSetKHR(cmd_, point, layout, set, static_cast<std::uint32_t>(writes.size()), writes.data());
}

} // namespace tyndall::rg
