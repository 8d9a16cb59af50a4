// Which device a name means and which queues are opened, on descriptions of devices.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/device_info.hpp"
#include "engine/queue_choice.hpp"

namespace tyndall::engine {
namespace {

using testing::AllOf;
using testing::HasSubstr;

DeviceInfo device(std::uint32_t index, const char* name, VkPhysicalDeviceType type, const char* lacks = "") {
    DeviceInfo info;
    info.index = index;
    info.name = name;
    info.driver = "driver of " + info.name;
    info.type = type;
    info.lacks = lacks;
    return info;
}

const std::vector<DeviceInfo> four = {device(0, "llvmpipe (LLVM 15.0.6)", VK_PHYSICAL_DEVICE_TYPE_CPU),
                                      device(1, "Iris Xe", VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU),
                                      device(2, "Old Card", VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, "dynamicRendering"),
                                      device(3, "New Card", VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU)};

TEST(DeviceChoice, BestIsDiscreteThenIntegratedThenProcessor) {
    EXPECT_EQ(choose_device(four, ""), 3U);
    EXPECT_EQ(choose_device(std::span(four).first(3), ""), 1U) << "the discrete one cannot be used";
    EXPECT_EQ(choose_device(std::span(four).first(1), ""), 0U);
}

TEST(DeviceChoice, NameIsAPartInAnyCaseAndANumberIsAnIndex) {
    EXPECT_EQ(choose_device(four, "LLVMPIPE"), 0U);
    EXPECT_EQ(choose_device(four, "driver of iris"), 1U);
    EXPECT_EQ(choose_device(four, "card"), 3U) << "of two, the one that can be used";
    EXPECT_EQ(choose_device(four, "1"), 1U);
}

TEST(DeviceChoice, ErrorsNameWhatThereIsAndWhatIsLacking) {
    const auto unknown = choose_device(four, "Voodoo");
    ASSERT_FALSE(unknown.has_value());
    EXPECT_EQ(unknown.error().message,
              "There is no device 'Voodoo'; there is 'llvmpipe (LLVM 15.0.6)', 'Iris Xe', 'Old Card', 'New Card'");
    const auto beyond = choose_device(four, "4");
    ASSERT_FALSE(beyond.has_value());
    EXPECT_THAT(beyond.error().message, HasSubstr("no device '4'"));
    const auto old = choose_device(four, "old");
    ASSERT_FALSE(old.has_value());
    EXPECT_THAT(old.error().message, AllOf(HasSubstr("'Old Card'"), HasSubstr("lacks dynamicRendering")));
    const auto only_old = choose_device(std::span(four).subspan(2, 1), "");
    ASSERT_FALSE(only_old.has_value());
    EXPECT_THAT(only_old.error().message, AllOf(HasSubstr("'Old Card'"), HasSubstr("lacks dynamicRendering")));
    const auto none = choose_device({}, "");
    ASSERT_FALSE(none.has_value());
    EXPECT_THAT(none.error().message, HasSubstr("no Vulkan device"));
}

TEST(FeatureTable, NamesEachRequiredFeatureThatIsMissing) {
    FeatureChain offered;
    for (const FeatureSupport& feature : feature_support(offered)) {
        EXPECT_FALSE(feature.supported) << feature.name;
    }
    offered.v13.synchronization2 = offered.v13.dynamicRendering = offered.v13.maintenance4 = VK_TRUE;
    offered.v13.shaderDemoteToHelperInvocation = offered.v13.shaderTerminateInvocation = VK_TRUE;
    offered.v12.hostQueryReset = offered.v12.uniformBufferStandardLayout = VK_TRUE;
    offered.core.features.independentBlend = offered.core.features.shaderStorageImageExtendedFormats = VK_TRUE;
    EXPECT_EQ(lacking_features(feature_support(offered)), "timelineSemaphore, depthClamp");
    offered.v12.timelineSemaphore = offered.core.features.depthClamp = VK_TRUE;
    EXPECT_EQ(lacking_features(feature_support(offered)), "");
}

TEST(FeatureTable, EnablesWhatIsOfferedAndNothingElse) {
    FeatureChain offered;
    offered.core.features.dualSrcBlend = VK_TRUE;
    offered.core.features.robustBufferAccess = VK_TRUE; // not in the table: it costs, and nobody asked
    FeatureChain enabled;
    enable_features(offered, enabled);
    EXPECT_EQ(enabled.core.features.dualSrcBlend, VK_TRUE);
    EXPECT_EQ(enabled.core.features.samplerAnisotropy, VK_FALSE);
    EXPECT_EQ(enabled.core.features.robustBufferAccess, VK_FALSE);
}

constexpr VkQueueFlags g = VK_QUEUE_GRAPHICS_BIT;
constexpr VkQueueFlags c = VK_QUEUE_COMPUTE_BIT;
constexpr VkQueueFlags t = VK_QUEUE_TRANSFER_BIT;

std::string chosen(const std::vector<QueueFamilyInfo>& families) {
    std::string text;
    for (const QueueChoice& queue : choose_queues(families)) {
        text += std::string(rg::name_of(queue.kind)) + " " + std::to_string(queue.family) + "." +
                std::to_string(queue.index) + "; ";
    }
    return text;
}

TEST(QueueChoice, FamiliesOfItsOwnForComputeAndTransfer) {
    // As discrete GPUs have them.
    EXPECT_EQ(chosen({{0, 16, g | c | t, 64}, {1, 2, t, 64}, {2, 8, c | t, 64}}),
              "graphics 0.0; compute 2.0; transfer 1.0; ");
}

TEST(QueueChoice, SecondQueueOfTheSameFamily) {
    EXPECT_EQ(chosen({{0, 2, g | c | t, 64}}), "graphics 0.0; compute 0.1; ");
    EXPECT_EQ(chosen({{0, 4, g | c | t, 64}}), "graphics 0.0; compute 0.1; transfer 0.2; ");
}

TEST(QueueChoice, TransferPrefersAFreeComputeQueue) {
    EXPECT_EQ(chosen({{0, 4, g | c | t, 64}, {1, 2, c | t, 64}}), "graphics 0.0; compute 1.0; transfer 1.1; ");
}

TEST(QueueChoice, OneQueueIsUsedForEverything) {
    EXPECT_EQ(chosen({{0, 1, g | c | t, 64}}), "graphics 0.0; ");
}

TEST(QueueChoice, GraphicsMustCompute) {
    EXPECT_EQ(chosen({{0, 1, g | t, 64}, {1, 1, g | c, 64}}), "graphics 1.0; transfer 0.0; ");
    EXPECT_EQ(chosen({{0, 1, g | t, 64}, {1, 1, c, 64}}), "");
}

TEST(DeviceInfoText, VersionHasThreeParts) {
    EXPECT_EQ(version_text(VK_MAKE_API_VERSION(0, 1, 3, 230)), "1.3.230");
}

} // namespace
} // namespace tyndall::engine
