#include "tests/rendergraph/any_frame.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <span>

#include "tests/rendergraph/any_parts.hpp"
#include "tests/rendergraph/random_costs.hpp"

namespace tyndall::rg::test {
namespace {

constexpr std::uint32_t buffer_parts = 4; ///< byte ranges begin and end at quarters

/// Mips x layers of an image, or quarters of a buffer (in `a`).
struct Box {
    std::uint32_t first_a = 0, end_a = 1, first_b = 0, end_b = 1;
    [[nodiscard]] bool meets(const Box& o) const {
        return first_a < o.end_a && o.first_a < end_a && first_b < o.end_b && o.first_b < end_b;
    }
};

/// A resource as the frame knows it so far.
struct Known {
    Image image;
    Buffer buffer;
    ImageDesc image_desc;
    VkDeviceSize size_bytes = 0;
    std::uint32_t parts_a = 1, parts_b = 1;
    std::vector<bool> written; ///< by part
    bool writable = true;
    bool is_import = false;
    bool idle_before = false; ///< an imported buffer that the host's own code may fill while the frame is recorded

    [[nodiscard]] bool is_image() const { return image.valid(); }
    template <typename F>
    void for_parts(const Box& box, F&& f) {
        for (std::uint32_t a = box.first_a; a < box.end_a; ++a) {
            for (std::uint32_t b = box.first_b; b < box.end_b; ++b) {
                f(a * parts_b + b);
            }
        }
    }
    [[nodiscard]] bool is_written(const Box& box) {
        bool all = true;
        for_parts(box, [&](std::uint32_t part) { all = all && written[part]; });
        return all;
    }
};

class Maker {
public:
    explicit Maker(std::uint32_t seed) : bits_(seed), ban_bits_(~seed) {}

    AnyFrame run() {
        topology_ = any_topology(bits_);
        const std::uint32_t resources = 3 + bits_.below(6);
        for (std::uint32_t i = 0; i < resources; ++i) {
            make_resource("r" + std::to_string(i));
        }
        if (bits_.below(2) == 0) {
            make_history();
        }
        const std::uint32_t passes = 2 + bits_.below(14);
        for (std::uint32_t i = 0; i < passes; ++i) {
            if (bits_.below(12) == 0) {
                make_variant(i);
            } else if (!snapshots_.empty() && bits_.below(6) == 0) {
                make_late_reader(i);
            } else {
                make_pass("p" + std::to_string(i));
            }
        }
        GraphDesc graph = graph_.finish().desc;
        Costs costs = random_costs(bits_.any(), graph.passes.size(), bits_.below(4) != 0);
        return {std::move(graph), topology_, std::move(costs)};
    }

private:
    void make_resource(const std::string& name) {
        Known known;
        bool has_content = false;
        if (bits_.below(3) == 0) {
            known.size_bytes = 64ULL * buffer_parts * (1 + bits_.below(40));
            known.parts_a = buffer_parts;
            if (bits_.below(3) == 0) {
                const ImportDesc import = any_import(bits_, topology_, false);
                known.buffer = graph_.import_buffer(name, {.size_bytes = known.size_bytes}, import);
                known.writable = !import.read_only;
                known.is_import = true;
                known.idle_before = import.initial_stages == 0 && !import.waits_semaphore;
                has_content = true;
            } else {
                known.buffer = graph_.create_buffer(name, {.size_bytes = known.size_bytes});
            }
        } else {
            known.image_desc = any_image(bits_);
            known.parts_a = known.image_desc.mips;
            known.parts_b = known.image_desc.layers;
            if (bits_.below(4) == 0) {
                const ImportDesc import = any_import(bits_, topology_, true);
                known.image = graph_.import_image(name, known.image_desc, import);
                known.writable = !import.read_only;
                known.is_import = true;
                known.idle_before = import.initial_stages == 0 && !import.waits_semaphore;
                has_content = import.initial_layout != VK_IMAGE_LAYOUT_UNDEFINED;
            } else {
                known.image = graph_.create_image(name, known.image_desc);
            }
        }
        known.written.assign(std::size_t{known.parts_a} * known.parts_b, has_content);
        if (bits_.below(5) == 0) {
            known.is_image() ? graph_.share_between_queues(known.image) : graph_.share_between_queues(known.buffer);
        }
        known_.push_back(std::move(known));
    }

