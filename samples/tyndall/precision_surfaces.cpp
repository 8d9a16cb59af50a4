#include "samples/tyndall/precision_surfaces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "samples/tyndall/frame_loop.hpp"

namespace tyndall::samples {
namespace {

template <typename T>
using Expected = tl::expected<T, std::string>;

/// Radiance under ambient light alone, of the pixels asked for.
Expected<std::vector<glm::dvec3>> draw(const engine::Device& device, engine::Scene scene,
                                       const engine::Ambient& ambient, Size size,
                                       std::span<const reference::Pixel> pixels) {
    for (engine::Light& light : scene.lights) {
        light.intensity = glm::vec3(0.0F);
    }
    FrameLoopInfo info;
    info.renderer.color_format = VK_FORMAT_R32G32B32A32_SFLOAT;
    info.renderer.ambient = ambient;
    info.renderer.background = engine::Background{};
    FrameWishes wishes;
    wishes.camera = scene.cameras.front();
    wishes.size = {size.width, size.height};
    wishes.cut = true;
    wishes.read_radiance = true;
    auto loop = FrameLoop::create(device, std::move(scene), std::move(info));
    if (!loop) {
        return tl::unexpected(loop.error().message);
    }
    if (const auto run = (*loop)->run(wishes); !run) {
        return tl::unexpected(run.error().message);
    }
    return values_at((*loop)->radiance(), pixels);
}

/// The scene turned so that what was toward `axis` is up; white, and dark by itself.
engine::Scene turned_white(engine::Scene scene, int axis) {
    for (engine::Material& material : scene.materials) {
        material.base_color_factor = glm::vec4(1.0F);
        material.base_color.reset();
        material.emissive = glm::vec3(0.0F);
    }
    for (engine::Primitive& primitive : scene.primitives) {
        std::fill(primitive.colors.begin(), primitive.colors.end(), glm::vec4(1.0F));
    }
    // A permutation of the axes that keeps their hand: `axis` becomes y.
    glm::dmat4 turn(0.0);
    turn[axis][1] = 1.0;
    turn[(axis + 1) % 3][2] = 1.0;
    turn[(axis + 2) % 3][0] = 1.0;
    turn[3][3] = 1.0;
    scene.bounds = {};
    for (engine::Instance& instance : scene.instances) {
        instance.world_from_object = turn * instance.world_from_object;
        const engine::Box box = instance.box;
        instance.box = {};
        instance.box.grow(glm::dvec3(turn * glm::dvec4(box.min, 1.0)));
        instance.box.grow(glm::dvec3(turn * glm::dvec4(box.max, 1.0)));
        instance.sphere.center = glm::dvec3(turn * glm::dvec4(instance.sphere.center, 1.0));
        scene.bounds.grow(instance.box);
    }
    for (engine::Camera& camera : scene.cameras) {
        camera.world_from_camera = turn * camera.world_from_camera;
    }
    return scene;
}

} // namespace

std::vector<glm::dvec3> values_at(const engine::Pixels<float>& image, std::span<const reference::Pixel> pixels) {
    std::vector<glm::dvec3> values;
    for (const reference::Pixel& pixel : pixels) {
        const float* rgb = image.values.data() + 3 * (std::size_t{pixel.y} * image.width + pixel.x);
        values.emplace_back(rgb[0], rgb[1], rgb[2]);
    }
    return values;
}

Expected<std::vector<std::optional<reference::SurfacePoint>>> drawn_surfaces(const engine::Device& device,
                                                                             const PrecisionScene& scene, Size size,
                                                                             std::span<const reference::Pixel> pixels) {
    const engine::Scene lit = engine_scene(scene);
    engine::Scene dark = lit;
    for (engine::Material& material : dark.materials) {
        material.emissive = glm::vec3(0.0F);
    }
    const engine::Ambient even{glm::vec3(1.0F), glm::vec3(1.0F)};
    const engine::Ambient above{glm::vec3(1.0F), glm::vec3(0.0F)};
    const auto albedo = draw(device, std::move(dark), even, size, pixels);
    const auto emission = draw(device, lit, {}, size, pixels);
    std::array<Expected<std::vector<glm::dvec3>>, 3> toward{draw(device, turned_white(lit, 0), above, size, pixels),
                                                            draw(device, turned_white(lit, 1), above, size, pixels),
                                                            draw(device, turned_white(lit, 2), above, size, pixels)};
    for (const auto* drawn :
         {&albedo, &emission, &std::as_const(toward[0]), &std::as_const(toward[1]), &std::as_const(toward[2])}) {
        if (!*drawn) {
            return tl::unexpected(drawn->error());
        }
    }
    const reference::Scene geometry = reference_scene(scene, {});
    std::vector<std::optional<reference::SurfacePoint>> points(pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const reference::Ray ray = reference::pixel_ray(scene.camera, {size.width, size.height}, pixels[i]);
        const std::optional<reference::Hit> hit = geometry.geometry.hit(ray);
        const glm::dvec3 normal(2.0 * (*toward[0])[i].x - 1.0, 2.0 * (*toward[1])[i].x - 1.0,
                                2.0 * (*toward[2])[i].x - 1.0);
        if (hit) {
            // At a silhouette the engine may draw what the ray just misses: no normal is of unit length there.
            const bool drawn = std::abs(glm::length(normal) - 1.0) < 0.05;
            points[i] = {reference::point_at(ray, hit->distance_m), drawn ? glm::normalize(normal) : hit->normal,
                         (*albedo)[i], (*emission)[i]};
        }
    }
    return points;
}

} // namespace tyndall::samples
