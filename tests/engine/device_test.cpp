// The device itself: what it is, what its validation sees, its clocks and its errors.
#include <chrono>
#include <string>

#include <gmock/gmock.h>

#include "tests/engine/device_fixture.hpp"

namespace tyndall::engine {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

TEST_F(DeviceTest, DescribesItself) {
    const DeviceInfo& info = device().info();
    EXPECT_FALSE(info.name.empty());
    EXPECT_GE(info.api_version, VK_API_VERSION_1_3);
    EXPECT_EQ(info.lacks, "");
    EXPECT_GE(info.max_push_descriptors, 32U) << "the least that VK_KHR_push_descriptor allows";
    ASSERT_FALSE(info.heaps.empty());
    EXPECT_GT(info.heaps.front().size_bytes, 1U << 20U);
    ASSERT_FALSE(device().queues().empty());
    EXPECT_EQ(device().graphics_queue().kind, rg::QueueKind::graphics);
    for (const rg::DeviceQueue& queue : device().queues()) {
        EXPECT_NE(queue.queue, VK_NULL_HANDLE);
    }
    EXPECT_EQ(device().is_lavapipe(), info.name.find("llvmpipe") != std::string::npos);
    if (device().is_lavapipe()) {
        EXPECT_NE(info.driver.find("Mesa " + std::to_string(info.mesa_major) + "."), std::string::npos);
    }
    EXPECT_EQ(device().executor_info(true).timestamps_need_full_barrier, device().is_lavapipe());
}

TEST_F(DeviceTest, NamedDeviceIsThatDevice) {
    const std::vector<DeviceInfo> all = list_devices(instance());
    for (const DeviceInfo& info : all) {
        if (!info.lacks.empty()) {
            continue;
        }
        const auto made = Device::create(instance(), std::to_string(info.index));
        ASSERT_TRUE(made.has_value()) << made.error().message;
        EXPECT_EQ(made->info().index, info.index);
        EXPECT_EQ(made->info().driver, info.driver);
    }
}

TEST_F(DeviceTest, UnknownNameIsAnErrorWithTheNamesThatThereAre) {
    const auto made = Device::create(instance(), "no such device");
    ASSERT_FALSE(made.has_value());
    EXPECT_THAT(made.error().message, AllOf(HasSubstr("'no such device'"), HasSubstr(device().info().name)));
}

TEST_F(DeviceTest, UnknownExtensionIsAnError) {
    const auto made = Device::create(instance(), {}, {"VK_TYNDALL_no_such_extension"});
    ASSERT_FALSE(made.has_value());
    EXPECT_THAT(made.error().message, HasSubstr("extension"));
}

// The negative controls: without them a silent log would say nothing.
TEST_F(DeviceTest, ValidationLogHearsAMisuse) {
    const VkBufferCreateInfo empty{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                   .size = 0,
                                   .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                   .sharingMode = VK_SHARING_MODE_EXCLUSIVE};
    VkBuffer buffer = VK_NULL_HANDLE;
    if (vk().CreateBuffer(device().handle(), &empty, nullptr, &buffer) == VK_SUCCESS) {
        vk().DestroyBuffer(device().handle(), buffer, nullptr);
    }
    EXPECT_THAT(take_errors(), Contains(HasSubstr("VUID-VkBufferCreateInfo-size-00912")));
}

TEST_F(DeviceTest, ValidationLogHearsAMissingBarrier) {
    const Buffer a = mapped_buffer(256, VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    const Buffer b = mapped_buffer(256, VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    const VkBufferCopy all{0, 0, 256};
    for (const bool with_barrier : {true, false}) {
        OneTimeCommands work = commands();
        vk().CmdFillBuffer(work.cmd(), a.handle(), 0, 256, 7);
        if (with_barrier) {
            work.full_barrier();
        }
        vk().CmdCopyBuffer(work.cmd(), a.handle(), b.handle(), 1, &all);
        ASSERT_TRUE(work.finish().has_value());
        if (with_barrier) {
            EXPECT_THAT(take_errors(), testing::IsEmpty());
        } else {
            EXPECT_THAT(take_errors(), Contains(HasSubstr("SYNC-HAZARD-READ-AFTER-WRITE")));
        }
    }
}

TEST(VulkanInstanceTest, WithoutValidationNothingIsHeard) {
    const auto instance = VulkanInstance::create(Validation::off);
    ASSERT_TRUE(instance.has_value()) << instance.error().message;
    EXPECT_TRUE(instance->log().errors().empty());
    EXPECT_TRUE(Device::create(*instance).has_value());
}

TEST(VulkanInstanceTest, UnknownExtensionIsAnError) {
    const auto instance = VulkanInstance::create(Validation::off, {"VK_TYNDALL_no_such_extension"});
    ASSERT_FALSE(instance.has_value());
    EXPECT_THAT(instance.error().message, HasSubstr("VK_TYNDALL_no_such_extension"));
}

TEST_F(DeviceTest, TimestampsLieWithinTheHostsOwnMeasure) {
    ASSERT_GT(device().graphics_queue().timestamp_valid_bits, 0U);
    const VkQueryPoolCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO, .queryType = VK_QUERY_TYPE_TIMESTAMP, .queryCount = 2};
    VkQueryPool pool = VK_NULL_HANDLE;
    ASSERT_EQ(vk().CreateQueryPool(device().handle(), &info, nullptr, &pool), VK_SUCCESS);
    const Buffer buffer = mapped_buffer(16U << 20U, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    const auto before = std::chrono::steady_clock::now();
    OneTimeCommands work = commands();
    vk().CmdResetQueryPool(work.cmd(), pool, 0, 2);
    vk().CmdWriteTimestamp2(work.cmd(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool, 0);
    work.full_barrier();
    vk().CmdFillBuffer(work.cmd(), buffer.handle(), 0, VK_WHOLE_SIZE, 1);
    work.full_barrier();
    vk().CmdWriteTimestamp2(work.cmd(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool, 1);
    ASSERT_TRUE(work.finish().has_value());
    const std::chrono::duration<double, std::nano> host = std::chrono::steady_clock::now() - before;
    std::array<std::uint64_t, 2> ticks{};
    EXPECT_EQ(vk().GetQueryPoolResults(device().handle(), pool, 0, 2, sizeof(ticks), ticks.data(), sizeof(ticks[0]),
                                       VK_QUERY_RESULT_64_BIT),
              VK_SUCCESS);
    const double device_ns =
        static_cast<double>(ticks[1] - ticks[0]) * static_cast<double>(device().properties().limits.timestampPeriod);
    EXPECT_GT(device_ns, 0.0);
    EXPECT_LE(device_ns, host.count());
    vk().DestroyQueryPool(device().handle(), pool, nullptr);
}

} // namespace
} // namespace tyndall::engine
