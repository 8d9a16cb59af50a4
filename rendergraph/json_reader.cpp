#include <algorithm>
#include <numeric>
#include <set>

#include "rendergraph/json_types.hpp"

namespace tyndall::rg::json {
namespace {

/// Levenshtein's distance: how many letters to insert, remove or replace. O(a x b).
std::size_t letters_apart(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t k = 0; k < b.size(); ++k) {
            const std::size_t replaced = diagonal + (a[i] == b[k] ? 0 : 1);
            diagonal = row[k + 1];
            row[k + 1] = std::min({replaced, row[k] + 1, row[k + 1] + 1});
        }
    }
    return row[b.size()];
}

/// Finds what the document's tree no longer shows: where the syntax breaks, and keys given twice.
class SyntaxCheck final : public nlohmann::json_sax<Json> {
public:
    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t&) override { return true; }
    bool string(string_t&) override { return true; }
    bool binary(binary_t&) override { return true; }
    bool start_object(std::size_t) override {
        keys_.emplace_back();
        return true;
    }
    bool key(string_t& name) override {
        if (!keys_.back().insert(name).second) {
            json::complain(mistakes_, {"The file"}, "gives the key " + in_quotes(name) + " twice in one object");
        }
        return true;
    }
    bool end_object() override {
        keys_.pop_back();
        return true;
    }
    bool start_array(std::size_t) override { return true; }
    bool end_array() override { return true; }
    bool parse_error(std::size_t position, const std::string& token, const nlohmann::detail::exception&) override {
        json::complain(mistakes_, {"The file"},
                       "is not valid JSON at byte " + std::to_string(position) +
                           (token.empty() ? "" : ", near " + in_quotes(token)));
        return false;
    }
    [[nodiscard]] Diagnostics& mistakes() { return mistakes_; }

private:
    std::vector<std::set<std::string>> keys_;
    Diagnostics mistakes_;
};

} // namespace

std::string in_quotes(std::string_view name) {
    constexpr std::size_t longest = 100;
    if (name.size() <= longest) {
        return "'" + std::string(name) + "'";
    }
    std::size_t end = longest;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0U) == 0x80U) { // not within a character
        --end;
    }
    return "'" + std::string(name.substr(0, end)) + "...'";
}

bool is_text(const Json& value) {
    return value.is_string() && value.get_ref<const std::string&>().find('\0') == std::string::npos;
}

void complain(Diagnostics& mistakes, const Subject& subject, const std::string& what) {
    mistakes.push_back({.code = DiagnosticCode::bad_file,
                        .pass = subject.pass,
                        .resource = subject.resource,
                        .message = subject.text + " " + what});
}

std::string suggestion(std::string_view word, const std::vector<std::string_view>& candidates) {
    constexpr std::size_t listed_whole = 8;
    std::string_view nearest;
    std::size_t distance = std::max<std::size_t>(word.size() / 2, 2) + 1;
    for (const std::string_view candidate : candidates) {
        if (const std::size_t apart = letters_apart(word, candidate); apart < distance) {
            distance = apart;
            nearest = candidate;
        }
    }
    if (!nearest.empty()) {
        return "; did you mean " + in_quotes(nearest) + "?";
    }
    if (candidates.empty() || candidates.size() > listed_whole) {
        return "";
    }
    std::string text;
    for (const std::string_view candidate : candidates) {
        text += (text.empty() ? "; there are " : ", ") + in_quotes(candidate);
    }
    return text;
}

std::vector<std::string_view> names_of(VulkanNames names) {
    std::vector<std::string_view> out;
    for (const VulkanName& entry : names) {
        out.push_back(entry.name);
    }
    return out;
}

Json named(VulkanNames names, std::uint64_t value) {
    const std::optional<std::string_view> name = name_in(names, value);
    return name ? Json(*name) : Json(value);
}

Json mask(VulkanNames names, std::uint64_t bits) {
    Json list = Json::array();
    for (const VulkanName& entry : names) {
        if ((bits & entry.value) == entry.value) {
            list.push_back(entry.name);
            bits &= ~entry.value;
        }
    }
    if (bits != 0) {
        list.push_back(bits);
    }
    return list;
}

std::string dump(const Json& document, int indent) {
    return document.dump(indent, ' ', false, Json::error_handler_t::replace);
}

tl::expected<Json, Diagnostics> parse_document(std::string_view text) {
    SyntaxCheck check;
    const bool whole = Json::sax_parse(text.begin(), text.end(), &check);
    if (!whole || !check.mistakes().empty()) {
        return tl::unexpected(std::move(check.mistakes()));
    }
    return Json::parse(text.begin(), text.end(), nullptr, false);
}

ObjectReader::ObjectReader(const Json& value, Subject subject, Diagnostics& mistakes)
    : object_(value.is_object() ? &value : nullptr), subject_(std::move(subject)), mistakes_(&mistakes) {
    if (object_ == nullptr) {
        complain("must be an object");
    }
}

bool ObjectReader::has(const char* key) const {
    return object_ != nullptr && object_->contains(key);
}

const Json* ObjectReader::find(const char* key) {
    known_.emplace_back(key);
    if (object_ == nullptr) {
        return nullptr;
    }
    const auto at = object_->find(key);
    return at == object_->end() ? nullptr : &*at;
}

