// Declaring a frame. A pass lists every access; writing makes a new version of a handle, reading names a version, so
// the data flow, and not the order of declaration, is the graph.
//
//   rg::GraphBuilder graph;
//   rg::Image shadow = graph.create_image("sun cascades", {.format = VK_FORMAT_D32_SFLOAT, .extent = {1024, 1024, 1}});
//   graph.add_pass("shadow map", rg::PassKind::graphics)
//       .writes(shadow, rg::Access::depth_attachment, {.clear = rg::clear_depth(0.0F)})
//       .executes([=](rg::PassContext& ctx) { ... });
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <source_location>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "rendergraph/graph_desc.hpp"

namespace tyndall::rg {

class PassContext;
class GraphBuilder;

/// A version of an image of one graph. Small, copyable; a handle of another graph or an overwritten version is caught.
struct Image {
    std::uint32_t graph = 0;
    std::uint32_t resource = none;
    std::uint32_t version = 0;
    [[nodiscard]] bool valid() const { return resource != none; }
};
/// A version of a buffer of one graph.
struct Buffer {
    std::uint32_t graph = 0;
    std::uint32_t resource = none;
    std::uint32_t version = 0;
    [[nodiscard]] bool valid() const { return resource != none; }
};

/// The handle to go on with after the forms of a variant: the content of whichever form is kept.
template <typename Handle>
[[nodiscard]] Handle either(Handle a, Handle b) {
    return a.version < b.version ? b : a;
}

[[nodiscard]] VkClearValue clear_color(float r, float g, float b, float a);
[[nodiscard]] VkClearValue clear_depth(float depth, std::uint32_t stencil = 0);

/// What an access says beside the resource: everything has a default.
struct ImageUse {
    ImageRange range = {};
    std::optional<VkClearValue> clear = {}; ///< attachments only: loaded by a clear
};

/// The callbacks of a frame, by pass index. They own their captures and outlive the builder.
class PassCallbacks {
public:
    PassCallbacks() = default;
    PassCallbacks(PassCallbacks&&) noexcept = default;
    PassCallbacks& operator=(PassCallbacks&&) noexcept = default;
    PassCallbacks(const PassCallbacks&) = delete;
    PassCallbacks& operator=(const PassCallbacks&) = delete;

    [[nodiscard]] bool has(std::uint32_t pass) const { return pass < entries_.size() && entries_[pass] != nullptr; }
    void invoke(std::uint32_t pass, PassContext& ctx) const { entries_[pass]->invoke(ctx); }

private:
    friend class GraphBuilder;
    friend class PassBuilder;
    struct Callback {
        virtual ~Callback() = default;
        virtual void invoke(PassContext& ctx) const = 0;
    };
    std::vector<std::unique_ptr<Callback>> entries_;
};

/// Names the accesses of one pass. Returned by GraphBuilder::add_pass and valid as long as the builder is.
class PassBuilder {
public:
    using Where = std::source_location;

    /// The pass uses the content of this version.
    PassBuilder& reads(Image image, Access access, const ImageRange& range = {}, Where where = Where::current());
    PassBuilder& reads(Buffer buffer, Access access, const BufferRange& range = {}, Where where = Where::current());

    /// The pass gives the range new content; the old one is dead. `image` becomes the new version.
    PassBuilder& writes(Image& image, Access access, const ImageUse& use = {}, Where where = Where::current());
    PassBuilder& writes(Buffer& buffer, Access access, const BufferRange& range = {}, Where where = Where::current());

    /// The pass reads the version and changes it. `image` becomes the new version.
    PassBuilder& modifies(Image& image, Access access, const ImageRange& range = {}, Where where = Where::current());
    PassBuilder& modifies(Buffer& buffer, Access access, const BufferRange& range = {}, Where where = Where::current());

    /// The pass does something that the graph cannot see, so it is never culled.
    PassBuilder& has_side_effect(std::string_view what);
    PassBuilder& on_queue(QueueWish wish);
    /// Where the scheduler must not put it while its queue is automatic.
    PassBuilder& never_on(QueueKind kind);

    /// `callback(PassContext&)` records the pass. It runs after the builder is gone: capture by value, and only handles
    /// and plain data. Capture handles in the same expression, after the accesses that version them.
    template <typename F>
    PassBuilder& executes(F&& callback);

    [[nodiscard]] std::uint32_t index() const { return pass_; }

private:
    friend class GraphBuilder;
    PassBuilder(GraphBuilder& builder, std::uint32_t pass) : builder_(&builder), pass_(pass) {}
    GraphBuilder* builder_;
    std::uint32_t pass_;
};

/// A finished declaration: plain data, and the callbacks beside it.
struct DeclaredGraph {
    GraphDesc desc;
    PassCallbacks callbacks;
};

class GraphBuilder {
public:
    using Where = std::source_location;

