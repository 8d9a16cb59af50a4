// Reading a frame that a person wrote.
// In: text. Out: the frame, or all its mistakes. Invariant: what is returned can be given to compile as it is: indices
// are sound, versions are without gaps. O(accesses).
#include <algorithm>
#include <limits>
#include <map>

#include "rendergraph/compile.hpp"
#include "rendergraph/json.hpp"
#include "rendergraph/json_frame_types.hpp"
#include "rendergraph/json_types.hpp"

namespace tyndall::rg {
namespace {

using json::Json;
using json::ObjectReader;
using json::Subject;

std::vector<std::string_view> access_names_in_table() {
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < access_count; ++i) {
        names.push_back(access_info(static_cast<Access>(i)).name);
    }
    return names;
}

class FrameReader {
public:
    Diagnostics read(const Json& document, Frame& frame) {
        frame_ = &frame;
        graph_ = &frame.graph;
        ObjectReader root(document, {"The frame"}, mistakes_);
        root.text("about", frame.about);
        queues(root.array("queues"));
        json::read_model(root, frame.costs);
        points(root.array("points"));
        variants(root.array("variants"));
        json::read_resources(root.array("resources"), *graph_, mistakes_);
        for (std::uint32_t i = 0; i < graph_->resources.size(); ++i) {
            by_name_.emplace(graph_->resources[i].name, i);
        }
        passes(root.array("passes"));
        root.finish();
        version_gaps();
        return std::move(mistakes_);
    }

private:
    void queues(const Json* list) {
        if (list == nullptr) {
            return;
        }
        frame_->topology.queues.clear();
        for (std::size_t i = 0; i < list->size(); ++i) {
            const Json& value = (*list)[i];
            const Subject subject{"Queue " + std::to_string(i)};
            if (value.is_string()) {
                const auto at = std::find(json::queue_kinds.begin(), json::queue_kinds.end(), value.get<std::string>());
                if (at == json::queue_kinds.end()) {
                    json::complain(mistakes_, subject,
                                   "has the unknown kind " + value.dump() +
                                       json::suggestion(value.get<std::string>(), json::list(json::queue_kinds)));
                } else {
                    frame_->topology.queues.push_back(
                        usual_queue(static_cast<QueueKind>(at - json::queue_kinds.begin())));
                }
                continue;
            }
            ObjectReader reader(value, subject, mistakes_);
            const auto kind =
                static_cast<QueueKind>(reader.choice("kind", json::list(json::queue_kinds), true).value_or(0));
            QueueInfo queue = usual_queue(kind);
            reader.number("family", queue.family);
            queue.capabilities =
                static_cast<std::uint8_t>(reader.mask("can", json::capabilities).value_or(queue.capabilities));
            reader.finish();
            frame_->topology.queues.push_back(queue);
        }
    }

    void points(const Json* list) {
        if (list == nullptr) {
            return;
        }
        for (const Json& value : *list) {
            if (json::is_text(value)) {
                graph_->points.push_back(value.get<std::string>());
            } else {
                json::complain(mistakes_, {"The frame"}, "needs names in 'points'");
            }
        }
    }

    void variants(const Json* list) {
        if (list == nullptr) {
            return;
        }
        for (const Json& value : *list) {
            VariantDesc variant;
            ObjectReader reader(value, {"Variant " + std::to_string(graph_->variants.size())}, mistakes_);
            reader.text("name", variant.name, true);
            if (const Json* forms = reader.array("forms"); forms != nullptr) {
                for (const Json& form : *forms) {
                    if (json::is_text(form)) {
                        variant.forms.push_back(form.get<std::string>());
                    } else {
                        reader.complain("needs names in 'forms'");
                    }
                }
            }
            if (variant.forms.empty()) {
                reader.complain("needs at least one name in 'forms'");
            }
            reader.finish();
            graph_->variants.push_back(std::move(variant));
        }
    }