const Json* ObjectReader::array(const char* key) {
    const Json* value = find(key);
    if (value != nullptr && !value->is_array()) {
        complain("needs an array as " + in_quotes(key));
        return nullptr;
    }
    return value;
}

void ObjectReader::text(const char* key, std::string& out, bool required) {
    const Json* value = find(key);
    if (value != nullptr && is_text(*value)) {
        out = value->get_ref<const std::string&>();
    } else if (value != nullptr || (required && object_ != nullptr)) {
        complain("needs a text as " + in_quotes(key));
    }
}

void ObjectReader::flag(const char* key, bool& out) {
    const Json* value = find(key);
    if (value != nullptr && value->is_boolean()) {
        out = value->get<bool>();
    } else if (value != nullptr) {
        complain("needs true or false as " + in_quotes(key));
    }
}

std::optional<std::uint64_t> ObjectReader::whole_number(const char* key, std::uint64_t least, std::uint64_t most) {
    const Json* value = find(key);
    if (value == nullptr) {
        return std::nullopt;
    }
    if (!value->is_number_unsigned() || value->get<std::uint64_t>() < least || value->get<std::uint64_t>() > most) {
        complain("needs a whole number from " + std::to_string(least) + " to " + std::to_string(most) + " as " +
                 in_quotes(key));
        return std::nullopt;
    }
    return value->get<std::uint64_t>();
}

void ObjectReader::real(const char* key, float& out, double least, double most) {
    const Json* value = find(key);
    if (value == nullptr) {
        return;
    }
    const double number = value->is_number() ? value->get<double>() : least - 1.0;
    if (number < least || number > most) {
        complain("needs a number from " + dump(least, -1) + " to " + dump(most, -1) + " as " + in_quotes(key));
    } else {
        out = static_cast<float>(number);
    }
}

std::optional<std::uint64_t> ObjectReader::name(const char* key, VulkanNames names) {
    const Json* value = find(key);
    if (value == nullptr) {
        return std::nullopt;
    }
    if (value->is_number_unsigned()) {
        return value->get<std::uint64_t>();
    }
    if (!value->is_string()) {
        complain("needs a name as " + in_quotes(key));
        return std::nullopt;
    }
    const auto& word = value->get_ref<const std::string&>();
    const std::optional<std::uint64_t> found = value_in(names, word);
    if (!found) {
        complain("has the unknown " + std::string(key) + " " + in_quotes(word) + suggestion(word, names_of(names)));
    }
    return found;
}

std::optional<std::uint64_t> ObjectReader::mask(const char* key, VulkanNames names) {
    const Json* list = array(key);
    if (list == nullptr) {
        return std::nullopt;
    }
    std::uint64_t bits = 0;
    for (const Json& entry : *list) {
        if (entry.is_number_unsigned()) {
            bits |= entry.get<std::uint64_t>();
        } else if (!entry.is_string()) {
            complain("needs names in " + in_quotes(key));
        } else if (const std::optional<std::uint64_t> bit = value_in(names, entry.get_ref<const std::string&>())) {
            bits |= *bit;
        } else {
            const auto& word = entry.get_ref<const std::string&>();
            complain("has the unknown name " + in_quotes(word) + " in " + in_quotes(key) +
                     suggestion(word, names_of(names)));
        }
    }
    return bits;
}

std::optional<std::uint32_t> ObjectReader::choice(const char* key, const std::vector<std::string_view>& choices,
                                                  bool required) {
    const Json* value = find(key);
    if (value == nullptr) {
        if (required && object_ != nullptr) {
            complain("needs " + in_quotes(key) + suggestion("", choices));
        }
        return std::nullopt;
    }
    const std::string word = value->is_string() ? value->get<std::string>() : value->dump();
    const auto at = std::find(choices.begin(), choices.end(), word);
    if (!value->is_string() || at == choices.end()) {
        complain("has the unknown " + std::string(key) + " " + in_quotes(word) + suggestion(word, choices));
        return std::nullopt;
    }
    return static_cast<std::uint32_t>(at - choices.begin());
}

std::optional<std::vector<std::uint64_t>> ObjectReader::numbers(const char* key, std::size_t least, std::size_t most) {
    const Json* list = array(key);
    if (list == nullptr) {
        return std::nullopt;
    }
    std::vector<std::uint64_t> values;
    for (const Json& entry : *list) {
        if (entry.is_number_unsigned()) {
            values.push_back(entry.get<std::uint64_t>());
        }
    }
    if (values.size() != list->size() || values.size() < least || values.size() > most) {
        complain("needs " + std::to_string(least) + (most > least ? " to " + std::to_string(most) : "") +
                 " whole numbers as " + in_quotes(key));
        return std::nullopt;
    }
    return values;
}

void ObjectReader::finish() {
    if (object_ == nullptr) {
        return;
    }
    for (const auto& entry : object_->items()) {
        if (std::find(known_.begin(), known_.end(), entry.key()) == known_.end()) {
            complain("has the unknown key " + in_quotes(entry.key()) + suggestion(entry.key(), known_));
        }
    }
}

} // namespace tyndall::rg::json
