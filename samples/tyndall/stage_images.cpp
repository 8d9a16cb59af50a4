#include "samples/tyndall/stage_images.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <system_error>

#include <glm/gtc/packing.hpp>
#include <glm/vec3.hpp>

#include "engine/image_io.hpp"
#include "features/volumetrics/parameters.hpp"

namespace tyndall::samples {
namespace {

const rg::ImportDesc to_host = {
    .has_final = true, .final_stages = VK_PIPELINE_STAGE_2_HOST_BIT, .final_access = VK_ACCESS_2_HOST_READ_BIT};

/// Values of a copied image, as floats, channel by channel of each texel in order.
std::vector<float> as_floats(const engine::Buffer& buffer, VkFormat format, std::size_t texels) {
    std::vector<float> values;
    switch (format) {
    case VK_FORMAT_R16G16B16A16_SFLOAT:
        for (const std::uint16_t half : buffer.mapped_as<std::uint16_t>().first(texels * 4)) {
            values.push_back(glm::unpackHalf1x16(half));
        }
        break;
    case VK_FORMAT_R32G32B32A32_SFLOAT: {
        const auto floats = buffer.mapped_as<float>().first(texels * 4);
        values.assign(floats.begin(), floats.end());
        break;
    }
    default: {
        const auto floats = buffer.mapped_as<float>().first(texels);
        values.assign(floats.begin(), floats.end());
        break;
    }
    }
    return values;
}

/// The value that 99 % of the positive ones do not exceed; 1 where there are none.
float bright_level(std::vector<float> values) {
    std::erase_if(values, [](float v) { return !(v > 0.0F) || !std::isfinite(v); });
    if (values.empty()) {
        return 1.0F;
    }
    const auto level = values.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(values.size() - 1) * 0.99);
    std::nth_element(values.begin(), level, values.end());
    return *level;
}

std::uint8_t display(float linear) {
    const float clamped = std::clamp(std::isfinite(linear) ? linear : 0.0F, 0.0F, 1.0F);
    return static_cast<std::uint8_t>(std::lround(255.0F * std::pow(clamped, 1.0F / 2.2F)));
}

/// Slices laid out in reading order on a sheet that is about as many tiles wide as high.
class Sheet {
public:
    Sheet(std::uint32_t width, std::uint32_t height, std::uint32_t slices)
        : width_(width), height_(height),
          columns_(static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(slices))))) {
        const std::uint32_t rows = (slices + columns_ - 1) / columns_;
        image_ = {columns_ * width, rows * height, 3, {}};
        image_.values.resize(std::size_t{image_.width} * image_.height * 3);
    }
    void set(std::uint32_t slice, std::uint32_t x, std::uint32_t y, glm::vec3 linear) {
        const std::size_t px = std::size_t{slice % columns_} * width_ + x;
        const std::size_t py = std::size_t{slice / columns_} * height_ + y;
        std::uint8_t* pixel = image_.values.data() + (py * image_.width + px) * 3;
        pixel[0] = display(linear.r);
        pixel[1] = display(linear.g);
        pixel[2] = display(linear.b);
    }
    [[nodiscard]] const engine::Pixels<std::uint8_t>& image() const { return image_; }

private:
    std::uint32_t width_;
    std::uint32_t height_;
    std::uint32_t columns_;
    engine::Pixels<std::uint8_t> image_;
};

} // namespace

tl::expected<rg::Buffer, engine::Error> StageImages::host_buffer(rg::GraphBuilder& graph, Capture& capture,
                                                                 VkDeviceSize bytes) {
    auto buffer =
        engine::Buffer::create(*device_, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, engine::MemoryUse::readback);
    if (!buffer) {
        return tl::unexpected(buffer.error());
    }
    capture.buffer = std::move(*buffer);
    const rg::Buffer out = graph.import_buffer("picture of " + capture.name, {.size_bytes = bytes}, to_host);
    bindings_.push_back({.resource = out.resource, .buffer = capture.buffer.handle()});
    return out;
}

