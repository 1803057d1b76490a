#!/usr/bin/env python3
"""Runs a G-code program through LinuxCNC's own interpreter and compares its moves with a tool.csv.

    check_gcode.py PROGRAM.ngc TOOL.csv [--cache FOLDER] [--machine FOLDER]

Every move between the comments "path begins" and "path ends" must reproduce the tip of its row to 1 um in every
coordinate and the tool axis to 1e-6 in every component (the interpreter prints 4 decimals: 5e-5 mm, 9e-7 rad), in
order; moves between two rows must lie on the straight line between the tips and the great circle between the axes. Lifts
through the air must be traverses, all others feeds, with five axes the tool-centre-point control must be on, and the
feed must be that of the row: mm/min, or with five axes a move time no shorter than the length over the feed.

The interpreter comes from Debian's package linuxcnc-uspace, unpacked into the cache folder and not installed.
Exit status: 0 the program is right, 1 it is not, 77 the package cannot be had here.
"""

import argparse
import csv
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

PACKAGES = ["linuxcnc-uspace", "libboost-python1.74.0", "libmodbus5", "libpython3.11", "libedit2", "libtirpc3", "libbsd0"]
LENGTH_TOLERANCE = 1e-3  # mm
AXIS_TOLERANCE = 1e-6
ROOT = pathlib.Path(__file__).resolve().parent.parent


class Skip(Exception):
    """The check cannot run here."""


class Wrong(Exception):
    """The program does not do what the path says."""


def interpreter(cache):
    """Path of rs274 below the cache folder; downloads and unpacks it there at first."""
    root = cache / "root"
    program = root / "usr/bin/rs274"
    if program.exists():
        return program
    if not shutil.which("apt-get") or not shutil.which("dpkg-deb"):
        raise Skip("rs274 comes from a Debian package; there is no apt-get or dpkg-deb here")
    cache.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=cache) as folder:
        download = ["apt-get", "download", "-qq", *PACKAGES]
        got = subprocess.run(download, cwd=folder, capture_output=True, text=True)
        if got.returncode != 0 and os.geteuid() == 0:
            subprocess.run(["apt-get", "update", "-qq"], capture_output=True)
            got = subprocess.run(download, cwd=folder, capture_output=True, text=True)
        if got.returncode != 0:
            raise Skip("apt-get cannot download " + ", ".join(PACKAGES) + ": " + got.stderr.strip())
        unpacked = pathlib.Path(folder) / "root"
        for package in sorted(pathlib.Path(folder).glob("*.deb")):
            subprocess.run(["dpkg-deb", "-x", package, unpacked], check=True)
        try:
            unpacked.rename(root)  # at once: a cache folder is either complete or absent
        except OSError:
            if not program.exists():  # unless another run was first
                raise
    return program


def interpret(program, machine, cache):
    """The canonical commands that LinuxCNC makes of the program, one a line."""
    rs274 = interpreter(cache).resolve()
    libraries = [rs274.parent.parent / "lib", *(rs274.parent.parent / "lib").glob("*-linux-gnu*")]
    environment = dict(os.environ, LD_LIBRARY_PATH=":".join(map(str, libraries)))
    with tempfile.TemporaryDirectory() as folder:
        for file in machine.iterdir():
            shutil.copy(file, folder)
        shutil.copy(program, pathlib.Path(folder) / "program.ngc")
        for name in ("check.var", "check.tbl"):
            (pathlib.Path(folder) / name).touch()
        command = [rs274, "-g", "-i", "check.ini", "-v", "check.var", "-t", "check.tbl", "program.ngc"]
        run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300)
    if "error while loading shared libraries" in run.stderr:
        raise Skip("rs274 does not start: " + run.stderr.strip())
    if run.returncode != 0 or "PROGRAM_END()" not in run.stdout:
        last = (run.stdout.strip().splitlines() or ["nothing"])[-1]
        raise Wrong(f"LinuxCNC refuses the program: {run.stderr.strip()}\n  its last command: {last}")
    return run.stdout


def path_moves(canonical):
    """(is feed, x, y, z, a, c, feed or moves per minute, tcp is on, inverse time) of every move of the path proper."""
    moves = []
    within = tcp = inverse = False
    feed = 0.0
    for line in canonical.splitlines():
        match = re.search(r"([A-Z_0-9]+)\((.*)\)\s*$", line)
        if not match:
            continue
        name, arguments = match.groups()
        if name == "COMMENT":
            comment = arguments.strip('"')
            within = {"path begins": True, "path ends": False}.get(comment, within)
            tcp = {"tcp on": True, "tcp off": False}.get(comment, tcp)
            if "feed mode set to" in comment:
                inverse = "inverse time" in comment
        elif name == "SET_FEED_RATE":
            feed = float(arguments)
        elif within and name in ("STRAIGHT_FEED", "STRAIGHT_TRAVERSE"):
            x, y, z, a, _, c = map(float, arguments.split(","))
            moves.append((name == "STRAIGHT_FEED", x, y, z, a, c, feed, tcp, inverse))
        elif within and name.startswith("ARC"):
            raise Wrong("the program has an arc; a path is made of straight moves")
    return moves


