// The shell that makes one struct definition valid in GLSL and in C++. Members are vec4, uvec4, ivec4 and mat4 only, so
// that std140, std430 and the C++ layout are the same.
#ifndef TYNDALL_SHADERS_COMMON_INTEROP_H
#define TYNDALL_SHADERS_COMMON_INTEROP_H

#ifdef __cplusplus
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#define TYNDALL_INTEROP_BEGIN namespace tyndall::gpu {
#define TYNDALL_INTEROP_END } // namespace tyndall::gpu

namespace tyndall::gpu {
using glm::ivec4;
using glm::mat4;
using glm::uvec4;
using glm::vec4;
} // namespace tyndall::gpu
#else
#define TYNDALL_INTEROP_BEGIN
#define TYNDALL_INTEROP_END
#endif

#endif
