#include "engine/particles_json.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

namespace tyndall::engine {
namespace {

using Json = nlohmann::json;

constexpr double largest_length_m = 1e6;
constexpr double largest_speed_m_s = 1e4;
constexpr double largest_rate_per_s = 1e5;
constexpr double largest_lifetime_s = 1e5;
constexpr double smallest_positive = 1e-6;

/// What a number must be: from `low` to `high`.
struct Domain {
    double low;
    double high;
};
constexpr Domain length{0.0, largest_length_m};
constexpr Domain signed_length{-largest_length_m, largest_length_m};
constexpr Domain speed{0.0, largest_speed_m_s};
constexpr Domain signed_speed{-largest_speed_m_s, largest_speed_m_s};
constexpr Domain share{0.0, 1.0};

std::string to_text(double value) {
    std::ostringstream stream;
    stream.imbue(std::locale::classic());
    stream << value;
    return stream.str();
}

/// Reads the keys of one emitter; keeps the first complaint.
class EmitterReader {
public:
    EmitterReader(const Json& object, std::string path) : object_(object), path_(std::move(path)) {}

    void read(const char* key, double& value, Domain domain, bool required = false) {
        if (const Json* json = find(key, required)) {
            value = number(*json, path_ + "." + key, domain, value);
        }
    }
    void read(const char* key, float& value, Domain domain, bool required = false) {
        double wide = static_cast<double>(value);
        read(key, wide, domain, required);
        value = static_cast<float>(wide);
    }
    template <typename Vector>
    void read_vector(const char* key, Vector& value, Domain domain, bool required = false) {
        const Json* json = find(key, required);
        if (json == nullptr) {
            return;
        }
        if (!json->is_array() || json->size() != 3) {
            complain(path_ + "." + key + " must be an array of 3 numbers.");
            return;
        }
        for (int i = 0; i < 3; ++i) {
            const std::string path = path_ + "." + key + "[" + std::to_string(i) + "]";
            value[i] = static_cast<typename Vector::value_type>(
                number((*json)[static_cast<std::size_t>(i)], path, domain, static_cast<double>(value[i])));
        }
    }
    void read(const char* key, std::string& value) {
        if (const Json* json = find(key, true)) {
            if (json->is_string() && !json->get_ref<const std::string&>().empty()) {
                value = json->get<std::string>();
            } else {
                complain(path_ + "." + key + " must be a string that is not empty.");
            }
        }
    }
    void read(const char* key, ParticleKind& value) {
        if (const Json* json = find(key, true)) {
            if (*json == "smoke" || *json == "dust") {
                value = *json == "smoke" ? ParticleKind::smoke : ParticleKind::dust;
            } else {
                complain(path_ + "." + key + " must be \"smoke\" or \"dust\".");
            }
        }
    }
    void read(const char* key, Blend& value) {
        if (const Json* json = find(key, false)) {
            const auto* word = json->get_ptr<const std::string*>();
            if (const auto blend = word != nullptr ? to_blend(*word) : std::nullopt) {
                value = *blend;
            } else {
                complain(path_ + "." + key + " must be " + std::string(blend_words) + ".");
            }
        }
    }
    void read(const char* key, std::uint32_t& value) {
        if (const Json* json = find(key, false)) {
            const auto* whole = json->get_ptr<const Json::number_unsigned_t*>();
            if (whole != nullptr && *whole <= std::numeric_limits<std::uint32_t>::max()) {
                value = static_cast<std::uint32_t>(*whole);
            } else {
                complain(path_ + "." + key + " must be a whole number from 0 to 4294967295.");
            }
        }
    }
    void refuse_unknown_keys() {
        for (auto entry = object_.begin(); entry != object_.end(); ++entry) {
            if (!known_.contains(entry.key())) {
                complain(path_ + "." + entry.key() + " is not a key of an emitter.");
            }
        }
    }
    void complain(std::string sentence) {
        if (!error_) {
            error_ = Error{std::move(sentence)};
        }
    }
    [[nodiscard]] const std::optional<Error>& error() const { return error_; }
    [[nodiscard]] const std::string& path() const { return path_; }

private:
    const Json* find(const char* key, bool required) {
        known_.insert(key);
        const auto found = object_.find(key);
        if (found != object_.end()) {
            return &*found;
        }
        if (required) {
            complain(path_ + "." + key + " is missing.");
        }
        return nullptr;
    }
    double number(const Json& json, const std::string& path, Domain domain, double fallback) {
        if (!json.is_number()) {
            complain(path + " must be a number.");
            return fallback;
        }
        const double value = json.get<double>();
        if (!(value >= domain.low && value <= domain.high)) {
            complain(path + " is " + to_text(value) + ", which is not from " + to_text(domain.low) + " to " +
                     to_text(domain.high) + ".");
            return fallback;
        }
        return value;
    }

