// One object of a fog file, read key by key.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include "features/volumetrics/error.hpp"
#include "features/volumetrics/fog_json.hpp"
#include "features/volumetrics/range_check.hpp"

namespace tyndall::volumetrics {

using Json = nlohmann::json;

/// How programs write in JSON what is no finite number.
inline constexpr std::array<std::string_view, 3> not_finite_words{"NaN", "-Infinity", "Infinity"};

/// Reads known keys of one object; what is left over at the end is unknown. Keeps the first complaint of all sections.
class Section {
public:
    Section(const Json& object, std::string path, std::optional<Error>& error)
        : object_(&object), path_(std::move(path)), error_(&error) {
        if (!object.is_object()) {
            complain(path_.empty() ? "The fog file" : path_, "must be an object");
            object_ = nullptr;
        }
    }
    Section(const Section&) = delete;
    Section& operator=(const Section&) = delete;
    ~Section() {
        if (object_ == nullptr) {
            return;
        }
        for (auto entry = object_->begin(); entry != object_->end(); ++entry) {
            if (!known_.contains(entry.key())) {
                std::string keys; // beside others they may be others: of another kind of noise, say
                for (const std::string& key : known_) {
                    keys += (keys.empty() ? "" : ", ") + key;
                }
                complain(path_of(entry.key()), "is not a key here, where the keys are " + keys);
            }
        }
    }

    [[nodiscard]] const Json* find(const char* key) {
        known_.insert(key);
        if (object_ == nullptr) {
            return nullptr;
        }
        const auto found = object_->find(key);
        return found == object_->end() ? nullptr : &*found;
    }
    void read(const char* key, float& value) {
        if (const Json* json = find(key)) {
            value = number(*json, path_of(key), value);
        }
    }
    void read(const char* key, bool& value) {
        if (const Json* json = find(key)) {
            if (const auto* boolean = json->get_ptr<const Json::boolean_t*>()) {
                value = *boolean;
            } else {
                complain(path_of(key), "must be true or false");
            }
        }
    }
    /// A whole number; that it lies in the range, which is named where it is none, is left to `validate`.
    void read_whole(const char* key, std::uint32_t& value, std::uint32_t least, std::uint32_t most) {
        const Json* json = find(key);
        if (json == nullptr) {
            return;
        }
        const double given = json->is_number() ? json->get<double>() : std::numeric_limits<double>::quiet_NaN();
        if (given >= 0.0 && given <= std::numeric_limits<std::uint32_t>::max() && given == std::floor(given)) {
            value = static_cast<std::uint32_t>(given);
        } else {
            complain(path_of(key), "must be a whole number between " + std::to_string(least) + " and " +
                                       std::to_string(most) +
                                       (json->is_number() ? ", not " + text_of(given) : std::string()));
        }
    }
    void read(const char* key, std::string& value) {
        if (const Json* json = find(key)) {
            const auto* text = json->get_ptr<const Json::string_t*>();
            if (text != nullptr && !text->empty()) {
                value = *text;
            } else {
                complain(path_of(key), "must be a text that is not empty");
            }
        }
    }
    void read(const char* key, glm::vec2& value) {
        const Json* json = find(key);
        if (json == nullptr) {
            return;
        }
        if (!json->is_array() || json->size() != 2) {
            complain(path_of(key), "must be an array of 2 numbers");
            return;
        }
        for (int i = 0; i < 2; ++i) {
            value[i] =
                number((*json)[static_cast<std::size_t>(i)], path_of(key) + "[" + std::to_string(i) + "]", value[i]);
        }
    }
    void read(const char* key, glm::vec3& value) {
        if (const Json* json = find(key)) {
            read_vector(*json, path_of(key), value);
        }
    }
    /// One number, or an array of one a channel: the largest, and all in parts of it.
    void read_extinction(const char* key, float& largest, glm::vec3& color) {
        const Json* json = find(key);
        if (json == nullptr || !json->is_array()) {
            read(key, largest);
            return;
        }
        glm::vec3 channels(0.0F);
        if (json->size() != 3) {
            complain(path_of(key), "must be a number or an array of 3 numbers");
            return;
        }
        read_vector(*json, path_of(key), channels);
        for (int i = 0; i < 3; ++i) {
            if (!(channels[i] >= 0.0F && channels[i] <= 1e6F)) {
                complain(path_of(key) + "[" + std::to_string(i) + "]",
                         "must be between 0 and 1e+06, not " + text_of(static_cast<double>(channels[i])));
                return;
            }
        }
        largest = std::max({channels.x, channels.y, channels.z});
        color = largest > 0.0F ? channels / largest : glm::vec3(1.0F);
    }
    void read(const char* key, std::array<glm::vec3, 3>& value) {
        const Json* json = find(key);
        if (json == nullptr) {
            return;
        }
        if (!json->is_array() || json->size() != 3) {
            complain(path_of(key), "must be an array of 3 arrays of 3 numbers");
            return;
        }
        for (std::size_t i = 0; i < 3; ++i) {
            read_vector((*json)[i], path_of(key) + "[" + std::to_string(i) + "]", value[i]);
        }
    }
    void read(const char* key, glm::quat& value) {
        const Json* json = find(key);
        if (json == nullptr) {
            return;
        }
        if (!json->is_array() || json->size() != 4) {
            complain(path_of(key), "must be an array of 4 numbers, a quaternion x, y, z, w");
            return;
        }
        float* parts[] = {&value.x, &value.y, &value.z, &value.w};
        for (std::size_t i = 0; i < 4; ++i) {
            *parts[i] = number((*json)[i], path_of(key) + "[" + std::to_string(i) + "]", *parts[i]);
        }
    }
    void read_list(const char* key, std::vector<float>& values) {
        const Json* json = find(key);
        if (json == nullptr) {
            return;
        }
        if (!json->is_array()) {
            complain(path_of(key), "must be an array of numbers");
            return;
        }
        for (const Json& entry : *json) {
            values.push_back(number(entry, path_of(key) + "[" + std::to_string(values.size()) + "]", 0.0F));
        }
    }
    void read_per_cascade(const char* key, std::array<float, 4>& value) {
        const Json* json = find(key);
        if (json == nullptr) {
            return;
        }
        if (!json->is_array()) {
            value.fill(number(*json, path_of(key), value[0]));
        } else if (json->size() != value.size()) {
            complain(path_of(key), "must be one number, or an array of 4 for the cascades");
        } else {
            for (std::size_t i = 0; i < value.size(); ++i) {
                value[i] = number((*json)[i], path_of(key) + "[" + std::to_string(i) + "]", value[i]);
            }
        }
    }
    void read(const char* key, StorageFormat& value) {
        if (const Json* json = find(key)) {
            const auto* name = json->get_ptr<const Json::string_t*>();
            if (name != nullptr && (*name == "fp16" || *name == "fp32")) {
                value = *name == "fp16" ? StorageFormat::fp16 : StorageFormat::fp32;
            } else {
                complain(path_of(key), "must be \"fp16\" or \"fp32\"");
            }
        }
    }
    /// One of the names of `choices`.
    template <typename Enum>
    void read(const char* key, Enum& value, std::initializer_list<std::pair<std::string_view, Enum>> choices) {
        const Json* json = find(key);
        if (json == nullptr) {
            return;
        }
        const auto* name = json->get_ptr<const Json::string_t*>();
        std::string names;
        for (const auto& [choice, meaning] : choices) {
            if (name != nullptr && *name == choice) {
                value = meaning;
                return;
            }
            names += (names.empty() ? "\"" : ", \"") + std::string(choice) + "\"";
        }
        complain(path_of(key), "must be one of " + names);
    }
    void complain(const std::string& path, const std::string& what) {
        if (!*error_) {
            *error_ = Error{path + " " + what + "."};
        }
    }
    [[nodiscard]] bool has(const char* key) const { return object_ != nullptr && object_->contains(key); }
    [[nodiscard]] std::string path_of(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

private:
    void read_vector(const Json& json, const std::string& path, glm::vec3& value) {
        if (!json.is_array() || json.size() != 3) {
            complain(path, "must be an array of 3 numbers");
            return;
        }
        for (int i = 0; i < 3; ++i) {
            value[i] = number(json[static_cast<std::size_t>(i)], path + "[" + std::to_string(i) + "]", value[i]);
        }
    }
    float number(const Json& json, const std::string& path, float fallback) {
        const auto* word = json.get_ptr<const Json::string_t*>();
        for (const std::string_view not_finite : not_finite_words) {
            if (word != nullptr && *word == not_finite) { // outside every range, so that `validate` names it
                return not_finite == "NaN"         ? std::numeric_limits<float>::quiet_NaN()
                       : not_finite == "-Infinity" ? -std::numeric_limits<float>::infinity()
                                                   : std::numeric_limits<float>::infinity();
            }
        }
        if (!json.is_number()) {
            complain(path, "must be a number");
            return fallback;
        }
        const double value = json.get<double>();
        if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) {
            return value > 0.0 ? std::numeric_limits<float>::infinity() : -std::numeric_limits<float>::infinity();
        }
        return static_cast<float>(value);
    }

