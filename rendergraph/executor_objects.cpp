// Keeping physical objects: a steady frame finds all of them, creates none, and frees what no frame uses any more.
#include <algorithm>
#include <bit>

#include "rendergraph/executor_state.hpp"

namespace tyndall::rg {
namespace {

/// Sets, histories and imports that no frame has used for so long are given back.
constexpr std::uint64_t frames_kept_unused = 8;
/// Two plans may alternate from frame to frame without creating objects; the memory of more is not held on to.
constexpr std::size_t transient_sets_kept = 2;

bool out_of_memory(const ExecuteError& error) {
    return error.kind == ExecuteError::Kind::out_of_memory;
}

} // namespace

void ExecutorState::set_name(VkObjectType type, std::uint64_t handle, const std::string& name) const {
    if (!info.debug_labels || vk.SetDebugUtilsObjectNameEXT == nullptr) {
        return;
    }
    const VkDebugUtilsObjectNameInfoEXT named{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                              .objectType = type,
                                              .objectHandle = handle,
                                              .pObjectName = name.c_str()};
    static_cast<void>(vk.SetDebugUtilsObjectNameEXT(info.device, &named)); // a name is a convenience
}

// ---- one object for every resource of the frame ------------------------------------------------------------------

ExecutorState::Result ExecutorState::bind_objects(std::span<const ImportBinding> given) {
    work.objects.assign(work.graph->resources.size(), nullptr);
    if (Result bound = bind_imports(given); !bound) {
        return bound;
    }
    Result bound = bind_transients();
    if (!bound && out_of_memory(bound.error()) && make_room()) {
        bound = bind_transients();
    }
    if (!bound) {
        return bound;
    }
    return bind_histories();
}

ExecutorState::Result ExecutorState::bind_imports(std::span<const ImportBinding> given) {
    const GraphDesc& graph = *work.graph;
    work.bindings.assign(graph.resources.size(), nullptr);
    for (const ImportBinding& binding : given) {
        if (binding.resource < graph.resources.size()) {
            work.bindings[binding.resource] = &binding;
        }
    }
    const auto missing = [&](std::uint32_t resource, std::string_view what) {
        return tl::unexpected(ExecuteError{.kind = ExecuteError::Kind::missing_binding,
                                           .message = "Imported resource '" + graph.resources[resource].name +
                                                      "' has no " + std::string(what) +
                                                      " bound in this frame; add it to the import bindings"});
    };
    for (const PlannedPass& planned : work.plan->passes) {
        const PassDesc& pass = graph.passes[planned.pass];
        for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
            const std::uint32_t resource = graph.accesses[i].resource;
            const ResourceDesc& desc = graph.resources[resource];
            if (desc.lifetime != ResourceLifetime::imported || work.objects[resource] != nullptr) {
                continue;
            }
            const ImportBinding* binding = work.bindings[resource];
            const bool is_image = desc.kind == ResourceKind::image;
            if (binding == nullptr || (is_image && binding->image == VK_NULL_HANDLE) ||
                (!is_image && binding->buffer == VK_NULL_HANDLE)) {
                return missing(resource, is_image ? "image" : "buffer");
            }
            const ImportDesc& import = graph.imports[desc.import];
            if (!work.by_host && import.waits_semaphore && binding->wait_semaphore == VK_NULL_HANDLE) {
                return missing(resource, "semaphore to wait for");
            }
            if (!work.by_host && import.signals_semaphore && binding->signal_semaphore == VK_NULL_HANDLE) {
                return missing(resource, "semaphore to signal");
            }
            const auto known = std::find_if(imports.begin(), imports.end(), [&](const auto& entry) {
                return is_image ? entry->objects.front().image == binding->image
                                : entry->objects.front().buffer == binding->buffer;
            });
            const bool is_new = known == imports.end();
            if (is_new) {
                imports.push_back(std::make_unique<ImportedObject>());
                imports.back()->objects.push_back({.image = is_image ? binding->image : VK_NULL_HANDLE,
                                                   .buffer = is_image ? VK_NULL_HANDLE : binding->buffer,
                                                   .owned = false});
            }
            ImportedObject& entry = is_new ? *imports.back() : **known;
            entry.last_used = work.number;
            work.objects[resource] = &entry.objects.front();
        }
    }
    return {};
}

