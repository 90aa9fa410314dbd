#!/usr/bin/env bash
# Tries inputs on everything that reads files and on the algorithms (fuzz/), by Clang's libFuzzer with sanitizers, as many
# fuzzers at a time as there are cores. What was learned stays in build/fuzz/corpus and is where the next run begins; what
# fails is in build/fuzz/failures, to be tried again by `build/fuzz/fuzz/NAME_fuzzer FILE`. Ends with 1 where any failed.
# Usage: scripts/fuzz.sh [SECONDS [FUZZER...]]: each fuzzer, or those named, for so many seconds (60), for example
#   scripts/fuzz.sh 3600 mcap alignment
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
seconds=${1:-60}
shift || true
if ! command -v clang++ > /dev/null; then
  echo "fuzz.sh: Clang is missing (clang): skipped"
  exit 77
fi

cd -- "$root"
build=$root/build/fuzz
launcher=()
if command -v ccache > /dev/null; then
  launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
cmake --preset fuzz "${launcher[@]}" > /dev/null
cmake --build --preset fuzz --target fuzzers --parallel "$(nproc)"
"$build/fuzz/write_seeds" "$build/seeds"
fuzzers=("$@")
(( ${#fuzzers[@]} )) || mapfile -t fuzzers < "$build/fuzz/fuzzers.txt"
rm -rf "$build/logs"
mkdir -p "$build/failures" "$build/logs"

# A process that takes 1 GB, allocates 512 MB at once or takes 20 s for an input has failed.
run() {
  local name=$1
  mkdir -p "$build/corpus/$name"
  TMPDIR=/dev/shm "$build/fuzz/${name}_fuzzer" "$build/corpus/$name" "$build/seeds/$name" \
    -max_total_time="$seconds" -rss_limit_mb=1024 -malloc_limit_mb=512 -timeout=20 -print_final_stats=1 \
    -artifact_prefix="$build/failures/$name-" > "$build/logs/$name" 2>&1 || echo "exit code $?" >> "$build/logs/$name"
}
export -f run
export build seconds
printf '%s\n' "${fuzzers[@]}" | xargs -P "$(nproc)" -I{} bash -c 'run {}'

failed=0 total=0
printf '%-22s %12s %10s %10s  %s\n' fuzzer executions per_second edges result
for name in "${fuzzers[@]}"; do
  log=$build/logs/$name
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  rate=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")
  edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -n 1)
  result=passed
  if grep -q '^exit code' "$log"; then
    result="failed: $(grep -m 1 -E 'does not hold|ERROR:|runtime error|terminate called' "$log" || tail -n 1 "$log")"
    failed=1
  fi
  total=$((total + ${executions:-0}))
  printf '%-22s %12s %10s %10s  %s\n' "$name" "${executions:-?}" "${rate:-?}" "${edges:-?}" "$result"
done
echo "$total executions"
exit "$failed"