    /// A pass writes all of a transient first, so that its history means something.
    void make_history() {
        for (std::size_t i = 0; i < known_.size(); ++i) {
            Known& current = known_[i];
            const bool fresh = std::none_of(current.written.begin(), current.written.end(), [](bool w) { return w; });
            if (!fresh || current.is_import || (current.is_image() && is_depth_or_stencil(current.image_desc.format))) {
                continue;
            }
            Known previous = current;
            previous.writable = false;
            PassBuilder pass = graph_.add_pass("begin", PassKind::compute);
            if (current.is_image()) {
                previous.image = graph_.history_of(current.image);
                pass.writes(current.image, Access::storage_compute);
            } else {
                previous.buffer = graph_.history_of(current.buffer);
                pass.writes(current.buffer, Access::storage_compute);
            }
            pass.on_queue(bits_.one_of({QueueWish::async_compute, QueueWish::automatic}));
            current.written.assign(current.written.size(), true);
            previous.written.assign(previous.written.size(), true);
            known_.push_back(std::move(previous));
            return;
        }
    }

    struct Using {
        std::size_t known;
        Box box;
    };
    /// What of a resource a pass may still touch, at random; false where it touches it already.
    bool pick_box(std::size_t index, bool whole, Box& box) {
        const Known& known = known_[index];
        box = {0, known.parts_a, 0, known.parts_b};
        if (!whole && bits_.below(2) == 0) {
            box.first_a = bits_.below(known.parts_a);
            box.end_a = box.first_a + 1 + bits_.below(known.parts_a - box.first_a);
            box.first_b = bits_.below(known.parts_b);
            box.end_b = box.first_b + 1 + bits_.below(known.parts_b - box.first_b);
        }
        return std::none_of(used_.begin(), used_.end(),
                            [&](const Using& use) { return use.known == index && use.box.meets(box); });
    }

    static std::uint8_t abilities(PassKind kind) {
        switch (kind) {
        case PassKind::graphics: return can_graphics | can_compute | can_transfer;
        case PassKind::compute: return can_compute | can_transfer;
        case PassKind::transfer: return can_transfer;
        case PassKind::host: return can_host;
        }
        return 0;
    }

    static bool is_attachment(Access access) {
        return access == Access::color_attachment || access == Access::depth_attachment ||
               access == Access::resolve_attachment;
    }

    /// The accesses by which such a pass can read or write such a resource.
    std::vector<Access> possible(PassKind kind, const Known& known, bool writes) {
        std::vector<Access> out;
        const bool depth = known.is_image() && is_depth_or_stencil(known.image_desc.format);
        for (std::size_t i = 0; i < access_count; ++i) {
            const auto access = static_cast<Access>(i);
            const AccessInfo& info = access_info(access);
            const VkImageLayout layout = depth ? info.depth_layout : info.color_layout;
            const bool fits = known.is_image() ? layout != VK_IMAGE_LAYOUT_UNDEFINED : info.buffer_usage != 0;
            const bool masks = (writes ? info.write_mask : info.read_mask) != 0;
            const bool drawable = !is_attachment(access) || known.image_desc.type != VK_IMAGE_TYPE_3D;
            if (fits && masks && drawable && (info.needs & abilities(kind)) != 0) {
                out.push_back(access);
            }
        }
        return out;
    }

    void declare(PassBuilder& pass, Known& known, Access access, Direction direction, const Box& box) {
        may_leave_graphics_ = may_leave_graphics_ && !known.is_import;
        if (known.is_image()) {
            may_leave_graphics_ = may_leave_graphics_ && access != Access::transfer_source &&
                                  access != Access::transfer_destination; // it may be a blit
            const ImageRange range{box.first_a, box.end_a - box.first_a, box.first_b, box.end_b - box.first_b};
            switch (direction) {
            case Direction::read: pass.reads(known.image, access, range); break;
            case Direction::modify: pass.modifies(known.image, access, range); break;
            case Direction::replace:
                ImageUse use{.range = range};
                if (access == Access::color_attachment && bits_.below(2) == 0) {
                    use.clear = clear_color(0, 0, 0, 0);
                }
                pass.writes(known.image, access, use);
            }
        } else {
            const VkDeviceSize part = known.size_bytes / buffer_parts;
            const BufferRange range{box.first_a * part, (box.end_a - box.first_a) * part};
            switch (direction) {
            case Direction::read: pass.reads(known.buffer, access, range); break;
            case Direction::modify: pass.modifies(known.buffer, access, range); break;
            case Direction::replace: pass.writes(known.buffer, access, range);
            }
        }
        if (is_write(direction)) {
            known.for_parts(box, [&](std::uint32_t p) { known.written[p] = true; });
        }
    }

