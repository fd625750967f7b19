#!/usr/bin/env python3
"""Measures the figures that stickslip sets itself, beside the programs it compares itself with, and prints a Markdown table.

    python3 scripts/goals.py [--peers DIR] [--python VENV_PYTHON] [--getfem-python PYTHON] [--quick] [--out FILE.json]

Everything runs on one thread, one process at a time, ours and the other program's in turn; a process measures one thing, so that
its peak memory is its own. DIR holds the two scripts of the same scene, peer_skfem.py (scikit-fem, CHOLMOD through scikit-sparse,
Newton on the contact) and peer_getfem.py (GetFEM with its own friction solver, MUMPS); without them, or without a Python that
has their packages, the rows that need them say so. The times of the others are CPU times of a step, imports and set-up apart,
the least of several runs; ours the mean over the steps of the run of their shortest times. Takes about ten minutes, half of it
GetFEM at h = 1/256, which --quick leaves out. Exit status 0 whether or not the goals are met.
"""
import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
ENVIRONMENT = {**os.environ, **ONE_THREAD, "PYTHONDONTWRITEBYTECODE": "1"}
FIELDS = {"slip_rate": "w_tau", "tangential_stress": "sigma_tau"}
# the smallest residual of the friction law that rounding allows on the finest mesh
ZERO_START = ["time.start=zero", "fidelity.friction_tolerance=1e-12"]


def tell(text):
    print(text, file=sys.stderr, flush=True)


def last_line(command, **more):
    out = subprocess.run([str(c) for c in command], env=ENVIRONMENT, stdout=subprocess.PIPE, text=True, check=True, **more)
    return json.loads(out.stdout.strip().splitlines()[-1])


class Ours:
    """The bench program of this repository."""

    def __init__(self):
        tell("building")
        command = ["cargo", "bench", "--bench", "goals", "--no-run", "--message-format=json", "--quiet"]
        out = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
        messages = [json.loads(line) for line in out.stdout.splitlines() if line.startswith("{")]
        found = [m["executable"] for m in messages if m.get("executable") and m["target"]["name"] == "goals"]
        self.program = found[-1]

    def __call__(self, *arguments):
        tell("stickslip " + " ".join(arguments))
        return last_line([self.program, *arguments])


class Peer:
    """Another program on the same scene; not there without its script or its packages."""

    def __init__(self, directory, script, python, imports, *arguments):
        # runs in its own directory
        self.python = os.path.abspath(shutil.which(python) or python)
        self.directory, self.script, self.arguments = directory, script, arguments
        is_there = directory and (Path(directory) / script).is_file() and self.can_import(imports)
        self.missing = None if is_there else "not installed"

    def can_import(self, modules):
        try:
            command = [self.python, "-c", f"import {modules}"]
            return subprocess.run(command, env=ENVIRONMENT, stderr=subprocess.DEVNULL).returncode == 0
        except OSError:
            return False

    def __call__(self, cells):
        tell(f"{self.script} --m {cells}")
        with tempfile.TemporaryDirectory() as scratch:
            dump = Path(scratch) / "dump.json"
            command = [self.python, self.script, "--m", cells, "--method", "newton", *self.arguments, "--dump", dump]
            last_line(command, cwd=self.directory)
            return json.loads(dump.read_text())


def mesh(cells, height=None):
    return f"mesh.cells=[{cells},{height or cells // 2}]"


def difference(ours, theirs):
    """Largest difference at a contact node at t = 1 s, relative to the largest there, of slip rate and stress; and of the tip."""
    found = {}
    for name, other in FIELDS.items():
        pairs = list(zip(ours[name], theirs[other], strict=True))
        found[name] = max(abs(a - b) for a, b in pairs) / max(abs(b) for _, b in pairs)
    found["displacement of (1, 0)"] = abs(ours["tip"][0] / theirs["u_x10"] - 1)
    return found


