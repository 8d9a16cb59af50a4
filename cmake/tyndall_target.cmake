# tyndall_target(NAME): what every library, tool and test of ours has in common.
# Headers are included by their path from the project root: #include "rendergraph/graph.hpp".
function(tyndall_target name)
    target_compile_features(${name} PUBLIC cxx_std_20)
    set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
    target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/tyndall>)
    target_compile_options(${name} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
                           # Designated initialisers that leave the rest at its default are how Vulkan structs are filled.
                           -Wno-missing-field-initializers
                           # g++ 12 sees overlaps in std::string concatenation that are not there (GCC bug 105651).
                           $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
endfunction()

# The libraries that a host embeds promise to build without exceptions and run-time type information.
function(tyndall_no_exceptions name)
    target_compile_options(${name} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fno-exceptions -fno-rtti>)
endfunction()
