#!/bin/sh
# Runs the examples in examples/python on what the program writes. Skips (77) where NumPy or Matplotlib are missing.
# Usage: read_with_python.sh PROGRAM SOURCE_DIR
set -eu
program=$1
source=$2
python=
for candidate in python3 /usr/bin/python3; do
  if "$candidate" -c 'import matplotlib, numpy' 2>/dev/null; then
    python=$candidate
    break
  fi
done
if [ -z "$python" ]; then
  echo "skipped: no Python with NumPy and Matplotlib (apt install python3-numpy python3-matplotlib)"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export MPLCONFIGDIR="$folder"

# A picture has to be a PNG of some size.
check_picture() {
  [ "$(head -c 4 "$1" | tail -c 3)" = PNG ] || { echo "$1 is no PNG"; exit 1; }
  [ "$(wc -c < "$1")" -gt 5000 ] || { echo "$1 is empty"; exit 1; }
}

"$program" run "$source/data/crossing_drive.json" --frames 0:5 --output npz --quiet -o "$folder/run"
"$python" "$source/examples/python/read_paths.py" "$folder/run/paths.npz" pole on_car1 "$folder/paths.png" | tee "$folder/text"
check_picture "$folder/paths.png"
grep -q '^5 frames, ' "$folder/text"

"$program" map "$source/data/office_map_coarse.json" --quiet -o "$folder/map"
for arrays in "$folder"/map/map_*.npz; do
  [ -e "$arrays" ] || { echo "no arrays of maps"; exit 1; }
  "$python" "$source/examples/python/read_map.py" "$arrays" power_incoherent_dbm "$folder/map.png"
  check_picture "$folder/map.png"
  break
done
