#!/usr/bin/env bash
# Installs what is missing, builds a preset, `release` unless named, and runs every test; the exit code is that of CTest.
# Tests of real scans skip themselves where there are none: see SAW_NDT_DATA in CONTRIBUTING.md.
# Usage: scripts/test.sh [-preset release|debug|asan|tsan|clang] [CTEST_OPTION...], for example:
#   scripts/test.sh -R drop_in
#   scripts/test.sh -preset asan
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
preset=release
if [[ ${1:-} == -preset ]]; then
  preset=${2:?"test.sh: -preset needs a name"}
  shift 2
fi
"$root/scripts/install_dependencies.sh"

cd -- "$root"
launcher=()
if command -v ccache > /dev/null; then
  launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
cmake --preset "$preset" "${launcher[@]}"
cmake --build --preset "$preset" --parallel "$(nproc)"
ctest --preset "$preset" --no-tests=error --parallel "$(nproc)" "$@"
