#!/usr/bin/env python3
"""Compares the cost of distance fields between a commit and the checkout, in one sitting.

Usage: bench_guard.py BASE [CASE...]

Builds bench/field_table of both, runs them in turn, and prints the ratio of time and of peak memory for every row that
both have. Exits with 1 when a ratio is above the limit. CASE are beginnings of the cases' names (default: the small
ones). Nothing else should run on the machine meanwhile.
"""

import os
import statistics
import subprocess
import sys

ROUNDS = 3
SLOWER, LARGER = 1.15, 1.10
DEFAULT_CASES = ["ball-point", "wavy-boundary-1e-06"]
ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def build(source, folder):
    subprocess.run(["cmake", "-S", source, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    "-DISOPATH_BENCH=ON", "-DISOPATH_STEP=OFF"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", folder, "--target", "field_table"], check=True, stdout=subprocess.DEVNULL)
    return os.path.join(folder, "bench", "field_table")


def run(program, case):
    """Seconds by row, and the peak memory of the run in megabytes."""
    process = subprocess.Popen([program, case], stdout=subprocess.PIPE, text=True)
    text = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{program} {case} failed")
    rows = {}
    for line in text.splitlines()[2:]:
        name, triangles, threads, seconds = [cell.strip() for cell in line.strip("|").split("|")][:4]
        rows[(name, int(triangles), int(threads))] = float(seconds)
    return rows, usage.ru_maxrss / 1024


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    cases = sys.argv[2:] or DEFAULT_CASES
    base = subprocess.run(["git", "-C", ROOT, "rev-parse", "--verify", sys.argv[1] + "^{commit}"], check=True,
                          capture_output=True, text=True).stdout.strip()
    folder = os.path.join(ROOT, "build", "guard")
    checkout = os.path.join(folder, "base-source")
    subprocess.run(["git", "-C", ROOT, "worktree", "prune"], check=True)
    if not os.path.exists(checkout):
        subprocess.run(["git", "-C", ROOT, "worktree", "add", "--detach", checkout, base], check=True)
    subprocess.run(["git", "-C", checkout, "checkout", "--quiet", "--detach", base], check=True)
    programs = [build(checkout, os.path.join(folder, "base")), build(ROOT, os.path.join(folder, "head"))]

    worst = False
    print("| case | triangles | threads | base s | head s | time ratio |")
    print("|---|---|---|---|---|---|")
    for case in cases:
        seconds, memory = [{}, {}], [[], []]
        for _ in range(ROUNDS):
            for side, program in enumerate(programs):
                rows, peak = run(program, case)
                memory[side].append(peak)
                for row, value in rows.items():
                    seconds[side].setdefault(row, []).append(value)
        for row in [r for r in seconds[0] if r in seconds[1]]:
            before, after = (statistics.median(seconds[side][row]) for side in (0, 1))
            worst |= after > SLOWER * before
            print(f"| {row[0]} | {row[1]} | {row[2]} | {before:.3f} | {after:.3f} | {after / before:.2f} |")
        before, after = (statistics.median(m) for m in memory)
        worst |= after > LARGER * before
        print(f"\n{case}: peak memory {before:.0f} MB, then {after:.0f} MB ({after / before:.2f})\n")
    sys.exit(1 if worst else 0)


if __name__ == "__main__":
    main()
