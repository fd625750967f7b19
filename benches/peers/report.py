"""What the scripts of this folder print: differences to the CSV of `stickslip run`, the time of a step, lines; at last all of it as JSON."""
import csv
import json
from pathlib import Path

import numpy as np


def read(path, fields):
    """Rows of the CSV by communication point and node: places, and one array (points x nodes) per field."""
    with open(path) as table:
        rows = list(csv.DictReader(table))
    nodes = 1 + max(int(row["node"]) for row in rows)
    places = np.array([[float(row["x"]), float(row["y"])] for row in rows[:nodes]])
    return places, {field: np.array([float(row[field]) for row in rows]).reshape(-1, nodes) for field in fields}


def lines(path):
    return sum(1 for line in Path(path).read_text().splitlines() if line.strip() and not line.lstrip().startswith("#"))


def report(program, scene, script, set_up, step, differences):
    print(f"{program}: set-up {set_up * 1e3:.1f} ms, {step * 1e6:.0f} us a step; {lines(scene)} lines of the scene, {lines(script)} of this script")
    for field, difference in differences.items():
        print(f"{field}: differs by {difference:.1e} of the largest")
    print(json.dumps({"program": program, "setup_s": set_up, "step_s": step, "lines": lines(script), "differences": differences}))


def difference(theirs, ours):
    """Largest difference, relative to the largest value of the field."""
    return float(np.abs(theirs - ours).max() / np.abs(theirs).max())
