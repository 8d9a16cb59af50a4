# Installs the build into an empty folder, copies the embedding sample out of the tree, and configures, builds and runs
# it against the package. Its plan must have work on both queues, a wait between them and the reason for what it left out.
# Then every header of the package is compiled by itself against the package alone.
#   cmake -DBUILD_DIR= -DSAMPLE_DIR= -DCXX= -DCXX_FLAGS= -P install.cmake
cmake_minimum_required(VERSION 3.25)

function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT result EQUAL 0)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "${command}\n${output}")
    endif()
endfunction()

execute_process(COMMAND mktemp -d OUTPUT_VARIABLE room OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
set(prefix "${room}/prefix")
run("${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${prefix}")

file(COPY "${SAMPLE_DIR}/" DESTINATION "${room}/embedding")
run("${CMAKE_COMMAND}" -S "${room}/embedding" -B "${room}/build" -G Ninja -DCMAKE_BUILD_TYPE=Release
    "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" "-DCMAKE_PREFIX_PATH=${prefix}")
run("${CMAKE_COMMAND}" --build "${room}/build")
execute_process(COMMAND "${room}/build/embedding" OUTPUT_VARIABLE plan RESULT_VARIABLE result)
if(NOT result EQUAL 0)
    message(FATAL_ERROR "the embedding sample ended with ${result}:\n${plan}")
endif()
foreach(fact IN ITEMS "batch [0-9]+ on graphics" "batch [0-9]+ on compute, waits for batch" "  ambient occlusion  "
                      "read after write of 'color' after 'opaque'" "left out: count overdraw")
    if(NOT plan MATCHES "${fact}")
        message(FATAL_ERROR "the plan of the embedding sample lacks \"${fact}\":\n${plan}")
    endif()
endforeach()

# All headers of the package in one project, each included by a source of its own.
file(GLOB_RECURSE headers RELATIVE "${prefix}/include/tyndall" "${prefix}/include/tyndall/*.hpp"
     "${prefix}/include/tyndall/*.h")
list(LENGTH headers count)
if(count LESS 10)
    message(FATAL_ERROR "the package has only ${count} headers")
endif()
set(sources "")
foreach(header IN LISTS headers)
    string(MAKE_C_IDENTIFIER "${header}" name)
    file(WRITE "${room}/headers/${name}.cpp" "#include \"${header}\"\n#include \"${header}\"\n")
    string(APPEND sources " ${name}.cpp")
endforeach()
file(WRITE "${room}/headers/CMakeLists.txt"
"cmake_minimum_required(VERSION 3.25)
project(headers LANGUAGES C CXX)
find_package(tyndall 0.1 REQUIRED)
add_library(headers OBJECT ${sources})
target_compile_options(headers PRIVATE -Wall -Wextra -Werror)
foreach(component rendergraph volumetrics engine)
    if(TARGET tyndall::\${component})
        target_link_libraries(headers PRIVATE tyndall::\${component})
    endif()
endforeach()
")
run("${CMAKE_COMMAND}" -S "${room}/headers" -B "${room}/headers/build" -G Ninja
    "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" "-DCMAKE_PREFIX_PATH=${prefix}")
run("${CMAKE_COMMAND}" --build "${room}/headers/build")
file(REMOVE_RECURSE "${room}")
message(STATUS "installed, found, built and run; ${count} headers stand by themselves")
