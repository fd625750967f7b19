"""Every trajectory of tests/reference through FMPy equals the Rust run bit for bit, and the reference within tolerance.

The Rust run is the one that the packager makes and puts into the FMU.
"""

import json
import math

import fmpy
import numpy as np
import pytest
from raw import OK, Instance, Library
from trajectories import FIELDS, REFERENCES, ROOT, fmpy_run, rust_run

MOVING = ["belt", "brake_pad_3d", "disc_brake", "fault", "seal", "sheared_column", "snap"]


def check_bits(fmu):
    inputs, (names, *expected) = rust_run(fmu)
    found = fmpy_run(fmu, inputs)
    assert np.array(found).tobytes() == np.array(expected).tobytes()
    return names, expected


def scene_of(name):
    return json.loads((ROOT / f"src/scene/examples/{name}.json").read_text())


def moves(rows):
    """Whether any column but the time changes."""
    return any(max(column) != min(column) for column in list(zip(*rows))[1:])


@pytest.mark.parametrize("kind", ["2", "3", "3 scalar"])
@pytest.mark.parametrize("scene", ["kazmi2014", *MOVING])
def test_examples_run_bit_for_bit(pack, scene, kind):
    fmu = pack(scene, kind)
    names, rows = check_bits(fmu)
    slip = [i for i, name in enumerate(names) if name.startswith("contact.slip[")]
    assert max(abs(row[i]) for row in rows for i in slip) > 0
    # a load that rises and falls, sampled: a run at rest would compare zeros with zeros
    assert moves(rust_run(fmu)[0][1:]) == (scene in MOVING)


@pytest.mark.parametrize("scene", ["kazmi2014", *MOVING])
def test_the_run_of_the_scene_is_the_default_experiment_and_the_reference_run(pack, version, scene):
    fmu, run = pack(scene, version), scene_of(scene)["run"]
    experiment = fmpy.read_model_description(str(fmu)).defaultExperiment
    step = run.get("step", scene_of(scene)["time"]["step"])
    assert float(experiment.startTime) == 0.0 and float(experiment.stopTime) == run["until"]
    assert float(experiment.stepSize) == step
    (names, *inputs), _ = rust_run(fmu)
    assert inputs[0][0] == 0.0 and inputs[-1][0] == run["until"] and len(inputs) == round(run["until"] / step) + 1
    for name, signal in run["signals"].items():
        column = names.index(name)
        times, values = zip(*signal) if isinstance(signal, list) else ([0.0], [signal])
        for row in inputs:
            assert row[column] == pytest.approx(np.interp(row[0], times, values), abs=1e-12 * max(map(abs, values)))


def test_longer_runs_and_other_steps_of_a_scene_are_kept(pack, tmp_path, version):
    scene = scene_of("kazmi2014")
    scene["run"] = {"until": 3.0, "step": 0.5, "signals": {"press": [[0, 0], [1, -0.3], [2, -0.1]]}}
    path = tmp_path / "own_run.json"
    path.write_text(json.dumps(scene))
    fmu = pack(path, version)
    experiment = fmpy.read_model_description(str(fmu)).defaultExperiment
    assert (float(experiment.stopTime), float(experiment.stepSize)) == (3.0, 0.5)
    (_, *inputs), _ = rust_run(fmu)
    assert [row[1] for row in inputs] == pytest.approx([0, -0.15, -0.3, -0.2, -0.1, -0.1, -0.1])


@pytest.mark.parametrize("scene", ["kazmi2014", *MOVING])
def test_simulate_fmu_gives_the_reference_run(pack, scene):
    """FMPy's own loop, with the stimuli and the default experiment that the FMU carries: the same bits."""
    fmu = pack(scene, "2")
    (names, *inputs), (outputs, *expected) = rust_run(fmu)
    signals = np.array([tuple(row) for row in inputs], dtype=[(name, float) for name in names])
    found = fmpy.simulate_fmu(str(fmu), input=signals, output=outputs[1:])
    assert len(found) == len(expected) and np.array(found.tolist()).tobytes() == np.array(expected).tobytes()


def wave(t):
    return -0.15 * (1 - math.cos(4 * t))


