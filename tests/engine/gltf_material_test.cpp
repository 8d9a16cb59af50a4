// Materials, textures, samplers and the material extensions.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/engine/gltf_fixture.hpp"

namespace tyndall::engine::test {
namespace {

std::string png_uri(std::uint8_t r, std::uint8_t g, std::uint8_t b, std::uint8_t a) {
    return "data:image/png;base64," + base64(one_pixel_png(r, g, b, a));
}

/// The triangle with this material; texture i shows image i, all of which are one pixel (10 i, 20, 30, 40).
GltfFile with_material(json material, int texture_count = 0) {
    GltfFile file;
    file.add_triangle(std::move(material));
    for (int i = 0; i < texture_count; ++i) {
        file.add("images", {{"uri", png_uri(static_cast<std::uint8_t>(10 * i), 20, 30, 40)}});
        file.add("textures", {{"source", i}});
    }
    return file;
}

Scene loaded(const GltfFile& file) {
    auto scene = file.load();
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? std::move(*scene) : Scene{.materials = {Material{}}};
}

TEST(GltfMaterial, DefaultsAreThoseOfTheSpecification) {
    const Material material = loaded(with_material(json::object())).materials.front();
    EXPECT_EQ(material.base_color_factor, glm::vec4(1.0F));
    EXPECT_EQ(material.metallic_factor, 1.0F);
    EXPECT_EQ(material.roughness_factor, 1.0F);
    EXPECT_EQ(material.emissive, glm::vec3(0.0F));
    EXPECT_EQ(material.alpha_mode, AlphaMode::opaque);
    EXPECT_EQ(material.alpha_cutoff, 0.5F);
    EXPECT_EQ(material.specular_factor, 1.0F);
    EXPECT_EQ(material.specular_color_factor, glm::vec3(1.0F));
    EXPECT_FALSE(material.double_sided);
    EXPECT_FALSE(material.unlit);
    EXPECT_FALSE(material.base_color);
}

TEST(GltfMaterial, PrimitiveWithoutMaterialUsesTheDefaultOneAtTheEnd) {
    GltfFile file = with_material({{"name", "unused"}});
    file.root["meshes"][0]["primitives"][0].erase("material");
    const Scene scene = loaded(file);
    ASSERT_EQ(scene.materials.size(), 2U);
    EXPECT_EQ(scene.primitives[0].material, 1U);
    EXPECT_EQ(scene.materials[1].name, "default");
}

TEST(GltfMaterial, FactorsAndModesAreRead) {
    const Scene scene = loaded(with_material(
        {{"name", "leaf"},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.25},
         {"doubleSided", true},
         {"emissiveFactor", {0.5, 0.25, 1.0}},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.75}}}}));
    const Material& material = scene.materials.front();
    EXPECT_EQ(material.name, "leaf");
    EXPECT_EQ(material.alpha_mode, AlphaMode::mask);
    EXPECT_EQ(material.alpha_cutoff, 0.25F);
    EXPECT_TRUE(material.double_sided);
    EXPECT_EQ(material.base_color_factor, glm::vec4(0.1F, 0.2F, 0.3F, 0.4F));
    EXPECT_EQ(material.metallic_factor, 0.5F);
    EXPECT_EQ(material.roughness_factor, 0.75F);
    EXPECT_EQ(material.emissive, glm::vec3(0.5F, 0.25F, 1.0F));
    EXPECT_EQ(loaded(with_material({{"alphaMode", "BLEND"}})).materials[0].alpha_mode, AlphaMode::blend);
}

TEST(GltfMaterial, AnExtraSaysHowWhatIsBlendedIs) {
    const auto with_extra = [](const json& blend, const char* mode = "BLEND") {
        return loaded(with_material({{"alphaMode", mode}, {"extras", {{"blend", blend}, {"mood", "grim"}}}}));
    };
    EXPECT_EQ(loaded(with_material({{"alphaMode", "BLEND"}})).materials[0].blend, Blend::premultiplied);
    EXPECT_EQ(with_extra("premultiplied").materials[0].blend, Blend::premultiplied);
    EXPECT_EQ(with_extra("additive").materials[0].blend, Blend::additive);
    EXPECT_EQ(with_extra("multiply").materials[0].blend, Blend::multiply);
    for (const json& wrong : {json("screen"), json(1), json::array({"additive"})}) {
        EXPECT_EQ(with_extra(wrong).materials[0].blend, Blend::premultiplied);
    }
    EXPECT_TRUE(has_note(with_extra("screen"),
                         "Material 0 has an extra 'blend' that is not \"premultiplied\", \"additive\" or \"multiply\", "
                         "which is left out."));
    EXPECT_TRUE(has_note(with_extra(1), "Material 0 has an extra 'blend' that is not"));
    const Scene opaque = with_extra("additive", "OPAQUE");
    EXPECT_EQ(opaque.materials[0].blend, Blend::premultiplied);
    EXPECT_TRUE(has_note(opaque, "Material 0 has an extra 'blend' without the alphaMode BLEND, which is left out."));
}

