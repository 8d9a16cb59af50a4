// Compares what a pass pushes, and so what it declared, with what its shader does to it.
#include <algorithm>

#include "rendergraph/executor_state.hpp"

namespace tyndall::rg {
namespace {

std::string_view words_of(VkDescriptorType type) {
    switch (type) {
    case VK_DESCRIPTOR_TYPE_SAMPLER: return "a sampler";
    case VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER: return "a combined image sampler";
    case VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE: return "a sampled image";
    case VK_DESCRIPTOR_TYPE_STORAGE_IMAGE: return "a storage image";
    case VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER: return "a uniform texel buffer";
    case VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER: return "a storage texel buffer";
    case VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER: return "a uniform buffer";
    case VK_DESCRIPTOR_TYPE_STORAGE_BUFFER: return "a storage buffer";
    case VK_DESCRIPTOR_TYPE_INPUT_ATTACHMENT: return "an input attachment";
    case VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR: return "an acceleration structure";
    default: return "a descriptor of another type";
    }
}

/// 0: a descriptor that shaders only read, whatever was declared.
VkFlags usage_of(VkDescriptorType type) {
    switch (type) {
    case VK_DESCRIPTOR_TYPE_STORAGE_IMAGE: return VK_IMAGE_USAGE_STORAGE_BIT;
    case VK_DESCRIPTOR_TYPE_STORAGE_BUFFER: return VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    default: return 0;
    }
}

} // namespace

void ExecutorState::check_bindings(std::uint32_t pass, std::uint32_t set, std::span<const Binding> pushed,
                                   std::span<const ReflectedBinding> shader) {
    for (const ReflectedBinding& expected : shader) {
        if (expected.set == set) {
            const auto found = std::find_if(pushed.begin(), pushed.end(), [&](const Binding& binding) {
                return binding.binding == expected.binding;
            });
            check_binding(pass, found == pushed.end() ? nullptr : &*found, expected);
        }
    }
}

void ExecutorState::check_binding(std::uint32_t pass, const Binding* pushed, const ReflectedBinding& expected) {
    const auto place = [&] {
        return " at binding " + std::to_string(expected.binding) + " of set " + std::to_string(expected.set);
    };
    if (pushed == nullptr) {
        report_undeclared(pass, std::string(words_of(expected.type)) + place() + " in its shader, but pushes none");
        return;
    }
    const bool of_graph = pushed->resource < work.graph->resources.size();
    const auto name = [&] {
        return of_graph ? "'" + work.graph->resources[pushed->resource].name + "'" : "a descriptor of its own";
    };
    if (pushed->type != expected.type) {
        report_undeclared(pass, name() + place() + " as " + std::string(words_of(pushed->type)) +
                                    ", but its shader has " + std::string(words_of(expected.type)) + " there");
        return;
    }
    if (!of_graph || usage_of(pushed->type) == 0) {
        return;
    }
    const DeclaredDirections declared =
        declared_directions(pass, pushed->resource, pushed->version, usage_of(pushed->type));
    if (expected.may_write && declared.reads && !declared.writes) {
        report_undeclared(pass,
                          name() + place() + " in a shader that may write it, but declared that it only reads it");
    }
    if (expected.may_read && declared.writes && !declared.reads) {
        report_undeclared(pass,
                          name() + place() + " in a shader that may read it, but declared that it only writes it");
    }
}

} // namespace tyndall::rg
