#include "engine/device_features.hpp"

#include <array>

namespace tyndall::engine {
namespace {

struct Row {
    std::string_view name;
    bool required;
    VkBool32& (*of)(FeatureChain&);
};

// clang-format off
constexpr std::array rows = {
    Row{"synchronization2",   true, [](FeatureChain& f) -> VkBool32& { return f.v13.synchronization2; }},
    Row{"dynamicRendering",   true, [](FeatureChain& f) -> VkBool32& { return f.v13.dynamicRendering; }},
    Row{"maintenance4",       true, [](FeatureChain& f) -> VkBool32& { return f.v13.maintenance4; }},
    // What glslang makes of `discard` for Vulkan 1.3.
    Row{"shaderDemoteToHelperInvocation", true, [](FeatureChain& f) -> VkBool32& { return f.v13.shaderDemoteToHelperInvocation; }},
    Row{"shaderTerminateInvocation",      true, [](FeatureChain& f) -> VkBool32& { return f.v13.shaderTerminateInvocation; }},
    Row{"timelineSemaphore",  true, [](FeatureChain& f) -> VkBool32& { return f.v12.timelineSemaphore; }},
    Row{"hostQueryReset",     true, [](FeatureChain& f) -> VkBool32& { return f.v12.hostQueryReset; }},
    Row{"uniformBufferStandardLayout", true, [](FeatureChain& f) -> VkBool32& { return f.v12.uniformBufferStandardLayout; }},
    Row{"independentBlend",   true, [](FeatureChain& f) -> VkBool32& { return f.core.features.independentBlend; }},
    Row{"depthClamp",         true, [](FeatureChain& f) -> VkBool32& { return f.core.features.depthClamp; }},
    Row{"shaderStorageImageExtendedFormats", true, [](FeatureChain& f) -> VkBool32& { return f.core.features.shaderStorageImageExtendedFormats; }},
    Row{"fragmentStoresAndAtomics", false, [](FeatureChain& f) -> VkBool32& { return f.core.features.fragmentStoresAndAtomics; }},
    Row{"vertexPipelineStoresAndAtomics", false, [](FeatureChain& f) -> VkBool32& { return f.core.features.vertexPipelineStoresAndAtomics; }},
    Row{"samplerAnisotropy",  false, [](FeatureChain& f) -> VkBool32& { return f.core.features.samplerAnisotropy; }},
    Row{"dualSrcBlend",       false, [](FeatureChain& f) -> VkBool32& { return f.core.features.dualSrcBlend; }},
    Row{"depthBiasClamp",     false, [](FeatureChain& f) -> VkBool32& { return f.core.features.depthBiasClamp; }},
    Row{"multiDrawIndirect",  false, [](FeatureChain& f) -> VkBool32& { return f.core.features.multiDrawIndirect; }},
    Row{"drawIndirectFirstInstance", false, [](FeatureChain& f) -> VkBool32& { return f.core.features.drawIndirectFirstInstance; }},
    Row{"imageCubeArray",     false, [](FeatureChain& f) -> VkBool32& { return f.core.features.imageCubeArray; }},
    Row{"multiview",          false, [](FeatureChain& f) -> VkBool32& { return f.v11.multiview; }},
    Row{"shaderDrawParameters", false, [](FeatureChain& f) -> VkBool32& { return f.v11.shaderDrawParameters; }},
    Row{"scalarBlockLayout",  false, [](FeatureChain& f) -> VkBool32& { return f.v12.scalarBlockLayout; }},
    Row{"drawIndirectCount",  false, [](FeatureChain& f) -> VkBool32& { return f.v12.drawIndirectCount; }},
};
// clang-format on

} // namespace

std::vector<FeatureSupport> feature_support(FeatureChain& offered) {
    std::vector<FeatureSupport> support;
    for (const Row& row : rows) {
        support.push_back({row.name, row.required, row.of(offered) == VK_TRUE});
    }
    return support;
}

void enable_features(FeatureChain& offered, FeatureChain& enabled) {
    for (const Row& row : rows) {
        row.of(enabled) = row.of(offered);
    }
}

std::string lacking_features(const std::vector<FeatureSupport>& support) {
    std::string names;
    for (const FeatureSupport& feature : support) {
        if (feature.required && !feature.supported) {
            names += (names.empty() ? "" : ", ") + std::string(feature.name);
        }
    }
    return names;
}

} // namespace tyndall::engine
