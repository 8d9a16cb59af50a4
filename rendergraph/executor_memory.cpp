// Making physical objects: the driver's requirements, images and buffers at the plan's offsets of its heaps, history
// pairs.
#include <algorithm>
#include <bit>

#include "rendergraph/executor_state.hpp"

namespace tyndall::rg {
namespace {

bool same_image(const ImageDesc& a, const ImageDesc& b) {
    return a.format == b.format && a.extent.width == b.extent.width && a.extent.height == b.extent.height &&
           a.extent.depth == b.extent.depth && a.mips == b.mips && a.layers == b.layers && a.type == b.type &&
           a.samples == b.samples && a.flags == b.flags;
}

bool describable(const ResourceDesc& desc) {
    if (desc.kind == ResourceKind::buffer) {
        return desc.buffer.size_bytes > 0;
    }
    const VkExtent3D& extent = desc.image.extent;
    return desc.image.format != VK_FORMAT_UNDEFINED && extent.width > 0 && extent.height > 0 && extent.depth > 0 &&
           desc.image.mips > 0 && desc.image.layers > 0;
}

std::uint32_t families_of(const std::vector<RealQueue>& queues, std::uint32_t queue_bits,
                          std::array<std::uint32_t, 32>& families) {
    std::uint32_t count = 0;
    for (std::uint32_t q = 0; q < queues.size(); ++q) {
        if ((queue_bits >> q & 1U) != 0) {
            families[count++] = queues[q].info.family;
        }
    }
    return count;
}

VkImageCreateInfo image_info(const ObjectKey& key, const std::array<std::uint32_t, 32>& families,
                             std::uint32_t family_count) {
    return {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
            .flags = key.image.flags,
            .imageType = key.image.type,
            .format = key.image.format,
            .extent = key.image.extent,
            .mipLevels = key.image.mips,
            .arrayLayers = key.image.layers,
            .samples = key.image.samples,
            .tiling = VK_IMAGE_TILING_OPTIMAL,
            .usage = key.usage,
            .sharingMode = family_count > 1 ? VK_SHARING_MODE_CONCURRENT : VK_SHARING_MODE_EXCLUSIVE,
            .queueFamilyIndexCount = family_count > 1 ? family_count : 0,
            .pQueueFamilyIndices = family_count > 1 ? families.data() : nullptr,
            .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED};
}

VkBufferCreateInfo buffer_info(const ObjectKey& key, const std::array<std::uint32_t, 32>& families,
                               std::uint32_t family_count) {
    return {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
            .size = key.size_bytes,
            .usage = key.usage,
            .sharingMode = family_count > 1 ? VK_SHARING_MODE_CONCURRENT : VK_SHARING_MODE_EXCLUSIVE,
            .queueFamilyIndexCount = family_count > 1 ? family_count : 0,
            .pQueueFamilyIndices = family_count > 1 ? families.data() : nullptr};
}

bool device_address(const ObjectKey& key) {
    return key.kind == ResourceKind::buffer && (key.usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT) != 0;
}

} // namespace

bool same_key(const ObjectKey& a, const ObjectKey& b) {
    return a.kind == b.kind && a.usage == b.usage && a.queues == b.queues &&
           (a.kind == ResourceKind::buffer ? a.size_bytes == b.size_bytes : same_image(a.image, b.image));
}

void gather_usage(const GraphDesc& graph, bool poisoned, std::vector<VkFlags>& usage) {
    usage.clear();
    for (const ResourceDesc& desc : graph.resources) {
        usage.push_back(desc.kind == ResourceKind::image ? desc.image.extra_usage : desc.buffer.extra_usage);
    }
    for (const AccessDesc& access : graph.accesses) {
        const AccessInfo& row = access_info(access.access);
        usage[access.resource] |=
            graph.resources[access.resource].kind == ResourceKind::image ? row.image_usage : row.buffer_usage;
    }
    for (std::uint32_t resource = 0; resource < graph.resources.size(); ++resource) {
        const ResourceDesc& desc = graph.resources[resource];
        if (poisoned && usage[resource] != 0 && can_poison(desc)) {
            usage[resource] |= desc.kind == ResourceKind::image ? VkFlags{VK_IMAGE_USAGE_TRANSFER_DST_BIT}
                                                                : VkFlags{VK_BUFFER_USAGE_TRANSFER_DST_BIT};
        }
    }
    for (std::uint32_t resource = 0; resource < graph.resources.size(); ++resource) {
        // The two copies of a history swap roles, so both can do what either must.
        if (const std::uint32_t written = graph.resources[resource].history_of; written != none) {
            usage[resource] = usage[written] = usage[resource] | usage[written];
        }
    }
}

// ---- requirements ------------------------------------------------------------------------------------------------

MemoryRequirement ExecutorState::requirement_of(const ResourceDesc& desc, VkFlags usage) const {
    const ObjectKey key{desc.kind, desc.image, desc.buffer.size_bytes, usage, 0};
    MemoryRequirement out;
    if (desc.lifetime == ResourceLifetime::imported || key.usage == 0 || !describable(desc)) {
        return out;
    }
    // Whether it will be shared is for compile to decide: the worse of both is asked for.
    const std::array<std::uint32_t, 2> sharings = {0, all_families};
    for (const std::uint32_t sharing : sharings) {
        std::array<std::uint32_t, 32> families = {};
        const std::uint32_t count = families_of(queues, sharing, families);
        VkMemoryRequirements2 needs{.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2};
        if (desc.kind == ResourceKind::image) {
            const VkImageCreateInfo create = image_info(key, families, count);
            const VkDeviceImageMemoryRequirements query{.sType = VK_STRUCTURE_TYPE_DEVICE_IMAGE_MEMORY_REQUIREMENTS,
                                                        .pCreateInfo = &create};
            vk.GetDeviceImageMemoryRequirements(info.device, &query, &needs);
        } else {
            const VkBufferCreateInfo create = buffer_info(key, families, count);
            const VkDeviceBufferMemoryRequirements query{.sType = VK_STRUCTURE_TYPE_DEVICE_BUFFER_MEMORY_REQUIREMENTS,
                                                         .pCreateInfo = &create};
            vk.GetDeviceBufferMemoryRequirements(info.device, &query, &needs);
        }
        out.size_bytes = std::max(out.size_bytes, needs.memoryRequirements.size);
        out.alignment = std::max(out.alignment, needs.memoryRequirements.alignment);
        out.memory_type_bits &= needs.memoryRequirements.memoryTypeBits;
    }
    return out;
}

VkMemoryRequirements ExecutorState::requirements_of(const PhysicalObject& object) const {
    VkMemoryRequirements needs = {};
    if (object.image != VK_NULL_HANDLE) {
        vk.GetImageMemoryRequirements(info.device, object.image, &needs);
    } else {
        vk.GetBufferMemoryRequirements(info.device, object.buffer, &needs);
    }
    return needs;
}

// ---- objects -----------------------------------------------------------------------------------------------------

ObjectKey ExecutorState::key_of(std::uint32_t resource) const {
    const ResourceDesc& desc = work.graph->resources[resource];
    const Placement& placement = work.plan->placements[resource];
    ObjectKey key{desc.kind, desc.image, desc.buffer.size_bytes, work.usage[resource], 0};
    key.usage |= desc.kind == ResourceKind::image ? placement.image_usage : placement.buffer_usage;
    // A history passes from family to family between frames, outside the plan's sight: it is shared if it has several.
    if (!placement.concurrent && placement.kind != PlacementKind::history) {
        return key;
    }
    for (std::uint32_t q = 0; q < work.plan->topology.queues.size(); ++q) {
        const std::uint32_t family = work.plan->topology.queues[q].family;
        if (std::find(placement.families.begin(), placement.families.end(), family) != placement.families.end()) {
            key.queues |= queues[work.real_of[q]].family_bit;
        }
    }
    // One family owns it. The next plan's may be another: then a new history begins, since nobody releases the old one.
    if (std::popcount(key.queues) < 2 && placement.kind != PlacementKind::history) {
        key.queues = 0;
    }
    return key;
}

ExecutorState::Result ExecutorState::create_object(const ObjectKey& key, const std::string& name,
                                                   PhysicalObject& object) {
    std::array<std::uint32_t, 32> families = {};
    const std::uint32_t count = families_of(queues, key.queues, families);
    object.concurrent = count > 1;
    if (key.kind == ResourceKind::image) {
        const VkImageCreateInfo create = image_info(key, families, count);
        if (const VkResult result = vk.CreateImage(info.device, &create, nullptr, &object.image); result < 0) {
            return tl::unexpected(vulkan_error(result, "Image '" + name + "' could not be created"));
        }
        set_name(VK_OBJECT_TYPE_IMAGE, std::bit_cast<std::uint64_t>(object.image), name);
        return {};
    }
    const VkBufferCreateInfo create = buffer_info(key, families, count);
    if (const VkResult result = vk.CreateBuffer(info.device, &create, nullptr, &object.buffer); result < 0) {
        return tl::unexpected(vulkan_error(result, "Buffer '" + name + "' could not be created"));
    }
    set_name(VK_OBJECT_TYPE_BUFFER, std::bit_cast<std::uint64_t>(object.buffer), name);
    return {};
}

tl::expected<VkDeviceMemory, ExecuteError> ExecutorState::allocate(VkDeviceSize size, std::uint32_t type_bits,
                                                                   bool addressed) const {
    constexpr VkMemoryPropertyFlags never = VK_MEMORY_PROPERTY_PROTECTED_BIT | VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT |
                                            VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD;
    const VkPhysicalDeviceMemoryProperties& memory = info.memory_properties;
    std::uint32_t chosen = none;
    for (std::uint32_t type = 0; type < memory.memoryTypeCount; ++type) {
        const VkMemoryPropertyFlags flags = memory.memoryTypes[type].propertyFlags;
        if ((type_bits >> type & 1U) == 0 || (flags & never) != 0) {
            continue;
        }
        const bool local = (flags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) != 0;
        if (local || chosen == none) {
            chosen = type;
        }
        if (local) {
            break;
        }
    }
    if (chosen == none) {
        return tl::unexpected(ExecuteError{.message = "No memory type fits a heap of the plan; compile it with this "
                                                      "executor's memory_requirements"});
    }
    const VkMemoryAllocateFlagsInfo flags{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                          .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
    const VkMemoryAllocateInfo request{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                       .pNext = addressed ? &flags : nullptr,
                                       .allocationSize = size,
                                       .memoryTypeIndex = chosen};
    VkDeviceMemory out = VK_NULL_HANDLE;
    const VkResult result = info.memory.allocate ? info.memory.allocate(request, out)
                                                 : vk.AllocateMemory(info.device, &request, nullptr, &out);
    if (result < 0) {
        return tl::unexpected(vulkan_error(result, std::to_string(size) + " bytes of device memory were refused"));
    }
    return out;
}

VkResult ExecutorState::bind_memory(const PhysicalObject& object, VkDeviceMemory memory, VkDeviceSize offset) const {
    return object.image != VK_NULL_HANDLE ? vk.BindImageMemory(info.device, object.image, memory, offset)
                                          : vk.BindBufferMemory(info.device, object.buffer, memory, offset);
}

ExecutorState::Result ExecutorState::fill(TransientSet& set) {
    const Plan& plan = *work.plan;
    std::vector<bool> addressed(plan.heaps.size(), false);
    for (std::uint32_t resource = 0; resource < plan.placements.size(); ++resource) {
        const Placement& placement = plan.placements[resource];
        if (placement.kind != PlacementKind::heap) {
            continue;
        }
        const ObjectKey key = key_of(resource);
        const std::string& name = work.graph->resources[resource].name;
        set.entries[resource] = {true, key, placement.heap, placement.offset_bytes};
        if (Result made = create_object(key, name, set.objects[resource]); !made) {
            return made;
        }
        const VkMemoryRequirements needs = requirements_of(set.objects[resource]);
        if (needs.size > placement.size_bytes || placement.offset_bytes % needs.alignment != 0) {
            return tl::unexpected(ExecuteError{.message = "'" + name + "' needs " + std::to_string(needs.size) +
                                                          " bytes aligned to " + std::to_string(needs.alignment) +
                                                          " on this device, which its placement does not give; compile "
                                                          "with this executor's memory_requirements"});
        }
        set.type_bits[placement.heap] &= needs.memoryTypeBits;
        addressed[placement.heap] = addressed[placement.heap] || device_address(key);
    }
    for (std::uint32_t heap = 0; heap < plan.heaps.size(); ++heap) {
        const auto memory = allocate(plan.heaps[heap].size_bytes, set.type_bits[heap], addressed[heap]);
        if (!memory) {
            return tl::unexpected(memory.error());
        }
        set.memory.push_back(*memory);
    }
    for (std::uint32_t resource = 0; resource < set.entries.size(); ++resource) {
        const TransientSet::Entry& entry = set.entries[resource];
        if (!entry.placed) {
            continue;
        }
        if (const VkResult bound = bind_memory(set.objects[resource], set.memory[entry.heap], entry.offset_bytes);
            bound < 0) {
            return tl::unexpected(
                vulkan_error(bound, "Memory of '" + work.graph->resources[resource].name + "' was not bound"));
        }
    }
    return {};
}

tl::expected<std::unique_ptr<TransientSet>, ExecuteError> ExecutorState::create_transients() {
    auto set = std::make_unique<TransientSet>();
    set->entries.resize(work.plan->placements.size());
    set->objects.resize(work.plan->placements.size());
    for (const Heap& heap : work.plan->heaps) {
        set->heap_bytes.push_back(heap.size_bytes);
        set->type_bits.push_back(heap.memory_type_bits);
    }
    if (Result filled = fill(*set); !filled) {
        destroy(set->objects, set->memory);
        return tl::unexpected(std::move(filled.error()));
    }
    return set;
}

ExecutorState::Result ExecutorState::fill(HistoryPair& pair) {
    for (PhysicalObject& copy : pair.copies) {
        if (Result made = create_object(pair.key, pair.name, copy); !made) {
            return made;
        }
    }
    const VkMemoryRequirements needs = requirements_of(pair.copies[0]);
    const VkDeviceSize second = (needs.size + needs.alignment - 1) / needs.alignment * needs.alignment;
    const auto memory = allocate(second + needs.size, needs.memoryTypeBits, device_address(pair.key));
    if (!memory) {
        return tl::unexpected(memory.error());
    }
    pair.memory.push_back(*memory);
    for (std::uint32_t copy = 0; copy < 2; ++copy) {
        if (const VkResult bound = bind_memory(pair.copies[copy], *memory, copy * second); bound < 0) {
            return tl::unexpected(vulkan_error(bound, "Memory of '" + pair.name + "' was not bound"));
        }
    }
    return {};
}

tl::expected<std::unique_ptr<HistoryPair>, ExecuteError> ExecutorState::create_history(const ObjectKey& key,
                                                                                       const std::string& name) {
    auto pair = std::make_unique<HistoryPair>();
    pair->name = name;
    pair->key = key;
    pair->copies.resize(2);
    if (Result filled = fill(*pair); !filled) {
        destroy(pair->copies, pair->memory);
        return tl::unexpected(std::move(filled.error()));
    }
    return pair;
}

} // namespace tyndall::rg
