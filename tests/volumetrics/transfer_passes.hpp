// Passes that carry a whole image or buffer between the host's memory and the device.
#pragma once

#include <string>

#include "rendergraph/graph.hpp"

namespace tyndall::volumetrics::test {

/// Copies the whole of a host buffer into an image.
void upload(rg::GraphBuilder& graph, const std::string& pass_name, rg::Buffer source, rg::Image& image);
/// And back: `target` becomes the version that the pass wrote.
void download(rg::GraphBuilder& graph, const std::string& pass_name, rg::Image image, rg::Buffer& target);
void download(rg::GraphBuilder& graph, const std::string& pass_name, rg::Buffer source, rg::Buffer& target);

} // namespace tyndall::volumetrics::test
