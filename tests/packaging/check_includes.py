#!/usr/bin/env python3
"""Checks which header includes which: the order of the rooms, and what public headers may show.

    check_includes.py REPOSITORY     lists the violations; exit status 1 if there are any
    check_includes.py --figures REPOSITORY   prints the table of rooms that ARCHITECTURE.md must hold
    check_includes.py --self-check   plants one violation of each rule in a scratch tree and expects it to be found
"""
import re
import sys
import tempfile
from pathlib import Path

# What each room may include besides itself. `paths` lacks `em` on purpose: a path is geometry, so that a gain can never
# be cached by mistake. `accel` and `em` do not know each other. Nothing includes `io`.
ROOMS = {
    "core": [],
    "geometry": ["core"],
    "accel": ["core", "geometry"],
    "world": ["core", "geometry"],
    "em": ["core", "geometry"],
    "scene": ["core", "geometry", "world", "em"],
    "paths": ["core", "geometry", "accel", "world", "scene"],
    "field": ["core", "geometry", "accel", "world", "em", "scene", "paths"],
    "channel": ["core", "geometry", "accel", "world", "em", "scene", "paths", "field"],
    "sim": ["core", "geometry", "accel", "world", "em", "scene", "paths", "field", "channel"],
    "debug": ["core", "geometry", "accel", "world", "em", "scene", "paths", "field", "channel", "sim"],
    "engine": ["core", "geometry", "accel", "world", "em", "scene", "paths", "field", "channel", "sim"],
    "io": ["core", "geometry", "accel", "world", "em", "scene", "paths", "field", "channel", "sim", "debug"],
}
UMBRELLA = "dcem/dcem.hpp"  # stands outside the rooms; includes what most programs need
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
STANDARD_OR_GLM = re.compile(r"^([a-z_0-9]+|glm/.+)$")  # <vector>, <glm/vec3.hpp>; not <unistd.h>, <nlohmann/json.hpp>
SYSTEM_HEADER_OF = {"dcem/core/huge_pages.hpp": "sys/mman.h"}  # included only where there is such a system
PROJECT_FOLDERS = ["dcem", "examples", "tests", "bench"]


def room_of(path):
    """'em' for dcem/em/material.hpp; None for the umbrella."""
    parts = path.split("/")
    return parts[1] if len(parts) > 2 else None


def is_public_header(path):
    return path.endswith(".hpp") and not path.startswith("dcem/io/src/")


def check_target(path, target, root):
    """A line about an include of one of the project's own headers that the rooms forbid, or None."""
    if not (root / target).is_file():
        return f"{path}: includes {target}, which does not exist"
    room, target_room = room_of(path), room_of(target)
    if target == UMBRELLA:
        return f"{path}: includes the umbrella {target}; include what is used"
    if room is None:
        return f"{path}: the umbrella includes {target}; io is not part of it" if target_room == "io" else None
    if target_room != room and target_room not in ROOMS[room]:
        return f"{path}: {room} must not include {target}"
    return None


def check_include(path, bracket, target, root):
    own = target.startswith("dcem/")
    if own and bracket == '"':
        return check_target(path, target, root)
    if own or bracket == '"':
        return f'{path}: own headers are included as "dcem/room/file.hpp", not {bracket}{target}'
    if SYSTEM_HEADER_OF.get(path) == target:
        return None
    if is_public_header(path) and not STANDARD_OR_GLM.match(target):
        return f"{path}: a public header includes <{target}>; only the standard library and GLM may show"
    return None


def levels_of(boxes, arrows):
    """The longest chain; a cycle is an error."""
    depth = {}

    def visit(box, above):
        if box in above:
            sys.exit(f"includes run in a circle: {' -> '.join(above + (box,))}")
        if box not in depth:
            depth[box] = 1 + max((visit(target, above + (box,)) for target in arrows.get(box, ())), default=0)
        return depth[box]

    return max((visit(box, ()) for box in sorted(boxes)), default=0)