tl::expected<void, engine::Error> StageImages::capture_image(rg::GraphBuilder& graph, Capture capture,
                                                             rg::Image image) {
    const std::optional<rg::ImageDesc> desc = graph.describe(image);
    if (!desc) {
        return {}; // its pass was left out
    }
    capture.image = *desc;
    capture.width = desc->extent.width;
    capture.height = desc->extent.height;
    capture.slices = std::max(desc->extent.depth, desc->layers);
    const VkDeviceSize texels = VkDeviceSize{capture.width} * capture.height * capture.slices;
    const VkDeviceSize bytes = texels * rg::format_texel_bytes(desc->format);
    auto bound = host_buffer(graph, capture, bytes);
    if (!bound) {
        return tl::unexpected(bound.error());
    }
    rg::Buffer out = *bound;
    graph.add_pass("copy " + capture.name, rg::PassKind::transfer)
        .reads(image, rg::Access::transfer_source)
        .writes(out, rg::Access::transfer_destination)
        .executes([=, extent = desc->extent, layers = desc->layers](rg::PassContext& ctx) {
            const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                            .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, layers},
                                            .imageExtent = extent};
            const VkCopyImageToBufferInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                                .srcImage = ctx.image(image),
                                                .srcImageLayout = ctx.layout(image),
                                                .dstBuffer = ctx.buffer(out),
                                                .regionCount = 1,
                                                .pRegions = &region};
            ctx.vk().CmdCopyImageToBuffer2(ctx.cmd(), &copy);
        });
    captures_.push_back(std::move(capture));
    return {};
}

tl::expected<void, engine::Error> StageImages::capture_masks(rg::GraphBuilder& graph, Capture capture,
                                                             rg::Buffer masks) {
    const VkDeviceSize bytes = graph.describe(masks)->size_bytes;
    auto bound = host_buffer(graph, capture, bytes);
    if (!bound) {
        return tl::unexpected(bound.error());
    }
    rg::Buffer out = *bound;
    graph.add_pass("copy " + capture.name, rg::PassKind::transfer)
        .reads(masks, rg::Access::transfer_source)
        .writes(out, rg::Access::transfer_destination)
        .executes([=](rg::PassContext& ctx) {
            const VkBufferCopy copy{0, 0, bytes};
            ctx.vk().CmdCopyBuffer(ctx.cmd(), ctx.buffer(masks), ctx.buffer(out), 1, &copy);
        });
    captures_.push_back(std::move(capture));
    return {};
}

tl::expected<void, engine::Error> StageImages::declare(rg::GraphBuilder& graph, const volumetrics::Feature& feature,
                                                       const volumetrics::Settings& settings,
                                                       std::uint32_t light_count) {
    const volumetrics::StageResources& stages = feature.stages();
    const bool colored = feature.volume() && feature.volume()->colored;
    tl::expected<void, engine::Error> done;
    done = capture_image(graph, {.name = "density", .kind = Kind::density, .colored = colored}, stages.density);
    if (done) {
        done = capture_image(graph, {.name = "esm", .kind = Kind::esm, .esm_exponent = settings.shadow.esm_exponent[0]},
                             stages.esm);
    }
    if (done && feature.volume()) {
        done = capture_image(graph, {.name = "lighting", .kind = Kind::radiance}, feature.volume()->in_scattered);
    }
    if (done && feature.volume()) {
        done = capture_image(graph, {.name = "accumulated", .kind = Kind::accumulated, .colored = colored},
                             feature.volume()->accumulated);
    }
    if (done && feature.clusters()) {
        const gpu::LightClusters clusters = volumetrics::light_clusters(settings.grid, light_count, {});
        Capture capture{.name = "clusters", .kind = Kind::clusters};
        capture.width = clusters.counts.x;
        capture.height = clusters.counts.y;
        capture.slices = clusters.counts.z;
        capture.words = clusters.block.w;
        done = capture_masks(graph, std::move(capture), feature.clusters()->masks);
    }
    return done;
}

