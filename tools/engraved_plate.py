#!/usr/bin/env python3
"""Writes the bubbles of scenes/engraved_plate.toml: one mesh of a ball, shown by a node for each bubble.

    python3 tools/engraved_plate.py scenes/meshes/bubbles.glb
    python3 tools/engraved_plate.py scenes/meshes/bubbles.glb --spheres scenes/engraved_plate.toml spheres.toml

The second form also writes the scene with exact spheres in place of the mesh, which gives its reference.
Bubbles of radius 0.2 mm lie in a plate from x = 0 to 60 mm, |y| < 19 mm, z = 0.6 to 3.4 mm, more of them far from the
lamp at x = 0. The ball is an icosahedron with each triangle divided into four, three times, and the area of the
sphere: the mean cross-section of a convex body is a quarter of its area (Cauchy).
"""

import json
import math
import struct
import sys

BUBBLES, RADIUS = 2000, 0.2
SIZE, MARGIN = (60.0, 38.0, 4.0), 0.6
LEVELS = 3
TINY = 1e-3  # glTF is in metres


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


def ball():
    golden = (1 + 5**0.5) / 2
    points = [unit(p) for a in (-1, 1) for b in (-golden, golden) for p in ((0, a, b), (a, b, 0), (b, 0, a))]
    near = lambda p, q: math.dist(p, q) < 1.2
    triangles = []
    for i in range(12):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                a, b, c = points[i], points[j], points[k]
                if near(a, b) and near(b, c) and near(c, a):
                    triangles.append((i, j, k) if dot(cross(sub(b, a), sub(c, a)), a) > 0 else (i, k, j))
    middles = {}

    def middle(i, j):
        key = (min(i, j), max(i, j))
        if key not in middles:
            middles[key] = len(points)
            points.append(unit(tuple(x + y for x, y in zip(points[i], points[j]))))
        return middles[key]

    for _ in range(LEVELS):
        finer = []
        for i, j, k in triangles:
            a, b, c = middle(i, j), middle(j, k), middle(k, i)
            finer += [(i, a, c), (a, j, b), (c, b, k), (a, b, c)]
        triangles = finer
    return points, triangles


def sub(p, q):
    return tuple(x - y for x, y in zip(p, q))


def dot(p, q):
    return sum(x * y for x, y in zip(p, q))


def cross(p, q):
    return (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])


def radical_inverse(base, n):
    value, share = 0.0, 1.0 / base
    while n:
        value += share * (n % base)
        n, share = n // base, share / base
    return value


def places():
    """A Halton sequence, with a density along x that grows from 1 to 2.5; bubbles keep apart."""
    found, cells, index = [], {}, 0
    gap = 2.2 * RADIUS
    while len(found) < BUBBLES:
        index += 1
        u, v, w = (radical_inverse(base, index) for base in (2, 3, 5))
        # Cumulative density s + 0.75 s^2 over 1.75, inverted.
        s = (math.sqrt(1 + 4 * 0.75 * 1.75 * u) - 1) / 1.5
        x, y, z = 1 + s * (SIZE[0] - 2), (v - 0.5) * SIZE[1], MARGIN + w * (SIZE[2] - 2 * MARGIN)
        place = tuple(round(c, 2) for c in (x, y, z))
        cell = tuple(math.floor(c / gap) for c in place)
        around = [
            other
            for dx in (-1, 0, 1)
            for dy in (-1, 0, 1)
            for dz in (-1, 0, 1)
            for other in cells.get((cell[0] + dx, cell[1] + dy, cell[2] + dz), [])
        ]
        if all(max(abs(a - b) for a, b in zip(place, other)) >= gap for other in around):
            cells.setdefault(cell, []).append(place)
            found.append(place)
    return found


def write_glb(path, all_places):
    points, triangles = ball()
    area = sum(
        0.5 * math.sqrt(dot(n, n))
        for n in (cross(sub(points[j], points[i]), sub(points[k], points[i])) for i, j, k in triangles)
    )
    radius = RADIUS * math.sqrt(4 * math.pi / area)
    positions = b"".join(struct.pack("<3f", *(radius * TINY * x for x in p)) for p in points)
    normals = b"".join(struct.pack("<3f", *p) for p in points)
    indices = b"".join(struct.pack("<3H", *t) for t in triangles)
    blob = positions + normals + indices
    views, start = [], 0
    for part in (positions, normals, indices):
        views.append({"buffer": 0, "byteOffset": start, "byteLength": len(part)})
        start += len(part)
    document = {
        "asset": {"version": "2.0", "generator": "tools/engraved_plate.py"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"scale": [TINY] * 3, "children": list(range(1, len(all_places) + 1))}]
        + [{"mesh": 0, "translation": list(place), "scale": [1 / TINY] * 3} for place in all_places],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"name": "bubble"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": len(points), "type": "VEC3"},
            {"bufferView": 2, "componentType": 5123, "count": 3 * len(triangles), "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": len(blob)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    blob += b"\0" * (-len(blob) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(blob)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(blob), b"BIN\0") + blob)


def write_spheres(scene, path, all_places):
    text = open(scene, encoding="utf-8").read()
    start = text.index("[solids.bubbles.mesh]")
    end = text.index("\n\n", start)
    solids = "\n\n".join(
        f"[solids.bubble_{i}.sphere]\nradius_mm = {RADIUS}\nmedium = \"air\"\npriority = 1\n"
        f"at = {{ position_mm = [{x}, {y}, {z}] }}"
        for i, (x, y, z) in enumerate(all_places)
    )
    with open(path, "w", encoding="utf-8") as file:
        file.write(text[:start] + solids + text[end:])


def main():
    all_places = places()
    write_glb(sys.argv[1], all_places)
    if sys.argv[2:3] == ["--spheres"]:
        write_spheres(sys.argv[3], sys.argv[4], all_places)


if __name__ == "__main__":
    main()