def count_figures(library):
    """Per room: headers, levels, arrows inside, and the rooms it includes. Two headers that include each other are one
    box: the second holds the bodies of the first."""
    includes = {path: {target for _, target in INCLUDE.findall(text) if target in library and target != path}
                for path, text in library.items() if path.endswith(".hpp")}
    box_of = {path: path for path in includes}
    for path, targets in includes.items():
        for target in targets:
            if path in includes.get(target, ()):  # the shorter path is the one that others include
                first, second = sorted((path, target), key=lambda name: (name.count("/"), len(name)))
                box_of[second] = first
    def box(path):
        return path if box_of[path] == path else box(box_of[path])
    arrows = {}
    for path, targets in includes.items():
        arrows.setdefault(box(path), set()).update(box(target) for target in targets if box(target) != box(path))
    rooms = {}
    for room in ROOMS:
        boxes = {name for name in arrows if room_of(name) == room}
        inside = {name: {t for t in arrows[name] if room_of(t) == room} for name in boxes}
        others = {room_of(t) for name in boxes for t in arrows[name]} - {room, None}
        rooms[room] = (len(boxes), levels_of(boxes, inside), sum(map(len, inside.values())), others)
    return rooms


def figure_lines(library):
    rooms = count_figures(library)
    lines = ["| room | boxes | levels | arrows inside | includes |", "|---|---|---|---|---|"]
    for room, (boxes, levels, arrows, others) in rooms.items():
        names = ", ".join(sorted(others, key=list(ROOMS).index)) or "–"
        lines.append(f"| `{room}` | {boxes} | {levels} | {arrows} | {names} |")
    total = {room: others for room, (_, _, _, others) in rooms.items()}
    lines.append(f"| all {len(rooms)} rooms | {sum(r[0] for r in rooms.values())} | {levels_of(total, total)} | "
                 f"{sum(map(len, total.values()))} between rooms | |")
    return lines


def check_figures(root, library):
    """The table in ARCHITECTURE.md must be the one counted here."""
    document = root / "ARCHITECTURE.md"
    if not document.is_file():
        return []
    text = document.read_text(encoding="utf-8")
    return [f"ARCHITECTURE.md: lacks the line '{line}' (check_includes.py --figures prints the table)"
            for line in figure_lines(library) if line not in text]


def check_tree(root):
    """All violations in the tree at `root`, one line each."""
    lines = []
    texts = {p.relative_to(root).as_posix(): p.read_text(encoding="utf-8")
             for folder in PROJECT_FOLDERS for p in sorted((root / folder).rglob("*.[hc]pp"))}
    library = {path: text for path, text in texts.items() if path.startswith("dcem/")}
    includes = {path: INCLUDE.findall(text) for path, text in library.items()}

    for path, text in library.items():
        room = room_of(path)
        if path != UMBRELLA and room not in ROOMS:
            lines.append(f"{path}: stands in no known room")
            continue
        lines += filter(None, (check_include(path, bracket, target, root) for bracket, target in includes[path]))
        if path.endswith(".hpp") and not text.startswith("#pragma once\n"):
            lines.append(f"{path}: does not begin with #pragma once")
        if path.endswith(".cpp") and not path.startswith(("dcem/io/src/", "dcem/engine/")):
            lines.append(f"{path}: compiled code stands in dcem/engine and dcem/io/src only")
    lines += [f"{path}: defines GLM_FORCE_..., which changes GLM for whoever includes it"
              for path, text in texts.items() if re.search(r"#\s*define\s+GLM_FORCE_", text)]

    lines += [f"{path}: bodies are included by the header that they are named after and dcem/engine alone; {other} does, too"
              for other, found in includes.items() for _, path in found
              if path.endswith("_bodies.hpp") and path != other
              and not path.startswith(other.replace(".hpp", "_")) and room_of(other) != "engine"]
    lines += check_figures(root, library)
    return lines


