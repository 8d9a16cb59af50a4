// What the particle file may say, and the sentence for each mistake.
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/particle_frame.hpp"
#include "engine/particles_json.hpp"

namespace tyndall::engine {
namespace {

/// An emitter with all that is required, and `more` (begins with a comma).
std::string file(const std::string& more, const std::string& name = "a") {
    return R"({"emitters": [{"name": ")" + name +
           R"(", "kind": "dust", "position_m": [1, 2, 3], "rate_per_s": 4, "lifetime_s": 2.5, "start_radius_m": 0.1,)"
           R"( "end_radius_m": 0.2, "opacity": 0.5)" +
           more + "}]}";
}

std::string error_of(const std::string& text) {
    const auto parsed = parse_particles_json(text);
    return parsed ? "" : parsed.error().message;
}

TEST(ParticlesJson, ReadsEveryKey) {
    const auto parsed = parse_particles_json(file(
        R"(, "box_half_extent_m": [0.5, 0, 2], "velocity_m_s": [1, -2, 3], "velocity_spread_m_s": [4, 5, 6],)"
        R"( "buoyancy_m_s2": -0.5, "drag_per_s": 0.25, "turbulence_m_s": 0.125, "albedo": [0.5, 1, 0], "seed": 7, "blend": "multiply")"));
    ASSERT_TRUE(parsed.has_value()) << parsed.error().message;
    ASSERT_EQ(parsed->size(), 1U);
    const ParticleEmitter& emitter = parsed->front();
    EXPECT_EQ(emitter.name, "a");
    EXPECT_EQ(emitter.kind, ParticleKind::dust);
    EXPECT_EQ(emitter.position_m, glm::dvec3(1, 2, 3));
    EXPECT_EQ(emitter.box_half_extent_m, glm::vec3(0.5F, 0.0F, 2.0F));
    EXPECT_EQ(emitter.rate_per_s, 4.0);
    EXPECT_EQ(emitter.lifetime_s, 2.5);
    EXPECT_EQ(emitter.velocity_m_s, glm::vec3(1, -2, 3));
    EXPECT_EQ(emitter.velocity_spread_m_s, glm::vec3(4, 5, 6));
    EXPECT_EQ(emitter.buoyancy_m_s2, -0.5F);
    EXPECT_EQ(emitter.drag_per_s, 0.25F);
    EXPECT_EQ(emitter.turbulence_m_s, 0.125F);
    EXPECT_EQ(emitter.start_radius_m, 0.1F);
    EXPECT_EQ(emitter.end_radius_m, 0.2F);
    EXPECT_EQ(emitter.opacity, 0.5F);
    EXPECT_EQ(emitter.albedo, glm::vec3(0.5F, 1.0F, 0.0F));
    EXPECT_EQ(emitter.seed, 7U);
    EXPECT_EQ(emitter.blend, Blend::multiply);
    EXPECT_EQ(particle_slots(emitter), 11U);
}

TEST(ParticlesJson, OptionalKeysHaveDefaultsAndTheSeedIsTheIndex) {
    const std::string one = file("");
    const std::string two = file("", "b");
    const std::string emitter_b = two.substr(two.find('{', 1), two.size() - two.find('{', 1) - 2);
    const auto parsed = parse_particles_json(one.substr(0, one.size() - 2) + ", " + emitter_b + "]}");
    ASSERT_TRUE(parsed.has_value()) << parsed.error().message;
    ASSERT_EQ(parsed->size(), 2U);
    EXPECT_EQ((*parsed)[0].seed, 0U);
    EXPECT_EQ((*parsed)[1].seed, 1U);
    EXPECT_EQ((*parsed)[1].albedo, glm::vec3(1.0F));
    EXPECT_EQ((*parsed)[1].blend, Blend::premultiplied);
    EXPECT_EQ(particle_count(*parsed), 22U);
    EXPECT_EQ(particle_key_count(22), 32U);
}

TEST(ParticlesJson, AnEmptyListIsAllowed) {
    const auto parsed = parse_particles_json(R"({"emitters": []})");
    ASSERT_TRUE(parsed.has_value());
    EXPECT_TRUE(parsed->empty());
}

struct Mistake {
    std::string text;
    std::string sentence;
};

