#!/usr/bin/env python3
"""Checks that code compiled for a newer processor is reached through its own names alone.

    kernel_symbols.py LIBRARY NM OBJDUMP

A function that is not in the namespace of a level of instructions, yet is defined weakly by an object that is compiled
for that level, may be taken by the linker for the whole program, which then stops on an older processor. And nowhere may a
product and a sum be rounded once: what the processor has must not show in a result.
"""
import re
import subprocess
import sys


def fused(library, objdump):
    listing = subprocess.run([objdump, "-d", "--no-show-raw-insn", library], capture_output=True, text=True,
                             check=True).stdout
    return sorted(set(re.findall(r"\bvfn?m(?:add|sub)\w*", listing)))


def main(library, nm, objdump):
    listing = subprocess.run([nm, "-C", library], capture_output=True, text=True, check=True).stdout
    found, wrong = 0, []
    for member in listing.split("\n\n"):
        name, *lines = member.strip().split("\n")
        level = re.match(r"kernels_(avx2|avx512)\.", name)
        if not level:
            continue
        for line in lines:
            symbol = re.match(r"[0-9a-f]+ ([TWVuBDR]) (.+)", line)
            if not symbol:
                continue
            found += 1
            own = f"isa_{level[1]}" in symbol[2] or f"engine_kernels_{level[1]}" in symbol[2]
            if not own:
                wrong.append(f"{name} defines {symbol[2]}")
    wrong += [f"the library holds {instruction}" for instruction in fused(library, objdump)]
    if found == 0 and not wrong:
        print("no kernels for newer processors in this library")
        sys.exit(77)
    print("\n".join(wrong) if wrong else f"{found} symbols, all under their own names")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