def best(runs, key):
    return min(run[key] for run in runs)


def number(value, unit=""):
    return f"{value:.3g}{unit}" if value is not None else "-"


def shorten(measurement):
    """Leaves out the fields of the contact."""
    for value in list(measurement.values() if isinstance(measurement, dict) else measurement):
        if isinstance(value, (dict, list)):
            shorten(value)
    if isinstance(measurement, dict):
        for key in [*FIELDS, *FIELDS.values(), "slip", "x", "its"]:
            measurement.pop(key, None)


class Table:
    def __init__(self):
        self.rows, self.data = [], {}

    def add(self, figure, goal, ours, theirs, is_met):
        met = {True: "yes", False: "**no**", None: "-"}[is_met]
        self.rows.append((figure, goal, ours, theirs, met))
        tell(" | ".join(self.rows[-1]))

    def markdown(self):
        head = [("figure", "goal", "measured: ours", "theirs", "met"), ("---",) * 5]
        return "\n".join("| " + " | ".join(row) + " |" for row in head + self.rows)


def step_against_scikit_fem(table, ours, peer, cells, times_goal, equal_goal, repetitions):
    figure, goal = f"step, h = 1/{cells}, against scikit-fem + CHOLMOD + Newton", f">= {times_goal} times, outputs equal to {equal_goal:g}"
    theirs, gap, tried = [], None, []
    if not peer.missing:
        theirs.append(peer(cells))
    # the loosest reduction that agrees; the first is the one set-up is measured with
    for tolerance in (1e-9, 1e-10, 1e-11):
        try:
            run = ours("steps", mesh(cells), *ZERO_START, f"fidelity.tolerance={tolerance}")
        except subprocess.CalledProcessError:
            break
        tried.append((tolerance, run, difference(run, theirs[0]) if theirs else None))
        if not theirs or max(tried[-1][2].values()) <= equal_goal:
            break
    tolerance, run, gap = min(tried, key=lambda t: max(t[2].values()) if t[2] else 0)
    runs = [run]
    for _ in range(repetitions - 1):
        if theirs:
            theirs.append(peer(cells))
        runs.append(ours("steps", mesh(cells), *ZERO_START, f"fidelity.tolerance={tolerance}"))
    time = best(runs, "mean_us")
    told = f"{number(time, ' us')} (first run {number(best(runs, 'first_us'), ' us')}), {run['states']} states, reduced to {tolerance:g}"
    table.data[figure] = {"ours": runs, "theirs": theirs, "differences": [(t, d) for t, _, d in tried]}
    if not theirs:
        return table.add(figure, goal, told, peer.missing, None)
    other = 1e6 * best(theirs, "cpu_per_step")
    worst = max(gap.values())
    told += f": **{other / time:.0f} times**; differences: " + ", ".join(f"{k} {v:.2e}" for k, v in gap.items())
    decay = max(map(abs, theirs[0]["w_tau"])) / run["largest_slip_rate"]
    told += f" (slip rate, relative to the largest of the run: {decay * gap['slip_rate']:.1e})"
    table.add(figure, goal, told, number(other / 1e3, " ms"), other >= times_goal * time and worst <= equal_goal)


def step_against_getfem(table, ours, peer, cells, times_goal, repetitions, is_left_out):
    figure, goal = f"step, h = 1/{cells}, against GetFEM", f">= {times_goal:,} times"
    runs, theirs = [], []
    for _ in range(repetitions):
        runs.append(ours("steps", mesh(cells), *ZERO_START))
        if not peer.missing and not is_left_out:
            theirs.append(peer(cells))
    time = best(runs, "mean_us")
    table.data[figure] = {"ours": runs, "theirs": theirs}
    if not theirs:
        return table.add(figure, goal, number(time, " us"), peer.missing or "left out", None)
    other = 1e6 * best(theirs, "cpu_per_step")
    gap = max(difference(runs[0], theirs[0]).values())
    told = f"{number(time, ' us')}: **{other / time:,.0f} times**; largest difference {gap:.1e}"
    table.add(figure, goal, told, number(other / 1e3, " ms"), other >= times_goal * time)