bool ExecutorState::matches(const TransientSet& set) const {
    const Plan& plan = *work.plan;
    if (set.entries.size() != plan.placements.size() || set.heap_bytes.size() != plan.heaps.size()) {
        return false;
    }
    for (std::size_t heap = 0; heap < plan.heaps.size(); ++heap) {
        if (set.heap_bytes[heap] != plan.heaps[heap].size_bytes ||
            (set.type_bits[heap] & ~plan.heaps[heap].memory_type_bits) != 0) {
            return false;
        }
    }
    for (std::uint32_t resource = 0; resource < plan.placements.size(); ++resource) {
        const TransientSet::Entry& entry = set.entries[resource];
        const Placement& placement = plan.placements[resource];
        const bool placed = placement.kind == PlacementKind::heap;
        if (placed != entry.placed ||
            (placed && (entry.heap != placement.heap || entry.offset_bytes != placement.offset_bytes ||
                        !same_key(entry.key, key_of(resource))))) {
            return false;
        }
    }
    return true;
}

ExecutorState::Result ExecutorState::bind_transients() {
    const auto known =
        std::find_if(transients.begin(), transients.end(), [&](const auto& set) { return matches(*set); });
    const bool is_new = known == transients.end();
    if (is_new) {
        if (transients.size() >= transient_sets_kept) {
            const auto oldest =
                std::min_element(transients.begin(), transients.end(),
                                 [](const auto& a, const auto& b) { return a->last_used < b->last_used; });
            retire((*oldest)->last_used, std::move((*oldest)->objects), std::move((*oldest)->memory));
            transients.erase(oldest);
        }
        auto made = create_transients();
        if (!made) {
            return tl::unexpected(std::move(made.error()));
        }
        transients.push_back(std::move(*made));
    }
    TransientSet& set = is_new ? *transients.back() : **known;
    set.last_used = work.number;
    for (std::uint32_t resource = 0; resource < set.entries.size(); ++resource) {
        if (set.entries[resource].placed) {
            work.objects[resource] = &set.objects[resource];
        }
    }
    return {};
}

ExecutorState::Result ExecutorState::bind_histories() {
    const GraphDesc& graph = *work.graph;
    for (const auto& pair : histories) {
        pair->resource = none;
    }
    for (std::uint32_t resource = 0; resource < graph.resources.size(); ++resource) {
        const std::uint32_t written = graph.resources[resource].history_of;
        if (written == none || work.plan->placements[written].kind != PlacementKind::history) {
            continue;
        }
        const ObjectKey key = key_of(written);
        if (key.usage == 0) {
            continue; // no pass touches either copy
        }
        const std::string& name = graph.resources[written].name;
        auto known = std::find_if(histories.begin(), histories.end(),
                                  [&](const auto& pair) { return pair->resource == none && pair->name == name; });
        if (known != histories.end() && !same_key((*known)->key, key)) {
            retire((*known)->last_used, std::move((*known)->copies), std::move((*known)->memory));
            histories.erase(known);
            known = histories.end();
        }
        if (known == histories.end()) {
            const auto create = [&] {
                auto first = create_history(key, name);
                return !first && out_of_memory(first.error()) && make_room() ? create_history(key, name)
                                                                             : std::move(first);
            };
            auto made = create();
            if (!made) {
                return tl::unexpected(std::move(made.error()));
            }
            histories.push_back(std::move(*made));
            known = histories.end() - 1;
        }
        HistoryPair& pair = **known;
        pair.resource = written;
        pair.history_resource = resource;
        pair.last_used = work.number;
        work.objects[written] = &pair.copies[pair.current];
        work.objects[resource] = &pair.copies[1 - pair.current];
    }
    return {};
}

bool ExecutorState::history_valid(std::uint32_t resource) const {
    for (const auto& pair : histories) {
        if (pair->resource != none && pair->history_resource == resource) {
            return !history_lost && pair->written_in != 0 && pair->written_in + 1 == work.number;
        }
    }
    return false;
}

