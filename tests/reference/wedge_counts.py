#!/usr/bin/env python3
"""Counts the diffracting edges of an OBJ file, by other means than the C++ code.

    python3 wedge_counts.py FILE.obj

Reads the file by itself; vertices and facets are joined as in surface_counts.py (whose small functions it uses). The
exterior angle comes from the triangles' opposite corners and one atan2 of a triple product. Edges between the same two
facets are one where they hang together through vertices and lie on one line: seen from the longest distance between two
of their vertices, none is further than 5 mm (two facets) or twice the weld tolerance (nearly flat, rims) from it.
Otherwise the chain is cut at every corner whose neighbours, taken one by one, do not pass it within that tolerance.
Prints counts, summed lengths, and how close the closest decision was to its limit.
"""
import math
import sys
from collections import defaultdict

from surface_counts import ANGLE_DEG, PLANARITY, STRAY, WELD, components, cross, dot, norm, read, sub, unit, weld


def clean(path):
    vertices, faces = read(path)
    distinct = sorted({vertices[c] for corners, _ in faces for c in corners})
    label = dict(zip(distinct, weld(distinct)))
    kept = {}
    for corners, material in faces:
        key = tuple(sorted(label[vertices[c]] for c in corners))
        a, b, c = (distinct[k] for k in key)
        longest = max(math.dist(a, b), math.dist(b, c), math.dist(c, a))
        if norm(cross(sub(b, a), sub(c, a))) > longest * max(1e-3 * WELD, 1e-12 * longest):
            kept[key] = min(kept.get(key, material), material)
    return distinct, sorted(kept.items())


def facets_of(distinct, triangles, edges):
    """Facet label of each triangle, and the mean normal of each facet."""
    points = [[distinct[k] for k in key] for key, _ in triangles]
    scaled = [cross(sub(b, a), sub(c, a)) for a, b, c in points]
    joined = defaultdict(list)
    for users in edges.values():
        for one in users:
            for other in users:
                if one == other or triangles[one][1] != triangles[other][1]:
                    continue
                sine, cosine = norm(cross(scaled[one], scaled[other])), abs(dot(scaled[one], scaled[other]))
                stray = max(abs(dot(unit(scaled[a]), sub(p, points[a][0]))) for a, b in ((one, other), (other, one))
                            for p in points[b])
                if math.degrees(math.atan2(sine, cosine)) < ANGLE_DEG and stray <= PLANARITY:
                    joined[one].append(other)
    label = components(len(triangles), joined)
    members = defaultdict(list)
    for index, first in enumerate(label):
        members[first].append(index)
    normal = {}
    for first, group in members.items():
        reference = max((scaled[m] for m in group), key=norm)
        sign = {m: math.copysign(0.5, dot(scaled[m], reference)) for m in group}
        normal[first] = unit([math.fsum(sign[m] * scaled[m][k] for m in group) for k in range(3)])
        area = math.fsum(0.5 * norm(scaled[m]) for m in group)
        centre = [math.fsum(0.5 * norm(scaled[m]) * sum(p[k] for p in points[m]) / 3 for m in group) / area
                  for k in range(3)]
        if max(abs(dot(normal[first], sub(p, centre))) for m in group for p in points[m]) > STRAY * PLANARITY:
            for m in group:
                label[m], normal[m] = m, unit(scaled[m])
    return label, normal


def off_line(point, a, b):
    return norm(cross(sub(point, a), sub(b, a))) / math.dist(a, b)


