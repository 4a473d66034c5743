#!/usr/bin/env python3
"""Holds what it costs to include a header.

    compile_budget.py REPOSITORY COMPILER [HEADER...]    checks all public headers, or those named
    compile_budget.py --table REPOSITORY COMPILER        prints what each costs, dearest first

The unit of time is a reference that is compiled in the same run: the standard headers that a program of this kind has
anyway, and GLM's vectors. What looks dearer than its budget is measured again, in turns with the reference, five times
and, where it still looks so, ten times more; of both the fastest counts. Memory is the compiler's largest resident set.
"""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

REFERENCE = "".join(f"#include <{name}>\n" for name in (
    "algorithm", "array", "cmath", "complex", "cstdint", "functional", "memory", "optional", "span", "string",
    "unordered_map", "unordered_set", "variant", "vector", "glm/mat3x3.hpp", "glm/vec3.hpp"))
# References, and megabytes, per header; the first entry whose beginning fits. The whole simulator as a template, trees and
# fields are for those who need them; what most programs include must be light. The budgets stand a seventh and more above what was
# measured on an idle machine: other work beside it makes a header dearer by up to an eighth, in references too.
BUDGETS = [
    ("dcem/dcem.hpp", 2.4, 330), ("dcem/sim/simulator.hpp", 2.4, 330),
    ("dcem/sim/basic_simulator.hpp", 9.2, 700), ("dcem/sim/verify/brute_force_simulator.hpp", 9.4, 700),
    ("dcem/sim/verify/basic_verifier.hpp", 10.0, 750),
    ("dcem/sim/", 2.2, 330), ("dcem/accel/", 3.5, 450), ("dcem/paths/", 4.9, 450), ("dcem/field/", 5.0, 500),
    ("dcem/io/", 3.0, 400), ("dcem/", 2.2, 330),
]


def compile_once(compiler, root, text):
    """Processor seconds and megabytes."""
    with tempfile.NamedTemporaryFile("w", suffix=".cpp") as source:
        source.write(text)
        source.flush()
        command = [compiler, "-std=c++20", "-O2", "-ffp-contract=off", "-DDCEM_ENGINE", f"-I{root}", "-c", source.name,
                   "-o", "/dev/null"]
        process = subprocess.Popen(command, stderr=subprocess.PIPE)
        message = process.stderr.read().decode()
        _, status, used = os.wait4(process.pid, 0)
        if status != 0:
            sys.exit(f"does not compile: {text}{message}")
        return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def reference_of(runs, compiler, root):
    measured = [compile_once(compiler, root, REFERENCE) for _ in range(runs)]
    return min(m[0] for m in measured), min(m[1] for m in measured)


def paired_cost(compiler, root, text, most):
    """References. Both are measured in turns, since a machine changes its pace, and of each the fastest counts: other
    work only adds. Five times, or fifteen where it takes more than `most`: what is that dear stays so."""
    own_s, reference_s = [], []
    for pairs in (5, 10):
        for _ in range(pairs):
            own_s.append(compile_once(compiler, root, text)[0])
            reference_s.append(compile_once(compiler, root, REFERENCE)[0])
        if min(own_s) <= most * min(reference_s):
            break
    return min(own_s) / min(reference_s)


def budget_of(header):
    return next((seconds, megabytes) for start, seconds, megabytes in BUDGETS if header.startswith(start))


def public_headers(root):
    paths = (path.relative_to(root).as_posix() for path in sorted((root / "dcem").rglob("*.hpp")))
    return [path for path in paths if not path.startswith(("dcem/io/src/", "dcem/engine/"))
            and "/detail/" not in path and not path.endswith("_bodies.hpp")]


def main(arguments):
    table = arguments[:1] == ["--table"]
    arguments = arguments[1:] if table else arguments
    if len(arguments) < 2:
        sys.exit(__doc__)
    root, compiler = Path(arguments[0]).resolve(), arguments[1]
    reference_s, reference_mb = reference_of(3, compiler, root)
    print(f"reference: {reference_s:.2f} s, {reference_mb:.0f} MB")
    rows, over = [], []
    for header in arguments[2:] or public_headers(root):
        text = f'#include "{header}"\n'
        seconds, megabytes = compile_once(compiler, root, text)
        most, most_mb = budget_of(header)
        cost = seconds / reference_s
        if cost > most:  # the machine may be slower than it was at the beginning
            cost = paired_cost(compiler, root, text, most)
        rows.append((cost, megabytes, header))
        if cost > most or megabytes > most_mb:
            over.append(f"{header}: {cost:.2f} references and {megabytes:.0f} MB; its budget is {most} and {most_mb} MB")
    if table:
        for cost, megabytes, header in sorted(rows, reverse=True):
            print(f"{cost:6.2f} {megabytes:6.0f} MB  {header}")
    print("\n".join(over) if over else f"{len(rows)} headers, all within their budgets")
    sys.exit(1 if over and not table else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
