#!/usr/bin/env bash
# Builds the fuzz targets and runs each for some seconds, from the kept corpus and the good files of the tests. What is
# kept must pass: where it does not, the exit code is 2; where new input finds something, 1; where the targets cannot be
# built, 3.
#
#   tests/fuzz/run.sh [SECONDS [TARGET...]]   default: 60 seconds each, all targets; 0 seconds: the kept corpus alone
#
# What is found stands in build/fuzz/found/; the corpus that grows in build/fuzz/corpus/. To keep what a change has made worth
# keeping: build/fuzz/bin/fuzz_obj -merge=1 tests/fuzz/corpus/obj build/fuzz/corpus/obj
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds="${1:-60}"
shift || true
targets=("${@:-obj scenario traffic pattern import}")
read -ra targets <<<"${targets[*]}"

{
  examples/install_dependencies.sh clang &&
    cmake --preset fuzz >/dev/null &&
    cmake --build --preset fuzz --parallel "$(nproc)"
} || exit 3

export ASAN_OPTIONS="allocator_may_return_null=1:${ASAN_OPTIONS:-}"
bounds=(-timeout=20 -rss_limit_mb=3000)
status=0
mkdir -p build/fuzz/found
for target in "${targets[@]}"; do
  echo "== $target: what is kept"
  "build/fuzz/bin/fuzz_$target" -runs=0 "${bounds[@]}" -artifact_prefix="build/fuzz/found/$target-kept-" \
    "tests/fuzz/corpus/$target" >"build/fuzz/$target-kept.log" 2>&1 || { status=2; tail -40 "build/fuzz/$target-kept.log"; }
done
[[ "$status" == 0 && "$seconds" != 0 ]] || exit "$status"

for target in "${targets[@]}"; do
  mkdir -p "build/fuzz/corpus/$target"
  echo "== $target"
  "build/fuzz/bin/fuzz_$target" -max_total_time="$seconds" "${bounds[@]}" -max_len=20000 -print_final_stats=1 \
    -artifact_prefix="build/fuzz/found/$target-" "build/fuzz/corpus/$target" "tests/fuzz/corpus/$target" \
    >"build/fuzz/$target.log" 2>&1 || { status=1; tail -40 "build/fuzz/$target.log"; }
  grep -E 'stat::number_of_executed_units|stat::new_units_added' "build/fuzz/$target.log" || true
done
exit "$status"
