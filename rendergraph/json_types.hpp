// Reading JSON written by people: every mistake is kept, none stops the reading. Internal.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

#include "rendergraph/diagnostic.hpp"
#include "rendergraph/vulkan_names.hpp"

namespace tyndall::rg::json {

using Json = nlohmann::ordered_json;

/// What a mistake is reported under.
struct Subject {
    std::string text = {}; ///< begins the sentence: "Pass 'esm blur', access 2"
    std::string pass = {};
    std::string resource = {};
};

/// Cut where it is too long for a sentence.
[[nodiscard]] std::string in_quotes(std::string_view name);
/// A text without the character that ends one in C.
[[nodiscard]] bool is_text(const Json& value);
void complain(Diagnostics& mistakes, const Subject& subject, const std::string& what);

/// ", did you mean 'x'?" with the candidate nearest to `word`, or the list of a few where none is near.
[[nodiscard]] std::string suggestion(std::string_view word, const std::vector<std::string_view>& candidates);
[[nodiscard]] std::vector<std::string_view> names_of(VulkanNames names);

/// The value's name, or the value where the table has none.
[[nodiscard]] Json named(VulkanNames names, std::uint64_t value);
/// The names of a mask's bits; those without a name as one number.
[[nodiscard]] Json mask(VulkanNames names, std::uint64_t bits);

/// Text of a document; bytes of names that are no UTF-8 become U+FFFD. `indent` -1: one line.
[[nodiscard]] std::string dump(const Json& document, int indent);

/// The document, or where its syntax breaks, or the keys that one object gives twice.
[[nodiscard]] tl::expected<Json, Diagnostics> parse_document(std::string_view text);

/// Reads the known keys of one object; `finish` reports those that nobody asked for.
class ObjectReader {
public:
    ObjectReader(const Json& value, Subject subject, Diagnostics& mistakes);

    [[nodiscard]] bool has(const char* key) const;
    /// The value of a key, null where the object has none.
    [[nodiscard]] const Json* find(const char* key);
    /// The same, an array; complains where it is something else.
    [[nodiscard]] const Json* array(const char* key);

    void text(const char* key, std::string& out, bool required = false);
    void flag(const char* key, bool& out);
    template <typename T>
    void number(const char* key, T& out, std::uint64_t least = 0,
                std::uint64_t most = static_cast<std::uint64_t>(std::numeric_limits<T>::max())) {
        if (const std::optional<std::uint64_t> value = whole_number(key, least, most)) {
            out = static_cast<T>(*value);
        }
    }
    /// Any number from `least` to `most`.
    void real(const char* key, float& out, double least, double most);
    /// One of a table's names, or the plain number.
    [[nodiscard]] std::optional<std::uint64_t> name(const char* key, VulkanNames names);
    /// An array of names, or of plain numbers, as a mask.
    [[nodiscard]] std::optional<std::uint64_t> mask(const char* key, VulkanNames names);
    /// The index of one of `choices`.
    [[nodiscard]] std::optional<std::uint32_t> choice(const char* key, const std::vector<std::string_view>& choices,
                                                      bool required = false);
    /// `least` to `most` whole numbers of 64 bits.
    [[nodiscard]] std::optional<std::vector<std::uint64_t>> numbers(const char* key, std::size_t least,
                                                                    std::size_t most);

    void complain(const std::string& what) { json::complain(*mistakes_, subject_, what); }
    [[nodiscard]] Subject& subject() { return subject_; }
    [[nodiscard]] Diagnostics& mistakes() { return *mistakes_; }
    void finish();

private:
    [[nodiscard]] std::optional<std::uint64_t> whole_number(const char* key, std::uint64_t least, std::uint64_t most);

    const Json* object_; ///< null: the value is no object, which was said
    Subject subject_;
    Diagnostics* mistakes_;
    std::vector<std::string_view> known_;
};

} // namespace tyndall::rg::json
