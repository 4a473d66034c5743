#!/usr/bin/env bash
# Installs what DCEM needs to build and test on Debian and Ubuntu, as far as it is missing. Uses apt-get, as root or with
# sudo. Elsewhere it does nothing: CMake then names each library that it cannot find.
#
#   install_dependencies.sh [MORE PACKAGES]
set -euo pipefail

packages=(
  g++ make cmake python3
  libglm-dev libtinyobjloader-dev nlohmann-json3-dev libstb-dev libexpat1-dev zlib1g-dev libzip-dev libcli11-dev
  doctest-dev libjs-three libcairo2-dev fonts-dejavu-core libmatio-dev libhdf5-dev libgeographiclib-dev
  libgeos-dev libosmium2-dev libopenmpi-dev openmpi-bin
  "$@"
)

is_installed() {
  [[ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "This is no Debian or Ubuntu: nothing installed. Packages needed, by their Debian names: ${packages[*]}" >&2
  exit 0
fi

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  exit 0
fi

as_root=(env)
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "Missing packages, and neither root nor sudo to install them. As root: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo env)
fi

echo "Installing ${missing[*]}"
"${as_root[@]}" apt-get update -q
"${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
