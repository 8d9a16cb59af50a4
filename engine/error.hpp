// What the user, a file or the device did wrong. Errors of the engine are values: tl::expected<T, Error>.
#pragma once

#include <string>

namespace tyndall::engine {

struct Error {
    std::string message; ///< one sentence that names the culprit and, for a value, what is allowed
};

} // namespace tyndall::engine
