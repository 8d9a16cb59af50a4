// Whether two declared frames say the same, field by field; places in source code apart.
#pragma once

#include <algorithm>

#include <gtest/gtest.h>

#include "rendergraph/json.hpp"

namespace tyndall::rg::test {

inline void expect_same(const ResourceDesc& a, const ResourceDesc& b) {
    SCOPED_TRACE("resource " + a.name);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.lifetime, b.lifetime);
    EXPECT_EQ(a.concurrent, b.concurrent);
    EXPECT_EQ(a.has_history, b.has_history);
    EXPECT_EQ(a.import, b.import);
    EXPECT_EQ(a.history_of, b.history_of);
    EXPECT_EQ(a.buffer.size_bytes, b.buffer.size_bytes);
    EXPECT_EQ(a.buffer.extra_usage, b.buffer.extra_usage);
    EXPECT_EQ(a.image.format, b.image.format);
    EXPECT_EQ(a.image.extent.width, b.image.extent.width);
    EXPECT_EQ(a.image.extent.height, b.image.extent.height);
    EXPECT_EQ(a.image.extent.depth, b.image.extent.depth);
    EXPECT_EQ(a.image.mips, b.image.mips);
    EXPECT_EQ(a.image.layers, b.image.layers);
    EXPECT_EQ(a.image.type, b.image.type);
    EXPECT_EQ(a.image.samples, b.image.samples);
    EXPECT_EQ(a.image.flags, b.image.flags);
    EXPECT_EQ(a.image.extra_usage, b.image.extra_usage);
}

inline void expect_same(const ImportDesc& a, const ImportDesc& b) {
    EXPECT_EQ(a.initial_layout, b.initial_layout);
    EXPECT_EQ(a.initial_stages, b.initial_stages);
    EXPECT_EQ(a.initial_access, b.initial_access);
    EXPECT_EQ(a.initial_family, b.initial_family);
    EXPECT_EQ(a.waits_semaphore, b.waits_semaphore);
    EXPECT_EQ(a.has_final, b.has_final);
    EXPECT_EQ(a.final_layout, b.final_layout);
    EXPECT_EQ(a.final_stages, b.final_stages);
    EXPECT_EQ(a.final_access, b.final_access);
    EXPECT_EQ(a.final_family, b.final_family);
    EXPECT_EQ(a.signals_semaphore, b.signals_semaphore);
    EXPECT_EQ(a.read_only, b.read_only);
}

inline void expect_same(const PassDesc& a, const PassDesc& b) {
    SCOPED_TRACE("pass " + a.name);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.wish, b.wish);
    EXPECT_EQ(a.forbidden_queues, b.forbidden_queues);
    EXPECT_EQ(a.variant, b.variant);
    EXPECT_EQ(a.form, b.form);
    EXPECT_EQ(a.has_side_effect, b.has_side_effect);
    EXPECT_EQ(a.side_effect, b.side_effect);
    EXPECT_EQ(a.first_access, b.first_access);
    EXPECT_EQ(a.access_count, b.access_count);
    EXPECT_EQ(a.point, b.point);
}

inline void expect_same(const AccessDesc& a, const AccessDesc& b) {
    EXPECT_EQ(a.pass, b.pass);
    EXPECT_EQ(a.resource, b.resource);
    EXPECT_EQ(a.version, b.version);
    EXPECT_EQ(a.access, b.access);
    EXPECT_EQ(a.direction, b.direction);
    EXPECT_EQ(a.clears, b.clears);
    EXPECT_TRUE(std::ranges::equal(a.clear.color.uint32, b.clear.color.uint32));
    EXPECT_EQ(a.image_range, b.image_range);
    EXPECT_EQ(a.buffer_range, b.buffer_range);
}

template <typename T>
void expect_same_list(const std::vector<T>& a, const std::vector<T>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        SCOPED_TRACE("number " + std::to_string(i));
        expect_same(a[i], b[i]);
    }
}

inline void expect_same(const Frame& a, const Frame& b) {
    EXPECT_EQ(a.about, b.about);
    expect_same_list(a.graph.resources, b.graph.resources);
    expect_same_list(a.graph.imports, b.graph.imports);
    expect_same_list(a.graph.passes, b.graph.passes);
    expect_same_list(a.graph.accesses, b.graph.accesses);
    EXPECT_EQ(a.graph.points, b.graph.points);
    ASSERT_EQ(a.graph.variants.size(), b.graph.variants.size());
    for (std::size_t i = 0; i < a.graph.variants.size(); ++i) {
        EXPECT_EQ(a.graph.variants[i].name, b.graph.variants[i].name);
        EXPECT_EQ(a.graph.variants[i].forms, b.graph.variants[i].forms);
    }
    ASSERT_EQ(a.topology.queues.size(), b.topology.queues.size());
    for (std::size_t i = 0; i < a.topology.queues.size(); ++i) {
        EXPECT_EQ(a.topology.queues[i].kind, b.topology.queues[i].kind);
        EXPECT_EQ(a.topology.queues[i].family, b.topology.queues[i].family);
        EXPECT_EQ(a.topology.queues[i].capabilities, b.topology.queues[i].capabilities);
    }
    EXPECT_EQ(a.costs, b.costs);
}

} // namespace tyndall::rg::test