def cut_chain(pieces, distinct, tolerance):
    """Straight runs of a connected set of pieces: lists of their two ends."""
    at = defaultdict(list)
    for a, b in pieces:
        at[a].append(b)
        at[b].append(a)
    stops = {v for v, others in at.items() if len(others) != 2}
    gone = defaultdict(list)  # vertices passed by, per remaining edge
    links = {v: list(others) for v, others in at.items()}
    changed = True
    while changed:
        changed = False
        for v in sorted(links):
            if v in stops or len(links[v]) != 2 or links[v][0] == links[v][1]:
                continue
            a, b = links[v]
            if dot(sub(distinct[v], distinct[a]), sub(distinct[b], distinct[v])) <= 0.0:
                continue
            passed = gone[frozenset((a, v))] + gone[frozenset((v, b))] + [v]
            if max(off_line(distinct[p], distinct[a], distinct[b]) for p in passed) > tolerance or b in links[a]:
                continue
            links[a][links[a].index(v)], links[b][links[b].index(v)] = b, a
            gone[frozenset((a, b))] = passed
            del links[v]
            changed = True
    return [(a, b) for a in links for b in links[a] if a < b]


def main(path):
    distinct, triangles = clean(path)
    edges = defaultdict(list)
    for index, (key, _) in enumerate(triangles):
        for skip in range(3):
            edges[key[:skip] + key[skip + 1:]].append(index)
    label, normal = facets_of(distinct, triangles, edges)

    pairs, free, closest_flat, closest_190 = defaultdict(list), defaultdict(list), math.inf, math.inf
    for (a, b), users in edges.items():
        facets = {label[u] for u in users}
        if len(users) == 1:
            free[label[users[0]]].append((a, b))
        if len(users) != 2 or len(facets) != 2:
            continue
        along = unit(sub(distinct[b], distinct[a]))
        into = []
        for user in users:
            across = cross(normal[label[user]], along)
            corner = next(v for v in triangles[user][0] if v not in (a, b))
            into.append(across if dot(across, sub(distinct[corner], distinct[a])) > 0 else [-x for x in across])
        inside = math.degrees(math.atan2(abs(dot(along, cross(*into))), dot(*into)))
        closest_flat = min(closest_flat, abs(180 - inside - ANGLE_DEG))
        closest_190 = min(closest_190, abs(170 - inside))
        if 180 - inside > ANGLE_DEG:
            pairs[tuple(sorted(facets))].append((a, b, inside))

    total = {"wedges": [0, 0.0], "wedges_from_190_deg": [0, 0.0], "free_edges": [0, 0.0]}

    def count(name, ends):
        total[name][0] += 1
        total[name][1] += math.dist(distinct[ends[0]], distinct[ends[1]])

    bent = 0
    for pieces in pairs.values():
        for group in hanging_together([p[:2] for p in pieces]):
            inside = next(p[2] for p in pieces if p[:2] in group)
            vertices = sorted({v for piece in group for v in piece})
            ends = max(((a, b) for a in vertices for b in vertices if a < b),
                       key=lambda ab: math.dist(distinct[ab[0]], distinct[ab[1]]))
            stray = max(off_line(distinct[v], distinct[ends[0]], distinct[ends[1]]) for v in vertices)
            steep = 10 <= inside <= 170
            bent += steep and stray > 2 * WELD
            runs = [ends] if steep and stray <= STRAY * PLANARITY else cut_chain(group, distinct, 2 * WELD)
            for run in runs:
                count("wedges", run)
                if inside <= 170:
                    count("wedges_from_190_deg", run)
    for pieces in free.values():
        for group in hanging_together(pieces):
            for run in cut_chain(group, distinct, 2 * WELD):
                count("free_edges", run)
    for name, (number, length) in total.items():
        print(f"{name} {number} length_m {length:.9g}")
    print(f"edges between facets that bend by more than two weld tolerances {bent}")
    print(f"closest angle to flat {closest_flat:.3g} deg, to 190 degrees {closest_190:.3g} deg")


def hanging_together(pieces):
    neighbours, users = defaultdict(list), defaultdict(list)
    for index, piece in enumerate(pieces):
        for v in piece:
            users[v].append(index)
    for group in users.values():
        for one in group:
            neighbours[one] += [other for other in group if other != one]
    found = defaultdict(list)
    for index, first in enumerate(components(len(pieces), neighbours)):
        found[first].append(pieces[index])
    return found.values()


if __name__ == "__main__":
    main(sys.argv[1])
