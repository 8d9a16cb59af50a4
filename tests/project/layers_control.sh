#!/bin/sh
# The negative control of layers.sh: each forbidden line must be found.
#   layers_control.sh PATH/TO/layers.sh
set -eu
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
missed=0
try() {
    rm -rf "${root:?}"/*
    mkdir -p "$root/rendergraph" "$root/features/volumetrics" "$root/engine"
    if [ $# -gt 0 ]; then
        printf '%s\n' "$2" >"$root/$1"
    fi
    sh "$layers" "$root" >/dev/null
}
layers=$1
must_find() {
    if try "$1" "$2"; then
        echo "not found in $1: $2"
        missed=1
    fi
}
try # clean rooms pass
try features/volumetrics/a.cpp '#include "rendergraph/graph.hpp"'
must_find rendergraph/a.hpp '#include "engine/scene.hpp"'
must_find rendergraph/a.hpp '#include <glm/vec3.hpp>'
must_find rendergraph/a.cpp '#include <vulkan/vulkan.h>'
must_find rendergraph/verify_a.cpp '#include "rendergraph/stages.hpp"'
must_find features/volumetrics/a.cpp '#include "engine/scene.hpp"'
must_find features/volumetrics/a.cpp '#include "samples/tyndall/arguments.hpp"'
must_find engine/a.cpp '#include "features/volumetrics/feature.hpp"'
must_find engine/a.cpp '#include "shaders/volumetrics/interop.h"'
must_find engine/a.hpp 'volumetrics::Feature* fog;'
exit $missed
