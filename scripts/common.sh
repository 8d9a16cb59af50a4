# shellcheck shell=sh
# Read by the scripts beside it, from the project's root.

started=$(date +%s)
elapsed() {
    seconds=$(($(date +%s) - started))
    printf '%d:%02d min' $((seconds / 60)) $((seconds % 60))
}
run_with="" # words before what is built and run, for the sanitisers
say() { printf '\n== %s\n' "$*"; }

# configure PRESET [OPTION ...]
configure() {
    preset=$1
    shift
    say "configure $preset"
    launcher=""
    if command -v ccache >/dev/null; then
        launcher="-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache"
    fi
    # shellcheck disable=SC2086 # a list of words
    cmake --preset "$preset" --log-level=WARNING $launcher "$@"
}

# build PRESET [OPTION ...]
build() {
    preset=$1
    shift
    say "build $preset"
    # shellcheck disable=SC2086 # a list of words
    $run_with cmake --build --preset "$preset" "$@"
}
