#!/usr/bin/env bash
# Builds the release preset and runs every test. Installs missing Debian packages where it may (root or sudo).
#
#   tests/run.sh              with the default compiler, in build/release
#   CXX=clang++ tests/run.sh  with another one, in build/release-clang++
#
# With CI set in the environment a compiler warning is an error.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build_dir=build/release
more_packages=()
if [[ -n "${CXX:-}" ]]; then
  build_dir+="-$(basename "$CXX")"
  command -v "$CXX" >/dev/null || more_packages+=("$(basename "${CXX/clang++/clang}")")
fi
examples/install_dependencies.sh ${more_packages[@]+"${more_packages[@]}"}

cmake --preset release -B "$build_dir" -DDCEM_WARNINGS_AS_ERRORS="${CI:-OFF}"
cmake --build "$build_dir" --parallel "$(nproc)"

log="$build_dir/ctest.log"
status=0
ctest --test-dir "$build_dir" --output-on-failure --no-tests=error -j2 2>&1 | tee "$log" || status=$?
grep 'tests passed' "$log" || true  # ctest's closing line once more, as the last line
exit "$status"