SOUND_TREE = {
    UMBRELLA: '#pragma once\n#include "dcem/paths/path.hpp"\n',
    "dcem/core/ids.hpp": "#pragma once\n#include <cstdint>\n",
    "dcem/accel/bvh.hpp": '#pragma once\n#include <glm/vec3.hpp>\n#include "dcem/core/ids.hpp"\n',
    "dcem/em/surface/fresnel.hpp": '#pragma once\n#include "dcem/core/ids.hpp"\n',
    "dcem/scene/scene_bodies.hpp": '#pragma once\n#include "dcem/scene/scene.hpp"\n',
    "dcem/engine/world.cpp": '#include "dcem/scene/scene_bodies.hpp"\n',
    "dcem/scene/scene.hpp": '#pragma once\n#include "dcem/em/surface/fresnel.hpp"\n',
    "dcem/paths/path.hpp": '#pragma once\n#include "dcem/accel/bvh.hpp"\n#include "dcem/scene/scene.hpp"\n',
    "dcem/io/load.hpp": '#pragma once\n#include "dcem/paths/path.hpp"\n',
    "dcem/io/src/load.cpp": '#include "dcem/io/load.hpp"\n#include <nlohmann/json.hpp>\n',
    "examples/first_path.cpp": '#include "dcem/dcem.hpp"\n',
}
PLANTED = [  # file, the line put at its end, a piece of the message it must cause
    ("dcem/core/ids.hpp", '#include "dcem/accel/bvh.hpp"', "core must not include"),
    ("dcem/accel/bvh.hpp", '#include "dcem/scene/scene.hpp"', "accel must not include"),
    ("dcem/accel/bvh.hpp", '#  include "dcem/em/surface/fresnel.hpp"', "accel must not include"),
    ("dcem/em/surface/fresnel.hpp", '#include "dcem/accel/bvh.hpp"', "em must not include"),
    ("dcem/paths/path.hpp", '#include "dcem/em/surface/fresnel.hpp"', "paths must not include"),
    ("dcem/paths/path.hpp", '#include "dcem/io/load.hpp"', "paths must not include"),
    ("dcem/paths/path.hpp", '#include "../em/fresnel.hpp"', "own headers are included as"),
    ("dcem/paths/path.hpp", "#include <dcem/core/ids.hpp>", "own headers are included as"),
    ("dcem/paths/path.hpp", '#include "dcem/core/no_such.hpp"', "does not exist"),
    ("dcem/paths/path.hpp", '#include "dcem/dcem.hpp"', "includes the umbrella"),
    ("dcem/io/load.hpp", "#include <nlohmann/json.hpp>", "a public header includes"),
    ("dcem/io/load.hpp", "#include <tiny_obj_loader.h>", "a public header includes"),
    ("dcem/io/load.hpp", "#include <CLI/CLI.hpp>", "a public header includes"),
    ("dcem/core/ids.hpp", "#include <sys/mman.h>", "a public header includes"),
    (UMBRELLA, '#include "dcem/io/load.hpp"', "io is not part of it"),
    ("dcem/paths/path.hpp", '#include "dcem/scene/scene_bodies.hpp"', "bodies are included by"),
    ("dcem/core/guard.hpp", "#ifndef GUARD", "does not begin with #pragma once"),
    ("dcem/core/code.cpp", "", "compiled code stands in"),
    ("dcem/tools/x.hpp", "#pragma once", "stands in no known room"),
    ("examples/first_path.cpp", "#define GLM_FORCE_RADIANS", "defines GLM_FORCE_"),
]


def self_check():
    def violations(extra):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for path, text in {**SOUND_TREE, **extra}.items():
                (root / path).parent.mkdir(parents=True, exist_ok=True)
                (root / path).write_text(text, encoding="utf-8")
            return check_tree(root)

    failures = [f"a sound tree is called wrong: {line}" for line in violations({})]
    for path, line, message in PLANTED:
        found = violations({path: SOUND_TREE.get(path, "") + line + "\n"})
        if not any(message in violation and path in violation for violation in found):
            failures.append(f"planted in {path}: {line!r}: expected '{message}', found {found}")
    return failures


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "--figures":
        root = Path(arguments[1]).resolve()
        print("\n".join(figure_lines({p.relative_to(root).as_posix(): p.read_text(encoding="utf-8")
                                      for p in (root / "dcem").rglob("*.[hc]pp")})))
        return
    if len(arguments) != 1:
        sys.exit(__doc__)
    violations = self_check() if arguments[0] == "--self-check" else check_tree(Path(arguments[0]).resolve())
    print("\n".join(violations) if violations else "no violations")
    sys.exit(1 if violations else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
