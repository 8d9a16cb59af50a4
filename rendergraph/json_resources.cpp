// Reading the resources of a frame: images, buffers, imports, histories.
// In: the array. Out: GraphDesc::resources and imports. Invariant: indices are sound also where there are mistakes.
#include <algorithm>
#include <bit>
#include <map>

#include "rendergraph/json_frame_types.hpp"

namespace tyndall::rg::json {
namespace {

constexpr std::uint64_t largest_extent = 1U << 20U;
constexpr std::uint32_t largest_layers = 1U << 16U;

class ResourcesReader {
public:
    ResourcesReader(GraphDesc& graph, Diagnostics& mistakes) : graph_(&graph), mistakes_(mistakes) {}

    void read(const Json& list) {
        for (const Json& value : list) {
            resource(value);
        }
        histories();
    }

private:
    void resource(const Json& value) {
        ResourceDesc resource;
        ObjectReader reader(value, {"Resource " + std::to_string(graph_->resources.size())}, mistakes_);
        reader.text("name", resource.name, true);
        if (!resource.name.empty()) {
            reader.subject() = {"Resource " + in_quotes(resource.name), "", resource.name};
        }
        std::string history_of;
        reader.text("history_of", history_of);
        reader.flag("concurrent", resource.concurrent);
        if (!history_of.empty()) {
            resource.lifetime = ResourceLifetime::history;
        } else if (reader.has("bytes")) {
            resource.kind = ResourceKind::buffer;
            reader.number("bytes", resource.buffer.size_bytes);
            resource.buffer.extra_usage =
                static_cast<VkBufferUsageFlags>(reader.mask("usage", buffer_usage_names()).value_or(0));
        } else {
            image(reader, resource.image);
        }
        if (const Json* import = history_of.empty() ? reader.find("import") : nullptr; import != nullptr) {
            resource.lifetime = ResourceLifetime::imported;
            resource.import = static_cast<std::uint32_t>(graph_->imports.size());
            graph_->imports.push_back(read_import(*import, reader.subject()));
        }
        reader.finish();
        by_name_.emplace(resource.name, static_cast<std::uint32_t>(graph_->resources.size()));
        graph_->resources.push_back(std::move(resource));
        history_of_.push_back(std::move(history_of));
    }

    static void image(ObjectReader& reader, ImageDesc& image) {
        if (!reader.has("format") && !reader.has("size")) {
            reader.complain("needs 'format' and 'size' (an image), 'bytes' (a buffer) or 'history_of'");
        } else if (!reader.has("format") || !reader.has("size")) {
            reader.complain(reader.has("size") ? "needs a 'format'" : "needs a 'size'");
        }
        image.format = static_cast<VkFormat>(reader.name("format", format_names()).value_or(VK_FORMAT_UNDEFINED));
        if (const auto size = reader.numbers("size", 1, 3)) {
            const auto side = [&](std::size_t i) {
                const std::uint64_t texels = i < size->size() ? (*size)[i] : 1;
                if (texels > largest_extent) {
                    reader.complain("has a size of " + std::to_string(texels) + " texels; at most " +
                                    std::to_string(largest_extent) + " can be");
                }
                return static_cast<std::uint32_t>(std::min<std::uint64_t>(texels, largest_extent));
            };
            image.extent = {side(0), side(1), side(2)};
            image.type = static_cast<VkImageType>(size->size() - 1);
        }
        if (const auto type = reader.choice("type", list(image_types))) {
            image.type = static_cast<VkImageType>(*type);
        }
        reader.number("mips", image.mips, 0, 32);
        reader.number("layers", image.layers, 0, largest_layers);
        auto samples = static_cast<std::uint32_t>(image.samples);
        reader.number("samples", samples, 1, 64);
        if (!std::has_single_bit(samples)) {
            reader.complain("has " + std::to_string(samples) + " samples; only powers of two can be");
            samples = 1;
        }
        image.samples = static_cast<VkSampleCountFlagBits>(samples);
        image.flags = static_cast<VkImageCreateFlags>(reader.mask("flags", image_flag_names()).value_or(0));
        image.extra_usage = static_cast<VkImageUsageFlags>(reader.mask("usage", image_usage_names()).value_or(0));
    }

    ImportDesc read_import(const Json& value, const Subject& of) {
        ImportDesc import;
        ObjectReader reader(value, {of.text + ", import,", "", of.resource}, mistakes_);
        const auto use = [&](const char* key, VkImageLayout& layout, VkPipelineStageFlags2& stages,
                             VkAccessFlags2& access, std::uint32_t& family, bool* waits) {
            const Json* side = reader.find(key);
            if (side == nullptr) {
                return false;
            }
            ObjectReader one(*side, {of.text + ", import, " + key + " use,", "", of.resource}, mistakes_);
            layout = static_cast<VkImageLayout>(one.name("layout", layout_names()).value_or(VK_IMAGE_LAYOUT_UNDEFINED));
            stages = one.mask("stages", stage_names()).value_or(0);
            access = one.mask("access", access_names()).value_or(0);
            one.number("family", family);
            if (waits != nullptr) {
                one.flag("waits_semaphore", *waits);
            }
            one.finish();
            return true;
        };
        use("initial", import.initial_layout, import.initial_stages, import.initial_access, import.initial_family,
            &import.waits_semaphore);
        import.has_final =
            use("final", import.final_layout, import.final_stages, import.final_access, import.final_family, nullptr);
        reader.flag("signals_semaphore", import.signals_semaphore);
        reader.flag("read_only", import.read_only);
        reader.finish();
        return import;
    }

    void histories() {
        for (std::uint32_t i = 0; i < graph_->resources.size(); ++i) {
            if (history_of_[i].empty()) {
                continue;
            }
            ResourceDesc& history = graph_->resources[i];
            const Subject subject{"Resource " + in_quotes(history.name), "", history.name};
            const auto at = by_name_.find(history_of_[i]);
            if (at == by_name_.end()) {
                complain(mistakes_, subject,
                         "is the history of the unknown resource " + in_quotes(history_of_[i]) +
                             suggestion(history_of_[i], names_of(*graph_)));
                history.lifetime = ResourceLifetime::transient;
                continue;
            }
            ResourceDesc& current = graph_->resources[at->second];
            if (current.lifetime != ResourceLifetime::transient || current.has_history) {
                complain(mistakes_, subject,
                         current.has_history ? "is a second history of " + in_quotes(current.name) + "; one is enough"
                                             : "is the history of " + in_quotes(current.name) +
                                                   ", which is no transient; only transients have a history");
                history.lifetime = ResourceLifetime::transient;
                continue;
            }
            current.has_history = true;
            history.history_of = at->second;
            history.kind = current.kind;
            history.image = current.image;
            history.buffer = current.buffer;
        }
    }

    GraphDesc* graph_;
    Diagnostics& mistakes_;
    std::map<std::string, std::uint32_t, std::less<>> by_name_; ///< the first of a name
    std::vector<std::string> history_of_;                       ///< by resource
};

} // namespace

std::vector<std::string_view> names_of(const GraphDesc& graph) {
    std::vector<std::string_view> names;
    for (const ResourceDesc& resource : graph.resources) {
        names.push_back(resource.name);
    }
    return names;
}

void read_resources(const Json* list, GraphDesc& graph, Diagnostics& mistakes) {
    if (list != nullptr) {
        ResourcesReader(graph, mistakes).read(*list);
    }
}

} // namespace tyndall::rg::json
