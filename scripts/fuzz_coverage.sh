#!/usr/bin/env bash
# Counts the lines of the library that the inputs of scripts/fuzz.sh reach, those that it has learned and those that it
# begins with, file by file; a second build tells. Lines of the sources that read files come first.
# Usage: scripts/fuzz_coverage.sh
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
cd -- "$root"
learned=$root/build/fuzz build=$root/build/fuzz-coverage
if [[ ! -d $learned/seeds ]]; then
  echo "fuzz_coverage.sh: run scripts/fuzz.sh first" >&2
  exit 1
fi
launcher=()
if command -v ccache > /dev/null; then
  launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
cmake --preset fuzz-coverage "${launcher[@]}" > /dev/null
cmake --build --preset fuzz-coverage --target fuzzers --parallel "$(nproc)"
tool() { command -v "$1" || compgen -c "$1-" | sort -V | tail -n 1; }

programs=()
while read -r name; do
  program=$build/fuzz/${name}_fuzzer
  mkdir -p "$learned/corpus/$name"
  TMPDIR=/dev/shm LLVM_PROFILE_FILE=$build/$name.profraw "$program" -runs=0 "$learned/corpus/$name" \
    "$learned/seeds/$name" > /dev/null 2>&1
  programs+=(-object "$program")
done < "$build/fuzz/fuzzers.txt"
"$(tool llvm-profdata)" merge -o "$build/all.profdata" "$build"/*.profraw

report() {
  "$(tool llvm-cov)" report "${programs[@]:1}" -instr-profile="$build/all.profdata" "$@" |
    awk '/\.(cpp|h) / || /^TOTAL/ { printf "%-55s %6s lines, %s reached\n", $1, $8, $10 }'
}
echo "What reads files:"
report "$root"/src/io "$root"/src/map/{map_file,map_front,map_metadata,localization_map_file,localization_tile}.cpp \
  "$root"/src/localization/place_table.cpp
echo "All of the core:"
report "$root"/src/{common,segmentation,map,registration,localization} | tail -n 1
