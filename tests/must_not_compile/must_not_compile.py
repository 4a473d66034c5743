#!/usr/bin/env python3
"""Mistakes that the compiler must find, with the words by which it should.

    must_not_compile.py REPOSITORY COMPILER
"""
import subprocess
import sys

SOUND = '#include "dcem/dcem.hpp"\n'
TEMPLATES = '#include "dcem/sim/basic_simulator.hpp"\n'
CASES = [  # what it is, the program's last line, a piece of the message
    ("a facet where a material is expected", "double f(const dcem::Scene& s, dcem::FacetId id) { return "
     "s.material(id).roughness_rms_m; }", "FacetId|FacetTag"),
    ("a number where an id is expected", "auto f(const dcem::Scene& s) { return s.facet(3); }", "convert|no matching"),
    ("a surface model without a response", "struct Own {}; dcem::BasicSimulator<Own>* p = nullptr; "
     "auto f() { return p->discovery(); }", "constraint"),
    ("a response of another type", "struct Own { double response(dcem::MaterialId, double) const { return 0; } }; "
     "dcem::BasicSimulator<Own>* p = nullptr; auto f() { return p->discovery(); }", "constraint"),
    ("an index that cannot answer", "struct Tree {}; dcem::BasicSimulator<dcem::MaterialTable, Tree>* p = nullptr; "
     "auto f() { return p->discovery(); }", "constraint"),
    ("a path loss without an amplitude", "struct Own {}; auto f() { return dcem::UserPathLoss(Own{}); }",
     "constraint|no matching"),
    ("a pattern that is none", "#include \"dcem/em/antenna/user_pattern.hpp\"\nstruct Own {}; "
     "auto f() { return dcem::user_pattern(Own{}); }", "constraint|no matching"),
    ("a surface that is none", "#include \"dcem/em/surface/user_surface.hpp\"\nstruct Own {}; "
     "auto f() { return dcem::user_surface(Own{}); }", "constraint|no matching"),
    ("a copy of a simulator", "dcem::Simulator f(const dcem::Simulator& s) { return s; }", "delete"),
]


def compiles(compiler, root, text):
    command = [compiler, "-std=c++20", "-DDCEM_ENGINE", "-fsyntax-only", f"-I{root}", "-x", "c++", "-"]
    result = subprocess.run(command, input=text, text=True, capture_output=True)
    return result.returncode == 0, result.stderr


def main(root, compiler):
    failures = []
    ok, message = compiles(compiler, root, SOUND + TEMPLATES)
    if not ok:
        failures.append(f"the sound program does not compile:\n{message}")
    for what, line, words in CASES:
        ok, message = compiles(compiler, root, SOUND + (TEMPLATES if "Basic" in line else "") + line + "\n")
        if ok:
            failures.append(f"{what}: compiles")
        elif not any(word in message for word in words.split("|")):
            failures.append(f"{what}: fails, but without a word of '{words}':\n{message[:2000]}")
    print("\n".join(failures) if failures else f"{len(CASES)} mistakes, all found by the compiler")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
