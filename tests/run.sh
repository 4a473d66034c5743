#!/usr/bin/env bash
# Builds the release preset and runs its tests. Installs missing Debian packages where it may (root or sudo).
#
#   tests/run.sh              what a contributor needs: everything but what --all adds
#   tests/run.sh --all        also slow tests, all draws of the others, every slip in every key, the viewer in a
#                             browser, pictures of docs/, benchmarks, packaging, budgets of compile time
#   CXX=clang++ tests/run.sh  with another compiler, in build/release-clang++ (default: build/release)
#
# With CI set in the environment a compiler warning is an error.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

all=OFF
if [[ "${1:-}" == --all ]]; then
  all=ON
  shift
fi
if (($# > 0)); then
  echo "tests/run.sh: unknown argument '$1'; expected --all or nothing" >&2
  exit 2
fi

build_dir=build/release
more_packages=()
if [[ -n "${CXX:-}" ]]; then
  build_dir+="-$(basename "$CXX")"
  command -v "$CXX" >/dev/null || more_packages+=("$(basename "${CXX/clang++/clang}")")
fi
examples/install_dependencies.sh ${more_packages[@]+"${more_packages[@]}"}

cmake --preset release -B "$build_dir" -DDCEM_WARNINGS_AS_ERRORS="${CI:-OFF}" -DDCEM_TEST_ALL="$all" \
  -DDCEM_BUILD_BENCH="$all"
cmake --build "$build_dir" --parallel "$(nproc)"

log="$build_dir/ctest.log"
status=0
ctest --test-dir "$build_dir" --output-on-failure --no-tests=error -j2 2>&1 | tee "$log" || status=$?
grep 'tests passed' "$log" || true  # ctest's closing line once more, as the last line
exit "$status"