    void passes(const Json* list) {
        if (list == nullptr) {
            return;
        }
        latest_.assign(graph_->resources.size(), 0);
        for (const Json& value : *list) {
            pass(value);
        }
    }

    void pass(const Json& value) {
        PassDesc pass;
        const auto index = static_cast<std::uint32_t>(graph_->passes.size());
        ObjectReader reader(value, {"Pass " + std::to_string(index)}, mistakes_);
        reader.text("name", pass.name, true);
        if (!pass.name.empty()) {
            reader.subject() = {"Pass " + json::in_quotes(pass.name), pass.name, ""};
        }
        pass.kind = static_cast<PassKind>(reader.choice("kind", json::list(json::pass_kinds), true).value_or(0));
        pass.wish = static_cast<QueueWish>(reader.choice("queue", json::list(json::queue_wishes)).value_or(0));
        std::vector<VulkanName> kinds;
        for (std::size_t i = 0; i < json::queue_kinds.size(); ++i) {
            kinds.push_back({queue_bit(static_cast<QueueKind>(i)), json::queue_kinds[i]});
        }
        pass.forbidden_queues = static_cast<std::uint8_t>(reader.mask("not_on", kinds).value_or(0));
        variant_of(reader, pass);
        pass.point = reader.choice("point", {graph_->points.begin(), graph_->points.end()}).value_or(none);
        pass.has_side_effect = reader.has("side_effect");
        reader.text("side_effect", pass.side_effect);
        PassCost cost;
        reader.number("duration_ns", cost.mean_ns, 0, json::longest_pass_ns);
        reader.number("deviation_ns", cost.deviation_ns, 0, json::longest_pass_ns);
        if (cost != PassCost{}) {
            frame_->costs.of_pass.resize(index);
            frame_->costs.of_pass.push_back(cost);
        }
        const auto first = static_cast<std::uint32_t>(graph_->accesses.size());
        if (const Json* list = reader.array("accesses"); list != nullptr) {
            for (std::size_t i = 0; i < list->size(); ++i) {
                access((*list)[i], index, {reader.subject().text + ", access " + std::to_string(i) + ",", pass.name});
            }
        }
        pass.access_count = static_cast<std::uint32_t>(graph_->accesses.size()) - first;
        pass.first_access = pass.access_count == 0 ? 0 : first;
        reader.finish();
        graph_->passes.push_back(std::move(pass));
    }

    void variant_of(ObjectReader& reader, PassDesc& pass) {
        std::vector<std::string_view> names;
        for (const VariantDesc& variant : graph_->variants) {
            names.push_back(variant.name);
        }
        pass.variant = reader.choice("variant", names).value_or(none);
        const std::vector<std::string_view> forms =
            pass.variant == none ? std::vector<std::string_view>{}
                                 : std::vector<std::string_view>{graph_->variants[pass.variant].forms.begin(),
                                                                 graph_->variants[pass.variant].forms.end()};
        pass.form = reader.choice("form", forms, pass.variant != none).value_or(0);
    }

