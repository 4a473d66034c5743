#!/usr/bin/env python3
"""Sets copies of a city side by side and writes a SUMO trace of vehicles in their streets, all of which carry devices.

  make_city_fleet.py CITY.obj FOLDER COPIES STEPS [RANGE_M] [INTERACTIONS] [LONGEST_PATH_M]

COPIES x COPIES copies with 625 vehicles each. A vehicle drives along a straight that nothing stands on, north and south
or east and west, and turns round at its ends. The same arguments give the same files.
"""
import os
import random
import sys

from make_fleet import SPEED_MPS, STEP_S, write_scenario, write_steps

VEHICLES_PER_COPY = 625
CELL_M = 2.0
STREET_HEIGHT_M = 1.0  # what is higher stands in the way
SHORTEST_M = 40.0


class City:
    """The lines of an OBJ file, and where nothing stands."""

    def __init__(self, path):
        self.vertices, self.faces, self.lines = [], [], []
        with open(path, encoding="utf-8") as file:
            for line in file:
                words = line.split()
                if not words or words[0] in ("vn", "vt"):
                    continue
                if words[0] == "v":
                    self.vertices.append(tuple(map(float, words[1:4])))
                    self.lines.append(("v", len(self.vertices) - 1))
                elif words[0] == "f":
                    corners = [int(word.split("/")[0]) - 1 for word in words[1:]]
                    self.faces.append(corners)
                    self.lines.append(("f", corners))
                elif words[0] == "usemtl":
                    self.lines.append(("text", line))
        self.low = [min(vertex[axis] for vertex in self.vertices) for axis in range(2)]
        self.size = [max(vertex[axis] for vertex in self.vertices) - self.low[axis] for axis in range(2)]
        self.cells = [int(self.size[axis] / CELL_M) for axis in range(2)]
        self.taken = [bytearray(self.cells[0]) for _ in range(self.cells[1])]
        for corners in self.faces:
            self._take([self.vertices[corner] for corner in corners])

    def _take(self, corners):
        """Marks the cells of the box around a triangle over the street, or around its pieces where it is large."""
        if max(corner[2] for corner in corners) < STREET_HEIGHT_M:
            return
        low = [int((min(corner[axis] for corner in corners) - self.low[axis]) / CELL_M) for axis in range(2)]
        high = [int((max(corner[axis] for corner in corners) - self.low[axis]) / CELL_M) for axis in range(2)]
        if len(corners) == 3 and max(high[0] - low[0], high[1] - low[1]) > 1:
            middles = [tuple(0.5 * (corners[at][axis] + corners[(at + 1) % 3][axis]) for axis in range(3)) for at in range(3)]
            for at in range(3):
                self._take([corners[at], middles[at], middles[at - 1]])
            return self._take(middles)
        for row in range(max(0, low[1]), min(self.cells[1] - 1, high[1]) + 1):
            for column in range(max(0, low[0]), min(self.cells[0] - 1, high[0]) + 1):
                self.taken[row][column] = 1

    def is_free(self, column, row):
        """Whether a vehicle has room there, with a cell more on each side."""
        inside = 1 <= column < self.cells[0] - 1 and 1 <= row < self.cells[1] - 1
        return inside and not any(self.taken[row + dy][column + dx] for dx in (-1, 0, 1) for dy in (-1, 0, 1))

    def straight(self, draw):
        """A free straight: its first cell, its axis and its length in cells."""
        while True:
            start = [draw.randrange(self.cells[0]), draw.randrange(self.cells[1])]
            axis = draw.randrange(2)
            if not self.is_free(*start):
                continue
            first, last = list(start), list(start)
            while self.is_free(*[first[at] - (at == axis) for at in range(2)]):
                first[axis] -= 1
            while self.is_free(*[last[at] + (at == axis) for at in range(2)]):
                last[axis] += 1
            length = last[axis] - first[axis]
            if length * CELL_M >= SHORTEST_M:
                return first, axis, length, start[axis] - first[axis]


def write_city(city, path, copies):
    with open(path, "w", encoding="utf-8") as file:
        file.write("mtllib city.mtl\n")
        for copy in range(copies * copies):
            east_m, north_m = city.size[0] * (copy % copies), city.size[1] * (copy // copies)
            first = copy * len(city.vertices) + 1
            for kind, what in city.lines:
                if kind == "v":
                    x_m, y_m, z_m = city.vertices[what]
                    file.write(f"v {x_m + east_m:.4f} {y_m + north_m:.4f} {z_m:.4f}\n")
                elif kind == "f":
                    file.write("f " + " ".join(str(corner + first) for corner in what) + "\n")
                else:
                    file.write(what)


def drives_of(city, copies):
    """Of each vehicle where its straight begins, its axis, its length and where the vehicle is at first, in metres."""
    draw = random.Random(1)
    for copy in range(copies * copies):
        shift_m = (city.size[0] * (copy % copies), city.size[1] * (copy // copies))
        for _ in range(VEHICLES_PER_COPY):
            first, axis, length, at = city.straight(draw)
            start_m = [city.low[side] + shift_m[side] + (first[side] + 0.5) * CELL_M for side in range(2)]
            yield start_m, axis, length * CELL_M, at * CELL_M


def places_of(drives, step):
    for start_m, axis, length_m, at_m in drives:
        way_m = (at_m + SPEED_MPS * STEP_S * step) % (2.0 * length_m)
        back = way_m > length_m
        place_m = list(start_m)
        place_m[axis] += 2.0 * length_m - way_m if back else way_m
        angle_deg = (270 if back else 90) if axis == 0 else (180 if back else 0)
        yield place_m[0], place_m[1], angle_deg


def main():
    if not 5 <= len(sys.argv) <= 8:
        sys.exit(__doc__)
    city_file, folder, copies, steps = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    range_m = float(sys.argv[5]) if len(sys.argv) > 5 else 150.0
    interactions = int(sys.argv[6]) if len(sys.argv) > 6 else 0
    longest_m = sys.argv[7] if len(sys.argv) > 7 else "null"
    os.makedirs(folder, exist_ok=True)
    city = City(city_file)
    write_city(city, os.path.join(folder, "city.obj"), copies)
    with open(os.path.splitext(city_file)[0] + ".mtl", encoding="utf-8") as source:
        materials = source.read()
    with open(os.path.join(folder, "city.mtl"), "w", encoding="utf-8") as file:
        file.write(materials)
    write_scenario(folder, "city.obj", range_m, interactions, longest_m)
    drives = list(drives_of(city, copies))
    write_steps(os.path.join(folder, "trace.fcd.xml"), steps, lambda step: places_of(drives, step))
    print(f"{folder}: {copies} x {copies} copies, {steps} steps of {len(drives)} vehicles")


if __name__ == "__main__":
    main()