def users_scenes(table, ours, peers, repetitions):
    """Scenes of benches/peers, which the scripts beside them write for another program; the answers are compared over the whole run."""
    folder = ROOT / "benches" / "peers"
    command = ["cargo", "run", "--release", "--quiet", "--", "run"]
    for scene, script, program, python, imports, goal in (
        ("shoe", "shoe_scikit_fem.py", "scikit-fem + SuperLU + Newton", peers["scikit-fem"], "skfem, meshio", 20),
        ("pad", "pad_scikit_fem.py", "scikit-fem + SuperLU + Newton", peers["scikit-fem"], "skfem", 5),
        ("pad", "pad_getfem.py", "GetFEM", peers["getfem"], "getfem", 100),
    ):
        file = folder / f"{scene}.json"
        figure, wanted = f"step of benches/peers/{scene}.json against {program}", f">= {goal} times, outputs equal to 1e-6"
        runs = [ours("course", str(file)) for _ in range(repetitions)]
        time = best(runs, "mean_us")
        told = f"{number(time, ' us')}, {runs[0]['iterations']:.2g} iterations a step"
        peer = Peer(folder, script, python, imports)
        theirs = []
        with tempfile.TemporaryDirectory() as scratch:
            table_file = Path(scratch) / "ours.csv"
            subprocess.run([*command, file, "--csv", table_file], cwd=ROOT, stdout=subprocess.DEVNULL, check=True)
            for _ in range(0 if peer.missing else repetitions):
                tell(script)
                theirs.append(last_line([peer.python, folder / script, table_file]))
        table.data[figure] = {"ours": runs, "theirs": theirs}
        if not theirs:
            table.add(figure, wanted, told, peer.missing, None)
            continue
        other = 1e6 * best(theirs, "step_s")
        worst = max(theirs[0]["differences"].values())
        told += f": **{other / time:.0f} times**; largest difference {worst:.1e}"
        table.add(figure, wanted, told, number(other / 1e3, " ms"), other >= goal * time and worst <= 1e-6)


def step_against_floor(table, ours):
    runs = {}
    for start in ("consistent", "zero"):
        for cells in (32, 64, 128, 256):
            runs[start, cells] = ours("steps", mesh(cells), f"time.start={start}")
    table.data["step against the floor"] = [{"start": s, "cells": c, **run} for (s, c), run in runs.items()]

    def ratios(start, key, floor="floor_us"):
        rows = [run for (s, _), run in runs.items() if s == start]
        return [run[key] / run[floor] for run in rows if run[key] is not None]

    def told(values):
        return " / ".join(f"{v:.2g}" for v in values)

    def of_consistent(key):
        return told(run[key] for (s, _), run in runs.items() if s == "consistent")

    sizes = "h = 1/32 / 1/64 / 1/128 / 1/256"
    floors = f"floor {of_consistent('floor_us')} us with faer's product, {of_consistent('own_floor_us')} us with ours"
    figure = "step against its floor (two passes over its port matrix)"
    for label, key, goal in (
        ("all nodes stick", "stick_us", 3),
        ("all nodes slip", "slip_us", 3),
        ("steps of the run without a change", "steady_us", 3),
        ("mean over the run", "mean_us", 8),
    ):
        values = {start: ratios(start, key) for start in ("consistent", "zero")}
        ours_told = "; ".join(f"{start} start {told(v)}" for start, v in values.items())
        ours_told += f"; consistent start over the floor with our product {told(ratios('consistent', key, 'own_floor_us'))}"
        worst = max(v for start in values.values() for v in start)
        table.add(f"{figure}: {label}, {sizes}", f"<= {goal}", ours_told, floors, worst <= goal)

    pad = ours("steps", "brake_pad_3d")
    table.data["step in space"] = pad
    kinds = {"all stick": "stick_us", "all slip": "slip_us", "mean": "mean_us"}
    ours_told = ", ".join(f"{label} {pad[key] / pad['floor_us']:.2g}" for label, key in kinds.items() if pad[key])
    ours_told += f"; mean {number(pad['mean_us'], ' us')}, {pad['contact']} x {pad['states']}, {pad['iterations']:.2g} iterations"
    floors = f"floor {number(pad['floor_us'], ' us')} with faer's product, {number(pad['own_floor_us'], ' us')} with ours"
    table.add(f"{figure}: brake_pad_3d on its signals", "-", ours_told, floors, None)


