#!/usr/bin/env bash
# From a fresh checkout to pictures: installs what is missing, builds the program, and runs it twice, on vehicles that
# drive through a small town and on a coverage map of an office. Results go to out/. Run it from anywhere.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

step() {
  printf '\n== %s\n' "$*"
}

step "Looking for compiler and libraries"
examples/install_dependencies.sh

step "Building build/release/bin/dcem"
cmake --preset release
cmake --build build/release --target dcem_program --parallel "$(nproc)"

step "Town: vehicles drive through streets, 100 frames"
build/release/bin/dcem run data/town_drive.json -o out/town_drive --output paths,links,pdp,npz,plots,html

step "Office: a coverage map for each transmitter"
build/release/bin/dcem map data/office_map.json -o out/office_map

step "Done. Results are in $PWD/out; open these:"
find "$PWD/out/town_drive" -name '*.html'
find "$PWD/out/office_map" -name '*.png' | sort
echo "and, for each link of the drive, power over time (plot_*.svg; for a paper panels_*.pdf), its delay profile (pdp_*) and its paths (taps_*.png), such as:"
find "$PWD/out/town_drive" -name '*_roof_on_car1*' | sort
