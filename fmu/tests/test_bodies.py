"""Bodies of meshes, regions, memory, anisotropy and nonlinear laws as FMUs: what an importer steps is the run of the command, and the
trajectory of the independent solver in tests/reference/bodies."""

import csv
import json
import subprocess
from pathlib import Path

import pytest
from conftest import BUILD
from raw import Instance, Library, OK

BODIES = Path(__file__).parents[2] / "tests" / "reference" / "bodies"
NAMES = ["pad_prony", "pad3d_orthotropic_prony", "paper_prony_u0_be", "plate_hole_graded", "plate_hole_von_mises", "shoe_arc_p2",
         "two_feet_carreau"]
END_OF_STEP = 1


def norm(vector):
    return sum(x * x for x in vector) ** 0.5


def friction(part):
    if part["a"] == part["b"]:
        return {"law": "tresca", "bound": part["a"]}
    return {"law": "exponential", "a": part["a"], "b": part["b"], "alpha": part["alpha"]}


def scene_of(file):
    """The scene of a reference file. Its directions have lengths, which go into the signals."""
    mesh = file["mesh"]
    if mesh["kind"] == "gmsh":
        mesh = {"kind": "gmsh", "file": mesh["file"]}
    signals = {}
    for load in file["loads"]:
        length, given = norm(load["direction"]), file["signals"][load["name"]]
        signals[load["name"]] = [[t, v * length] for t, v in given] if isinstance(given, list) else given * length
    k, parts = file["step_size"], file["contact_parts"]
    scene = {
        "schema_version": 1, "name": file["name"], "mesh": mesh, "element": file["element"],
        "materials": [{"region": region, **material} for region, material in file["materials"].items()],
        "clamped": file["clamped"], "loads": file["loads"],
        "probes": [{"name": p["name"], "at": p["at"]} for p in file["probes_at"]],
        "time": {"scheme": file["scheme"], "start": file["start"], "step": k},
        "fidelity": {"tolerance": 1e-9, "friction_tolerance": 1e-12},
        "run": {"until": file["steps"] * k, "signals": signals},
    }
    if len(parts) == 1:
        scene["contact"] = {"part": parts[0]["part"], "friction": friction(parts[0])}
    else:
        scene["contacts"] = [{"name": p["part"].replace(" ", "_"), "part": p["part"], "friction": friction(p)} for p in parts]
    if start := file["initial_displacement"]:
        shape = f"{start['amplitude']} * ({'xyz'[start['axis']]} - {start['origin']})^2"
        scene["initial"] = {"displacement": [{"expression": shape} if i == start["component"] else 0.0
                                             for i in range(file["dimension"])]}
    return scene


@pytest.fixture(scope="module")
def body(tmp_path_factory):
    """Writes the scene of a body beside its mesh and runs it: file, scene, its path, and per instant the rows of the nodes."""
    made = {}

    def make(name):
        if name not in made:
            folder = tmp_path_factory.mktemp(name)
            file = json.loads((BODIES / f"{name}.json").read_text())
            scene = scene_of(file)
            if mesh := scene["mesh"].get("file"):
                (folder / mesh).write_bytes((BODIES / mesh).read_bytes())
            path = folder / f"{name}.json"
            path.write_text(json.dumps(scene))
            table = folder / "run.csv"
            done = subprocess.run([BUILD / "stickslip", "run", path, "--csv", table], capture_output=True, text=True)
            assert done.returncode == 0, done.stderr
            run = {}
            with open(table, newline="") as rows:
                for row in csv.DictReader(rows):
                    run.setdefault(float(row["time"]), []).append(row)
            made[name] = file, scene, path, run
        return made[name]

    return make


def at(signal, time):
    """Value of a signal that is linear between its points."""
    if not isinstance(signal, list):
        return signal
    for (t0, v0), (t1, v1) in zip(signal, signal[1:]):
        if t0 <= time <= t1:
            return v0 + (v1 - v0) * (time - t0) / (t1 - t0)
    return signal[-1][1] if time > signal[-1][0] else signal[0][1]


def columns(rows, prefix):
    names = [name for name in rows[0] if name == prefix or name.startswith(f"{prefix}_")]
    return [[float(row[name]) for name in names] for row in rows]


@pytest.mark.parametrize("name", NAMES)
def test_an_fmu_goes_the_way_of_the_run_and_of_the_reference(body, pack, version, name):
    file, scene, path, run = body(name)
    library = Library(pack(path, version))
    pad = Instance(library)
    assert pad.setup() == OK and pad.choice("time.inputs", END_OF_STEP) == OK and pad.enter() == OK, pad.log
    signals, instants = scene["run"]["signals"], sorted(run)
    for load, signal in signals.items():
        assert pad.set(load, at(signal, 0.0)) == OK
    assert pad.exit() == OK, pad.log
    places = [[float(row[axis]) for axis in "xyz" if axis in row] for row in run[instants[0]]]
    distance = lambda node, point: norm([a - b for a, b in zip(places[node], point)])
    match = [min(range(len(places)), key=lambda node: distance(node, point)) for point in file["contact_points"]]
    assert sorted(match) == list(range(len(places)))
    samples = {round(sample["t"] / file["step_size"]): sample for sample in file["samples"]}
    apart, largest, off = {"slip_rate": 0.0, "tangential_stress": 0.0}, dict.fromkeys(("slip_rate", "tangential_stress"), 0.0), {}
    for step, (before, now) in enumerate(zip(instants, instants[1:]), 1):
        for load, signal in signals.items():
            assert pad.set(load, at(signal, now)) == OK
        assert pad.step(before, now - before) == OK, pad.log
        for field in apart:
            rows = columns(run[now], field)
            ours, width = pad.get(f"contact.{field}"), len(rows[0])
            expected = [value for row in rows for value in row]
            apart[field] = max(apart[field], *(abs(a - b) for a, b in zip(ours, expected, strict=True)))
            largest[field] = max(largest[field], *map(abs, expected))
            if sample := samples.get(step):
                # magnitudes do not depend on the frames of the nodes
                theirs = [norm(v) if isinstance(v, list) else abs(v) for v in sample[field]]
                magnitudes = [norm(ours[width * node : width * (node + 1)]) for node in match]
                off[field] = max(off.get(field, 0.0), *(abs(a - b) for a, b in zip(magnitudes, theirs, strict=True)))
    for field, size in largest.items():
        assert size > 0.0
        assert apart[field] <= 1e-12 * size, (field, apart[field] / size)
        assert off[field] <= 1e-7 * size, (field, off[field] / size)
    pad.free()
    library.close()
