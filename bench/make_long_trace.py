#!/usr/bin/env python3
"""Writes a SUMO trace of any length, and a scenario that drives it through the town of data/.

  make_long_trace.py FOLDER MEGABYTES [VEHICLES_AT_A_TIME]

Vehicles enter one after the other, cross the town on parallel straight lanes, leave, and never come back: the trace
holds far more vehicles than are on the road at a time, as a day of traffic does. Nothing is random.
"""
import math
import os
import sys

STEP_S = 0.1
SPEED_MPS = 12.5
LANE_LENGTH_M = 300.0


def vehicle(number, time_s, entered_s):
    """Position and heading of a vehicle, as SUMO says them: centre of the front bumper, degrees clockwise from north."""
    along_m = SPEED_MPS * (time_s - entered_s) - LANE_LENGTH_M / 2
    across_m = 3.5 * (number % 40) - 70.0
    east = number % 2 == 0
    x_m, y_m = (along_m, across_m) if east else (across_m, along_m)
    return x_m, y_m, 90.0 if east else 0.0


def write_trace(path, limit_bytes, at_a_time):
    stay_s = LANE_LENGTH_M / SPEED_MPS
    headway_s = stay_s / at_a_time
    written = 0
    step = 0
    with open(path, "w", encoding="utf-8") as file:
        written += file.write('<?xml version="1.0" encoding="UTF-8"?>\n<fcd-export>\n')
        while written < limit_bytes:
            time_s = step * STEP_S
            first = max(0, math.ceil((time_s - stay_s) / headway_s))
            last = math.floor(time_s / headway_s)
            lines = [f'    <timestep time="{time_s:.2f}">\n']
            for number in range(first, last + 1):
                x_m, y_m, angle_deg = vehicle(number, time_s, number * headway_s)
                lines.append(f'        <vehicle id="veh{number}" x="{x_m:.2f}" y="{y_m:.2f}" angle="{angle_deg:.2f}" '
                             f'type="car" speed="{SPEED_MPS:.2f}" pos="{x_m + 150:.2f}" lane="lane{number % 40}_0" '
                             'slope="0.00"/>\n')
            lines.append("    </timestep>\n")
            written += file.write("".join(lines))
            step += 1
        file.write("</fcd-export>\n")
    return step


SCENARIO = """{
  "format": "dcem-scenario/1",
  "scene": {"obj": "%s"},
  "materials": {"metal": {"model": "pec"}},
  "frequency_hz": 30e9,
  "mobility": {"sumo_fcd": "trace.fcd.xml", "vehicle_types": "vtypes.add.xml", "material": "metal"},
  "transmitters": [{"id": "roof", "position_m": [68.5, 34.2, 20.3], "power_w": 5}],
  "receivers": [{"id": "square", "position_m": [24.3, 31.7, 1.5]}],
  "propagation": {"max_reflections": 1, "max_transmissions": 0, "discovery": "sampled", "rays": 200, "rays_steady": 20}
}
"""


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    folder, megabytes = sys.argv[1], float(sys.argv[2])
    at_a_time = int(sys.argv[3]) if len(sys.argv) == 4 else 200
    os.makedirs(folder, exist_ok=True)
    town = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data", "town.obj")
    with open(os.path.join(folder, "vtypes.add.xml"), "w", encoding="utf-8") as file:
        file.write('<additional>\n    <vType id="car" length="4.4" width="1.8" height="1.5"/>\n</additional>\n')
    with open(os.path.join(folder, "scenario.json"), "w", encoding="utf-8") as file:
        file.write(SCENARIO % os.path.relpath(town, folder))
    steps = write_trace(os.path.join(folder, "trace.fcd.xml"), megabytes * 1e6, at_a_time)
    print(f"{folder}: {steps} steps, up to {at_a_time} vehicles at a time")


if __name__ == "__main__":
    main()
