// A plan as JSON, both ways.
// Invariant: a plan that was read has no index outside its table, none missing that its reasons speak of, and no number
// that overflows in a sum.
#include <algorithm>
#include <array>
#include <type_traits>

#include "rendergraph/json.hpp"
#include "rendergraph/json_types.hpp"
#include "rendergraph/plan_fields_types.hpp"

namespace tyndall::rg {
namespace {

using json::fields;
using json::Json;
using json::Table;

/// The value that stands for "no index", "the rest", "all types" or "no family": null in the file.
template <typename T>
constexpr T nothing = std::numeric_limits<T>::max();

// ---- writing -----------------------------------------------------------------------------------------------------

class Writer {
public:
    explicit Writer(Json& out) : out_(out) {}

    template <typename T>
    void value(const char* key, T& v, T = nothing<T>) {
        out_[key] = v;
    }
    template <typename T>
    void value_or_all(const char* key, T& v) {
        out_[key] = v == nothing<T> ? Json(nullptr) : Json(v);
    }
    template <typename T>
    void values(const char* key, std::vector<T>& list, T = nothing<T>) {
        out_[key] = list;
    }
    void index(const char* key, std::uint32_t& v, Table) { value_or_all(key, v); }
    void index_or_none(const char* key, std::uint32_t& v, Table, bool = false) { value_or_all(key, v); }
    void indices(const char* key, std::vector<std::uint32_t>& list, Table) { values(key, list); }
    void run(const char* first_key, const char* count_key, std::uint32_t& first, std::uint32_t& count, Table) {
        value(first_key, first);
        value(count_key, count);
    }
    template <typename E, std::size_t N>
    void word(const char* key, E& v, const std::array<std::string_view, N>& words) {
        const auto at = static_cast<std::size_t>(v);
        out_[key] = at < N ? Json(words[at]) : Json(at);
    }
    template <typename T>
    void mask(const char* key, T& v, VulkanNames names) {
        out_[key] = json::mask(names, v);
    }
    template <typename E>
    void name(const char* key, E& v, VulkanNames names) {
        out_[key] = json::named(names, static_cast<std::uint64_t>(v));
    }
    template <typename S>
    void object(const char* key, S& s) {
        Json& inner = out_[key] = Json::object();
        Writer writer(inner);
        fields(writer, s);
    }
    template <typename S>
    void objects(const char* key, std::vector<S>& list) {
        Json& array = out_[key] = Json::array();
        for (S& s : list) {
            Writer writer(array.emplace_back(Json::object()));
            fields(writer, s);
        }
    }

private:
    Json& out_;
};

// ---- reading -----------------------------------------------------------------------------------------------------

class Reader {
public:
    Reader(const Json& in, std::string path, Diagnostics& mistakes)
        : in_(in), path_(std::move(path)), mistakes_(mistakes) {
        if (!in.is_object()) {
            wrong("", "an object");
        }
    }

