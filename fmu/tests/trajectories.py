"""The trajectories of tests/reference: their scenes, the run that the packager put into an FMU, and a run through FMPy."""

import csv
import io
import json
import math
import shutil
import zipfile
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

ROOT = Path(__file__).parents[2]
SCHEMES = {"trap": "trapezoid", "be": "backward_euler", "rect": "rectangle"}
FIELDS = ("slip_rate", "slip", "tangential_stress")
# those files that hold a trajectory, by name
REFERENCES = {
    file.stem: reference
    for file in sorted((ROOT / "tests" / "reference").glob("*.json"))
    if "samples" in (reference := json.loads(file.read_text())) and "scheme" in reference
}


def scene_of(reference):
    scene = json.loads((ROOT / "src/scene/examples/kazmi2014.json").read_text())
    p = reference["parameters"]
    scene["mesh"]["cells"] = reference["cells"]
    scene["contact"]["friction"].update(a=p["a"], b=p["b"], alpha=p["alpha"])
    scene["time"] = {"scheme": SCHEMES[reference["scheme"]], "start": reference["start"], "step": reference["step_size"]}
    scene["run"]["until"] = reference["samples"][-1]["t"]
    return scene


def pulsed():
    """The paper's example under a load that changes at every step."""
    scene = json.loads((ROOT / "src/scene/examples/kazmi2014.json").read_text())
    h = scene["time"]["step"]
    press = [-0.3 + 0.1 * math.sin(7 * i * h) for i in range(33)]
    scene["run"]["signals"]["press"] = [[i * h, value] for i, value in enumerate(press)]
    scene["loads"][0]["start"] = press[0]
    return scene


SCENES = {name: scene_of(reference) for name, reference in REFERENCES.items()} | {"pulsed": pulsed()}


def rust_run(fmu):
    """Rows of time and inputs, rows of time and all outputs, each below the names; as the packager ran the scene: the inputs of a
    row are set before the step that begins at its time."""
    with zipfile.ZipFile(fmu) as archive:
        tables = [archive.read(f"extra/org.fmi-standard.fmi-ls-ref/reference_{n}.csv").decode() for n in ("in", "out")]
    tables = [list(csv.reader(io.StringIO(table))) for table in tables]
    return [[names, *([float(x) for x in row] for row in rows)] for names, *rows in tables]


def fmpy_run(fmu, inputs, outputs=None):
    """Rows of time and the outputs named (default: all), in the order of the description, through FMPy's low-level interface."""
    d = fmpy.read_model_description(str(fmu))
    folder = fmpy.extract(str(fmu))
    two = d.fmiVersion == "2.0"
    kind = FMU2Slave if two else FMU3Slave
    token = d.guid if two else d.instantiationToken
    pad = kind(guid=token, unzipDirectory=folder, modelIdentifier=d.coSimulation.modelIdentifier, instanceName="pad")
    by_name = {v.name: v for v in d.modelVariables}
    found = [by_name[n] for n in outputs] if outputs else [v for v in d.modelVariables if v.causality == "output"]
    refs = [v.valueReference for v in found]
    sizes = sum(int(np.prod(v.shape)) if v.dimensions else 1 for v in found)
    knobs, rows = [by_name[n].valueReference for n in inputs[0][1:]], []

    def put(row):
        pad.setReal(knobs, row[1:]) if two else pad.setFloat64(knobs, row[1:])

    pad.instantiate()
    if two:
        pad.setupExperiment(startTime=0.0)
    pad.enterInitializationMode()
    put(inputs[1])
    pad.exitInitializationMode()


    def read(time):
        rows.append([time] + list(pad.getReal(refs) if two else pad.getFloat64(refs, nValues=sizes)))

    read(inputs[1][0])
    for row, after in zip(inputs[1:], inputs[2:]):
        put(row)
        pad.doStep(row[0], after[0] - row[0])
        read(after[0])
    pad.terminate()
    pad.freeInstance()
    shutil.rmtree(folder)
    return rows
