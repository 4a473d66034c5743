#!/usr/bin/env bash
# From SUMO to Google Earth: a network with its buildings and its traffic becomes a scenario, some seconds of it are run, and links and
# vehicles are written as KML.
#
#   examples/from_sumo_to_kml.sh NET_OR_CFG POLYGONS FCD FOLDER [FRAMES] [MORE FILES OF TYPES...]
#
# The network must say where on the Earth it lies (projParameter), as those from OpenStreetMap do.
set -euo pipefail
if (($# < 4)); then
  sed -n '2,8s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
network="$1" polygons="$2" trace="$3" folder="$4" frames="${5:-10}"
shift "$(($# < 5 ? 4 : 5))"
types=()
for file in "$@"; do types+=(--additional "$file"); done
dcem="$(dirname "${BASH_SOURCE[0]}")/../build/release/bin/dcem"

"$dcem" import sumo "$network" --poly "$polygons" --fcd "$trace" ${types[@]+"${types[@]}"} -o "$folder"
"$dcem" run "$folder/scenario.json" --frames "0:$frames" --output links,kml -o "$folder/out"
echo "Open $folder/out/links.kml in Google Earth: lines are links, their height and colour the received power."
