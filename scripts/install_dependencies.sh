#!/usr/bin/env bash
# Installs the packages of Debian 12 that building, testing and running need, if any is missing.
# This is the one list of them. libpcl-dev brings Eigen, Boost, FLANN, VTK, Qt and MPI, which PCL's CMake package asks for.
# The Python modules write the recordings that test/recordings reads; its MCAP bags also need npm, wherever it comes from.
set -euo pipefail

packages=(
  build-essential cmake ninja-build ccache
  libpcl-dev libeigen3-dev libboost-dev libboost-filesystem-dev libboost-program-options-dev libboost-system-dev zlib1g-dev
  nlohmann-json3-dev libhwy-dev libembree-dev
  libpcap-dev libbz2-dev liblz4-dev libzstd-dev libsqlite3-dev libfastcdr-dev libyaml-cpp-dev
  libboost-mpi-dev libopenmpi-dev openmpi-bin
  libgtest-dev libbenchmark-dev
  clang libclang-rt-14-dev llvm libomp-dev
  gnuplot-nox
  python3 python3-numpy python3-rosbag python3-sensor-msgs python3-geometry-msgs python3-nav-msgs python3-std-msgs python3-tf2-msgs
)

if ! command -v dpkg-query > /dev/null; then
  echo "install_dependencies.sh: no dpkg here; taking for granted that these are installed: ${packages[*]}" >&2
  exit 0
fi

missing=()
for package in "${packages[@]}"; do
  # shellcheck disable=SC2016  # ${Status} is dpkg-query's
  status=$(dpkg-query --show --showformat='${Status}' "$package" 2> /dev/null || true)
  [[ $status == "install ok installed" ]] || missing+=("$package")
done
(( ${#missing[@]} )) || exit 0

as_root=()
if (( EUID != 0 )); then
  if ! command -v sudo > /dev/null; then
    echo "install_dependencies.sh: missing packages, and neither root nor sudo to install them: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "Installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
