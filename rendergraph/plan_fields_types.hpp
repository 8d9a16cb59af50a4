// The fields of every struct of a plan, listed once: writing, reading and checking a plan walk these lists. Internal.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "rendergraph/limits.hpp"
#include "rendergraph/plan.hpp"
#include "rendergraph/vulkan_names.hpp"

namespace tyndall::rg::json {

/// What an index counts in.
enum class Table : std::uint8_t {
    passes,
    resources,
    accesses,
    variants,
    queues,
    planned,
    batches,
    dependencies,
    attachments,
    heaps
};
inline constexpr std::size_t table_count = 10;

// ---- the enumerations' words, in their order ---------------------------------------------------------------------

inline constexpr std::array<std::string_view, 3> queue_words = {"graphics", "compute", "transfer"};
inline constexpr std::array<std::string_view, 4> keep_words = {"side_effect", "writes_import", "writes_history",
                                                               "feeds_kept_pass"};
inline constexpr std::array<std::string_view, 5> cull_words = {"no_consumer", "consumer_culled", "all_passes_culled",
                                                               "never_used", "other_form"};
inline constexpr std::array<std::string_view, 10> queue_reason_words = {
    "only_queue_that_can", "asked_for",
    "default_graphics",    "asked_for_but_no_such_queue",
    "async_switched_off",  "import_ordered_by_queue",
    "import_not_shared",   "forbidden",
    "overlap_pays",        "earliest_here"};
inline constexpr std::array<std::string_view, 8> decision_words = {"one_queue",
                                                                   "switched_off",
                                                                   "nothing_async_capable",
                                                                   "nothing_measured",
                                                                   "ceiling_below_threshold",
                                                                   "gain_below_threshold",
                                                                   "overlap_pays",
                                                                   "forced"};
inline constexpr std::array<std::string_view, 3> variant_words = {"shortest_frame", "kept_by_hysteresis",
                                                                  "nothing_measured"};
inline constexpr std::array<std::string_view, 9> hazard_words = {
    "read_after_write", "write_after_read", "write_after_write", "layout_change", "aliased_memory",
    "import_entry",     "import_exit",      "frame_entry",       "history_rest"};
inline constexpr std::array<std::string_view, 3> placement_words = {"unplaced", "heap", "history"};
inline constexpr std::array<std::string_view, 8> memory_reason_words = {
    "not_created",   "host_owns",  "outlives_frame", "takes_over",
    "is_taken_over", "never_idle", "better_apart",   "sharing_off"};
inline constexpr std::array<VulkanName, 3> load_names = {{{VK_ATTACHMENT_LOAD_OP_LOAD, "load"},
                                                          {VK_ATTACHMENT_LOAD_OP_CLEAR, "clear"},
                                                          {VK_ATTACHMENT_LOAD_OP_DONT_CARE, "dont care"}}};
inline constexpr std::array<VulkanName, 3> store_names = {{{VK_ATTACHMENT_STORE_OP_STORE, "store"},
                                                           {VK_ATTACHMENT_STORE_OP_DONT_CARE, "dont care"},
                                                           {VK_ATTACHMENT_STORE_OP_NONE, "none"}}};

static_assert(static_cast<std::size_t>(QueueReason::earliest_here) + 1 == queue_reason_words.size());
static_assert(static_cast<std::size_t>(DecisionReason::forced) + 1 == decision_words.size());
static_assert(static_cast<std::size_t>(MemoryReason::sharing_off) + 1 == memory_reason_words.size());
static_assert(static_cast<std::size_t>(Hazard::history_rest) + 1 == hazard_words.size());

// ---- the fields of every struct ----------------------------------------------------------------------------------

template <typename V>
void fields(V& v, QueueInfo& q) {
    v.word("kind", q.kind, queue_words);
    v.value("family", q.family);
    v.value("capabilities", q.capabilities);
}
template <typename V>
void fields(V& v, ImageRange& r) {
    v.value("base_mip", r.base_mip);
    v.value_or_all("mip_count", r.mip_count);
    v.value("base_layer", r.base_layer);
    v.value_or_all("layer_count", r.layer_count);
    v.mask("aspects", r.aspects, aspect_names());
}
template <typename V>
void fields(V& v, BufferRange& r) {
    v.value("offset", r.offset);
    v.value_or_all("size", r.size);
}
template <typename V>
void fields(V& v, Dependency& d) {
    v.index_or_none("producer", d.producer, Table::passes);
    v.index_or_none("consumer", d.consumer, Table::passes);
    v.index("resource", d.resource, Table::resources);
    v.word("hazard", d.hazard, hazard_words);
    v.value("transfers_ownership", d.transfers_ownership);
    v.value("discards", d.discards);
    v.object("image_range", d.image_range);
    v.object("buffer_range", d.buffer_range);
    v.mask("src_stages", d.src_stages, stage_names());
    v.mask("src_access", d.src_access, access_names());
    v.mask("local_stages", d.local_stages, stage_names());
    v.mask("local_access", d.local_access, access_names());
    v.mask("dst_stages", d.dst_stages, stage_names());
    v.mask("dst_access", d.dst_access, access_names());
    v.name("old_layout", d.old_layout, layout_names());
    v.name("new_layout", d.new_layout, layout_names());
    v.index("src_queue", d.src_queue, Table::queues);
    v.index("dst_queue", d.dst_queue, Table::queues);
    v.value_or_all("src_family", d.src_family);
    v.value_or_all("dst_family", d.dst_family);
    v.index_or_none("alias_of", d.alias_of, Table::resources);
    v.index_or_none("orders_for", d.orders_for, Table::resources);
}
template <typename V>
void fields(V& v, AttachmentOps& a) {
    v.index("access", a.access, Table::accesses);
    v.name("load", a.load, load_names);
    v.name("store", a.store, store_names);
}
template <typename V>
void fields(V& v, PlannedPass& p) {
    v.index("pass", p.pass, Table::passes);
    v.index("queue", p.queue, Table::queues);
    v.index("batch", p.batch, Table::batches);
    v.value("slot", p.slot);
    v.word("keep_reason", p.keep_reason, keep_words);
    v.index_or_none("keep_for", p.keep_for,
                    p.keep_reason == KeepReason::feeds_kept_pass ? Table::passes : Table::resources,
                    p.keep_reason == KeepReason::writes_import || p.keep_reason == KeepReason::writes_history);
    v.word("queue_reason", p.queue_reason, queue_reason_words);
    v.run("first_barrier", "barrier_count", p.first_barrier, p.barrier_count, Table::dependencies);
    v.run("first_attachment", "attachment_count", p.first_attachment, p.attachment_count, Table::attachments);
}
template <typename V>
void fields(V& v, CulledPass& c) {
    v.index("pass", c.pass, Table::passes);
    v.word("reason", c.reason, cull_words);
    v.index_or_none("because_of", c.because_of,
                    c.reason == CullReason::consumer_culled ? Table::passes
                    : c.reason == CullReason::other_form    ? Table::variants
                                                            : Table::resources,
                    c.reason == CullReason::consumer_culled || c.reason == CullReason::other_form);
}
template <typename V>
void fields(V& v, CulledResource& c) {
    v.index("resource", c.resource, Table::resources);
    v.word("reason", c.reason, cull_words);
}
template <typename V>
void fields(V& v, BatchWait& w) {
    v.index("batch", w.batch, Table::batches);
    v.mask("stages", w.stages, stage_names());
    v.index_or_none("first_dependency", w.first_dependency, Table::dependencies);
}
template <typename V>
void fields(V& v, Batch& b) {
    v.index("queue", b.queue, Table::queues);
    v.run("first_pass", "pass_count", b.first_pass, b.pass_count, Table::planned);
    v.objects("waits", b.waits);
    v.indices("releases", b.releases, Table::dependencies);
    v.indices("waits_imports", b.waits_imports, Table::resources);
    v.indices("signals_imports", b.signals_imports, Table::resources);
    v.value("signals", b.signals);
}
template <typename V>
void fields(V& v, Placement& p) {
    v.word("kind", p.kind, placement_words);
    v.index_or_none("heap", p.heap, Table::heaps, p.kind == PlacementKind::heap);
    v.value("offset_bytes", p.offset_bytes, most_plan_bytes);
    v.value("size_bytes", p.size_bytes, most_plan_bytes);
    v.mask("image_usage", p.image_usage, image_usage_names());
    v.mask("buffer_usage", p.buffer_usage, buffer_usage_names());
    v.value("concurrent", p.concurrent);
    v.values("families", p.families);
    v.word("reason", p.reason, memory_reason_words);
    v.index_or_none("shares_with", p.shares_with, Table::resources);
    v.value("could_share", p.could_share);
    v.name("resting_layout", p.resting_layout, layout_names());
}
template <typename V>
void fields(V& v, Heap& h) {
    v.value_or_all("memory_type_bits", h.memory_type_bits);
    v.value("size_bytes", h.size_bytes, most_plan_bytes);
}
template <typename V>
void fields(V& v, AsyncDecision& d) {
    v.value("overlaps", d.overlaps);
    v.word("reason", d.reason, decision_words);
    v.value("serial_ns", d.serial_ns, most_ns);
    v.value("overlap_ns", d.overlap_ns, most_ns);
    v.value("lower_bound_ns", d.lower_bound_ns, most_ns);
    v.value("ceiling_ns", d.ceiling_ns, most_ns);
    v.value("threshold_ns", d.threshold_ns, most_ns);
    v.value("kept_by_hysteresis", d.kept_by_hysteresis);
}
template <typename V>
void fields(V& v, VariantDecision& d) {
    v.value("form", d.form);
    v.word("reason", d.reason, variant_words);
    v.values("predicted_ns", d.predicted_ns, most_ns);
}
template <typename V>
void fields(V& v, PlanStatistics& s) {
    v.value("transient_bytes", s.transient_bytes, most_plan_bytes);
    v.value("transient_bytes_unaliased", s.transient_bytes_unaliased, most_plan_bytes);
    v.value("transient_bound_bytes", s.transient_bound_bytes, most_plan_bytes);
    v.value("barrier_count", s.barrier_count);
    v.value("wait_count", s.wait_count);
}
template <typename V>
void fields(V& v, Plan& p) {
    v.objects("queues", p.topology.queues);
    v.object("decision", p.decision);
    v.object("statistics", p.statistics);
    v.objects("passes", p.passes);
    v.objects("batches", p.batches);
    v.objects("dependencies", p.dependencies);
    v.objects("attachments", p.attachments);
    v.objects("placements", p.placements);
    v.objects("heaps", p.heaps);
    v.objects("culled_passes", p.culled_passes);
    v.objects("culled_resources", p.culled_resources);
    v.objects("variants", p.variants);
    v.run("first_exit_barrier", "exit_barrier_count", p.first_exit_barrier, p.exit_barrier_count, Table::dependencies);
    v.value("passes_hash", p.passes_hash);
}

} // namespace tyndall::rg::json
