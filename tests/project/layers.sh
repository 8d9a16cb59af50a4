#!/bin/sh
# Who may include whom. Prints each include that breaks it.
#   layers.sh ROOT
set -eu
cd "$1"
broken=0

# allow FOLDER PREFIXES: what stands in quotes in FOLDER's sources begins with one of PREFIXES (a|b|c).
allow() {
    found=$(grep -rnE --include='*.hpp' --include='*.cpp' '^ *# *include *"' "$1" | grep -vE "include *\"($2)/" || true)
    report "$1 may include only $2" "$found"
}
# forbid FOLDER PATTERN WHY
forbid() {
    found=$(grep -rnE --include='*.hpp' --include='*.cpp' "$2" "$1" || true)
    report "$1 $3" "$found"
}
report() {
    if [ -n "$2" ]; then
        printf '%s:\n%s\n' "$1" "$2"
        broken=1
    fi
}

allow rendergraph 'rendergraph'
allow features 'rendergraph|features|shaders|spirv'
allow engine 'rendergraph|engine|shaders/common|shaders/engine|spirv'
forbid rendergraph '# *include *<(glm|GLFW)/' 'needs Vulkan headers and tl::expected, and a JSON library for reports'
report 'rendergraph reads and writes JSON through json_types.hpp only' \
    "$(grep -rnE --include='*.hpp' --include='*.cpp' '# *include *<nlohmann/' rendergraph | grep -v '^rendergraph/json_types.hpp:' || true)"
forbid rendergraph '# *include *<vulkan/vulkan.h(pp)?>' 'includes vulkan_core.h and no platform headers'
report 'the checker shares nothing with compile but the graph, the plan and the access table' \
    "$(grep -sHnE '^ *# *include *"' rendergraph/verify* | grep -vE '"rendergraph/(verify[a-z_]*|plan|graph_desc|access)\.hpp"' || true)"
forbid features '# *include *<GLFW/' 'opens no window'
forbid engine 'volumetrics(/|::)' 'knows no feature by name'
exit $broken
