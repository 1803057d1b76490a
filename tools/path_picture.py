#!/usr/bin/env python3
"""Draws planned paths side by side, seen along z: path_picture.py out.svg impact.csv…"""

import csv
import sys
from itertools import groupby

size, gap = 300, 15
colour = {"cover": "#135", "link": "#c22", "lift": "#c2c"}
body, left, tall = [], gap, 0
for name in sys.argv[2:]:
    with open(name, encoding="utf-8") as file:
        points = [(float(row["x"]), float(row["y"]), row["kind"]) for row in csv.DictReader(file)]
    low = [min(p[i] for p in points) for i in range(2)]
    high = [max(p[i] for p in points) for i in range(2)]
    scale = size / max(high[i] - low[i] for i in range(2))
    place = [(left + (x - low[0]) * scale, gap + (high[1] - y) * scale) for x, y, _ in points]
    for kind, run in groupby(range(1, len(points)), key=lambda i: points[i][2]):
        run = list(run)
        line = [place[run[0] - 1]]
        for point in place[run[0] : run[-1] + 1]:
            if abs(point[0] - line[-1][0]) + abs(point[1] - line[-1][1]) > 1.2:  # finer than a picture shows
                line.append(point)
        text = " ".join(f"{x:.1f},{y:.1f}" for x, y in [*line, place[run[-1]]])
        body.append(f'<polyline points="{text}" fill="none" stroke="{colour[kind]}" stroke-width="1.2"/>')
    tall = max(tall, (high[1] - low[1]) * scale + 2 * gap)
    left += (high[0] - low[0]) * scale + gap
with open(sys.argv[1], "w", encoding="utf-8") as file:
    file.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {left:.0f} {tall:.0f}">\n')
    file.write(f'<rect width="{left:.0f}" height="{tall:.0f}" fill="white"/>\n' + "\n".join(body) + "\n</svg>\n")
