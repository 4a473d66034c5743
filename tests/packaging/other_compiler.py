#!/usr/bin/env python3
"""Everything that is compiled for the engine, dcem::io and the program is also understood by clang, without a warning.

    other_compiler.py BUILD_DIR CLANG     reads BUILD_DIR/compile_commands.json; checks the syntax only

Exit 77 where CLANG is not installed or is the compiler of the build.
"""
import concurrent.futures
import json
import os
import re
import shlex
import shutil
import subprocess
import sys

TARGETS = ("CMakeFiles/dcem_engine.dir/", "CMakeFiles/dcem_io.dir/", "examples/CMakeFiles/dcem_program.dir/")
# What clang does not know or need: a switch of g++ alone, precompiled headers, and where the result goes.
DROPPED = re.compile(r"^(-mno-fma|-Winvalid-pch|-Wno-restrict|-Wno-array-bounds|-Wno-stringop-overflow|-MD|-c)$")


def clang_command(entry, clang):
    words = shlex.split(entry["command"])
    while not words[0].startswith("-"):  # the compiler, and what may stand before it
        words.pop(0)
    kept = [clang, "-fsyntax-only", "-Werror"]
    skip = 0
    for word in words:
        if skip:
            skip -= 1
        elif word in ("-o", "-MF", "-MT", "-include"):
            skip = 1
        elif not DROPPED.match(word):
            kept.append(word)
    return kept


def check(entry, clang):
    run = subprocess.run(clang_command(entry, clang), cwd=entry["directory"], capture_output=True, text=True)
    return entry["file"], run.returncode, run.stderr


def main():
    build, clang = sys.argv[1:3]
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        entries = json.load(file)
    if shutil.which(clang) is None or any("clang" in shlex.split(entry["command"])[0] for entry in entries):
        print("nothing to do: no " + clang + ", or the build is its own")
        return 77
    outputs = lambda entry: entry.get("output") or shlex.split(entry["command"])[shlex.split(entry["command"]).index("-o") + 1]
    chosen = [entry for entry in entries if outputs(entry).startswith(TARGETS) and "cmake_pch" not in entry["file"]]
    if len(chosen) < 10:
        print(f"only {len(chosen)} files of the engine, dcem::io and the program are known; expected at least 10")
        return 1
    failures = 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for name, code, errors in pool.map(lambda entry: check(entry, clang), chosen):
            if code != 0:
                failures += 1
                print(f"{name}:\n{errors[:4000]}")
    print(f"{len(chosen)} files, {failures} not understood by {clang}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