def tool_axis(a, c):
    """The part's direction that stands along the machine's +Z, for a tilting rotary table (xyzac-trt-kins)."""
    a, c = math.radians(a), math.radians(c)
    return (math.sin(c) * math.sin(a), math.cos(c) * math.sin(a), math.cos(a))


def position_and_axis(row):
    return [float(row[name]) for name in "xyz"], [float(row[name]) for name in "ijk"]


def part_way(before, row, place):
    """Tip, axis and axis tolerance where a move between two rows should be that ends near this place."""
    (p, a), (q, b) = position_and_axis(before), position_and_axis(row)
    length = math.dist(p, q)
    u = sum((s - o) * (t - o) for s, o, t in zip(place, p, q)) / length**2 if length else 1.0
    u = min(max(u, 0.0), 1.0)
    angle = math.atan2(math.dist(a, b) / 2, math.dist(a, [-x for x in b]) / 2) * 2
    if angle < 1e-8:
        axis = a
    else:
        axis = [(math.sin((1 - u) * angle) * s + math.sin(u * angle) * t) / math.sin(angle) for s, t in zip(a, b)]
    # The 4 decimals of the place leave u, and so the axis, uncertain.
    return [s + u * (t - s) for s, t in zip(p, q)], axis, AXIS_TOLERANCE + angle * 1e-4 / max(length, 1e-4)


def difference(move, tip, axis):
    """Largest differences of a coordinate and of a component of the axis."""
    _, x, y, z, a, c, *_ = move
    return tuple(max(abs(p - w) for p, w in zip(*pair)) for pair in (((x, y, z), tip), (tool_axis(a, c), axis)))


def reproduces(move, row):
    off, axis_off = difference(move, *position_and_axis(row))
    return off <= LENGTH_TOLERANCE and axis_off <= AXIS_TOLERANCE


def check_between(move, before, row):
    """A move that does not end at the row must end on the way to it."""
    tip, axis, tolerance = part_way(before, row, move[1:4])
    off, axis_off = difference(move, tip, axis)
    if off > LENGTH_TOLERANCE or axis_off > tolerance:
        wanted = position_and_axis(row)
        off, axis_off = difference(move, *wanted)
        raise Wrong(
            f"tip off by {off:.6f} mm, axis off by {axis_off:.2e}: moves to {move[1:4]} with A {move[4]} C {move[5]}, "
            f"the path says {wanted[0]} with axis {wanted[1]}"
        )


def check_manner(row, is_lift_in_air, last, move):
    """Rapid or feed, how fast, and under which control."""
    is_feed, *_, a, c, feed, tcp, inverse = move
    if (a or c) and not tcp:
        raise Wrong("A or C is not 0, but the tool-centre-point control is off")
    if is_feed == is_lift_in_air:
        raise Wrong("a lift through the air must be a traverse, any other move a feed")
    wanted = float(row["feed"])
    if is_feed and not inverse and abs(feed - wanted) > 1e-4 * max(1, feed):
        raise Wrong(f"feed is {feed} mm/min, the path says {wanted}")
    # With inverse time the interpreter turns moves a minute into mm/min; the table may slow a move down.
    if is_feed and inverse and last and math.dist(last[1:4], move[1:4]) > 0.05 and feed > wanted * 1.01:
        raise Wrong(f"moves at {feed} mm/min, the path says {wanted}")


def compare(rows, moves):
    """Walks along the moves and the rows together."""
    i = 0
    last = None
    for move in moves:
        if i == len(rows):
            raise Wrong("moves on after the last point")
        following = rows[i + 1]["kind"] if i + 1 < len(rows) else "lift"
        try:
            check_manner(rows[i], rows[i]["kind"] == "lift" and following == "lift", last, move)
            if reproduces(move, rows[i]):
                i += 1
            else:
                check_between(move, rows[max(i - 1, 0)], rows[i])
        except Wrong as wrong:
            raise Wrong(f"point {i}: {wrong}") from None
        last = move
    if i < len(rows):
        raise Wrong(f"ends after {i} of {len(rows)} points")


def check(program, tool, machine, cache):
    with open(tool, newline="") as file:
        rows = list(csv.DictReader(file))
    compare(rows, path_moves(interpret(program, machine, cache)))
    return len(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("tool", type=pathlib.Path)
    parser.add_argument("--cache", type=pathlib.Path, default=ROOT / "build/linuxcnc", help="where rs274 is kept")
    parser.add_argument("--machine", type=pathlib.Path, default=ROOT / "tests/post/linuxcnc", help="check.ini and subs")
    given = parser.parse_args()
    try:
        count = check(given.program, given.tool, given.machine, given.cache)
    except Skip as skip:
        print(f"check_gcode: skipped: {skip}", file=sys.stderr)
        return 77
    except Wrong as wrong:
        print(f"check_gcode: {given.program}: {wrong}", file=sys.stderr)
        return 1
    print(f"check_gcode: {given.program}: LinuxCNC reproduces all {count} points")
    return 0


if __name__ == "__main__":
    sys.exit(main())