VkImageView ExecutorState::view_of(std::uint32_t resource, const ImageRange& range, VkImageViewType type) {
    PhysicalObject& object = *work.objects[resource];
    for (const CachedView& cached : object.views) {
        if (cached.type == type && cached.range == range) {
            return cached.view;
        }
    }
    const ResourceDesc& desc = work.graph->resources[resource];
    const VkImageViewCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = object.image,
        .viewType = type,
        .format = desc.image.format,
        .subresourceRange = {range.aspects, range.base_mip, range.mip_count, range.base_layer, range.layer_count}};
    VkImageView view = VK_NULL_HANDLE;
    if (const VkResult result = vk.CreateImageView(info.device, &create, nullptr, &view); result < 0) {
        if (!work.error) {
            work.error = vulkan_error(result, "A view of '" + desc.name + "' could not be created");
        }
        return VK_NULL_HANDLE;
    }
    set_name(VK_OBJECT_TYPE_IMAGE_VIEW, std::bit_cast<std::uint64_t>(view), desc.name);
    object.views.push_back({range, type, view});
    return view;
}

// ---- giving back -------------------------------------------------------------------------------------------------

void ExecutorState::retire(std::uint64_t last_used, std::vector<PhysicalObject> objects,
                           std::vector<VkDeviceMemory> memory) {
    garbage.push_back({last_used, std::move(objects), std::move(memory)});
}

void ExecutorState::release_import(VkImage image) {
    const auto found = std::find_if(imports.begin(), imports.end(),
                                    [&](const auto& entry) { return entry->objects.front().image == image; });
    if (found != imports.end()) {
        retire((*found)->last_used, std::move((*found)->objects), {});
        imports.erase(found);
    }
}

void ExecutorState::retire_unused() {
    const auto unused = [&](std::uint64_t last_used) { return last_used + frames_kept_unused < work.number; };
    std::erase_if(transients, [&](auto& set) {
        const bool old = unused(set->last_used);
        if (old) {
            retire(set->last_used, std::move(set->objects), std::move(set->memory));
        }
        return old;
    });
    std::erase_if(histories, [&](auto& pair) {
        const bool old = unused(pair->last_used);
        if (old) {
            retire(pair->last_used, std::move(pair->copies), std::move(pair->memory));
        }
        return old;
    });
    std::erase_if(imports, [&](auto& import) {
        const bool old = unused(import->last_used);
        if (old) {
            retire(import->last_used, std::move(import->objects), {});
        }
        return old;
    });
}

void ExecutorState::collect_garbage(std::uint64_t finished_frame) {
    std::erase_if(garbage, [&](Garbage& entry) {
        const bool free = entry.last_used <= finished_frame;
        if (free) {
            destroy(entry.objects, entry.memory);
        }
        return free;
    });
}

bool ExecutorState::make_room() {
    for (const FrameSlot& slot : slots) {
        if (slot.by_host || !wait_for_values(slot.values)) {
            return false; // what a host's command buffer uses is not known to be free
        }
    }
    const std::size_t before = garbage.size() + transients.size();
    std::erase_if(transients, [&](auto& set) {
        const bool idle = set->last_used < work.number;
        if (idle) {
            retire(set->last_used, std::move(set->objects), std::move(set->memory));
        }
        return idle;
    });
    collect_garbage(frames);
    return garbage.size() + transients.size() < before;
}

void ExecutorState::destroy(std::vector<PhysicalObject>& objects, std::vector<VkDeviceMemory>& memory) const {
    for (PhysicalObject& object : objects) {
        for (const CachedView& cached : object.views) {
            vk.DestroyImageView(info.device, cached.view, nullptr);
        }
        if (object.owned) {
            vk.DestroyImage(info.device, object.image, nullptr);
            vk.DestroyBuffer(info.device, object.buffer, nullptr);
        }
    }
    for (const VkDeviceMemory block : memory) {
        if (info.memory.free) {
            info.memory.free(block);
        } else {
            vk.FreeMemory(info.device, block, nullptr);
        }
    }
    objects.clear();
    memory.clear();
}

} // namespace tyndall::rg
