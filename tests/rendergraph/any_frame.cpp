#include "tests/rendergraph/any_frame.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>
#include <span>

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
    explicit Maker(std::uint32_t seed) : bits_(seed) {}

    AnyFrame run() {
        make_topology();
        const std::uint32_t resources = 3 + below(6);
        for (std::uint32_t i = 0; i < resources; ++i) {
            make_resource("r" + std::to_string(i));
        }
        if (below(2) == 0) {
            make_history();
        }
        const std::uint32_t passes = 2 + below(14);
        for (std::uint32_t i = 0; i < passes; ++i) {
            if (!snapshots_.empty() && below(6) == 0) {
                make_late_reader(i);
            } else {
                make_pass("p" + std::to_string(i));
            }
        }
        GraphDesc graph = graph_.finish().desc;
        Costs costs = random_costs(static_cast<std::uint32_t>(bits_()), graph.passes.size(), below(4) != 0);
        return {std::move(graph), topology_, std::move(costs)};
    }

private:
    // Only the generator's raw bits are used: distributions differ between standard libraries.
    std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(bits_() % limit); }
    template <typename T>
    T one_of(std::initializer_list<T> values) {
        return values.begin()[below(static_cast<std::uint32_t>(values.size()))];
    }

    void make_topology() {
        constexpr std::uint8_t all = can_graphics | can_compute | can_transfer;
        topology_.queues = {{QueueKind::graphics, 0, all}};
        const std::uint32_t shape = below(6);
        if (shape == 1 || shape >= 3) {
            const std::uint32_t family = below(3) == 0 ? 0 : 1;
            const std::uint8_t can = family == 0 ? all : std::uint8_t{can_compute | can_transfer};
            topology_.queues.push_back({QueueKind::compute, family, can});
        }
        if (shape >= 2 && shape != 4) {
            topology_.queues.push_back({QueueKind::transfer, 2, can_transfer});
        }
    }

    std::uint32_t any_family() { return topology_.queues[below(queue_count())].family; }
    [[nodiscard]] std::uint32_t queue_count() const { return static_cast<std::uint32_t>(topology_.queues.size()); }

    ImageDesc image_desc() {
        ImageDesc desc{.format = one_of({VK_FORMAT_R32_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM,
                                         VK_FORMAT_D32_SFLOAT, VK_FORMAT_D32_SFLOAT_S8_UINT}),
                       .extent = {16, 16, 1}};
        switch (below(4)) {
        case 0: desc.mips = 1 + below(4); break;
        case 1: desc.layers = 1 + below(4); break;
        case 2:
            desc.mips = 1 + below(3);
            desc.layers = 1 + below(3);
            break;
        default:
            if (!is_depth_or_stencil(desc.format)) {
                desc.extent = {32, 16, 1 + below(8)};
                desc.type = VK_IMAGE_TYPE_3D;
            }
        }
        return desc;
    }

    /// What a queue that may be the first to use an import can name as the host's last use.
    VkPipelineStageFlags2 host_stages() {
        return queue_count() == 1
                   ? one_of({VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT})
                   : one_of({VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT});
    }

    ImportDesc import_desc(bool image) {
        ImportDesc import;
        const bool writes_before = below(2) == 0;
        import.waits_semaphore = below(3) == 0;
        if (!import.waits_semaphore && below(3) != 0) {
            import.initial_stages = host_stages();
            import.initial_access = writes_before ? VK_ACCESS_2_MEMORY_WRITE_BIT : VK_ACCESS_2_MEMORY_READ_BIT;
        }
        if (image && below(3) != 0) {
            import.initial_layout = one_of({VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                            VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR});
        }
        const bool has_content = !image || import.initial_layout != VK_IMAGE_LAYOUT_UNDEFINED;
        if (has_content && below(3) == 0) {
            import.initial_family = any_family();
        }
        import.read_only = has_content && below(4) == 0;
        import.has_final = !import.read_only;
        if (import.has_final || below(2) == 0) {
            import.has_final = true;
            import.final_layout = !image
                                      ? VK_IMAGE_LAYOUT_UNDEFINED
                                      : one_of({VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                                VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
            import.signals_semaphore = below(3) == 0;
            if (!import.signals_semaphore) {
                import.final_stages = one_of(
                    {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_PIPELINE_STAGE_2_HOST_BIT, VkPipelineStageFlags2{0}});
                import.final_access = import.final_stages == VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT
                                          ? one_of({VK_ACCESS_2_TRANSFER_READ_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT})
                                      : import.final_stages != 0 ? VK_ACCESS_2_HOST_READ_BIT
                                                                 : VkAccessFlags2{0};
            }
            if (below(4) == 0) {
                import.final_family = any_family();
            }
        }
        return import;
    }

    void make_resource(const std::string& name) {
        Known known;
        bool has_content = false;
        if (below(3) == 0) {
            known.size_bytes = 64ULL * buffer_parts * (1 + below(40));
            known.parts_a = buffer_parts;
            if (below(3) == 0) {
                const ImportDesc import = import_desc(false);
                known.buffer = graph_.import_buffer(name, {.size_bytes = known.size_bytes}, import);
                known.writable = !import.read_only;
                known.is_import = true;
                known.idle_before = import.initial_stages == 0 && !import.waits_semaphore;
                has_content = true;
            } else {
                known.buffer = graph_.create_buffer(name, {.size_bytes = known.size_bytes});
            }
        } else {
            known.image_desc = image_desc();
            known.parts_a = known.image_desc.mips;
            known.parts_b = known.image_desc.layers;
            if (below(4) == 0) {
                const ImportDesc import = import_desc(true);
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
        if (below(5) == 0) {
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
            pass.on_queue(one_of({QueueWish::async_compute, QueueWish::automatic}));
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
        if (!whole && below(2) == 0) {
            box.first_a = below(known.parts_a);
            box.end_a = box.first_a + 1 + below(known.parts_a - box.first_a);
            box.first_b = below(known.parts_b);
            box.end_b = box.first_b + 1 + below(known.parts_b - box.first_b);
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
        if (known.is_image()) {
            const ImageRange range{box.first_a, box.end_a - box.first_a, box.first_b, box.end_b - box.first_b};
            switch (direction) {
            case Direction::read: pass.reads(known.image, access, range); break;
            case Direction::modify: pass.modifies(known.image, access, range); break;
            case Direction::replace:
                ImageUse use{.range = range};
                if (access == Access::color_attachment && below(2) == 0) {
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
        const Access access = accesses[below(static_cast<std::uint32_t>(accesses.size()))];
        Box box;
        if (!pick_box(index, false, box)) {
            return false;
        }
        if (is_attachment(access)) {
            box.first_a = 0;
            box.end_a = 1;
            if (!std::none_of(used_.begin(), used_.end(),
                              [&](const Using& use) { return use.known == index && use.box.meets(box); })) {
                return false;
            }
        }
        Direction direction = Direction::read;
        if (writes) {
            direction = known.is_written(box) && below(2) == 0 && access != Access::resolve_attachment
                            ? Direction::modify
                            : Direction::replace;
        } else if (!known.is_written(box)) {
            return false;
        }
        const bool first_use =
            std::none_of(used_.begin(), used_.end(), [&](const Using& u) { return u.known == index; });
        if (writes && first_use && kind != PassKind::host && below(4) == 0 && known.is_written(box)) {
            snapshots_.push_back(known); // a later pass may ask for what this write overwrites
        }
        declare(pass, known, access, direction, box);
        known.idle_before = false;
        used_.push_back({index, box});
        return true;
    }

    PassKind any_kind() {
        switch (below(10)) {
        case 0: return PassKind::transfer;
        case 1: return below(3) == 0 ? PassKind::host : PassKind::transfer;
        case 2:
        case 3:
        case 4: return PassKind::graphics;
        default: return PassKind::compute;
        }
    }

    QueueWish any_wish(PassKind kind) {
        switch (kind) {
        case PassKind::graphics: return one_of({QueueWish::automatic, QueueWish::graphics});
        case PassKind::compute:
            return one_of(
                {QueueWish::automatic, QueueWish::graphics, QueueWish::async_compute, QueueWish::async_compute});
        case PassKind::transfer:
            return one_of({QueueWish::automatic, QueueWish::async_compute, QueueWish::transfer, QueueWish::transfer});
        case PassKind::host: break;
        }
        return QueueWish::automatic;
    }

    void make_pass(const std::string& name) {
        const PassKind kind = any_kind();
        PassBuilder pass = graph_.add_pass(name, kind);
        pass.on_queue(any_wish(kind));
        used_.clear();
        for (std::uint32_t reads = below(4); reads > 0; --reads) {
            try_access(pass, kind, below(static_cast<std::uint32_t>(known_.size())), false);
        }
        const std::size_t before = used_.size();
        const std::uint32_t writes = 1 + below(2);
        for (std::uint32_t attempt = 0; attempt < 6 && used_.size() < before + writes; ++attempt) {
            try_access(pass, kind, below(static_cast<std::uint32_t>(known_.size())), true);
        }
        if (used_.size() == before || below(8) == 0) {
            pass.has_side_effect("random");
        }
    }

    /// Reads a version that another pass has overwritten since, and touches nothing else: so it can run before that.
    void make_late_reader(std::uint32_t index) {
        Known& past = snapshots_[below(static_cast<std::uint32_t>(snapshots_.size()))];
        const std::vector<Access> accesses = possible(PassKind::compute, past, false);
        const Box box{0, past.parts_a, 0, past.parts_b};
        PassBuilder pass = graph_.add_pass("late " + std::to_string(index), PassKind::compute);
        pass.has_side_effect("reads an old version").on_queue(any_wish(PassKind::compute));
        if (!accesses.empty() && past.is_written(box)) {
            declare(pass, past, accesses[below(static_cast<std::uint32_t>(accesses.size()))], Direction::read, box);
        }
    }

    std::mt19937 bits_;
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

tl::expected<Plan, Diagnostics> plan_of(const AnyFrame& frame) {
    return compile(frame.graph, frame.topology, estimate_memory(frame.graph), {}, frame.costs);
}

std::uint32_t random_graph_count(std::uint32_t otherwise) {
    const char* asked = std::getenv("TYNDALL_RANDOM_GRAPHS");
    return asked == nullptr ? otherwise : static_cast<std::uint32_t>(std::strtoul(asked, nullptr, 10));
}

} // namespace tyndall::rg::test
