#include "samples/tyndall/precision_truths.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <system_error>

#include <glm/geometric.hpp>

#include "engine/file_io.hpp"
#include "samples/precision/hash.hpp"

namespace tyndall::samples {
namespace {

template <typename T>
using Expected = tl::expected<T, std::string>;

struct Truth {
    const char* name;
    Physics physics;
};
constexpr std::array truths{Truth{full_physics, {}}, Truth{"unweakened light paths", {.light_paths = false}},
                            Truth{"and no shadows of local lights", {.light_paths = false, .local_shadows = false}}};

bool has_local_shadows(const PrecisionScene& scene) {
    return std::any_of(scene.lights.begin(), scene.lights.end(),
                       [](const reference::Light& light) { return light.casts_shadows; });
}

/// Of this program's file; read once.
Expected<Hash> program_hash() {
    static const Expected<Hash> hash = []() -> Expected<Hash> {
        const auto bytes = engine::read_file("/proc/self/exe");
        if (!bytes) {
            return tl::unexpected(bytes.error().message);
        }
        Hash made;
        made.add(*bytes);
        return made;
    }();
    return hash;
}

void add(Hash& hash, const reference::SurfacePoint& point) {
    for (const glm::dvec3& v : {point.position, point.normal, point.albedo, point.emission}) {
        hash.add(v.x);
        hash.add(v.y);
        hash.add(v.z);
    }
}

TruthImage to_image(const char* physics, std::span<const reference::Estimate> estimates) {
    TruthImage image{physics, {}, 0.0, false};
    double errors = 0.0;
    double squares = 0.0;
    for (const reference::Estimate& estimate : estimates) {
        image.values.push_back(estimate.value);
        errors += glm::dot(estimate.error, estimate.error);
        squares += glm::dot(estimate.value, estimate.value);
    }
    image.relative_error = std::sqrt(errors / squares);
    return image;
}

/// The file holds the reference's error and three doubles a pixel.
std::optional<TruthImage> read_picture(const std::filesystem::path& path, const char* physics, std::size_t pixels) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) {
        return std::nullopt;
    }
    const auto bytes = engine::read_file(path);
    std::vector<double> numbers(1 + 3 * pixels);
    if (!bytes || bytes->size() != numbers.size() * sizeof(double)) {
        return std::nullopt;
    }
    std::memcpy(numbers.data(), bytes->data(), bytes->size());
    TruthImage image{physics, {}, numbers.front(), true};
    for (std::size_t i = 1; i < numbers.size(); i += 3) {
        image.values.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    }
    return image;
}

Expected<void> write_picture(const std::filesystem::path& path, const TruthImage& image) {
    std::vector<double> numbers{image.relative_error};
    for (const glm::dvec3& value : image.values) {
        numbers.insert(numbers.end(), {value.x, value.y, value.z});
    }
    if (const auto written = engine::replace_file(path, std::as_bytes(std::span(numbers))); !written) {
        return tl::unexpected(written.error().message);
    }
    return {};
}

} // namespace

Expected<std::vector<TruthImage>> exact_pictures(const PrecisionScene& scene, reference::ImageSize size,
                                                 std::span<const reference::Pixel> pixels,
                                                 std::span<const std::optional<reference::SurfacePoint>> surfaces,
                                                 bool airlight_only, const std::optional<std::filesystem::path>& folder,
                                                 const std::function<void(const std::string&, double)>& progress) {
    std::vector<TruthImage> images;
    for (const Truth& truth : truths) {
        if (!truth.physics.local_shadows && !has_local_shadows(scene)) {
            continue;
        }
        std::filesystem::path file;
        if (folder) {
            Expected<Hash> hash = program_hash();
            if (!hash) {
                return tl::unexpected(hash.error());
            }
            for (const std::string& part : {scene.name, scene.identity, std::string(truth.name)}) {
                hash->add(part);
            }
            hash->add(scene.tolerance);
            hash->add(airlight_only ? 1.0 : 0.0);
            hash->add(size.width);
            hash->add(size.height);
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                hash->add(pixels[i].x);
                hash->add(pixels[i].y);
                if (!surfaces.empty() && surfaces[i]) {
                    add(*hash, *surfaces[i]);
                }
            }
            file = *folder / (scene.name + "_" + hash->text() + ".exact");
            if (std::optional<TruthImage> kept = read_picture(file, truth.name, pixels.size())) {
                images.push_back(std::move(*kept));
                continue;
            }
        }
        const auto tell = [&](std::size_t done) {
            if (done % 256 == 0) {
                progress(truth.name, static_cast<double>(done) / static_cast<double>(pixels.size()));
            }
        };
        const std::vector<reference::Estimate> estimates = reference::render(
            reference_scene(scene, truth.physics), scene.camera, size, pixels, {scene.tolerance, 0.0}, tell, surfaces);
        images.push_back(to_image(truth.name, estimates));
        if (folder) {
            if (const auto written = write_picture(file, images.back()); !written) {
                return tl::unexpected(written.error());
            }
        }
    }
    return images;
}

} // namespace tyndall::samples