    /// An image of several samples, that this pass alone draws to.
    void declare_resolved(PassBuilder& pass, const Known& target, const Box& box) {
        ImageDesc desc = target.image_desc;
        desc.layers = box.end_b - box.first_b;
        desc.mips = 1;
        desc.samples = VK_SAMPLE_COUNT_4_BIT;
        Image drawn = graph_.create_image("drawn " + std::to_string(drawn_count_++), desc);
        pass.writes(drawn, Access::color_attachment);
    }

    bool try_access(PassBuilder& pass, PassKind kind, std::size_t index, bool writes) {
        Known& known = known_[index];
        if (writes && !known.writable) {
            return false;
        }
        // A host pass runs while the frame is recorded: it comes before all that a queue does to the same bytes.
        if (kind == PassKind::host && (!writes || !known.idle_before)) {
            return false;
        }
        const std::vector<Access> accesses = possible(kind, known, writes);
        if (accesses.empty()) {
            return false;
        }
        const Access access = accesses[bits_.below(static_cast<std::uint32_t>(accesses.size()))];
        Box box;
        if (!pick_box(index, false, box)) {
            return false;
        }
        if (is_attachment(access)) {
            box.first_a = 0;
            box.end_a = 1;
            const std::uint32_t layers = box.end_b - box.first_b;
            const bool fits_others = layers_ == 0 || layers == layers_;
            const bool resolves = access == Access::resolve_attachment; // all that is drawn to has several samples
            const bool same_samples = layers_ == 0 || resolves == resolves_;
            if (!fits_others || !same_samples || (access == Access::depth_attachment && has_depth_)) {
                return false;
            }
            if (!std::none_of(used_.begin(), used_.end(),
                              [&](const Using& use) { return use.known == index && use.box.meets(box); })) {
                return false;
            }
        }
        Direction direction = Direction::read;
        if (writes) {
            direction = known.is_written(box) && bits_.below(2) == 0 && access != Access::resolve_attachment
                            ? Direction::modify
                            : Direction::replace;
        } else if (!known.is_written(box)) {
            return false;
        }
        const bool first_use =
            std::none_of(used_.begin(), used_.end(), [&](const Using& u) { return u.known == index; });
        if (writes && first_use && kind != PassKind::host && bits_.below(4) == 0 && known.is_written(box)) {
            snapshots_.push_back(known); // a later pass may ask for what this write overwrites
        }
        if (access == Access::resolve_attachment) {
            declare_resolved(pass, known, box);
        }
        declare(pass, known, access, direction, box);
        known.idle_before = false;
        used_.push_back({index, box});
        layers_ = is_attachment(access) ? box.end_b - box.first_b : layers_;
        has_depth_ = has_depth_ || access == Access::depth_attachment;
        resolves_ = resolves_ || access == Access::resolve_attachment;
        return true;
    }

    void make_pass(const std::string& name) {
        const PassKind kind = any_kind(bits_);
        PassBuilder pass = graph_.add_pass(name, kind);
        const QueueWish wish = any_wish(bits_, kind);
        pass.on_queue(wish);
        used_.clear();
        may_leave_graphics_ = true;
        layers_ = 0;
        has_depth_ = false;
        resolves_ = false;
        for (std::uint32_t reads = bits_.below(4); reads > 0; --reads) {
            try_access(pass, kind, bits_.below(static_cast<std::uint32_t>(known_.size())), false);
        }
        const std::size_t before = used_.size();
        const std::uint32_t writes = 1 + bits_.below(2);
        for (std::uint32_t attempt = 0; attempt < 6 && used_.size() < before + writes; ++attempt) {
            try_access(pass, kind, bits_.below(static_cast<std::uint32_t>(known_.size())), true);
        }
        if (used_.size() == before || bits_.below(8) == 0) {
            pass.has_side_effect("random");
        }
        if (wish == QueueWish::automatic && (kind == PassKind::compute || kind == PassKind::transfer)) {
            forbid(pass, kind);
        }
    }

    /// Kinds of queue, but never all that can run the pass.
    void forbid(PassBuilder& pass, PassKind kind) {
        const bool has_compute = topology_.queues.size() > 1 && topology_.queues[1].kind == QueueKind::compute;
        switch (ban_bits_.below(8)) {
        case 0: pass.never_on(QueueKind::compute); break;
        case 1: pass.never_on(QueueKind::compute).never_on(QueueKind::transfer); break;
        case 2:
        case 3:
            if (has_compute && may_leave_graphics_ && kind == PassKind::compute) {
                pass.never_on(QueueKind::graphics);
            }
            break;
        default: break;
        }
    }