def setup(table, ours, peer, repetitions):
    figure, goal = "set-up reduced to 1e-9, h = 1/256, against the best peer's", "<= 0.3, peak memory <= 1 GB"
    runs, theirs = [], []
    for _ in range(repetitions):
        runs.append(ours("compile", mesh(256), "fidelity.tolerance=1e-9"))
        if not peer.missing:
            theirs.append(peer(256))
    table.data[figure] = {"ours": runs, "theirs": theirs}
    time, peak = best(runs, "cpu_s"), max(run["peak_mb"] for run in runs)
    told = f"{number(time, ' s')} CPU, {peak:.0f} MB, {runs[0]['states']} states, {runs[0]['bytes'] / 1e6:.1f} MB"
    if not theirs:
        return table.add(figure, goal, told, peer.missing, None)
    other = best(theirs, "cpu_setup")
    their_peak = best(theirs, "rss_mb")
    told += f": **{time / other:.2f}**"
    table.add(figure, goal, told, f"{number(other, ' s')} CPU, {their_peak:.0f} MB", time <= 0.3 * other and peak <= 1000)
    return theirs


def growth(table, ours):
    # at h = 1/512 the rounding of the samples allows no smaller tolerance
    runs = {cells: ours("steps", mesh(cells), "fidelity.tolerance=1e-7") for cells in (64, 128, 256, 512)}
    table.data["growth"] = [{"cells": c, **run} for c, run in runs.items()]

    def exponent(low, high):
        return math.log(high["mean_us"] / low["mean_us"]) / math.log(high["contact"] / low["contact"])

    pairs = list(runs.values())
    whole = exponent(pairs[0], pairs[-1])
    parts = ", ".join(f"{exponent(a, b):.2f}" for a, b in zip(pairs, pairs[1:]))
    times = " / ".join(number(run["mean_us"]) for run in pairs)
    told = f"**{whole:.2f}** ({parts}); {times} us, {pairs[-1]['states']} states at h = 1/512, reduced to 1e-7"
    table.add("growth of a step, h = 1/64 to 1/512, exponent of the contact nodes", "<= 2", told, "", whole <= 2)

    heights = {height: ours("steps", mesh(128, height)) for height in (32, 64, 128)}
    table.data["interior"] = [{"height": h, **run} for h, run in heights.items()]
    low, high = min(r["mean_us"] for r in heights.values()), max(r["mean_us"] for r in heights.values())
    dofs = " / ".join(str(run["free_dofs"]) for run in heights.values())
    times = " / ".join(number(run["mean_us"]) for run in heights.values())
    told = f"{times} us with {dofs} dofs and {' / '.join(str(run['states']) for run in heights.values())} states: within {high / low:.2f}"
    table.add("step of 128 contact nodes whatever the interior", "alike (within 1.25)", told, "", high <= 1.25 * low)


def loading(table, ours):
    figure = "loading a compiled model, h = 1/256"
    with tempfile.TemporaryDirectory() as scratch:
        file = str(Path(scratch) / "model")
        ours("compile", mesh(256), f"save={file}")
        runs = [ours("load", file) for _ in range(3)]
    table.data[figure] = runs
    first, shortest = best(runs, "first_ms"), best(runs, "shortest_ms")
    told = f"{number(first, ' ms')} the first time, {number(shortest, ' ms')} again, {runs[0]['bytes'] / 1e6:.1f} MB"
    table.add(figure, "<= 10 ms", told, "", first <= 10)


