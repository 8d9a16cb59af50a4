#include "rendergraph/graph.hpp"

#include <algorithm>

namespace tyndall::rg {
namespace {

// Distinguishes handles of different builders, of one builder before and after finish(), and of builders that stand one
// after the other at the same address. The value reaches no plan, so that it may differ from run to run.
std::uint32_t next_identity(const void* builder, std::uint32_t previous) {
    thread_local std::uint32_t built = 0;
    built += previous == 0 ? 1 : 0;
    const auto address = reinterpret_cast<std::uintptr_t>(builder);
    const auto mixed = static_cast<std::uint32_t>((address >> 4U) * 2654435761U) + built * 0x85ebca6bU;
    const std::uint32_t next = previous == 0 ? mixed : previous + 1;
    return next == 0 ? 1 : next;
}

/// What the last graph of the thread held: the next one will be much the same, and so grows without moving.
struct Sizes {
    std::size_t resources = 64; // what most frames stay below
    std::size_t passes = 64;
    std::size_t accesses = 256;
};
thread_local Sizes expected;

} // namespace

std::string_view name_of(PassKind kind) {
    switch (kind) {
    case PassKind::graphics: return "graphics";
    case PassKind::compute: return "compute";
    case PassKind::transfer: return "transfer";
    case PassKind::host: return "host";
    }
    return "";
}

std::string_view name_of(QueueKind kind) {
    switch (kind) {
    case QueueKind::graphics: return "graphics";
    case QueueKind::compute: return "compute";
    case QueueKind::transfer: return "transfer";
    }
    return "";
}

VkClearValue clear_color(float r, float g, float b, float a) {
    VkClearValue value = {};
    value.color.float32[0] = r;
    value.color.float32[1] = g;
    value.color.float32[2] = b;
    value.color.float32[3] = a;
    return value;
}

VkClearValue clear_depth(float depth, std::uint32_t stencil) {
    VkClearValue value = {};
    value.depthStencil = {depth, stencil};
    return value;
}

GraphBuilder::GraphBuilder() : id_(next_identity(this, 0)) {
    desc_.resources.reserve(expected.resources);
    latest_version_.reserve(expected.resources);
    desc_.passes.reserve(expected.passes);
    callbacks_.entries_.reserve(expected.passes);
    desc_.accesses.reserve(expected.accesses);
}

template <typename Handle>
Handle GraphBuilder::add_resource(std::string_view name, ResourceKind kind, Where where) {
    const auto index = static_cast<std::uint32_t>(desc_.resources.size());
    ResourceDesc& resource = desc_.resources.emplace_back();
    resource.name = name;
    resource.kind = kind;
    resource.where = where;
    latest_version_.push_back(0);
    return Handle{id_, index, 0};
}

Image GraphBuilder::create_image(std::string_view name, const ImageDesc& desc, Where where) {
    const auto image = add_resource<Image>(name, ResourceKind::image, where);
    desc_.resources.back().image = desc;
    return image;
}

Buffer GraphBuilder::create_buffer(std::string_view name, const BufferDesc& desc, Where where) {
    const auto buffer = add_resource<Buffer>(name, ResourceKind::buffer, where);
    desc_.resources.back().buffer = desc;
    return buffer;
}

Image GraphBuilder::import_image(std::string_view name, const ImageDesc& desc, const ImportDesc& import, Where where) {
    const Image image = create_image(name, desc, where);
    import_last_resource(import);
    return image;
}

Buffer GraphBuilder::import_buffer(std::string_view name, const BufferDesc& desc, const ImportDesc& import,
                                   Where where) {
    const Buffer buffer = create_buffer(name, desc, where);
    import_last_resource(import);
    return buffer;
}

void GraphBuilder::import_last_resource(const ImportDesc& import) {
    ResourceDesc& resource = desc_.resources.back();
    resource.lifetime = ResourceLifetime::imported;
    resource.import = static_cast<std::uint32_t>(desc_.imports.size());
    desc_.imports.push_back(import);
}

template <typename Handle>
Handle GraphBuilder::add_history(Handle current, ResourceKind kind, Where where) {
    if (!check_handle(current, kind, none, where)) {
        return Handle{};
    }
    ResourceDesc& source = desc_.resources[current.resource];
    if (source.lifetime != ResourceLifetime::transient || source.has_history) {
        report({.code = DiagnosticCode::history_misuse,
                .resource = source.name,
                .message = source.has_history
                               ? "'" + source.name + "' already has a history; use the first handle"
                               : "'" + source.name + "' is not a transient; only transients have a history",
                .where = where,
                .other_where = source.where});
        return Handle{};
    }
    source.has_history = true;
    const ResourceDesc of = source; // which moves as the list grows
    const auto history = add_resource<Handle>(of.name + " (previous frame)", kind, where);
    ResourceDesc& added = desc_.resources.back();
    added.lifetime = ResourceLifetime::history;
    added.concurrent = of.concurrent;
    added.image = of.image;
    added.buffer = of.buffer;
    added.history_of = current.resource;
    return history;
}

Image GraphBuilder::history_of(Image current, Where where) {
    return add_history(current, ResourceKind::image, where);
}
Buffer GraphBuilder::history_of(Buffer current, Where where) {
    return add_history(current, ResourceKind::buffer, where);
}

void GraphBuilder::share_between_queues(Image image) {
    if (check_handle(image, ResourceKind::image, none, Where::current())) {
        desc_.resources[image.resource].concurrent = true;
    }
}
void GraphBuilder::share_between_queues(Buffer buffer) {
    if (check_handle(buffer, ResourceKind::buffer, none, Where::current())) {
        desc_.resources[buffer.resource].concurrent = true;
    }
}

PassBuilder GraphBuilder::add_pass(std::string_view name, PassKind kind, Where where) {
    const auto index = static_cast<std::uint32_t>(desc_.passes.size());
    PassDesc& pass = desc_.passes.emplace_back();
    pass.name = name;
    pass.kind = kind;
    pass.variant = variant_;
    pass.form = form_;
    pass.point = point_;
    pass.where = where;
    callbacks_.entries_.emplace_back();
    return {*this, index};
}

std::uint32_t GraphBuilder::add_variant(std::string_view name, Where where) {
    desc_.variants.push_back({.name = std::string(name), .where = where});
    return static_cast<std::uint32_t>(desc_.variants.size() - 1);
}

void GraphBuilder::begin_form(std::uint32_t variant, std::string_view form) {
    std::vector<std::string>& forms = desc_.variants[variant].forms;
    variant_ = variant;
    form_ = static_cast<std::uint32_t>(forms.size());
    forms.emplace_back(form);
}

void GraphBuilder::set_injection_points(std::vector<std::string> names) {
    desc_.points = std::move(names);
}

std::optional<ImageDesc> GraphBuilder::describe(Image image) const {
    const bool known = image.graph == id_ && image.resource < desc_.resources.size();
    return known ? std::optional(desc_.resources[image.resource].image) : std::nullopt;
}
std::optional<BufferDesc> GraphBuilder::describe(Buffer buffer) const {
    const bool known = buffer.graph == id_ && buffer.resource < desc_.resources.size();
    return known ? std::optional(desc_.resources[buffer.resource].buffer) : std::nullopt;
}

template <typename Handle>
bool GraphBuilder::check_handle(const Handle& handle, ResourceKind kind, std::uint32_t pass, Where where) {
    const bool known = handle.graph == id_ && handle.resource < desc_.resources.size() &&
                       desc_.resources[handle.resource].kind == kind &&
                       handle.version <= latest_version_[handle.resource];
    if (!known) {
        report_unknown(handle.valid(), pass, where);
    }
    return known;
}

void GraphBuilder::report_unknown(bool initialised, std::uint32_t pass, Where where) {
    const std::string pass_name = pass == none ? "" : desc_.passes[pass].name;
    report({.code = DiagnosticCode::foreign_handle,
            .pass = pass_name,
            .message = (pass == none ? std::string("A handle that ") : "Pass '" + pass_name + "' uses a handle that ") +
                       (initialised ? "comes from another graph or an earlier frame; declare it here"
                                    : "was never initialised; create or import the resource first"),
            .where = where,
            .other_where = pass == none ? where : desc_.passes[pass].where});
}

template <typename Handle>
AccessDesc& GraphBuilder::add_access(std::uint32_t pass, Handle& handle, ResourceKind kind, Access access,
                                     Direction direction, Where where) {
    if (!check_handle(handle, kind, pass, where)) {
        return refused_ = {};
    }
    AccessDesc& added = desc_.accesses.emplace_back();
    added.pass = pass;
    added.resource = handle.resource;
    added.access = access;
    added.direction = direction;
    added.where = where;
    if (is_write(direction)) {
        // A write from an overwritten version gives the version that already has a writer: validate reports both.
        ++handle.version;
        latest_version_[handle.resource] = std::max(latest_version_[handle.resource], handle.version);
    }
    added.version = handle.version;
    return added;
}

PassBuilder& PassBuilder::reads(Image image, Access access, const ImageRange& range, Where where) {
    builder_->add_access(pass_, image, ResourceKind::image, access, Direction::read, where).image_range = range;
    return *this;
}
PassBuilder& PassBuilder::reads(Buffer buffer, Access access, const BufferRange& range, Where where) {
    builder_->add_access(pass_, buffer, ResourceKind::buffer, access, Direction::read, where).buffer_range = range;
    return *this;
}
PassBuilder& PassBuilder::writes(Image& image, Access access, const ImageUse& use, Where where) {
    AccessDesc& added = builder_->add_access(pass_, image, ResourceKind::image, access, Direction::replace, where);
    added.image_range = use.range;
    added.clears = use.clear.has_value();
    added.clear = use.clear.value_or(VkClearValue{});
    return *this;
}
PassBuilder& PassBuilder::writes(Buffer& buffer, Access access, const BufferRange& range, Where where) {
    builder_->add_access(pass_, buffer, ResourceKind::buffer, access, Direction::replace, where).buffer_range = range;
    return *this;
}
PassBuilder& PassBuilder::modifies(Image& image, Access access, const ImageRange& range, Where where) {
    builder_->add_access(pass_, image, ResourceKind::image, access, Direction::modify, where).image_range = range;
    return *this;
}
PassBuilder& PassBuilder::modifies(Buffer& buffer, Access access, const BufferRange& range, Where where) {
    builder_->add_access(pass_, buffer, ResourceKind::buffer, access, Direction::modify, where).buffer_range = range;
    return *this;
}

PassBuilder& PassBuilder::has_side_effect(std::string_view what) {
    PassDesc& pass = builder_->desc_.passes[pass_];
    pass.has_side_effect = true;
    pass.side_effect = what;
    return *this;
}
PassBuilder& PassBuilder::on_queue(QueueWish wish) {
    builder_->desc_.passes[pass_].wish = wish;
    return *this;
}

PassBuilder& PassBuilder::never_on(QueueKind kind) {
    builder_->desc_.passes[pass_].forbidden_queues |= queue_bit(kind);
    return *this;
}

DeclaredGraph GraphBuilder::finish() {
    // Accesses were appended in order of the calls; two pass builders in use at once interleave them.
    const auto by_pass = [](const AccessDesc& a, const AccessDesc& b) { return a.pass < b.pass; };
    if (!std::is_sorted(desc_.accesses.begin(), desc_.accesses.end(), by_pass)) {
        std::stable_sort(desc_.accesses.begin(), desc_.accesses.end(), by_pass);
    }
    for (std::uint32_t i = 0; i < desc_.accesses.size(); ++i) {
        PassDesc& pass = desc_.passes[desc_.accesses[i].pass];
        if (pass.access_count++ == 0) {
            pass.first_access = i;
        }
    }
    expected = {desc_.resources.size(), desc_.passes.size(), desc_.accesses.size()};
    DeclaredGraph declared{std::move(desc_), std::move(callbacks_)};
    desc_ = {};
    callbacks_ = {};
    latest_version_.clear();
    point_ = none;
    variant_ = none;
    id_ = next_identity(this, id_);
    return declared;
}

} // namespace tyndall::rg
