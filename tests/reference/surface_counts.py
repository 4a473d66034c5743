#!/usr/bin/env python3
"""Counts what the surface builder should find in an OBJ file, by other means than the C++ code.

    python3 surface_counts.py FILE.obj

Vertices are joined by sweeping along x, sets by breadth-first search, angles come from atan2, normals and mean planes
from exact sums (math.fsum). Rules: conventions, section on facets: weld 1e-4 m, planarity 1e-3 m, 0.1 degrees, five
planarity tolerances. Prints one count per line, and how close the closest decision was to its limit.
"""
import math
import sys
from collections import defaultdict, deque

WELD, PLANARITY, ANGLE_DEG, STRAY = 1e-4, 1e-3, 0.1, 5.0


def read(path):
    vertices, faces, material = [], [], "default"
    for line in open(path):
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            vertices.append(tuple(map(float, words[1:4])))
        elif words[0] == "usemtl":
            material = words[1]
        elif words[0] == "f":
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [c - 1 if c > 0 else len(vertices) + c for c in corners]
            assert len(corners) == 3, "triangles only"
            faces.append((tuple(corners), material))
    return vertices, faces


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return math.fsum((a[0] * b[0], a[1] * b[1], a[2] * b[2]))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def norm(a):
    return math.hypot(*a)


def unit(a):
    length = norm(a)
    return (a[0] / length, a[1] / length, a[2] / length)


def components(count, neighbours):
    """Label of each node: the smallest node of its connected set."""
    label = [None] * count
    for start in range(count):
        if label[start] is not None:
            continue
        label[start], queue = start, deque([start])
        while queue:
            for other in neighbours[queue.popleft()]:
                if label[other] is None:
                    label[other] = start
                    queue.append(other)
    return label


def weld(points):
    """points: distinct, sorted. Neighbours by a sweep along x."""
    neighbours = defaultdict(list)
    first = 0
    for index, point in enumerate(points):
        while points[first][0] < point[0] - 2 * WELD:
            first += 1
        for other in range(first, index):
            if math.dist(point, points[other]) <= WELD:
                neighbours[index].append(other)
                neighbours[other].append(index)
    return components(len(points), neighbours)


def main(path):
    vertices, faces = read(path)
    used = sorted({c for corners, _ in faces for c in corners})
    distinct = sorted({vertices[c] for c in used})
    label = dict(zip(distinct, weld(distinct)))
    counts = {"vertices_read": len(vertices), "triangles_read": len(faces)}
    counts["vertices_welded"] = len(used) - len(set(label.values()))

    kept, repeated, flat = {}, 0, 0
    for corners, material in faces:
        key = tuple(sorted(label[vertices[c]] for c in corners))
        a, b, c = (distinct[k] for k in key)
        longest = max(math.dist(a, b), math.dist(b, c), math.dist(c, a))
        if norm(cross(sub(b, a), sub(c, a))) <= longest * max(1e-3 * WELD, 1e-12 * longest):
            flat += 1
        elif key in kept:
            repeated += 1
            kept[key] = min(kept[key], material)
        else:
            kept[key] = material
    counts["triangles_without_area"], counts["triangles_repeated"] = flat, repeated
    triangles = sorted(kept.items())
    points = [[distinct[k] for k in key] for key, _ in triangles]
    normals = [unit(cross(sub(b, a), sub(c, a))) for a, b, c in points]
    areas = [0.5 * norm(cross(sub(b, a), sub(c, a))) for a, b, c in points]

    edges = defaultdict(list)
    for index, (key, _) in enumerate(triangles):
        for pair in ((key[0], key[1]), (key[0], key[2]), (key[1], key[2])):
            edges[pair].append(index)
    counts["open_edges"] = sum(len(users) == 1 for users in edges.values())
    counts["crowded_edges"] = sum(len(users) > 2 for users in edges.values())

    closest_angle, closest_stray = math.inf, math.inf
    joined, touching = defaultdict(list), defaultdict(list)
    for users in edges.values():
        for i, one in enumerate(users):
            for other in users[:i]:
                touching[one].append(other)
                touching[other].append(one)
                if triangles[one][1] != triangles[other][1]:
                    continue
                angle = math.degrees(math.atan2(norm(cross(normals[one], normals[other])),
                                                abs(dot(normals[one], normals[other]))))
                stray = max(abs(dot(normals[a], sub(p, points[a][0]))) for a, b in ((one, other), (other, one))
                            for p in points[b])
                if stray < 2 * PLANARITY:
                    closest_angle = min(closest_angle, abs(angle - ANGLE_DEG))
                if angle < 2 * ANGLE_DEG:
                    closest_stray = min(closest_stray, abs(stray - PLANARITY))
                if angle < ANGLE_DEG and stray <= PLANARITY:
                    joined[one].append(other)
                    joined[other].append(one)

    sets = defaultdict(list)
    for index, first in enumerate(components(len(triangles), joined)):
        sets[first].append(index)
    facets, uneven, closest_bend = 0, 0, math.inf
    for members in sets.values():
        if len(members) == 1:
            facets += 1
            continue
        reference = normals[max(members, key=lambda m: areas[m])]
        sign = {m: math.copysign(1.0, dot(normals[m], reference)) for m in members}
        normal = unit([math.fsum(sign[m] * areas[m] * normals[m][k] for m in members) for k in range(3)])
        total = math.fsum(areas[m] for m in members)
        centre = [math.fsum(areas[m] * sum(p[k] for p in points[m]) / 3 for m in members) / total for k in range(3)]
        stray = max(abs(dot(normal, sub(p, centre))) for m in members for p in points[m])
        closest_bend = min(closest_bend, abs(stray - STRAY * PLANARITY))
        uneven += stray > STRAY * PLANARITY
        facets += len(members) if stray > STRAY * PLANARITY else 1
    counts["facets"], counts["uneven_sets"] = facets, uneven

    shells = defaultdict(list)
    for index, first in enumerate(components(len(triangles), touching)):
        shells[first].append(index)
    closed, standing, flat_sheets = 0, 0, 0
    shell_of = {m: first for first, members in shells.items() for m in members}
    places = defaultdict(list)
    for pair, users in edges.items():
        places[shell_of[users[0]]].append((pair, len(users)))
    for first, members in shells.items():
        heights = [p[2] for m in members for p in points[m]]
        foot = min(heights)
        open_pairs = [pair for pair, users in places[first] if users == 1]
        if any(users > 2 for _, users in places[first]):
            continue
        if any(max(distinct[v][2] for v in pair) > foot + WELD for pair in open_pairs):
            continue
        if not open_pairs:
            closed += 1
        elif max(heights) > foot + WELD:
            standing += 1
        else:
            flat_sheets += 1  # a level sheet is all foot: nothing stands on it, it encloses nothing
    counts["closed_shells"], counts["standing_shells"], counts["level_sheets"] = closed, standing, flat_sheets
    counts["triangles_kept"] = len(triangles)
    for name, value in counts.items():
        print(f"{name} {value}")
    print(f"area_m2 {math.fsum(areas):.9g}")
    print(f"closest angle to its limit {closest_angle:.3g} deg, corner {closest_stray:.3g} m, bend {closest_bend:.3g} m")


if __name__ == "__main__":
    main(sys.argv[1])
