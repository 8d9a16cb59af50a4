// The frame file's own words and parts. Internal.
#pragma once

#include <array>
#include <charconv>
#include <string_view>
#include <vector>

#include "rendergraph/costs.hpp"
#include "rendergraph/json.hpp"
#include "rendergraph/json_types.hpp"
#include "rendergraph/plan.hpp"
#include "rendergraph/vulkan_names.hpp"

namespace tyndall::rg::json {

inline constexpr std::array<std::string_view, 3> queue_kinds = {"graphics", "compute", "transfer"};
inline constexpr std::array<std::string_view, 4> pass_kinds = {"graphics", "compute", "transfer", "host"};
inline constexpr std::array<std::string_view, 4> queue_wishes = {"automatic", "graphics", "async_compute", "transfer"};
inline constexpr std::array<std::string_view, 3> image_types = {"1D", "2D", "3D"};        ///< as VkImageType counts
inline constexpr std::array<std::string_view, 3> verbs = {"reads", "writes", "modifies"}; ///< as Direction counts
inline constexpr std::array<VulkanName, 4> capabilities = {
    {{can_graphics, "graphics"}, {can_compute, "compute"}, {can_transfer, "transfer"}, {can_host, "host"}}};

template <std::size_t N>
[[nodiscard]] std::vector<std::string_view> list(const std::array<std::string_view, N>& words) {
    return {words.begin(), words.end()};
}

/// "name@version" as two parts; the version is `none` where the text does not end in '@' and a number. Resources whose
/// own names end so are always written with a version. What no frame can make is the largest number below `none`.
struct VersionedName {
    std::string_view name;
    std::uint32_t version = none;
};
[[nodiscard]] inline VersionedName split_version(std::string_view text) {
    const std::size_t at = text.rfind('@');
    if (at == std::string_view::npos) {
        return {text};
    }
    std::uint32_t version = none;
    const auto [end, error] = std::from_chars(text.data() + at + 1, text.data() + text.size(), version);
    const bool too_large = error == std::errc::result_out_of_range;
    const bool number = (error == std::errc{} || too_large) && end == text.data() + text.size();
    version = too_large || version == none ? none - 1 : version;
    return number ? VersionedName{text.substr(0, at), version} : VersionedName{text};
}

/// What the numbers of a colour's clear value are.
enum class ClearNumbers : std::uint8_t { real, unsigned_whole, signed_whole };
[[nodiscard]] inline ClearNumbers clear_numbers_of(VkFormat format) {
    const std::string_view name = name_in(format_names(), static_cast<std::uint64_t>(format)).value_or("");
    return name.find("_UINT") != std::string_view::npos   ? ClearNumbers::unsigned_whole
           : name.find("_SINT") != std::string_view::npos ? ClearNumbers::signed_whole
                                                          : ClearNumbers::real;
}

inline constexpr std::uint64_t longest_pass_ns = 10'000'000'000;

/// The key "model" of `from`.
void read_model(ObjectReader& from, Costs& costs);
/// The key "resources", null where there is none.
void read_resources(const Json* list, GraphDesc& graph, Diagnostics& mistakes);
/// Of the resources.
[[nodiscard]] std::vector<std::string_view> names_of(const GraphDesc& graph);

} // namespace tyndall::rg::json
