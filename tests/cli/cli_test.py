"""Runs the program as people run it: arguments in; files, standard output and exit status out.

Usage: cli_test.py PROGRAM COMMAND,COMMAND,... SLOWNESS [unittest arguments]
SLOWNESS is how many times slower this build of the program is than the one that is delivered: limits of time are
stretched by it, and parts that only serve to keep the program busy are made smaller.
"""

import json
import math
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = ""
COMMANDS = []
SLOWNESS = 1.0
OK, FAULT, USAGE, INPUT, NO_PLAN, INTERRUPTED = 0, 1, 2, 3, 4, 130


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=120 * SLOWNESS)


def grid_off(nx, ny, step):
    """A plane of nx by ny squares of two triangles; vertex (i, j) is number j (nx + 1) + i."""
    vertices = [(i * step, j * step, 0) for j in range(ny + 1) for i in range(nx + 1)]
    triangles = []
    for j in range(ny):
        for i in range(nx):
            a = j * (nx + 1) + i
            b = a + nx + 1
            triangles += [(a, a + 1, b + 1), (a, b + 1, b)]
    lines = [f"OFF\n{len(vertices)} {len(triangles)} 0"]
    lines += [f"{x} {y} {z}" for x, y, z in vertices]
    lines += ["3 %d %d %d" % t for t in triangles]
    return vertices, "\n".join(lines) + "\n"


