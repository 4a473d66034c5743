#!/usr/bin/env python3
"""Writes a SUMO trace of any number of vehicles at a time, all of which carry devices, and a scenario with their links.

  make_fleet.py FOLDER VEHICLES STEPS [RANGE_M] [INTERACTIONS] [LONGEST_PATH_M]

The vehicles drive along parallel streets 40 m apart over a square that grows with their number: 625 vehicles for a square
kilometre, so that each has the same number of others around it. In the middle lies the town of data/. Nothing is random.
"""
import math
import os
import sys

STEP_S = 0.1
SPEED_MPS = 12.5
VEHICLES_PER_KM2 = 625.0
STREET_SPACING_M = 40.0

SCENARIO = """{
  "format": "dcem-scenario/1",
  "scene": {"obj": "%s"},
  "materials": {"metal": {"model": "pec"}},
  "frequency_hz": 5.9e9,
  "mobility": {"sumo_fcd": "trace.fcd.xml", "vehicle_types": "vtypes.add.xml", "material": "metal",
    "devices": {"vehicles": "all", "power_dbm": 23}},
  "links": {"range_m": %g},
  "propagation": {"max_reflections": 2, "max_transmissions": 0, "max_interactions": %d, "max_path_length_m": %s}
}
"""


def write_steps(path, steps, vehicles_of):
    """Writes a trace; `vehicles_of(step)` tells of each vehicle where it is, in metres, and its angle in degrees."""
    with open(path, "w", encoding="utf-8") as file:
        file.write('<?xml version="1.0" encoding="UTF-8"?>\n<fcd-export>\n')
        for step in range(steps):
            file.write(f'    <timestep time="{step * STEP_S:.2f}">\n')
            for number, (x_m, y_m, angle_deg) in enumerate(vehicles_of(step)):
                file.write(f'        <vehicle id="v{number}" x="{x_m:.2f}" y="{y_m:.2f}" angle="{angle_deg:.0f}" type="car" '
                           f'speed="{SPEED_MPS}" pos="0" lane="a_0" slope="0"/>\n')
            file.write("    </timestep>\n")
        file.write("</fcd-export>\n")


def write_scenario(folder, scene, range_m, interactions, longest_m):
    """With the type of the vehicles. `scene`: its file, as seen from the folder."""
    with open(os.path.join(folder, "vtypes.add.xml"), "w", encoding="utf-8") as file:
        file.write('<additional>\n    <vType id="car" length="4.4" width="1.8" height="1.5"/>\n</additional>\n')
    with open(os.path.join(folder, "scenario.json"), "w", encoding="utf-8") as file:
        file.write(SCENARIO % (scene, range_m, interactions, longest_m))


def write_trace(path, vehicles, steps):
    side_m = 1000.0 * math.sqrt(vehicles / VEHICLES_PER_KM2)
    streets = max(1, round(side_m / STREET_SPACING_M))

    def vehicles_of(step):
        for number in range(vehicles):
            east = number % streets % 2 == 0
            start_m = side_m * ((number // streets * 0.6180339887 + number % streets * 0.37) % 1.0)
            along_m = (start_m + SPEED_MPS * STEP_S * step) % side_m - side_m / 2
            across_m = STREET_SPACING_M * (number % streets + 0.5) - side_m / 2
            yield (along_m, across_m, 90.0) if east else (across_m, along_m, 0.0)

    write_steps(path, steps, vehicles_of)


def main():
    if not 4 <= len(sys.argv) <= 7:
        sys.exit(__doc__)
    folder, vehicles, steps = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    range_m = float(sys.argv[4]) if len(sys.argv) > 4 else 150.0
    interactions = int(sys.argv[5]) if len(sys.argv) > 5 else 0
    longest_m = sys.argv[6] if len(sys.argv) > 6 else "null"
    os.makedirs(folder, exist_ok=True)
    town = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data", "town.obj")
    write_scenario(folder, os.path.relpath(town, folder), range_m, interactions, longest_m)
    write_trace(os.path.join(folder, "trace.fcd.xml"), vehicles, steps)
    print(f"{folder}: {steps} steps of {vehicles} vehicles")


if __name__ == "__main__":
    main()
