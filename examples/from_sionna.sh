#!/usr/bin/env bash
# A scene of Sionna RT in DCEM: its Mitsuba XML with PLY meshes and radio materials becomes OBJ, MTL and a scenario, which is run.
#
#   examples/from_sionna.sh SCENE.xml FOLDER
set -euo pipefail
if (($# != 2)); then
  sed -n '2,4s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
dcem="$(dirname "${BASH_SOURCE[0]}")/../build/release/bin/dcem"

"$dcem" import sionna "$1" -o "$2"
"$dcem" run "$2/scenario.json" --output paths,links,npz,html -o "$2/out"
echo "$2/out/viewer.html shows the paths; $2/out/paths.npz has them as arrays with the names of Sionna's own."
