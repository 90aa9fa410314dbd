#!/usr/bin/env bash
# Shows what this project does. Without a KITTI folder: simulates two drives through each of three scenes, builds a map
# of one drive and localizes the other in it (and each drive in its own map), by every method. With one: runs KITTI's
# sequences 00, 01 and 03 and prints the paper's Table I beside ours. Installs what is missing and builds first.
# Usage: scripts/demo.sh [KITTI_FOLDER [BENCHMARK_OPTION...]]
#   KITTI_FOLDER  holds sequences/00, 01, 03 and poses/00.txt, ...; the environment variable KITTI_ROOT stands for it
#   DEMO_OUTPUT   environment variable: folder for the results, `demo` in the project unless set
#   DEMO_SCANS    environment variable: scans of each simulated drive, 150 unless set
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
kitti=${1:-${KITTI_ROOT:-}}
(( $# )) && shift
[[ -z $kitti ]] || kitti=$(realpath -- "$kitti")
output=$(realpath -m -- "${DEMO_OUTPUT:-$root/demo}")
scans=${DEMO_SCANS:-150}

step() { printf '\n[%3d s] %s\n' "$SECONDS" "$*"; }

step "Installing what is missing"
"$root/scripts/install_dependencies.sh"

step "Building"
cd -- "$root"
launcher=()
if command -v ccache > /dev/null; then
  launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
cmake --preset release "${launcher[@]}" > /dev/null
cmake --build --preset release --parallel "$(nproc)" --target saw_ndt_simulate saw_ndt_benchmark
mkdir -p -- "$output"
cd -- "$output"
export PATH=$root/build/release/apps:$PATH

if [[ -n $kitti ]]; then
  step "Localizing KITTI's sequences 00, 01 and 03 in maps of their own"
  saw_ndt_benchmark "$kitti"/sequences/{00,01,03} -paper -output kitti "$@"
  step "Done. The report: $output/kitti/report.html"
  exit 0
fi

scenes=(residential highway rural)
drives=() maps=()
rm -rf -- drives
for scene in "${scenes[@]}"; do
  for drive in 1 2; do
    step "Simulating $scene, drive $drive"
    saw_ndt_simulate "drives/$drive/$scene" -scene "$scene" -drive "$drive" -scans "$scans"
  done
  drives+=("drives/2/$scene")
  maps+=("drives/1/$scene")
done

step "Beside PCL's own class, on a few scans"
saw_ndt_benchmark "${drives[0]}" -map-from "${maps[0]}" -drives other -methods weighted,classical,pcl-ndt \
  -scans 40:60:2 -map-scans 0:100 -skip 0 -output pcl

step "Localizing each drive in the map of the other and in its own"
saw_ndt_benchmark "${drives[@]}" -map-from "$(IFS=,; echo "${maps[*]}")" -output simulated
step "Done. The report: $output/simulated/report.html"
