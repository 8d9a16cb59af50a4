#include "samples/hall/sidecars.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "samples/hall/layout.hpp"

namespace tyndall::hall {
namespace {

// Keeps the order of insertion, and prints a float with as few digits as bring it back.
using Json =
    nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool, std::int64_t, std::uint64_t, float>;

Json to_json(glm::vec3 v) {
    return Json::array({v.x, v.y, v.z});
}

Json smoke_emitter(const std::string& name, glm::vec3 brazier) {
    return {{"name", name},
            {"kind", "smoke"},
            {"position_m", to_json(brazier + glm::vec3{0.0F, brazier_bowl_m + 0.35F, 0.0F})},
            {"box_half_extent_m", {0.16F, 0.05F, 0.16F}},
            {"rate_per_s", 16.0F},
            {"lifetime_s", 7.0F},
            {"velocity_m_s", {0.04F, 0.75F, 0.02F}},
            {"velocity_spread_m_s", {0.12F, 0.15F, 0.12F}},
            {"buoyancy_m_s2", 0.06F},
            {"drag_per_s", 0.12F},
            {"turbulence_m_s", 0.16F},
            {"start_radius_m", 0.16F},
            {"end_radius_m", 0.95F},
            {"opacity", 0.22F},
            {"albedo", {0.72F, 0.70F, 0.68F}}};
}

} // namespace

std::string fog_json() {
    const Json fog{{"medium",
                    {{"homogeneous", {{"extinction_per_m", 0.016F}, {"albedo", {0.95F, 0.95F, 0.95F}}}},
                     {"height",
                      {{"extinction_per_m", 0.03F},
                       {"albedo", {0.95F, 0.95F, 0.95F}},
                       {"base_height_m", 0.0F},
                       {"falloff_per_m", 0.4F}}},
                     {"noise", {{"amplitude", 0.55F}, {"scale_m", 2.6F}, {"wind_m_s", {0.25F, 0.04F, 0.12F}}}}}},
                   {"phase", {{"g", 0.6F}}},
                   {"ambient", {{"radiance", {17.0F, 15.5F, 14.5F}}}},
                   {"grid", {{"width", 160}, {"height", 90}, {"slices", 64}, {"range_m", 40.0F}, {"shape_m", 12.0F}}},
                   {"temporal", {{"enabled", true}, {"new_frame_weight", 0.05F}}}};
    return fog.dump(1) + "\n";
}

std::string particles_json() {
    Json emitters = Json::array();
    const std::vector<std::string> names{"dais_left_smoke", "dais_right_smoke", "nave_smoke"};
    for (std::size_t i = 0; i < names.size(); ++i) {
        emitters.push_back(smoke_emitter(names[i], brazier_positions_m[i]));
    }
    emitters.push_back({{"name", "hall_dust"},
                        {"kind", "dust"},
                        {"position_m", {1.0F, 2.6F, 2.0F}},
                        {"box_half_extent_m", {5.6F, 2.5F, 12.0F}},
                        {"rate_per_s", 120.0F},
                        {"lifetime_s", 14.0F},
                        {"velocity_m_s", {0.02F, -0.01F, 0.01F}},
                        {"velocity_spread_m_s", {0.05F, 0.04F, 0.05F}},
                        {"buoyancy_m_s2", 0.0F},
                        {"drag_per_s", 0.0F},
                        {"turbulence_m_s", 0.05F},
                        {"start_radius_m", 0.006F},
                        {"end_radius_m", 0.008F},
                        {"opacity", 0.55F},
                        {"albedo", {0.90F, 0.86F, 0.80F}}});
    return Json{{"emitters", emitters}}.dump(1) + "\n";
}

} // namespace tyndall::hall