TEST(ParticlesJson, EachMistakeNamesItsKey) {
    const std::string long_life = R"({"emitters": [{"name": "a", "kind": "dust", "position_m": [0, 0, 0],)"
                                  R"( "rate_per_s": 1000, "lifetime_s": 1000, "start_radius_m": 1, "end_radius_m": 1,)"
                                  R"( "opacity": 1}]})";
    const std::string point = R"({"emitters": [{"name": "a", "kind": "dust", "position_m": [0, 0, 0],)"
                              R"( "rate_per_s": 1, "lifetime_s": 1, "start_radius_m": 0, "end_radius_m": 0,)"
                              R"( "opacity": 1}]})";
    const Mistake mistakes[] = {
        {"", "The particle file is not valid JSON near byte 1."},
        {R"({"emitters": [)", "The particle file is not valid JSON near byte 15."},
        {"[]", "The particle file must be an object with the key \"emitters\"."},
        {"{}", "emitters must be an array of objects."},
        {R"({"emitters": {}})", "emitters must be an array of objects."},
        {R"({"emitters": [], "emitter": 1})", "emitter is not a key of the particle file."},
        {R"({"emitters": [1]})", "emitters[0] must be an object."},
        {R"({"emitters": [{}]})", "emitters[0].name is missing."},
        {file("", ""), "emitters[0].name must be a string that is not empty."},
        {file(R"(, "colour": [1, 1, 1])"), "emitters[0].colour is not a key of an emitter."},
        {file(R"(, "seed": 1, "seed": 2)"), "The particle file gives the key \"seed\" twice in one object."},
        {file(R"(, "seed": -1)"), "emitters[0].seed must be a whole number from 0 to 4294967295."},
        {file(R"(, "albedo": [1, 1])"), "emitters[0].albedo must be an array of 3 numbers."},
        {file(R"(, "albedo": [1, 2, 1])"), "emitters[0].albedo[1] is 2, which is not from 0 to 1."},
        {file(R"(, "albedo": [1, "x", 1])"), "emitters[0].albedo[1] must be a number."},
        {file(R"(, "drag_per_s": -1)"), "emitters[0].drag_per_s is -1, which is not from 0 to 10000."},
        {file(R"(, "turbulence_m_s": true)"), "emitters[0].turbulence_m_s must be a number."},
        {file(R"(, "box_half_extent_m": [0, -1, 0])"),
         "emitters[0].box_half_extent_m[1] is -1, which is not from 0 to 1e+06."},
        {file(R"(, "blend": "screen")"), "emitters[0].blend must be \"premultiplied\", \"additive\" or \"multiply\"."},
        {file(R"(, "blend": 1)"), "emitters[0].blend must be \"premultiplied\", \"additive\" or \"multiply\"."},
        {long_life, "emitters[0].rate_per_s times lifetime_s makes 1e+06 particles, more than 262143."},
        {point, "emitters[0].end_radius_m is 0 and so is start_radius_m: one of them must be more."},
    };
    for (const Mistake& mistake : mistakes) {
        EXPECT_EQ(error_of(mistake.text), mistake.sentence) << mistake.text;
    }
}

TEST(ParticlesJson, ImpossibleValuesOfRequiredKeys) {
    const auto with = [](const std::string& key, const std::string& value) {
        std::string text = file("");
        const std::size_t start = text.find("\"" + key + "\": ") + key.size() + 4;
        const std::size_t end = text[start] == '[' ? text.find(']', start) + 1 : text.find_first_of(",}", start);
        return text.replace(start, end - start, value);
    };
    EXPECT_EQ(error_of(with("rate_per_s", "0")), "emitters[0].rate_per_s is 0, which is not from 1e-06 to 100000.");
    EXPECT_EQ(error_of(with("lifetime_s", "-2")), "emitters[0].lifetime_s is -2, which is not from 1e-06 to 100000.");
    EXPECT_EQ(error_of(with("opacity", "1.5")), "emitters[0].opacity is 1.5, which is not from 0 to 1.");
    EXPECT_EQ(error_of(with("start_radius_m", "-1")),
              "emitters[0].start_radius_m is -1, which is not from 0 to 1e+06.");
    EXPECT_EQ(error_of(with("kind", "\"fire\"")), "emitters[0].kind must be \"smoke\" or \"dust\".");
    EXPECT_EQ(error_of(with("position_m", "[0, 0, 1e30]")),
              "emitters[0].position_m[2] is 1e+30, which is not from -1e+06 to 1e+06.");
    EXPECT_EQ(error_of(with("position_m", "[0, 0, 1e999]")),
              "The particle file holds a number that is too large for double precision.");
}

TEST(ParticlesJson, ReadsTheWaysOfBlending) {
    for (const auto& [word, blend] : {std::pair("premultiplied", Blend::premultiplied),
                                      {"additive", Blend::additive},
                                      {"multiply", Blend::multiply}}) {
        const auto parsed = parse_particles_json(file(R"(, "blend": ")" + std::string(word) + "\""));
        ASSERT_TRUE(parsed.has_value()) << parsed.error().message;
        EXPECT_EQ(parsed->front().blend, blend);
    }
}

TEST(Blend, OnlyMultiplyingNeedsASecondSource) {
    for (const Blend blend : {Blend::premultiplied, Blend::additive, Blend::multiply}) {
        EXPECT_TRUE(check_blend("It", blend, true));
    }
    EXPECT_TRUE(check_blend("It", Blend::premultiplied, false));
    EXPECT_TRUE(check_blend("It", Blend::additive, false));
    const auto refused = check_blend("The particle emitter \"soot\"", Blend::multiply, false);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message,
              "The particle emitter \"soot\" is blended by \"multiply\", which needs a device with dualSrcBlend.");
}

TEST(ParticlesJson, NamesAreUniqueAndTheTotalIsBounded) {
    const auto emitter = [](const std::string& name, const std::string& rate) {
        return R"({"name": ")" + name + R"(", "kind": "dust", "position_m": [0, 0, 0], "rate_per_s": )" + rate +
               R"(, "lifetime_s": 10, "start_radius_m": 1, "end_radius_m": 1, "opacity": 1})";
    };
    const auto list = [](const std::string& a, const std::string& b) {
        return R"({"emitters": [)" + a + ", " + b + "]}";
    };
    EXPECT_EQ(error_of(list(emitter("a", "1"), emitter("a", "1"))),
              "emitters[1].name \"a\" is that of an earlier emitter.");
    EXPECT_EQ(error_of(list(emitter("a", "20000"), emitter("b", "20000"))),
              "emitters[1].rate_per_s times lifetime_s brings all emitters together to 400002 particles, more than "
              "262144.");
}

} // namespace
} // namespace tyndall::engine
