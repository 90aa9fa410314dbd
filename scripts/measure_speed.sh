#!/usr/bin/env bash
# Runs the benchmarks that are built (build/release, see bench/README.md) and prints their tables as Markdown.
# usage: scripts/measure_speed.sh [KITTI_FOLDER]
#   KITTI_FOLDER        holds sequences/ and poses/; without it a short drive is simulated
#   SPEED_REPETITIONS   environment variable: repetitions of which the median is printed, 5 unless set
#   SPEED_FILTER        environment variable: regular expression of the benchmarks to run, all unless set
#   SPEED_OUTPUT        environment variable: folder for the JSON files, a temporary one unless set
set -euo pipefail

bench=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)/build/release/bench
repetitions=${SPEED_REPETITIONS:-5}
[[ $# == 0 ]] || SAW_NDT_KITTI=$(realpath -- "$1")
[[ -z ${SAW_NDT_KITTI:-} ]] || export SAW_NDT_KITTI
output=${SPEED_OUTPUT:-}
if [[ -z $output ]]; then
  output=$(mktemp -d)
  trap 'rm -rf -- "$output"' EXIT
fi
mkdir -p -- "$output"

files=()
while read -r program; do
  if [[ ! -x $bench/$program ]]; then
    echo "measure_speed.sh: $program is not built; left out" >&2
    continue
  fi
  echo "measure_speed.sh: $program" >&2
  rm -f -- "$output/$program.json"
  "$bench/$program" --benchmark_filter="${SPEED_FILTER:-.}" --benchmark_repetitions="$repetitions" \
    --benchmark_enable_random_interleaving=true --benchmark_report_aggregates_only=true \
    --benchmark_out_format=json --benchmark_out="$output/$program.json" > /dev/null
  # A filter that matches nothing of a program leaves an empty file.
  [[ ! -s $output/$program.json ]] || files+=("$output/$program.json")
done < "$bench/google_benchmarks.txt"

grep -m 1 "^model name" /proc/cpuinfo | sed 's/.*: //'
date --utc +%F
echo
(( ${#files[@]} == 0 )) || "$bench/benchmark_tables" "${files[@]}"
echo
"$bench/roofline"
