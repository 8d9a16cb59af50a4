// The cache comes back as it was saved, and whatever else lies in its file is ignored.
#include <array>

#include <gmock/gmock.h>
#include <unistd.h>

#include "engine/file_io.hpp"
#include "engine/pipelines.hpp"
#include "spirv/test_affine.h"
#include "tests/engine/device_fixture.hpp"

namespace tyndall::engine {
namespace {

class Cache : public DeviceTest {
protected:
    void SetUp() override {
        DeviceTest::SetUp();
        std::string name = (std::filesystem::temp_directory_path() / "tyndall-cache-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override {
        std::filesystem::remove_all(folder_);
        DeviceTest::TearDown();
    }
    /// Makes a pipeline with the cache of the folder, which is saved; returns how much was loaded before.
    std::size_t use() {
        const PipelineCache cache = PipelineCache::create(device(), folder_ / "sub").value();
        const std::array bindings = {VkDescriptorSetLayoutBinding{0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
                                                                  VK_SHADER_STAGE_COMPUTE_BIT, nullptr}};
        const auto set = create_set_layout(device(), bindings, true).value();
        const std::array sets = {set.get()};
        const auto layout = create_pipeline_layout(device(), sets, 8, VK_SHADER_STAGE_COMPUTE_BIT).value();
        const std::array constants = {SpecializationConstant{0, 8}};
        EXPECT_TRUE(
            create_compute_pipeline(device(), cache.handle(), layout.get(), test_affine, constants).has_value());
        file_ = cache.file();
        return cache.loaded_bytes();
    }
    std::filesystem::path folder_;
    std::filesystem::path file_;
};

TEST_F(Cache, ComesBack) {
    EXPECT_EQ(use(), 0U);
    const std::size_t size = std::filesystem::file_size(file_);
    const std::size_t loaded = use();
    EXPECT_GE(loaded, sizeof(VkPipelineCacheHeaderVersionOne));
    EXPECT_LT(loaded, size);
    EXPECT_GT(use(), 0U);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file_.parent_path()), {}), 1)
        << "an unfinished file is left";
}

TEST_F(Cache, BrokenFilesAreIgnored) {
    use();
    const std::vector<std::byte> whole = read_file(file_).value();
    for (std::size_t size = 0; size < whole.size(); size += 5) {
        ASSERT_TRUE(replace_file(file_, std::span(whole).first(size)).has_value());
        EXPECT_EQ(PipelineCache::create(device(), file_.parent_path()).value().loaded_bytes(), 0U) << size;
    }
    for (std::size_t i = 0; i < whole.size(); ++i) {
        std::vector<std::byte> changed = whole;
        changed[i] ^= std::byte{16};
        ASSERT_TRUE(replace_file(file_, changed).has_value());
        EXPECT_EQ(PipelineCache::create(device(), file_.parent_path()).value().loaded_bytes(), 0U) << "byte " << i;
        if (i > 128) {
            i += whole.size() / 64;
        }
    }
    ASSERT_TRUE(replace_file(file_, whole).has_value());
    EXPECT_GT(PipelineCache::create(device(), file_.parent_path()).value().loaded_bytes(), 0U) << "the control";
}

TEST_F(Cache, AFolderThatCannotBeMadeIsNoError) {
    ASSERT_TRUE(replace_file(folder_ / "file", {}).has_value());
    const auto cache = PipelineCache::create(device(), folder_ / "file" / "below");
    ASSERT_TRUE(cache.has_value());
    EXPECT_EQ(cache->loaded_bytes(), 0U);
    EXPECT_FALSE(cache->save());
}

} // namespace
} // namespace tyndall::engine