def finest(table, ours):
    run = ours("finest")
    table.data["finest"] = run
    errors = ("tip", "slip_rate", "stress", "strain")

    def told(r):
        return f"{number(r['cpu_s'] * 1e3, ' ms')}, {r['dofs']} dofs, " + ", ".join(f"{e} {r[e]:.1e}" for e in errors)

    for start in ("consistent", "zero"):
        full = run[f"full, {start} start"]
        good = {k: r for k, r in run.items() if not k.startswith("full") and all(r[e] <= full[e] for e in errors)}
        figure = f"accuracy of the paper's finest run (p1, h = k = 1/256), {start} start: time for 1 s, errors at t = 1 s"
        goal = "<= 1/1000 of the time, <= 1/50 of the dofs"
        if not good:
            table.add(figure, goal, "not reached", told(full), False)
            continue
        way = min(good, key=lambda k: good[k]["cpu_s"])
        time, dofs = full["cpu_s"] / good[way]["cpu_s"], full["dofs"] / good[way]["dofs"]
        ours_told = f"p2 refined, {way}: {told(good[way])}: **1/{time:.0f}**, 1/{dofs:.0f}"
        table.add(figure, goal, ours_told, f"full model: {told(full)}", time >= 1000 and dofs >= 50)


def estimate(table, ours):
    ranges = {}
    for course in ("paper", "pad", "seal", "swinging"):
        run = ours("estimate", course)
        table.data[f"estimate, {course}"] = run
        ranges[course] = (min(r["lowest"] for r in run.values()), max(r["highest"] for r in run.values()))
    told = ", ".join(f"{course} {low:.2f}..{high:.2f}" for course, (low, high) in ranges.items())
    is_met = all(low >= 0.3 and high <= 3 for low, high in ranges.values())
    table.add("error estimate over true error, 4 to 32 steps per communication step", "0.3 to 3", told, "", is_met)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peers", help="directory of peer_skfem.py and peer_getfem.py")
    parser.add_argument("--python", default=sys.executable, help="Python with scikit-fem and scikit-sparse")
    parser.add_argument("--getfem-python", default="/usr/bin/python3", help="Python with GetFEM")
    parser.add_argument("--quick", action="store_true", help="without GetFEM at h = 1/256")
    parser.add_argument("--out", help="file for all measurements, JSON")
    options = parser.parse_args()

    ours, table = Ours(), Table()
    skfem = Peer(options.peers, "peer_skfem.py", options.python, "skfem, sksparse.cholmod", "--solver", "cholmod")
    getfem = Peer(options.peers, "peer_getfem.py", options.getfem_python, "getfem")
    step_against_scikit_fem(table, ours, skfem, 32, 50, 1e-9, 5)
    step_against_scikit_fem(table, ours, skfem, 256, 100, 1e-8, 2)
    step_against_getfem(table, ours, getfem, 32, 1000, 3, False)
    step_against_getfem(table, ours, getfem, 256, 10_000, 1, options.quick)
    users_scenes(table, ours, {"scikit-fem": options.python, "getfem": options.getfem_python}, 3)
    step_against_floor(table, ours)
    setup(table, ours, skfem, 3)
    growth(table, ours)
    loading(table, ours)
    finest(table, ours)
    estimate(table, ours)
    print(table.markdown())
    if options.out:
        for measurement in table.data.values():
            shorten(measurement)
        rows = [dict(zip(("figure", "goal", "ours", "theirs", "met"), row)) for row in table.rows]
        Path(options.out).write_text(json.dumps({"rows": rows, "measurements": table.data}, indent=1) + "\n")


if __name__ == "__main__":
    main()