    /// A number from 0, or where it may be negative from -most, to most.
    template <typename T>
    void value(const char* key, T& v, T most = nothing<T>) {
        if (const Json* at = find(key)) {
            scalar(key, *at, v, most);
        }
    }
    void value(const char* key, bool& v) {
        const Json* at = find(key);
        v = at != nullptr && at->is_boolean() && at->get<bool>();
        if (at != nullptr && !at->is_boolean()) {
            wrong(key, "true or false");
        }
    }
    template <typename T>
    void value_or_all(const char* key, T& v) {
        const Json* at = find(key);
        if (at != nullptr && at->is_null()) {
            v = nothing<T>;
        } else if (at != nullptr) {
            scalar(key, *at, v, nothing<T>);
        }
    }
    template <typename T>
    void values(const char* key, std::vector<T>& list, T most = nothing<T>) {
        for_each(key, [&](const Json& entry, const std::string&) { scalar(key, entry, list.emplace_back(), most); });
    }
    void index(const char* key, std::uint32_t& v, Table) { value(key, v); }
    void index_or_none(const char* key, std::uint32_t& v, Table, bool = false) { value_or_all(key, v); }
    void indices(const char* key, std::vector<std::uint32_t>& list, Table) { values(key, list); }
    void run(const char* first_key, const char* count_key, std::uint32_t& first, std::uint32_t& count, Table) {
        value(first_key, first);
        value(count_key, count);
    }
    template <typename E, std::size_t N>
    void word(const char* key, E& v, const std::array<std::string_view, N>& words) {
        const Json* at = find(key);
        if (at == nullptr) {
            return;
        }
        const auto found =
            at->is_string() ? std::find(words.begin(), words.end(), at->get_ref<const std::string&>()) : words.end();
        if (found == words.end()) {
            wrong(key, "one of its words");
            return;
        }
        v = static_cast<E>(found - words.begin());
    }
    template <typename T>
    void mask(const char* key, T& v, VulkanNames names) {
        std::uint64_t bits = 0;
        for_each(key, [&](const Json& entry, const std::string&) {
            if (const auto bit = number_or_name(entry, names, nothing<T>)) {
                bits |= *bit;
            } else {
                wrong(key, "names");
            }
        });
        v = static_cast<T>(bits);
    }
    template <typename E>
    void name(const char* key, E& v, VulkanNames names) {
        const Json* at = find(key);
        constexpr std::uint64_t most = 0x7fffffff; // VK_*_MAX_ENUM
        const auto found = at == nullptr ? std::nullopt : number_or_name(*at, names, most);
        if (found) {
            v = static_cast<E>(*found);
        } else if (at != nullptr) {
            wrong(key, "a name");
        }
    }
    template <typename S>
    void object(const char* key, S& s) {
        if (const Json* at = find(key)) {
            Reader reader(*at, path_ + key + ".", mistakes_);
            fields(reader, s);
        }
    }
    template <typename S>
    void objects(const char* key, std::vector<S>& list) {
        list.clear();
        for_each(key, [&](const Json& entry, const std::string& path) {
            Reader reader(entry, path, mistakes_);
            fields(reader, list.emplace_back());
        });
    }

private:
    const Json* find(const char* key) {
        if (!in_.is_object()) {
            return nullptr;
        }
        const auto at = in_.find(key);
        if (at == in_.end()) {
            wrong(key, "a value");
            return nullptr;
        }
        return &*at;
    }
    template <typename F>
    void for_each(const char* key, F&& f) {
        const Json* at = find(key);
        if (at != nullptr && !at->is_array()) {
            wrong(key, "an array");
        } else if (at != nullptr) {
            for (std::size_t i = 0; i < at->size(); ++i) {
                f((*at)[i], path_ + key + "[" + std::to_string(i) + "].");
            }
        }
    }
    static std::optional<std::uint64_t> number_or_name(const Json& entry, VulkanNames names, std::uint64_t most) {
        if (entry.is_number_unsigned() && entry.get<std::uint64_t>() <= most) {
            return entry.get<std::uint64_t>();
        }
        return entry.is_string() ? value_in(names, entry.get_ref<const std::string&>()) : std::nullopt;
    }
    template <typename T>
    void scalar(const char* key, const Json& entry, T& v, T most) {
        bool fits = entry.is_number_unsigned() && entry.get<std::uint64_t>() <= static_cast<std::uint64_t>(most);
        if constexpr (std::is_signed_v<T>) {
            fits = fits || (entry.is_number_integer() && !entry.is_number_unsigned() && entry.get<T>() >= -most);
        }
        v = fits ? entry.get<T>() : T{};
        if (!fits) {
            wrong(key, "a whole number up to " + std::to_string(most));
        }
    }
    void wrong(const char* key, const std::string& needed) {
        json::complain(mistakes_, {"The plan"}, "needs " + needed + " as '" + path_ + key + "'");
    }

    const Json& in_;
    std::string path_;
    Diagnostics& mistakes_;
};

// ---- checking ----------------------------------------------------------------------------------------------------

class Checker {
public:
    Checker(const std::array<std::size_t, json::table_count>& sizes, std::string path, Diagnostics& mistakes)
        : sizes_(sizes), path_(std::move(path)), mistakes_(mistakes) {}

    template <typename T>
    void value(const char*, T&, T = nothing<T>) {}
    template <typename T>
    void value_or_all(const char*, T&) {}
    template <typename T>
    void values(const char*, std::vector<T>&, T = nothing<T>) {}
    void index(const char* key, std::uint32_t& v, Table table) {
        if (v >= size(table)) {
            outside(key);
        }
    }
    void index_or_none(const char* key, std::uint32_t& v, Table table, bool needed = false) {
        if (v != none || needed) {
            index(key, v, table);
        }
    }
    void indices(const char* key, std::vector<std::uint32_t>& list, Table table) {
        for (std::uint32_t& v : list) {
            index(key, v, table);
        }
    }
    void run(const char* first_key, const char*, std::uint32_t& first, std::uint32_t& count, Table table) {
        if (first > size(table) || count > size(table) - first) {
            outside(first_key);
        }
    }
    template <typename E, std::size_t N>
    void word(const char*, E&, const std::array<std::string_view, N>&) {}
    template <typename T>
    void mask(const char*, T&, VulkanNames) {}
    template <typename E>
    void name(const char*, E&, VulkanNames) {}
    template <typename S>
    void object(const char* key, S& s) {
        Checker checker(sizes_, path_ + key + ".", mistakes_);
        fields(checker, s);
    }
    template <typename S>
    void objects(const char* key, std::vector<S>& list) {
        for (std::size_t i = 0; i < list.size(); ++i) {
            Checker checker(sizes_, path_ + key + "[" + std::to_string(i) + "].", mistakes_);
            fields(checker, list[i]);
        }
    }

private:
    [[nodiscard]] std::size_t size(Table table) const { return sizes_[static_cast<std::size_t>(table)]; }
    void outside(const char* key) {
        json::complain(mistakes_, {"The plan"}, "has an index outside its table as '" + path_ + key + "'");
    }