    void access(const Json& value, std::uint32_t pass, Subject subject) {
        AccessDesc access{.pass = pass};
        ObjectReader reader(value, std::move(subject), mistakes_);
        std::string target;
        std::size_t verb_count = 0;
        for (std::size_t i = 0; i < json::verbs.size(); ++i) {
            const bool there = reader.has(json::verbs[i].data());
            reader.text(json::verbs[i].data(), target);
            verb_count += there ? 1 : 0;
            access.direction = there ? static_cast<Direction>(i) : access.direction;
        }
        if (verb_count != 1) {
            reader.complain("needs one of 'reads', 'writes' and 'modifies'");
        }
        const bool found = verb_count == 1 && !target.empty() && resolve(reader, target, access);
        const auto use = reader.choice("as", access_names_in_table(), true);
        access.access = static_cast<Access>(use.value_or(0));
        const bool is_image = !found || graph_->resources[access.resource].kind == ResourceKind::image;
        if (is_image) {
            range(reader, "mips", access.image_range.base_mip, access.image_range.mip_count);
            range(reader, "layers", access.image_range.base_layer, access.image_range.layer_count);
            access.image_range.aspects =
                static_cast<VkImageAspectFlags>(reader.mask("aspects", aspect_names()).value_or(0));
        }
        if (!found || !is_image) {
            range(reader, "bytes", access.buffer_range.offset, access.buffer_range.size);
        }
        if (const Json* clear = is_image ? reader.find("clear") : nullptr; clear != nullptr && found) {
            access.clears = true;
            read_clear(reader, *clear, graph_->resources[access.resource].image.format, access.clear);
        }
        reader.finish();
        if (found && use) {
            if (is_write(access.direction)) {
                std::uint32_t& latest = latest_[access.resource];
                latest = std::max(latest, access.version);
            }
            graph_->accesses.push_back(access);
        }
    }

    bool resolve(ObjectReader& reader, const std::string& target, AccessDesc& access) {
        const json::VersionedName split = json::split_version(target);
        auto at = by_name_.find(split.name);
        const bool versioned = split.version != none && at != by_name_.end();
        if (!versioned) {
            at = by_name_.find(target);
        }
        if (at == by_name_.end()) {
            reader.subject().resource = split.name;
            reader.complain("names the unknown resource " + json::in_quotes(split.name) +
                            json::suggestion(split.name, json::names_of(*graph_)));
            return false;
        }
        reader.subject().resource = at->first;
        access.resource = at->second;
        const std::uint32_t latest = latest_[access.resource];
        access.version = versioned ? split.version : is_write(access.direction) ? latest + 1 : latest;
        return true;
    }

    template <typename T>
    static void range(ObjectReader& reader, const char* key, T& base, T& count) {
        const auto values = reader.numbers(key, 1, 2);
        if (!values) {
            return;
        }
        for (const std::uint64_t value : *values) {
            if (value > std::numeric_limits<T>::max() / 2) {
                reader.complain("has " + std::to_string(value) + " in " + json::in_quotes(key) +
                                ", which nothing can have");
                return;
            }
        }
        base = static_cast<T>((*values)[0]);
        count = values->size() == 2 ? static_cast<T>((*values)[1]) : std::numeric_limits<T>::max();
    }

    void read_clear(ObjectReader& reader, const Json& value, VkFormat format, VkClearValue& clear) {
        if (is_depth_or_stencil(format)) {
            if (!value.is_object()) {
                reader.complain("clears a depth image: 'clear' must be {\"depth\": ..., \"stencil\": ...}");
                return;
            }
            Subject subject = reader.subject();
            subject.text += " clear,";
            ObjectReader one(value, std::move(subject), mistakes_);
            one.real("depth", clear.depthStencil.depth, 0.0, 1.0);
            one.number("stencil", clear.depthStencil.stencil);
            one.finish();
            return;
        }
        const json::ClearNumbers numbers = json::clear_numbers_of(format);
        const bool four =
            value.is_array() && value.size() == 4 &&
            std::all_of(value.begin(), value.end(), [&](const Json& v) { return is_clear_number(v, numbers); });
        if (!four) {
            const char* const kind = numbers == json::ClearNumbers::unsigned_whole ? " whole numbers from 0"
                                     : numbers == json::ClearNumbers::signed_whole ? " whole numbers"
                                                                                   : " numbers";
            reader.complain(std::string("clears a colour image: 'clear' must be four") + kind +
                            " that fit into 32 bits");
            return;
        }
        for (std::size_t i = 0; i < 4; ++i) {
            switch (numbers) {
            case json::ClearNumbers::unsigned_whole: clear.color.uint32[i] = value[i].get<std::uint32_t>(); break;
            case json::ClearNumbers::signed_whole: clear.color.int32[i] = value[i].get<std::int32_t>(); break;
            case json::ClearNumbers::real: clear.color.float32[i] = value[i].get<float>(); break;
            }
        }
    }

