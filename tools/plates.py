#!/usr/bin/env python3
"""Writes the flat and wavy parts of docs/blending.md and docs/anisotropic.md as OFF files: plates.py folder"""

import math
import pathlib
import sys


def write(name, points, triangles):
    lines = ["OFF", f"{len(points)} {len(triangles)} 0"]
    lines += [" ".join(f"{c:.9g}" for c in p) for p in points]
    lines += [f"3 {a} {b} {c}" for a, b, c in triangles]
    (folder / f"{name}.off").write_text("\n".join(lines) + "\n", encoding="utf-8")


def cells(name, nx, ny, size, keep=lambda i, j: True, height=lambda x, y: 0, origin=0):
    """The cells of a grid that are kept, from `origin` in x and y on."""
    index, points, triangles = {}, [], []

    def vertex(i, j):
        if (i, j) not in index:
            x, y = origin + i * size, origin + j * size
            index[i, j] = len(points)
            points.append((x, y, height(x, y)))
        return index[i, j]

    for i in range(nx):
        for j in range(ny):
            if keep(i, j):
                a, b, c, d = vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)
                triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
    write(name, points, triangles)


def fan(name, outline, rings, height=lambda x, y: 0):
    """What a closed outline around the origin encloses, in rings around it."""
    n = len(outline)
    points = [(0, 0, height(0, 0))]
    for ring in range(1, rings + 1):
        points += [(x * ring / rings, y * ring / rings, height(x * ring / rings, y * ring / rings)) for x, y in outline]
    triangles = [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]
    for ring in range(rings - 1):
        for k in range(n):
            a, b = 1 + ring * n + k, 1 + ring * n + (k + 1) % n
            triangles += [(a, a + n, b + n), (a, b + n, b)]
    write(name, points, triangles)


def ring(name, outer, inner, rings):
    """What lies between two closed outlines of as many points."""
    n = len(outer)
    points = [((1 - t) * a[0] + t * b[0], (1 - t) * a[1] + t * b[1], 0)
              for t in (r / rings for r in range(rings + 1)) for a, b in zip(outer, inner)]
    triangles = []
    for r in range(rings):
        for k in range(n):
            a, b = r * n + k, r * n + (k + 1) % n
            triangles += [(a, b, b + n), (a, b + n, a + n)]
    write(name, points, triangles)


def star(tips, outer, inner, parts):
    corners = [(r * math.cos(math.pi * k / tips), r * math.sin(math.pi * k / tips))
               for k, r in enumerate([outer, inner] * tips)]
    return [((1 - t) * a[0] + t * b[0], (1 - t) * a[1] + t * b[1])
            for a, b in zip(corners, corners[1:] + corners[:1]) for t in (s / parts for s in range(parts))]


def notched(angle):
    off = math.remainder(angle - 1.2, 2 * math.pi)
    share = 1 - 0.55 * math.exp(-((off / 0.16) ** 2))
    return 100 * share * math.cos(angle), 70 * share * math.sin(angle)


folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
turn = [2 * math.pi * k / 360 for k in range(360)]
cells("square", 20, 20, 5)
cells("l", 20, 20, 5, lambda i, j: i < 10 or j < 10)
cells("strip", 60, 6, 5)
cells("dumbbell", 40, 16, 5, lambda i, j: i < 14 or i >= 26 or 6 <= j < 10)
cells("bump", 60, 60, 2, height=lambda x, y: 35 * math.exp(-((x - 15) ** 2 + (y - 5) ** 2) / 288), origin=-60)
fan("disc", [(50 * math.cos(t), 50 * math.sin(t)) for t in turn[::2]], 12)
fan("star", star(5, 60, 25, 12), 10)
fan("notch", [notched(t) for t in turn], 30, lambda x, y: 9 * math.sin(x / 14) * math.cos(y / 14))
cells("frame", 24, 24, 5, lambda i, j: not (8 <= i < 16 and 8 <= j < 16))
cells("slab", 30, 12, 5, lambda i, j: not (6 <= i < 10 and 4 <= j < 8))
ring("washer", [(60 * math.cos(t), 60 * math.sin(t)) for t in turn[::2]],
     [(25 * math.cos(t), 25 * math.sin(t)) for t in turn[::2]], 12)
ring("eccentric", [(60 * math.cos(t), 60 * math.sin(t)) for t in turn[::2]],
     [(20 + 25 * math.cos(t), 25 * math.sin(t)) for t in turn[::2]], 14)
holes = [(8, 13, 7, 11), (21, 25, 3, 7), (28, 33, 11, 15)]
cells("plate", 40, 20, 5, lambda i, j: not any(a <= i < b and c <= j < d for a, b, c, d in holes),
      lambda x, y: 8 * math.sin(x / 25) * math.cos(y / 25))
cells("waves", 160, 160, 0.2, height=lambda x, y: 4.2 * math.sin(0.2 * x) * math.cos(0.2 * y))