    const Json& object_;
    std::string path_;
    std::set<std::string, std::less<>> known_;
    std::optional<Error> error_;
};

tl::expected<ParticleEmitter, Error> read_emitter(const Json& json, const std::string& path, std::uint32_t index) {
    if (!json.is_object()) {
        return tl::unexpected(Error{path + " must be an object."});
    }
    ParticleEmitter emitter;
    emitter.seed = index;
    EmitterReader reader(json, path);
    reader.read("name", emitter.name);
    reader.read("kind", emitter.kind);
    reader.read_vector("position_m", emitter.position_m, signed_length, true);
    reader.read_vector("box_half_extent_m", emitter.box_half_extent_m, length);
    reader.read("rate_per_s", emitter.rate_per_s, {smallest_positive, largest_rate_per_s}, true);
    reader.read("lifetime_s", emitter.lifetime_s, {smallest_positive, largest_lifetime_s}, true);
    reader.read_vector("velocity_m_s", emitter.velocity_m_s, signed_speed);
    reader.read_vector("velocity_spread_m_s", emitter.velocity_spread_m_s, speed);
    reader.read("buoyancy_m_s2", emitter.buoyancy_m_s2, signed_speed);
    reader.read("drag_per_s", emitter.drag_per_s, {0.0, 1e4});
    reader.read("turbulence_m_s", emitter.turbulence_m_s, speed);
    reader.read("start_radius_m", emitter.start_radius_m, length, true);
    reader.read("end_radius_m", emitter.end_radius_m, length, true);
    reader.read("opacity", emitter.opacity, share, true);
    reader.read_vector("albedo", emitter.albedo, share);
    reader.read("blend", emitter.blend);
    reader.read("seed", emitter.seed);
    reader.refuse_unknown_keys();
    if (!(emitter.start_radius_m > 0.0F || emitter.end_radius_m > 0.0F)) {
        reader.complain(path + ".end_radius_m is 0 and so is start_radius_m: one of them must be more.");
    }
    if (emitter.rate_per_s * emitter.lifetime_s >= static_cast<double>(largest_particle_count)) {
        reader.complain(path + ".rate_per_s times lifetime_s makes " +
                        to_text(emitter.rate_per_s * emitter.lifetime_s) + " particles, more than " +
                        std::to_string(largest_particle_count - 1) + ".");
    }
    if (reader.error()) {
        return tl::unexpected(*reader.error());
    }
    return emitter;
}

/// The document, or why it is none. Keys given twice are refused: the document's tree would keep only the last.
tl::expected<Json, Error> parse_document(std::string_view text) {
    std::vector<std::set<std::string>> keys;
    std::optional<std::string> repeated;
    const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
        if (event == Json::parse_event_t::object_start) {
            keys.emplace_back();
        } else if (event == Json::parse_event_t::object_end) {
            keys.pop_back();
        } else if (event == Json::parse_event_t::key &&
                   !keys.back().insert(parsed.get_ref<const std::string&>()).second && !repeated) {
            repeated = parsed.get<std::string>();
        }
        return true;
    };
    try {
        Json document = Json::parse(text.begin(), text.end(), watch);
        if (repeated) {
            return tl::unexpected(Error{"The particle file gives the key \"" + *repeated + "\" twice in one object."});
        }
        return document;
    } catch (const Json::parse_error& error) {
        return tl::unexpected(
            Error{"The particle file is not valid JSON near byte " + std::to_string(error.byte) + "."});
    } catch (const Json::out_of_range&) {
        return tl::unexpected(Error{"The particle file holds a number that is too large for double precision."});
    }
}

} // namespace

std::uint32_t particle_slots(const ParticleEmitter& emitter) {
    return static_cast<std::uint32_t>(std::floor(emitter.rate_per_s * emitter.lifetime_s)) + 1;
}

tl::expected<std::vector<ParticleEmitter>, Error> parse_particles_json(std::string_view text) {
    const tl::expected<Json, Error> document = parse_document(text);
    if (!document) {
        return tl::unexpected(document.error());
    }
    if (!document->is_object()) {
        return tl::unexpected(Error{"The particle file must be an object with the key \"emitters\"."});
    }
    for (auto entry = document->begin(); entry != document->end(); ++entry) {
        if (entry.key() != "emitters") {
            return tl::unexpected(Error{entry.key() + " is not a key of the particle file."});
        }
    }
    const auto list = document->find("emitters");
    if (list == document->end() || !list->is_array()) {
        return tl::unexpected(Error{"emitters must be an array of objects."});
    }
    std::vector<ParticleEmitter> emitters;
    std::set<std::string> names;
    std::uint64_t particles = 0;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const std::string path = "emitters[" + std::to_string(i) + "]";
        tl::expected<ParticleEmitter, Error> emitter = read_emitter((*list)[i], path, static_cast<std::uint32_t>(i));
        if (!emitter) {
            return tl::unexpected(emitter.error());
        }
        if (!names.insert(emitter->name).second) {
            return tl::unexpected(Error{path + ".name \"" + emitter->name + "\" is that of an earlier emitter."});
        }
        particles += particle_slots(*emitter);
        if (particles > largest_particle_count) {
            return tl::unexpected(Error{path + ".rate_per_s times lifetime_s brings all emitters together to " +
                                        std::to_string(particles) + " particles, more than " +
                                        std::to_string(largest_particle_count) + "."});
        }
        emitters.push_back(std::move(*emitter));
    }
    return emitters;
}

} // namespace tyndall::engine