    /// Two forms that give the same resource new content, the second maybe by doing nothing.
    void make_variant(std::uint32_t index) {
        const std::size_t chosen = bits_.below(static_cast<std::uint32_t>(known_.size()));
        if (!known_[chosen].writable || possible(PassKind::compute, known_[chosen], true).empty()) {
            return;
        }
        const Known before = known_[chosen];
        const std::string name = std::to_string(index);
        const std::uint32_t variant = graph_.add_variant("variant " + name);
        std::vector<Known> after;
        for (const char* form : {"a", "b"}) {
            graph_.begin_form(variant, form);
            known_[chosen] = before;
            const std::uint32_t passes = after.empty() ? 1 + bits_.below(2) : bits_.below(3);
            for (std::uint32_t i = 0; i < passes; ++i) {
                PassBuilder pass = graph_.add_pass("form " + name + form + std::to_string(i), PassKind::compute);
                pass.on_queue(any_wish(bits_, PassKind::compute));
                used_.clear();
                if (!try_access(pass, PassKind::compute, chosen, true)) {
                    pass.has_side_effect("random");
                }
            }
            after.push_back(known_[chosen]);
        }
        graph_.end_form();
        Known& known = known_[chosen];
        if (known.is_image()) {
            known.image = either(after[0].image, after[1].image);
        } else {
            known.buffer = either(after[0].buffer, after[1].buffer);
        }
        for (std::size_t part = 0; part < known.written.size(); ++part) {
            known.written[part] = after[0].written[part] && after[1].written[part];
        }
        known.idle_before = after[0].idle_before && after[1].idle_before;
        std::erase_if(snapshots_, [&](const Known& past) { // what one form overwrites, the other may not
            return past.image.resource == known.image.resource && past.buffer.resource == known.buffer.resource;
        });
    }

    /// Reads a version that another pass has overwritten since, and touches nothing else: so it can run before that.
    void make_late_reader(std::uint32_t index) {
        Known& past = snapshots_[bits_.below(static_cast<std::uint32_t>(snapshots_.size()))];
        const std::vector<Access> accesses = possible(PassKind::compute, past, false);
        const Box box{0, past.parts_a, 0, past.parts_b};
        PassBuilder pass = graph_.add_pass("late " + std::to_string(index), PassKind::compute);
        pass.has_side_effect("reads an old version").on_queue(any_wish(bits_, PassKind::compute));
        if (!accesses.empty() && past.is_written(box)) {
            declare(pass, past, accesses[bits_.below(static_cast<std::uint32_t>(accesses.size()))], Direction::read,
                    box);
        }
    }

    Bits bits_;
    Bits ban_bits_; ///< apart, so that the rest of a frame is the same without them
    // Of the pass at hand.
    bool may_leave_graphics_ = true; ///< what it does, any compute queue can
    std::uint32_t layers_ = 0;       ///< of its attachments, 0: it has none yet
    bool has_depth_ = false;         ///< a depth attachment
    bool resolves_ = false;          ///< resolve attachments, and nothing else but what is resolved
    std::uint32_t drawn_count_ = 0;
    QueueTopology topology_;
    GraphBuilder graph_;
    std::vector<Known> known_;
    std::vector<Known> snapshots_; ///< resources at versions that were overwritten
    std::vector<Using> used_;      ///< by the pass at hand
};

} // namespace

AnyFrame any_frame(std::uint32_t seed) {
    return Maker(seed).run();
}

tl::expected<Plan, Diagnostics> plan_of(const AnyFrame& frame, const CompileOptions& options) {
    return compile(frame.graph, frame.topology, estimate_memory(frame.graph), options, frame.costs);
}

std::vector<std::pair<std::string, CompileOptions>> each_switch() {
    return {{"no culling", {.culling = false}},
            {"no aliasing", {.aliasing = false}},
            {"serial", {.async = false}},
            {"no reordering", {.reordering = false}},
            {"full barriers", {.full_barriers = true}}};
}

CompileOptions any_switches(std::uint32_t seed) {
    return {.culling = (seed & 1U) == 0,
            .aliasing = (seed & 2U) == 0,
            .async = (seed & 4U) == 0,
            .reordering = (seed & 8U) == 0,
            .full_barriers = (seed & 16U) != 0};
}

std::uint32_t random_graph_count(std::uint32_t otherwise) {
    const char* asked = std::getenv("TYNDALL_RANDOM_GRAPHS");
    return asked == nullptr ? otherwise : static_cast<std::uint32_t>(std::strtoul(asked, nullptr, 10));
}

} // namespace tyndall::rg::test
