// A plan as JSON, both ways.
// Invariant: a plan that was read has no index outside its table.
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

/// The value that stands for "no index", "the rest" or "no family": null in the file.
template <typename T>
constexpr bool means_nothing(T value) {
    return std::is_unsigned_v<T> && sizeof(T) >= sizeof(std::uint32_t) && value == std::numeric_limits<T>::max();
}

// ---- writing -----------------------------------------------------------------------------------------------------

class Writer {
public:
    explicit Writer(Json& out) : out_(out) {}

    template <typename T>
    void value(const char* key, T& v) {
        out_[key] = scalar(v);
    }
    template <typename T>
    void values(const char* key, std::vector<T>& list) {
        Json& array = out_[key] = Json::array();
        for (const T& v : list) {
            array.push_back(scalar(v));
        }
    }
    void index(const char* key, std::uint32_t& v, Table) { value(key, v); }
    void index_or_none(const char* key, std::uint32_t& v, Table) { value(key, v); }
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
    template <typename T>
    static Json scalar(const T& v) {
        return means_nothing(v) ? Json(nullptr) : Json(v);
    }
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

    template <typename T>
    void value(const char* key, T& v) {
        if (const Json* at = find(key); at != nullptr && !scalar(*at, v)) {
            wrong(key, "another kind of value");
        }
    }
    template <typename T>
    void values(const char* key, std::vector<T>& list) {
        for_each(key, [&](const Json& entry, const std::string&) {
            if (!scalar(entry, list.emplace_back())) {
                wrong(key, "another kind of value");
            }
        });
    }
    void index(const char* key, std::uint32_t& v, Table) { value(key, v); }
    void index_or_none(const char* key, std::uint32_t& v, Table) { value(key, v); }
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
            if (const auto bit = number_or_name(entry, names)) {
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
        const auto found = at == nullptr ? std::nullopt : number_or_name(*at, names);
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
    static std::optional<std::uint64_t> number_or_name(const Json& entry, VulkanNames names) {
        return entry.is_number_unsigned() ? entry.get<std::uint64_t>()
               : entry.is_string()        ? value_in(names, entry.get_ref<const std::string&>())
                                          : std::nullopt;
    }
    static bool scalar(const Json& entry, bool& v) {
        v = entry.is_boolean() && entry.get<bool>();
        return entry.is_boolean();
    }
    template <typename T>
    static bool scalar(const Json& entry, T& v) {
        if (entry.is_null() && means_nothing(std::numeric_limits<T>::max())) {
            v = std::numeric_limits<T>::max();
            return true;
        }
        const bool fits = std::is_signed_v<T>
                              ? entry.is_number_integer()
                              : entry.is_number_unsigned() &&
                                    entry.get<std::uint64_t>() <= std::uint64_t{std::numeric_limits<T>::max()};
        v = fits ? static_cast<T>(entry.get<std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>>())
                 : T{};
        return fits;
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
    void value(const char*, T&) {}
    template <typename T>
    void values(const char*, std::vector<T>&) {}
    void index(const char* key, std::uint32_t& v, Table table) {
        if (v >= size(table)) {
            outside(key);
        }
    }
    void index_or_none(const char* key, std::uint32_t& v, Table table) {
        if (v != none) {
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
    if (plan.variants.size() != graph.variants.size()) {
        json::complain(mistakes, {"The plan"}, "needs one of 'variants' for each variant");
    }
    if (!mistakes.empty()) {
        return tl::unexpected(std::move(mistakes));
    }
    return plan;
}

} // namespace tyndall::rg
