# `cmake --install` makes a package of those libraries that were built. Each has its own export set, so that a host that
# asks for one component needs the dependencies of that one only:
#   find_package(tyndall REQUIRED COMPONENTS rendergraph)
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/tyndall")
set(TYNDALL_INSTALLED_COMPONENTS "")

# tyndall_install_library(NAME FOLDER [PRIVATE_HEADERS pattern ...]): the target tyndall_NAME, if there is one, and the
# headers of FOLDER but those that only the library's own sources share.
function(tyndall_install_library name folder)
    cmake_parse_arguments(arg "" "" "PRIVATE_HEADERS" ${ARGN})
    if(NOT TARGET tyndall_${name})
        return()
    endif()
    set(exclusions "")
    foreach(pattern IN LISTS arg_PRIVATE_HEADERS)
        list(APPEND exclusions PATTERN "${pattern}" EXCLUDE)
    endforeach()
    # EXPORT_NAME makes it tyndall::NAME outside, as it is inside.
    set_target_properties(tyndall_${name} PROPERTIES EXPORT_NAME ${name})
    install(TARGETS tyndall_${name} EXPORT tyndall_${name} ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
    install(EXPORT tyndall_${name} NAMESPACE tyndall:: FILE tyndall_${name}.cmake DESTINATION "${package_dir}")
    install(DIRECTORY "${PROJECT_SOURCE_DIR}/${folder}/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/tyndall/${folder}"
            FILES_MATCHING PATTERN "*.hpp" ${exclusions})
    set(TYNDALL_INSTALLED_COMPONENTS ${TYNDALL_INSTALLED_COMPONENTS} ${name} PARENT_SCOPE)
endfunction()

tyndall_install_library(rendergraph rendergraph
                        PRIVATE_HEADERS stages.hpp *_state.hpp *_types.hpp assign.hpp formats.hpp queue_model.hpp search.hpp
                                        variants.hpp verify_order.hpp verify_replay.hpp vulkan_names.hpp)
tyndall_install_library(volumetrics features/volumetrics
                        PRIVATE_HEADERS reference *_state.hpp density_image.hpp dispatch.hpp host_buffers.hpp persistent_image.hpp
                                        pipelines.hpp shaders.hpp)
tyndall_install_library(engine engine PRIVATE_HEADERS *_state.hpp gltf_*.hpp)

# The structs that C++ shares with the shaders.
install(DIRECTORY "${PROJECT_SOURCE_DIR}/shaders/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/tyndall/shaders"
        FILES_MATCHING PATTERN "*.h")

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/tyndallConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/tyndallConfig.cmake" INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/tyndallConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/tyndallConfig.cmake" "${PROJECT_BINARY_DIR}/tyndallConfigVersion.cmake"
        DESTINATION "${package_dir}")