    const std::array<std::size_t, json::table_count>& sizes_;
    std::string path_;
    Diagnostics& mistakes_;
};

template <typename T>
Json names_json(const std::vector<T>& named) {
    Json list = Json::array();
    for (const T& entry : named) {
        list.push_back(entry.name);
    }
    return list;
}

/// What walks through a plan relies on, once its indices are sound: batches that hold all passes, one after the other,
/// and forms that exist.
void check_structure(const GraphDesc& graph, const Plan& plan, Diagnostics& mistakes) {
    const auto complain = [&](const std::string& what) { json::complain(mistakes, {"The plan"}, what); };
    std::size_t next = 0;
    for (std::uint32_t b = 0; b < plan.batches.size(); ++b) {
        const Batch& batch = plan.batches[b];
        bool follows = batch.first_pass == next && batch.pass_count > 0;
        next += batch.pass_count;
        for (std::size_t i = batch.first_pass; follows && i < next; ++i) {
            follows = plan.passes[i].batch == b && plan.passes[i].queue == batch.queue;
        }
        if (!follows) {
            complain("needs passes of its queue, behind those of the batch before, in 'batches[" + std::to_string(b) +
                     "]'");
            return;
        }
    }
    if (next != plan.passes.size()) {
        complain("needs 'batches' that hold all passes");
    }
    if (plan.variants.size() != graph.variants.size()) {
        complain("needs one of 'variants' for each variant");
        return;
    }
    for (std::size_t i = 0; i < plan.variants.size(); ++i) {
        const std::size_t forms = graph.variants[i].forms.size();
        const std::size_t predicted = plan.variants[i].predicted_ns.size();
        if (plan.variants[i].form >= forms || (predicted != 0 && predicted != forms)) {
            complain("needs a form of " + json::in_quotes(graph.variants[i].name) +
                     " and a prediction for each in 'variants[" + std::to_string(i) + "]'");
        }
    }
}

} // namespace

std::string plan_to_json(const GraphDesc& graph, const Plan& plan) {
    Json document = {{"pass_names", names_json(graph.passes)}, {"resource_names", names_json(graph.resources)}};
    Plan copy = plan; // the lists of fields serve reading too
    Writer writer(document);
    fields(writer, copy);
    return json::dump(document, 1) + "\n";
}

tl::expected<Plan, Diagnostics> plan_from_json(std::string_view text, const GraphDesc& graph) {
    tl::expected<Json, Diagnostics> document = json::parse_document(text);
    if (!document) {
        return tl::unexpected(std::move(document.error()));
    }
    Diagnostics mistakes;
    const auto fits = [&](const char* key, const Json& names) {
        if (!document->is_object() || !document->contains(key) || (*document)[key] != names) {
            json::complain(mistakes, {"The plan"}, std::string("is of another frame: '") + key + "' differ");
        }
    };
    fits("pass_names", names_json(graph.passes));
    fits("resource_names", names_json(graph.resources));
    if (!mistakes.empty()) {
        return tl::unexpected(std::move(mistakes));
    }
    Plan plan;
    Reader reader(*document, "", mistakes);
    fields(reader, plan);
    const std::array<std::size_t, json::table_count> sizes = {
        graph.passes.size(),         graph.resources.size(), graph.accesses.size(), graph.variants.size(),
        plan.topology.queues.size(), plan.passes.size(),     plan.batches.size(),   plan.dependencies.size(),
        plan.attachments.size(),     plan.heaps.size()};
    Checker checker(sizes, "", mistakes);
    fields(checker, plan);
    if (plan.placements.size() != graph.resources.size()) {
        json::complain(mistakes, {"The plan"}, "needs one of 'placements' for each resource");
    }
    if (mistakes.empty()) {
        check_structure(graph, plan, mistakes);
    }
    if (!mistakes.empty()) {
        return tl::unexpected(std::move(mistakes));
    }
    return plan;
}

} // namespace tyndall::rg