class Program(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.vertices, text = grid_off(8, 5, 10)
        self.plane = self.path("plane.off")
        self.write(self.plane, text)

    def path(self, *names):
        return os.path.join(self.folder.name, *names)

    @staticmethod
    def write(path, text):
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    @staticmethod
    def read(path):
        with open(path, "rb") as file:
            return file.read()

    def assert_refused(self, result, status, *parts):
        self.assertEqual(result.returncode, status, result.stderr)
        self.assertIn("isopath: error: ", result.stderr)
        self.assertEqual(result.stdout, "")
        for part in parts:
            self.assertIn(part, result.stderr)


class Usage(Program):
    def test_help_of_every_command_has_examples(self):
        top = run("--help")
        self.assertEqual(top.returncode, OK)
        for command in COMMANDS:
            self.assertIn(command, top.stdout)
            result = run(command, "--help")
            self.assertEqual(result.returncode, OK, command)
            self.assertIn("Examples:", result.stdout, command)

    def test_wrong_usage_is_2(self):
        self.assertEqual(run().returncode, USAGE)
        self.assertEqual(run("fly").returncode, USAGE)
        self.assertEqual(run("field").returncode, USAGE)
        self.assertEqual(run("field", self.plane, "-o", "d.csv", "--wings").returncode, USAGE)
        misspelt = run("plan", self.plane, "--spacng", "0.5", "-o", self.path("out"))
        self.assert_refused(misspelt, USAGE, "no option '--spacng'")
        self.assertEqual(run("field", self.plane, "--threads", "-1", "-o", "d.csv").returncode, USAGE)
        out = self.path("d.csv")
        self.assert_refused(run("field", self.plane, "--source", "border", "-o", out), USAGE, "'border'", "boundary:K")
        self.assert_refused(run("field", self.plane, "--source", "vertex:54", "-o", out), USAGE, "54 of 54")
        self.assert_refused(run("field", self.plane, "--method", "magic", "-o", out), USAGE, "magic", "exact")
        self.assert_refused(run("field", self.plane, "-o", self.path("d.xyz")), USAGE, ".csv, .ply or .vtp")
        self.assert_refused(run("field", self.plane), USAGE, "--path-to")
        self.assertFalse(os.path.exists(out))

    def test_bad_input_is_3_and_says_where(self):
        out = self.path("d.csv")
        self.assert_refused(run("field", self.path("none.stl"), "-o", out), INPUT, "none.stl", "No such file")
        broken = self.path("broken.off")
        self.write(broken, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 oops 0\n3 0 1 2\n")
        self.assert_refused(run("field", broken, "-o", out), INPUT, "broken.off: line 5", "oops")
        line = self.path("line.csv")
        self.write(line, "1,2,3\n4,5\n")
        self.assert_refused(
            run("field", self.plane, "--source", "polyline:" + line, "-o", out), INPUT, "line.csv: line 2", "4,5")
        self.assertFalse(os.path.exists(out))

    def test_an_output_that_cannot_be_written_is_3(self):
        self.assert_refused(run("field", self.plane, "-o", self.path("plane.off", "d.csv")), INPUT, "plane.off")

    def test_what_cannot_be_written_is_refused_before_the_work(self):
        # nobody may make folders in /proc, not even root
        places = [os.path.join("/proc", "no", "such"), self.path("new", "n" * 300), self.path("plane.off", "below")]
        before = os.listdir(self.folder.name)
        for place in places:
            for arguments in (["field", "-o", place + ".csv"], ["field", "--report", place + ".html"],
                              ["contours", "--spacing", 5, "-o", place + ".json"],
                              ["contours", "--spacing", 5, "--report", place + ".html"],
                              ["medial-axis", "-o", place + ".csv"], ["medial-axis", "--report", place + ".html"],
                              ["plan", "--no-report", "-o", place], ["check", "--repair", "-o", place + ".ply"]):
                result = run(arguments[0], self.plane, *arguments[1:])
                self.assert_refused(result, INPUT, place, "cannot ")
                self.assertNotIn("read mesh", result.stderr)
        self.assertEqual(os.listdir(self.folder.name), before)
        self.assert_refused(run("field", self.plane, "--source", "vertex:99", "-o", self.path("a", "b", "d.csv")), USAGE)
        self.assert_refused(run("plan", self.plane, "--spacing", 95, "-o", self.path("a", "b")), NO_PLAN)
        self.assertEqual(os.listdir(self.folder.name), before)


class Field(Program):
    def distances(self, *arguments):
        out = self.path("out", "d.csv")
        result = run("field", self.plane, *arguments, "-o", out)
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertIn(f"written to {out}", result.stdout)
        return [float(line) for line in self.read(out).decode().splitlines()]

    def test_csv_of_a_plane_holds_the_distances_of_the_plane(self):
        corner = self.distances("--source", "vertex:0")
        self.assertEqual(len(corner), len(self.vertices))
        for (x, y, _), d in zip(self.vertices, corner):
            self.assertAlmostEqual(d, math.hypot(x, y), delta=1e-10)
        for (x, y, _), d in zip(self.vertices, self.distances("--source", "boundary")):
            self.assertAlmostEqual(d, min(x, 80 - x, y, 50 - y), delta=1e-10)
        for (x, y, _), d in zip(self.vertices, self.distances("--source", "plane:1,0,0,33", "--source", "point:80,50,7")):
            self.assertAlmostEqual(d, min(abs(x - 33), math.hypot(x - 80, y - 50)), delta=1e-10)

    def test_the_fast_methods_come_close_to_the_exact_distance(self):
        straight = self.distances("--source", "plane:1,0,0,0", "--method", "fast-marching")
        for (x, _, _), d in zip(self.vertices, straight):
            self.assertAlmostEqual(d, x, delta=1e-10)
        exact, marched, graph = (
            self.distances("--source", "vertex:0", "--method", method) for method in ("exact", "fast-marching", "graph"))
        virtual = self.distances("--source", "vertex:0", "--method", "virtual-source")
        checked = self.distances("--source", "vertex:0", "--method", "virtual-source", "--max-error", "1e-9")
        longest = 10 * math.sqrt(2)
        for true, v, c in zip(exact, virtual, checked):
            self.assertAlmostEqual(v, true, delta=1e-3 * true)
            self.assertAlmostEqual(c, true, delta=2e-9 * true)
        for true, m, g in zip(exact, marched, graph):
            self.assertGreaterEqual(g, true - 1e-9)
            self.assertLessEqual(abs(m - true), longest)
            self.assertLessEqual(g, 1.1 * true)

    def test_a_broken_part_is_repaired_and_the_changes_are_said(self):
        broken, out = self.path("broken.off"), self.path("d.csv")
        # The second triangle is the wrong way round, the last is there twice.
        self.write(broken, "OFF\n5 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0\n3 0 1 2\n3 0 3 2\n3 1 4 2\n3 1 4 2\n")
        result = run("field", broken, "--source", "vertex:0", "-o", out, "--json")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertIn("isopath: warning: repaired: ", result.stderr)
        self.assertEqual(len([w for w in json.loads(result.stdout)["warnings"] if w.startswith("repaired: ")]), 2)
        distances = [float(line) for line in self.read(out).decode().splitlines()]
        for d, expected in zip(distances, [0, 1, math.sqrt(2), 1, 2]):
            self.assertAlmostEqual(d, expected)

    def test_units_are_converted(self):
        self.assertAlmostEqual(max(self.distances("--source", "vertex:0", "--unit", "cm")), 10 * math.hypot(80, 50))

    def test_threads_do_not_change_a_bit(self):
        one, two = self.path("1.csv"), self.path("2.csv")
        self.assertEqual(run("field", self.plane, "--threads", 1, "-o", one).returncode, OK)
        self.assertEqual(run("field", self.plane, "--threads", 2, "-o", two).returncode, OK)
        self.assertEqual(self.read(one), self.read(two))

    def test_path_leads_straight_back(self):
        result = run("field", self.plane, "--source", "vertex:0", "--path-to", "vertex:53", "--json", "--quiet")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertEqual(result.stderr, "")
        path = json.loads(result.stdout)["path"]
        self.assertAlmostEqual(path["length"], math.hypot(80, 50))
        self.assertEqual(path["points"][0], [80, 50, 0])
        self.assertEqual(path["points"][-1], [0, 0, 0])
        for x, y, _ in path["points"]:
            self.assertAlmostEqual(x * 50, y * 80, delta=1e-8)

    def test_every_format_is_written(self):
        for name in ["d.csv", "d.ply", "d.vtp"]:
            result = run("field", self.plane, "-o", self.path(name), "--json")
            self.assertEqual(result.returncode, OK, result.stderr)
            self.assertEqual(json.loads(result.stdout)["vertices"], 54)
            self.assertGreater(len(self.read(self.path(name))), 54)


class Contours(Program):
    def test_lines_of_a_plane_lie_at_their_level(self):
        out, edge = self.path("lines.json"), self.path("edge.csv")
        self.write(edge, "x,y,z\n0,0,0\n0,50,0\n")
        result = run("contours", self.plane, "--source", "polyline:" + edge, "--spacing", 15, "-o", out, "--json")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertEqual(json.loads(result.stdout)["contours"], 5)
        content = json.loads(self.read(out))
        self.assertEqual([c["level"] for c in content["contours"]], [15, 30, 45, 60, 75])
        for contour in content["contours"]:
            self.assertFalse(contour["closed"])
            self.assertAlmostEqual(contour["length"], 50)
            for x, _, _ in contour["points"]:
                self.assertAlmostEqual(x, contour["level"], delta=1e-8)
        self.assertEqual(content["graph"]["children"], [[1], [2], [3], [4], []])

    def test_spacing_is_checked(self):
        out = self.path("lines.vtp")
        self.assert_refused(run("contours", self.plane, "--spacing", 0, "-o", out), USAGE, "--spacing", "above 0")
        self.assert_refused(run("contours", self.plane, "--spacing", 1e-9, "-o", out), USAGE, "--spacing", "or more")


class Pictures(Program):
    """--report of the commands that compute something to look at."""

    def report_of(self, *arguments):
        out = self.path("picture.html")
        result = run(*arguments, "--source", "boundary", "--report", out, "--json")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertEqual(json.loads(result.stdout)["report"], str(out))
        page = self.read(out).decode()
        return json.loads(re.search(r'<script[^>]*id="meta"[^>]*>(.*?)</script>', page, re.S).group(1))

    def test_of_contours(self):
        meta = self.report_of("contours", self.plane, "--spacing", 8)
        self.assertEqual(meta["isolines_name"], "Contours")
        self.assertEqual([(line["level"], line["closed"]) for line in meta["isolines"]], [(8, True), (16, True)])

    def test_of_a_medial_axis(self):
        meta = self.report_of("medial-axis", self.plane)
        self.assertEqual((meta["isolines_name"], len(meta["isolines"])), ("Medial axis", 5))

    def test_of_a_field(self):
        meta = self.report_of("field", self.plane)
        self.assertEqual((meta["isolines_name"], len({line["level"] for line in meta["isolines"]})), ("Isolines", 19))
        meta = self.report_of("field", self.plane, "--path-to", "point:40,25,0")
        self.assertEqual((meta["isolines_name"], len(meta["isolines"])), ("Shortest path", 1))

    def test_data_and_picture_come_together(self):
        out = self.path("axis.csv")
        result = run("medial-axis", self.plane, "-o", out, "--report", self.path("axis.html"))
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertIn("axis.csv", result.stdout)
        self.assertIn("axis.html", result.stdout)
        self.assertTrue(self.read(out))

    def test_a_picture_is_a_page_and_something_is_asked_for(self):
        for command in (["field"], ["medial-axis"], ["contours", "--spacing", 5]):
            arguments = [command[0], self.plane, *command[1:]]
            self.assert_refused(run(*arguments, "--report", "axis.png"), USAGE, "--report", ".html")
            self.assert_refused(run(*arguments), USAGE, "nothing to do", "--report")


class MedialAxis(Program):
    def test_of_a_rectangle_is_its_roof(self):
        out = self.path("axis.csv")
        result = run("medial-axis", self.plane, "--source", "boundary", "-o", out, "--json")
        self.assertEqual(result.returncode, OK, result.stderr)
        report = json.loads(result.stdout)
        self.assertEqual((report["arcs"], report["nodes"], report["leaves"]), (5, 6, 4))
        self.assertAlmostEqual(report["length"], 30 + 4 * 25 * math.sqrt(2))
        self.assertAlmostEqual(report["max_clearance"], 25)
        header, *lines = self.read(out).decode().split()
        columns = header.split(",")
        self.assertGreater(len(lines), 10)
        for line in lines:
            point = dict(zip(columns, map(float, line.split(","))))
            x, y = point["x"], point["y"]
            self.assertAlmostEqual(point["clearance"], min(x, y, 80 - x, 50 - y))
            self.assertAlmostEqual(sorted([x, y, 80 - x, 50 - y])[0], sorted([x, y, 80 - x, 50 - y])[1])

    def test_branches_are_pruned(self):
        out = self.path("axis.vtp")
        result = run("medial-axis", self.plane, "--source", "boundary", "--prune", 1.5, "-o", out, "--json")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertEqual(json.loads(result.stdout)["leaves"], 2)
        self.assertIn(b"clearance", self.read(out))

    def test_voronoi_diagram_lies_half_way(self):
        out = self.path("cells.csv")
        result = run("medial-axis", self.plane, "--source", "vertex:0,8", "--voronoi", "-o", out, "--json")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertEqual(json.loads(result.stdout)["arcs"], 1)
        for line in self.read(out).decode().split()[1:]:
            self.assertAlmostEqual(float(line.split(",")[3]), 40)

    def test_options_are_checked(self):
        out = self.path("axis.vtp")
        self.assert_refused(run("medial-axis", self.plane, "--min-angle", 181, "-o", out), USAGE, "--min-angle", "180")
        self.assert_refused(run("medial-axis", self.plane, "--prune", -1, "-o", out), USAGE, "--prune")
        self.assert_refused(run("medial-axis", self.plane, "-o", "axis.txt"), USAGE, ".csv")


class Check(Program):
    def test_describes_a_plane(self):
        result = run("check", self.plane, "--json")
        self.assertEqual(result.returncode, OK, result.stderr)
        report = json.loads(result.stdout)
        self.assertEqual((report["triangles"], report["vertices"], report["components"]), (80, 54, 1))
        self.assertAlmostEqual(report["area"], 4000)
        self.assertEqual(len(report["boundary_loops"]), 1)
        self.assertAlmostEqual(report["boundary_loops"][0]["length"], 260)
        self.assertTrue(report["sound"])
        self.assertIn("ready to plan on", run("check", self.plane).stdout)

    def test_says_that_a_mesh_is_in_pieces(self):
        self.assertNotIn("pieces", run("check", self.plane).stdout)
        two = self.path("two.off")
        self.write(two, "OFF\n6 2 0\n0 0 0\n3 0 0\n0 3 0\n9 0 0\n10 0 0\n9 1 0\n3 0 1 2\n3 3 4 5\n")
        self.assertIn("2 separate pieces, the largest with 90 % of the area", run("check", two).stdout)
        report = json.loads(run("check", two, "--json").stdout)
        self.assertEqual((report["components"], report["largest_component_area"]), (2, 4.5))

    def test_repairs_on_request(self):
        broken, mended = self.path("broken.off"), self.path("mended.off")
        # The second triangle is the wrong way round, the third is there twice.
        self.write(broken, "OFF\n5 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0\n3 0 1 2\n3 0 3 2\n3 1 4 2\n3 1 4 2\n")
        before = run("check", broken, "--repair", "-o", mended, "--json")
        self.assertEqual(before.returncode, OK, before.stderr)
        report = json.loads(before.stdout)
        self.assertFalse(report["sound"])
        self.assertIn("duplicate_triangle", [defect["kind"] for defect in report["defects"]])
        self.assertTrue(report["changes"])
        self.assertTrue(json.loads(run("check", mended, "--json").stdout)["sound"])
        self.assertEqual(run("check", broken, "--repair").returncode, USAGE)


    def test_a_mesh_that_planning_repairs_is_usable_but_not_strictly(self):
        broken = self.path("broken.off")
        self.write(broken, "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 3 2\n")
        result = run("check", broken, "--json")
        self.assertEqual(result.returncode, OK, result.stderr)
        report = json.loads(result.stdout)
        self.assertFalse(report["sound"])
        self.assertTrue(report["usable"])
        self.assertTrue(report["repaired"]["sound"])
        strict = run("check", broken, "--strict", "--json")
        self.assertEqual(strict.returncode, INPUT)
        self.assertEqual(json.loads(strict.stdout), report)
        self.assertIn("needs repair", strict.stderr)
        self.assertEqual(run("check", self.plane, "--strict").returncode, OK)

    def test_a_mesh_without_surface_is_not_usable(self):
        flat = self.path("flat.off")
        self.write(flat, "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n")
        result = run("check", flat, "--json")
        self.assertEqual(result.returncode, INPUT)
        self.assertFalse(json.loads(result.stdout)["usable"])
        self.assertIn("flat.off", result.stderr)
        mended = self.path("mended.off")
        self.assertEqual(run("check", flat, "--repair", "-o", mended).returncode, INPUT)
        self.assertFalse(os.path.exists(mended))
        self.assert_refused(run("check", flat, "--repair", "-o", self.path("m.xyz")), USAGE, ".ply")


class Plan(Program):
    PARTS = ["summary.json", "impact.csv", "tool.csv", "path.vtp", "job.yaml", "report.html"]

    def plan(self, *arguments):
        result = run("plan", *arguments)
        self.assertEqual(result.returncode, OK, result.stderr)
        return result

    def test_writes_everything_and_reports_it(self):
        out = self.path("out")
        result = self.plan(self.plane, "--source", "plane:1,0,0,0", "--spacing", 4, "-o", out, "--json")
        for name in self.PARTS:
            self.assertIn(name, os.listdir(out))
        self.assertTrue(any(name.startswith("program_") for name in os.listdir(out)))
        summary = json.loads(result.stdout)
        self.assertEqual(summary, json.loads(self.read(os.path.join(out, "summary.json"))))
        self.assertAlmostEqual(summary["area"], 80 * 50)
        self.assertEqual(summary["spacing"], 4)
        self.assertAlmostEqual(summary["length_ratio"], summary["cover_length"] * 4 / (80 * 50))
        self.assertGreater(summary["covered_fraction"], 0.99)
        for key in ["pieces", "lifts", "links_length", "min_radius", "sharp_corners", "tight_turns", "peak_memory_mb", "warnings"]:
            self.assertIn(key, summary)
        self.assertEqual(set(summary["gap"]), {"max", "p99", "mean", "cv"})
        header = self.read(os.path.join(out, "impact.csv")).decode().splitlines()[0]
        self.assertEqual(header, "index,piece,kind,x,y,z,nx,ny,nz,s")

    def test_the_job_runs_again_to_the_same_bytes(self):
        strip, one, two = self.path("strip.off"), self.path("one"), self.path("two")
        self.write(strip, grid_off(8, 1, 10)[1])
        self.plan(strip, "--source", "vertex:3", "--tool", "ball:6", "--feed", "700", "-o", one)
        self.plan(os.path.join(one, "job.yaml"), "--threads", 1, "-o", two)
        self.assertEqual(sorted(os.listdir(one)), sorted(os.listdir(two)))
        for name in os.listdir(one):
            first, second = (self.read(os.path.join(folder, name)) for folder in (one, two))
            if name == "summary.json":
                first, second = json.loads(first), json.loads(second)
                for summary in (first, second):
                    del summary["time_s"], summary["peak_memory_mb"]
            self.assertEqual(first, second, name)

    def test_export_gives_the_same_path(self):
        out = self.path("out")
        self.plan(self.plane, "--spacing", 9, "--no-report", "-o", out)
        again = self.path("again.csv")
        self.assertEqual(run("export", out, "--to", "csv", "-o", again).returncode, OK)
        self.assertEqual(self.read(again), self.read(os.path.join(out, "tool.csv")))
        self.assert_refused(run("export", out, "--to", "fax", "-o", again), USAGE, "'fax'", "gcode5")

    def test_what_cannot_be_written_is_said(self):
        self.assert_refused(run("plan", self.plane, "-o", self.plane), INPUT, "plane.off", "is a file")
        job = self.path("job.yaml")
        self.write(job, "mesh: plane.off\nspacings: 3\n")
        self.assert_refused(run("plan", job, "-o", self.path("out")), INPUT, "job.yaml: line 2: spacings", "spacing,")
        self.assert_refused(run("plan", self.plane, "--spacing", -1, "-o", self.path("out")), USAGE, "spacing", "-1")
        self.assertFalse(os.path.exists(self.path("out")))


    def test_lengths_that_cannot_be_meant_are_refused(self):
        out = self.path("out")
        for option in ["--spacing", "--clearance", "--stand-off", "--feed", "--link-feed", "--rapid"]:
            for value in ["nan", "inf", "-1", "0", "", "x", "1e999", "3mm"]:
                self.assert_refused(run("plan", self.plane, option, value, "-o", out), USAGE, option, f"'{value}'")
        self.assert_refused(run("plan", self.plane, "--tool", "ball:-3", "-o", out), USAGE, "ball:-3")
        # 25 mm from the rim to the middle.
        self.assert_refused(run("plan", self.plane, "--spacing", 1e-9, "-o", out), USAGE, "1e-09 mm", "limit 20000")
        self.assert_refused(run("plan", self.plane, "--spacing", 95, "-o", out), NO_PLAN, "95 mm", "94.3398 mm")
        self.assert_refused(run("plan", self.plane, "--clearance", 1e6, "-o", out), USAGE, "clearance", "limit 94339.8")
        self.assert_refused(run("plan", self.plane, "-o", ""), USAGE, "--output")
        self.assertFalse(os.path.exists(out))

    def test_a_length_with_a_unit_is_told_how_to_write_it(self):
        for text, number in [("30mm", "30"), ("3 cm", "30"), ("0.03m", "30"), ("2in", "50.8")]:
            self.assert_refused(run("plan", self.plane, "--spacing", text, "-o", self.path("out")), USAGE,
                                "--spacing", f"'{text}'", "in mm", f"here {number}\n")
        self.assert_refused(run("plan", self.plane, "--feed", "3m/min", "-o", self.path("out")), USAGE, "only the number")

    def test_a_part_in_another_unit_is_pointed_out(self):
        result = self.plan(self.plane, "--unit", "m", "--spacing", 9000, "--no-report", "-o", self.path("out"))
        self.assertIn("--unit", result.stderr)
        self.assertIn("9.434e+04 mm", result.stderr)
        self.assertNotIn("--unit", self.plan(self.plane, "--spacing", 9, "--no-report", "-o", self.path("out")).stderr)

    def test_a_part_that_faces_away_from_a_fixed_axis_is_refused_before_planning(self):
        result = run("plan", self.plane, "--axis", "0,0,-1", "-o", self.path("out"))
        self.assert_refused(result, NO_PLAN, "faces away", "100 % of the area")
        self.assertNotIn("isolines", result.stderr)

    def test_a_program_that_cannot_hold_the_axes_is_refused_before_planning(self):
        slope, out = self.path("slope.off"), self.path("out")
        self.write(slope, "OFF\n4 2 0\n0 0 0\n20 0 0\n20 20 20\n0 20 20\n3 0 1 2\n3 0 2 3\n")
        result = run("plan", slope, "--post", "gcode3", "-o", out)
        self.assert_refused(result, NO_PLAN, "gcode3", "45.0 degrees off +Z", "100 % of the area", "--axis 0,0,1")
        self.assertNotIn("distance field", result.stderr)
        self.assert_refused(run("plan", slope, "--post", "gcode3", "--axis", "0,1,1", "-o", out), USAGE, "gcode3", "0, 0, 1")
        self.plan(slope, "--post", "gcode3", "--axis", "0,0,1", "--spacing", 5, "--no-report", "-o", out)

    def test_options_without_effect_are_pointed_out(self):
        job = self.path("job.yaml")
        self.write(job, "mesh: plane.off\nspacing: 20\nreport: false\ntool:\n  process: spray\n")
        spiral = ["--pattern", "spiral"]
        for idle, beside in [(["--direction", "1,0,0"], spiral), (["--circle-radius", 5], spiral),
                             (["--circle-step", 5], spiral), (["--crease-angle", 30], ["--partition", "medial"]),
                             (["--unevenness", 2], ["--partition", "creases"]), (["--blend"], ["--blend-form", "none"]),
                             (["--source", "vertex:1"], ["--pattern", "planar"]),
                             (["--tool", "ball:6"], ["--process", "spray"]),
                             (["--stand-off", 100], ["--process", "grind"])]:
            told = f"{idle[0]} has no effect with {' '.join(beside)}"
            result = self.plan(job, *idle, *beside, "--json", "-o", self.path("out"))
            self.assertIn(f"isopath: warning: {told}\n", result.stderr)
            self.assertIn(told, json.loads(result.stdout)["warnings"])
        given = {"planar_direction": "[1, 0, 0]", "circle_radius": 5, "circle_step": 5, "partition": "{crease_angle: 1}",
                 "tool": "{stand_off: 100}"}
        self.write(job, "mesh: plane.off\nspacing: 20\npattern: meander\n" + "".join(f"{k}: {v}\n" for k, v in given.items()))
        result = self.plan(job, "--circle-step", 6, "--json", "-o", self.path("out"))
        self.assertEqual([w for w in json.loads(result.stdout)["warnings"] if "no effect" in w],
                         ["planar_direction in the job file has no effect with pattern meander",
                          "circle_radius in the job file has no effect with pattern meander",
                          "--circle-step has no effect with --pattern meander",
                          "partition.crease_angle in the job file has no effect with partition none",
                          "tool.stand_off in the job file has no effect with process mill"])
        self.write(job, "mesh: plane.off\nspacing: 20\npattern: planar\nsources: ['vertex:3']\npartition: {unevenness: 2}\n"
                   "report: false\ntool: {process: spray, ball_diameter: 6, fixed_axis: [1, 0, 1]}\n")
        for key in ["sources", "partition.unevenness", "tool.ball_diameter", "tool.fixed_axis"]:
            self.assertIn(f"{key} in the job file has no effect", self.plan(job, "-o", self.path("out")).stderr)
        self.plan(self.plane, "--spacing", 20, "--no-report", "-o", self.path("out"))
        whole = self.plan(self.path("out", "job.yaml"), "-o", self.path("again"))  # has all the keys
        self.assertNotIn("no effect", whole.stderr)
        self.write(job, "mesh: plane.off\nspacing: 20\nreport: false\ntool:\n  process: spray\n")
        useful = self.plan(job, "--stand-off", 100, "--pattern", "planar", "--direction", "1,0,0", "-o", self.path("out"))
        self.assertNotIn("no effect", useful.stderr)
        self.assertIn("--stand-off has no effect with --process mill",
                      self.plan(self.plane, "--stand-off", 100, "--spacing", 20, "--no-report", "-o", self.path("out")).stderr)
        told = run("export", self.path("out"), "--to", "csv", "--spindle-rpm", 100, "-o", self.path("x.csv")).stderr
        self.assertIn("--spindle-rpm has no effect with --to csv", told)
        told = run("medial-axis", self.plane, "--source", "vertex:0,8", "--voronoi", "--min-angle", 5, "-o", self.path("x.csv")).stderr
        self.assertIn("--min-angle has no effect with --voronoi", told)

    def test_an_edge_that_the_tool_axis_jumps_at_is_warned_of(self):
        folded = self.path("folded.off")
        self.write(folded, "OFF\n6 4 0\n0 0 0\n20 0 0\n20 20 0\n0 20 0\n20 0 -20\n20 20 -20\n"
                   + "3 0 1 2\n3 0 2 3\n3 1 4 5\n3 1 5 2\n")
        arguments = ["--source", "plane:0,1,0,0", "--spacing", 2, "--process", "spray", "--json"]
        along = self.plan(folded, *arguments, "-o", self.path("out"))
        warnings = [w for w in json.loads(along.stdout)["warnings"] if "tool axis turns" in w]
        self.assertEqual(len(warnings), 1)
        self.assertIn("(20, ", warnings[0])
        fixed = self.plan(folded, *arguments, "--axis", "1,0,1", "-o", self.path("out"))
        self.assertNotIn("tool axis turns", fixed.stdout)

    def test_a_file_whose_name_is_not_utf8_is_planned(self):
        odd = os.path.join(self.folder.name.encode(), b"odd \xff\xfe.off")
        with open(odd, "wb") as file:
            file.write(self.read(self.plane))
        out = os.path.join(self.folder.name.encode(), b"out \xff")
        for command in [["plan", odd, "--source", b"vertex:0", "--spacing", "9", "-o", out, "--json"],
                        ["check", odd, "--json"],
                        ["field", odd, "-o", out + b".csv", "--json"],
                        ["contours", odd, "--spacing", "5", "-o", out + b".json", "--json"]]:
            result = subprocess.run([PROGRAM, *command], capture_output=True, timeout=120 * SLOWNESS)
            self.assertEqual(result.returncode, OK, result.stderr)
            json.loads(result.stdout.decode("utf-8"))
        again = subprocess.run([PROGRAM, "plan", os.path.join(out, b"job.yaml"), "-o", out], capture_output=True)
        self.assertIn(again.returncode, [OK, INPUT], again.stderr)

    def test_an_empty_mesh_is_bad_input_and_every_component_is_covered(self):
        empty, two = self.path("empty.off"), self.path("two.off")
        self.write(empty, "OFF\n0 0 0\n")
        self.assert_refused(run("plan", empty, "-o", self.path("out")), INPUT, "empty.off", "no triangles")
        square = "{0} 0 0\n{1} 0 0\n{1} 20 0\n{0} 20 0\n"
        self.write(two, "OFF\n8 4 0\n" + square.format(0, 20) + square.format(50, 70)
                   + "3 0 1 2\n3 0 2 3\n3 4 5 6\n3 4 6 7\n")
        result = self.plan(two, "--source", "plane:0,1,0,0", "--spacing", 4, "-o", self.path("out"), "--json")
        summary = json.loads(result.stdout)
        self.assertAlmostEqual(summary["area"], 800)
        self.assertGreater(summary["covered_fraction"], 0.99)
        self.assertGreaterEqual(summary["lifts"], 1)
        result = self.plan(two, "--source", "vertex:0", "--spacing", 4, "-o", self.path("out"), "--json")
        self.assertLess(json.loads(result.stdout)["covered_fraction"], 0.51)
        self.assertIn("1 of the part's 2 components", result.stderr)


class Interrupt(Program):
    def test_plan_stops_within_a_second_in_every_stage_and_leaves_nothing(self):
        side = round(60 / SLOWNESS**0.75)
        _, text = grid_off(side, side, 1)
        large = self.path("large.off")
        self.write(large, text)
        arguments = [PROGRAM, "plan", large, "--spacing", "0.8"]
        started = time.monotonic()
        self.assertEqual(subprocess.run([*arguments, "-o", self.path("whole")], capture_output=True).returncode, OK)
        duration = time.monotonic() - started
        trials = 10 if SLOWNESS == 1 else 4
        for k in range(trials):
            parent = self.path(f"run{k}")
            os.makedirs(os.path.join(parent, "old"))
            out = os.path.join(parent, "old" if k % 2 else "new")
            process = subprocess.Popen([*arguments, "-o", out], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                       text=True)
            process.stderr.readline()
            time.sleep(duration * k / trials)
            start = time.monotonic()
            process.send_signal(signal.SIGINT)
            message = process.stderr.read()
            process.stderr.close()
            status = process.wait(60 * SLOWNESS)
            if status == OK:
                continue  # it was faster this time
            self.assertEqual(status, INTERRUPTED, message)
            self.assertLess(time.monotonic() - start, SLOWNESS, message)
            self.assertEqual([os.listdir(parent), os.listdir(os.path.join(parent, "old"))], [["old"], []], message)

    def test_a_file_too_large_for_its_limit_leaves_nothing(self):
        parent = self.path("parent")
        os.mkdir(parent)

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))

        result = subprocess.run([PROGRAM, "plan", self.plane, "--spacing", "9", "-o", os.path.join(parent, "out")],
                                capture_output=True, text=True, preexec_fn=limit)
        self.assert_refused(result, INPUT, "out", "too large")
        self.assertEqual(os.listdir(parent), [])

    def test_ctrl_c_stops_within_a_second_and_leaves_nothing(self):
        side = round(400 / math.sqrt(SLOWNESS))
        _, text = grid_off(side, side, 1)
        large = self.path("large.off")
        self.write(large, text)
        out = self.path("out")
        os.mkdir(out)
        for sent in (signal.SIGINT, signal.SIGTERM):
            # the path takes the whole field, which is not done before the signal is there
            process = subprocess.Popen([PROGRAM, "field", large, "-o", os.path.join(out, "d.csv"), "--path-to", "vertex:9"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            while "distance field" not in process.stderr.readline():
                self.assertIsNone(process.poll(), "ended before it could be interrupted")
            start = time.monotonic()
            process.send_signal(sent)
            if sent == signal.SIGTERM:
                process.send_signal(signal.SIGINT)  # and once more
            message = process.stderr.read()
            process.stderr.close()
            self.assertEqual(process.wait(60 * SLOWNESS), INTERRUPTED, message)
            self.assertLess(time.monotonic() - start, SLOWNESS)
            self.assertIn("interrupted", message)
            self.assertEqual(os.listdir(out), [])


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    COMMANDS = [name for name in sys.argv.pop(1).split(",") if name]
    SLOWNESS = float(sys.argv.pop(1))
    unittest.main(verbosity=1)
