#!/bin/sh
# Runs the examples in examples/octave on what the program writes, and compares what they say with links.csv and
# paths.jsonl. Skips (77) where Octave is missing, or where the program writes no MAT files.
# Usage: read_with_octave.sh PROGRAM SOURCE_DIR PYTHON
set -eu
program=$1
source=$2
python=$3
command -v octave-cli >/dev/null || { echo "skipped: no Octave (apt install octave)"; exit 77; }
case $("$program" --version) in *"no matio"*) echo "skipped: this build writes no MAT files"; exit 77 ;; esac
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" run "$source/data/crossing_drive.json" --frames 0:5 --output paths,links,mat --quiet -o "$folder/run"
octave-cli --quiet "$source/examples/octave/read_paths.m" "$folder/run/paths.mat" | tee "$folder/paths.txt"
octave-cli --quiet "$source/examples/octave/read_links.m" "$folder/run/links.csv" | tee "$folder/links.txt"
"$python" - "$folder" <<'END'
import csv, json, sys
folder = sys.argv[1]
lines = [json.loads(line) for line in open(folder + "/run/paths.jsonl", encoding="utf-8")]
gains = [path["path_gain_db"] for line in lines for path in line["paths"]]
said = open(folder + "/paths.txt").read().split()
assert said[:4] == ["5", "frames,", str(len(gains)), "paths,"], said
assert abs(float(said[-2]) - max(gains)) < 1e-9, (said, max(gains))
rows = list(csv.DictReader(open(folder + "/run/links.csv", encoding="utf-8")))
said = open(folder + "/links.txt").read().split()
assert said[:4] == [str(len({(row["tx"], row["rx"]) for row in rows})), "links,", str(len(rows)), "lines,"], said
assert abs(float(said[-2]) - max(float(row["power_dbm"]) for row in rows if row["power_dbm"])) < 1e-9, said
END
