"""The same FMU in other importers, each in its own environment: STICKSLIP_IMPORTERS names a folder that holds a virtual
environment per importer (made by scripts/importers_fmu.sh); without it these tests are skipped."""

import ctypes
import json
import os
import shutil
import subprocess
from pathlib import Path

import fmpy
import pytest
from raw import OK, Instance, Library

FOLDER = Path(os.environ.get("STICKSLIP_IMPORTERS", "/nonexistent"))


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


# Each script steps the paper's example 32 times through one importer and prints a few contact values: the stress and the
# slip rate of the first and the last contact node.
LIBCOSIM = """
import sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave
execution = CosimExecution.from_step_size(step_size=10**9 // 32)
index = execution.add_local_slave(CosimLocalSlave(fmu_path=sys.argv[1], instance_name="pad"))
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
assert execution.simulate_until(10**9)
references = [int(r) for r in sys.argv[4:]]
print("values", *(float(x).hex() for x in observer.last_real_values(index, references)))
"""

# With FMI 2, fmuloader asks for the functions of Model Exchange too and refuses an FMU for Co-Simulation alone.
FMULOADER = """
import sys
from fmuloader.fmi3 import Fmi3Slave
pad = Fmi3Slave(sys.argv[1], model_identifier=sys.argv[2])
pad.instantiate_co_simulation("pad", instantiation_token=sys.argv[3])
pad.enter_initialization_mode(start_time=0.0)
pad.exit_initialization_mode()
for i in range(32):
    pad.do_step(i / 32, 1 / 32)
print("values", *(x.hex() for x in pad.get_float64([int(r) for r in sys.argv[4:]])))
pad.terminate()
pad.free_instance()
"""

ECOS = """
import sys
from ecospy import EcosSimulation, EcosSimulationStructure
with EcosSimulationStructure() as structure:
    structure.add_model("pad", sys.argv[1])
    with EcosSimulation(structure=structure, step_size=1 / 32) as simulation:
        simulation.init()
        for i in range(32):
            simulation.step()
        names = [f"pad::contact.{q}[{i}]" for q in ("tangential_stress", "slip_rate") for i in (1, 32)]
        print("values", *(float(simulation.get_real(name)).hex() for name in names))
        simulation.terminate()
"""


@pytest.mark.parametrize(
    ("importer", "kind", "script"),
    [
        ("libcosimpy", "2", LIBCOSIM),
        ("fmuloader", "3 scalar", FMULOADER),
        ("ecospy", "2", ECOS),
        ("ecospy", "3 scalar", ECOS),
    ],
)
def test_importer_gives_the_same_bits(pack, importer, kind, script):
    python = environment(importer) / "python"
    fmu = pack("kazmi2014", kind)
    description = fmpy.read_model_description(str(fmu))
    by_name = {v.name: v.valueReference for v in description.modelVariables}
    names = [f"contact.{q}[{i}]" for q in ("tangential_stress", "slip_rate") for i in (1, 32)]
    references = [str(by_name[n]) for n in names]
    token = description.guid or description.instantiationToken
    arguments = [str(fmu), description.coSimulation.modelIdentifier, token, *references]
    done = subprocess.run([python, "-c", script, *arguments], capture_output=True, text=True)
    lines = [line for line in done.stdout.splitlines() if line.startswith("values")]
    assert lines, done.stdout + done.stderr
    library = Library(fmu)
    pad = Instance(library).start()
    for i in range(32):
        assert pad.step(i / 32, 1 / 32) == OK
    expected = (ctypes.c_double * len(references))()
    assert pad.get_refs([int(r) for r in references], expected) == OK
    assert [float.fromhex(x) for x in lines[-1].split()[1:]] == list(expected)
    pad.free()
    library.close()


@pytest.mark.parametrize("kind", ["2", "3 scalar"])
def test_a_container_of_the_toolbox_gives_the_same_bits(pack, kind, tmp_path):
    """The FMU inside a container FMU, which runs in FMPy."""
    tool = environment("fmu-manipulation-toolbox") / "fmucontainer"
    fmu = pack("kazmi2014", kind)
    shutil.copy(fmu, tmp_path / "pad.fmu")
    names = [f"contact.{q}[{i}]" for q in ("tangential_stress", "slip_rate") for i in (1, 32)]
    content = {
        "name": "container.fmu",
        "step_size": 1 / 32,
        "fmu": ["pad.fmu"],
        "input": [["press", "pad.fmu", "press"]],
        "output": [["pad.fmu", name, f"value{i}"] for i, name in enumerate(names)],
        "auto_output": False,
    }
    (tmp_path / "container.json").write_text(json.dumps(content))
    options = ["-fmu-directory", ".", "-container", "container.json", "-fmi", kind[0], "-no-auto-output"]
    done = subprocess.run([tool, *options], cwd=tmp_path, capture_output=True, text=True)
    container = tmp_path / "container.fmu"
    assert container.is_file(), done.stdout + done.stderr
    course = {"stop_time": 1.0, "output_interval": 1 / 32, "start_values": {"press": -0.3}}
    inside = fmpy.simulate_fmu(str(container), step_size=1 / 32, output=[f"value{i}" for i in range(4)], **course)
    alone = fmpy.simulate_fmu(str(fmu), output=names, **course)
    # the container's clock adds its steps up: the last point is the same
    assert list(inside[-1])[1:] == [alone[-1][name] for name in names]
