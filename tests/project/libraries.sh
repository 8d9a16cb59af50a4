#!/bin/sh
# The libraries that a host embeds were built without exceptions and run-time type information, and call no Vulkan
# function by its global name, so they link without a loader.
#   libraries.sh NM LIBRARY ...
set -eu
nm=$1
shift
bad=0
for library in "$@"; do
    symbols=$("$nm" "$library" 2>/dev/null)
    if [ -z "$symbols" ]; then
        echo "$library has no symbols"
        bad=1
    fi
    # __gxx_personality_v0 and landing pads come with exceptions, _ZTI and _ZTS with type information.
    found=$(printf '%s\n' "$symbols" |
        grep -E ' (__gxx_personality_v0|__cxa_(throw|begin_catch|rethrow)|_ZTI[A-Z0-9].*|_ZTS[A-Z0-9].*| *vk[A-Z].*)$' |
        sort -u || true)
    if [ -n "$found" ]; then
        printf '%s:\n%s\n' "$library" "$found"
        bad=1
    fi
done
exit $bad
