#!/bin/sh
# Every C++ file stands as .clang-format would put it.
#   format.sh ROOT
set -eu
cd "$1"
if ! command -v clang-format-16 >/dev/null; then
    echo "clang-format-16 is not installed; scripts/setup --test installs it"
    exit 77
fi
unformatted=$(find rendergraph features engine samples tests benchmarks -name '*.[ch]pp' -print0 |
    xargs -0 clang-format-16 --dry-run -Werror 2>&1 | sed -n 's/^\([^ :]*\):.*error:.*/\1/p' | sort | uniq -c)
if [ -n "$unformatted" ]; then
    printf 'clang-format-16 -i would change (lines, file):\n%s\n' "$unformatted"
    exit 1
fi
