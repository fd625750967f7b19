"""The same FMU in other importers, each in its own environment: STICKSLIP_IMPORTERS names a folder that holds a virtual
environment per importer (made by scripts/importers_fmu.sh); without it these tests are skipped.

Every importer runs every trajectory, and one whose load changes at every step, and gives slip rate, slip and tangential
stress of every contact node at every communication point: the bits of the run that the packager made, as FMPy gives them too
(test_trajectories.py).
"""

import json
import os
import shutil
import subprocess
from pathlib import Path

import fmpy
import numpy as np
import pytest
from trajectories import FIELDS, SCENES, fmpy_run, rust_run

FOLDER = Path(os.environ.get("STICKSLIP_IMPORTERS", "/nonexistent"))
SCRIPTS = Path(__file__).parent / "importers"


def environment(name):
    if not (FOLDER / name).is_dir():
        pytest.skip(f"no environment {name} in STICKSLIP_IMPORTERS")
    return FOLDER / name / "bin"


@pytest.mark.parametrize("kind", ["2", "3", "3 scalar"])
@pytest.mark.parametrize("scene", ["kazmi2014", "brake_pad_3d"])
def test_manipulation_toolbox_finds_nothing(pack, scene, kind):
    tool = environment("fmu-manipulation-toolbox") / "fmutool"
    done = subprocess.run([tool, "-input", pack(scene, kind), "-check"], capture_output=True, text=True)
    text = done.stdout + done.stderr
    assert "seems to be compliant" in text and "No semantic error" in text, text


def contact(fmu):
    """Inputs of the packager's run; names and rows of the contact fields in it."""
    inputs, (names, *rows) = rust_run(fmu)
    columns = [i for i, name in enumerate(names) if name.removeprefix("contact.").split("[")[0] in FIELDS]
    assert len(columns) in (3 * 8, 3 * 32) and len(rows) == len(inputs) - 1 >= 9
    return inputs, [names[i] for i in columns], [[row[i] for i in columns] for row in rows]


def check_bits(found, expected):
    assert np.shape(found) == np.shape(expected)
    assert np.array(found).tobytes() == np.array(expected).tobytes()


# What each can carry: ecospy and fmuloader read the scalars of FMI 3 and no arrays; with FMI 2, fmuloader asks for the
# functions of Model Exchange too and refuses an FMU for Co-Simulation alone; libcosimpy is for FMI 2.
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize(
    ("importer", "kind"), [("libcosimpy", "2"), ("fmuloader", "3 scalar"), ("ecospy", "2"), ("ecospy", "3 scalar")]
)
def test_importer_gives_the_same_bits(pack_trajectory, importer, kind, name, tmp_path):
    python = environment(importer) / "python"
    fmu = pack_trajectory(name, kind)
    d = fmpy.read_model_description(str(fmu))
    references = {v.name: v.valueReference for v in d.modelVariables}
    inputs, names, expected = contact(fmu)
    job = {
        "fmu": str(fmu),
        "identifier": d.coSimulation.modelIdentifier,
        "token": d.guid or d.instantiationToken,
        "step": inputs[2][0],
        "inputs": [row[1:] for row in inputs[1:]],
        "input_names": inputs[0][1:],
        "input_references": [references[n] for n in inputs[0][1:]],
        "names": names,
        "references": [references[n] for n in names],
    }
    (tmp_path / "job.json").write_text(json.dumps(job))
    done = subprocess.run([python, SCRIPTS / f"run_{importer}.py", tmp_path / "job.json"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("row ")]
    check_bits([[float.fromhex(x) for x in row] for row in rows], expected)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("kind", ["2", "3", "3 scalar"])
def test_a_container_of_the_toolbox_gives_the_same_bits(pack_trajectory, kind, name, tmp_path):
    """The FMU inside a container FMU, which runs in FMPy; a container for FMI 3 hands arrays on."""
    tool = environment("fmu-manipulation-toolbox") / "fmucontainer"
    fmu = pack_trajectory(name, kind)
    inputs, names, expected = contact(fmu)
    if kind == "3":
        names = [f"contact.{field}" for field in dict.fromkeys(n.removeprefix("contact.").split("[")[0] for n in names)]
    shutil.copy(fmu, tmp_path / "pad.fmu")
    content = {
        "name": "container.fmu",
        "step_size": inputs[2][0],
        "fmu": ["pad.fmu"],
        "input": [[n, "pad.fmu", n] for n in inputs[0][1:]],
        "output": [["pad.fmu", n, n] for n in names],
        "auto_output": False,
    }
    (tmp_path / "container.json").write_text(json.dumps(content))
    options = ["-fmu-directory", ".", "-container", "container.json", "-fmi", kind[0], "-no-auto-output"]
    done = subprocess.run([tool, *options], cwd=tmp_path, capture_output=True, text=True)
    container = tmp_path / "container.fmu"
    assert container.is_file(), done.stdout + done.stderr
    check_bits([row[1:] for row in fmpy_run(container, inputs, names)], expected)
