#!/bin/sh
# No unfinished places and no paths of somebody's machine in any file of the project.
#   text.sh ROOT
set -eu
cd "$1"
self=tests/project/text.sh
found=$(find . \( -name .git -o -path ./build -o -path ./out \) -prune -o -type f ! -path "./$self" -print0 |
    xargs -0 grep -InE '\b(TODO|FIXME|XXX|HACK)\b|(^|[^A-Za-z0-9_.])/(work|home|root|Users)/' || true)
if [ -n "$found" ]; then
    printf 'unfinished, or tied to one machine:\n%s\n' "$found"
    exit 1
fi
long=$(find rendergraph features engine samples tests benchmarks shaders -type f \
    \( -name '*.[ch]pp' -o -name '*.h' -o -name '*.glsl' -o -name '*.comp' -o -name '*.vert' -o -name '*.frag' \) \
    -exec awk 'END { if (NR > 450) print FILENAME ": " NR " lines" }' {} \;)
if [ -n "$long" ]; then
    printf 'more than one subject? over 450 lines:\n%s\n' "$long"
    exit 1
fi