    static bool is_clear_number(const Json& value, json::ClearNumbers numbers) {
        const auto within = [&](double least, double most) {
            return value.get<double>() >= least && value.get<double>() <= most;
        };
        switch (numbers) {
        case json::ClearNumbers::unsigned_whole:
            return value.is_number_unsigned() && within(0.0, std::numeric_limits<std::uint32_t>::max());
        case json::ClearNumbers::signed_whole:
            return value.is_number_integer() &&
                   within(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max());
        case json::ClearNumbers::real:
            return value.is_number() && within(std::numeric_limits<float>::lowest(), std::numeric_limits<float>::max());
        }
        return false;
    }

    /// Versions are made one by one: what no access makes, none can name.
    void version_gaps() {
        std::vector<std::uint32_t> made(graph_->resources.size(), 0);
        for (const AccessDesc& access : graph_->accesses) {
            made[access.resource] += is_write(access.direction) ? 1 : 0;
        }
        for (const AccessDesc& access : graph_->accesses) {
            const std::uint32_t least = is_write(access.direction) ? 1 : 0;
            if (access.version < least || access.version > made[access.resource]) {
                const std::string& name = graph_->resources[access.resource].name;
                const std::string& pass = graph_->passes[access.pass].name;
                json::complain(mistakes_, {"Pass " + json::in_quotes(pass), pass, name},
                               access.version < least
                                   ? "makes version 0 of " + json::in_quotes(name) +
                                         ", which is what was there before the frame; the first is version 1"
                                   : "names version " + std::to_string(access.version) + " of " +
                                         json::in_quotes(name) + ", but the frame makes " +
                                         std::to_string(made[access.resource]));
            }
        }
    }

    Frame* frame_ = nullptr;
    GraphDesc* graph_ = nullptr;
    Diagnostics mistakes_;
    std::map<std::string, std::uint32_t, std::less<>> by_name_; ///< the first of a name
    std::vector<std::uint32_t> latest_;                         ///< version, by resource
};

/// What compile says of the part of the frame that the file's own mistakes leave whole.
Diagnostics further_mistakes(const Frame& frame, const Diagnostics& mistakes) {
    const auto plan = compile(frame.graph, frame.topology, estimate_memory(frame.graph));
    Diagnostics further;
    for (const Diagnostic& found : plan ? Diagnostics{} : plan.error()) {
        const bool known = std::any_of(mistakes.begin(), mistakes.end(), [&](const Diagnostic& mistake) {
            return (!found.pass.empty() && found.pass == mistake.pass) ||
                   (!found.resource.empty() && found.resource == mistake.resource);
        });
        if (!known) {
            further.push_back(found);
        }
    }
    return further;
}

} // namespace

QueueInfo usual_queue(QueueKind kind) {
    switch (kind) {
    case QueueKind::graphics: break;
    case QueueKind::compute: return {QueueKind::compute, 1, can_compute | can_transfer};
    case QueueKind::transfer: return {QueueKind::transfer, 2, can_transfer};
    }
    return {QueueKind::graphics, 0, can_graphics | can_compute | can_transfer};
}

tl::expected<Frame, Diagnostics> frame_from_json(std::string_view text) {
    tl::expected<Json, Diagnostics> document = json::parse_document(text);
    if (!document) {
        return tl::unexpected(std::move(document.error()));
    }
    Frame frame;
    Diagnostics mistakes = FrameReader().read(*document, frame);
    if (!mistakes.empty()) {
        const Diagnostics further = further_mistakes(frame, mistakes);
        mistakes.insert(mistakes.end(), further.begin(), further.end());
        return tl::unexpected(std::move(mistakes));
    }
    return frame;
}

} // namespace tyndall::rg