TEST(GltfMaterial, FactorsOutsideOfTheirRangeAreClampedWithANote) {
    const Scene scene = loaded(with_material({{"pbrMetallicRoughness", {{"metallicFactor", 7.0}}}}));
    EXPECT_EQ(scene.materials[0].metallic_factor, 1.0F);
    EXPECT_TRUE(has_note(scene, "Material 0 has a factor outside of its range"));
}

TEST(GltfMaterial, UseDecidesBetweenColourAndDataAndImagesAreShared) {
    const Scene scene = loaded(with_material(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 1}}}}},
         {"normalTexture", {{"index", 1}, {"scale", -0.5}}},
         {"occlusionTexture", {{"index", 0}, {"strength", 0.25}, {"texCoord", 1}}},
         {"emissiveTexture", {{"index", 0}}}},
        3));
    const Material& material = scene.materials[0];
    EXPECT_TRUE(scene.textures[material.base_color->texture].srgb);
    EXPECT_TRUE(scene.textures[material.emission->texture].srgb);
    EXPECT_FALSE(scene.textures[material.metallic_roughness->texture].srgb);
    EXPECT_FALSE(scene.textures[material.normal->texture].srgb);
    EXPECT_FALSE(scene.textures[material.occlusion->texture].srgb);
    EXPECT_EQ(material.normal_scale, -0.5F);
    EXPECT_EQ(material.occlusion_strength, 0.25F);
    EXPECT_EQ(material.occlusion->uv_set, 1U);
    EXPECT_EQ(material.base_color->uv_set, 0U);
    EXPECT_EQ(scene.textures.size(), 3U) << "texture 0 as colour and as data, texture 1 as data";
    ASSERT_EQ(scene.images.size(), 2U) << "the third image is not used, the first one is decoded once";
    EXPECT_EQ(scene.images[0].rgba, (std::vector<std::uint8_t>{0, 20, 30, 40}));
    EXPECT_EQ(scene.images[1].rgba, (std::vector<std::uint8_t>{10, 20, 30, 40}));
}

TEST(GltfMaterial, ImagesComeFromFilesAndBufferViewsToo) {
    const std::vector<std::uint8_t> png = one_pixel_png(1, 2, 3, 4);
    GltfFile in_view;
    in_view.add_triangle({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    in_view.add("textures", {{"source", 0}});
    GltfFile in_file = in_view;
    in_view.add("images", {{"bufferView", in_view.add_view(png)}, {"mimeType", "image/png"}});
    EXPECT_EQ(loaded(in_view).images.at(0).rgba, (std::vector<std::uint8_t>{1, 2, 3, 4}));

    in_file.add("images", {{"uri", "my%20picture.png"}});
    const TemporaryFolder folder;
    folder.write("my picture.png", std::string(png.begin(), png.end()));
    const auto scene = load_gltf(folder.write("test.gltf", in_file.text()));
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->images.at(0).rgba, (std::vector<std::uint8_t>{1, 2, 3, 4}));
    EXPECT_EQ(scene->images.at(0).name, "'my picture.png'");
}

TEST(GltfMaterial, SamplersAreRead) {
    GltfFile file = with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}, 1);
    EXPECT_EQ(loaded(file).textures.at(0).sampler, Sampler{}) << "open: trilinear, repeated";
    file.root["textures"][0]["sampler"] =
        file.add("samplers", {{"magFilter", 9728}, {"minFilter", 9985}, {"wrapS", 33071}, {"wrapT", 33648}});
    Sampler expected;
    expected.magnify = Filter::nearest;
    expected.between_levels = Filter::nearest;
    expected.wrap_u = Wrap::clamp_to_edge;
    expected.wrap_v = Wrap::mirrored_repeat;
    EXPECT_EQ(loaded(file).textures.at(0).sampler, expected);
    file.root["samplers"][0] = {{"minFilter", 9728}};
    EXPECT_FALSE(loaded(file).textures.at(0).sampler.has_levels);
    EXPECT_EQ(loaded(file).textures.at(0).sampler.minify, Filter::nearest);
}

