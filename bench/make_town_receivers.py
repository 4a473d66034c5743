#!/usr/bin/env python3
"""Puts a receiver on every vehicle of a SUMO trace that is there in its first steps.

  make_town_receivers.py SCENARIO.json OUT.json [STEPS]

SCENARIO has a mast and a trace, as bad_hersfeld_exact.json; OUT is the same with these receivers, 1.7 m above the middle
of each vehicle's floor, with `cache: exact`. STEPS: 100 if nothing is said; the run is to be asked for as many frames.
"""
import gzip
import json
import os
import sys
import xml.etree.ElementTree as ElementTree

HEIGHT_M = 1.7


def vehicles_of(trace, steps):
    """The ids of all that are there in the first steps."""
    found, seen = set(), 0
    opened = gzip.open if trace.endswith(".gz") else open
    with opened(trace, "rb") as file:
        for _, element in ElementTree.iterparse(file):
            if element.tag != "timestep":
                continue
            if seen == steps:
                break
            seen += 1
            found.update(vehicle.get("id") for vehicle in element.iter("vehicle"))
            element.clear()
    return sorted(found)


def main(arguments):
    if len(arguments) not in (2, 3):
        sys.exit(__doc__)
    source, target = arguments[:2]
    steps = int(arguments[2]) if len(arguments) == 3 else 100
    with open(source, encoding="utf-8") as file:
        scenario = json.load(file)
    folder = os.path.dirname(os.path.abspath(source))
    blocks = (scenario["scene"], scenario["mobility"])
    for block in blocks:
        for key, value in block.items():
            path = os.path.join(folder, value) if isinstance(value, str) else ""
            if os.path.isfile(path):
                block[key] = os.path.relpath(path, os.path.dirname(os.path.abspath(target)))
    trace = os.path.join(os.path.dirname(os.path.abspath(target)), scenario["mobility"]["sumo_fcd"])
    scenario["receivers"] = [
        {"id": "on_" + vehicle, "attach_to": vehicle, "offset_m": [0, 0, HEIGHT_M]} for vehicle in vehicles_of(trace, steps)
    ]
    scenario["propagation"]["cache"] = "exact"
    with open(target, "w", encoding="utf-8") as file:
        json.dump(scenario, file, indent=1)
        file.write("\n")


if __name__ == "__main__":
    main(sys.argv[1:])
