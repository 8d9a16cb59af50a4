// Which configurations of the fog the precision study measures in a scene.
#pragma once

#include <vector>

#include "samples/precision/scene.hpp"
#include "samples/tyndall/arguments.hpp"

namespace tyndall::samples {

/// What the scene's own fog settings ask for.
[[nodiscard]] PrecisionConfiguration own_configuration(const PrecisionScene& scene);

/// The scene's fog in another configuration.
[[nodiscard]] volumetrics::Fog configured_fog(const PrecisionScene& scene, const PrecisionConfiguration& configuration);

/// Whether a ladder stands in for the lists that are not given: --sweep, --quick, or a wish for error or time without
/// any list.
[[nodiscard]] bool is_sweep(const PrecisionArguments& arguments);

/// Every combination of the lists, each once; of a sweep the scene's own first. A list that is not given is the
/// ladder's, or holds the scene's own value only. A scene without a sun has no visibilities to vary; a ladder leaves
/// out grids of more than four times as many froxels as the default has.
[[nodiscard]] std::vector<PrecisionConfiguration> configurations(const PrecisionArguments& arguments,
                                                                 const PrecisionScene& scene);

} // namespace tyndall::samples