TEST(GltfMaterial, TextureTransformIsTranslationRotationScale) {
    // KHR_texture_transform's own example: rotation counter-clockwise, v pointing down.
    const double quarter = std::acos(0.0);
    const json transform = {{"offset", {10.0, 20.0}}, {"rotation", quarter}, {"scale", {2.0, 3.0}}, {"texCoord", 1}};
    const Scene scene = loaded(with_material(
        {{"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}}},
        1));
    const TextureUse use = scene.materials[0].base_color.value();
    EXPECT_EQ(use.uv_set, 1U);
    const glm::vec2 of_u = use.apply({1, 0});
    const glm::vec2 of_v = use.apply({0, 1});
    EXPECT_NEAR(of_u.x, 10.0F, 1e-6F);
    EXPECT_NEAR(of_u.y, 18.0F, 1e-6F);
    EXPECT_NEAR(of_v.x, 13.0F, 1e-6F);
    EXPECT_NEAR(of_v.y, 20.0F, 1e-6F);
}

TEST(GltfMaterial, UnlitSpecularAndEmissiveStrengthAreRead) {
    const Scene scene = loaded(with_material({{"emissiveFactor", {0.5, 1.0, 0.0}},
                                              {"extensions",
                                               {{"KHR_materials_unlit", json::object()},
                                                {"KHR_materials_emissive_strength", {{"emissiveStrength", 400}}},
                                                {"KHR_materials_specular",
                                                 {{"specularFactor", 0.5},
                                                  {"specularTexture", {{"index", 0}}},
                                                  {"specularColorFactor", {0.25, 0.5, 2.0}},
                                                  {"specularColorTexture", {{"index", 1}}}}}}}},
                                             2));
    const Material& material = scene.materials[0];
    EXPECT_TRUE(material.unlit);
    EXPECT_EQ(material.emissive, glm::vec3(200.0F, 400.0F, 0.0F));
    EXPECT_EQ(material.specular_factor, 0.5F);
    EXPECT_EQ(material.specular_color_factor, glm::vec3(0.25F, 0.5F, 2.0F));
    EXPECT_FALSE(scene.textures[material.specular->texture].srgb);
    EXPECT_TRUE(scene.textures[material.specular_color->texture].srgb);
}

TEST(GltfMaterial, SpecularGlossinessBecomesMetallicRoughness) {
    const Scene scene = loaded(with_material({{"extensions",
                                               {{"KHR_materials_pbrSpecularGlossiness",
                                                 {{"diffuseFactor", {0.1, 0.2, 0.3, 0.5}},
                                                  {"diffuseTexture", {{"index", 0}}},
                                                  {"specularFactor", {0.04, 0.08, 0.0}},
                                                  {"glossinessFactor", 0.5},
                                                  {"specularGlossinessTexture", {{"index", 1}}}}}}}},
                                             2));
    const Material& material = scene.materials[0];
    EXPECT_EQ(material.base_color_factor, glm::vec4(0.1F, 0.2F, 0.3F, 0.5F));
    EXPECT_EQ(material.metallic_factor, 0.0F);
    // Reflectance 0.04 is that of the default dielectric, factor 1.
    EXPECT_NEAR(material.specular_color_factor.r, 1.0F, 1e-6F);
    EXPECT_NEAR(material.specular_color_factor.g, 2.0F, 1e-6F);
    EXPECT_EQ(material.specular_color_factor.b, 0.0F);
    const Image& roughness = scene.images[scene.textures[material.metallic_roughness->texture].image];
    EXPECT_EQ(roughness.rgba[1], 255 - 20) << "1 - 0.5 * 40 / 255";
    EXPECT_TRUE(has_note(scene, "converted"));
}

TEST(GltfMaterial, TextureOfAnUnknownFormatIsLeftOutWithANote) {
    GltfFile file = with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    file.add("textures", {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}});
    const Scene scene = loaded(file);
    EXPECT_FALSE(scene.materials[0].base_color);
    EXPECT_TRUE(has_note(scene, "Texture 0 has no image in a format that is read and is left out."));
}

} // namespace
} // namespace tyndall::engine::test