std::vector<StageValues> StageImages::values() const {
    std::vector<StageValues> all;
    for (const Capture& capture : captures_) {
        if (capture.kind != Kind::clusters) {
            const std::size_t texels = std::size_t{capture.width} * capture.height * capture.slices;
            std::vector<float> values = as_floats(capture.buffer, capture.image.format, texels);
            if (capture.colored) {
                const auto half = static_cast<std::ptrdiff_t>(values.size() / 2);
                all.push_back({capture.name + " of each channel", capture.width, capture.height, capture.slices / 2,
                               std::vector<float>(values.begin() + half, values.end())});
                values.resize(values.size() / 2);
            }
            all.push_back({capture.name, capture.width, capture.height,
                           capture.colored ? capture.slices / 2 : capture.slices, std::move(values)});
        }
    }
    return all;
}

tl::expected<std::vector<std::filesystem::path>, engine::Error>
StageImages::write(const std::filesystem::path& folder) const {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure) {
        return tl::unexpected(engine::Error{"Cannot make the folder '" + folder.string() + "': " + failure.message()});
    }
    std::vector<std::filesystem::path> files;
    const auto save = [&](const std::string& name, const Sheet& sheet) -> tl::expected<void, engine::Error> {
        files.push_back(folder / (name + ".png"));
        return engine::write_png(files.back(), sheet.image());
    };
    for (const Capture& capture : captures_) {
        const std::size_t texels = std::size_t{capture.width} * capture.height * capture.slices;
        Sheet sheet(capture.width, capture.height, capture.slices);
        Sheet second(capture.width, capture.height, capture.slices);
        std::vector<float> values;
        float level = 1.0F;
        if (capture.kind == Kind::clusters) {
            level = static_cast<float>(capture.words) * 32.0F;
            std::uint32_t most = 1;
            const auto words = capture.buffer.mapped_as<std::uint32_t>();
            std::vector<std::uint32_t> lights(texels, 0);
            for (std::size_t i = 0; i < texels * capture.words; ++i) {
                lights[i / capture.words] += static_cast<std::uint32_t>(std::popcount(words[i]));
                most = std::max(most, lights[i / capture.words]);
            }
            values.assign(lights.begin(), lights.end());
            level = static_cast<float>(most);
        } else {
            values = as_floats(capture.buffer, capture.image.format, texels);
            if (capture.kind != Kind::esm) {
                std::vector<float> first;
                const std::size_t channel = capture.kind == Kind::density ? 3 : 1;
                for (std::size_t i = channel; i < values.size(); i += 4) {
                    first.push_back(values[i]);
                }
                level = bright_level(std::move(first));
            }
        }
        for (std::size_t i = 0; i < texels; ++i) {
            const auto x = static_cast<std::uint32_t>(i % capture.width);
            const auto y = static_cast<std::uint32_t>(i / capture.width % capture.height);
            const auto slice = static_cast<std::uint32_t>(i / (std::size_t{capture.width} * capture.height));
            switch (capture.kind) {
            case Kind::clusters: {
                const float share = values[i] / level;
                sheet.set(slice, x, y, {share, share * share, 0.05F * share});
                break;
            }
            case Kind::esm: sheet.set(slice, x, y, glm::vec3(values[i] / capture.esm_exponent)); break;
            case Kind::density: sheet.set(slice, x, y, glm::vec3(values[4 * i + 3] / level)); break;
            case Kind::accumulated: second.set(slice, x, y, glm::vec3(std::exp(-values[4 * i + 3]))); [[fallthrough]];
            case Kind::radiance:
                sheet.set(slice, x, y, glm::vec3(values[4 * i], values[4 * i + 1], values[4 * i + 2]) / level);
                break;
            }
        }
        tl::expected<void, engine::Error> done = save(capture.name, sheet);
        if (done && capture.kind == Kind::accumulated) {
            done = save("transmittance", second);
        }
        if (!done) {
            return tl::unexpected(done.error());
        }
    }
    return files;
}

} // namespace tyndall::samples
