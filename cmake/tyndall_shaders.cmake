find_program(TYNDALL_GLSLANG glslangValidator REQUIRED)

# tyndall_shader(TARGET SOURCE [NAME name] [DEFINES A=1 ...])
# Compiles shaders/SOURCE to SPIR-V and makes it available to TARGET's C++ as
#   #include "spirv/<name>.h"   ->   const uint32_t <name>[]
# NAME defaults to the path with every '/' and '.' turned into '_'; give one for each variant of a shader.
# The includes that the shader reads are tracked, so touching a .glsl rebuilds just what reads it.
function(tyndall_shader target source)
    cmake_parse_arguments(arg "" "NAME" "DEFINES" ${ARGN})
    if(NOT arg_NAME)
        string(REGEX REPLACE "[/.]" "_" arg_NAME "${source}")
    endif()
    set(root "${PROJECT_SOURCE_DIR}/shaders")
    set(out_dir "${PROJECT_BINARY_DIR}/generated/${target}/spirv")
    set(header "${out_dir}/${arg_NAME}.h")
    list(TRANSFORM arg_DEFINES PREPEND "-D")
    file(MAKE_DIRECTORY "${out_dir}")
    add_custom_command(
        OUTPUT "${header}"
        COMMAND "${TYNDALL_GLSLANG}" --quiet -V --target-env vulkan1.3 "-I${root}" ${arg_DEFINES} --vn ${arg_NAME}
                --depfile "${header}.d" -o "${header}" "${root}/${source}"
        DEPENDS "${root}/${source}"
        DEPFILE "${header}.d"
        COMMENT "SPIR-V ${arg_NAME}"
        VERBATIM)
    target_sources(${target} PRIVATE "${header}")
    target_include_directories(${target} PRIVATE "${PROJECT_BINARY_DIR}/generated/${target}")
endfunction()
