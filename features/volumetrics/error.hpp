// What a user of the feature did wrong, or what the device refused.
#pragma once

#include <string>

namespace tyndall::volumetrics {

struct Error {
    std::string message; ///< one sentence that names the culprit and, for a value, what is allowed
};

} // namespace tyndall::volumetrics
