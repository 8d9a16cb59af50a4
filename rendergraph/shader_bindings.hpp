// What a compiled shader binds, read from its SPIR-V: the other side of what a pass declares and pushes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>
#include <vulkan/vulkan_core.h>

namespace tyndall::rg {

/// A descriptor that a shader's code touches.
struct ReflectedBinding {
    std::uint32_t set = 0;
    std::uint32_t binding = 0;
    VkDescriptorType type = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    bool may_read = true; ///< false: declared writeonly
    bool may_write = false;
    friend bool operator==(const ReflectedBinding&, const ReflectedBinding&) = default;
};

/// Of all entry points of the module, by set, binding and type; two variables at one binding are one, as merge_bindings
/// makes them. Variables that no function touches are left out. The error says in one sentence why `spirv` is no
/// module.
[[nodiscard]] tl::expected<std::vector<ReflectedBinding>, std::string>
reflect_bindings(std::span<const std::uint32_t> spirv);

/// Adds `more` to `bindings`, which are in the order of set, binding and type and stay so. Two of one set, binding and
/// type become one, that may do what either may: so the shaders of a pipeline are one list.
void merge_bindings(std::vector<ReflectedBinding>& bindings, std::span<const ReflectedBinding> more);

/// Whether pushed bindings are compared with their shaders: when asked for, and always in a debug build.
[[nodiscard]] bool checks_bindings(bool asked);

} // namespace tyndall::rg
