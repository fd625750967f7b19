"""Every trajectory of tests/reference through FMPy equals the Rust run bit for bit, and the reference within tolerance.

The Rust run is the one that the packager makes and puts into the FMU.
"""

import csv
import io
import json
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

ROOT = Path(__file__).parents[2]
FILES = sorted((ROOT / "tests" / "reference").glob("*.json"))
SCHEMES = {"trap": "trapezoid", "be": "backward_euler", "rect": "rectangle"}


def scene_of(reference):
    scene = json.loads((ROOT / "src/scene/examples/kazmi2014.json").read_text())
    p = reference["parameters"]
    cells = reference["cells"]
    scene["mesh"]["cells"] = cells
    scene["contact"]["friction"].update(a=p["a"], b=p["b"], alpha=p["alpha"])
    step = reference["step_size"]
    scene["time"] = {"scheme": SCHEMES[reference["scheme"]], "start": reference["start"], "step": step}
    scene["run"]["until"] = reference["samples"][-1]["t"]
    return scene


def rust_run(fmu):
    with zipfile.ZipFile(fmu) as archive:
        tables = [archive.read(f"extra/org.fmi-standard.fmi-ls-ref/reference_{n}.csv").decode() for n in ("in", "out")]
    inputs, outputs = (list(csv.reader(io.StringIO(t))) for t in tables)
    return inputs, outputs


def fmpy_run(fmu, inputs):
    """Rows of time and all outputs, in the order of the description, through FMPy's low-level interface."""
    d = fmpy.read_model_description(str(fmu))
    folder = fmpy.extract(str(fmu))
    two = d.fmiVersion == "2.0"
    kind = FMU2Slave if two else FMU3Slave
    token = d.guid if two else d.instantiationToken
    pad = kind(guid=token, unzipDirectory=folder, modelIdentifier=d.coSimulation.modelIdentifier, instanceName="pad")
    by_name = {v.name: v for v in d.modelVariables}
    refs = [v.valueReference for v in d.modelVariables if v.causality == "output"]
    sizes = sum(int(np.prod(v.shape)) if v.dimensions else 1 for v in d.modelVariables if v.causality == "output")
    names, rows = [by_name[n].valueReference for n in inputs[0][1:]], []

    def put(row):
        values = [float(x) for x in row[1:]]
        pad.setReal(names, values) if two else pad.setFloat64(names, values)

    pad.instantiate()
    if two:
        pad.setupExperiment(startTime=0.0)
    pad.enterInitializationMode()
    put(inputs[1])
    pad.exitInitializationMode()
    for i, row in enumerate(inputs[1:]):
        if i:
            put(row)
            before = float(inputs[i][0])
            pad.doStep(before, float(inputs[2][0]))
        rows.append([float(row[0])] + list(pad.getReal(refs) if two else pad.getFloat64(refs, nValues=sizes)))
    pad.terminate()
    pad.freeInstance()
    return rows


def check_bits(fmu):
    inputs, outputs = rust_run(fmu)
    expected = [[float(x) for x in row] for row in outputs[1:]]
    found = fmpy_run(fmu, inputs)
    assert np.array(found).tobytes() == np.array(expected).tobytes()
    return outputs[0], expected


@pytest.mark.parametrize("kind", ["2", "3", "3 scalar"])
@pytest.mark.parametrize("scene", ["kazmi2014", "brake_pad_3d", "seal", "sheared_column"])
def test_examples_run_bit_for_bit(pack, scene, kind):
    check_bits(pack(scene, kind))


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.stem)
def test_reference_trajectories_run_bit_for_bit(pack, version, file, tmp_path):
    reference = json.loads(file.read_text())
    if "samples" not in reference or "scheme" not in reference:
        pytest.skip("no trajectory")
    path = tmp_path / f"{file.stem}.json"
    path.write_text(json.dumps(scene_of(reference)))
    header, rows = check_bits(pack(path, version))
    step = reference["step_size"]
    fields = ("slip_rate", "slip", "tangential_stress")
    for field in fields:
        columns = [i for i, name in enumerate(header) if name.startswith(f"contact.{field}[")]
        pairs = [(rows[round(s["t"] / step)], s[field]) for s in reference["samples"]]
        error = max(abs(row[c] - x) for row, xs in pairs for c, x in zip(columns, xs))
        assert error <= 1e-6 * max(abs(x) for _, xs in pairs for x in xs)


def test_packed_files_are_valid(pack):
    for scene in ("kazmi2014", "brake_pad_3d"):
        for kind in ("2", "3", "3 scalar"):
            assert fmpy.validation.validate_fmu(str(pack(scene, kind))) == []