def scene_under_a_wave(tmp_path, h):
    scene = scene_of("kazmi2014")
    scene["loads"][0]["start"] = 0.0
    scene["time"]["step"] = h
    path = tmp_path / f"wave_{round(1 / h)}.json"
    path.write_text(json.dumps(scene))
    return path


def course(pack, tmp_path, kind, h, **start_values):
    """Displacements of the tip every 1/8 s, of the paper's example under a smooth load, by simulate_fmu."""
    path = scene_under_a_wave(tmp_path, h)
    signal = np.array([(i * h, wave(i * h)) for i in range(round(1 / h) + 1)], dtype=[("time", float), ("press", float)])
    rows = fmpy.simulate_fmu(
        str(pack(path, kind)), input=signal, output=["press.displacement"], output_interval=h, stop_time=1.0, start_values=start_values,
    )  # fmt: skip
    every = round(1 / (8 * h))
    return np.array([row[1] for row in rows])[::every]


def with_derivatives(pack, tmp_path, h):
    """The same with u and its mean derivative over the step, as an importer sets them in FMI 2."""
    library = Library(pack(scene_under_a_wave(tmp_path, h), "2"))
    pad, rows = Instance(library).start(press=wave(0.0)), [0.0]
    for i in range(round(1 / h)):
        t = i * h
        assert pad.set("press", wave(t)) == OK and pad.input_derivative("press", (wave(t + h) - wave(t)) / h) == OK
        assert pad.step(t, h) == OK
        rows += pad.get("press.displacement")
    pad.free()
    library.close()
    return np.array(rows)[:: round(1 / (8 * h))]


def end_of_step(pack, tmp_path, h):
    """The same as the scene's own run has it: inputs are the loads at the end of the step."""
    scene = scene_of("kazmi2014")
    scene["loads"][0]["start"] = 0.0
    scene["time"].update(step=h, inputs="end_of_step")
    scene["run"]["signals"] = {"press": [[i * h, wave(i * h)] for i in range(round(1 / h) + 1)]}
    path = tmp_path / f"own_{round(1 / h)}.json"
    path.write_text(json.dumps(scene))
    _, (names, *rows) = rust_run(pack(path, "3"))
    return np.array([row[names.index("press.displacement")] for row in rows])[:: round(1 / (8 * h))]


@pytest.mark.parametrize("kind", ["2", "3"])
def test_ordinary_clients_reproduce_the_run_without_shifted_rows(pack, tmp_path, kind):
    """Set u(t), step: of second order with the continued slope, of first order held, and with derivatives of order 2 at once."""
    fine = end_of_step(pack, tmp_path, 1 / 512)
    error = lambda rows: max(abs(rows - fine))  # noqa: E731
    steps = (1 / 32, 1 / 64)
    continued = [error(course(pack, tmp_path, kind, h)) for h in steps]
    held = [error(course(pack, tmp_path, kind, h, **{"time.inputs": 2})) for h in steps]
    assert math.log2(continued[0] / continued[1]) > 1.7
    assert 0.8 < math.log2(held[0] / held[1]) < 1.2
    assert continued[0] < 0.2 * held[0]
    if kind == "2":
        given = [error(with_derivatives(pack, tmp_path, h)) for h in steps]
        own = [error(end_of_step(pack, tmp_path, h)) for h in steps]
        assert given == pytest.approx(own, rel=1e-6)


@pytest.mark.parametrize("name", REFERENCES)
def test_reference_trajectories_run_bit_for_bit(pack_trajectory, version, name):
    reference = REFERENCES[name]
    header, rows = check_bits(pack_trajectory(name, version))
    step = reference["step_size"]
    for field in FIELDS:
        columns = [i for i, name in enumerate(header) if name.startswith(f"contact.{field}[")]
        pairs = [(rows[round(s["t"] / step)], s[field]) for s in reference["samples"]]
        error = max(abs(row[c] - x) for row, xs in pairs for c, x in zip(columns, xs))
        assert error <= 1e-6 * max(abs(x) for _, xs in pairs for x in xs)


def test_packed_files_are_valid(pack):
    for scene in ("kazmi2014", "brake_pad_3d"):
        for kind in ("2", "3", "3 scalar"):
            assert fmpy.validation.validate_fmu(str(pack(scene, kind))) == []