    GraphBuilder();
    GraphBuilder(const GraphBuilder&) = delete;
    GraphBuilder& operator=(const GraphBuilder&) = delete;

    [[nodiscard]] Image create_image(std::string_view name, const ImageDesc& desc, Where where = Where::current());
    [[nodiscard]] Buffer create_buffer(std::string_view name, const BufferDesc& desc, Where where = Where::current());
    [[nodiscard]] Image import_image(std::string_view name, const ImageDesc& desc, const ImportDesc& import,
                                     Where where = Where::current());
    [[nodiscard]] Buffer import_buffer(std::string_view name, const BufferDesc& desc, const ImportDesc& import,
                                       Where where = Where::current());

    /// What the frame before left in `current`, a transient of this frame. Read-only. Whether it holds anything is
    /// asked when the pass runs: PassContext::history_valid.
    [[nodiscard]] Image history_of(Image current, Where where = Where::current());
    [[nodiscard]] Buffer history_of(Buffer current, Where where = Where::current());

    /// VK_SHARING_MODE_CONCURRENT instead of ownership transfers.
    void share_between_queues(Image image);
    void share_between_queues(Buffer buffer);

    PassBuilder add_pass(std::string_view name, PassKind kind, Where where = Where::current());

    /// Passes declared from now on are recorded as declared at this injection point (see injection.hpp).
    void set_injection_points(std::vector<std::string> names);
    void begin_injection_point(std::uint32_t point) { point_ = point; }
    void end_injection_point() { point_ = none; }

    /// A part of the frame in alternative forms, of which compile keeps the one with the shortest predicted frame:
    ///
    ///   const std::uint32_t culling = graph.add_variant("light culling");
    ///   rg::Buffer by_depth = lists;
    ///   graph.begin_form(culling, "by depth");  // waits for the depth pre-pass, culls more
    ///   ...writes(by_depth, ...)...
    ///   rg::Buffer by_frustum = lists;
    ///   graph.begin_form(culling, "by frustum"); // overlaps the depth pre-pass, culls less
    ///   ...writes(by_frustum, ...)...
    ///   graph.end_form();
    ///   lists = rg::either(by_depth, by_frustum);
    ///
    /// Passes declared from begin_form on belong to that form, which may also have none. Each form begins from the same
    /// handles, so each needs its own copies.
    [[nodiscard]] std::uint32_t add_variant(std::string_view name, Where where = Where::current());
    void begin_form(std::uint32_t variant, std::string_view form);
    void end_form() {
        variant_ = none;
        form_ = 0;
    }

    /// What a resource was made as; nothing for a handle of another graph.
    [[nodiscard]] std::optional<ImageDesc> describe(Image image) const;
    [[nodiscard]] std::optional<BufferDesc> describe(Buffer buffer) const;

    /// Ends the declaration; the builder is empty afterwards and older handles no longer fit it.
    [[nodiscard]] DeclaredGraph finish();

    void report(Diagnostic diagnostic) { desc_.declaration_errors.push_back(std::move(diagnostic)); }

private:
    friend class PassBuilder;
    template <typename Handle>
    [[nodiscard]] bool check_handle(const Handle& handle, ResourceKind kind, std::uint32_t pass, Where where);
    void report_unknown(bool initialised, std::uint32_t pass, Where where);
    /// The new access, whose range the caller fills in where it lies.
    template <typename Handle>
    AccessDesc& add_access(std::uint32_t pass, Handle& handle, ResourceKind kind, Access access, Direction direction,
                           Where where);
    template <typename Handle>
    Handle add_resource(std::string_view name, ResourceKind kind, Where where);
    void import_last_resource(const ImportDesc& import);
    template <typename Handle>
    Handle add_history(Handle current, ResourceKind kind, Where where);

    std::uint32_t id_;
    std::uint32_t point_ = none;
    std::uint32_t variant_ = none;
    std::uint32_t form_ = 0;
    GraphDesc desc_;
    std::vector<std::uint32_t> latest_version_; ///< per resource
    PassCallbacks callbacks_;
    AccessDesc refused_; ///< what a call with an unknown handle fills in
};

template <typename F>
PassBuilder& PassBuilder::executes(F&& callback) {
    using Function = std::decay_t<F>;
    using Base = PassCallbacks::Callback;
    struct Holder final : Base {
        explicit Holder(F&& f) : function(std::forward<F>(f)) {}
        void invoke(PassContext& ctx) const override { function(ctx); }
        Function function;
    };
    builder_->callbacks_.entries_[pass_] = std::make_unique<Holder>(std::forward<F>(callback));
    return *this;
}

} // namespace tyndall::rg
