#!/usr/bin/env bash
# Installs what is missing, builds the release preset and runs every test; the exit code is that of CTest.
# Tests of real scans skip themselves where there are none: see SAW_NDT_DATA in CONTRIBUTING.md.
# Usage: scripts/test.sh [CTEST_OPTION...], for example: scripts/test.sh -R drop_in
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
"$root/scripts/install_dependencies.sh"

cd -- "$root"
launcher=()
if command -v ccache > /dev/null; then
  launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
cmake --preset release "${launcher[@]}"
cmake --build --preset release --parallel "$(nproc)"
ctest --preset release --no-tests=error --parallel "$(nproc)" "$@"