    const Json* object_;
    std::string path_;
    std::optional<Error>* error_;
    std::set<std::string> known_;
};

/// Runs `read` on the object at `key`, if there is one.
template <typename Read>
void subsection(Section& parent, const char* key, std::optional<Error>& error, Read read) {
    if (const Json* json = parent.find(key)) {
        Section section(*json, parent.path_of(key), error);
        read(section);
    }
}

/// Runs `read` on each object of the array at `key`, if there is one, and returns their number, at most `most`.
template <typename Read>
std::uint32_t elements(Section& parent, const char* key, std::uint32_t most, std::optional<Error>& error, Read read) {
    const Json* json = parent.find(key);
    if (json == nullptr) {
        return 0;
    }
    if (!json->is_array() || json->empty() || json->size() > most) {
        parent.complain(parent.path_of(key), "must be an array of 1 to " + std::to_string(most) + " objects");
        return 0;
    }
    const auto count = static_cast<std::uint32_t>(json->size());
    for (std::uint32_t i = 0; i < count; ++i) {
        Section section((*json)[i], parent.path_of(key) + "[" + std::to_string(i) + "]", error);
        read(section, i);
    }
    return count;
}

/// The media, phase function and ambient light; the rest.
void read_medium(Section& root, Fog& fog, std::optional<Error>& error);
void read_settings(Section& root, Settings& settings, std::optional<Error>& error);

} // namespace tyndall::volumetrics
