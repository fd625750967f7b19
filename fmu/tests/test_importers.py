"""The same FMU in other importers, each in its own environment: STICKSLIP_IMPORTERS names a folder that holds a virtual
environment per importer (made by scripts/importers_fmu.sh); without it these tests are skipped."""

import os
import subprocess
from pathlib import Path

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


COSIM = """
import sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave
execution = CosimExecution.from_step_size(step_size=10**9 // 32)
index = execution.add_local_slave(CosimLocalSlave(fmu_path=sys.argv[1], instance_name="pad"))
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
assert execution.simulate_until(10**9)
print("values", *(float(x).hex() for x in observer.last_real_values(index, [2, 33, 34, 65])))
"""


def test_libcosim_gives_the_same_bits(pack):
    python = environment("libcosimpy") / "python"
    fmu = pack("kazmi2014", "2")
    done = subprocess.run([python, "-c", COSIM, str(fmu)], capture_output=True, text=True)
    line = next(line for line in done.stdout.splitlines() if line.startswith("values"))
    library = Library(fmu)
    pad = Instance(library).start()
    for i in range(32):
        assert pad.step(i / 32, 1 / 32) == OK
    expected = (pad.get("contact.tangential_stress") + pad.get("contact.slip_rate"))
    picked = [expected[i] for i in (0, 31, 32, 63)]
    assert [float.fromhex(x) for x in line.split()[1:]] == picked
    pad.free()
    library.close()
