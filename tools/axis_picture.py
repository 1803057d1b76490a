#!/usr/bin/env python3
"""Draws a medial axis over isolines, seen along z: axis_picture.py axis.csv lines.json out.svg

axis.csv is what `isopath medial-axis` writes, lines.json what `isopath contours` writes.
"""

import csv
import json
import sys
from collections import defaultdict

axis_file, lines_file, out_file = sys.argv[1:]
arcs = defaultdict(list)
with open(axis_file, encoding="utf-8") as file:
    for row in csv.DictReader(file):
        arcs[row["arc"]].append((float(row["x"]), float(row["y"])))
with open(lines_file, encoding="utf-8") as file:
    lines = [[(x, y) for x, y, _ in c["points"] + c["points"][: c["closed"]]] for c in json.load(file)["contours"]]

points = [p for line in [*arcs.values(), *lines] for p in line]
left, right = min(x for x, _ in points), max(x for x, _ in points)
low, high = min(y for _, y in points), max(y for _, y in points)
scale = 600 / max(right - left, high - low)


def polyline(line, style):
    text = " ".join(f"{(x - left) * scale + 10:.1f},{(high - y) * scale + 10:.1f}" for x, y in line)
    return f'<polyline points="{text}" fill="none" {style}/>'


width, height = (right - left) * scale + 20, (high - low) * scale + 20
with open(out_file, "w", encoding="utf-8") as file:
    file.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}">\n')
    file.write(f'<rect width="{width:.0f}" height="{height:.0f}" fill="white"/>\n')
    for line in lines:
        file.write(polyline(line, 'stroke="#9ab" stroke-width="1"') + "\n")
    for line in arcs.values():
        file.write(polyline(line, 'stroke="#c22" stroke-width="2.5"') + "\n")
    file.write("</svg>\n")
