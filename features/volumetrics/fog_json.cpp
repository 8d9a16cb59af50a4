#include "features/volumetrics/fog_json.hpp"

#include <charconv>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "features/volumetrics/fog_json_section.hpp"

namespace tyndall::volumetrics {
namespace {

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
            error_ = Error{"The fog file gives the key \"" + name + "\" twice in one object."};
            return false;
        }
        return true;
    }
    bool end_object() override {
        keys_.pop_back();
        return true;
    }
    bool start_array(std::size_t) override { return true; }
    bool end_array() override { return true; }
    bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception&) override {
        error_ = Error{"The fog file is not valid JSON near byte " + std::to_string(position) + "."};
        return false;
    }
    [[nodiscard]] const std::optional<Error>& error() const { return error_; }

private:
    std::vector<std::set<std::string>> keys_;
    std::optional<Error> error_;
};

/// The length of the number that begins at `at`, if it is one that double precision cannot hold; else 0.
std::size_t length_of_overflow(std::string_view text, std::size_t at) {
    const char before = at > 0 ? text[at - 1] : ' ';
    const bool begins = text[at] == '-' || (text[at] >= '0' && text[at] <= '9');
    if (!begins || std::string_view("+-.eE0123456789").find(before) != std::string_view::npos) {
        return 0;
    }
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), value);
    const auto length = static_cast<std::size_t>(end - (text.data() + at));
    const std::string_view number = text.substr(at, length);
    const bool small = number.find("e-") != std::string_view::npos || number.find("E-") != std::string_view::npos ||
                       number.starts_with("0.") || number.starts_with("-0.");
    return error == std::errc::result_out_of_range && !small ? length : 0;
}

/// JSON has no word for what is no finite number, though many programs write one, and no limit to a number's size. As
/// strings, both are met where the key and its range are known.
std::string quote_words_for_no_number(std::string_view text) {
    std::string quoted;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size();) {
        std::size_t length = 1;
        bool is_word = false;
        for (const std::string_view word : not_finite_words) {
            if (!in_string && text.substr(i, word.size()) == word) {
                length = word.size();
                is_word = true;
                break;
            }
        }
        const std::size_t overflow = in_string ? 0 : length_of_overflow(text, i);
        if (overflow > 0) {
            quoted += text[i] == '-' ? "\"-Infinity\"" : "\"Infinity\"";
            i += overflow;
            continue;
        }
        if (in_string && text[i] == '\\') {
            length = 2;
        } else if (text[i] == '"') {
            in_string = !in_string;
        }
        const std::string piece(text.substr(i, length));
        quoted += is_word ? '"' + piece + '"' : piece;
        i += length;
    }
    return quoted;
}

} // namespace

tl::expected<void, Error> set_density(Fog& fog, const DensityPicture& picture, std::uint32_t width,
                                      std::uint32_t height, std::vector<std::uint8_t> values) {
    if (height % picture.slices != 0) {
        return tl::unexpected(Error{picture.key + " must have a height that is a multiple of its " +
                                    std::to_string(picture.slices) + " slices, not " + std::to_string(height) + "."});
    }
    auto texels = DensityTexels::create({width, height / picture.slices, picture.slices}, std::move(values));
    if (!texels) {
        return tl::unexpected(Error{picture.key + ": " + texels.error().message});
    }
    (picture.volume ? fog.medium.volumes[*picture.volume].density : fog.medium.map.texels) = std::move(*texels);
    return {};
}

tl::expected<Fog, Error> parse_fog_json(std::string_view text) {
    const std::string quoted = quote_words_for_no_number(text);
    SyntaxCheck syntax;
    if (!Json::sax_parse(quoted.begin(), quoted.end(), &syntax)) {
        return tl::unexpected(syntax.error().value_or(Error{"The fog file is not valid JSON."}));
    }
    const Json document = Json::parse(quoted.begin(), quoted.end(), nullptr, false);
    Fog fog;
    std::optional<Error> error;
    {
        Section root(document, "", error);
        read_medium(root, fog, error);
        read_settings(root, fog.settings, error);
    }
    if (error) {
        return tl::unexpected(*error);
    }
    if (auto valid = validate(fog.medium); !valid) {
        return tl::unexpected(valid.error());
    }
    if (auto valid = validate(fog.settings); !valid) {
        return tl::unexpected(valid.error());
    }
    return fog;
}

} // namespace tyndall::volumetrics
