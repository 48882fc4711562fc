# Sourced by ./run and ./test: installs what is missing (Debian 12) and builds the release preset.
# Packages: what the program needs, then what its checks need.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build_packages=(g++ cmake ninja-build ccache libeigen3-dev libsuitesparse-dev libboost-dev libboost-program-options-dev
  nlohmann-json3-dev libtomlplusplus-dev libfmt-dev libkainjow-mustache-dev libssl-dev libmatio-dev musl-dev)
# libopenmpi-dev, openmpi-bin: yield under mpirun, which is optional;
# python3-*, pybind11-dev: the Python package and its tests; python3-jsonschema, mandoc, pkg-config: schemas, manual, installed library.
check_packages=(ngspice libgtest-dev libgmock-dev libopenmpi-dev openmpi-bin chromium
  python3-dev python3-numpy python3-pytest pybind11-dev python3-jsonschema mandoc pkg-config)

is_installed() {
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

install_missing() {
  local missing=() package
  for package in "$@"; do
    is_installed "$package" || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  echo "installing: ${missing[*]}" >&2
  if [ "$(id -u)" -ne 0 ] && ! command -v sudo >/dev/null; then
    echo "these packages are missing and there is neither root nor sudo: ${missing[*]}" >&2
    exit 2
  fi
  as_root apt-get update -q >&2
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}" >&2
}

# CVODE's archive and headers out of libsundials-dev, where that is not installed: what it depends on is 160 packages more.
unpack_cvode() {
  is_installed libsundials-dev && return 0
  [ -d build/packages ] && return 0
  rm -rf build/unpacking
  mkdir -p build/unpacking
  (
    cd build/unpacking
    apt-get download -q libsundials-dev || { as_root apt-get update -q && apt-get download -q libsundials-dev; }
    dpkg-deb -x libsundials-dev_*.deb .
    rm libsundials-dev_*.deb
    mv "$PWD" ../packages
  ) >&2
}

build_release() {
  # A folder that was configured elsewhere (moved, copied) would fail: begin anew then.
  if [ -f build/CMakeCache.txt ] && ! grep -qx "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" build/CMakeCache.txt; then
    rm -rf build
  fi
  unpack_cvode
  cmake --preset release "$@" >build-configure.log 2>&1 || { cat build-configure.log >&2; exit 1; }
  rm -f build-configure.log
  # As many at a time as there are cores: more of them only take the caches from each other.
  cmake --build --preset release --parallel "$(nproc)" >&2
}
