#!/bin/sh
# Puts every case of expected.txt to the program: it must exit with 2, print exactly one line on stderr that holds the
# expected pieces, print nothing on stdout, and leave no output behind.
#   run_program.sh PROGRAM
set -u
[ $# -eq 1 ] || { echo "usage: $0 PROGRAM" >&2; exit 2; }
program=$(realpath "$1") || exit 2
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
mkdir "$work/start"
cd "$work/start" || exit 2
count=0
failures=0

fail() {
  echo "FAILED $name ($how): $1" >&2
  sed 's/^/    /' "$work/stderr" >&2
  failures=$((failures + 1))
}

# Whether stderr holds every piece of "piece | piece | ...".
holds_pieces() {
  rest=$1
  while [ -n "$rest" ]; do
    piece=${rest%% | *}
    case $rest in *" | "*) rest=${rest#* | } ;; *) rest= ;; esac
    grep -qF -- "$piece" "$work/stderr" || { fail "no '$piece' in the message"; return; }
  done
}

while IFS= read -r line; do
  case $line in '#'* | '') continue ;; esac
  name=${line%% | *}
  line=${line#* | }
  how=${line%% | *}
  pieces=${line#* | }
  if [ "$how" = load ]; then
    "$program" run "$here/cases/$name/scenario.json" -o "$work/out" >"$work/stdout" 2>"$work/stderr" </dev/null
  else
    # shellcheck disable=SC2086  # the arguments are words
    "$program" $how "$here/$name/scenario.json" -o "$work/out" >"$work/stdout" 2>"$work/stderr" </dev/null
  fi
  status=$?
  count=$((count + 1))
  [ $status -eq 2 ] || fail "exit status $status instead of 2"
  [ "$(wc -l <"$work/stderr")" -eq 1 ] || fail "$(wc -l <"$work/stderr") lines on stderr instead of 1"
  [ -s "$work/stdout" ] && fail "something on stdout"
  [ -e "$work/out" ] && fail "an output folder was left" && rm -rf "$work/out"
  [ -z "$(ls -A "$work/start")" ] || { fail "files were left where the program started"; rm -rf "$work/start/"*; }
  holds_pieces "$pieces"
done <"$here/expected.txt"

echo "$count cases, $failures failures"
[ $failures -eq 0 ] && [ $count -gt 0 ]
